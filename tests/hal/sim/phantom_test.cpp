#include "hal/sim/phantom.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "tests/support/support.h"

namespace sonoband::sim {
namespace {

using Eigen::Vector3f;

Vector3f random_point(std::mt19937_64& random, float reach) {
  std::uniform_real_distribution<float> u(-reach, reach);
  const float x = u(random);
  const float y = u(random);
  return {x, y, u(random)};
}

TEST(Shapes, AConeIsTheUnionOfItsBalls) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> radius(0.3F, 3);
  for (int i = 0; i < 200; ++i) {
    const Shape s =
        cone(random_point(random, 5), radius(random), random_point(random, 5), radius(random), {});
    const Vector3f p = random_point(random, 8);
    float nearest = std::numeric_limits<float>::infinity();
    for (int k = 0; k <= 4000; ++k) {
      const float h = static_cast<float>(k) / 4000;
      const float d = (p - (s.a + h * (s.b - s.a))).norm() - (s.radius + h * (s.radius_b - s.radius));
      nearest = std::min(nearest, d);
    }
    EXPECT_NEAR(s.distance(p), nearest, 2e-3F);
  }
}

TEST(Shapes, DistanceHasTheSignOfContainsAndNeverPromisesTooMuch) {
  std::mt19937_64 random(2);
  const std::vector<Shape> shapes{
      capsule({-2, 0, 1}, {3, 1, 0}, 1.2F, {}), cone({0, -3, 0}, 2, {0, 3, 1}, 0.5F, {}),
      ellipsoid({1, 1, -1}, {4, 2, 1}, {}, test::random_rotation(random).cast<float>()), slab(-1, 2, {})};
  for (const Shape& s : shapes) {
    for (int i = 0; i < 2000; ++i) {
      const Vector3f p = random_point(random, 6);
      const float d = s.distance(p);
      if (std::abs(d) < 1e-4F) continue;
      EXPECT_EQ(s.contains(p), d < 0);
      // Nothing within |d| of p is on the other side of the surface.
      const Vector3f q = p + 0.999F * std::abs(d) * random_point(random, 1).normalized();
      EXPECT_EQ(s.contains(q), s.contains(p));
    }
  }
}

TEST(Shapes, TheNormalLeadsAwayFromTheSurface) {
  std::mt19937_64 random(3);
  const std::vector<Shape> shapes{capsule({-2, 0, 1}, {3, 1, 0}, 1.2F, {}),
                                  cone({0, -3, 0}, 2, {0, 3, 1}, 0.5F, {}),
                                  ellipsoid({1, 1, -1}, {3, 3, 3}, {})};
  for (const Shape& s : shapes) {
    for (int i = 0; i < 500; ++i) {
      const Vector3f p = random_point(random, 6);
      const Vector3f n = s.normal(p);
      EXPECT_NEAR(n.norm(), 1, 1e-4F);
      if (s.distance(p) > 0.1F) {
        EXPECT_GT(s.distance(p + 0.05F * n), s.distance(p));
      }
    }
  }
}

// The definition the grid must keep: the last shape added that holds the point.
Anatomy::ShapeId slow_at(const Anatomy& body, const Vector3f& p) {
  for (std::size_t i = body.shapes().size(); i-- > 1;) {
    if (body.shapes()[i].contains(p)) return static_cast<Anatomy::ShapeId>(i);
  }
  return 0;
}

TEST(Anatomy, TheGridChangesNothing) {
  std::mt19937_64 random(4);
  for (const Anatomy& body : {foetus(), vessels()}) {
    for (int i = 0; i < 4000; ++i) {
      Vector3f p = random_point(random, 35);
      p.y() += 40;
      EXPECT_EQ(body.at(p), slow_at(body, p)) << p.transpose();
    }
  }
}

TEST(Anatomy, CalmMeansTheSameAllAround) {
  std::mt19937_64 random(5);
  const Anatomy body = foetus();
  int calm = 0;
  for (int i = 0; i < 20000; ++i) {
    Vector3f p = random_point(random, 45);
    p.y() += 45;
    const Anatomy::ShapeId* id = body.calm_at(p);
    if (id == nullptr) continue;
    ++calm;
    EXPECT_EQ(body.at(p + body.cell_mm() * random_point(random, 1).normalized()), *id);
  }
  EXPECT_GT(calm, 5000);
}

TEST(Anatomy, OutsideItsBoxIsBackground) {
  const Anatomy body({.echo_db = -1}, {ellipsoid({0, 0, 0}, {50, 50, 50}, {})}, {-1, -1, -1}, {1, 1, 1});
  EXPECT_EQ(body.at({0, 0, 0}), 1);
  EXPECT_EQ(body.at({-1.01F, 0, 0}), 0);
  EXPECT_EQ(body.at({0, 20, 0}), 0);
}

TEST(Foetus, ItsBonesFitASweepOf100MmAndTheWomb) {
  const Anatomy body = foetus();
  int bones = 0;
  for (const Shape& s : body.shapes()) {
    if (!s.material.bone) continue;
    ++bones;
    Vector3f low;
    Vector3f high;
    s.bounds(low, high);
    EXPECT_GE(low.z(), -50);
    EXPECT_LE(high.z(), 50);
    EXPECT_GE(low.y(), 12);
    EXPECT_LE(high.y(), 88);
    EXPECT_LE(high.x(), 25);
    EXPECT_GE(low.x(), -25);
  }
  EXPECT_GT(bones, 500);
}

// Figure 4 and 5 of the paper need this of the phantom: a slice of no thickness misses most bones of spine
// and legs because they weave, a slab of 14 mm has them.
TEST(Foetus, ASlabShowsFarMoreBoneThanASlice) {
  const Anatomy body = foetus();
  int slice = 0;
  int slab = 0;
  for (float y = 20; y < 80; y += 0.5F) {
    for (float z = -12; z < 50; z += 0.5F) {
      bool any = false;
      for (float x = -7; x <= 7; x += 0.5F) any = any || body.shape(body.at({x, y, z})).material.bone;
      slab += any ? 1 : 0;
      slice += body.shape(body.at({0, y, z})).material.bone ? 1 : 0;
    }
  }
  EXPECT_GT(slice, 50);
  EXPECT_GT(slab, 4 * slice);
}

// Figure 12: rulings of +-20 mm through the curve meet bone nearly all along it.
TEST(Foetus, TheCurveRunsAlongTheSkeleton) {
  const Anatomy body = foetus();
  const std::vector<Eigen::Vector2d> curve = foetus_curve();
  int with_bone = 0;
  int rulings = 0;
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    for (double u = 0; u < 1; u += 0.1) {
      const Eigen::Vector2d p = curve[i] + u * (curve[i + 1] - curve[i]);
      bool any = false;
      for (float x = -20; x <= 20; x += 0.25F) {
        const Vector3f q(x, static_cast<float>(p.x()), static_cast<float>(p.y()));
        any = any || body.shape(body.at(q)).material.bone;
      }
      with_bone += any ? 1 : 0;
      ++rulings;
    }
  }
  EXPECT_GT(with_bone, rulings * 7 / 10);
}

TEST(Vessels, TheVeinLiesBehindTheArteryAndTheArteryDivides) {
  const Anatomy body = vessels();
  // Stretches of flow along a line into the body, and across one deep enough to cross both branches.
  const auto flows = [&](float z) {
    int arteries = 0;
    bool inside = false;
    for (float x = -15; x <= 15; x += 0.1F) {
      bool artery = false;
      for (float y = 10; y < 24; y += 0.2F) {
        artery = artery || body.shape(body.at({x, y, z})).flow.peak_mm_s > 0;
      }
      arteries += artery && !inside ? 1 : 0;
      inside = artery;
    }
    return arteries;
  };
  EXPECT_EQ(flows(-40), 1);
  EXPECT_EQ(flows(25), 2);
  EXPECT_EQ(flows(55), 3);
  float first_artery = 0;
  float first_vein = 0;
  for (float y = 40; y > 5; y -= 0.1F) {
    const float v = body.shape(body.at({0, y, -20})).flow.peak_mm_s;
    if (v > 0) first_artery = y;
    if (v < 0) first_vein = y;
  }
  EXPECT_GT(first_artery, 10);
  EXPECT_GT(first_vein, first_artery + 3);
}

}  // namespace
}  // namespace sonoband::sim
