#include "tests/app/screen/golden.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <vector>

#include "app/exchange/png.h"

namespace sonoband::test {
namespace {

constexpr int shrink = 4;
// Within one distribution processors differ by up to 4.
constexpr int tolerance = 8;
// Whose fonts and rasteriser of glyphs the pictures have. With others words have other widths, and all that
// stands beside them another place: Debian 13's Inter 4.1 changes up to a third of the values.
constexpr const char* release_of_goldens = "bookworm";
// A wide line of the Outline wins or loses one of a pixel's four samples where another compiler rounds the
// last bit of its corners differently: up to 57 levels of 36 pixels at full size, clang against GCC.
constexpr int edge_tolerance = 24;
constexpr int most_edges = 30;  // values, three a pixel

std::filesystem::path golden_folder() {
  return std::filesystem::path(SONOBAND_SOURCE_DIR) / "tests/golden/screen";
}

std::string this_release() {
  const std::string key = "VERSION_CODENAME=";
  std::ifstream in("/etc/os-release");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with(key)) return line.substr(key.size());
  return "unknown";
}

// A quarter as wide and high, by means. How much room this machine's disk has is no part of it: those places
// are blank.
exchange::PngPicture shrunk(const ui::Rgba& all, const std::vector<ui::Rect>& blank) {
  exchange::PngPicture out{all.width / shrink, all.height / shrink, 3, {}, 0, {}};
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

}  // namespace

void expect_golden(ScreenCart& cart, const std::string& name, std::initializer_list<const char*> varying) {
  cart.show(name);
  const ui::Rgba all = cart.shot();
  std::vector<ui::Rect> blank;
  std::vector<std::string> widgets = {"status/storage", "set-up/devices", "set-up/storage"};
  widgets.insert(widgets.end(), varying.begin(), varying.end());
  for (const std::string& widget : widgets) {
    if (const auto found = cart.loop().screen().widgets().find(widget)) blank.push_back(found->rect);
  }
  ASSERT_FALSE(blank.empty());
  const exchange::PngPicture got = shrunk(all, blank);
  if (const std::string release = this_release(); release != release_of_goldens)
    GTEST_SKIP() << name << " was drawn; the golden pictures have the glyphs of Debian " << release_of_goldens
                 << ", this is " << release;
  const auto file = golden_folder() / (name + ".png");
  const char* mode = std::getenv("SONOBAND_GOLDENS");
  if (mode != nullptr && std::string(mode) == "write") {
    std::filesystem::create_directories(golden_folder());
    exchange::write_png(got, file);
    return;
  }
  const exchange::PngPicture golden = exchange::read_png(file);
  ASSERT_EQ(golden.width, got.width) << name;
  ASSERT_EQ(golden.height, got.height) << name;
  int worst = 0;
  int edges = 0;
  std::size_t at = 0;
  for (std::size_t i = 0; i < got.bytes.size(); ++i) {
    const int off = std::abs(int{got.bytes[i]} - int{golden.bytes[i]});
    if (off > worst) at = i;
    worst = std::max(worst, off);
    edges += off > tolerance;
  }
  const int pixel = static_cast<int>(at / 3);
  EXPECT_LE(worst, edge_tolerance) << name << ": at " << shrink * (pixel % got.width) << ", "
                                   << shrink * (pixel / got.width);
  EXPECT_LE(edges, most_edges) << name;
}

}  // namespace sonoband::test
