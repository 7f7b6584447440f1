#include "hal/sim/probe_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hal/sim/random.h"

namespace sonoband::sim {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

namespace {

constexpr double degree = std::numbers::pi / 180;

// Sums of sines: wander below 1 Hz and the 8 to 12 Hz of muscles, 15 % of the whole. Deviation 1.
double tremor(std::uint64_t seed, std::uint64_t axis, double t) {
  constexpr std::array<double, 6> hz{0.13, 0.31, 0.57, 0.9, 8.3, 11.1};
  constexpr std::array<double, 6> share{0.8, 0.8, 0.6, 0.35, 0.15, 0.12};
  double sum = 0;
  for (std::size_t i = 0; i < hz.size(); ++i) {
    const double phase = 2 * std::numbers::pi * uniform(seed, axis * 16 + i);
    const double rate = hz[i] * (0.85 + 0.3 * uniform(seed + 1, axis * 16 + i));
    sum += share[i] * std::sin(2 * std::numbers::pi * rate * t + phase);
  }
  return sum;  // the shares' squares add up to 2
}

// 0 to 1 with speed 0 at the ends. A tenth of the way is taken to speed up and another to slow down, the rest
// at constant speed.
double eased(double u) {
  constexpr double ramp = 0.1;
  constexpr double top = 1 / (1 - ramp);
  if (u < ramp) return top * u * u / (2 * ramp);
  if (u > 1 - ramp) return 1 - top * (1 - u) * (1 - u) / (2 * ramp);
  return top * (u - ramp / 2);
}

}  // namespace

ProbePath::ProbePath(const PathSettings& settings, const WorldFromPhantom& world_from_phantom)
    : settings_(settings), world_from_phantom_(world_from_phantom) {
  using Kind = PathSettings::Kind;
  const double half = settings.length_mm / 2;
  const Duration along = from_seconds(settings.length_mm / settings.speed_mm_s);
  const Duration pause = std::chrono::milliseconds(1200);
  const auto start_at = [this](const Station& s) { legs_.push_back({Duration(0), Duration(0), s, s, 0}); };
  switch (settings.kind) {
    case Kind::linear:
    case Kind::reversed: {
      const double from = settings.kind == Kind::linear ? -half : half;
      start_at({{0, 0, from}, 0, 0});
      stay(settings.hover);
      sweep({{0, 0, -from}, 0, 0}, along);
      break;
    }
    case Kind::fan: {
      const double tilt = settings.fan_deg / 2;
      start_at({{0, 0, 0}, -tilt, 0});
      stay(settings.hover);
      sweep({{0, 0, 0}, tilt, 0}, from_seconds(settings.fan_deg * degree * 60 / settings.speed_mm_s));
      break;
    }
    case Kind::two_overlapping: {
      const double aside = settings.apart_mm / 2;
      start_at({{-aside, 0, -half}, 0, 3});
      stay(settings.hover);
      sweep({{-aside, 0, half}, 0, 3}, along);
      stay(settings.hover / 2);
      go({{aside, 0, half}, 0, -4}, pause, 8);
      stay(settings.hover);
      sweep({{aside, 0, -half}, 0, -4}, along);
      break;
    }
  }
  stay(settings.hover);
  const Station home = legs_.front().from;
  go(home, pause, 15);
}

void ProbePath::go(const Station& to, Duration time, double lift_mm) {
  const Leg last = legs_.back();
  legs_.push_back({last.end, last.end + time, last.to, to, lift_mm});
}

void ProbePath::stay(Duration time) {
  go(legs_.back().to, time, 0);
}

void ProbePath::sweep(const Station& to, Duration time) {
  go(to, time, 0);
  sweeps_.push_back({legs_.back().begin, legs_.back().end});
}

Duration ProbePath::duration() const {
  return legs_.back().end;
}

WorldFromFace ProbePath::world_from_face(Duration elapsed, Duration shake_time) const {
  Station at = legs_.front().from;
  if (elapsed > Duration(0) && elapsed < duration()) {
    const auto leg = std::find_if(legs_.begin(), legs_.end(), [&](const Leg& l) { return elapsed < l.end; });
    const double u = eased(seconds(elapsed - leg->begin) / seconds(leg->end - leg->begin));
    at.place = leg->from.place + u * (leg->to.place - leg->from.place);
    at.place.y() -= leg->lift_mm * 4 * u * (1 - u);
    at.tilt_deg = leg->from.tilt_deg + u * (leg->to.tilt_deg - leg->from.tilt_deg);
    at.turn_deg = leg->from.turn_deg + u * (leg->to.turn_deg - leg->from.turn_deg);
  }
  const double t = seconds(shake_time);
  const auto shake = [&](std::uint64_t axis) { return tremor(settings_.seed, axis, t); };
  at.place += settings_.tremor_mm * Vector3d(shake(0), shake(1), shake(2));
  const double wobble = settings_.tremor_deg * degree;

  Rigid<frame::Phantom, frame::Face> phantom_from_face;
  phantom_from_face.rotation = (AngleAxisd(at.turn_deg * degree + wobble * shake(3), Vector3d::UnitY()) *
                                AngleAxisd(at.tilt_deg * degree + wobble * shake(4), Vector3d::UnitX()) *
                                AngleAxisd(wobble * shake(5), Vector3d::UnitZ()))
                                   .toRotationMatrix();
  phantom_from_face.translation = at.place;
  return world_from_phantom_ * phantom_from_face;
}

Rigid<frame::Probe, frame::Face> typical_mount() {
  return {(AngleAxisd(8 * degree, Vector3d::UnitZ()) * AngleAxisd(-95 * degree, Vector3d::UnitY()) *
           AngleAxisd(20 * degree, Vector3d::UnitX()))
              .toRotationMatrix(),
          Vector3d(14.5, 96, -21)};
}

ProbeFromImage typical_calibration(const Affine<frame::Face, frame::Image>& face_from_image) {
  return typical_mount() * face_from_image;
}

}  // namespace sonoband::sim
