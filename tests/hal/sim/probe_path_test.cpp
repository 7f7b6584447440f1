#include "hal/sim/probe_path.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>

#include "hal/sim/scanner.h"

namespace sonoband::sim {
namespace {

using Kind = PathSettings::Kind;
using std::chrono::milliseconds;

PathSettings steady(Kind kind) {
  PathSettings s;
  s.kind = kind;
  s.tremor_mm = 0;
  s.tremor_deg = 0;
  return s;
}

constexpr std::array kinds{Kind::linear, Kind::fan, Kind::reversed, Kind::two_overlapping};

TEST(ProbePath, ALinearSweepIsTheStraightLineAtItsSpeed) {
  const ProbePath path(steady(Kind::linear), {});
  ASSERT_EQ(path.sweeps().size(), 1U);
  const SweepTime sweep = path.sweeps()[0];
  EXPECT_NEAR(path.world_from_face(sweep.begin).translation.z(), -50, 1e-9);
  EXPECT_NEAR(path.world_from_face(sweep.end).translation.z(), 50, 1e-9);
  const Duration middle = (sweep.begin + sweep.end) / 2;
  EXPECT_NEAR(path.world_from_face(middle).translation.norm(), 0, 1e-6);
  const Eigen::Vector3d a = path.world_from_face(middle - milliseconds(100)).translation;
  const Eigen::Vector3d b = path.world_from_face(middle + milliseconds(100)).translation;
  EXPECT_NEAR((b - a).z() / 0.2, 15 / 0.9, 1e-6);  // 15 on average, both ends slower
  EXPECT_TRUE(path.world_from_face(middle).rotation.isIdentity(1e-12));
}

TEST(ProbePath, ReversedIsTheOtherWayRound) {
  const ProbePath there(steady(Kind::linear), {});
  const ProbePath back(steady(Kind::reversed), {});
  for (int ms = 0; ms < 9000; ms += 137) {
    const Eigen::Vector3d p = there.world_from_face(milliseconds(ms)).translation;
    const Eigen::Vector3d q = back.world_from_face(milliseconds(ms)).translation;
    EXPECT_NEAR(p.z(), -q.z(), 1e-9);
  }
}

TEST(ProbePath, AFanTiltsInOnePlace) {
  const ProbePath path(steady(Kind::fan), {});
  const SweepTime sweep = path.sweeps()[0];
  const WorldFromFace a = path.world_from_face(sweep.begin);
  const WorldFromFace b = path.world_from_face(sweep.end);
  EXPECT_LT(a.translation.norm() + b.translation.norm(), 1e-9);
  const double degrees = Eigen::AngleAxisd(a.rotation.transpose() * b.rotation).angle() * 57.29577951308232;
  EXPECT_NEAR(degrees, 60, 1e-6);
}

TEST(ProbePath, TwoSweepsOverlapWithAGapBetween) {
  const ProbePath path(steady(Kind::two_overlapping), {});
  ASSERT_EQ(path.sweeps().size(), 2U);
  const SweepTime first = path.sweeps()[0];
  const SweepTime second = path.sweeps()[1];
  EXPECT_GT(second.begin - first.end, milliseconds(1000));
  const Eigen::Vector3d a = path.world_from_face((first.begin + first.end) / 2).translation;
  const Eigen::Vector3d b = path.world_from_face((second.begin + second.end) / 2).translation;
  EXPECT_NEAR((b - a).x(), 24, 1e-9);
}

TEST(ProbePath, NeverJumps) {
  for (const Kind kind : kinds) {
    PathSettings s;
    s.kind = kind;
    const ProbePath path(s, {});
    WorldFromFace last = path.world_from_face(milliseconds(-500));
    for (Duration t = milliseconds(-500); t < path.duration() + milliseconds(500); t += milliseconds(4)) {
      const WorldFromFace now = path.world_from_face(t);
      // 150 mm/s: the fastest stretch is the way home.
      EXPECT_LT((now.translation - last.translation).norm(), 0.6) << seconds(t);
      last = now;
    }
  }
}

TEST(ProbePath, TremorIsSmallSeededAndRepeatable) {
  PathSettings s;
  const ProbePath steady_path(steady(Kind::linear), {});
  const ProbePath a(s, {});
  const ProbePath b(s, {});
  s.seed = 2;
  const ProbePath c(s, {});
  double square = 0;
  double apart = 0;
  int n = 0;
  for (int ms = 0; ms < 10000; ms += 13, ++n) {
    const Eigen::Vector3d p = a.world_from_face(milliseconds(ms)).translation;
    EXPECT_EQ(p, b.world_from_face(milliseconds(ms)).translation);
    square += (p - steady_path.world_from_face(milliseconds(ms)).translation).squaredNorm() / 3;
    apart += (p - c.world_from_face(milliseconds(ms)).translation).norm();
  }
  EXPECT_NEAR(std::sqrt(square / n), 0.25, 0.1);
  EXPECT_GT(apart / n, 0.1);
}

TEST(ProbePath, PlacesThePhantomInTheWorld) {
  const WorldFromPhantom place{
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(),
      Eigen::Vector3d(300, 40, -60)};
  const ProbePath here(steady(Kind::two_overlapping), {});
  const ProbePath there(steady(Kind::two_overlapping), place);
  for (int ms = 0; ms < 20000; ms += 501) {
    const WorldFromFace expected =
        place * Rigid<frame::Phantom, frame::Face>{here.world_from_face(milliseconds(ms)).rotation,
                                                   here.world_from_face(milliseconds(ms)).translation};
    const WorldFromFace got = there.world_from_face(milliseconds(ms));
    EXPECT_TRUE(got.rotation.isApprox(expected.rotation, 1e-12));
    EXPECT_TRUE(got.translation.isApprox(expected.translation, 1e-12));
  }
}

TEST(ProbePath, TheCalibrationPutsThePictureOnTheFace) {
  const ScannerSettings s = abdominal();
  const ProbeFromImage probe_from_image = typical_calibration(face_from_image(s));
  const auto face_from_probe = typical_mount().inverse();
  const Point<frame::Image> middle_of_face{{(s.width_px - 1) / 2.0, s.face_row_px, 0}};
  EXPECT_LT((face_from_probe * (probe_from_image * middle_of_face)).v.norm(), 1e-9);
  EXPECT_NEAR(probe_from_image.linear.col(0).norm(), s.pixel_mm, 1e-12);
  EXPECT_TRUE(is_rotation(typical_mount().rotation, 1e-12));
}

}  // namespace
}  // namespace sonoband::sim
