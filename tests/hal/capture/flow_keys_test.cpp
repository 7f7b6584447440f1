// Doppler keys from captures: as the classifier of core/image/colour_bar.h takes the colours, whatever the
// format, crop and orientation.
#include "hal/capture/flow_keys.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace sonoband {
namespace {

using doppler::Rgb;

const doppler::ColourBar& bar() {
  static const doppler::ColourBar made = doppler::red_blue_bar();
  return made;
}
doppler::ColourClassifier classifier() {
  return doppler::ColourClassifier(bar(), {});
}

// BT.601 of limited range, rounded: luma, blue and red difference.
struct Yuv {
  std::uint8_t y, u, v;
};
Yuv yuv_of(Rgb c) {
  const double r = c.r / 255.0, g = c.g / 255.0, b = c.b / 255.0;
  const double light = 0.299 * r + 0.587 * g + 0.114 * b;
  const auto level = [](double x) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(x, 0.0, 255.0)));
  };
  return {level(16 + 219 * light), level(128 + 224 * (b - light) / 1.772),
          level(128 + 224 * (r - light) / 1.402)};
}

struct Capture {
  std::vector<std::uint8_t> bytes;
  Frame frame;
};

// The same colour twice side by side, since pairs share their chroma.
Capture capture(PixelFormat format, int width, int height, int padding, const std::vector<Rgb>& colours) {
  const int pixel = format == PixelFormat::rgb24 ? 3 : 2;
  const int stride = pixel * width + padding;
  Capture c;
  c.bytes.assign(static_cast<std::size_t>(stride) * static_cast<std::size_t>(height), 0xcc);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Rgb colour = colours[static_cast<std::size_t>(y * (width / 2) + x / 2) % colours.size()];
      std::uint8_t* p = c.bytes.data() + y * stride + x * pixel;
      if (format == PixelFormat::rgb24) {
        p[0] = colour.r, p[1] = colour.g, p[2] = colour.b;
        continue;
      }
      const Yuv yuv = yuv_of(colour);
      const int chroma = format == PixelFormat::yuyv ? 1 : 0;
      p[1 - chroma] = yuv.y;
      p[chroma] = x % 2 == 0 ? yuv.u : yuv.v;
    }
  }
  c.frame = {.data = c.bytes.data(),
             .bytes = c.bytes.size(),
             .width = width,
             .height = height,
             .stride_bytes = stride,
             .format = format};
  return c;
}

std::vector<Rgb> bar_and_greys() {
  std::vector<Rgb> all;
  for (int level = 0; level < doppler::level_count; ++level) {
    all.push_back(bar().red[static_cast<std::size_t>(level)]);
    all.push_back(bar().blue[static_cast<std::size_t>(level)]);
  }
  for (int grey = 0; grey < 256; grey += 5) {
    const auto g = static_cast<std::uint8_t>(grey);
    all.push_back({g, g, g});
  }
  return all;
}

TEST(FlowKeys, OfRgbAreTheClassifiers) {
  std::mt19937 random(4);
  std::vector<Rgb> colours = bar_and_greys();
  for (int i = 0; i < 500; ++i)
    colours.push_back({static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
                       static_cast<std::uint8_t>(random())});
  const Capture c = capture(PixelFormat::rgb24, 64, 40, 6, colours);
  Pixels out(64, 40);
  FlowKeys(classifier()).copy(c.frame, {}, out.view());
  const doppler::ColourClassifier judge = classifier();
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 64; ++x) {
      const Rgb colour = colours[static_cast<std::size_t>(y * 32 + x / 2) % colours.size()];
      ASSERT_EQ(out.view()(x, y), judge.classify(colour).key) << x << "," << y;
    }
  }
}

// The colours of the bar come through pairs with their direction and, but for the table's cells, their level.
TEST(FlowKeys, OfPairsKeepDirectionLevelAndGrey) {
  const std::vector<Rgb> colours = bar_and_greys();
  for (const PixelFormat format : {PixelFormat::yuyv, PixelFormat::uyvy}) {
    const int width = 2 * static_cast<int>(colours.size());
    const Capture c = capture(format, width, 1, 0, colours);
    Pixels out(width, 1);
    FlowKeys(classifier()).copy(c.frame, {}, out.view());
    const doppler::ColourClassifier judge = classifier();
    for (std::size_t i = 0; i < colours.size(); ++i) {
      const std::uint8_t wanted = judge.classify(colours[i]).key;
      for (const int x : {0, 1}) {
        const std::uint8_t got = out.view()(2 * static_cast<int>(i) + x, 0);
        if (!doppler::is_colour(wanted)) {
          // Y as it is: limited range stays unexpanded, as in copy_luma.
          EXPECT_EQ(got, (yuv_of(colours[i]).y * 127 + 127) / 255) << i;
          continue;
        }
        ASSERT_TRUE(doppler::is_colour(got)) << i;
        EXPECT_EQ(got & 1, wanted & 1) << i;
        EXPECT_NEAR(doppler::velocity(got), doppler::velocity(wanted), 6) << i;
      }
    }
  }
}

TEST(FlowKeys, CropsAndFlipsAsLumaDoes) {
  const std::vector<Rgb> colours = bar_and_greys();
  for (const PixelFormat format : {PixelFormat::rgb24, PixelFormat::yuyv, PixelFormat::uyvy}) {
    const Capture c = capture(format, 60, 20, 4, colours);
    const FlowKeys keys(classifier());
    Pixels whole(60, 20);
    keys.copy(c.frame, {}, whole.view());
    for (const int left : {0, 7}) {
      for (int flips = 0; flips < 4; ++flips) {
        const Crop crop{.x = left, .y = 3, .flip_x = (flips & 1) != 0, .flip_y = (flips & 2) != 0};
        Pixels out(41, 11);
        keys.copy(c.frame, crop, out.view());
        for (int y = 0; y < 11; ++y)
          for (int x = 0; x < 41; ++x)
            ASSERT_EQ(out.view()(x, y),
                      whole.view()(left + (crop.flip_x ? 40 - x : x), 3 + (crop.flip_y ? 10 - y : y)));
      }
    }
  }
}

// Of an odd width the last pixel has no second chroma: it is grey, and nothing behind it is read.
TEST(FlowKeys, TheLastOfAnOddWidthIsGrey) {
  const Capture even = capture(PixelFormat::yuyv, 6, 1, 0, {bar().red[40]});
  Frame odd = even.frame;
  odd.width = 5;
  odd.bytes = 10;
  const std::vector<std::uint8_t> bytes(even.bytes.begin(), even.bytes.begin() + 10);  // for the sanitizer
  odd.data = bytes.data();
  Pixels out(5, 1);
  FlowKeys(classifier()).copy(odd, {}, out.view());
  for (int x = 0; x < 4; ++x) EXPECT_TRUE(doppler::is_colour(out.view()(x, 0))) << x;
  EXPECT_FALSE(doppler::is_colour(out.view()(4, 0)));
}

// Green is turbulence or text, not a velocity of this bar.
TEST(FlowKeys, AHueOffTheBarIsTheDarkestGrey) {
  for (const PixelFormat format : {PixelFormat::rgb24, PixelFormat::yuyv, PixelFormat::uyvy}) {
    const Capture c = capture(format, 8, 1, 0, {{0, 230, 60}});
    Pixels out(8, 1);
    FlowKeys(classifier()).copy(c.frame, {}, out.view());
    for (int x = 0; x < 8; ++x) EXPECT_EQ(out.view()(x, 0), 0);
  }
}

TEST(FlowKeys, FormatsWithoutColourGiveGreys) {
  const std::vector<std::uint8_t> bytes = {0, 64, 128, 255};
  const Frame frame = {.data = bytes.data(),
                       .bytes = 4,
                       .width = 4,
                       .height = 1,
                       .stride_bytes = 4,
                       .format = PixelFormat::grey8};
  Pixels out(4, 1);
  FlowKeys(classifier()).copy(frame, {}, out.view());
  for (int x = 0; x < 4; ++x)
    EXPECT_EQ(out.view()(x, 0), (bytes[static_cast<std::size_t>(x)] * 127 + 127) / 255);
}

}  // namespace
}  // namespace sonoband
