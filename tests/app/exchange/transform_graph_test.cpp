#include "app/exchange/transform_graph.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/app/exchange/sequence_samples.h"

namespace sonoband::test {
namespace {

using exchange::FrameTransform;
using exchange::TransformGraph;

Eigen::Matrix4d random_pose(std::mt19937_64& random) {
  std::uniform_real_distribution<double> mm(-100, 100);
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = random_rotation(random);
  m.topRightCorner<3, 1>() << mm(random), mm(random), mm(random);
  return m;
}

FrameTransform own(const char* from, const char* to, const Eigen::Matrix4d& m, const char* status = "OK") {
  FrameTransform t;
  t.name = {from, to};
  t.to_from_from = m;
  t.status = status;
  return t;
}

double distance(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

TEST(TransformGraph, ChainsInvertWhereNeeded) {
  std::mt19937_64 random(1);
  Eigen::Matrix4d probe_from_image = random_pose(random);
  probe_from_image.col(0) *= 0.08;
  probe_from_image.col(1) *= 0.07;
  const auto tracker_from_probe = random_pose(random);
  const auto tracker_from_reference = random_pose(random);
  const auto reference_from_phantom = random_pose(random);
  TransformGraph shared;
  shared.add({"Image", "Probe"}, probe_from_image, "plus.xml, line 1");
  shared.add({"Phantom", "Reference"}, reference_from_phantom, "plus.xml, line 2");
  const auto graph = shared.with(
      {own("Probe", "Tracker", tracker_from_probe), own("Reference", "Tracker", tracker_from_reference)},
      "frame 0");
  const auto found = graph.find("Phantom", "Image");
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->ok);
  EXPECT_LT(
      distance(found->to_from_from, reference_from_phantom.inverse() * tracker_from_reference.inverse() *
                                        tracker_from_probe * probe_from_image),
      1e-9);
  EXPECT_EQ(found->links,
            (std::vector<std::string>{"ImageToProbe", "ProbeToTracker", "inverse of ReferenceToTracker",
                                      "inverse of PhantomToReference"}));
  EXPECT_LT(distance(graph.find("Image", "Phantom")->to_from_from * found->to_from_from,
                     Eigen::Matrix4d::Identity()),
            1e-9);
  EXPECT_EQ(graph.find("Probe", "Probe")->to_from_from, Eigen::Matrix4d::Identity());
}

TEST(TransformGraph, FewestLinksWinAndAPicturesOwnComeFirst) {
  std::mt19937_64 random(2);
  const auto direct = random_pose(random);
  TransformGraph shared;
  shared.add({"Image", "Reference"}, random_pose(random), "plus.xml");
  shared.add({"Image", "Probe"}, random_pose(random), "plus.xml");
  const auto graph = shared.with(
      {own("Probe", "Reference", random_pose(random)), own("Image", "Reference", direct)}, "frame 0");
  EXPECT_EQ(graph.find("Reference", "Image")->to_from_from, direct);
}

TEST(TransformGraph, LaterConfigurationsReplaceEarlierOnesInEitherDirection) {
  std::mt19937_64 random(3);
  TransformGraph graph;
  const auto later = random_pose(random);
  graph.add({"Image", "Probe"}, random_pose(random), "a.xml");
  graph.add({"Probe", "Image"}, later, "b.xml");
  EXPECT_LT(distance(graph.find("Probe", "Image")->to_from_from, later.inverse()), 1e-12);
}

TEST(TransformGraph, OneBadLinkMakesTheChainBad) {
  std::mt19937_64 random(4);
  TransformGraph shared;
  shared.add({"Image", "Probe"}, random_pose(random), "plus.xml");
  const Eigen::Matrix4d stale = Eigen::Matrix4d::Constant(std::numeric_limits<double>::quiet_NaN());
  const auto graph = shared.with({own("Probe", "Tracker", stale, "OUT_OF_VIEW")}, "frame 0");
  const auto found = graph.find("Tracker", "Image");
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->ok);
  EXPECT_EQ(found->bad_link, "ProbeToTrackerTransform is OUT_OF_VIEW");
  EXPECT_TRUE(graph.find("Probe", "Image")->ok);
}

TEST(TransformGraph, WhatCannotBeReachedIsEmpty) {
  TransformGraph graph;
  graph.add({"Image", "Probe"}, Eigen::Matrix4d::Identity(), "plus.xml");
  EXPECT_FALSE(graph.find("World", "Image"));
  EXPECT_FALSE(graph.find("Image", "World"));
  EXPECT_EQ(graph.frames(), (std::vector<std::string>{"Image", "Probe"}));
}

struct BadLink {
  const char* name;
  const char* from;
  Eigen::Matrix4d matrix;
  const char* says;
};

std::vector<BadLink> bad_links() {
  Eigen::Matrix4d scaled = Eigen::Matrix4d::Identity();
  scaled(0, 0) = 1.01;
  Eigen::Matrix4d mirrored = Eigen::Matrix4d::Identity();
  mirrored(2, 2) = -1;
  Eigen::Matrix4d nan = Eigen::Matrix4d::Identity();
  nan(1, 3) = std::numeric_limits<double>::quiet_NaN();
  Eigen::Matrix4d row = Eigen::Matrix4d::Identity();
  row(3, 0) = 0.5;
  Eigen::Matrix4d flat = Eigen::Matrix4d::Identity();
  flat.col(1) = 2 * flat.col(0);
  return {
      {"Scaled", "Probe", scaled, "is no rotation"}, {"Mirrored", "Probe", mirrored, "is no rotation"},
      {"Nan", "Probe", nan, "not finite"},           {"LastRow", "Probe", row, "last row other than 0 0 0 1"},
      {"Flat", "Image", flat, "is singular"},        {"Zero", "Image", Eigen::Matrix4d::Zero(), "last row"},
      {"ImageNan", "Image", nan, "not finite"}};
}

class TransformGraphDamage : public ::testing::TestWithParam<BadLink> {};

TEST_P(TransformGraphDamage, IsRefusedWithItsPlace) {
  const TransformGraph empty;
  const auto graph = empty.with({own(GetParam().from, "Tracker", GetParam().matrix)}, "sweep.mha, frame 7");
  const std::string said = refusal([&] { graph.find("Tracker", GetParam().from); });
  EXPECT_TRUE(said.starts_with("sweep.mha, frame 7: the transform from ")) << said;
  EXPECT_NE(said.find(GetParam().says), std::string::npos) << said;
}

INSTANTIATE_TEST_SUITE_P(Links, TransformGraphDamage, ::testing::ValuesIn(bad_links()),
                         [](const auto& link) { return link.param.name; });

TEST(TransformGraph, LinksToPixelsMayScaleAndShear) {
  Eigen::Matrix4d sheared = Eigen::Matrix4d::Identity();
  sheared.topLeftCorner<2, 2>() << 0.085, -0.004, 0.002, 0.079;
  for (const char* frame : {"Image", "CroppedImage", "TransducerOriginPixel"}) {
    TransformGraph graph;
    graph.add({frame, "Probe"}, sheared, "plus.xml");
    EXPECT_TRUE(graph.find("Probe", frame)) << frame;
  }
}

}  // namespace
}  // namespace sonoband::test
