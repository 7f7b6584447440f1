// The cues of recording, as sound. Pure: a cue in, samples out.
#pragma once

#include <cstdint>
#include <vector>

namespace sonoband {

enum class Cue : std::uint8_t {
  started,  // recording: two tones that rise
  ended,    // it has stopped: two that fall
  refused,  // a press did not start it: one low tone, twice
};
constexpr int cue_count = 3;

constexpr int cue_rate_hz = 48000;

// One channel; a quarter of full scale at most: heard beside a scanner's fan, no start for the patient.
// Shorter than 0.3 s, and silent at both ends.
std::vector<std::int16_t> samples_of(Cue cue);

}  // namespace sonoband
