#include "hal/sound/cue.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sonoband {
namespace {

constexpr double loudness = 0.25;
constexpr double fade_s = 0.008;  // shorter is heard as a click

void add_tone(std::vector<std::int16_t>& samples, double hz, double length_s) {
  const int count = static_cast<int>(length_s * cue_rate_hz);
  for (int i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / cue_rate_hz;
    const double left = static_cast<double>(count - 1 - i) / cue_rate_hz;
    const double swell = std::min({1.0, t / fade_s, left / fade_s});
    const double value = loudness * swell * std::sin(2 * std::numbers::pi * hz * t);
    samples.push_back(static_cast<std::int16_t>(std::lround(32767 * value)));
  }
}

void add_silence(std::vector<std::int16_t>& samples, double length_s) {
  samples.insert(samples.end(), static_cast<std::size_t>(length_s * cue_rate_hz), 0);
}

}  // namespace

std::vector<std::int16_t> samples_of(Cue cue) {
  constexpr double low_hz = 660;
  constexpr double high_hz = 880;  // a fourth above: up and down are told apart by ear
  std::vector<std::int16_t> samples;
  switch (cue) {
    case Cue::started:
      add_tone(samples, low_hz, 0.07);
      add_tone(samples, high_hz, 0.12);
      break;
    case Cue::ended:
      add_tone(samples, high_hz, 0.07);
      add_tone(samples, low_hz, 0.12);
      break;
    case Cue::refused:
      add_tone(samples, low_hz / 3, 0.11);
      add_silence(samples, 0.05);
      add_tone(samples, low_hz / 3, 0.11);
      break;
  }
  return samples;
}

}  // namespace sonoband
