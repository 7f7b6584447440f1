#include <alsa/asoundlib.h>

#include <string>

#include "hal/sound/cue.h"
#include "hal/sound/sound_sink.h"

namespace sonoband {
namespace {

// ALSA tells of every missing card on stderr; works() tells the operator once.
void say_nothing(const char*, int, const char*, int, const char*, ...) {}

class AlsaSink final : public SoundSink {
 public:
  explicit AlsaSink(const char* device) : device_(device) { snd_lib_error_set_handler(say_nothing); }

  bool works() override {
    const bool opened = open();
    close();
    return opened;
  }

  bool play(std::span<const std::int16_t> samples) override {
    if (!open()) return false;
    bool well = true;
    while (!samples.empty() && well) {
      const snd_pcm_sframes_t written = snd_pcm_writei(pcm_, samples.data(), samples.size());
      if (written > 0) samples = samples.subspan(static_cast<std::size_t>(written));
      // An underrun is restarted; a card that is gone is not.
      if (written <= 0)
        well = snd_pcm_recover(pcm_, written == 0 ? -EPIPE : static_cast<int>(written), 1) >= 0;
    }
    well = well && snd_pcm_drain(pcm_) >= 0;
    close();
    return well;
  }

 private:
  bool open() {
    constexpr unsigned latency_us = 40'000;  // of the card's buffer: the cue comes with the press
    // Not blocking: a card that another program holds would make the thread wait for ever.
    if (snd_pcm_open(&pcm_, device_.c_str(), SND_PCM_STREAM_PLAYBACK, SND_PCM_NONBLOCK) < 0) {
      pcm_ = nullptr;
      return false;
    }
    snd_pcm_nonblock(pcm_, 0);
    const int set = snd_pcm_set_params(pcm_, SND_PCM_FORMAT_S16, SND_PCM_ACCESS_RW_INTERLEAVED, 1,
                                       cue_rate_hz, 1, latency_us);
    if (set < 0) close();
    return set >= 0;
  }
  void close() {
    if (pcm_ != nullptr) snd_pcm_close(pcm_);
    pcm_ = nullptr;
  }

  std::string device_;
  snd_pcm_t* pcm_ = nullptr;
};

}  // namespace

std::unique_ptr<SoundSink> alsa_sink(const char* device) {
  return std::make_unique<AlsaSink>(device);
}

}  // namespace sonoband
