// The system calls that Video4Linux is spoken to with, as a seam: behind it is the kernel and, in tests, a
// bridge of made-up answers. All as their manual pages have them; errors are negative errno.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/time.h"

namespace sonoband {

class KernelCalls {
 public:
  virtual ~KernelCalls() = default;
  virtual int open(const std::string& path) = 0;
  virtual int control(int fd, unsigned long request,
                      void* argument) = 0;  // ioctl, begun again after a signal
  // The mapped memory, null where the kernel refuses.
  virtual void* map(int fd, std::size_t bytes, std::int64_t offset) = 0;
  virtual void unmap(void* start, std::size_t bytes) = 0;
  // Waits for a picture or an event: poll's revents; 0 when the time is over.
  virtual int wait(int fd, Duration timeout) = 0;
  virtual void close(int fd) = 0;
};

KernelCalls& kernel_calls();  // the kernel itself; has no state

}  // namespace sonoband
