#include "hal/capture/kernel_calls.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>

namespace sonoband {
namespace {

class Kernel final : public KernelCalls {
 public:
  int open(const std::string& path) override {
    const int fd = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return fd < 0 ? -errno : fd;
  }
  int control(int fd, unsigned long request, void* argument) override {
    int result = 0;
    do {
      result = ioctl(fd, request, argument);
    } while (result == -1 && errno == EINTR);
    return result < 0 ? -errno : result;
  }
  void* map(int fd, std::size_t bytes, std::int64_t offset) override {
    void* start = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
    return start == MAP_FAILED ? nullptr : start;
  }
  void unmap(void* start, std::size_t bytes) override { munmap(start, bytes); }
  int wait(int fd, Duration timeout) override {
    pollfd ready{fd, POLLIN | POLLPRI, 0};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
    const int n = poll(&ready, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 10'000)));
    if (n < 0) return errno == EINTR ? 0 : -errno;
    return n == 0 ? 0 : ready.revents;
  }
  void close(int fd) override { ::close(fd); }
};

}  // namespace

KernelCalls& kernel_calls() {
  static Kernel kernel;
  return kernel;
}

}  // namespace sonoband
