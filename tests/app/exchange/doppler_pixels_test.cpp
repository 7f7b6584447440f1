// A screen in colour whose every pixel is known, to keys and mask.
#include "app/exchange/doppler_pixels.h"

#include <gtest/gtest.h>

#include "app/exchange/sweep_from_sequence.h"
#include "tests/app/exchange/sequence_samples.h"

namespace sonoband::test {
namespace {

using doppler::Rgb;
using exchange::ColourUse;
using exchange::TrackedSequence;

constexpr int width = 20;
constexpr int height = 16;
constexpr int frames = 12;

void put(TrackedSequence& s, int frame, int x, int y, Rgb c) {
  const auto at = (static_cast<std::size_t>(frame) * width * height + static_cast<std::size_t>(y) * width +
                   static_cast<std::size_t>(x)) *
                  3;
  std::uint8_t* bytes = s.pixels.bytes().data() + at;
  bytes[0] = c.r;
  bytes[1] = c.g;
  bytes[2] = c.b;
}

int level(int frame) {
  return frame % 2 == 0 ? 40 : 20;
}

// Grey that flickers as speckle does, the scanner's white column at x = 5, steady orange text at (0, 0), and,
// if asked, pulsating flow: red of level 40 or 20 at (10, 8) to (12, 8), blue at (10, 9) and a passing green
// at (14, 3).
TrackedSequence screen(bool flow) {
  TrackedSequence s;
  s.width = width;
  s.height = height;
  s.components = 3;
  s.image_type = "RGB_COLOR";
  s.frames.resize(frames);
  s.pixels = exchange::PixelBuffer(std::size_t{3} * width * height * frames);
  const doppler::ColourBar bar = doppler::red_blue_bar();
  for (int f = 0; f < frames; ++f) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto v = static_cast<std::uint8_t>(60 + (x * 7 + y * 13 + f * 29) % 120);
        put(s, f, x, y, {v, v, v});
      }
    for (int y = 0; y < height; ++y) put(s, f, 5, y, {250, 250, 250});
    put(s, f, 0, 0, {230, 120, 190});
    if (flow) {
      for (const int x : {10, 11, 12}) put(s, f, x, 8, bar.red[static_cast<std::size_t>(level(f))]);
      put(s, f, 10, 9, bar.blue[static_cast<std::size_t>(level(f))]);
      if (f == 3) put(s, f, 14, 3, {20, 220, 60});
    }
    Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
    pose(2, 3) = f;
    exchange::set_transform(s.frames[static_cast<std::size_t>(f)], {"Probe", "Tracker"}, pose);
  }
  return s;
}

exchange::PlusConfig calibration() {
  exchange::PlusConfig config;
  exchange::ConfigTransform t;
  t.name = {"Image", "Probe"};
  t.to_from_from = Eigen::Vector4d(0.2, 0.2, 0.2, 1).asDiagonal();
  config.transforms.push_back(t);
  return config;
}

exchange::SequenceSweep sweep_of(bool flow, const exchange::SweepRequest& request = {}) {
  return exchange::sweep_from_sequence({.sequence = screen(flow), .warnings = {}}, calibration(), request,
                                       "screen.mha");
}

const doppler::ColourClassifier& classifier() {
  static const doppler::ColourClassifier made(doppler::red_blue_bar(), {});
  return made;
}

TEST(DopplerPixels, BecomeKeysAndWhatTheScannerDrawsIsMasked) {
  TrackedSequence s = screen(true);
  const Pixels mask = exchange::make_doppler(s, {}, classifier(), true);
  ASSERT_EQ(s.components, 1);
  ASSERT_EQ(s.frame_bytes(), std::size_t{width} * height);
  for (int f = 0; f < frames; ++f) {
    const auto keys = s.frame_pixels(f);
    const auto key = [&](int x, int y) {
      return keys[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
    };
    EXPECT_NEAR(doppler::velocity(key(11, 8)), level(f), 4) << f;
    EXPECT_NEAR(doppler::velocity(key(10, 9)), -level(f), 4) << f;
    EXPECT_NEAR(key(15, 9), (60 + (15 * 7 + 9 * 13 + f * 29) % 120) / 2.0, 1) << f;
  }
  EXPECT_EQ(s.frame_pixels(3)[3 * width + 14], 0) << "a passing hue that is no velocity";
  for (int y = 0; y < height; ++y) EXPECT_EQ(mask.view()(5, y), 0) << y;
  EXPECT_EQ(mask.view()(0, 0), 0) << "text";
  EXPECT_EQ(mask.view()(11, 8), 255);
  EXPECT_EQ(mask.view()(14, 3), 255);
  EXPECT_EQ(mask.view()(15, 9), 255);
}

TEST(DopplerPixels, AProbeHeldStillProvesNoDrawing) {
  TrackedSequence s = screen(true);
  const Pixels mask = exchange::make_doppler(s, {}, classifier(), false);
  EXPECT_EQ(mask.view()(5, 8), 255);
}

TEST(DopplerPixels, FlowIsToldFromAGreyScreenInColour) {
  EXPECT_TRUE(exchange::shows_flow(screen(true), {}, classifier()));
  EXPECT_FALSE(exchange::shows_flow(screen(false), {}, classifier()));
}

TEST(DopplerPixels, ASweepShowsFlowUnlessGreyIsAskedFor) {
  const auto coloured = sweep_of(true);
  EXPECT_EQ(coloured.kind, PixelKind::doppler);
  EXPECT_EQ(coloured.view().frames[4]->bscan.kind, PixelKind::doppler);
  EXPECT_EQ(coloured.view().frames[4]->bscan.pixels.data, coloured.sequence.frame_pixels(4).data());
  EXPECT_FALSE(coloured.view().mask.empty());

  exchange::SweepRequest as_grey, as_doppler, without_mask;
  as_grey.colour = ColourUse::grey;
  as_doppler.colour = ColourUse::doppler;
  without_mask.mask = false;
  const auto grey = sweep_of(true, as_grey);
  EXPECT_EQ(grey.kind, PixelKind::grey);
  EXPECT_EQ(grey.frames[4].bscan.pixels(11, 8), doppler::luma(doppler::red_blue_bar().red[40]));
  EXPECT_TRUE(grey.view().mask.empty());

  EXPECT_EQ(sweep_of(false).kind, PixelKind::grey);
  EXPECT_EQ(sweep_of(false, as_doppler).kind, PixelKind::doppler);
  const auto unmasked = sweep_of(true, without_mask);
  EXPECT_TRUE(unmasked.view().mask.empty());
}

}  // namespace
}  // namespace sonoband::test
