#include "app/cart/locked_memory.h"

#include <sys/mman.h>

#include <cerrno>
#include <system_error>

namespace sonoband::cart {

LockedMemory::LockedMemory(std::span<const std::byte> memory) : memory_(memory) {
  if (mlock(memory.data(), memory.size()) == 0) return;
  const std::string reason = std::generic_category().message(errno);
  warning_ = "The " + std::to_string((memory.size() + (1U << 20) - 1) >> 20) +
             " MB of picture memory could not be locked (" + reason +
             "): raise the limit with `ulimit -l` or LimitMEMLOCK= in the service file, or set fewer frames.";
}

LockedMemory::~LockedMemory() {
  if (locked()) munlock(memory_.data(), memory_.size());
}

}  // namespace sonoband::cart
