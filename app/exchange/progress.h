// How long work says how far it is, and is stopped.
#pragma once

#include <algorithm>
#include <functional>

namespace sonoband::exchange {

// Gets parts per thousand; false stops the work (BadInput "stopped"). May be empty.
using Progress = std::function<bool(int)>;

// Of the work's part `i` of `n` equal ones, from 0. `whole` must outlive it.
inline Progress part_of(const Progress& whole, int i, int n) {
  if (!whole) return {};
  return [&whole, i, n](int permille) { return whole((1000 * i + std::clamp(permille, 0, 1000)) / n); };
}

}  // namespace sonoband::exchange
