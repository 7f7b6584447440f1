// A small sweep, what is asked of it, and how bands compare.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "app/screen/render_worker.h"
#include "tests/support/test_sweep.h"

namespace sonoband::test::render {

inline constexpr double pixel_mm = 0.5;

// 40 B-scans of 80 x 60 pixels, 1 mm apart along z, whose greys tell where they are.
inline TestSweep make_sweep() {
  TestSweep sweep;
  for (int i = 0; i < 40; ++i) {
    sweep.add(80, 60, image_pose(Eigen::Matrix3d::Identity(), {0, 0, 1.0 * i}, pixel_mm),
              [](int, int, const Eigen::Vector3d& p) {
                return static_cast<std::uint8_t>(128 + 100 * std::sin(0.4 * p.x()) *
                                                           std::cos(0.3 * p.y() + 0.2 * p.z()));
              });
  }
  return sweep;
}

inline RenderRequest request_on(const TestSweep& sweep) {
  RenderRequest request;
  request.sweep = {sweep.view(), nullptr};
  request.sweep_version = 1;
  request.plane =
      *make_plane({20, 0, 0}, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY(), 78, 60, pixel_mm);
  request.curve_plane = request.plane;
  request.settings.band.step_mm = pixel_mm;
  request.settings.band.thickness_mm = 5;
  return request;
}

inline const std::vector<Eigen::Vector2d> bend = {{5, 10}, {15, 8}, {25, 14}, {33, 22}};

inline std::shared_ptr<const RenderResult> answer(RenderWorker& worker, const RenderRequest& request) {
  worker.ask(request);
  worker.wait();
  return worker.newest();
}

inline bool same(const BandImage& a, const BandImage& b) {
  if (a.pixels.width() != b.pixels.width() || a.pixels.height() != b.pixels.height()) return false;
  for (int y = 0; y < a.pixels.height(); ++y) {
    for (int x = 0; x < a.pixels.width(); ++x) {
      if (a.pixels.view()(x, y) != b.pixels.view()(x, y) ||
          a.coverage.view()(x, y) != b.coverage.view()(x, y))
        return false;
    }
  }
  return true;
}

inline ReslicePlane pushed(const RenderRequest& request, int steps) {
  ReslicePlane plane = request.plane;
  plane.origin = plane.origin + (steps * request.settings.band.step_mm) * plane.normal();
  return plane;
}

inline double equal_share(const BandImage& a, const BandImage& b) {
  int equal = 0;
  for (int y = 0; y < a.pixels.height(); ++y) {
    for (int x = 0; x < a.pixels.width(); ++x)
      equal += a.pixels.view()(x, y) == b.pixels.view()(x, y) ? 1 : 0;
  }
  return static_cast<double>(equal) / (a.pixels.width() * a.pixels.height());
}

// Thick enough for layers to pay.
inline RenderRequest dragged_request(const TestSweep& sweep) {
  RenderRequest request = request_on(sweep);
  request.settings.band.thickness_mm = 10;
  request.moving = true;
  return request;
}

}  // namespace sonoband::test::render
