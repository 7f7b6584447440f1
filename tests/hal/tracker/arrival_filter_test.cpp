// Device time out of late arrivals, against a clock that is known exactly.
#include "hal/tracker/arrival_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sonoband {
namespace {

const Duration period = from_seconds(1.0 / 240);

Stamp sent(double frame, double drift_ppm = 0) {
  return Stamp(std::chrono::seconds(5)) + from_seconds(frame / 240 * (1 + drift_ppm * 1e-6));
}

TEST(ArrivalFilter, ExactArrivalsComeBackExactly) {
  ArrivalFilter filter(period);
  for (std::uint32_t f = 0; f < 3000; ++f) {
    const auto t = filter.on_arrival(f, sent(f));
    EXPECT_EQ(t.has_value(), f >= 24) << f;  // after 100 ms
    if (t) {
      EXPECT_LE(std::abs((*t - sent(f)).count()), 2000) << f;  // the period is 1/3 ns short of 1/240 s
    }
  }
}

TEST(ArrivalFilter, JitterAndBurstsAndDriftAreTakenOff) {
  for (const double ppm : {-150.0, 0.0, 150.0}) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> jitter(0, 0.002);
    ArrivalFilter filter(period);
    Stamp last{};
    Stamp held{};
    double worst = 0;
    for (std::uint32_t f = 0; f < 240 * 30; ++f) {
      Stamp arrival = sent(f, ppm) + from_seconds(jitter(random));
      if (f % 501 == 500) held = arrival + from_seconds(0.05);
      arrival = std::max(arrival, held);
      const auto t = filter.on_arrival(f, arrival);
      if (!t) continue;
      EXPECT_GT(*t, last);
      EXPECT_LE(*t, arrival);
      last = *t;
      if (f > 240) worst = std::max(worst, std::abs(seconds(*t - sent(f, ppm))));
    }
    EXPECT_LT(worst, 0.0004) << ppm;  // against 2 ms of jitter and 50 ms of bursts
    EXPECT_EQ(filter.broken(), 0u);
  }
}

TEST(ArrivalFilter, LostRecordsAndTheWrapDoNotMatter) {
  ArrivalFilter filter(period);
  const std::uint32_t first = 0xffffff00U;
  for (std::uint32_t f = 0; f < 2000; f += 1 + f % 7) {
    const auto t = filter.on_arrival(first + f, sent(f));
    if (t) {
      EXPECT_LE(std::abs((*t - sent(f)).count()), 2000) << f;
    }
  }
}

TEST(ArrivalFilter, ALateFirstArrivalDoesNotLast) {
  ArrivalFilter filter(period);
  int given = 0;
  for (std::uint32_t f = 0; f < 200; ++f) {
    const Stamp arrival = std::max(sent(f), sent(12));  // the first 50 ms arrive together
    const auto t = filter.on_arrival(f, arrival);
    if (!t) continue;
    ++given;
    EXPECT_LT(std::abs(seconds(*t - sent(f))), 1e-4) << f;
  }
  EXPECT_GT(given, 150);
}

TEST(ArrivalFilter, ACountThatStandsStillOrSkipsBreaksTheLine) {
  for (const double shift_s : {0.3, 0.004, -0.3}) {
    ArrivalFilter filter(period);
    for (std::uint32_t f = 0; f < 1000; ++f) filter.on_arrival(f, sent(f));
    Stamp last{};
    for (std::uint32_t f = 1000; f < 2000; ++f) {
      const Stamp truth = sent(f) + from_seconds(shift_s);
      const auto t = filter.on_arrival(f, truth);
      if (!t) continue;
      EXPECT_GT(*t, last);
      last = *t;
      if (f > 1200) {
        EXPECT_LT(std::abs(seconds(*t - truth)), 1e-5) << f;
      }
    }
    EXPECT_EQ(filter.broken(), 1u) << shift_s;
  }
}

TEST(ArrivalFilter, TheWindowForgets) {
  ArrivalFilter filter(period);
  // The way through USB gets 1 ms longer; after the window the line has followed.
  for (std::uint32_t f = 0; f < 480; ++f) filter.on_arrival(f, sent(f));
  std::optional<Stamp> t;
  std::uint32_t f = 480;
  for (; f < 480 + 240 * 5; ++f) t = filter.on_arrival(f, sent(f) + from_seconds(0.001));
  ASSERT_TRUE(t);
  EXPECT_NEAR(seconds(*t - sent(f - 1)), 0.001, 1e-5);
  EXPECT_EQ(filter.broken(), 0u);
}

}  // namespace
}  // namespace sonoband
