// The touchscreen over a simulated panel: comings and goings, losses, refusals.
#include "hal/touch/touchscreen.h"

#include <gtest/gtest.h>

#include <linux/input-event-codes.h>

#include <string>
#include <vector>

#include "hal/sim/sim_panel.h"
#include "hal/sim/virtual_clock.h"

namespace sonoband {
namespace {

using Kind = TouchEvent::Kind;
constexpr Duration ms = std::chrono::milliseconds(1);

class ATouchscreen : public ::testing::Test {
 protected:
  ATouchscreen() : member(clock) {
    auto port = std::make_unique<sim::SimPanel>(clock);
    panel = port.get();
    touchscreen = std::make_unique<Touchscreen>(std::move(port), clock);
    touchscreen->start();
  }
  // All there is within 20 ms.
  std::vector<TouchEvent> read() {
    std::vector<TouchEvent> events;
    TouchEvent event;
    while (touchscreen->read(event, 20 * ms) == ReadStatus::ok) events.push_back(event);
    return events;
  }

  sim::VirtualClock clock;
  ClockMember member;
  sim::SimPanel* panel = nullptr;
  std::unique_ptr<Touchscreen> touchscreen;
};

TEST_F(ATouchscreen, TellsWhereAndWhenFingersAre) {
  EXPECT_TRUE(read().empty());
  EXPECT_EQ(touchscreen->health().state, DeviceState::running);
  const Stamp landed = clock.now();
  panel->touch(0, 0.25, 0.5, 8);
  panel->touch(1, 0.75, 0.5, 30);
  panel->lift(0);
  const auto events = read();
  ASSERT_EQ(events.size(), 3u);
  EXPECT_EQ(events[0].kind, Kind::down);
  EXPECT_EQ(events[0].time, landed);
  EXPECT_NEAR(events[0].x, 0.25, 1e-4);
  EXPECT_NEAR(events[0].major_mm, 8, 0.01);
  EXPECT_NEAR(events[1].major_mm, 30, 0.01);
  EXPECT_EQ(events[2].kind, Kind::up);
  EXPECT_EQ(events[2].contact, events[0].contact);
  EXPECT_EQ(touchscreen->health().delivered, 3u);
}

TEST_F(ATouchscreen, AFingerOnGlassThatIsUnpluggedLifts) {
  read();
  panel->touch(0, 0.5, 0.5);
  read();
  panel->unplug();
  const auto events = read();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, Kind::up);
  EXPECT_EQ(touchscreen->health().state, DeviceState::absent);
  EXPECT_NE(std::string(touchscreen->health().reason).find("plug"), std::string::npos);

  for (int i = 0; i < 150; ++i) read();  // 3 s: it looks for it, in vain
  EXPECT_NE(std::string(touchscreen->health().reason).find("gone"), std::string::npos);
  panel->lift(0);
  panel->plug_in();
  for (int i = 0; i < 60; ++i) read();
  EXPECT_EQ(touchscreen->health().state, DeviceState::running);
  EXPECT_STREQ(touchscreen->health().reason, "");
  EXPECT_EQ(touchscreen->health().recoveries, 1u);
  panel->touch(0, 0.5, 0.5);  // where it was: nothing but the landing is told by the panel
  const auto again = read();
  ASSERT_EQ(again.size(), 1u);
  EXPECT_NEAR(again[0].x, 0.5, 1e-4);
}

TEST_F(ATouchscreen, LostEventsAreCountedAndEndInTheStateThatIs) {
  read();
  panel->touch(0, 0.1, 0.1);
  panel->touch(1, 0.9, 0.9);
  read();
  panel->lift(0);
  panel->touch(1, 0.8, 0.9);
  panel->touch(2, 0.3, 0.3);
  panel->drop();
  std::string kinds;
  for (const TouchEvent& e : read()) kinds += e.kind == Kind::down ? 'd' : e.kind == Kind::move ? 'm' : 'u';
  EXPECT_EQ(kinds, "umd");
  EXPECT_EQ(touchscreen->health().lost, 1u);
}

TEST_F(ATouchscreen, RefusalsAreSaidWithTheirCure) {
  panel->refuse(TouchStatus::access_denied);
  read();
  EXPECT_EQ(touchscreen->health().state, DeviceState::fault);
  EXPECT_NE(std::string(touchscreen->health().reason).find("70-sonoband.rules"), std::string::npos);
  panel->refuse(TouchStatus::busy);
  for (int i = 0; i < 60; ++i) read();
  EXPECT_NE(std::string(touchscreen->health().reason).find("Another program"), std::string::npos);
  panel->refuse(TouchStatus::ok);
  for (int i = 0; i < 60; ++i) read();
  EXPECT_EQ(touchscreen->health().state, DeviceState::running);
}

TEST_F(ATouchscreen, WithNoTimeToWaitAWholePacketStillComes) {
  read();
  panel->touch(0, 0.5, 0.5);
  TouchEvent event;
  EXPECT_EQ(touchscreen->read(event, {}), ReadStatus::ok);
  EXPECT_EQ(touchscreen->read(event, {}), ReadStatus::nothing_yet);
}

TEST_F(ATouchscreen, AfterTheStopItHasEnded) {
  read();
  touchscreen->stop();
  TouchEvent event;
  EXPECT_EQ(touchscreen->read(event, 20 * ms), ReadStatus::ended);
}

// A panel that tells of nobody, for ever, with stamps of another time.
class Babbling final : public TouchPort {
 public:
  TouchStatus open(TouchPanel& panel) override {
    panel.x = panel.y = {0, 99, 1};
    return TouchStatus::ok;
  }
  TouchStatus wait(RawTouch& out, Duration) override {
    ++told;
    out = {EV_ABS, ABS_MT_POSITION_X, told % 100, 1};
    if (told == 50) out = {EV_ABS, ABS_MT_TRACKING_ID, 1, 1};
    if (told == 51) out = {EV_SYN, SYN_REPORT, 0, 1};
    return TouchStatus::ok;
  }
  void close() override {}
  int told = 0;
};

TEST(ATouchscreenThatBabbles, IsNotListenedToForEverAndItsStampsAreNotBelieved) {
  SystemClock clock;
  Touchscreen touchscreen(std::make_unique<Babbling>(), clock);
  touchscreen.start();
  TouchEvent event;
  const Stamp before = clock.now();
  ASSERT_EQ(touchscreen.read(event, 1 * ms), ReadStatus::ok);
  EXPECT_GE(event.time, before);
  EXPECT_EQ(touchscreen.read(event, 1 * ms), ReadStatus::nothing_yet);
}

}  // namespace
}  // namespace sonoband
