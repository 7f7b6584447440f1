// Plays cues on a thread of its own: whoever asks for one never waits for the loudspeaker.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <semaphore>
#include <thread>
#include <vector>

#include "hal/sound/cue.h"
#include "hal/sound/sound_sink.h"

namespace sonoband {

class CuePlayer {
 public:
  explicit CuePlayer(std::unique_ptr<SoundSink> sink);
  ~CuePlayer();  // after the cue that is being heard
  CuePlayer(const CuePlayer&) = delete;
  CuePlayer& operator=(const CuePlayer&) = delete;

  // Any thread; takes no lock and no heap. Of cues that wait, only the newest is heard: an old one would be
  // wrong.
  void play(Cue cue);
  // Whether there is a loudspeaker: as last tried, false before the first try has ended.
  bool works() const { return works_; }

 private:
  void run();

  static constexpr int none = -1;
  static constexpr int stop = -2;
  std::unique_ptr<SoundSink> sink_;
  std::array<std::vector<std::int16_t>, cue_count> samples_;
  std::atomic<int> next_{none};
  std::atomic<bool> works_{false};
  std::counting_semaphore<> news_{0};
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace sonoband
