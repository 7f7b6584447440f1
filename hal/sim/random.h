// Numbers that depend only on a seed and a place in a sequence: the same on every machine, in any order.
#pragma once

#include <cstdint>

namespace sonoband::sim {

// SplitMix64 (Steele, Lea, Flood 2014).
constexpr std::uint64_t hash(std::uint64_t seed, std::uint64_t n) {
  std::uint64_t z = seed + (n + 1) * 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31);
}

// In [0, 1).
constexpr double uniform(std::uint64_t seed, std::uint64_t n) {
  return static_cast<double>(hash(seed, n) >> 11) * 0x1p-53;
}

// Near Gaussian, mean 0, deviation 1: a sum of four uniforms, so never beyond 3.5.
constexpr double gaussian(std::uint64_t seed, std::uint64_t n) {
  const std::uint64_t h = hash(seed, n);
  const auto part = [h](int i) { return static_cast<double>((h >> (16 * i)) & 0xffff) / 65535; };
  return (part(0) + part(1) + part(2) + part(3) - 2) * 1.7320508075688772;
}

}  // namespace sonoband::sim
