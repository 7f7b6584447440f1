// The sounds of an examination.
#include "app/screen/cues.h"

#include <gtest/gtest.h>

#include <semaphore>

#include "hal/sound/cue_player.h"
#include "tests/app/screen/screen_support.h"

namespace sonoband::test {
namespace {

using cart::Note;
using cart::State;

TEST(CueOf, StartEndAndRefusal) {
  EXPECT_EQ(cue_of(State::live, State::recording, Note::none), Cue::started);
  EXPECT_EQ(cue_of(State::review, State::recording, Note::none), Cue::started);
  EXPECT_EQ(cue_of(State::recording, State::review, Note::none), Cue::ended);
  EXPECT_EQ(cue_of(State::recording, State::idle, Note::frames_lost), Cue::ended);
  for (const Note refusal : {Note::no_frames, Note::no_room, Note::no_disk})
    EXPECT_EQ(cue_of(State::live, State::live, refusal), Cue::refused);
  EXPECT_FALSE(cue_of(State::recording, State::recording, Note::too_soon));
  EXPECT_FALSE(cue_of(State::live, State::live, Note::none));
}

struct Heard {
  std::vector<std::size_t> lengths;
  std::counting_semaphore<> times{0};
  bool card = true;
};

class Ear final : public SoundSink {
 public:
  explicit Ear(Heard& heard) : heard_(heard) {}
  bool works() override { return heard_.card; }
  bool play(std::span<const std::int16_t> samples) override {
    heard_.lengths.push_back(samples.size());
    heard_.times.release();
    return heard_.card;
  }

 private:
  Heard& heard_;
};

bool comes(Heard& heard) {
  return heard.times.try_acquire_for(std::chrono::seconds(20));
}

TEST(SoundOnTheScreen, IsHeardAtStartAndEndUntilItIsSwitchedOff) {
  Heard heard;
  CuePlayer player(std::make_unique<Ear>(heard));
  ScreenCart cart;
  cart.loop().give_sound(&player);
  cart.play("await live 5\nwait 1.2\npress\nwait 0.5\n");
  ASSERT_TRUE(comes(heard));
  cart.play("release\nawait review 5\n");
  ASSERT_TRUE(comes(heard));
  EXPECT_EQ(heard.lengths,
            (std::vector<std::size_t>{samples_of(Cue::started).size(), samples_of(Cue::ended).size()}));
  cart.play(
      "tap rail/set-up\ntap set-up/sound-off\ntap rail/live\nwait 1\npress\nwait 0.5\nrelease\nawait review "
      "5\n");
  EXPECT_FALSE(heard.times.try_acquire_for(std::chrono::milliseconds(200)));
}

TEST(SoundOnTheScreen, WithoutALoudspeakerSetUpSaysSo) {
  Heard heard;
  heard.card = false;
  CuePlayer player(std::make_unique<Ear>(heard));
  ScreenCart cart;
  cart.play("await live 5\ntap rail/set-up\n");
  EXPECT_FALSE(cart.has("set-up/no-sound")) << "nobody makes a sound here";
  cart.loop().give_sound(&player);
  cart.draw();
  EXPECT_TRUE(cart.has("set-up/no-sound"));
  EXPECT_FALSE(cart.has("set-up/sound-on"));
}

}  // namespace
}  // namespace sonoband::test
