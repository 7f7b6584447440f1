// A USB pedal down to the kernel's own calls. The device that umockdev emulates has one key, BTN_TOUCH.
#include <gtest/gtest.h>
#include <linux/input-event-codes.h>

#include <vector>

#include "hal/footswitch/key_contacts.h"
#include "tests/touch_device/mock_touchscreen.h"

namespace sonoband::test {
namespace {

constexpr Duration patience = std::chrono::milliseconds(300);

TEST(AKeyPedal, TellsItsEdgesAndWhenItIsGone) {
  MockTouchscreen mock;
  const auto pedal = key_contacts(MockTouchscreen::path);
  const ContactRequest request{.name = "BTN_TOUCH"};
  ASSERT_EQ(pedal->open({&request, 1}), ContactStatus::ok);
  EXPECT_TRUE(mock.was_grabbed());
  ContactEdge edge;
  EXPECT_EQ(pedal->wait(edge, std::chrono::milliseconds(1)), ContactStatus::nothing_yet);
  mock.write({{EV_KEY, BTN_TOUCH, 1, 0}});
  EXPECT_EQ(pedal->wait(edge, patience), ContactStatus::ok);
  EXPECT_TRUE(edge.active);
  mock.unplug();
  // Not "nothing yet" at once and for ever, which would keep a thread of real-time priority busy.
  EXPECT_EQ(pedal->wait(edge, patience), ContactStatus::gone);
  EXPECT_EQ(pedal->wait(edge, patience), ContactStatus::gone);
}

// PCsensor's pedals are a keyboard and a mouse in one; the kernel gives each an event device, of the same
// ids.
TEST(AKeyPedal, IsFoundByWhoHasItsKeysNotOnlyItsId) {
  MockTouchscreen mock({.vendor = 0x0c45, .product = 0x7403, .key = KEY_B, .with_mouse = true});
  const auto pedal = key_contacts("auto");
  const ContactRequest request{.name = "KEY_B"};
  ASSERT_EQ(pedal->open({&request, 1}), ContactStatus::ok);
  EXPECT_TRUE(mock.was_grabbed());
  EXPECT_FALSE(mock.mouse_was_grabbed());
  EXPECT_TRUE(mock.clock_was_set());
  EXPECT_EQ(find_key_pedal("auto", {&request, 1}).where, MockTouchscreen::path);
  const ContactRequest other{.name = "KEY_A"};
  EXPECT_EQ(pedal->open({&other, 1}), ContactStatus::no_such_line);
  EXPECT_FALSE(find_key_pedal("auto", {&other, 1}).found);
}

TEST(AKeyPedal, OfAnIdThatIsNoPedalsIsNotTaken) {
  MockTouchscreen mock({.key = KEY_B});
  const ContactRequest request{.name = "KEY_B"};
  EXPECT_EQ(key_contacts("auto")->open({&request, 1}), ContactStatus::no_such_line);
  EXPECT_FALSE(mock.was_grabbed());
}

TEST(AKeyPedal, IgnoresAutorepeatAndRereadsAfterALoss) {
  MockTouchscreen mock({.key = KEY_B});
  const auto pedal = key_contacts(MockTouchscreen::path);
  const ContactRequest request{.name = "KEY_B"};
  ASSERT_EQ(pedal->open({&request, 1}), ContactStatus::ok);
  ContactEdge edge;
  mock.write({{EV_KEY, KEY_B, 1, 0}, {EV_KEY, KEY_B, 2, 0}, {EV_KEY, KEY_A, 1, 0}, {EV_KEY, KEY_B, 0, 0}});
  std::vector<bool> told;
  for (int i = 0; i < 8; ++i)
    if (pedal->wait(edge, std::chrono::milliseconds(20)) == ContactStatus::ok) told.push_back(edge.active);
  EXPECT_EQ(told, (std::vector<bool>{true, false}));
  mock.write({{EV_KEY, KEY_B, 1, 0}, {EV_SYN, SYN_DROPPED, 0, 0}, {EV_SYN, SYN_REPORT, 0, 0}});
  bool lost = false;
  for (int i = 0; i < 8; ++i)
    lost = lost || pedal->wait(edge, std::chrono::milliseconds(20)) == ContactStatus::overflow;
  EXPECT_TRUE(lost);
  EXPECT_EQ(pedal->level(0), false) << "as the kernel says after it";
}

TEST(AKeyPedal, HeldByAnotherProgramIsSaid) {
  MockTouchscreen mock({.grabbed = true, .key = KEY_B});
  const ContactRequest request{.name = "KEY_B"};
  EXPECT_EQ(key_contacts(MockTouchscreen::path)->open({&request, 1}), ContactStatus::busy);
}

}  // namespace
}  // namespace sonoband::test
