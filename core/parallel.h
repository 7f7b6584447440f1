// Threads are lent to core by its caller (house: core starts none of its own).
#pragma once

#include <functional>

namespace sonoband {

// Runs body(0) .. body(count-1), each once, in any order and on any thread, and returns when all are done.
// Results must not depend on the order or on width(). Bodies must not throw.
class Parallel {
 public:
  virtual ~Parallel() = default;
  virtual int width() const = 0;  // threads that take part, the caller included
  virtual void for_each(int count, const std::function<void(int)>& body) = 0;
};

// The caller's own thread and nothing else.
class Serial final : public Parallel {
 public:
  int width() const override { return 1; }
  void for_each(int count, const std::function<void(int)>& body) override {
    for (int i = 0; i < count; ++i) body(i);
  }
};

}  // namespace sonoband
