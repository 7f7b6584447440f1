#include <gtest/gtest.h>

#include <vector>

#include "hal/footswitch/debounce.h"
#include "hal/sim/sim_footswitch.h"
#include "hal/sim/virtual_clock.h"

namespace sonoband::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const Stamp origin(std::chrono::hours(1));

std::vector<PedalEdge> edges_until(SimFootswitch& pedal, Clock& clock, Stamp end) {
  std::vector<PedalEdge> all;
  while (clock.now() < end) {
    PedalEdge e;
    if (pedal.read(e, milliseconds(20)) == ReadStatus::ok) all.push_back(e);
  }
  return all;
}

std::vector<PedalEvent> debounced(const std::vector<PedalEdge>& edges) {
  Debounce d;
  std::vector<PedalEvent> events;
  for (const PedalEdge& e : edges) {
    if (const auto event = d.edge(e)) events.push_back(*event);
  }
  if (const auto event = d.tick(edges.back().time + seconds(1))) events.push_back(*event);
  return events;
}

TEST(SimFootswitch, ReportsTheLevelFirstThenBouncingEdges) {
  VirtualClock clock(origin);
  SimFootswitch pedal(clock, {.script = {{milliseconds(500), milliseconds(900)}}, .seed = 3});
  pedal.start();
  const auto edges = edges_until(pedal, clock, origin + seconds(2));
  ASSERT_GE(edges.size(), 3U);
  EXPECT_EQ(edges[0].sequence, 0U);
  EXPECT_FALSE(edges[0].closed);
  EXPECT_EQ(edges[1].time, origin + milliseconds(500));
  for (std::size_t i = 1; i < edges.size(); ++i) {
    EXPECT_EQ(edges[i].sequence, i);
    EXPECT_EQ(edges[i].closed, !edges[i - 1].closed);
    EXPECT_GE(edges[i].time, edges[i - 1].time);
  }
  EXPECT_FALSE(edges.back().closed);
}

TEST(SimFootswitch, ThroughTheDebounceEveryScriptedPressComesAtItsTime) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    VirtualClock clock(origin);
    FootswitchSettings s;
    for (int i = 0; i < 8; ++i)
      s.script.push_back({milliseconds(500 * i + 200), milliseconds(500 * i + 350)});
    s.seed = seed;
    SimFootswitch pedal(clock, s);
    pedal.start();
    const auto events = debounced(edges_until(pedal, clock, origin + seconds(5)));
    ASSERT_EQ(events.size(), 16U) << seed;
    for (std::size_t i = 0; i < 8; ++i) {
      EXPECT_EQ(events[2 * i].time, origin + s.script[i].press);
      EXPECT_EQ(events[2 * i + 1].time, origin + s.script[i].release);
    }
  }
}

TEST(SimFootswitch, IsPressedLiveFromAnotherThread) {
  VirtualClock clock(origin);
  const ClockMember main(clock);
  Stamp told{};
  FootswitchSettings s;
  s.on_live_press = [&told](Stamp t) { told = t; };
  SimFootswitch pedal(clock, s);
  pedal.start();
  std::vector<PedalEdge> edges;
  ClockThread reader(clock, [&] { edges = edges_until(pedal, clock, origin + seconds(1)); });
  clock.sleep_until(origin + milliseconds(300));
  EXPECT_TRUE(pedal.press());
  clock.sleep_until(origin + milliseconds(600));
  EXPECT_TRUE(pedal.release());
  reader.join();
  const auto events = debounced(edges);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].time, origin + milliseconds(300));
  EXPECT_EQ(events[1].time, origin + milliseconds(600));
  EXPECT_EQ(told, origin + milliseconds(300));
}

TEST(SimFootswitch, AFullQueueRefuses) {
  VirtualClock clock(origin);
  SimFootswitch pedal(clock, {});
  pedal.start();
  for (int i = 0; i < 64; ++i) EXPECT_TRUE(i % 2 == 0 ? pedal.press() : pedal.release());
  EXPECT_FALSE(pedal.press());
}

TEST(SimFootswitch, LostEdgesShowAsAJump) {
  VirtualClock clock(origin);
  FootswitchSettings s{
      .script = {{milliseconds(200), milliseconds(400)}, {milliseconds(600), milliseconds(800)}}};
  s.faults = {{.kind = PedalFault::Kind::lose_edges, .from = milliseconds(390), .until = milliseconds(650)}};
  s.bounces = 0;
  SimFootswitch pedal(clock, s);
  pedal.start();
  const auto edges = edges_until(pedal, clock, origin + seconds(1));
  ASSERT_EQ(edges.size(), 3U);
  EXPECT_EQ(edges[1].sequence, 1U);
  EXPECT_EQ(edges[2].sequence, 4U);
  EXPECT_FALSE(edges[2].closed);
  EXPECT_EQ(pedal.health().lost, 2U);
}

TEST(SimFootswitch, UnpluggedItIsAbsentAndReportsItsLevelWhenBack) {
  VirtualClock clock(origin);
  FootswitchSettings s{.script = {{milliseconds(200), milliseconds(1500)}}};
  s.faults = {{.kind = PedalFault::Kind::unplug, .from = milliseconds(500), .until = milliseconds(1000)}};
  s.bounces = 0;
  SimFootswitch pedal(clock, s);
  pedal.start();
  EXPECT_EQ(edges_until(pedal, clock, origin + milliseconds(700)).size(), 2U);
  EXPECT_EQ(pedal.health().state, DeviceState::absent);
  const auto edges = edges_until(pedal, clock, origin + seconds(2));
  ASSERT_EQ(edges.size(), 2U);
  EXPECT_EQ(edges[0].sequence, 0U);
  EXPECT_TRUE(edges[0].closed);
  EXPECT_EQ(edges[1].time, origin + milliseconds(1500));
  EXPECT_EQ(pedal.health().recoveries, 1U);
}

TEST(SimFootswitch, HeldAtStartIsReported) {
  VirtualClock clock(origin);
  FootswitchSettings s;
  s.held_at_start = true;
  SimFootswitch pedal(clock, s);
  pedal.start();
  const auto edges = edges_until(pedal, clock, origin + milliseconds(100));
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_TRUE(edges[0].closed);
}

}  // namespace
}  // namespace sonoband::sim
