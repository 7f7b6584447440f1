#include "hal/sound/cue_player.h"

#include <utility>

namespace sonoband {

CuePlayer::CuePlayer(std::unique_ptr<SoundSink> sink) : sink_(std::move(sink)) {
  for (int i = 0; i < cue_count; ++i) samples_[static_cast<std::size_t>(i)] = samples_of(static_cast<Cue>(i));
  thread_ = std::thread([this] { run(); });
}

CuePlayer::~CuePlayer() {
  next_ = stop;
  news_.release();
  thread_.join();
}

void CuePlayer::play(Cue cue) {
  next_ = static_cast<int>(cue);
  news_.release();
}

void CuePlayer::run() {
  works_ = sink_->works();
  for (;;) {
    news_.acquire();
    int cue = next_.load();
    while (cue != stop && !next_.compare_exchange_weak(cue, none)) {
    }
    if (cue == stop) return;
    if (cue != none) works_ = sink_->play(samples_[static_cast<std::size_t>(cue)]);
  }
}

}  // namespace sonoband
