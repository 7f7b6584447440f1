// The seam to a loudspeaker: ALSA's, or what a test listens with.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

namespace sonoband {

class SoundSink {
 public:
  virtual ~SoundSink() = default;
  // One channel at cue_rate_hz. Returns when it has been heard, or false at once when there is no
  // loudspeaker.
  virtual bool play(std::span<const std::int16_t> samples) = 0;
  // Whether there is one; takes nothing and makes no sound.
  virtual bool works() = 0;
};

// ALSA's device of this name; opened for each sound only, so that a card plugged in later is found.
std::unique_ptr<SoundSink> alsa_sink(const char* device = "default");

}  // namespace sonoband
