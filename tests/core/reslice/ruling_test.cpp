// Curved bundles of lines through a sweep like a hand's: the kernel against the definition, and every
// instruction set against the others.
#include <gtest/gtest.h>

#include <cmath>

#include "core/reslice/patch_kernels.h"
#include "tests/core/reslice/compare.h"
#include "tests/core/reslice/only_target.h"
#include "tests/core/reslice/random_geometry.h"
#include "tests/core/reslice/reference.h"
#include "tests/support/speed_sweep.h"

namespace sonoband {
namespace {

test::TestSweep hand_sweep() {
  test::SpeedSweepOptions options;
  options.frames = 40;
  options.width = 100;
  options.height = 90;
  options.length_mm = 20;
  return test::speed_sweep(options);
}

// Lines along `along` through an arc of 30 mm radius in the plane of `across` and `deep`, layers beside it.
LineBundle arc(const Eigen::Vector3d& along, const Eigen::Vector3d& across, const Eigen::Vector3d& deep,
               bool gaps) {
  constexpr double mm = 0.2, radius_mm = 30;
  LineBundle bundle;
  bundle.samples = 75;
  bundle.rows = 61;
  bundle.layers = 19;
  bundle.step = {mm * along};
  const Eigen::Vector3d middle(0, 9, 10);
  for (int row = 0; row < bundle.rows; ++row) {
    const double angle = (row - 30) * mm / radius_mm;
    for (int l = 0; l < bundle.layers; ++l) {
      const double r = radius_mm + (l - 9) * mm;
      bundle.starts.push_back({middle + r * std::sin(angle) * across +
                               (r * std::cos(angle) - radius_mm) * deep - 37.3 * mm * along});
      if (gaps) bundle.present.push_back((row + l) % 7 == 0 ? 0 : 1);
    }
  }
  return bundle;
}

std::vector<LineBundle> arcs() {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d slant = (x + z).normalized(), beside = (x - z).normalized();
  return {arc(y, x, z, false),  arc(-y, z, x, true),         arc(z, y, x, false),
          arc(-x, z, y, false), arc(slant, beside, y, true), arc(-y, slant, beside, false)};
}

TEST(CurvedBundle, NearestEqualsTheDefinitionButForTies) {
  const test::TestSweep sweep = hand_sweep();
  Serial serial;
  test::Difference sum;
  for (const LineBundle& bundle : arcs()) {
    for (const auto how : {Compounding::maximum, Compounding::minimum, Compounding::mean}) {
      RenderSettings settings;
      settings.compounding = how;
      const test::Difference d = test::compare(render_lines(sweep.view(), bundle, settings, serial),
                                               test::reference_lines(sweep.view(), bundle, settings));
      EXPECT_GE(d.equal_share(), 0.998) << d.unequal << " of " << d.pixels;
      sum.pixels += d.pixels;
      sum.unequal += d.unequal;
    }
  }
  EXPECT_GE(sum.equal_share(), 0.999) << sum.unequal << " of " << sum.pixels;
}

TEST(CurvedBundle, LinearIsWithinALevelOfTheDefinition) {
  const test::TestSweep sweep = hand_sweep();
  Serial serial;
  test::Difference sum;
  for (const LineBundle& bundle : arcs()) {
    for (const auto how : {Compounding::maximum, Compounding::mean}) {
      RenderSettings settings;
      settings.compounding = how;
      settings.interpolation = Interpolation::linear;
      const test::Difference d = test::compare(render_lines(sweep.view(), bundle, settings, serial),
                                               test::reference_lines(sweep.view(), bundle, settings));
      sum.pixels += d.pixels;
      sum.beyond_one_level += d.beyond_one_level;
    }
  }
  EXPECT_GE(sum.close_share(), 0.999) << sum.beyond_one_level << " of " << sum.pixels;
}

// Crossing frames, several sweeps, masks, gaps, odd sizes, Doppler; lines bent and some of them missing.
TEST(CurvedBundle, InAnySceneNearestDiffersByTiesAloneAndLinearByALevel) {
  Serial serial;
  test::Difference linear;
  for (unsigned seed = 2000; seed < 2024; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    if (scene.settings.compounding == Compounding::mean) scene.settings.compounding = Compounding::minimum;
    LineBundle bundle = plane_lines(scene.plane, scene.settings.band);
    const Eigen::Vector3d n = scene.plane.normal().v;
    for (int row = 0; row < bundle.rows; ++row)
      for (int l = 0; l < bundle.layers; ++l)
        bundle.starts[row * bundle.layers + l].v += 2 * std::sin(0.2 * row) * n;
    bundle.present.assign(bundle.starts.size(), 1);
    for (std::size_t i = 0; i < bundle.present.size(); i += 5) bundle.present[i] = 0;
    const SweepView view = scene.sweep.view();
    EXPECT_EQ(
        test::beyond_ties(view, bundle, scene.settings, render_lines(view, bundle, scene.settings, serial)),
        0)
        << "seed " << seed;
    scene.settings.interpolation = Interpolation::linear;
    const test::Difference d = test::compare(render_lines(view, bundle, scene.settings, serial),
                                             test::reference_lines(view, bundle, scene.settings));
    linear.pixels += d.pixels;
    linear.beyond_one_level += d.beyond_one_level;
  }
  EXPECT_GE(linear.close_share(), 0.999) << linear.beyond_one_level << " of " << linear.pixels;
}

TEST(CurvedBundle, SameBitsWhateverOrderItsTasksTake) {
  class Backwards final : public Parallel {
   public:
    int width() const override { return 3; }
    void for_each(int count, const std::function<void(int)>& body) override {
      tasks += count;
      for (int i = count; i-- > 0;) body(i);
    }
    int tasks = 0;
  };
  const test::TestSweep sweep = hand_sweep();
  Serial serial;
  for (const Interpolation how : {Interpolation::nearest, Interpolation::linear}) {
    RenderSettings settings;
    settings.interpolation = how;
    for (const LineBundle& bundle : arcs()) {
      Backwards backwards;
      EXPECT_TRUE(test::same_bits(render_lines(sweep.view(), bundle, settings, serial),
                                  render_lines(sweep.view(), bundle, settings, backwards)));
      EXPECT_GT(backwards.tasks, 1);
    }
  }
}

TEST(CurvedBundle, EveryInstructionSetPaintsTheSame) {
  const test::TestSweep sweep = hand_sweep();
  Serial serial;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    for (const LineBundle& bundle : arcs()) {
      RenderSettings settings;
      const BandImage best = render_lines(sweep.view(), bundle, settings, serial);
      const test::OnlyTarget only(target);
      EXPECT_EQ(patch_kernels().target, target);
      const BandImage image = render_lines(sweep.view(), bundle, settings, serial);
      EXPECT_GE(test::compare(best, image).equal_share(), 0.999) << hwy::TargetName(target);
    }
  }
}

}  // namespace
}  // namespace sonoband
