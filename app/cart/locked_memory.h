// Memory that the system may not page out, so that no frame waits for a disk.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace sonoband::cart {

// What to tell the operator when the system refuses, with the cure. `error` is errno.
std::string lock_refused(std::size_t bytes, int error);

class LockedMemory {
 public:
  explicit LockedMemory(std::span<const std::byte> memory);
  ~LockedMemory();
  LockedMemory(const LockedMemory&) = delete;
  LockedMemory& operator=(const LockedMemory&) = delete;

  bool locked() const { return warning_.empty(); }
  // lock_refused's sentence, or empty. The cart works all the same.
  const std::string& warning() const { return warning_; }

 private:
  std::span<const std::byte> memory_;
  std::string warning_;
};

}  // namespace sonoband::cart
