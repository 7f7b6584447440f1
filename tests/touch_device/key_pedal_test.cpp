// A USB pedal down to the kernel's own calls. The device that umockdev emulates has one key, BTN_TOUCH.
#include <gtest/gtest.h>
#include <linux/input-event-codes.h>

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

}  // namespace
}  // namespace sonoband::test
