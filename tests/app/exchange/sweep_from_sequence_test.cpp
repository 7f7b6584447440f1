#include "app/exchange/sweep_from_sequence.h"

#include <gtest/gtest.h>

#include "tests/app/exchange/sequence_samples.h"
#include "tests/support/support.h"

namespace sonoband::test {
namespace {

using exchange::ElementType;
using exchange::PlusConfig;
using exchange::ReadSequence;
using exchange::SequenceSweep;
using exchange::SweepRequest;

Eigen::Matrix4d at_z(double z) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m(2, 3) = z;
  return m;
}

// Frame i lies at z = i mm, stamped at i / 10 s; every pose is OK.
ReadSequence straight(int frames, ElementType type = ElementType::uint8, int components = 1) {
  ReadSequence read{.sequence = random_sequence(6, 4, frames, type, components, 17), .warnings = {}};
  for (int i = 0; i < frames; ++i) {
    auto& frame = read.sequence.frames[static_cast<std::size_t>(i)];
    frame.fields.clear();
    exchange::set_transform(frame, {"Probe", "Tracker"}, at_z(i));
    exchange::set_field(frame.fields, "Timestamp", std::to_string(0.1 * i));
  }
  return read;
}

PlusConfig calibration(double scale_mm = 0.1) {
  PlusConfig config;
  Eigen::Matrix4d probe_from_image = Eigen::Matrix4d::Identity();
  probe_from_image.diagonal() << scale_mm, scale_mm, scale_mm, 1;
  exchange::ConfigTransform t;
  t.name = {"Image", "Probe"};
  t.to_from_from = probe_from_image;
  t.place = "plus.xml, line 4";
  config.transforms.push_back(t);
  return config;
}

SequenceSweep sweep_of(ReadSequence&& read, const PlusConfig& config = calibration(),
                       const SweepRequest& request = {}) {
  return exchange::sweep_from_sequence(std::move(read), config, request, "sweep.mha");
}

std::string refused(ReadSequence&& read, const PlusConfig& config = calibration(),
                    const SweepRequest& request = {}) {
  return refusal([&] { sweep_of(std::move(read), config, request); });
}

TEST(SweepFromSequence, PlacesEveryFrameAndBorrowsItsPixels) {
  const auto sweep = sweep_of(straight(5));
  EXPECT_EQ(sweep.world, "Tracker");
  ASSERT_EQ(sweep.view().frames.size(), 5u);
  EXPECT_TRUE(sweep.view().mask.empty());
  const TrackedFrame& f = *sweep.view().frames[3];
  EXPECT_EQ(f.pose_status, PoseStatus::ok);
  EXPECT_EQ(f.bscan.pixels.data, sweep.sequence.frame_pixels(3).data());
  const Eigen::Vector3d p = (f.world_from_image * Point<frame::Image>{{2, 3, 0}}).v;
  EXPECT_LT((p - Eigen::Vector3d(0.2, 0.3, 3)).norm(), 1e-12);
  EXPECT_EQ(f.captured, Stamp(from_seconds(0.3)));
  EXPECT_EQ(f.sequence, 3);
}

TEST(SweepFromSequence, MovedItStillBorrowsTheSamePixels) {
  auto first = sweep_of(straight(5));
  const std::uint8_t* pixels = first.view().frames[0]->bscan.pixels.data;
  const SequenceSweep second = std::move(first);
  EXPECT_EQ(second.view().frames[0], &second.frames[0]);
  EXPECT_EQ(second.view().frames[0]->bscan.pixels.data, pixels);
  EXPECT_EQ(second.sequence.pixels.bytes().data(), pixels);
}

TEST(SweepFromSequence, ReferenceIsTheWorldWhereThereIsOne) {
  auto read = straight(3);
  for (auto& frame : read.sequence.frames) exchange::set_transform(frame, {"Reference", "Tracker"}, at_z(10));
  const auto sweep = sweep_of(std::move(read));
  EXPECT_EQ(sweep.world, "Reference");
  EXPECT_DOUBLE_EQ(sweep.frames[1].world_from_image.translation.z(), -9);
}

TEST(SweepFromSequence, AReferenceOfTheConfigurationAloneIsNotTheWorld) {
  PlusConfig config = calibration();
  config.transforms.push_back(config.transforms[0]);
  config.transforms[1].name = {"Phantom", "Reference"};
  EXPECT_EQ(sweep_of(straight(3), config).world, "Tracker");
}

TEST(SweepFromSequence, ADirectTransformNeedsNoCalibration) {
  auto read = straight(3);
  Eigen::Matrix4d direct = at_z(4);
  direct(0, 0) = direct(1, 1) = 0.2;
  for (auto& frame : read.sequence.frames) exchange::set_transform(frame, {"Image", "Reference"}, direct);
  const auto sweep = sweep_of(std::move(read), {});
  EXPECT_EQ(sweep.world, "Reference");
  EXPECT_DOUBLE_EQ(sweep.frames[1].world_from_image.linear(0, 0), 0.2);
}

TEST(SweepFromSequence, FramesWithoutAPoseAreCountedByCause) {
  auto read = straight(7);
  auto& frames = read.sequence.frames;
  exchange::set_transform(frames[1], {"Probe", "Tracker"}, at_z(0), "MISSING");
  exchange::set_transform(frames[2], {"Probe", "Tracker"}, at_z(0), "MISSING");
  exchange::set_transform(frames[3], {"Probe", "Tracker"}, at_z(0), "INVALID");
  exchange::set_field(frames[4].fields, "ImageStatus", "INVALID");
  std::erase_if(frames[5].fields, [](const auto& f) { return f.name != "Timestamp"; });
  const auto sweep = sweep_of(std::move(read));
  EXPECT_EQ(sweep.frames.size(), 2u);
  ASSERT_EQ(sweep.left_out.size(), 4u);
  EXPECT_EQ(sweep.left_out[0].cause, "ProbeToTrackerTransform is MISSING");
  EXPECT_EQ(sweep.left_out[0].frames, 2);
  EXPECT_EQ(sweep.left_out[1].cause, "ProbeToTrackerTransform is INVALID");
  EXPECT_EQ(sweep.left_out[2].cause, "ImageStatus is not OK");
  EXPECT_EQ(sweep.left_out[3].cause, "no transforms from Image to Tracker");
}

TEST(SweepFromSequence, AMissingStatusIsOkWithAWarning) {
  auto read = straight(3);
  for (auto& frame : read.sequence.frames)
    std::erase_if(frame.fields, [](const auto& f) { return f.name.ends_with("Status"); });
  const auto sweep = sweep_of(std::move(read));
  EXPECT_EQ(sweep.frames.size(), 3u);
  ASSERT_EQ(sweep.warnings.size(), 1u);
  EXPECT_SAYS(sweep.warnings[0], "3 frames have a transform without a status");
}

TEST(SweepFromSequence, StampsCountOnlyWhereTheyOrder) {
  auto read = straight(4);
  exchange::set_field(read.sequence.frames[2].fields, "Timestamp", "0.05");
  const auto sweep = sweep_of(std::move(read));
  EXPECT_EQ(sweep.frames[3].captured, Stamp{});
  EXPECT_EQ(sweep.frames[3].sequence, 3);
  ASSERT_EQ(sweep.warnings.size(), 1u);
  EXPECT_SAYS(sweep.warnings[0], "frame 2 has an earlier time stamp");
}

TEST(SweepFromSequence, FramesClipAndFanChooseWhatCounts) {
  PlusConfig config = calibration();
  config.clip = exchange::ClipRectangle{1, 0, 5, 4};
  SweepRequest request;
  request.frames = {2, 4};
  request.clip = exchange::ClipRectangle{0, 2, 3, 9};
  const auto sweep = sweep_of(straight(7), config, request);
  ASSERT_EQ(sweep.frames.size(), 3u);
  EXPECT_EQ(sweep.frames[0].sequence, 2);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 6; ++x) EXPECT_EQ(sweep.mask.view()(x, y) != 0, x >= 1 && x < 3 && y >= 2);
  request.mask = false;
  EXPECT_TRUE(sweep_of(straight(7), config, request).mask.view().empty());
}

TEST(SweepFromSequence, ColourBecomesLumaWhereGreyIsAskedFor) {
  auto read = straight(2, ElementType::uint8, 3);
  auto bytes = read.sequence.pixels.bytes();
  bytes[9] = 200, bytes[10] = 100, bytes[11] = 50;  // pixel 3
  SweepRequest request;
  request.colour = exchange::ColourUse::grey;
  const auto sweep = sweep_of(std::move(read), calibration(), request);
  // 0.299 x 200 + 0.587 x 100 + 0.114 x 50 = 124.2
  EXPECT_EQ(sweep.view().frames[0]->bscan.pixels(3, 0), 124);
  EXPECT_EQ(sweep.view().frames[1]->bscan.pixels.data, sweep.view().frames[0]->bscan.pixels.data + 24);
}

TEST(SweepFromSequence, WideSamplesAreTakenOrStretched) {
  const auto with_samples = [](std::int16_t low, std::int16_t high) {
    auto read = straight(2, ElementType::int16);
    auto bytes = read.sequence.pixels.bytes();
    for (std::size_t i = 0; i < bytes.size(); i += 2) {
      const std::int16_t v = i == 0 ? low : i == 2 ? high : static_cast<std::int16_t>((low + high) / 2);
      std::memcpy(&bytes[i], &v, 2);
    }
    return sweep_of(std::move(read));
  };
  const auto as_is = with_samples(3, 251);
  EXPECT_EQ(as_is.view().frames[0]->bscan.pixels(0, 0), 3);
  EXPECT_EQ(as_is.view().frames[0]->bscan.pixels(1, 0), 251);
  EXPECT_EQ(as_is.view().frames[1]->bscan.pixels(5, 3), 127);
  const auto stretched = with_samples(-1000, 1000);
  EXPECT_EQ(stretched.view().frames[0]->bscan.pixels(0, 0), 0);
  EXPECT_EQ(stretched.view().frames[0]->bscan.pixels(1, 0), 255);
  EXPECT_EQ(stretched.view().frames[1]->bscan.pixels(5, 3), 128);
  EXPECT_SAYS(stretched.warnings[0], "from -1000 to 1000 are stretched");
}

TEST(SweepFromSequenceDamage, EachKindHasItsSentence) {
  EXPECT_SAYS(refused(straight(3), {}), "no transform leads away from Image (there are Probe and Tracker)");
  SweepRequest phantom;
  phantom.world = "Phantom";
  EXPECT_SAYS(refused(straight(3), calibration(), phantom),
              "no chain of transforms leads from Image to Phantom; choose --world among Probe and Tracker");
  SweepRequest beyond;
  beyond.frames = {1, 3};
  EXPECT_SAYS(refused(straight(3), calibration(), beyond), "frames 1 to 3 were asked for and it has 0 to 2");
  auto none_ok = straight(2);
  for (auto& frame : none_ok.sequence.frames)
    exchange::set_transform(frame, {"Probe", "Tracker"}, at_z(0), "MISSING");
  EXPECT_SAYS(refused(std::move(none_ok)),
              "no frame of 0 to 1 has a usable pose: ProbeToTrackerTransform is MISSING (2 frames)");
  auto not_rigid = straight(4);
  Eigen::Matrix4d scaled = at_z(0);
  scaled(0, 0) = 2;
  exchange::set_transform(not_rigid.sequence.frames[2], {"Probe", "Tracker"}, scaled);
  EXPECT_SAYS(refused(std::move(not_rigid)),
              "sweep.mha, frame 2: the transform from Probe to Tracker is no rotation");
  auto nan = straight(4);
  exchange::set_field(nan.sequence.frames[1].fields, "ProbeToTrackerTransform",
                      "1 0 0 nan 0 1 0 0 0 0 1 0 0 0 0 1");
  EXPECT_SAYS(refused(std::move(nan)),
              "frame 1: the transform from Probe to Tracker has a number that is not finite");
  EXPECT_SAYS(refused(straight(3), calibration(0)),
              "plus.xml, line 4: the transform from Image to Probe is singular");
  auto lines = straight(3);
  lines.sequence.image_type = "RF_REAL";
  EXPECT_SAYS(refused(std::move(lines)), "raw echoes (RF_REAL)");
  auto turned = straight(3);
  turned.sequence.orientation = "FM";
  EXPECT_SAYS(refused(std::move(turned)), "lie as FM");
  ReadSequence tracker{.sequence = random_sequence(0, 0, 4, ElementType::none, 1, 3), .warnings = {}};
  EXPECT_SAYS(refused(std::move(tracker)), "tracker readings and no pictures");
}

}  // namespace
}  // namespace sonoband::test
