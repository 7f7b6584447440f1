#include "app/cart/state_machine.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace sonoband::cart {
namespace {

using Kind = Event::Kind;
using std::chrono::milliseconds;

Stamp at_ms(int ms) {
  return Stamp(milliseconds(ms));
}

struct Cart {
  MachineSettings settings;
  Machine machine;

  Transition give(Kind kind, int ms) {
    const Transition t = step(machine, {kind, at_ms(ms)}, settings);
    machine = t.next;
    return t;
  }
};

Cart live(PedalMode mode = PedalMode::hold) {
  Cart cart;
  cart.settings.pedal = mode;
  cart.give(Kind::frames_up, 0);
  EXPECT_EQ(cart.machine.state, State::live);
  return cart;
}

TEST(StateMachine, HoldRecordsFromPressToRelease) {
  Cart cart = live();
  const Transition press = cart.give(Kind::pedal_down, 1000);
  EXPECT_EQ(press.action, Action::begin_sweep);
  EXPECT_EQ(press.at, at_ms(1000));
  EXPECT_EQ(cart.machine.state, State::recording);
  EXPECT_EQ(cart.give(Kind::tick, 500000).action, Action::none) << "a held pedal has its own limit";
  const Transition release = cart.give(Kind::pedal_up, 3000);
  EXPECT_EQ(release.action, Action::end_sweep);
  EXPECT_EQ(release.at, at_ms(3000));
  EXPECT_EQ(release.note, Note::none);
  EXPECT_EQ(cart.machine.state, State::review);
  EXPECT_EQ(cart.give(Kind::pedal_down, 4000).action, Action::begin_sweep) << "another sweep from the review";
}

TEST(StateMachine, ToggleRecordsFromPressToPress) {
  Cart cart = live(PedalMode::toggle);
  EXPECT_EQ(cart.give(Kind::pedal_down, 1000).action, Action::begin_sweep);
  EXPECT_EQ(cart.give(Kind::pedal_up, 1100).action, Action::none);
  const Transition slip = cart.give(Kind::pedal_down, 1299);
  EXPECT_EQ(slip.action, Action::none);
  EXPECT_EQ(slip.note, Note::too_soon);
  EXPECT_EQ(cart.give(Kind::pedal_down, 1300).action, Action::end_sweep);
  EXPECT_EQ(cart.machine.state, State::review);
}

TEST(StateMachine, WhatNobodyHoldsEndsByItself) {
  for (const Kind start : {Kind::pedal_down, Kind::button_down}) {
    Cart cart = live(PedalMode::toggle);
    cart.give(start, 1000);
    EXPECT_EQ(cart.give(Kind::tick, 120999).action, Action::none);
    const Transition t = cart.give(Kind::tick, 121500);
    EXPECT_EQ(t.action, Action::end_sweep);
    EXPECT_EQ(t.at, at_ms(121000));
    EXPECT_EQ(t.note, Note::too_long);
  }
}

TEST(StateMachine, ButtonTogglesWhateverThePedalDoes) {
  Cart cart = live();
  EXPECT_EQ(cart.give(Kind::button_down, 1000).action, Action::begin_sweep);
  EXPECT_EQ(cart.give(Kind::pedal_up, 1500).action, Action::none) << "the pedal did not start this";
  EXPECT_EQ(cart.give(Kind::button_down, 2000).action, Action::end_sweep);
  // And it stops what a pedal holds, at once.
  cart.give(Kind::pedal_down, 3000);
  EXPECT_EQ(cart.give(Kind::button_down, 3100).action, Action::end_sweep);
  EXPECT_EQ(cart.give(Kind::pedal_up, 3200).action, Action::none);
}

TEST(StateMachine, LosingThePedalOrThePicturesEndsTheSweep) {
  for (const PedalMode mode : {PedalMode::hold, PedalMode::toggle}) {
    Cart cart = live(mode);
    cart.give(Kind::pedal_down, 1000);
    const Transition lost = cart.give(Kind::pedal_lost, 2000);
    EXPECT_EQ(lost.action, Action::end_sweep);
    EXPECT_EQ(lost.note, Note::pedal_lost);
    cart.give(Kind::pedal_down, 3000);
    const Transition dark = cart.give(Kind::frames_down, 4000);
    EXPECT_EQ(dark.action, Action::end_sweep);
    EXPECT_EQ(dark.note, Note::frames_lost);
    EXPECT_EQ(cart.machine.state, State::review) << "what was recorded is shown";
    EXPECT_EQ(cart.give(Kind::pedal_down, 5000).note, Note::no_frames);
    cart.give(Kind::show_live, 6000);
    EXPECT_EQ(cart.machine.state, State::idle);
  }
}

TEST(StateMachine, AFullMemoryEndsOrRefusesASweepAndSaysSo) {
  Cart cart = live();
  cart.give(Kind::pedal_down, 1000);
  const Transition full = cart.give(Kind::sweep_full, 2500);
  EXPECT_EQ(full.action, Action::end_sweep);
  EXPECT_EQ(full.at, at_ms(2500));
  EXPECT_EQ(full.note, Note::sweep_full);
  EXPECT_EQ(cart.give(Kind::pedal_up, 3000).action, Action::none) << "it has ended already";
  cart.give(Kind::pedal_down, 4000);
  const Transition refused = cart.give(Kind::sweep_refused, 4001);
  EXPECT_EQ(refused.action, Action::none);
  EXPECT_EQ(refused.note, Note::no_room);
  EXPECT_EQ(cart.machine.state, State::live);
}

TEST(StateMachine, NothingStartsWithoutPictures) {
  Cart cart;
  const Transition t = cart.give(Kind::pedal_down, 10);
  EXPECT_EQ(t.action, Action::none);
  EXPECT_EQ(t.note, Note::no_frames);
  EXPECT_EQ(cart.machine.state, State::idle);
}

TEST(StateMachine, NothingStartsWithoutRoomOnTheDisk) {
  Cart cart = live();
  cart.give(Kind::disk_full, 500);
  const Transition refused = cart.give(Kind::pedal_down, 1000);
  EXPECT_EQ(refused.action, Action::none);
  EXPECT_EQ(refused.note, Note::no_disk);
  EXPECT_EQ(cart.machine.state, State::live);
  EXPECT_EQ(cart.give(Kind::button_down, 1500).note, Note::no_disk);
  cart.give(Kind::pedal_up, 1600);
  cart.give(Kind::disk_has_room, 2000);
  EXPECT_EQ(cart.give(Kind::pedal_down, 3000).action, Action::begin_sweep);
  // What has begun goes on.
  EXPECT_EQ(cart.give(Kind::disk_full, 3500).action, Action::none);
  EXPECT_EQ(cart.machine.state, State::recording);
  EXPECT_EQ(cart.give(Kind::pedal_up, 4000).action, Action::end_sweep);
}

TEST(StateMachine, ShowLiveLeavesTheReviewOnly) {
  Cart cart = live();
  cart.give(Kind::pedal_down, 1000);
  cart.give(Kind::show_live, 1500);
  EXPECT_EQ(cart.machine.state, State::recording);
  cart.give(Kind::pedal_up, 2000);
  cart.give(Kind::show_live, 2500);
  EXPECT_EQ(cart.machine.state, State::live);
}

// Laws on random events: begins and ends alternate, the state says which of them was last, a sweep never ends
// before it began, and every end or refusal that was not asked for has a sentence.
TEST(StateMachine, BeginsAndEndsAlternateWhateverHappens) {
  std::mt19937_64 random(11);
  for (int run = 0; run < 200; ++run) {
    Cart cart;
    cart.settings.pedal = run % 2 == 0 ? PedalMode::hold : PedalMode::toggle;
    bool open = false;
    Stamp begun{};
    int ms = 0;
    for (int i = 0; i < 300; ++i) {
      ms += static_cast<int>(random() % 900);
      const Kind kind = static_cast<Kind>(random() % (static_cast<int>(Kind::tick) + 1));
      // News may be late, but not so late that it is out of order.
      const Transition t = cart.give(kind, ms - static_cast<int>(random() % 300));
      if (t.action == Action::begin_sweep) {
        ASSERT_FALSE(open);
        open = true;
        begun = t.at;
      } else if (t.action == Action::end_sweep) {
        ASSERT_TRUE(open);
        ASSERT_GE(t.at, begun);
        open = false;
      } else if (kind == Kind::sweep_refused && open) {
        open = false;  // it never began
      }
      ASSERT_EQ(open, cart.machine.state == State::recording);
      ASSERT_EQ(t.note == Note::none, std::string(sentence_of(t.note)).empty());
    }
  }
}

}  // namespace
}  // namespace sonoband::cart
