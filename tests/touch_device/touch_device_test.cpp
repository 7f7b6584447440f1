// The driver down to the kernel's own calls, on a device that umockdev emulates: run under umockdev-wrapper.
#include <gtest/gtest.h>
#include <linux/input-event-codes.h>

#include <chrono>

#include "hal/touch/evdev_port.h"
#include "hal/touch/touchscreen.h"
#include "tests/support/touch_trace.h"
#include "tests/touch_device/mock_touchscreen.h"
#include "ui/gesture.h"

namespace sonoband::test {
namespace {

using Kind = TouchEvent::Kind;
constexpr Duration patience = std::chrono::milliseconds(300);

class ATouchDevice : public ::testing::Test {
 protected:
  std::string kinds_of_all() {
    std::string kinds;
    TouchEvent event;
    while (touchscreen.read(event, patience) == ReadStatus::ok) {
      kinds += event.kind == Kind::down ? 'd' : event.kind == Kind::move ? 'm' : 'u';
      last = event;
    }
    return kinds;
  }

  SystemClock clock;
  Touchscreen touchscreen{evdev_port("auto"), clock};
  TouchEvent last;
};

TEST_F(ATouchDevice, IsFoundByWhatItCanDoAndTaken) {
  MockTouchscreen mock;
  TouchPanel panel;
  const auto port = evdev_port("auto");
  ASSERT_EQ(port->open(panel), TouchStatus::ok);
  EXPECT_EQ(panel.name, "Mock panel");
  EXPECT_EQ(panel.path, MockTouchscreen::path);
  EXPECT_EQ(panel.protocol, TouchPanel::Protocol::slots);
  EXPECT_EQ(panel.x.most, 4095);
  EXPECT_EQ(panel.y.per_mm, 20);
  EXPECT_TRUE(mock.was_grabbed());
  EXPECT_TRUE(mock.clock_was_set());
}

TEST_F(ATouchDevice, ThatLiesOnNoDisplayIsNone) {
  MockSettings settings;
  settings.direct = false;  // a touchpad
  MockTouchscreen mock(settings);
  TouchPanel panel;
  EXPECT_EQ(evdev_port("auto")->open(panel), TouchStatus::absent);
  EXPECT_EQ(evdev_port("/dev/input/event6")->open(panel), TouchStatus::absent);
}

TEST_F(ATouchDevice, ThatAnotherProgramHoldsIsBusy) {
  MockSettings settings;
  settings.grabbed = true;
  MockTouchscreen mock(settings);
  TouchPanel panel;
  EXPECT_EQ(evdev_port("auto")->open(panel), TouchStatus::busy);
}

TEST_F(ATouchDevice, APinchIsReadAsWritten) {
  MockTouchscreen mock;
  touchscreen.start();
  EXPECT_EQ(kinds_of_all(), "");
  EXPECT_EQ(touchscreen.health().state, DeviceState::running);
  ui::GestureRecogniser recogniser(ui::limits_for(5.9F));
  std::vector<ui::Gesture> gestures;
  std::vector<RawTouch> packet;
  std::size_t read = 0;
  for (const RawTouch& raw : read_touch_trace("pinch").events) {
    packet.push_back(raw);
    if (raw.type != EV_SYN) continue;
    mock.write(packet);
    packet.clear();
    TouchEvent e;
    while (touchscreen.read(e, std::chrono::milliseconds(1)) == ReadStatus::ok) {
      const auto kind = static_cast<ui::Contact::Kind>(e.kind);
      recogniser.feed({e.time, kind, e.contact, {1280 * e.x, 800 * e.y}, e.major_mm}, gestures);
      ++read;
    }
  }
  EXPECT_GT(read, 60u);
  float scale = 1;
  for (const ui::Gesture& g : gestures)
    if (g.kind == ui::Gesture::Kind::pinch && g.phase != ui::Gesture::Phase::end) scale *= g.scale;
  EXPECT_NEAR(scale, 3, 0.1);
}

TEST_F(ATouchDevice, WhatItsSlotsHeldIsKnown) {
  MockSettings settings;
  settings.at_start[2] = {.id = -1, .x = 1000, .y = 640};
  settings.slot = 2;
  MockTouchscreen mock(settings);
  touchscreen.start();
  kinds_of_all();
  // The kernel tells neither the slot nor the place, which have not changed.
  mock.write({{EV_ABS, ABS_MT_TRACKING_ID, 5, 0}, {EV_SYN, SYN_REPORT, 0, 0}});
  ASSERT_EQ(kinds_of_all(), "d");
  EXPECT_NEAR(last.x, 1000.5 / 4096, 1e-6);
  EXPECT_NEAR(last.y, 640.5 / 2560, 1e-6);
}

TEST_F(ATouchDevice, LostEventsEndInTheStateThatIs) {
  MockTouchscreen mock;
  touchscreen.start();
  kinds_of_all();
  mock.write({{EV_ABS, ABS_MT_TRACKING_ID, 5, 0}, {EV_SYN, SYN_REPORT, 0, 0}});
  ASSERT_EQ(kinds_of_all(), "d");
  // The kernel's buffer was full; its slots, which libevdev asks for, say that nobody is there.
  mock.write({{EV_SYN, SYN_DROPPED, 0, 0}, {EV_ABS, ABS_MT_POSITION_X, 77, 0}, {EV_SYN, SYN_REPORT, 0, 0}});
  EXPECT_EQ(kinds_of_all(), "u");
  EXPECT_EQ(touchscreen.health().lost, 1u);
}

TEST_F(ATouchDevice, UnpluggedItLiftsTheFingerAndComesBack) {
  auto mock = std::make_unique<MockTouchscreen>();
  touchscreen.start();
  kinds_of_all();
  mock->write({{EV_ABS, ABS_MT_TRACKING_ID, 5, 0}, {EV_SYN, SYN_REPORT, 0, 0}});
  ASSERT_EQ(kinds_of_all(), "d");
  mock->unplug();
  EXPECT_EQ(kinds_of_all(), "u");
  EXPECT_EQ(touchscreen.health().state, DeviceState::absent);
  mock.reset();
  MockTouchscreen again;
  TouchEvent event;
  touchscreen.read(event, std::chrono::milliseconds(1500));
  EXPECT_EQ(touchscreen.health().state, DeviceState::running);
  again.write({{EV_ABS, ABS_MT_TRACKING_ID, 6, 0}, {EV_SYN, SYN_REPORT, 0, 0}});
  EXPECT_EQ(kinds_of_all(), "d");
}

}  // namespace
}  // namespace sonoband::test
