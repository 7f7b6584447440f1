// Band painter: blending bilinear samples of two frames, lanes that no kernel takes one by one.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/reslice/band_painter.h"
#include "core/reslice/bilinear.h"
#include "core/reslice/patch_kernels.h"

namespace sonoband {

// masks from range.low on.
void BandPainter::blend_cell(const ChainCells& cells, int cell, const PatchSite& site,
                             const LayerRange& range, LaneMask* masks) {
  const int layers = range.high - range.low;
  const auto side = [&](int member, BlendSide& out) {
    out.frame = tile_.candidates[cells.members[member]].frame;
    const ChainFrame& frame = cells.frames[member];
    out.patch = frame.frame;
    FixedPx x = frame.x_at(site, range.low) + foot_from_position;
    FixedPx y = frame.y_at(site, range.low) + foot_from_position;
    const TileDistance& z = cells.distances[member];
    for (int i = 0; i < layers; ++i, x += frame.x_per_layer, y += frame.y_per_layer) {
      out.x[i] = x;
      out.y[i] = y;
      out.z[i] = z.at(site, range.low + i);
    }
    out.z_per_sample = z.per_sample;
    out.z_per_row = z.per_row;
  };
  const int members = static_cast<int>(cells.members.size());
  if (cell > 0) side(cell - 1, side_a_);
  if (cell < members) side(cell, cell > 0 ? side_b_ : side_a_);
  blend(side_a_, cell > 0 && cell < members ? &side_b_ : nullptr, layers, masks);
}

void BandPainter::blend(BlendSide& a, BlendSide* b, int layers, LaneMask* masks) {
  // Lanes the kernel does not cover: colours, and taps the mask takes away.
  std::array<LaneMask, patch_layers> odd{};
  if (table().kind == PixelKind::doppler) {
    std::copy_n(masks, layers, odd.data());
    std::fill_n(masks, layers, LaneMask{0});
  } else if (!table().mask.empty()) {
    std::copy_n(masks, layers, odd.data());
    for (const BlendSide* s : {static_cast<const BlendSide*>(&a), static_cast<const BlendSide*>(b)}) {
      if (s == nullptr) continue;
      patch_kernels().taps_inside(*s->patch, table().mask.data, table().mask.stride, s->x.data(), s->y.data(),
                                  layers, masks);
    }
    for (int l = 0; l < layers; ++l) odd[l] &= ~masks[l];
  }
  for (int l = 0; l < layers; ++l) {
    for (LaneMask rest = odd[l]; rest != 0; rest &= rest - 1) blend_lane(a, b, l, std::countr_zero(rest));
  }
  if (b != nullptr) {
    patch_kernels().blend(tile_.grid, a.side(), b->side(), masks, layers, rule_, totals_.piece());
    return;
  }
  // Alone: blended with itself, whatever the weights.
  BlendSide& twin = side_b_;
  twin.z.fill(-1);
  twin.z_per_sample = twin.z_per_row = 0;
  LinearSide mine = a.side(), other = twin.side();
  other.frame = mine.frame;
  other.x = mine.x;
  other.y = mine.y;
  a.z.fill(0);
  mine.z_per_sample = mine.z_per_row = 0;
  patch_kernels().blend(tile_.grid, mine, other, masks, layers, rule_, totals_.piece());
}

void BandPainter::blend_lane(const BlendSide& a, const BlendSide* b, int l, int lane) {
  const auto z = [&](const BlendSide& s) {
    return static_cast<double>(s.z[l]) + static_cast<double>(s.z_per_sample) * tile_.grid.a[lane] +
           static_cast<double>(s.z_per_row) * tile_.grid.b[lane];
  };
  TapBlend taps(table());
  const auto add = [&](const BlendSide& s, double share) {
    const double x = static_cast<double>(s.x[l]) / fixed_per_px + s.patch->offset_x[lane] / 65536.0;
    const double y = static_cast<double>(s.y[l]) / fixed_per_px + s.patch->offset_y[lane] / 65536.0;
    taps.add(table().frames[s.frame], x, y, share);
  };
  const double za = std::abs(z(a)), zb = b != nullptr ? std::abs(z(*b)) : 0;
  const double share = b != nullptr && za > 0 ? zb / (za + zb) : 1;
  if (share > 0) add(a, share);
  if (share < 1) add(*b, 1 - share);
  const std::uint8_t value = taps.value();
  PatchSums& sums = totals_.piece();
  ++sums.count[lane];
  sums.extreme[lane] =
      rule_ == Rule::minimum ? std::min(sums.extreme[lane], value) : std::max(sums.extreme[lane], value);
  if (rule_ == Rule::mean_doppler && doppler::is_colour(value)) {
    ++sums.coloured[lane];
    sums.velocity[lane] = static_cast<std::int16_t>(sums.velocity[lane] + doppler::velocity(value));
  } else {
    sums.sum[lane] = static_cast<std::uint16_t>(sums.sum[lane] + value);
  }
}

// Blends the lanes of candidates a and b of which either is nearest and the other on the other side; b < 0:
// those of a with nothing there.
void BandPainter::blend_shares(const std::vector<Candidate>& candidates,
                               const std::vector<const PatchFrame*>& frames, std::size_t a, int b,
                               const LayerRange& range) {
  const Winners::Share& of_a = winners_.share(a);
  int first = std::max(of_a.first, range.low), last = std::min(of_a.last, range.high);
  if (b >= 0) {
    first = std::max(first, winners_.share(b).first);
    last = std::min(last, winners_.share(b).last);
  }
  if (first >= last) return;
  std::array<LaneMask, patch_layers> masks;
  LaneMask any = 0;
  for (int l = first; l < last; ++l) {
    LaneMask m = of_a.wins[l];
    if (b >= 0) {
      const Winners::Share& of_b = winners_.share(b);
      m = ((m & of_b.side_wins[l]) | (of_b.wins[l] & of_a.side_wins[l])) &
          (of_a.positive[l] ^ of_b.positive[l]);
    } else {
      m &= ~winners_.opposed(of_a, l);
    }
    masks[l - first] = m;
    any |= m;
  }
  if (any == 0) return;
  const auto side = [&](std::size_t c, BlendSide& out) {
    const Winners::Share& s = winners_.share(c);
    out.frame = candidates[c].frame;
    out.patch = frames[c];
    for (int l = first; l < last; ++l) {
      out.x[l - first] = s.x[l] + foot_from_position;
      out.y[l - first] = s.y[l] + foot_from_position;
      out.z[l - first] = static_cast<float>(s.z[l]);
    }
    out.z_per_sample = static_cast<float>(s.z_per_sample);
    out.z_per_row = static_cast<float>(s.z_per_row);
  };
  side(a, side_a_);
  if (b >= 0) side(b, side_b_);
  blend(side_a_, b >= 0 ? &side_b_ : nullptr, last - first, masks.data());
}

}  // namespace sonoband
