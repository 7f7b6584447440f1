#include "hal/footswitch/debounce.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace sonoband {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Cause = PedalEvent::Cause;

Stamp at(int ms) {
  return Stamp(milliseconds(ms));
}

// A pedal whose level at start was read as open and settled.
struct Pedal {
  Debounce debounce;
  std::uint64_t sequence = 0;
  std::vector<PedalEvent> events;

  explicit Pedal(bool closed_at_start = false) {
    edge(at(0), closed_at_start);
    tick(at(100));
  }
  void edge(Stamp t, bool closed) {
    if (const auto e = debounce.edge({.time = t, .closed = closed, .sequence = sequence++}))
      events.push_back(*e);
  }
  void tick(Stamp t) {
    if (const auto e = debounce.tick(t)) events.push_back(*e);
  }
};

TEST(Debounce, APressIsStampedAtItsFirstEdgeAndToldAfterTheQuiet) {
  Pedal p;
  p.edge(at(1000), true);
  p.edge(at(1002), false);
  p.edge(at(1003), true);
  p.tick(at(1027));
  EXPECT_TRUE(p.events.empty());
  EXPECT_EQ(p.debounce.next_tick(), at(1028));
  p.tick(at(1028));
  ASSERT_EQ(p.events.size(), 1U);
  EXPECT_TRUE(p.events[0].pressed);
  EXPECT_EQ(p.events[0].time, at(1000));
  p.edge(at(2000), false);
  p.tick(at(2500));
  ASSERT_EQ(p.events.size(), 2U);
  EXPECT_FALSE(p.events[1].pressed);
  EXPECT_EQ(p.events[1].time, at(2000));
  EXPECT_EQ(p.events[1].cause, Cause::contact);
}

TEST(Debounce, ASpikeIsNothing) {
  Pedal p;
  p.edge(at(1000), true);
  p.edge(at(1010), false);
  p.tick(at(1100));
  EXPECT_TRUE(p.events.empty());
  p.edge(at(2000), true);
  p.tick(at(2100));
  p.edge(at(2200), false);
  p.edge(at(2203), true);
  p.tick(at(2300));
  EXPECT_EQ(p.events.size(), 1U);
  EXPECT_TRUE(p.debounce.pressed());
}

TEST(Debounce, APedalHeldAtPowerUpMustComeUpFirst) {
  Pedal p(true);
  p.edge(at(200), false);  // a bounce of the held contact is no release
  p.edge(at(201), true);
  p.tick(at(300));
  EXPECT_FALSE(p.debounce.armed());
  EXPECT_TRUE(p.events.empty());
  p.edge(at(400), false);
  p.tick(at(500));
  EXPECT_TRUE(p.debounce.armed());
  EXPECT_TRUE(p.events.empty());
  p.edge(at(600), true);
  p.tick(at(700));
  EXPECT_EQ(p.events.size(), 1U);
}

TEST(Debounce, WithoutALevelAtStartTheFirstPressDoesNotCount) {
  Debounce d;
  EXPECT_FALSE(d.edge({.time = at(10), .closed = true, .sequence = 1}));
  EXPECT_FALSE(d.tick(at(100)));
  EXPECT_FALSE(d.pressed());
}

TEST(Debounce, AStuckPedalIsLetGoAndMustComeUp) {
  Pedal p;
  p.edge(at(1000), true);
  p.tick(at(1100));
  EXPECT_EQ(p.debounce.next_tick(), at(1000) + seconds(120));
  p.tick(at(1000) + seconds(120) - milliseconds(1));
  EXPECT_EQ(p.events.size(), 1U);
  p.tick(at(1000) + seconds(125));
  ASSERT_EQ(p.events.size(), 2U);
  EXPECT_FALSE(p.events[1].pressed);
  EXPECT_EQ(p.events[1].cause, Cause::stuck);
  EXPECT_EQ(p.events[1].time, at(1000) + seconds(120));
  EXPECT_FALSE(p.debounce.armed());
  p.edge(at(130000), false);
  p.tick(at(130100));
  EXPECT_EQ(p.events.size(), 2U);  // released already
  p.edge(at(131000), true);
  p.tick(at(131100));
  EXPECT_EQ(p.events.size(), 3U);
}

TEST(Debounce, ALostPedalIsReleased) {
  Pedal p;
  p.edge(at(1000), true);
  p.tick(at(1100));
  const auto event = p.debounce.pedal_lost(at(1500));
  ASSERT_TRUE(event);
  EXPECT_FALSE(event->pressed);
  EXPECT_EQ(event->cause, Cause::lost);
  EXPECT_EQ(event->time, at(1500));
  EXPECT_FALSE(p.debounce.pedal_lost(at(1600)));
  // Back, and still held down: not a press until it has been up.
  p.sequence = 0;
  p.edge(at(3000), true);
  p.tick(at(3100));
  EXPECT_EQ(p.events.size(), 1U);
  EXPECT_FALSE(p.debounce.pressed());
}

TEST(Debounce, LostEdgesAreCountedAndTheLevelReadAgainDecides) {
  Pedal p;
  p.edge(at(1000), true);
  p.tick(at(1100));
  p.sequence += 3;  // release, press and release, of which the kernel kept the last
  p.edge(at(2000), false);
  p.tick(at(2100));
  EXPECT_EQ(p.debounce.lost_edges(), 3U);
  ASSERT_EQ(p.events.size(), 2U);
  EXPECT_EQ(p.events[1].time, at(2000));
  // The level is what it was: nothing to tell, but counted.
  p.sequence += 2;
  p.edge(at(3000), false);
  p.tick(at(3100));
  EXPECT_EQ(p.events.size(), 2U);
  EXPECT_EQ(p.debounce.lost_edges(), 5U);
}

struct Truth {
  std::vector<PedalEdge> edges;
  std::vector<PedalEvent> events;
};

// Presses of at least 60 ms, 60 ms apart, each change bouncing up to 12 times, always under 24 ms between
// edges.
Truth random_pedal(std::mt19937_64& random) {
  std::uniform_int_distribution<int> pause(60000, 900000);
  std::uniform_int_distribution<int> pairs(0, 6);
  std::uniform_int_distribution<int> gap(1, 4000);
  Truth truth;
  truth.edges.push_back({.time = at(0), .closed = false, .sequence = 0});
  Stamp t = at(100);
  for (int change = 0; change < 20; ++change) {
    const bool closed = change % 2 == 0;
    t += microseconds(pause(random));
    truth.events.push_back({.time = t, .pressed = closed});
    truth.edges.push_back({.time = t, .closed = closed, .sequence = truth.edges.size()});
    const int bounces = 2 * pairs(random);
    for (int b = 0; b < bounces; ++b) {
      t += microseconds(gap(random));
      truth.edges.push_back({.time = t, .closed = (b % 2 == 0) != closed, .sequence = truth.edges.size()});
    }
  }
  return truth;
}

TEST(Debounce, NoPressIsLostOrInventedWhateverTheBounceAndTheTicks) {
  std::mt19937_64 random(11);
  for (int trial = 0; trial < 300; ++trial) {
    const Truth truth = random_pedal(random);
    const int tick_us = trial % 3 == 0 ? 1000 : trial % 3 == 1 ? 170000 : 1 << 30;  // often, seldom, never
    Debounce d;
    std::vector<PedalEvent> events;
    const auto keep = [&](const std::optional<PedalEvent>& e) {
      if (e) events.push_back(*e);
    };
    Stamp ticked = at(0);
    for (const PedalEdge& e : truth.edges) {
      for (; ticked < e.time && e.time - at(0) > milliseconds(50); ticked += microseconds(tick_us)) {
        keep(d.tick(ticked));
      }
      keep(d.edge(e));
    }
    keep(d.tick(truth.edges.back().time + seconds(1)));
    ASSERT_EQ(events.size(), truth.events.size()) << trial;
    for (std::size_t i = 0; i < events.size(); ++i) {
      EXPECT_EQ(events[i].time, truth.events[i].time);
      EXPECT_EQ(events[i].pressed, truth.events[i].pressed);
    }
    EXPECT_EQ(d.lost_edges(), 0U);
  }
}

// An edge that the kernel hands over after a tick has passed its stamp must not make a second press.
TEST(Debounce, ALateEdgeOfABounceInventsNothing) {
  Pedal p;
  p.edge(at(1000), true);
  p.tick(at(1030));
  p.edge(at(1004), false);
  p.edge(at(1005), true);
  p.tick(at(1100));
  EXPECT_EQ(p.events.size(), 1U);
}

}  // namespace
}  // namespace sonoband
