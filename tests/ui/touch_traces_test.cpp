// Hands as a panel tells them, through driver and gesture layer, on a 1280 x 800 picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "hal/sim/virtual_clock.h"
#include "hal/touch/touchscreen.h"
#include "tests/support/touch_trace.h"
#include "ui/gesture.h"

namespace sonoband::test {
namespace {

using ui::Contact;
using ui::Gesture;
using Kind = Gesture::Kind;

constexpr float px_per_mm = 1280 / 217.0F;

std::vector<Gesture> gestures_of(const std::string& trace) {
  sim::VirtualClock clock;
  const ClockMember member(clock);
  Touchscreen touchscreen(trace_port(read_touch_trace(trace), clock), clock);
  ui::GestureRecogniser recogniser(ui::limits_for(px_per_mm));
  std::vector<Gesture> gestures;
  touchscreen.start();
  for (int frame = 0; frame < 300; ++frame) {  // 3 s
    TouchEvent e;
    const Stamp next = clock.now() + std::chrono::milliseconds(10);
    while (touchscreen.read(e, next - clock.now()) == ReadStatus::ok) {
      const auto kind = e.kind == TouchEvent::Kind::down   ? Contact::Kind::down
                        : e.kind == TouchEvent::Kind::move ? Contact::Kind::move
                                                           : Contact::Kind::up;
      recogniser.feed({e.time, kind, e.contact, {1280 * e.x, 800 * e.y}, e.major_mm}, gestures);
    }
    recogniser.tick(clock.now(), gestures);
  }
  ui::Vec2 at;
  EXPECT_FALSE(recogniser.finger(at)) << "a finger stayed behind";
  return gestures;
}

int count(const std::vector<Gesture>& all, Kind kind) {
  return static_cast<int>(
      std::count_if(all.begin(), all.end(), [&](const Gesture& g) { return g.kind == kind; }));
}

ui::Vec2 travel_mm(const std::vector<Gesture>& all, Kind kind) {
  ui::Vec2 sum;
  for (const Gesture& g : all)
    if (g.kind == kind) sum = sum + (1 / px_per_mm) * g.step;
  return sum;
}

float zoom(const std::vector<Gesture>& all) {
  float scale = 1;
  for (const Gesture& g : all)
    if (g.kind == Kind::pinch && g.phase != Gesture::Phase::end) scale *= g.scale;
  return scale;
}

TEST(TouchTraces, Tap) {
  const auto all = gestures_of("tap");
  EXPECT_EQ(count(all, Kind::tap), 1);
  EXPECT_EQ(count(all, Kind::drag), 0);
  EXPECT_NEAR(all.front().at.x, 100 * px_per_mm, px_per_mm);
  EXPECT_NEAR(all.front().at.y, 60 * px_per_mm, px_per_mm);
}

TEST(TouchTraces, DoubleTap) {
  const auto all = gestures_of("double-tap");
  EXPECT_EQ(count(all, Kind::tap), 2);
  EXPECT_EQ(count(all, Kind::double_tap), 1);
}

TEST(TouchTraces, LongPress) {
  const auto all = gestures_of("long-press");
  EXPECT_EQ(count(all, Kind::long_press), 1);
  EXPECT_EQ(count(all, Kind::tap), 0);
}

TEST(TouchTraces, DragStaysUnderTheFinger) {
  const auto all = gestures_of("drag");
  EXPECT_NEAR(travel_mm(all, Kind::drag).x, 50, 0.5);
  EXPECT_NEAR(travel_mm(all, Kind::drag).y, 20, 0.5);
  EXPECT_EQ(count(all, Kind::flick), 0) << "it rested before it lifted";
}

TEST(TouchTraces, Flick) {
  const auto all = gestures_of("flick");
  ASSERT_EQ(count(all, Kind::flick), 1);
  const auto flick =
      std::find_if(all.begin(), all.end(), [](const Gesture& g) { return g.kind == Kind::flick; });
  EXPECT_GT(flick->velocity.x, 400 * px_per_mm);  // 40 mm in 90 ms, ever faster
  EXPECT_LT(flick->velocity.x, 1000 * px_per_mm);
}

TEST(TouchTraces, PinchWithSlotsAndWithPackets) {
  for (const char* trace : {"pinch", "pinch-protocol-a"}) {
    const auto all = gestures_of(trace);
    EXPECT_NEAR(zoom(all), 3, 0.1) << trace;
    EXPECT_EQ(count(all, Kind::twist), 0) << trace;
    EXPECT_EQ(count(all, Kind::tap), 0) << trace;
  }
}

TEST(TouchTraces, TwistOfAQuarterTurn) {
  const auto all = gestures_of("twist");
  float turned = 0;
  for (const Gesture& g : all) turned += g.kind == Kind::twist ? g.turn_rad : 0;
  EXPECT_NEAR(turned, std::numbers::pi / 2, 0.05);
  EXPECT_NEAR(zoom(all), 1, 0.02);
}

TEST(TouchTraces, TwoFingerDrag) {
  const auto all = gestures_of("two-finger-drag");
  EXPECT_NEAR(travel_mm(all, Kind::two_finger_drag).x, 45, 1);
  EXPECT_NEAR(zoom(all), 1, 0.02);
}

TEST(TouchTraces, ARestingPalmIsNobodyAndTheFingerBesideItTaps) {
  const auto all = gestures_of("palm-and-tap");
  EXPECT_EQ(count(all, Kind::press), 1);
  EXPECT_EQ(count(all, Kind::tap), 1);
  EXPECT_NEAR(all.front().at.x, 60 * px_per_mm, px_per_mm);
}

TEST(TouchTraces, AHandThatLiesDownBehindItsFingerEndsTheDrag) {
  const auto all = gestures_of("finger-becomes-palm");
  EXPECT_LT(travel_mm(all, Kind::drag).x, 27);
  EXPECT_EQ(count(all, Kind::tap), 0);
  EXPECT_EQ(count(all, Kind::flick), 0);
  ASSERT_GE(count(all, Kind::drag), 2);
}

}  // namespace
}  // namespace sonoband::test
