// A command on its way to a tracker, as the exact bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sonoband {

struct WireCommand {
  std::array<std::uint8_t, 64> storage{};
  std::size_t size = 0;

  std::span<const std::uint8_t> bytes() const { return {storage.data(), size}; }
};

}  // namespace sonoband
