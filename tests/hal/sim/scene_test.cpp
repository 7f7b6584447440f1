#include "hal/sim/scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hal/sim/virtual_clock.h"

namespace sonoband::sim {
namespace {

using Eigen::Vector3d;
using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(Scene, EveryPresetBuildsAndPaints) {
  for (const std::string& name : scene_presets()) {
    const SimulatedScene scene = make_scene({.preset = name, .path = {}});
    std::vector<std::uint8_t> picture(static_cast<std::size_t>(3 * 640 * 480));
    scene.painter()(Stamp(seconds(5)), picture.data(),
                    scene.scanner.format == PixelFormat::rgb24 ? 3 * 640 : 640);
    double sum = 0;
    for (const std::uint8_t v : picture) sum += v;
    EXPECT_GT(sum / static_cast<double>(picture.size()), 5) << name;
    EXPECT_FALSE(scene.views.empty()) << name;
    for (const SuggestedView& v : scene.views) {
      EXPECT_NEAR(v.plane.right.v.norm(), 1, 1e-9);
      EXPECT_NEAR(v.plane.down.v.norm(), 1, 1e-9);
      EXPECT_NEAR(v.plane.right.v.dot(v.plane.down.v), 0, 1e-9);
      EXPECT_GT(v.plane.width, 100);
    }
  }
}

// What the whole cart rests on: a pixel of a frame stamped `captured` shows the phantom where the tracker's
// pose of captured - latency and the calibration put it. The sign of the latency is in it.
TEST(Scene, PixelsAgreeWithPosesCalibrationAndLatency) {
  SceneSettings settings{.preset = "ramp", .path = {}};
  settings.path.speed_mm_s = 30;
  const SimulatedScene scene = make_scene(settings);
  scene.hand->begin(Stamp(seconds(10)));
  const Stamp captured = Stamp(seconds(10)) + milliseconds(3000);  // amid the sweep
  std::vector<std::uint8_t> picture(static_cast<std::size_t>(640 * 480));
  scene.painter()(captured, picture.data(), 640);

  const auto predicted = [&](Stamp pose_time, int x, int y) {
    const TrackerFromProbe pose = scene.hand->tracker_from_probe(pose_time);
    const Point<frame::Probe> p_probe = scene.probe_from_image * Point<frame::Image>{Vector3d(x, y, 0)};
    const Vector3d world = (pose * p_probe).v;
    const Vector3d p = (scene.world_from_phantom.inverse() * Point<frame::World>{world}).v;
    return 128 + Vector3d(0.5, -0.6, 0.4).dot(p);
  };
  double wrong_sign = 0;
  for (int y = 0; y < 480; y += 60) {
    for (int x = 0; x < 640; x += 64) {
      const double grey = picture[static_cast<std::size_t>(y) * 640 + static_cast<std::size_t>(x)];
      EXPECT_NEAR(grey, predicted(captured - scene.scanner_latency, x, y), 0.5001);
      wrong_sign += std::abs(grey - predicted(captured + scene.scanner_latency, x, y)) / 80;
    }
  }
  EXPECT_GT(wrong_sign, 1);  // 160 ms at 33 mm/s and 0.4 grey a mm: 2 levels
}

TEST(Scene, TheHandWaitsForThePedalAndDoesNotJump) {
  const SimulatedScene scene = make_scene({.preset = "constant", .path = {}});
  const auto z = [&](Stamp t) {
    return (scene.world_from_phantom.inverse() * scene.hand->world_from_face(t)).translation.z();
  };
  EXPECT_NEAR(z(Stamp(seconds(100))), -50, 1.5);
  const Stamp press = Stamp(seconds(101));
  const Vector3d before = scene.hand->world_from_face(press).translation;
  scene.hand->pressed(press);
  EXPECT_LT((scene.hand->world_from_face(press).translation - before).norm(), 1e-9);
  EXPECT_NEAR(z(press + milliseconds(200)), -50, 1.5);
  EXPECT_GT(z(press + seconds(3)), -20);
  scene.hand->pressed(press + seconds(3));  // already sweeping: nothing changes
  EXPECT_GT(z(press + seconds(3)), -20);
  const Stamp again = press + scene.hand->path().duration() + seconds(1);
  EXPECT_NEAR(z(again), -50, 1.5);
  scene.hand->pressed(again);
  EXPECT_GT(z(again + seconds(3)), -20);
}

TEST(Scene, FramesComeFromTheSceneThroughTheSource) {
  const SimulatedScene scene = make_scene({.preset = "ramp", .path = {}});
  VirtualClock clock;
  SimFrameSource source(clock, scene.frame_settings(), scene.painter());
  source.start();
  Frame f;
  ASSERT_EQ(source.read(f, seconds(1)), ReadStatus::ok);
  EXPECT_EQ(f.width, 640);
  std::vector<std::uint8_t> picture(static_cast<std::size_t>(640 * 480));
  scene.painter()(f.captured, picture.data(), 640);
  EXPECT_TRUE(std::equal(picture.begin(), picture.end(), f.data));
}

}  // namespace
}  // namespace sonoband::sim
