// Eight samples of eight lines each, whose feet follow no lattice from line to line. Included once per
// target.
// clang-format off
#if defined(SONOBAND_PATCH_RULINGS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_RULINGS_INL_H
#undef SONOBAND_PATCH_RULINGS_INL_H
#else
#define SONOBAND_PATCH_RULINGS_INL_H
#endif
// clang-format on

#include "core/reslice/patch_plain-inl.h"
#if HWY_TARGET == HWY_AVX3_DL
#include "core/reslice/patch_vbmi-inl.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

HWY_ATTR inline void find_changes(const RulingCondition& condition, RulingChange* changes) {
  const hn::CappedTag<double, 8> d;
  const hn::Rebind<std::int32_t, decltype(d)> d32;
  const bool rising = condition.per_sample >= 0;
  // A value that hardly changes along a line changes its sign beyond the end.
  const auto inverse = hn::Set(d, (rising ? -1 : 1) / std::max(std::abs(condition.per_sample), 1e-20));
  const auto offset = hn::Set(d, condition.offset);
  const auto least = hn::Set(d, rising ? 0.0 : -1.0), most = hn::Set(d, condition.samples + 1.0);
  for (int l = 0; l < condition.layers; ++l) {
    const double* first = condition.first[l].of.data();
    const double* second = condition.second != nullptr ? condition.second[l].of.data() : nullptr;
    alignas(32) std::int32_t at[8];
    for (std::size_t r = 0; r < 8; r += hn::Lanes(d)) {
      auto value = hn::Load(d, first + r);
      if (second != nullptr) value = hn::Add(value, hn::Load(d, second + r));
      const auto crossing = hn::Min(hn::Max(hn::Mul(hn::Add(value, offset), inverse), least), most);
      // The first sample from the crossing on; or the first beyond it.
      const auto sample = rising ? hn::Ceil(crossing) : hn::Add(hn::Floor(crossing), hn::Set(d, 1.0));
      hn::Store(hn::DemoteTo(d32, sample), d32, at + r);
    }
    unsigned begun = 0, beyond = 0;  // lines that change at their first sample; beyond their last
    for (int r = 0; r < 8; ++r) {
      changes[l].at[r] = static_cast<std::int16_t>(at[r]);
      begun |= (at[r] <= 0 ? 1U : 0U) << r;
      beyond |= (at[r] >= condition.samples ? 1U : 0U) << r;
    }
    changes[l].everywhere = static_cast<std::uint8_t>(rising ? begun : beyond);
    changes[l].nowhere = static_cast<std::uint8_t>(rising ? beyond : begun);
  }
}

// Lane by lane: any instruction set, any spread of the lines.
template <Rule rule>
HWY_ATTR void take_ruling_lanes(const RulingCell& cell, const RulingLayer& layer, int sample, LaneMask mask,
                                PatchSums& sums) {
  const PatchFrame& f = *cell.frame;
  alignas(64) std::uint8_t values[patch_lanes] = {};
  for (int k = 0; k < patch_lanes; ++k) {
    if (((mask >> k) & 1) == 0) continue;
    const auto at_x = static_cast<std::int32_t>((layer.x[k / 8] + sample * cell.x_per_sample) >> 16);
    const auto at_y = static_cast<std::int32_t>((layer.y[k / 8] + sample * cell.y_per_sample) >> 16);
    const int px = std::clamp((at_x + f.offset_x[k]) >> 16, 0, f.width - 1);
    const int py = std::clamp((at_y + f.offset_y[k]) >> 16, 0, f.height - 1);
    values[k] = f.pixels[py * f.stride + px];
  }
  compound_lanes<rule>(values, mask, sums);
}

// Lanes beyond which a condition changes: lane k is sample k % 8 of line k / 8.
HWY_ATTR inline LaneMask ruling_mask(const std::int16_t* at, bool rising, int sample) {
  LaneMask from = 0;
  for (int r = 0; r < 8; ++r) {
    const int skip = std::clamp(at[r] - sample, 0, 8);
    from |= static_cast<LaneMask>((0xff << skip) & 0xff) << (8 * r);
  }
  return rising ? from : ~from;
}

#if HWY_TARGET == HWY_AVX3_DL

struct RulingTables {
  alignas(64) std::uint8_t line[64], sample[64], whole_byte[64];
  alignas(64) std::uint16_t part_word[64];
  constexpr RulingTables() : line(), sample(), whole_byte(), part_word() {
    for (int k = 0; k < 64; ++k) {
      line[k] = static_cast<std::uint8_t>(k / 8);
      sample[k] = static_cast<std::uint8_t>(k % 8);
      // Of 64-bit positions: bits 32 to 39 are whole pixels, bits 16 to 31 the part that counts.
      whole_byte[k] = static_cast<std::uint8_t>(8 * (k / 8) + 4);
      part_word[k] = static_cast<std::uint16_t>(4 * (k / 8) + 1);
    }
  }
};
inline constexpr RulingTables ruling_tables;

HWY_ATTR HWY_INLINE LaneMask ruling_mask_by_bytes(const std::int16_t* at, bool rising, int sample) {
  const __m128i left = _mm_subs_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(at)),
                                      _mm_set1_epi16(static_cast<short>(sample)));
  const __m512i bytes = _mm512_castsi128_si512(_mm_packus_epi16(left, left));
  const __m512i lanes = _mm512_permutexvar_epi8(_mm512_load_si512(ruling_tables.line), bytes);
  const LaneMask from = _mm512_cmple_epu8_mask(lanes, _mm512_load_si512(ruling_tables.sample));
  return rising ? from : ~from;
}

// One axis of a foot: lanes' whole pixels from `first` on, in bytes.
class RulingAxis {
 public:
  HWY_ATTR HWY_INLINE RulingAxis(const std::uint16_t* parts, const std::uint8_t* wholes)
      : part_low_(_mm512_load_si512(parts)),
        part_high_(_mm512_load_si512(parts + 32)),
        whole_(_mm512_load_si512(wholes)) {}
  HWY_ATTR HWY_INLINE __m512i at(__m512i positions, int first) const {
    const __m512i rest = _mm512_xor_si512(positions, _mm512_set1_epi64(-1));
    const __mmask32 low = _mm512_cmpgt_epu16_mask(
        part_low_, _mm512_permutexvar_epi16(_mm512_load_si512(ruling_tables.part_word), rest));
    const __mmask32 high = _mm512_cmpgt_epu16_mask(
        part_high_, _mm512_permutexvar_epi16(_mm512_load_si512(ruling_tables.part_word + 32), rest));
    __m512i pixel = _mm512_add_epi8(
        whole_, _mm512_permutexvar_epi8(_mm512_load_si512(ruling_tables.whole_byte), positions));
    pixel = _mm512_sub_epi8(pixel, _mm512_set1_epi8(static_cast<char>(first)));
    return _mm512_mask_add_epi8(pixel, _mm512_kunpackd(high, low), pixel, _mm512_set1_epi8(1));
  }

 private:
  __m512i part_low_, part_high_, whole_;
};

// The pixels that a layer's lanes may take.
struct RulingSpan {
  int left, right, top, bottom;
  HWY_ATTR HWY_INLINE RulingSpan(const RulingLayer& layer, const PatchFrame& f, FixedPx dx, FixedPx dy)
      : left(whole(layer.least_x + dx) + f.least_column),
        right(whole(layer.greatest_x + dx) + f.least_column + f.columns + 1),
        top(whole(layer.least_y + dy) + f.least_row),
        bottom(whole(layer.greatest_y + dy) + f.least_row + f.rows + 1) {}
  bool fits() const { return right - left <= 15 && bottom - top <= 15; }
  RulingSpan with(const RulingSpan& o) const {
    RulingSpan both = *this;
    both.left = std::min(left, o.left);
    both.right = std::max(right, o.right);
    both.top = std::min(top, o.top);
    both.bottom = std::max(bottom, o.bottom);
    return both;
  }
};

template <Rule rule>
HWY_ATTR void take_rulings_by(const RulingCell* cells, int count, const RulingLayer* layers, int sample,
                              LaneMask lanes, PatchSums& sums) {
  Gathered<rule> gathered(sums);
  for (const RulingCell* cell = cells; cell != cells + count; ++cell) {
    const PatchFrame& f = *cell->frame;
    const RulingAxis axis_x(f.part_x.data(), f.column.data()), axis_y(f.part_y.data(), f.row.data());
    const FixedPx dx = sample * cell->x_per_sample, dy = sample * cell->y_per_sample;
    // To the patch beside this one.
    const int next_x = whole(8 * cell->x_per_sample), next_y = whole(8 * cell->y_per_sample);
    const bool large = f.width >= 16 && f.height >= 16;
    __m512i window[4];
    for (__m512i& w : window) w = _mm512_setzero_si512();
    int window_left = 1 << 24, window_top = 1 << 24, window_bottom = 0;  // far from any picture at first
    for (const RulingLayer* layer = layers + cell->first; layer != layers + cell->last; ++layer) {
      LaneMask m = lanes & layer->lanes;
      if (layer->from != nullptr) m &= ruling_mask_by_bytes(layer->from, cell->from_rising, sample);
      if (layer->to != nullptr) m &= ~ruling_mask_by_bytes(layer->to, cell->to_rising, sample);
      if (m == 0) continue;
      const RulingSpan span(*layer, f, dx, dy);
      if (!large || !span.fits()) {
        gathered.store();
        take_ruling_lanes<rule>(*cell, *layer, sample, m, sums);
        gathered = Gathered<rule>(sums);
        continue;
      }
      if (span.left < window_left || span.right > window_left + 15 || span.top < window_top ||
          span.bottom > window_bottom) {
        // As many of the layers to come as fit as well.
        RulingSpan all = span;
        for (const RulingLayer* more = layer + 1; more != layers + cell->last; ++more) {
          const RulingSpan both = all.with(RulingSpan(*more, f, dx, dy));
          if (!both.fits()) break;
          all = both;
        }
        window_left = std::clamp(all.left, 0, f.width - 16);
        window_top = std::clamp(all.top, 0, f.height - 16);
        const int quarters = std::clamp((all.bottom - window_top) / 4 + 1, 1, 4);
        window_bottom = window_top + 4 * quarters - 1;
        const std::uint8_t* from = f.pixels + window_top * f.stride + window_left;
        load_rows(from, f.stride, quarters, window);
        // Memory answers while this patch is painted.
        from += next_y * f.stride + next_x;
        for (int i = 0; i < 4 * quarters; ++i, from += f.stride)
          _mm_prefetch(reinterpret_cast<const char*>(from), _MM_HINT_T0);
      }
      const __m512i x = _mm512_add_epi64(_mm512_load_si512(layer->x), _mm512_set1_epi64(dx));
      const __m512i y = _mm512_add_epi64(_mm512_load_si512(layer->y), _mm512_set1_epi64(dy));
      const __m512i fifteen = _mm512_set1_epi8(15);
      const __m512i row = _mm512_and_si512(axis_y.at(y, window_top - f.least_row), fifteen);
      const __m512i column = _mm512_and_si512(axis_x.at(x, window_left - f.least_column), fifteen);
      const __m512i index = _mm512_or_si512(_mm512_slli_epi16(row, 4), column);
      const __m512i upper = _mm512_permutex2var_epi8(window[0], index, window[1]);
      const __m512i lower = _mm512_permutex2var_epi8(window[2], index, window[3]);
      gathered.add(m, _mm512_mask_mov_epi8(upper, _mm512_movepi8_mask(index), lower));
    }
  }
  gathered.store();
}

#else

template <Rule rule>
HWY_ATTR void take_rulings_by(const RulingCell* cells, int count, const RulingLayer* layers, int sample,
                              LaneMask lanes, PatchSums& sums) {
  for (const RulingCell* cell = cells; cell != cells + count; ++cell) {
    for (const RulingLayer* layer = layers + cell->first; layer != layers + cell->last; ++layer) {
      LaneMask m = lanes & layer->lanes;
      if (layer->from != nullptr) m &= ruling_mask(layer->from, cell->from_rising, sample);
      if (layer->to != nullptr) m &= ~ruling_mask(layer->to, cell->to_rising, sample);
      if (m != 0) take_ruling_lanes<rule>(*cell, *layer, sample, m, sums);
    }
  }
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
