#include "app/cart/picture.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace sonoband::cart {
namespace {

// 4 x 3, rows padded to 6 bytes a pixel row.
Frame grey(const std::vector<std::uint8_t>& bytes) {
  Frame f;
  f.data = bytes.data();
  f.bytes = bytes.size();
  f.width = 4;
  f.height = 3;
  f.stride_bytes = 6;
  return f;
}

const std::vector<std::uint8_t> numbered = {11, 12, 13, 14, 0, 0,  //
                                            21, 22, 23, 24, 0, 0,  //
                                            31, 32, 33, 34};

std::vector<int> cropped(const Frame& frame, const Crop& crop, int width, int height) {
  Pixels out(width, height);
  copy_luma(frame, crop, out.view());
  std::vector<int> list;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) list.push_back(out.view()(x, y));
  return list;
}

TEST(Picture, CropsAndFlipsTheCrop) {
  const Frame f = grey(numbered);
  ASSERT_FALSE(unusable(f, 4, 3));
  EXPECT_EQ(cropped(f, {1, 1, false, false}, 3, 2), std::vector<int>({22, 23, 24, 32, 33, 34}));
  EXPECT_EQ(cropped(f, {1, 1, true, false}, 3, 2), std::vector<int>({24, 23, 22, 34, 33, 32}));
  EXPECT_EQ(cropped(f, {1, 1, false, true}, 3, 2), std::vector<int>({32, 33, 34, 22, 23, 24}));
  EXPECT_EQ(cropped(f, {0, 0, true, true}, 2, 3), std::vector<int>({32, 31, 22, 21, 12, 11}));
}

TEST(Picture, LumaKeepsGreyAndWeighsColour) {
  std::vector<std::uint8_t> bytes;
  for (int v = 0; v < 256; ++v) bytes.insert(bytes.end(), 3, static_cast<std::uint8_t>(v));
  const std::vector<std::uint8_t> primaries = {255, 0, 0, 0, 255, 0, 0, 0, 255};
  bytes.insert(bytes.end(), primaries.begin(), primaries.end());
  Frame f;
  f.data = bytes.data();
  f.bytes = bytes.size();
  f.width = 259;
  f.height = 1;
  f.stride_bytes = static_cast<std::ptrdiff_t>(bytes.size());
  f.format = PixelFormat::rgb24;
  ASSERT_FALSE(unusable(f, 259, 1));
  const std::vector<int> got = cropped(f, {}, 259, 1);
  for (int v = 0; v < 256; ++v) EXPECT_EQ(got[static_cast<std::size_t>(v)], v);
  EXPECT_NEAR(got[256], 0.299 * 255, 1);
  EXPECT_NEAR(got[257], 0.587 * 255, 1);
  EXPECT_NEAR(got[258], 0.114 * 255, 1);
}

TEST(Picture, RefusesWhatItCannotRead) {
  Frame f = grey(numbered);
  f.bytes = 15;  // one byte short
  EXPECT_EQ(unusable(f, 4, 3), LossCause::bad_size);
  f = grey(numbered);
  EXPECT_EQ(unusable(f, 5, 3), LossCause::bad_size);
  EXPECT_EQ(unusable(f, 4, 2), LossCause::bad_size);
  f.stride_bytes = 3;
  EXPECT_EQ(unusable(f, 4, 3), LossCause::bad_size);
  f.stride_bytes = -6;
  EXPECT_EQ(unusable(f, 4, 3), LossCause::bad_size);
  f.stride_bytes = std::numeric_limits<std::ptrdiff_t>::max();
  EXPECT_EQ(unusable(f, 4, 3), LossCause::bad_size);
  f = grey(numbered);
  f.data = nullptr;
  EXPECT_EQ(unusable(f, 4, 3), LossCause::bad_size);
  f = grey(numbered);
  f.format = PixelFormat::mjpeg;
  EXPECT_EQ(unusable(f, 4, 3), LossCause::bad_format);
  f = grey(numbered);
  f.format = PixelFormat::rgb24;  // needs 12 bytes a row
  EXPECT_EQ(unusable(f, 4, 3), LossCause::bad_size);
}

TEST(Picture, DifferenceIsTheSumOverAllPixels) {
  std::mt19937_64 random(2);
  Pixels a(9, 7);
  Pixels b(9, 7);
  std::uint64_t sum = 0;
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 9; ++x) {
      a.view()(x, y) = static_cast<std::uint8_t>(random());
      b.view()(x, y) = static_cast<std::uint8_t>(random());
      sum += static_cast<std::uint64_t>(std::abs(a.view()(x, y) - b.view()(x, y)));
    }
  }
  EXPECT_TRUE(differ_less(a.view(), b.view(), sum + 1));
  EXPECT_FALSE(differ_less(a.view(), b.view(), sum));
  EXPECT_TRUE(differ_less(a.view(), a.view(), 1));
  EXPECT_FALSE(differ_less(a.view(), a.view(), 0));
}

}  // namespace
}  // namespace sonoband::cart
