// What the recogniser makes of hands: recorded traces, written out.
#include "ui/gesture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sonoband::test {
namespace {

using ui::Contact;
using ui::Gesture;
using ui::Vec2;
using Kind = Gesture::Kind;

// 5.9 px per mm, so a slop of 11.8 px.
class Gestures : public testing::Test {
 protected:
  void contact(int ms, Contact::Kind kind, int id, Vec2 at, float major_mm = 0) {
    recogniser.feed({Stamp(std::chrono::milliseconds(ms)), kind, id, at, major_mm}, all);
  }
  void down(int ms, int id, Vec2 at, float major_mm = 0) {
    contact(ms, Contact::Kind::down, id, at, major_mm);
  }
  void move(int ms, int id, Vec2 at, float major_mm = 0) {
    contact(ms, Contact::Kind::move, id, at, major_mm);
  }
  void up(int ms, int id, Vec2 at) { contact(ms, Contact::Kind::up, id, at); }
  void tick(int ms) { recogniser.tick(Stamp(std::chrono::milliseconds(ms)), all); }
  int count(Kind kind) const {
    return static_cast<int>(
        std::count_if(all.begin(), all.end(), [&](const Gesture& g) { return g.kind == kind; }));
  }
  Vec2 travel(Kind kind) const {
    Vec2 sum;
    for (const Gesture& g : all) {
      if (g.kind == kind) sum = sum + g.step;
    }
    return sum;
  }

  ui::GestureRecogniser recogniser{ui::limits_for(5.9f)};
  std::vector<Gesture> all;
};

TEST_F(Gestures, TapIsShortAndStill) {
  down(0, 4, {100, 100});
  move(40, 4, {103, 98});  // a finger rolls
  up(90, 4, {104, 98});
  EXPECT_EQ(count(Kind::press), 1);
  EXPECT_EQ(count(Kind::tap), 1);
  EXPECT_EQ(count(Kind::release), 1);
  EXPECT_EQ(count(Kind::drag), 0);
  EXPECT_EQ(all.front().start, (Vec2{100, 100}));
}

TEST_F(Gestures, SecondTapSoonAndNearIsDouble) {
  for (const int t : {0, 200}) {
    down(t, 0, {50, 50});
    up(t + 60, 0, {50, 50});
  }
  EXPECT_EQ(count(Kind::tap), 2);
  EXPECT_EQ(count(Kind::double_tap), 1);
  down(400, 0, {50, 50});  // a third begins anew
  up(450, 0, {50, 50});
  EXPECT_EQ(count(Kind::double_tap), 1);
}

TEST_F(Gestures, SecondTapLateOrFarIsNot) {
  down(0, 0, {50, 50});
  up(60, 0, {50, 50});
  down(500, 0, {50, 50});
  up(560, 0, {50, 50});
  down(700, 0, {150, 50});  // 17 mm away
  up(760, 0, {150, 50});
  EXPECT_EQ(count(Kind::tap), 3);
  EXPECT_EQ(count(Kind::double_tap), 0);
}

TEST_F(Gestures, LongPressComesWhileTheFingerIsDownAndIsNoTap) {
  down(0, 0, {50, 50});
  EXPECT_TRUE(recogniser.waiting());
  tick(599);
  EXPECT_EQ(count(Kind::long_press), 0);
  tick(600);
  EXPECT_EQ(count(Kind::long_press), 1);
  EXPECT_FALSE(recogniser.waiting());
  up(900, 0, {50, 50});
  EXPECT_EQ(count(Kind::tap), 0);
  EXPECT_EQ(count(Kind::release), 1);
}

TEST_F(Gestures, DragKeepsThePictureUnderTheFinger) {
  down(0, 0, {100, 100});
  for (int i = 1; i <= 20; ++i) move(i * 16, 0, {100.0f + 5 * static_cast<float>(i), 100});
  up(600, 0, {200, 100});  // at rest at the end
  EXPECT_EQ(count(Kind::tap), 0);
  EXPECT_NEAR(travel(Kind::drag).x, 100, 1e-3);
  EXPECT_NEAR(travel(Kind::drag).y, 0, 1e-3);
  EXPECT_EQ(count(Kind::flick), 0);
}

TEST_F(Gestures, FlickHasTheSpeedItLeftWith) {
  down(0, 0, {100, 100});
  for (int i = 1; i <= 10; ++i) move(i * 10, 0, {100.0f + 15 * static_cast<float>(i), 100});
  up(101, 0, {250, 100});
  ASSERT_EQ(count(Kind::flick), 1);
  for (const Gesture& g : all) {
    if (g.kind == Kind::flick) {
      EXPECT_NEAR(g.velocity.x, 1500, 50);  // 15 px each 10 ms
    }
  }
}

TEST_F(Gestures, PinchAndTwistAreExact) {
  // Apart from 100 to 300 px while turning a quarter clockwise about (400, 300).
  const auto place = [](float part, int finger) {
    const float r = 50 + 100 * part;
    const float a = part * std::numbers::pi_v<float> / 2;
    const float sign = finger == 0 ? -1.0f : 1.0f;
    return Vec2{400 + sign * r * std::cos(a), 300 + sign * r * std::sin(a)};
  };
  down(0, 0, place(0, 0));
  down(10, 1, place(0, 1));
  for (int i = 1; i <= 30; ++i) {
    for (const int f : {0, 1}) move(10 + 16 * i, f, place(static_cast<float>(i) / 30, f));
  }
  up(600, 0, place(1, 0));
  up(610, 1, place(1, 1));
  float scale = 1;
  float turn = 0;
  for (const Gesture& g : all) {
    if (g.kind == Kind::pinch) scale *= g.scale;
    if (g.kind == Kind::twist) turn += g.turn_rad;
  }
  EXPECT_NEAR(scale, 3, 1e-4);
  EXPECT_NEAR(turn, std::numbers::pi / 2, 1e-4);
  EXPECT_EQ(count(Kind::tap), 0);
  EXPECT_EQ(count(Kind::drag), 0);
  EXPECT_EQ(count(Kind::release), 0);
}

TEST_F(Gestures, TwoFingersSideBySideOnlySlide) {
  down(0, 0, {100, 100});
  down(5, 1, {200, 100});
  for (int i = 1; i <= 10; ++i) {
    const float y = 100 + 8 * static_cast<float>(i);
    move(16 * i, 0, {100, y});
    move(16 * i, 1, {200, y});
  }
  up(300, 1, {200, 180});
  move(316, 0, {150, 250});  // the finger that stays means nothing more
  up(330, 0, {150, 250});
  EXPECT_NEAR(travel(Kind::two_finger_drag).y, 80, 1e-3);
  EXPECT_EQ(count(Kind::pinch), 0);
  EXPECT_EQ(count(Kind::drag), 0);
}

TEST_F(Gestures, TwistGoesRoundMoreThanHalfATurn) {
  const auto place = [](int step, float sign) {
    const float a = static_cast<float>(step) * std::numbers::pi_v<float> / 18;  // 10 degrees
    return Vec2{300 + sign * 80 * std::cos(a), 300 + sign * 80 * std::sin(a)};
  };
  down(0, 0, place(0, -1));
  down(0, 1, place(0, 1));
  for (int i = 1; i <= 27; ++i) {
    move(16 * i, 0, place(i, -1));
    move(16 * i, 1, place(i, 1));
  }
  float turn = 0;
  for (const Gesture& g : all) {
    if (g.kind == Kind::twist) turn += g.turn_rad;
  }
  EXPECT_NEAR(turn, 1.5 * std::numbers::pi, 1e-3);
}

TEST_F(Gestures, PalmsAreNotFingers) {
  down(0, 7, {600, 700}, 30);  // the edge of a hand
  move(10, 7, {620, 690}, 34);
  EXPECT_TRUE(all.empty());
  down(20, 1, {100, 100}, 9);  // a finger beside it works
  up(80, 1, {100, 100});
  EXPECT_EQ(count(Kind::tap), 1);
  up(500, 7, {620, 690});
  EXPECT_EQ(count(Kind::release), 1);
}

TEST_F(Gestures, HandThatComesDownAfterItsFingerEndsTheDrag) {
  down(0, 0, {100, 100}, 9);
  move(16, 0, {140, 100}, 9);
  move(32, 0, {180, 100}, 28);
  move(48, 0, {400, 100}, 30);
  up(64, 0, {400, 100});
  EXPECT_NEAR(travel(Kind::drag).x, 40, 1e-3);
  EXPECT_EQ(count(Kind::tap), 0);
  // The next finger starts afresh.
  down(500, 0, {10, 10});
  up(560, 0, {10, 10});
  EXPECT_EQ(count(Kind::tap), 1);
}

TEST_F(Gestures, ContactsThatNeverLandedAreIgnored) {
  move(0, 3, {10, 10});
  up(10, 3, {10, 10});
  EXPECT_TRUE(all.empty());
}

// Whatever a panel reports, every drag that begins ends, and no gesture belongs to nobody.
TEST_F(Gestures, RandomPanelsKeepTheRules) {
  std::uint32_t seed = 12345;
  const auto next = [&seed](std::uint32_t below) {
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) % below;
  };
  int now = 0;
  for (int i = 0; i < 20000; ++i) {
    now += static_cast<int>(next(30));
    const auto kind = static_cast<Contact::Kind>(next(3));
    contact(now, kind, static_cast<int>(next(3)),
            {static_cast<float>(next(1280)), static_cast<float>(next(800))}, static_cast<float>(next(26)));
  }
  for (int id = 0; id < 3; ++id) up(now + 1, id, {0, 0});
  int dragging = 0;
  for (const Gesture& g : all) {
    if (g.kind != Kind::drag) continue;
    if (g.phase == Gesture::Phase::begin) ++dragging;
    if (g.phase == Gesture::Phase::end) --dragging;
    ASSERT_GE(dragging, 0);
    ASSERT_LE(dragging, 1);
  }
  EXPECT_EQ(dragging, 0);
  EXPECT_GT(count(Kind::press), 100);
  Vec2 at;
  EXPECT_FALSE(recogniser.finger(at));
}

}  // namespace
}  // namespace sonoband::test
