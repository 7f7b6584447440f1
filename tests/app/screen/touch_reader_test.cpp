// The thread that reads the touchscreen: places in the window, nothing lost while nobody takes.
#include "app/screen/touch_reader.h"

#include <gtest/gtest.h>

#include <atomic>

namespace sonoband::test {
namespace {

// As fast as it is read: one finger lands, moves `moves` times, lifts.
class Strokes final : public Touch {
 public:
  explicit Strokes(int moves) : moves_(moves) {}
  void start() override {}
  ReadStatus read(TouchEvent& out, Duration) override {
    const int n = told_.load();
    if (n == moves_ + 2) return ReadStatus::nothing_yet;
    out.kind = n == 0            ? TouchEvent::Kind::down
               : n == moves_ + 1 ? TouchEvent::Kind::up
                                 : TouchEvent::Kind::move;
    out.contact = 5;
    out.x = 0.25F;
    out.y = 0.5F;
    out.major_mm = 9;
    ++told_;
    return ReadStatus::ok;
  }
  DeviceHealth health() const override { return {.state = DeviceState::running, .reason = ""}; }
  void stop() override { stopped_ = true; }
  int told() const { return told_; }
  bool stopped() const { return stopped_; }

 private:
  int moves_;
  std::atomic<int> told_{0};
  std::atomic<bool> stopped_{false};
};

TEST(TouchReader, PlacesContactsInTheWindow) {
  const TouchEvent event{.time = Stamp(std::chrono::seconds(3)),
                         .kind = TouchEvent::Kind::move,
                         .contact = 7,
                         .x = 0.5F,
                         .y = 1};
  // A window of 640 x 480 whose corner is at (100, 50) of a display of 1280 x 800.
  const ui::Contact contact = contact_of(event, {-100, -50, 1280, 800});
  EXPECT_EQ(contact.at, (ui::Vec2{540, 750}));
  EXPECT_EQ(contact.time, event.time);
  EXPECT_EQ(contact.kind, ui::Contact::Kind::move);
  EXPECT_EQ(contact.id, 7);
}

// More than it can keep: the thread waits for the screen, and the lift still comes, last.
TEST(TouchReader, LosesNothingWhileTheScreenIsBusy) {
  constexpr int moves = 5000;
  Strokes strokes(moves);
  SystemClock clock;
  std::atomic<int> woken{0};
  ui::Input input;
  {
    TouchReader reader(strokes, clock, [&] { ++woken; });
    const Stamp give_up = clock.now() + std::chrono::seconds(60);
    while (strokes.told() < 1000) clock.sleep_until(clock.now() + std::chrono::milliseconds(1));
    while (input.contacts.size() < moves + 2 && clock.now() < give_up) {
      reader.take({0, 0, 1280, 800}, input);
      clock.sleep_until(clock.now() + std::chrono::milliseconds(1));
    }
    EXPECT_EQ(reader.health().state, DeviceState::running);
  }
  ASSERT_EQ(input.contacts.size(), std::size_t{moves + 2});
  EXPECT_EQ(input.contacts.front().kind, ui::Contact::Kind::down);
  EXPECT_EQ(input.contacts.back().kind, ui::Contact::Kind::up);
  EXPECT_EQ(woken, moves + 2);
  EXPECT_TRUE(strokes.stopped());
}

}  // namespace
}  // namespace sonoband::test
