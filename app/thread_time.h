// Processor time of the calling thread: what work costs, whatever else the machine does.
#pragma once

#include <ctime>

#include "core/time.h"

namespace sonoband {

inline Duration thread_time() {
  std::timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return std::chrono::seconds(t.tv_sec) + std::chrono::nanoseconds(t.tv_nsec);
}

}  // namespace sonoband
