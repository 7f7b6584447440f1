// Cues as samples, and the thread that plays them.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <semaphore>

#include "hal/sound/cue.h"
#include "hal/sound/cue_player.h"

namespace sonoband {
namespace {

// How much of a frequency is in a stretch of samples (one bin of a Fourier transform), per sample.
double strength(std::span<const std::int16_t> samples, double hz) {
  double re = 0;
  double im = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double angle = 2 * std::numbers::pi * hz * static_cast<double>(i) / cue_rate_hz;
    re += samples[i] * std::cos(angle);
    im += samples[i] * std::sin(angle);
  }
  return std::hypot(re, im) / static_cast<double>(samples.size());
}

double higher_minus_lower(std::span<const std::int16_t> samples) {
  return strength(samples, 880) - strength(samples, 660);
}

TEST(Cues, RiseAtTheStartAndFallAtTheEnd) {
  const auto started = samples_of(Cue::started);
  const auto ended = samples_of(Cue::ended);
  constexpr std::size_t part = 3000;  // 62 ms
  EXPECT_LT(higher_minus_lower(std::span(started).first(part)), -1000);
  EXPECT_GT(higher_minus_lower(std::span(started).last(part)), 1000);
  EXPECT_GT(higher_minus_lower(std::span(ended).first(part)), 1000);
  EXPECT_LT(higher_minus_lower(std::span(ended).last(part)), -1000);
  const auto refused = samples_of(Cue::refused);
  EXPECT_GT(strength(std::span(refused).first(part), 220), 1000);
}

TEST(Cues, AreShortSoftAndDoNotClick) {
  for (const Cue cue : {Cue::started, Cue::ended, Cue::refused}) {
    const auto samples = samples_of(cue);
    EXPECT_LT(samples.size(), 0.3 * cue_rate_hz);
    EXPECT_EQ(samples.front(), 0);
    EXPECT_EQ(samples.back(), 0);
    int loudest = 0;
    int jump = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      loudest = std::max(loudest, std::abs(samples[i]));
      jump = std::max(jump, std::abs(samples[i] - samples[i - 1]));
    }
    EXPECT_NEAR(loudest, 8192, 100);
    EXPECT_LT(jump, 8192 * 2 * 3.15 * 880 / cue_rate_hz) << "steeper than its tone is a click";
  }
}

// What the tests listen with.
struct Heard {
  std::vector<std::size_t> lengths;
  std::counting_semaphore<> begun{0};
  std::counting_semaphore<> may_end{0};
  bool card = true;
};

class Ear final : public SoundSink {
 public:
  explicit Ear(Heard& heard) : heard_(heard) {}
  bool works() override { return heard_.card; }
  bool play(std::span<const std::int16_t> samples) override {
    if (!heard_.card) return false;
    heard_.lengths.push_back(samples.size());
    heard_.begun.release();
    heard_.may_end.acquire();
    return true;
  }

 private:
  Heard& heard_;
};

TEST(ACuePlayer, IsNotWaitedForAndPlaysTheNewestOfThoseThatWait) {
  Heard heard;
  {
    CuePlayer player(std::make_unique<Ear>(heard));
    player.play(Cue::refused);
    heard.begun.acquire();  // it sounds, and goes on
    for (int i = 0; i < 100; ++i) player.play(Cue::started);
    player.play(Cue::refused);
    heard.may_end.release(2);
    heard.begun.acquire();
    EXPECT_TRUE(player.works());
  }
  const std::size_t refused = samples_of(Cue::refused).size();
  EXPECT_EQ(heard.lengths, (std::vector<std::size_t>{refused, refused}));
}

TEST(ACuePlayer, WithoutACardIsSilentAndSaysSo) {
  Heard heard;
  heard.card = false;
  {
    CuePlayer player(std::make_unique<Ear>(heard));
    player.play(Cue::started);
    EXPECT_FALSE(player.works());
  }
  EXPECT_TRUE(heard.lengths.empty());
}

// "null" is ALSA's card that swallows all; it is there on every machine with ALSA's library.
TEST(AlsaSound, PlaysOnACardAndRefusesOneThatIsNotThere) {
  const auto none = alsa_sink("no-such-card");
  EXPECT_FALSE(none->works());
  EXPECT_FALSE(none->play(samples_of(Cue::started)));
  const auto null = alsa_sink("null");
  EXPECT_TRUE(null->works());
  EXPECT_TRUE(null->play(samples_of(Cue::started)));
}

}  // namespace
}  // namespace sonoband
