#include "core/review/measure.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/support/support.h"

namespace sonoband::test {
namespace {

using Eigen::Vector3d;

TEST(Measure, DistanceAndPath) {
  EXPECT_DOUBLE_EQ(distance_mm({1, 2, 3}, {1, 5, 7}), 5);
  const std::array<Vector3d, 3> chain = {{{0, 0, 0}, {3, 4, 0}, {3, 4, 12}}};
  EXPECT_DOUBLE_EQ(path_mm(chain), 17);
  EXPECT_DOUBLE_EQ(path_mm(std::span(chain).first(1)), 0);
  EXPECT_DOUBLE_EQ(path_mm({}), 0);
}

TEST(Measure, Angles) {
  EXPECT_DOUBLE_EQ(angle_deg({1, 0, 0}, {0, 0, 0}, {0, 0, 5}), 90);
  EXPECT_NEAR(angle_deg({1, 0, 0}, {0, 0, 0}, {1, std::sqrt(3.0), 0}), 60, 1e-12);
  EXPECT_DOUBLE_EQ(angle_deg({1, 0, 0}, {0, 0, 0}, {-2, 0, 0}), 180);
  EXPECT_DOUBLE_EQ(angle_deg({1, 1, 1}, {0, 0, 0}, {2, 2, 2}), 0);
  EXPECT_DOUBLE_EQ(angle_deg({0, 0, 0}, {0, 0, 0}, {2, 2, 2}), 0);
  // A thousandth of a degree is told apart from none.
  const double small = 0.001 * std::numbers::pi / 180;
  EXPECT_NEAR(angle_deg({1, 0, 0}, {0, 0, 0}, {std::cos(small), std::sin(small), 0}), 0.001, 1e-12);
}

TEST(Measure, AreaOfARectangleAndOfANotchedOne) {
  const std::array<Vector3d, 4> rectangle = {{{0, 0, 7}, {4, 0, 7}, {4, 3, 7}, {0, 3, 7}}};
  EXPECT_DOUBLE_EQ(area_mm2(rectangle), 12);
  // An L: concave, so a fan from its first corner leaves it.
  const std::array<Vector3d, 6> notched = {
      {{4, 0, 0}, {4, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}, {0, 0, 0}}};
  EXPECT_DOUBLE_EQ(area_mm2(notched), 6);
  EXPECT_DOUBLE_EQ(area_mm2(std::span(rectangle).first(2)), 0);
}

TEST(Measure, AreaDoesNotDependOnWhereItLies) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> far(-300, 300);
  std::vector<Vector3d> circle;
  constexpr int corners = 90;
  for (int i = 0; i < corners; ++i) {
    const double a = 2 * std::numbers::pi * i / corners;
    circle.emplace_back(10 * std::cos(a), 10 * std::sin(a), 0);
  }
  const double expected = 0.5 * corners * 100 * std::sin(2 * std::numbers::pi / corners);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Matrix3d turn = random_rotation(random);
    const Vector3d shift(far(random), far(random), far(random));
    std::vector<Vector3d> moved;
    for (const Vector3d& p : circle) moved.push_back(turn * p + shift);
    EXPECT_NEAR(area_mm2(moved), expected, 1e-9);
  }
}

}  // namespace
}  // namespace sonoband::test
