// Events to contacts: closed forms of each protocol, then any events at all.
#include "hal/touch/contacts.h"

#include <gtest/gtest.h>
#include <linux/input-event-codes.h>

#include <initializer_list>
#include <random>
#include <set>
#include <vector>

namespace sonoband {
namespace {

using Kind = TouchEvent::Kind;
using Protocol = TouchPanel::Protocol;

// 1000 x 500 units, 10 in a millimetre.
TouchPanel panel(Protocol protocol) {
  return {.name = "test",
          .path = "",
          .protocol = protocol,
          .x = {0, 999, 10},
          .y = {0, 499, 10},
          .major = {0, 255, 0}};
}

class Contacts : public ::testing::Test {
 protected:
  void begin(Protocol protocol, const TouchMapping& mapping = {}) {
    decoder.begin(panel(protocol), mapping);
    told.clear();
  }
  void abs(int code, int value) {
    decoder.feed({EV_ABS, static_cast<std::uint16_t>(code), value, 0}, Stamp{});
  }
  void syn(int code = SYN_REPORT) {
    decoder.feed({EV_SYN, static_cast<std::uint16_t>(code), 0, 0}, Stamp(std::chrono::milliseconds(++ms)));
    for (TouchEvent event; decoder.take(event);) told.push_back(event);
  }
  void land(int slot, int id, int x, int y) {
    abs(ABS_MT_SLOT, slot);
    abs(ABS_MT_TRACKING_ID, id);
    abs(ABS_MT_POSITION_X, x);
    abs(ABS_MT_POSITION_Y, y);
  }
  // Of protocol A.
  void packet(std::initializer_list<std::array<int, 3>> fingers) {
    for (const auto& [id, x, y] : fingers) {
      if (id >= 0) abs(ABS_MT_TRACKING_ID, id);
      abs(ABS_MT_POSITION_X, x);
      abs(ABS_MT_POSITION_Y, y);
      decoder.feed({EV_SYN, SYN_MT_REPORT, 0, 0}, Stamp{});
    }
    if (fingers.size() == 0) decoder.feed({EV_SYN, SYN_MT_REPORT, 0, 0}, Stamp{});
    syn();
  }
  std::string kinds() const {
    std::string word;
    for (const TouchEvent& e : told) word += e.kind == Kind::down ? 'd' : e.kind == Kind::move ? 'm' : 'u';
    return word;
  }

  ContactDecoder decoder;
  std::vector<TouchEvent> told;
  int ms = 0;
};

TEST_F(Contacts, AFingerLandsMovesAndLifts) {
  begin(Protocol::slots);
  land(0, 45, 250, 125);
  EXPECT_TRUE(told.empty()) << "the packet is not over";
  syn();
  abs(ABS_MT_POSITION_X, 500);
  syn();
  abs(ABS_MT_TRACKING_ID, -1);
  syn();
  ASSERT_EQ(kinds(), "dmu");
  EXPECT_FLOAT_EQ(told[0].x, 0.2505F);
  EXPECT_FLOAT_EQ(told[0].y, 0.251F);
  EXPECT_FLOAT_EQ(told[1].x, 0.5005F);
  EXPECT_FLOAT_EQ(told[2].x, 0.5005F) << "it lifts where it was";
  EXPECT_EQ(told[0].contact, told[2].contact);
  EXPECT_EQ(told[1].time, Stamp(std::chrono::milliseconds(2)));
}

TEST_F(Contacts, TwoFingersAreTwoContacts) {
  begin(Protocol::slots);
  land(0, 1, 100, 100);
  land(1, 2, 900, 100);
  syn();
  abs(ABS_MT_POSITION_X, 800);  // of slot 1, the last spoken of
  syn();
  ASSERT_EQ(kinds(), "ddm");
  EXPECT_NE(told[0].contact, told[1].contact);
  EXPECT_EQ(told[2].contact, told[1].contact);
}

TEST_F(Contacts, AnotherFingerInTheSamePacketLiftsTheFirst) {
  begin(Protocol::slots);
  land(0, 1, 100, 100);
  syn();
  land(0, 2, 700, 100);
  syn();
  ASSERT_EQ(kinds(), "dud");
  EXPECT_FLOAT_EQ(told[1].x, told[0].x);
  EXPECT_NE(told[2].contact, told[0].contact);
}

TEST_F(Contacts, AFingerThatCameAndWentWithinOnePacketIsNotTold) {
  begin(Protocol::slots);
  land(0, 1, 100, 100);
  abs(ABS_MT_TRACKING_ID, -1);
  syn();
  EXPECT_EQ(kinds(), "");
}

// The kernel tells a slot's values only when they change, even from one finger to the next.
TEST_F(Contacts, WhatTheSlotHeldBeforeIsWhereTheNextFingerIs) {
  begin(Protocol::slots);
  abs(ABS_MT_SLOT, 0);
  abs(ABS_MT_POSITION_X, 300);
  abs(ABS_MT_POSITION_Y, 200);
  abs(ABS_MT_TRACKING_ID, 9);
  syn();
  abs(ABS_MT_TRACKING_ID, -1);
  syn();
  abs(ABS_MT_TRACKING_ID, 10);
  abs(ABS_MT_POSITION_Y, 100);
  syn();
  ASSERT_EQ(kinds(), "dud");
  EXPECT_FLOAT_EQ(told[2].x, 0.3005F);
  EXPECT_FLOAT_EQ(told[2].y, 0.201F);
}

TEST_F(Contacts, AFingerThatWasDownAtTheStartCountsFromItsNextLanding) {
  begin(Protocol::slots);
  abs(ABS_MT_SLOT, 0);
  abs(ABS_MT_POSITION_X, 300);
  syn();
  abs(ABS_MT_TRACKING_ID, -1);
  syn();
  EXPECT_EQ(kinds(), "");
  abs(ABS_MT_TRACKING_ID, 3);
  syn();
  EXPECT_EQ(kinds(), "d");
}

TEST_F(Contacts, AFingerTooManyIsIgnoredAndHarmsNobody) {
  begin(Protocol::slots);
  land(0, 1, 100, 100);
  land(99, 2, 900, 400);
  land(-5, 3, 900, 400);
  syn();
  ASSERT_EQ(kinds(), "d");
  EXPECT_FLOAT_EQ(told[0].x, 0.1005F);
}

TEST_F(Contacts, TurnedPanels) {
  // The panel's own quarter point (x 0.25, y 0.1) on the picture, by hand.
  const struct {
    int rotation;
    float x, y;
  } cases[] = {{0, 0.25F, 0.1F}, {90, 0.9F, 0.25F}, {180, 0.75F, 0.9F}, {270, 0.1F, 0.75F}};
  for (const auto& c : cases) {
    TouchMapping mapping;
    mapping.rotation_deg = c.rotation;
    begin(Protocol::slots, mapping);
    land(0, 1, 250, 50);
    syn();
    ASSERT_EQ(kinds(), "d");
    EXPECT_NEAR(told[0].x, c.x, 1.1e-3) << c.rotation;
    EXPECT_NEAR(told[0].y, c.y, 1.1e-3) << c.rotation;
  }
}

TEST_F(Contacts, CalibrationIsLibinputsMatrix) {
  TouchMapping mapping;
  mapping.calibration = {0.5, 0, 0.25, 0, -1, 1};  // the middle half, upside down
  begin(Protocol::slots, mapping);
  land(0, 1, 0, 0);
  syn();
  ASSERT_EQ(kinds(), "d");
  EXPECT_NEAR(told[0].x, 0.25, 1e-3);
  EXPECT_NEAR(told[0].y, 1, 1.1e-3);
}

TEST_F(Contacts, SizesAreInMillimetres) {
  const auto size = [&](double x_per_mm, double major_per_mm, double width_mm, int major) {
    TouchPanel p = panel(Protocol::slots);
    p.x.per_mm = x_per_mm;
    p.major.per_mm = major_per_mm;
    TouchMapping mapping;
    mapping.width_mm = width_mm;
    decoder.begin(p, mapping);
    told.clear();
    land(0, 1, 10, 10);
    abs(ABS_MT_TOUCH_MAJOR, major);
    syn();
    return told.at(0).major_mm;
  };
  EXPECT_FLOAT_EQ(size(10, 0, 0, 80), 8);    // in the units of the positions
  EXPECT_FLOAT_EQ(size(10, 4, 0, 80), 20);   // in its own
  EXPECT_FLOAT_EQ(size(0, 0, 200, 80), 16);  // 1000 units on 200 mm
  EXPECT_FLOAT_EQ(size(0, 0, 0, 80), 0);     // nobody says
  EXPECT_FLOAT_EQ(size(10, 0, 0, -80), 0);   // no size
}

TEST_F(Contacts, APalmThatThePanelKnowsIsLargerThanAnyFinger) {
  begin(Protocol::slots);
  land(0, 1, 100, 100);
  syn();
  abs(ABS_MT_TOOL_TYPE, 2);
  syn();
  ASSERT_EQ(kinds(), "dm");
  EXPECT_EQ(told[0].major_mm, 0);
  EXPECT_GT(told[1].major_mm, 22);
}

TEST_F(Contacts, WhenThePanelIsGoneEveryFingerLifts) {
  begin(Protocol::slots);
  land(0, 1, 100, 100);
  land(3, 2, 900, 100);
  syn();
  decoder.lift_all(Stamp(std::chrono::seconds(1)));
  for (TouchEvent event; decoder.take(event);) told.push_back(event);
  ASSERT_EQ(kinds(), "dduu");
  EXPECT_EQ(told[3].time, Stamp(std::chrono::seconds(1)));
}

TEST_F(Contacts, PacketsWithoutIdsFollowTheNearest) {
  begin(Protocol::packets);
  packet({{-1, 100, 100}, {-1, 900, 100}});
  packet({{-1, 880, 100}, {-1, 120, 100}});  // told in the other order
  packet({{-1, 140, 100}});                  // the right one lifts
  packet({});
  ASSERT_EQ(kinds(), "ddmmumu");
  EXPECT_EQ(told[2].contact, told[0].contact);
  EXPECT_NEAR(told[2].x, 0.12, 1e-3);
  EXPECT_EQ(told[4].contact, told[1].contact);
  EXPECT_EQ(told[6].contact, told[0].contact);
}

TEST_F(Contacts, PacketsWithIdsFollowTheId) {
  begin(Protocol::packets);
  packet({{7, 100, 100}, {8, 900, 100}});
  packet({{8, 110, 100}, {7, 890, 100}});  // they cross
  ASSERT_EQ(kinds(), "ddmm");
  EXPECT_EQ(told[2].contact, told[0].contact);
  EXPECT_NEAR(told[2].x, 0.89, 1e-3);
}

TEST_F(Contacts, AfterALossAPacketIsAwaitedBeforeAnyoneLifts) {
  begin(Protocol::packets);
  packet({{-1, 100, 100}});
  abs(ABS_MT_POSITION_X, 990);
  decoder.feed({EV_SYN, SYN_DROPPED, 0, 0}, Stamp{});
  syn();  // of the resynchronisation, which tells no finger
  packet({{-1, 110, 100}});
  EXPECT_EQ(kinds(), "dm");
}

TEST_F(Contacts, OneFingerOfAResistivePanel) {
  begin(Protocol::single);
  abs(ABS_X, 500);
  abs(ABS_Y, 250);
  decoder.feed({EV_KEY, BTN_TOUCH, 1, 0}, Stamp{});
  syn();
  abs(ABS_X, 600);
  syn();
  decoder.feed({EV_KEY, BTN_TOUCH, 0, 0}, Stamp{});
  syn();
  abs(ABS_X, 700);  // hovering
  syn();
  ASSERT_EQ(kinds(), "dmu");
  EXPECT_NEAR(told[1].x, 0.6, 1e-3);
}

// Any events in any order: every contact goes down, moves and up, on the panel.
TEST_F(Contacts, AnyEventsAreSurvived) {
  std::mt19937 random(7);
  const auto pick = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  constexpr int codes[] = {ABS_MT_SLOT,
                           ABS_MT_TRACKING_ID,
                           ABS_MT_POSITION_X,
                           ABS_MT_POSITION_Y,
                           ABS_MT_TOUCH_MAJOR,
                           ABS_MT_TOOL_TYPE,
                           ABS_X,
                           ABS_Y};
  std::size_t downs = 0;
  for (const Protocol protocol : {Protocol::slots, Protocol::packets, Protocol::single}) {
    begin(protocol);
    std::set<std::int32_t> here;
    for (int i = 0; i < 200'000; ++i) {
      RawTouch raw;
      switch (pick(6)) {
        case 0:
          raw = {EV_SYN, static_cast<std::uint16_t>(pick(5)), 0, 0};
          break;
        case 1:
          raw = {EV_KEY, BTN_TOUCH, pick(3), 0};
          break;
        case 2:
          raw = {static_cast<std::uint16_t>(random()), static_cast<std::uint16_t>(random()),
                 static_cast<std::int32_t>(random()), 0};
          break;
        default:
          raw = {EV_ABS, static_cast<std::uint16_t>(codes[pick(8)]),
                 pick(50) == 0 ? static_cast<std::int32_t>(random()) : pick(20) - 2, 0};
      }
      decoder.feed(raw, Stamp{});
      for (TouchEvent event; decoder.take(event);) {
        const bool known = here.contains(event.contact);
        ASSERT_EQ(known, event.kind != Kind::down) << "event " << i;
        if (event.kind == Kind::down) here.insert(event.contact);
        if (event.kind == Kind::up) here.erase(event.contact);
        downs += event.kind == Kind::down ? 1 : 0;
        ASSERT_TRUE(event.x >= 0 && event.x <= 1 && event.y >= 0 && event.y <= 1);
        ASSERT_TRUE(event.major_mm >= 0);
      }
      ASSERT_LE(here.size(), std::size_t{ContactDecoder::most_contacts});
    }
  }
  EXPECT_GT(downs, 1000u);
}

}  // namespace
}  // namespace sonoband
