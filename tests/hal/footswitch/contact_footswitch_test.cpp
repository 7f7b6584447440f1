// Pedals on made-up contacts: wiring, lost edges, faults of the cable, unplugging.
#include "hal/footswitch/contact_footswitch.h"

#include <gtest/gtest.h>

#include "hal/footswitch/debounce.h"
#include "tests/hal/footswitch/fake_contacts.h"

namespace sonoband {
namespace {

using test::at;

using test::pedal::Rig;

TEST(ContactFootswitch, LevelFirstThenEveryEdgeAtItsStamp) {
  Rig rig;
  rig.wires.events = {{1, 0, true}, {1.001, 0, false}, {1.002, 0, true}, {2, 0, false}};
  rig.run_to(3);
  ASSERT_EQ(rig.edges.size(), 5u);
  EXPECT_EQ(rig.edges[0].sequence, 0u);
  EXPECT_FALSE(rig.edges[0].closed);
  for (std::size_t i = 1; i < 5; ++i) EXPECT_EQ(rig.edges[i].sequence, i);
  EXPECT_EQ(rig.edges[1].time, at(1));
  EXPECT_TRUE(rig.edges[3].closed);
  EXPECT_EQ(rig.edges[4].time, at(2));
  EXPECT_EQ(rig.health().state, DeviceState::running);
  EXPECT_EQ(rig.wires.asked[0].name, "FOOTSWITCH_NO");
  EXPECT_TRUE(rig.wires.asked[0].active_low);
}

// Found on the virtual board: libgpiod 1.6 has no count, and the kernel drops the newest edges when nobody
// reads.
TEST(ContactFootswitch, EdgesLostAtTheEndOfABurstAreSeenByTheLevel) {
  Rig rig;
  rig.wires.events = {{1, 0, true}, {1.001, 0, false}, {1.002, 0, true}};
  rig.run_to(1.0022);           // the last of them is read
  rig.wires.levels[0] = false;  // the release that nobody told
  rig.run_to(1.2);
  ASSERT_EQ(rig.edges.size(), 5u);
  EXPECT_FALSE(rig.edges[4].closed);
  EXPECT_EQ(rig.edges[4].sequence, 5u);  // one is missing before it
  EXPECT_EQ(rig.health().lost, 1u);
  rig.run_to(3);
  EXPECT_EQ(rig.edges.size(), 5u);
}

// The release, and later a press: each alone, seconds after the last edge and with none behind it.
TEST(ContactFootswitch, ALoneLostEdgeIsFoundWithinAThirdOfASecond) {
  Rig rig;
  rig.wires.events = {{1, 0, true}};
  rig.run_to(5);
  ASSERT_EQ(rig.edges.size(), 2u);
  for (const bool down : {false, true}) {
    const double lost_s = down ? 9 : 5;
    rig.edges.clear();
    rig.wires.levels[0] = down;
    rig.run_to(lost_s + 3);
    ASSERT_EQ(rig.edges.size(), 1u);
    EXPECT_EQ(rig.edges[0].closed, down);
    EXPECT_EQ(rig.edges[0].sequence, down ? 5u : 3u) << "one is missing before it";
    EXPECT_GE(rig.edges[0].time, at(lost_s + 0.05)) << "at the time it was found: when it was is not known";
    EXPECT_LE(rig.edges[0].time, at(lost_s + 0.35));
    EXPECT_EQ(rig.health().lost, down ? 2u : 1u);
    rig.run_to(lost_s + 4);
  }
}

// Shorter than the level is watched for: no edge was lost, its stamps would be made up.
TEST(ContactFootswitch, ALevelThatDiffersForAMomentIsNoLostEdge) {
  Rig rig;
  rig.wires.events = {{1, 0, true}};
  rig.run_to(3);
  for (int i = 0; i < 50; ++i) {
    rig.wires.levels[0] = false;
    rig.run_to(3 + 0.2 * i + 0.02);
    rig.wires.levels[0] = true;
    rig.run_to(3 + 0.2 * i + 0.2);
  }
  EXPECT_EQ(rig.edges.size(), 2u);
  EXPECT_EQ(rig.health().lost, 0u);
}

TEST(ContactFootswitch, AnEdgeOnItsWayIsNoLostOne) {
  Rig rig;
  rig.wires.events = {{1, 0, true}};
  rig.run_to(1.0002);
  rig.wires.levels[0] = false;  // 50 ms before its edge is handed over
  rig.wires.events = {{1.05, 0, false}};
  rig.run_to(2);
  ASSERT_EQ(rig.edges.size(), 3u);
  EXPECT_EQ(rig.edges[2].sequence, 2u);
  EXPECT_EQ(rig.health().lost, 0u);
}

TEST(ContactFootswitch, AJumpOfTheKernelsCountIsReadAgain) {
  Rig rig;
  // The release at 1.5 is lost, and so is the press after it: the level read says up.
  rig.wires.events = {{1, 0, true, 1}, {2, 0, true, 4}};
  rig.run_to(1.9);
  rig.wires.levels[0] = false;
  rig.wires.events.front().active = false;
  rig.run_to(3);
  ASSERT_EQ(rig.edges.size(), 3u);
  EXPECT_EQ(rig.edges[2].sequence, 4u);
  EXPECT_FALSE(rig.edges[2].closed);
  EXPECT_EQ(rig.health().lost, 2u);
}

TEST(ContactFootswitch, WithoutACountTheSameLevelTwiceIsALostEdge) {
  Rig rig;
  rig.wires.events = {{1, 0, true}, {2, 0, true}};
  rig.run_to(3);
  ASSERT_EQ(rig.edges.size(), 3u);
  EXPECT_EQ(rig.edges[2].sequence, 3u);
  EXPECT_EQ(rig.health().lost, 1u);
}

TEST(ContactFootswitch, AnOverflowReadsEveryLevel) {
  Rig rig;
  rig.wires.events = {{1, 0, true}, {1.5, 0, false, 0, ContactStatus::overflow}};
  rig.run_to(1.48);
  rig.wires.levels[0] = false;
  rig.run_to(2);
  ASSERT_EQ(rig.edges.size(), 3u);
  EXPECT_FALSE(rig.edges[2].closed);
  EXPECT_EQ(rig.edges[2].sequence, 3u);
}

TEST(ContactFootswitch, APairSaysWhenItsCableIsCut) {
  Rig rig(true);
  rig.wires.events = {{1, 1, false}, {1.01, 0, true}, {2, 0, false}, {2.01, 1, true}};
  rig.run_to(3);
  ASSERT_EQ(rig.edges.size(), 3u) << "the travel between its contacts is no edge of the pedal";
  EXPECT_EQ(rig.edges[1].time, at(1.01));
  EXPECT_EQ(rig.edges[2].time, at(2));
  EXPECT_EQ(rig.health().state, DeviceState::running);
  rig.wires.events = {{4, 1, false}};  // nobody pressed: the NC wire is cut
  rig.run_to(4.04);
  EXPECT_EQ(rig.health().state, DeviceState::running);
  rig.run_to(4.2);
  EXPECT_EQ(rig.health().state, DeviceState::fault);
  rig.wires.events = {{5, 1, true}};
  rig.run_to(5.1);
  EXPECT_EQ(rig.health().state, DeviceState::running);
}

TEST(ContactFootswitch, AShortWhileDownCountsAsReleased) {
  Rig rig(true);
  rig.wires.events = {{1, 1, false}, {1.01, 0, true}, {2, 1, true}};
  rig.run_to(3);
  ASSERT_EQ(rig.edges.size(), 3u);
  EXPECT_FALSE(rig.edges[2].closed);
  EXPECT_EQ(rig.health().state, DeviceState::fault);
}

TEST(ContactFootswitch, UnpluggedWhileDownIsReleasedAndComesBackWithItsLevel) {
  Rig rig;
  rig.wires.events = {{1, 0, true}, {2, 0, true, 0, ContactStatus::gone}};
  rig.run_to(1.5);
  rig.wires.opening = ContactStatus::no_such_line;
  rig.run_to(2.5);
  ASSERT_EQ(rig.edges.size(), 3u);
  EXPECT_FALSE(rig.edges[2].closed);
  EXPECT_EQ(rig.health().state, DeviceState::absent);
  rig.wires.opening = ContactStatus::ok;
  rig.run_to(5);
  ASSERT_EQ(rig.edges.size(), 4u);
  EXPECT_EQ(rig.edges[3].sequence, 0u);
  EXPECT_TRUE(rig.edges[3].closed) << "still held: the debouncer wants to see it up first";
  Debounce debounce;
  std::size_t presses = 0;
  for (const PedalEdge& e : rig.edges) {
    if (const auto tick = debounce.tick(e.time)) presses += tick->pressed ? 1 : 0;
    if (const auto event = debounce.edge(e)) presses += event->pressed ? 1 : 0;
  }
  EXPECT_EQ(presses, 1u);
}

TEST(ContactFootswitch, EveryReasonItCannotOpenIsSaid) {
  for (const ContactStatus why : {ContactStatus::no_such_line, ContactStatus::access_denied,
                                  ContactStatus::busy, ContactStatus::no_bias}) {
    Rig rig;
    rig.wires.opening = why;
    rig.run_to(3.5);
    EXPECT_STRNE(rig.health().reason, "");
    EXPECT_NEAR(rig.wires.opens, 4, 1) << "once a second";
    EXPECT_TRUE(rig.edges.empty());
  }
}

TEST(ContactFootswitch, AStampOfAnotherClockIsReplacedByTheArrival) {
  Rig rig;
  rig.wires.stamp_shift_ns = 1'000'000'000'000;
  rig.wires.events = {{1, 0, true}};
  rig.run_to(2);
  ASSERT_EQ(rig.edges.size(), 2u);
  EXPECT_EQ(rig.edges[1].time, at(1) + std::chrono::microseconds(200));
}

TEST(ContactFootswitch, AChatteringContactNeitherGrowsNorHangs) {
  Rig rig;
  for (int i = 0; i < 5000; ++i) rig.wires.events.push_back({1 + i * 1e-5, 0, i % 2 == 0});
  rig.run_to(3);
  EXPECT_EQ(rig.edges.size(), 5001u);
}

}  // namespace
}  // namespace sonoband
