#include "app/cart/locked_memory.h"

#include <sys/mman.h>

#include <cerrno>
#include <system_error>

namespace sonoband::cart {

std::string lock_refused(std::size_t bytes, int error) {
  return "The " + std::to_string((bytes + (1U << 20) - 1) >> 20) +
         " MB of picture memory could not be locked (" + std::generic_category().message(error) +
         "): raise the limit with `ulimit -l` or LimitMEMLOCK= in the service file, or set fewer frames.";
}

LockedMemory::LockedMemory(std::span<const std::byte> memory) : memory_(memory) {
  if (mlock(memory.data(), memory.size()) != 0) warning_ = lock_refused(memory.size(), errno);
}

LockedMemory::~LockedMemory() {
  if (locked()) munlock(memory_.data(), memory_.size());
}

}  // namespace sonoband::cart
