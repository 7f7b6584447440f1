// Reading time and waiting for it. Only hal and app may.
#pragma once

#include <memory>

#include "core/time.h"

namespace sonoband {

class Clock {
 public:
  virtual ~Clock() = default;
  virtual Stamp now() = 0;
  virtual void sleep_until(Stamp t) = 0;  // returns at once if t has passed
};

// CLOCK_MONOTONIC.
class SystemClock final : public Clock {
 public:
  Stamp now() override;
  void sleep_until(Stamp t) override;
};

}  // namespace sonoband
