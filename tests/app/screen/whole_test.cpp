// A finger and a foot drive the whole application: from boot to a second sweep, at every size and scale, each
// state against its golden picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "app/exchange/png.h"
#include "tests/app/screen/screen_support.h"

namespace sonoband::test {
namespace {

using exchange::PngPicture;

constexpr int shrink = 4;
// Within one distribution processors differ by up to 4; on another, glyphs do.
constexpr int tolerance = 8;

std::filesystem::path golden_folder() {
  return std::filesystem::path(SONOBAND_SOURCE_DIR) / "tests/golden/screen";
}

// A quarter as wide and high, by means. How much room this machine's disk has is no part of it: those places
// are blank.
PngPicture shrunk(const ui::Rgba& all, const std::vector<ui::Rect>& blank) {
  PngPicture out{all.width / shrink, all.height / shrink, 3, {}, 0, {}};
  out.bytes.resize(static_cast<std::size_t>(out.width) * out.height * 3);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      std::array<int, 3> sum{};
      for (int dy = 0; dy < shrink; ++dy) {
        for (int dx = 0; dx < shrink; ++dx) {
          const int px = x * shrink + dx;
          const int py = y * shrink + dy;
          const ui::Vec2 at{static_cast<float>(px), static_cast<float>(py)};
          if (std::any_of(blank.begin(), blank.end(), [&](const ui::Rect& r) { return r.contains(at); }))
            continue;
          for (std::size_t c = 0; c < 3; ++c)
            sum[c] += all.bytes[(static_cast<std::size_t>(py) * all.width + px) * 4 + c];
        }
      }
      for (std::size_t c = 0; c < 3; ++c)
        out.bytes[(static_cast<std::size_t>(y) * out.width + x) * 3 + c] =
            static_cast<std::uint8_t>(sum[c] / (shrink * shrink));
    }
  }
  return out;
}

// With SONOBAND_GOLDENS=write the picture becomes the golden one; look at it before it is committed.
void expect_golden(ScreenCart& cart, const std::string& name) {
  const ui::Rgba all = cart.shot(name);
  std::vector<ui::Rect> blank;
  for (const char* widget : {"status/storage", "set-up/devices", "set-up/storage"}) {
    if (const auto found = cart.loop().screen().widgets().find(widget)) blank.push_back(found->rect);
  }
  ASSERT_FALSE(blank.empty());
  const PngPicture got = shrunk(all, blank);
  const auto file = golden_folder() / (name + ".png");
  const char* mode = std::getenv("SONOBAND_GOLDENS");
  if (mode != nullptr && std::string(mode) == "write") {
    std::filesystem::create_directories(golden_folder());
    exchange::write_png(got, file);
    return;
  }
  const PngPicture golden = exchange::read_png(file);
  ASSERT_EQ(golden.width, got.width) << name;
  ASSERT_EQ(golden.height, got.height) << name;
  int worst = 0;
  std::size_t at = 0;
  for (std::size_t i = 0; i < got.bytes.size(); ++i) {
    const int off = std::abs(int{got.bytes[i]} - int{golden.bytes[i]});
    if (off > worst) at = i;
    worst = std::max(worst, off);
  }
  const int pixel = static_cast<int>(at / 3);
  EXPECT_LE(worst, tolerance) << name << ": at " << shrink * (pixel % got.width) << ", "
                              << shrink * (pixel / got.width);
}

struct Look {
  int width, height;
  float scale;
  const char* name;
};

class Whole : public ::testing::TestWithParam<Look> {};

TEST_P(Whole, FromBootToASecondSweep) {
  const Look look = GetParam();
  ScreenCartSettings settings;
  settings.screen.width = look.width;
  settings.screen.height = look.height;
  settings.screen.scale = look.scale;
  settings.screen.shots = scratch_folder();
  ScreenCart cart(settings);
  const auto golden = [&](const std::string& state) { expect_golden(cart, state + look.name); };

  cart.play("await live 5\nwait 1.5\n");
  golden("live");
  cart.play("press\nwait 1.5\n");
  golden("recording");
  cart.play("wait 1.2\nrelease\nawait review 5\nwait 0.2\n");
  const auto& session = cart.loop().session();
  EXPECT_EQ(session.page(), ui::Page::review);
  EXPECT_EQ(session.sweep_count(), 1u);
  golden("review");

  const bool every_step = std::string_view(look.name).empty();  // the others are for what it looks like
  // A thinner band: the gestures are what counts now, and every step of them is rendered.
  cart.play("drag tools/thickness 0.7,0.5 0.2,0.5 0.1\n");
  if (every_step) {
    cart.play(R"(tap tools/mean
drag reslice/picture 0.5,0.5 0.55,0.56 0.1
pinch reslice/picture 1.3
twist reslice/picture 12
drag reslice/normal 0.5,0.5 0.5,0.55 0.1
)");
    golden("moved");
    cart.play("tap tools/reset\ntap tools/maximum\n");
  }
  cart.play(R"(tap tools/curve
drag reslice/picture 0.42,0.6 0.46,0.45 0.54,0.45 0.58,0.6 0.3
drag tools/thickness 0.2,0.5 0.36,0.5 0.1
drag manifold/reach 0.5,0.5 0.5,1.5 0.1
)");
  ASSERT_TRUE(cart.loop().worker().newest()->manifold);
  golden("manifold");
  if (!every_step) {
    cart.play("tap rail/set-up\n");
    golden("set-up");
    return;
  }
  cart.play(R"(tap tools/mark
tap review/picture
tap tools/measure
drag review/slider 0.5,0.5 0.4,0.5 0.1
tap review/picture
tap reslice/picture
drag outline/picture 0.5,0.5 0.6,0.45 0.1
)");
  golden("measured");
  cart.play("tap rail/snapshot\n");
  EXPECT_TRUE(std::filesystem::exists(settings.screen.shots / "snapshot-1.png"));
  cart.play("tap rail/live\nwait 0.2\npress\nwait 1\nrelease\nawait review 5\nwait 0.3\n");
  EXPECT_EQ(session.sweep_count(), 2u);
  EXPECT_EQ(session.page(), ui::Page::review);
  cart.play("tap rail/set-up\n");
  golden("set-up");
}

INSTANTIATE_TEST_SUITE_P(Screens, Whole,
                         ::testing::Values(Look{1280, 800, 1, ""}, Look{1280, 800, 1.5f, "-large"},
                                           Look{1920, 1080, 1, "-hd"}, Look{1920, 1080, 1.5f, "-hd-large"}),
                         [](const auto& chosen) {
                           std::string name = chosen.param.name;
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return "Screen" + name;
                         });

}  // namespace
}  // namespace sonoband::test
