// Memory that the system may not page out, so that no frame waits for a disk.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace sonoband::cart {

class LockedMemory {
 public:
  explicit LockedMemory(std::span<const std::byte> memory);
  ~LockedMemory();
  LockedMemory(const LockedMemory&) = delete;
  LockedMemory& operator=(const LockedMemory&) = delete;

  bool locked() const { return warning_.empty(); }
  // One sentence with the cure when the system's limit forbids it, else empty. The cart works all the same.
  const std::string& warning() const { return warning_; }

 private:
  std::span<const std::byte> memory_;
  std::string warning_;
};

}  // namespace sonoband::cart
