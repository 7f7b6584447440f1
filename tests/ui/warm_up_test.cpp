// The driver meets every kind of draw call before the first frame; and pictures whose sides are powers of
// two, which are kept in larger textures for that, look like any other.
#include <GLES3/gl3.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/ui/showcase.h"
#include "ui/gl.h"
#include "ui/pictures.h"
#include "ui/theme.h"

namespace sonoband::test {
namespace {

void warm_up(Bench& bench) {
  bench.surface.begin_frame();
  bench.screen->warm_up(bench.surface.size_px());
}

// Of another size and kind than the foetus's.
struct OtherPicture {
  OtherPicture(int width, int height) : pixels(width, height), coverage(width, height) {}
  ui::Picture picture(PixelKind kind, bool covered, std::uint64_t version) const {
    ui::Picture p;
    p.pixels = pixels.view();
    if (covered) p.coverage = coverage.view();
    p.kind = kind;
    p.version = version;
    return p;
  }
  Pixels pixels;
  ImageBuffer<std::uint16_t> coverage;
};

TEST(WarmUp, AfterItNoFrameBringsAKindOfDrawCallThatIsNew) {
  Bench bench;
  warm_up(bench);
  const std::uint64_t met = bench.screen->counts().kinds;
  EXPECT_GE(met, 12u);
  for (const auto& make : {live_view, recording_view, review_view, exams_view, set_up_view}) {
    bench.frame(make());
    bench.frame(make());
  }
  std::uint64_t version = 1000;
  for (const auto& [width, height] : {std::pair{256, 128}, {256, 100}, {100, 256}, {99, 101}}) {
    const OtherPicture other(width, height);
    for (const PixelKind kind : {PixelKind::grey, PixelKind::doppler}) {
      for (const bool covered : {true, false}) {
        ui::View view = review_view();
        view.review.bscan = other.picture(kind, !covered, ++version);
        view.review.band = other.picture(kind, covered, ++version);
        view.review.manifold = other.picture(kind, covered, ++version);
        view.review.look.smooth = covered;
        bench.frame(view);
      }
    }
  }
  EXPECT_EQ(bench.screen->counts().late_kinds, 0u);
  EXPECT_EQ(bench.screen->counts().kinds, met);
}

TEST(WarmUp, WithoutItFramesBringThem) {
  Bench bench;
  bench.frame(live_view());
  const std::uint64_t live = bench.screen->counts().late_kinds;
  EXPECT_GE(live, 4u) << "type, the B-scan, the Outline's lines, the Outline";
  bench.frame(review_view());
  EXPECT_GT(bench.screen->counts().late_kinds, live);
}

TEST(WarmUp, LeavesNothingToBeSeen) {
  Bench plain(1280, 800, 1, true);
  Bench warm(1280, 800, 1, true);
  warm_up(warm);
  const ui::Rgba first = plain.surface.read();
  for (const auto& make : {set_up_view, live_view, review_view}) {
    plain.frame(make());
    warm.frame(make());
    const ui::Rgba seen = plain.surface.read();
    EXPECT_NE(seen.bytes, first.bytes);
    EXPECT_TRUE(warm.surface.read().bytes == seen.bytes);
  }
}

// The Outline slid down, so that its lower edge cuts the sweep: nothing of it may show at the upper edge.
TEST(Pictures, OfTheOutlineEndAtItsEdges) {
  Bench bench(1280, 800, 1, true);
  ui::View view = review_view();
  view.review.orbit.slide = {0, 0.6};
  bench.frame(view);
  const ui::Rect place = bench.find("outline/picture");
  const ui::Rgba seen = bench.surface.read();
  const std::uint32_t panel = ui::colour::panel.rgba;
  const auto at = [&](int x, int y, int channel) {
    return static_cast<int>(seen.bytes[static_cast<std::size_t>(y * seen.width + x) * 4 + channel]);
  };
  // The outer rows whose centres are within it.
  const int upper = static_cast<int>(std::ceil(place.y - 0.5f));
  const int lower = static_cast<int>(std::ceil(place.bottom() - 0.5f)) - 1;
  bool cut = false;
  for (int x = static_cast<int>(place.centre().x) - 150; x < place.centre().x + 150; ++x) {
    for (int channel = 0; channel < 3; ++channel) {
      const int ground = static_cast<int>(panel >> (24 - 8 * channel) & 255);
      ASSERT_EQ(at(x, upper, channel), ground) << x;
      cut = cut || at(x, lower, channel) != ground;
    }
  }
  EXPECT_TRUE(cut);
}

// Between pixel centres by their distance, beyond the outer ones as they are.
double smooth_value(const Pixels& pixels, double x, double y) {
  const auto at = [&](int i, int j) {
    return static_cast<double>(
        pixels.view()(std::clamp(i, 0, pixels.width() - 1), std::clamp(j, 0, pixels.height() - 1)));
  };
  const int i = static_cast<int>(std::floor(x));
  const int j = static_cast<int>(std::floor(y));
  const double u = x - i;
  const double v = y - j;
  return (1 - v) * ((1 - u) * at(i, j) + u * at(i + 1, j)) +
         v * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
}

TEST(Pictures, OfAnySizeAreDrawnToTheirEdges) {
  constexpr int screen = 64;
  ui::HeadlessSurface surface(screen, screen);
  surface.begin_frame();
  glViewport(0, 0, screen, screen);
  ui::DrawKinds kinds;
  ui::Pictures pictures(kinds);
  std::uint64_t version = 0;
  for (const auto& [width, height] : {std::pair{4, 4}, {4, 5}, {5, 4}, {5, 5}, {8, 1}, {2, 2}}) {
    OtherPicture p(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        p.pixels.view()(x, y) = static_cast<std::uint8_t>(40 + (x * 53 + y * 91) % 200);
        p.coverage.view()(x, y) = 1;
      }
    }
    for (const bool covered : {false, true}) {
      pictures.show(ui::Slot::bscan, p.picture(PixelKind::grey, covered, ++version));
      pictures.send();
      pictures.paint(ui::Slot::bscan, {0, 0, screen, screen}, {}, screen, screen);
      const ui::Rgba got = ui::gl::read_pixels(screen, screen);
      double worst = 0;
      for (int y = 0; y < screen; ++y) {
        for (int x = 0; x < screen; ++x) {
          const double wanted =
              smooth_value(p.pixels, (x + 0.5) * width / screen - 0.5, (y + 0.5) * height / screen - 0.5);
          worst = std::max(worst, std::abs(wanted - got.bytes[static_cast<std::size_t>(y * screen + x) * 4]));
        }
      }
      // Eight bits of the weights.
      EXPECT_LE(worst, 2) << width << " x " << height << (covered ? ", covered" : "");
    }
  }
}

}  // namespace
}  // namespace sonoband::test
