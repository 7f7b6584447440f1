#include "hal/capture/luma.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace sonoband {
namespace {

struct Capture {
  std::vector<std::uint8_t> bytes;
  Frame frame;
};

// Grey level of a pixel, of no pattern that a wrong stride or offset could repeat.
std::uint8_t level(int x, int y) {
  return static_cast<std::uint8_t>((x * 31 + y * 57 + x * y) & 0xff);
}

Capture capture(PixelFormat format, int width, int height, int padding) {
  const bool pairs = format == PixelFormat::yuyv || format == PixelFormat::uyvy;
  const int pixel = format == PixelFormat::rgb24 ? 3 : pairs ? 2 : 1;
  const int rows = format == PixelFormat::nv12 ? height * 3 / 2 : height;
  Capture c;
  const int stride = pixel * width + padding;
  c.bytes.assign(static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows), 0xcc);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      std::uint8_t* p = c.bytes.data() + y * stride + x * pixel + (format == PixelFormat::uyvy ? 1 : 0);
      for (int i = 0; i < (format == PixelFormat::rgb24 ? 3 : 1); ++i) p[i] = level(x, y);
    }
  c.frame = {.data = c.bytes.data(),
             .bytes = c.bytes.size(),
             .width = width,
             .height = height,
             .stride_bytes = stride,
             .format = format};
  return c;
}

constexpr PixelFormat with_luma[] = {PixelFormat::grey8, PixelFormat::rgb24, PixelFormat::yuyv,
                                     PixelFormat::uyvy, PixelFormat::nv12};

TEST(Luma, EveryFormatCropAndOrientationGivesTheSamePixels) {
  for (const PixelFormat format : with_luma)
    for (const int padding : {0, 2, 62})
      for (const int width : {1, 2, 15, 16, 17, 100})
        for (int flips = 0; flips < 4; ++flips) {
          const Capture c = capture(format, 140, 24, padding);
          ASSERT_EQ(check_frame(c.frame, 140, 24), FrameFault::none);
          Pixels out(width, 9);
          const Crop crop{.x = 23, .y = 11, .flip_x = (flips & 1) != 0, .flip_y = (flips & 2) != 0};
          copy_luma(c.frame, crop, out.view());
          for (int y = 0; y < 9; ++y)
            for (int x = 0; x < width; ++x)
              ASSERT_EQ(out.view()(x, y),
                        level(23 + (crop.flip_x ? width - 1 - x : x), 11 + (crop.flip_y ? 8 - y : y)))
                  << static_cast<int>(format) << " " << x << " " << y;
        }
}

TEST(Luma, NothingIsReadOrWrittenOutside) {
  for (const PixelFormat format : with_luma) {
    Capture c = capture(format, 33, 5, 0);
    // Exactly the bytes that luma needs: a sanitizer sees a read beyond.
    const auto need = c.frame.stride_bytes * 5;
    std::vector<std::uint8_t> exact(c.bytes.begin(), c.bytes.begin() + need);
    c.frame.data = exact.data();
    c.frame.bytes = exact.size();
    ASSERT_EQ(check_frame(c.frame, 33, 5), FrameFault::none);
    std::vector<std::uint8_t> wide(40 * 5, 0x55);
    copy_luma(c.frame, {}, {wide.data(), 33, 5, 40});
    for (int y = 0; y < 5; ++y)
      for (int x = 33; x < 40; ++x) EXPECT_EQ(wide[static_cast<std::size_t>(y * 40 + x)], 0x55);
    EXPECT_EQ(wide[4 * 40 + 32], level(32, 4));
  }
}

TEST(Luma, LiesAboutSizesAreRefused) {
  const Capture c = capture(PixelFormat::yuyv, 64, 48, 0);
  const auto fault = [&](auto change) {
    Frame f = c.frame;
    change(f);
    return check_frame(f, 64, 48);
  };
  EXPECT_EQ(fault([](Frame&) {}), FrameFault::none);
  EXPECT_EQ(fault([](Frame& f) { f.format = PixelFormat::mjpeg; }), FrameFault::format);
  EXPECT_EQ(fault([](Frame& f) { f.width = 65; }), FrameFault::size);
  EXPECT_EQ(fault([](Frame& f) { f.height = -48; }), FrameFault::size);
  EXPECT_EQ(fault([](Frame& f) { f.data = nullptr; }), FrameFault::size);
  EXPECT_EQ(fault([](Frame& f) { f.bytes -= 1; }), FrameFault::size);
  EXPECT_EQ(fault([](Frame& f) { f.bytes = 0; }), FrameFault::size);
  EXPECT_EQ(fault([](Frame& f) { f.stride_bytes = 127; }), FrameFault::size);
  EXPECT_EQ(fault([](Frame& f) { f.stride_bytes = -128; }), FrameFault::size);
  EXPECT_EQ(fault([](Frame& f) { f.stride_bytes = std::numeric_limits<std::ptrdiff_t>::max(); }),
            FrameFault::size);
  EXPECT_EQ(check_frame(c.frame, 0, 0), FrameFault::size);
}

}  // namespace
}  // namespace sonoband
