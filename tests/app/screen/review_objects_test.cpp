#include "app/screen/review_objects.h"

#include <gtest/gtest.h>

#include <random>

namespace sonoband {
namespace {

Eigen::Vector3d point3(std::mt19937& random) {
  std::uniform_real_distribution<double> mm(-200, 200);
  return {mm(random), mm(random), mm(random)};
}

SweepReview some_review(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> mm(0.1, 100);
  SweepReview r;
  r.plane = make_plane(point3(random), point3(random), point3(random), 320, 200, mm(random) / 100);
  r.content_px = {280, 200};
  r.settings.band.thickness_mm = mm(random) / 3;
  r.settings.compounding = static_cast<Compounding>(random() % 3);
  r.settings.interpolation = static_cast<Interpolation>(random() % 2);
  r.reach_mm = mm(random);
  for (int i = 0; i < 40; ++i) r.curve.line.emplace_back(mm(random), mm(random));
  r.curve.handles = {0, 13, 39};
  r.curve_plane = *make_plane(point3(random), point3(random), point3(random), 100, 90, 0.3);
  for (int i = 1; i < 4; ++i) r.landmarks.push_back({point3(random), i});
  for (int i = 0; i < 3; ++i) {
    const std::size_t points = i == 0 ? 2 : 3;
    r.measurements.push_back({i + 1, static_cast<ui::Measure>(i), {}});
    for (std::size_t k = 0; k < points; ++k) r.measurements.back().points.push_back(point3(random));
  }
  r.contours.push_back({7, Stamp(Duration(123'456'789'012'345)), std::nullopt, {}});
  r.contours.push_back({9, {}, make_plane(point3(random), point3(random), point3(random), 64, 48, 0.2), {}});
  for (SweepReview::Contour& contour : r.contours)
    for (int i = 0; i < 12; ++i) contour.points.push_back(point3(random));
  return r;
}

std::vector<std::string> texts(const std::vector<exam::ReviewObject>& objects) {
  std::vector<std::string> all;
  for (const exam::ReviewObject& o : objects) all.push_back(o.object + " " + name_of(o.kind) + " " + o.json);
  return all;
}

TEST(ReviewObjects, WhatIsReadIsWhatWasWrittenToTheLastBit) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const SweepReview made = some_review(seed);
    std::vector<exam::ReviewObject> objects = objects_of(made, 2);
    EXPECT_EQ(objects.size(), 11u);
    std::vector<std::string> refused;
    const SweepReview read = review_of(objects, 2, refused);
    EXPECT_TRUE(refused.empty());
    ASSERT_TRUE(read.plane);
    EXPECT_EQ(read.plane->origin.v, made.plane->origin.v);
    EXPECT_EQ(read.plane->right.v, made.plane->right.v);
    EXPECT_EQ(read.curve.line, made.curve.line);
    EXPECT_EQ(read.contours.at(0).captured, made.contours.at(0).captured);
    EXPECT_EQ(read.contours.at(0).points, made.contours.at(0).points);
    EXPECT_FALSE(read.contours.at(0).plane);
    ASSERT_TRUE(read.contours.at(1).plane);
    EXPECT_EQ(read.contours.at(1).plane->origin.v, made.contours.at(1).plane->origin.v);
    EXPECT_EQ(read.contours.at(1).points, made.contours.at(1).points);
    EXPECT_EQ(read.settings.band.thickness_mm, made.settings.band.thickness_mm);
    EXPECT_EQ(texts(objects_of(read, 2)), texts(objects));
    EXPECT_TRUE(review_of(objects, 1, refused).landmarks.empty()) << "they are another sweep's";
  }
}

TEST(ReviewObjects, OneThatHoldsSomethingElseIsNamedAndTheOthersStay) {
  for (const char* bad :
       {"", "[]", "{}", R"({"number":1,"position_mm":[1,2]})", R"({"number":1,"position_mm":[1,2,"x"]})",
        R"({"number":-4,"position_mm":[1,2,3]})", R"({"number":1e99,"position_mm":[1,2,3]})",
        R"({"number":4294967297,"position_mm":[1,2,3]})",
        R"({"number":18446744073709551617,"position_mm":[1,2,3]})",
        R"({"number":1.5,"position_mm":[1,2,3]})"}) {
    std::vector<exam::ReviewObject> objects = objects_of(some_review(3), 1);
    exam::ReviewObject landmark;
    landmark.object = "sweep1/landmark-9";
    landmark.kind = exam::ReviewKind::landmark;
    landmark.json = bad;
    objects.push_back(landmark);
    std::vector<std::string> refused;
    const SweepReview read = review_of(objects, 1, refused);
    EXPECT_EQ(read.landmarks.size(), 3u) << bad;
    ASSERT_EQ(refused.size(), 1u) << bad;
    EXPECT_NE(refused[0].find("sweep1/landmark-9"), std::string::npos);
  }
}

TEST(ReviewLog, OnlyWhatDiffersIsWrittenAndWhatIsGoneIsRemoved) {
  SweepReview review = some_review(5);
  ReviewLog log;
  log.know(objects_of(review, 1));
  EXPECT_TRUE(log.changes(objects_of(review, 1)).empty());
  review.landmarks.erase(review.landmarks.begin());
  review.settings.band.thickness_mm += 1;
  review.measurements.push_back({4, ui::Measure::distance, {{0, 0, 0}, {3, 4, 0}}});
  const auto changes = log.changes(objects_of(review, 1));
  ASSERT_EQ(changes.size(), 3u);
  EXPECT_EQ(changes[0].object, "sweep1/band");
  EXPECT_EQ(changes[1].object, "sweep1/measurement-4");
  EXPECT_NE(changes[1].json.find("\"value\":5.0"), std::string::npos);
  EXPECT_EQ(changes[2].object, "sweep1/landmark-1");
  EXPECT_TRUE(changes[2].removed);
  EXPECT_TRUE(log.changes(objects_of(review, 1)).empty());
}

}  // namespace
}  // namespace sonoband
