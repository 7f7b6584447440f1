#include "core/manifold/manifold_band.h"

#include <cassert>
#include <cmath>

namespace sonoband {

namespace {

// Rulings nearer than this share of the distance between rows are one.
constexpr double same_ruling = 1e-6;

int outermost_layer(const Band& band) {
  return (band.layers() - 1) / 2;
}

// The plane whose rows are the rulings of a straight curve.
ReslicePlane plane_along(const ReslicePlane& plane, const Curve& line, const Point<frame::World>& corner,
                         int samples, int rows) {
  const PlanePoint e = (line.vertices[1] - line.vertices[0]).normalized();
  const Eigen::Vector3d down = e.x() * plane.right.v + e.y() * plane.down.v;
  return {corner, plane.normal(), {down}, samples, rows, plane.pixel_mm};
}

}  // namespace

CurveFlow band_flow(const Curve& curve, const ReslicePlane& plane, const Band& band, FlowMethod method,
                    Parallel& parallel) {
  const FlowSettings settings{.method = method,
                              .step_mm = band.step_mm,
                              .layers = outermost_layer(band),
                              .ruling_mm = plane.pixel_mm,
                              .fronts = Fronts::outermost};
  return flow_curve(curve, settings, parallel);
}

LineBundle manifold_lines(const ReslicePlane& plane, const Curve& curve, const CurveFlow& flow,
                          double reach_mm, const Band& band) {
  const int last = outermost_layer(band);
  assert(flow.outermost() >= last);
  const int beside = static_cast<int>(std::floor(reach_mm / plane.pixel_mm + 0.5));
  const int rows = static_cast<int>(flow.rulings.size());
  const Eigen::Vector3d n = plane.normal().v;
  // Where plane mm (0, 0) is at the left edge of the picture.
  const Eigen::Vector3d left = plane.origin.v - (beside * plane.pixel_mm) * n;
  const auto start_of = [&](const PlanePoint& p) -> Point<frame::World> {
    return {left + p.x() * plane.right.v + p.y() * plane.down.v};
  };

  const bool straight = curve.edges() == 1;
  if (straight && std::abs((rows - 1) * plane.pixel_mm - length_mm(curve)) <= 1e-9 * length_mm(curve))
    return plane_lines(plane_along(plane, curve, start_of(curve.vertices[0]), 2 * beside + 1, rows), band);

  LineBundle bundle;
  bundle.samples = 2 * beside + 1;
  bundle.rows = rows;
  bundle.layers = band.layers();
  bundle.step = {plane.pixel_mm * n};
  const std::size_t lines = static_cast<std::size_t>(rows) * bundle.layers;
  bundle.starts.resize(lines);
  for (int k = -last; k <= last; ++k) {
    const auto& feet = flow.layer(k).feet;
    for (int row = 0; row < rows; ++row) {
      const std::size_t line = static_cast<std::size_t>(row) * bundle.layers + (k + last);
      if (feet[row]) {
        bundle.starts[line] = start_of(*feet[row]);
        continue;
      }
      if (bundle.present.empty()) bundle.present.assign(lines, 1);
      bundle.present[line] = 0;
    }
  }
  return bundle;
}

std::vector<std::uint8_t> smeared_rows(const CurveFlow& flow, int k) {
  const int rows = static_cast<int>(flow.rulings.size());
  std::vector<std::uint8_t> smeared(rows, 0);
  if (rows < 2) return smeared;
  const double limit = same_ruling * (flow.rulings[1].at - flow.rulings[0].at).norm();
  for (int layer = -k; layer <= k; ++layer) {
    const auto& feet = flow.layer(layer).feet;
    for (int row = 1; row < rows; ++row)
      if (feet[row] && feet[row - 1] && (*feet[row] - *feet[row - 1]).squaredNorm() <= limit * limit)
        smeared[row] = smeared[row - 1] = 255;
  }
  return smeared;
}

ManifoldBand render_manifold(const SweepView& sweep, const ReslicePlane& plane, const Curve& curve,
                             const ManifoldSettings& settings, Parallel& parallel) {
  const Band& band = settings.render.band;
  const int last = outermost_layer(band);
  CurveFlow flow = band_flow(curve, plane, band, settings.flow, parallel);
  const LineBundle lines = manifold_lines(plane, curve, flow, settings.reach_mm, band);
  ManifoldBand result{
      render_lines(sweep, lines, settings.render, parallel), smeared_rows(flow, last), {}, {}};
  result.up = std::move(flow.layers.back().front);
  result.down = std::move(flow.layers.front().front);
  if (last == 0) result.down = result.up;
  return result;
}

}  // namespace sonoband
