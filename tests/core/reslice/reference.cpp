#include "tests/core/reslice/reference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/image/doppler.h"
#include "core/reslice/ties.h"

namespace sonoband::test {
namespace {

bool later(const TrackedFrame& a, const TrackedFrame& b) {
  if (a.captured != b.captured) return a.captured > b.captured;
  if (a.sweep_id != b.sweep_id) return a.sweep_id > b.sweep_id;
  return a.sequence > b.sequence;
}

bool in_picture(const SweepView& sweep, const TrackedFrame& f, double x, double y) {
  if (!(x >= 0 && y >= 0 && x < f.bscan.pixels.width && y < f.bscan.pixels.height)) return false;
  return sweep.mask.empty() || sweep.mask(static_cast<int>(x), static_cast<int>(y)) != 0;
}

struct Foot {
  const TrackedFrame* frame = nullptr;
  double x = 0, y = 0;  // px
  double z = 0;         // mm, along the common orientation
  double gap = 0;       // d, mm
  double pixel_x() const { return std::floor(x + 0.5 + tie_px); }
  double pixel_y() const { return std::floor(y + 0.5 + tie_px); }
};

// Feet of one point on all frames.
class Sweep {
 public:
  Sweep(const SweepView& view, const GapLimit& gap) : view_(view), gaps_(gap_limits(view, gap)) {
    const TrackedFrame* earliest = nullptr;
    for (const TrackedFrame* f : view.frames)
      if (earliest == nullptr || later(*earliest, *f)) earliest = f;
    for (const TrackedFrame* f : view.frames)
      signs_.push_back(mean_normal(f->sweep_id).dot(mean_normal(earliest->sweep_id)) < 0 ? -1.0 : 1.0);
  }
  const SweepView& view() const { return view_; }
  std::vector<Foot> feet(const Eigen::Vector3d& p) const {
    std::vector<Foot> all;
    for (std::size_t i = 0; i < view_.frames.size(); ++i) {
      const Eigen::Vector3d q = (view_.frames[i]->image_from_world * Point<frame::World>{p}).v;
      all.push_back({view_.frames[i], q.x(), q.y(), signs_[i] * q.z(), gaps_[i]});
    }
    return all;
  }

 private:
  Eigen::Vector3d mean_normal(int sweep_id) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const TrackedFrame* f : view_.frames)
      if (f->sweep_id == sweep_id) sum += f->world_from_image.linear.col(2);
    return sum;
  }
  SweepView view_;
  std::vector<double> gaps_;
  std::vector<double> signs_;
};

// The nearest of `feet` within `reach` x gap that contains its foot and satisfies `admitted`.
template <class Admitted>
std::optional<Foot> nearest_foot(const SweepView& sweep, const std::vector<Foot>& feet, double reach,
                                 Admitted admitted) {
  double smallest = std::numeric_limits<double>::infinity();
  const auto candidate = [&](const Foot& f) {
    return std::abs(f.z) <= reach * f.gap + tie_mm && in_picture(sweep, *f.frame, f.pixel_x(), f.pixel_y()) &&
           admitted(f);
  };
  for (const Foot& f : feet)
    if (candidate(f)) smallest = std::min(smallest, std::abs(f.z));
  std::optional<Foot> best;
  for (const Foot& f : feet) {
    if (!candidate(f) || std::abs(f.z) > smallest + tie_mm) continue;
    if (!best || later(*f.frame, *best->frame)) best = f;
  }
  return best;
}

struct Tap {
  std::uint8_t value = 0;
  double weight = 0;
};

// Bilinear taps at the foot with weights that sum to `share`.
void add_taps(const SweepView& sweep, const Foot& f, double share, std::vector<Tap>& taps) {
  const double x0 = std::floor(f.x), y0 = std::floor(f.y);
  double sum = 0;
  const std::size_t first = taps.size();
  for (const double dy : {0.0, 1.0}) {
    for (const double dx : {0.0, 1.0}) {
      if (!in_picture(sweep, *f.frame, x0 + dx, y0 + dy)) continue;
      const double weight = (1 - std::abs(f.x - x0 - dx)) * (1 - std::abs(f.y - y0 - dy));
      taps.push_back({f.frame->bscan.pixels(static_cast<int>(x0 + dx), static_cast<int>(y0 + dy)), weight});
      sum += weight;
    }
  }
  for (std::size_t i = first; i < taps.size(); ++i) taps[i].weight *= share / sum;
}

std::uint8_t blend(const std::vector<Tap>& taps, PixelKind kind) {
  double coloured = 0, velocity = 0, grey_weight = 0, grey = 0;
  for (const Tap& t : taps) {
    if (kind == PixelKind::doppler && doppler::is_colour(t.value)) {
      coloured += t.weight;
      velocity += t.weight * doppler::velocity(t.value);
    } else {
      grey_weight += t.weight;
      grey += t.weight * t.value;
    }
  }
  if (coloured >= 0.5 - 1e-9) return doppler::velocity_key(static_cast<int>(std::round(velocity / coloured)));
  return static_cast<std::uint8_t>(std::floor(grey / grey_weight + 0.5 + 1e-9));
}

std::optional<std::uint8_t> sample(const Sweep& sweep, const Eigen::Vector3d& p,
                                   Interpolation interpolation) {
  const std::vector<Foot> feet = sweep.feet(p);
  const auto a = nearest_foot(sweep.view(), feet, 1, [](const Foot&) { return true; });
  if (!a) return std::nullopt;
  if (interpolation == Interpolation::nearest) {
    return a->frame->bscan.pixels(static_cast<int>(a->pixel_x()), static_cast<int>(a->pixel_y()));
  }
  const auto b = nearest_foot(sweep.view(), feet, 2, [&](const Foot& f) { return (f.z < 0) != (a->z < 0); });
  const double za = std::abs(a->z), zb = b ? std::abs(b->z) : 0;
  std::vector<Tap> taps;
  const double share = b && za + zb > 0 ? zb / (za + zb) : 1;
  add_taps(sweep.view(), *a, share, taps);
  if (share < 1) add_taps(sweep.view(), *b, 1 - share, taps);
  return blend(taps, a->frame->bscan.kind);
}

int rounded_mean(int sum, int count) {
  return static_cast<int>(std::floor(static_cast<double>(sum) / count + 0.5));
}

// Of `count` samples, `greys` of them without colour.
std::uint8_t mean(int velocity, int grey, int greys, int count) {
  if (greys < count) {
    const int level = static_cast<int>(std::round(static_cast<double>(velocity) / count));
    if (level != 0) return doppler::velocity_key(level);
  }
  return static_cast<std::uint8_t>(greys > 0 ? rounded_mean(grey, greys) : 0);
}

std::uint8_t compound(const std::vector<std::uint8_t>& samples, Compounding how, PixelKind kind) {
  if (how == Compounding::maximum) return *std::max_element(samples.begin(), samples.end());
  if (how == Compounding::minimum) return *std::min_element(samples.begin(), samples.end());
  int velocity = 0, grey = 0, greys = 0;
  for (const std::uint8_t s : samples) {
    if (kind == PixelKind::doppler && doppler::is_colour(s)) {
      velocity += doppler::velocity(s);
    } else {
      grey += s;
      ++greys;
    }
  }
  return mean(velocity, grey, greys, static_cast<int>(samples.size()));
}

template <class Body>  // body(x, row, layer, point)
void for_each_sample(const LineBundle& bundle, int x, int row, Body body) {
  for (int l = 0; l < bundle.layers; ++l) {
    const std::size_t line = static_cast<std::size_t>(row) * bundle.layers + l;
    if (!bundle.present.empty() && bundle.present[line] == 0) continue;
    body(Eigen::Vector3d(bundle.starts[line].v + x * bundle.step.v));
  }
}

// What a sample may be when every foot may err by `px` and every distance by `mm`.
struct TiedSample {
  std::vector<std::uint8_t> values;
  bool absent = false;  // it may be, too
};
TiedSample tied_sample(const Sweep& sweep, const Eigen::Vector3d& p, double px, double mm) {
  const auto options = [&](double at) {
    std::vector<double> pixels{std::floor(at + 0.5 - px)};
    if (std::floor(at + 0.5 + px) != pixels[0]) pixels.push_back(pixels[0] + 1);
    return pixels;
  };
  struct Choice {
    double distance;
    std::vector<std::uint8_t> values;
  };
  std::vector<Choice> choices;
  double certain = std::numeric_limits<double>::infinity();
  for (const Foot& f : sweep.feet(p)) {
    if (std::abs(f.z) > f.gap + mm) continue;
    Choice choice{std::abs(f.z), {}};
    bool sure = std::abs(f.z) <= f.gap - mm;
    for (const double v : options(f.y)) {
      for (const double u : options(f.x)) {
        if (in_picture(sweep.view(), *f.frame, u, v)) {
          choice.values.push_back(f.frame->bscan.pixels(static_cast<int>(u), static_cast<int>(v)));
        } else {
          sure = false;
        }
      }
    }
    if (sure) certain = std::min(certain, choice.distance);
    if (!choice.values.empty()) choices.push_back(choice);
  }
  TiedSample sample;
  sample.absent = !std::isfinite(certain);
  for (const Choice& c : choices)
    if (c.distance <= certain + mm)
      sample.values.insert(sample.values.end(), c.values.begin(), c.values.end());
  return sample;
}

}  // namespace

BandImage reference_lines(const SweepView& view, const LineBundle& bundle, const RenderSettings& settings) {
  BandImage image{Pixels(bundle.samples, bundle.rows),
                  ImageBuffer<std::uint16_t>(bundle.samples, bundle.rows), PixelKind::grey};
  if (view.frames.empty()) return image;
  image.kind = view.frames.front()->bscan.kind;
  const Sweep sweep(view, settings.gap);
  for (int y = 0; y < bundle.rows; ++y) {
    for (int x = 0; x < bundle.samples; ++x) {
      std::vector<std::uint8_t> samples;
      for_each_sample(bundle, x, y, [&](const Eigen::Vector3d& p) {
        if (const auto s = sample(sweep, p, settings.interpolation)) samples.push_back(*s);
      });
      image.coverage.view()(x, y) = static_cast<std::uint16_t>(samples.size());
      if (!samples.empty()) image.pixels.view()(x, y) = compound(samples, settings.compounding, image.kind);
    }
  }
  return image;
}

BandImage reference_planar(const SweepView& sweep, const ReslicePlane& plane,
                           const RenderSettings& settings) {
  LineBundle bundle;
  bundle.samples = plane.width;
  bundle.rows = plane.height;
  bundle.layers = settings.band.layers();
  bundle.step = plane.pixel_mm * plane.right;
  for (int y = 0; y < plane.height; ++y) {
    for (int l = 0; l < bundle.layers; ++l) {
      bundle.starts.push_back(plane.origin + (y * plane.pixel_mm) * plane.down +
                              settings.band.offset_mm(l) * plane.normal());
    }
  }
  return reference_lines(sweep, bundle, settings);
}

TieRange reference_ties(const SweepView& view, const LineBundle& bundle, const RenderSettings& settings,
                        double px, double mm) {
  const int w = bundle.samples, h = bundle.rows;
  TieRange range{Pixels(w, h), Pixels(w, h), ImageBuffer<std::uint16_t>(w, h),
                 ImageBuffer<std::uint16_t>(w, h)};
  if (view.frames.empty()) return range;
  const Sweep sweep(view, settings.gap);
  const PixelKind kind = view.frames.front()->bscan.kind;
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      // Of a sample that may also be absent, both ends of the range try with and without.
      std::vector<std::uint8_t> low, high, low_always, high_always;
      for_each_sample(bundle, x, y, [&](const Eigen::Vector3d& p) {
        const TiedSample sample = tied_sample(sweep, p, px, mm);
        if (sample.values.empty()) return;
        const auto [lo, hi] = std::minmax_element(sample.values.begin(), sample.values.end());
        low.push_back(*lo);
        high.push_back(*hi);
        if (!sample.absent) {
          low_always.push_back(*lo);
          high_always.push_back(*hi);
        }
      });
      range.least_coverage.view()(x, y) = static_cast<std::uint16_t>(low_always.size());
      range.most_coverage.view()(x, y) = static_cast<std::uint16_t>(low.size());
      const auto extreme = [&](const auto& all, const auto& sure, bool highest) -> std::uint8_t {
        std::uint8_t best = highest ? 0 : 255;
        for (const auto* s : {&all, &sure}) {
          const std::uint8_t v = s->empty() ? 0 : compound(*s, settings.compounding, kind);
          best = highest ? std::max(best, v) : std::min(best, v);
        }
        return best;
      };
      range.lowest.view()(x, y) = extreme(low, low_always, false);
      range.highest.view()(x, y) = extreme(high, high_always, true);
    }
  }
  return range;
}

std::set<std::pair<int, int>> reference_tied_means(const SweepView& view, const LineBundle& bundle,
                                                   const GapLimit& gap, int x, int row, double px,
                                                   double mm) {
  const Sweep sweep(view, gap);
  const PixelKind kind = view.frames.front()->bscan.kind;
  struct Sums {
    int velocity = 0, grey = 0, greys = 0, count = 0;
    auto operator<=>(const Sums&) const = default;  // NOLINT(modernize-use-nullptr)
  };
  std::set<Sums> reached{Sums{}};
  for_each_sample(bundle, x, row, [&](const Eigen::Vector3d& p) {
    const TiedSample sample = tied_sample(sweep, p, px, mm);
    if (sample.values.empty()) return;
    std::set<Sums> next;
    for (const Sums& s : reached) {
      if (sample.absent) next.insert(s);
      for (const std::uint8_t v : sample.values) {
        const bool colour = kind == PixelKind::doppler && doppler::is_colour(v);
        next.insert({s.velocity + (colour ? doppler::velocity(v) : 0), s.grey + (colour ? 0 : v),
                     s.greys + (colour ? 0 : 1), s.count + 1});
      }
    }
    reached = std::move(next);
  });
  std::set<std::pair<int, int>> results;
  for (const Sums& s : reached)
    results.insert({s.count > 0 ? mean(s.velocity, s.grey, s.greys, s.count) : 0, s.count});
  return results;
}

int beyond_ties(const SweepView& sweep, const LineBundle& bundle, const RenderSettings& settings,
                const BandImage& image) {
  const TieRange ties = reference_ties(sweep, bundle, settings, 1e-4, 1e-4);
  int beyond = 0;
  for (int y = 0; y < bundle.rows; ++y) {
    for (int x = 0; x < bundle.samples; ++x) {
      const int value = image.pixels.view()(x, y), covered = image.coverage.view()(x, y);
      const bool tied = value >= ties.lowest.view()(x, y) && value <= ties.highest.view()(x, y) &&
                        covered >= ties.least_coverage.view()(x, y) &&
                        covered <= ties.most_coverage.view()(x, y);
      beyond += tied ? 0 : 1;
    }
  }
  return beyond;
}

int beyond_ties(const SweepView& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                const BandImage& image) {
  return beyond_ties(sweep, plane_lines(plane, settings.band), settings, image);
}

}  // namespace sonoband::test
