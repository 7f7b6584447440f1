#include "core/reslice/plain_painter.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "core/reslice/bilinear.h"
#include "core/reslice/compound.h"
#include "core/reslice/cull.h"
#include "core/reslice/ties.h"

namespace sonoband {
namespace {

constexpr int block_rows = 8;
constexpr int block_samples = 64;
constexpr double infinity = std::numeric_limits<double>::infinity();

// The nearest frame of some kind for each sample of a stretch of line.
struct Nearest {
  std::array<double, block_samples> distance_mm;
  std::array<int, block_samples> frame;
  void clear() {
    distance_mm.fill(infinity);
    frame.fill(-1);
  }
  // Frames come earliest first, so a tie goes to the later.
  void offer(int s, double mm, int index) {
    if (mm > distance_mm[s] + tie_mm) return;
    distance_mm[s] = std::min(mm, distance_mm[s]);
    frame[s] = index;
  }
};

class BlockPainter {
 public:
  BlockPainter(const FrameTable& table, const LineBundle& bundle, const RenderSettings& settings,
               BandImage& image)
      : table_(table), bundle_(bundle), settings_(settings), image_(image) {}

  void paint(const BundleBlock& block, const std::vector<int>& frames) {
    const BlockBox box = box_of(bundle_, block);
    if (box.empty) return;
    cull(table_, frames, box.box, settings_.interpolation, candidates_);
    if (candidates_.empty()) return;
    std::vector<int> kept;
    for (const Candidate& c : candidates_) kept.push_back(c.frame);
    for (int row = block.row_begin; row < block.row_end; ++row) paint_row(block, row, kept);
  }

 private:
  void paint_row(const BundleBlock& block, int row, const std::vector<int>& frames) {
    const int count = block.sample_end - block.sample_begin;
    std::array<std::uint8_t, block_samples> extreme;
    extreme.fill(settings_.compounding == Compounding::minimum ? 255 : 0);
    std::array<MeanSums, block_samples> sums{};
    std::uint16_t* coverage = image_.coverage.view().row(row) + block.sample_begin;
    for (int layer = 0; layer < bundle_.layers; ++layer) {
      const std::size_t line = static_cast<std::size_t>(row) * bundle_.layers + layer;
      if (!bundle_.present.empty() && bundle_.present[line] == 0) continue;
      const Eigen::Vector3d start = bundle_.starts[line].v + block.sample_begin * bundle_.step.v;
      find_nearest(start, count, frames);
      for (int s = 0; s < count; ++s) {
        if (any_.frame[s] < 0) continue;
        ++coverage[s];
        const std::uint8_t value = sample(start + s * bundle_.step.v, s);
        switch (settings_.compounding) {
          case Compounding::maximum:
            extreme[s] = std::max(extreme[s], value);
            break;
          case Compounding::minimum:
            extreme[s] = std::min(extreme[s], value);
            break;
          case Compounding::mean:
            sums[s].add(value, table_.kind);
            break;
        }
      }
    }
    std::uint8_t* pixels = image_.pixels.view().row(row) + block.sample_begin;
    for (int s = 0; s < count; ++s) {
      if (coverage[s] == 0) continue;
      pixels[s] = settings_.compounding == Compounding::mean ? sums[s].value() : extreme[s];
    }
  }

  void find_nearest(const Eigen::Vector3d& start, int count, const std::vector<int>& frames) {
    any_.clear();
    above_.clear();
    below_.clear();
    const bool linear = settings_.interpolation == Interpolation::linear;
    for (const int i : frames) {
      const FrameEntry& f = table_.frames[i];
      const double x0 = f.x_px.at(start) + 0.5 + tie_px, y0 = f.y_px.at(start) + 0.5 + tie_px;
      const double z0 = f.z_mm.at(start);
      const double dx = f.x_px.gradient.dot(bundle_.step.v), dy = f.y_px.gradient.dot(bundle_.step.v);
      const double dz = f.z_mm.gradient.dot(bundle_.step.v);
      const double reach = (linear ? 2 : 1) * f.gap_mm + tie_mm;
      for (int s = 0; s < count; ++s) {
        const double z = z0 + s * dz, mm = std::abs(z);
        if (mm > reach) continue;
        const double x = x0 + s * dx, y = y0 + s * dy;
        if (!(x >= 0 && y >= 0 && x < f.width && y < f.height)) continue;
        if (!table_.mask.empty() && table_.mask(static_cast<int>(x), static_cast<int>(y)) == 0) continue;
        if (mm <= f.gap_mm + tie_mm) any_.offer(s, mm, i);
        if (linear) (is_below(f, z) ? below_ : above_).offer(s, mm, i);
      }
    }
  }

  static bool is_below(const FrameEntry& f, double z) { return (f.flipped ? -z : z) < 0; }

  std::uint8_t sample(const Eigen::Vector3d& p, int s) const {
    const FrameEntry& a = table_.frames[any_.frame[s]];
    const double x = a.x_px.at(p), y = a.y_px.at(p);
    if (settings_.interpolation == Interpolation::nearest) {
      return a.pixels[static_cast<int>(y + 0.5 + tie_px) * a.stride + static_cast<int>(x + 0.5 + tie_px)];
    }
    const Nearest& other = is_below(a, a.z_mm.at(p)) ? above_ : below_;
    const double za = any_.distance_mm[s], zb = other.frame[s] < 0 ? 0 : other.distance_mm[s];
    const double share = za > 0 && other.frame[s] >= 0 ? zb / (za + zb) : 1;
    TapBlend blend(table_);
    blend.add(a, x, y, share);
    if (share < 1) {
      const FrameEntry& b = table_.frames[other.frame[s]];
      blend.add(b, b.x_px.at(p), b.y_px.at(p), 1 - share);
    }
    return blend.value();
  }

  const FrameTable& table_;
  const LineBundle& bundle_;
  const RenderSettings& settings_;
  BandImage& image_;
  Nearest any_, above_, below_;
  std::vector<Candidate> candidates_;
};

}  // namespace

void paint_plainly(const FrameTable& table, const LineBundle& bundle, const RenderSettings& settings,
                   Parallel& parallel, const std::atomic<bool>* stop, BandImage& image) {
  std::vector<int> all(table.frames.size());
  std::iota(all.begin(), all.end(), 0);
  parallel.for_each((bundle.rows + block_rows - 1) / block_rows, [&](int b) {
    if (stop != nullptr && stop->load(std::memory_order_relaxed)) return;
    const BundleBlock rows{b * block_rows, std::min((b + 1) * block_rows, bundle.rows), 0, bundle.samples};
    const BlockBox box = box_of(bundle, rows);
    if (box.empty) return;
    std::vector<Candidate> candidates;
    cull(table, all, box.box, settings.interpolation, candidates);
    std::vector<int> near;
    for (const Candidate& c : candidates) near.push_back(c.frame);
    BlockPainter painter(table, bundle, settings, image);
    for (int s = 0; s < bundle.samples; s += block_samples)
      painter.paint({rows.row_begin, rows.row_end, s, std::min(s + block_samples, bundle.samples)}, near);
  });
}

}  // namespace sonoband
