#include "hal/sim/screen.h"

#include <array>
#include <cmath>
#include <string_view>

namespace sonoband::sim {

namespace {

class Screen {
 public:
  Screen(const ScannerSettings& s, std::uint8_t* pixels, std::ptrdiff_t stride)
      : width_(s.width_px),
        height_(s.height_px),
        bytes_(s.format == PixelFormat::rgb24 ? 3 : 1),
        pixels_(pixels),
        stride_(stride) {}

  void dot(int x, int y, std::uint8_t r, std::uint8_t g, std::uint8_t b) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
    std::uint8_t* p = pixels_ + y * stride_ + x * bytes_;
    p[0] = r;
    if (bytes_ == 3) {
      p[1] = g;
      p[2] = b;
    }
  }
  void grey(int x, int y, std::uint8_t v) { dot(x, y, v, v, v); }

 private:
  int width_;
  int height_;
  int bytes_;
  std::uint8_t* pixels_;
  std::ptrdiff_t stride_;
};

// Rows of 5 bits, the left one first.
struct Glyph {
  char letter;
  std::array<std::uint8_t, 7> rows;
};
constexpr std::array<Glyph, 9> glyphs{{{'S', {15, 16, 16, 14, 1, 1, 30}},
                                       {'O', {14, 17, 17, 17, 17, 17, 14}},
                                       {'N', {17, 25, 21, 19, 17, 17, 17}},
                                       {'B', {30, 17, 17, 30, 17, 17, 30}},
                                       {'A', {14, 17, 17, 31, 17, 17, 17}},
                                       {'D', {30, 17, 17, 17, 17, 17, 30}},
                                       {'I', {14, 4, 4, 4, 4, 4, 14}},
                                       {'M', {17, 27, 21, 21, 17, 17, 17}},
                                       {' ', {0, 0, 0, 0, 0, 0, 0}}}};

void write(Screen& screen, std::string_view text, int x, int y) {
  for (const char c : text) {
    for (const Glyph& g : glyphs) {
      if (g.letter != c) continue;
      for (int row = 0; row < 7; ++row) {
        for (int column = 0; column < 5; ++column) {
          if ((g.rows[static_cast<std::size_t>(row)] >> (4 - column) & 1) != 0) {
            screen.grey(x + column, y + row, 190);
          }
        }
      }
    }
    x += 6;
  }
}

void draw_decorations(Screen& screen, const ScannerSettings& s) {
  write(screen, "SONOBAND SIM", 8, 8);
  // Ticks every 5 mm of depth, longer every 10.
  for (int tick = 0; tick * 5 <= s.depth_mm; ++tick) {
    const int y = static_cast<int>(std::lround(s.face_row_px + tick * 5 / s.pixel_mm));
    const int length = tick % 2 == 0 ? 7 : 3;
    for (int x = 0; x < length; ++x) screen.grey(s.width_px - 1 - x, y, 160);
  }
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 8; ++x) screen.grey(8 + x, 30 + y, static_cast<std::uint8_t>(255 - 2 * y));
  }
}

void draw_colour_bar(Screen& screen, const doppler::ColourBar& bar) {
  for (int y = 0; y < 127; ++y) {
    const int level = 63 - y;
    const doppler::Rgb c = level != 0 ? flow_colour(bar, level) : doppler::Rgb{};
    for (int x = 0; x < 10; ++x) screen.dot(8 + x, 180 + y, c.r, c.g, c.b);
  }
}

void draw_box(Screen& screen, const ColourBox& box) {
  for (int x = -1; x <= box.width; ++x) {
    screen.grey(box.x + x, box.y - 1, 255);
    screen.grey(box.x + x, box.y + box.height, 255);
  }
  for (int y = 0; y < box.height; ++y) {
    screen.grey(box.x - 1, box.y + y, 255);
    screen.grey(box.x + box.width, box.y + y, 255);
  }
}

}  // namespace

doppler::Rgb flow_colour(const doppler::ColourBar& bar, int level) {
  return level > 0 ? bar.red[static_cast<std::size_t>(level)] : bar.blue[static_cast<std::size_t>(-level)];
}

void draw_screen(const ScannerSettings& settings, const doppler::ColourBar& bar, std::uint8_t* pixels,
                 std::ptrdiff_t stride_bytes) {
  Screen screen(settings, pixels, stride_bytes);
  if (settings.decorations) draw_decorations(screen, settings);
  if (!settings.colour) return;
  if (settings.decorations) draw_colour_bar(screen, bar);
  if (settings.colour->outline) draw_box(screen, *settings.colour);
}

}  // namespace sonoband::sim
