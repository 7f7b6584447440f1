#include "core/reslice/layer_kernels.h"

#include <algorithm>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/reslice/layer_kernels.cpp"
#include <hwy/foreach_target.h>
// Highway's per-target headers come after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Bytes = hn::ScalableTag<std::uint8_t>;
using Words = hn::ScalableTag<std::uint16_t>;

HWY_ATTR void fold(const std::uint8_t* const* rows, int count, bool minimum, int width, std::uint8_t* out) {
  const Bytes d;
  const int step = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + step <= width; x += step) {
    auto best = hn::LoadU(d, rows[0] + x);
    if (minimum) {
      for (int i = 1; i < count; ++i) best = hn::Min(best, hn::LoadU(d, rows[i] + x));
    } else {
      for (int i = 1; i < count; ++i) best = hn::Max(best, hn::LoadU(d, rows[i] + x));
    }
    hn::StoreU(best, d, out + x);
  }
  for (; x < width; ++x) {
    std::uint8_t best = rows[0][x];
    for (int i = 1; i < count; ++i) best = minimum ? std::min(best, rows[i][x]) : std::max(best, rows[i][x]);
    out[x] = best;
  }
}

HWY_ATTR void count(const std::uint16_t* has_data, std::uint16_t layers, bool add, int width,
                    std::uint16_t* counts) {
  const Words d;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto wanted = hn::Set(d, layers);
  int x = 0;
  for (; x + step <= width; x += step) {
    const auto has = hn::PopulationCount(hn::And(hn::LoadU(d, has_data + x), wanted));
    const auto old = hn::LoadU(d, counts + x);
    hn::StoreU(add ? hn::Add(old, has) : hn::Sub(old, has), d, counts + x);
  }
  const int sign = add ? 1 : -1;
  for (; x < width; ++x) {
    const int has = std::popcount(static_cast<std::uint16_t>(has_data[x] & layers));
    counts[x] = static_cast<std::uint16_t>(counts[x] + sign * has);
  }
}

HWY_ATTR void sum(const std::uint8_t* values, bool add, int width, std::uint32_t* sums) {
  const hn::ScalableTag<std::uint32_t> d;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const int step = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + step <= width; x += step) {
    const auto v = hn::PromoteTo(d, hn::LoadU(bytes, values + x)), old = hn::LoadU(d, sums + x);
    hn::StoreU(add ? hn::Add(old, v) : hn::Sub(old, v), d, sums + x);
  }
  const int sign = add ? 1 : -1;
  for (; x < width; ++x) sums[x] = static_cast<std::uint32_t>(static_cast<int>(sums[x]) + sign * values[x]);
}

HWY_ATTR void blank(const std::uint16_t* counts, int width, std::uint8_t* values) {
  const Words d;
  const hn::Rebind<std::uint8_t, Words> bytes;
  const int step = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + step <= width; x += step) {
    const auto some = hn::Min(hn::LoadU(d, counts + x), hn::Set(d, 1));
    const auto keep =
        hn::DemoteTo(bytes, hn::BitCast(hn::RebindToSigned<Words>(), hn::Mul(some, hn::Set(d, 255))));
    hn::StoreU(hn::And(hn::LoadU(bytes, values + x), keep), bytes, values + x);
  }
  for (; x < width; ++x)
    if (counts[x] == 0) values[x] = 0;
}

// (2 sum + count) / (2 count) cut off. A float holds both exactly, and the quotient is off a whole number by
// at least 1 / (2 count), far more than its rounding.
HWY_ATTR void mean(const std::uint32_t* sums, const std::uint16_t* counts, int width, std::uint8_t* out) {
  const hn::ScalableTag<float> d;
  const hn::Rebind<std::int32_t, decltype(d)> d32;
  const hn::Rebind<std::uint16_t, decltype(d)> d16;
  const hn::Rebind<std::uint8_t, decltype(d)> d8;
  const int step = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + step <= width; x += step) {
    const auto n = hn::ConvertTo(d, hn::PromoteTo(d32, hn::LoadU(d16, counts + x)));
    const auto s =
        hn::ConvertTo(d, hn::BitCast(d32, hn::LoadU(hn::Rebind<std::uint32_t, decltype(d)>(), sums + x)));
    const auto twice = hn::Add(n, n);
    const auto quotient = hn::Div(hn::Add(hn::Add(s, s), n), hn::Max(twice, hn::Set(d, 1.0F)));
    hn::StoreU(hn::DemoteTo(d8, hn::ConvertTo(d32, quotient)), d8, out + x);
  }
  for (; x < width; ++x)
    out[x] = static_cast<std::uint8_t>(counts[x] != 0 ? (2 * sums[x] + counts[x]) / (2U * counts[x]) : 0);
}

HWY_ATTR const LayerKernels& layer_kernels_of_target() {
  static constexpr LayerKernels kernels{fold, count, sum, blank, mean};
  return kernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sonoband {

HWY_EXPORT(layer_kernels_of_target);

const LayerKernels& layer_kernels() {
  return HWY_DYNAMIC_DISPATCH(layer_kernels_of_target)();
}

}  // namespace sonoband
#endif
