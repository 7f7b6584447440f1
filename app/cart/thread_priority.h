// Real-time priority for threads that must not wait for others: a late capture thread loses pictures.
#pragma once

#include <string>

namespace sonoband::cart {

// While it lives the calling thread, and every thread it starts (they inherit), runs before all that have no
// real-time priority; threads keep it. `priority` 1 to 99, 0 to do nothing. Usual: 40, below the kernel's own
// interrupt threads (50), which bring the pictures.
class BeforeOthers {
 public:
  explicit BeforeOthers(int priority);
  ~BeforeOthers();
  BeforeOthers(const BeforeOthers&) = delete;
  BeforeOthers& operator=(const BeforeOthers&) = delete;

  // One sentence with the cure where the system refuses, or empty. The cart works all the same.
  const std::string& warning() const { return warning_; }

 private:
  bool raised_ = false;
  int policy_ = 0;
  int before_ = 0;
  std::string warning_;
};

}  // namespace sonoband::cart
