// A hand on the board's own touchscreen beside a script: what `where` and `await-page` are for.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/screen/touch_reader.h"
#include "app/script/script.h"
#include "tests/app/screen/screen_support.h"

namespace sonoband::test {
namespace {

// One finger: down at `at`, up 0.1 s later.
class OneTap final : public Touch {
 public:
  OneTap(Clock& clock, Stamp at, ui::Vec2 part) : clock_(clock), at_(at), part_(part) {}
  void start() override {}
  ReadStatus read(TouchEvent& out, Duration timeout) override {
    const Stamp until = clock_.now() + timeout;
    const Stamp next = at_ + std::chrono::milliseconds(100 * told_);
    clock_.sleep_until(told_ < 2 ? std::min(until, next) : until);
    if (told_ == 2 || next > until) return ReadStatus::nothing_yet;
    out = {.time = next,
           .kind = told_ == 0 ? TouchEvent::Kind::down : TouchEvent::Kind::up,
           .contact = 1,
           .x = part_.x,
           .y = part_.y};
    ++told_;
    return ReadStatus::ok;
  }
  DeviceHealth health() const override { return {.state = DeviceState::running, .reason = ""}; }
  void stop() override {}

 private:
  Clock& clock_;
  Stamp at_;
  ui::Vec2 part_;
  int told_ = 0;  // by the thread that reads
};

TEST(PlayerTouch, AFingerOnTheBoardsTouchscreenTurnsThePage) {
  ScreenCartSettings settings;
  settings.screen.width = 800;
  settings.screen.height = 600;
  settings.screen.shots = scratch_folder();
  ScreenCart cart(settings);
  cart.play("await live 5\n");
  testing::internal::CaptureStdout();
  cart.play("where rail/exams\n");
  const ui::Vec2 at = cart.loop().screen().widgets().find("rail/exams")->rect.centre();
  const auto said = nlohmann::json::parse(testing::internal::GetCapturedStdout());
  EXPECT_EQ(said["widget"], "rail/exams");
  EXPECT_FLOAT_EQ(said["x"], at.x / 800);
  EXPECT_FLOAT_EQ(said["y"], at.y / 600);

  OneTap panel(cart.clock(), cart.clock().now() + std::chrono::seconds(1), {at.x / 800, at.y / 600});
  TouchReader reader(panel, cart.clock(), [] {});
  cart.player().give_touch(reader, {0, 0, 800, 600});
  EXPECT_THROW(cart.play("await-page exams 0.5\n"), script::ScriptFailed);
  testing::internal::CaptureStdout();
  cart.play("await-page exams 5\n");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "{\"page\":\"exams\"}\n");
  try {
    cart.play("await-page live 0.2\n");
    ADD_FAILURE() << "nobody turned the page back";
  } catch (const script::ScriptFailed& e) {
    EXPECT_NE(std::string(e.what()).find("the page live was to be shown within 0.2 s and exams is"),
              std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace sonoband::test
