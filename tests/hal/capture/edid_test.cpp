#include "hal/capture/edid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace sonoband {
namespace {

struct Timing {
  int width, height, blank_x, blank_y;
  double rate_hz;
};

Timing timing_of(const std::array<std::uint8_t, 128>& e) {
  const auto at = [&](int i) { return static_cast<int>(e[54 + static_cast<std::size_t>(i)]); };
  Timing t{at(2) | (at(4) >> 4) << 8, at(5) | (at(7) >> 4) << 8, at(3) | (at(4) & 15) << 8,
           at(6) | (at(7) & 15) << 8, 0};
  t.rate_hz = 10'000.0 * (at(0) | at(1) << 8) / ((t.width + t.blank_x) * (t.height + t.blank_y));
  return t;
}

int sum(const std::array<std::uint8_t, 128>& e) {
  int total = 0;
  for (const std::uint8_t byte : e) total += byte;
  return total;
}

// The detailed timing of 1920 x 1080 at 60 Hz, as every television has it.
TEST(Edid, FullHdIsTheStandardsOwn) {
  const auto e = edid(1920, 1080, 60);
  const std::uint8_t standard[12] = {0x02, 0x3a, 0x80, 0x18, 0x71, 0x38, 0x2d, 0x40, 0x58, 0x2c, 0x45, 0x00};
  EXPECT_TRUE(std::equal(std::begin(standard), std::end(standard), e.begin() + 54));
  EXPECT_EQ(sum(e) % 256, 0);
  EXPECT_NEAR(timing_of(edid(1920, 1080, 50)).rate_hz, 50, 1e-9);
  EXPECT_NEAR(timing_of(edid(1280, 720, 50)).rate_hz, 50, 1e-9);
}

TEST(Edid, EverySizeAndRateComesBackFromItsBytes) {
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i) {
    const int width = std::uniform_int_distribution<int>(16, 4095)(random);
    const int height = std::uniform_int_distribution<int>(16, 4095)(random);
    const double rate = std::uniform_int_distribution<int>(1, 240)(random);
    const auto e = edid(width, height, rate);
    if (e[1] == 0) {
      EXPECT_GT(rate * (width + 160) * (height + 14), 655e6 * 0.5)
          << "only a clock beyond 16 bits is refused";
      continue;
    }
    const Timing t = timing_of(e);
    EXPECT_EQ(t.width, width);
    EXPECT_EQ(t.height, height);
    // The clock counts in 10 kHz.
    EXPECT_NEAR(t.rate_hz, rate, 5000.0 / ((t.width + t.blank_x) * (t.height + t.blank_y)) + 1e-9);
    EXPECT_EQ(sum(e) % 256, 0);
  }
}

TEST(Edid, WhatItCannotSayIsEmpty) {
  for (const auto& e : {edid(15, 480, 60), edid(640, 4096, 60), edid(4095, 4095, 240), edid(640, 480, 0),
                        edid(640, 480, std::numeric_limits<double>::quiet_NaN())})
    EXPECT_EQ(sum(e), 0);
}

}  // namespace
}  // namespace sonoband
