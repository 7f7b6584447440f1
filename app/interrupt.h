// Ctrl-C and a polite kill as a question, so that a verb can take away what is half written, and the cart
// saves a sweep that is being recorded.
#pragma once

namespace sonoband {

// While one lives, SIGINT and SIGTERM are only noted; a second one ends the program as usual. One at a time.
class Interruptible {
 public:
  Interruptible();
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

  bool asked_to_stop() const;
};

}  // namespace sonoband
