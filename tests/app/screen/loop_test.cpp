// The loop alone on a simulated cart: when it draws, what it keeps, and what it costs while nothing happens.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/app/screen/screen_support.h"

namespace sonoband::test {
namespace {

ScreenCartSettings in_scratch() {
  ScreenCartSettings settings;
  settings.screen.width = 800;
  settings.screen.height = 600;
  settings.screen.shots = scratch_folder();
  return settings;
}

std::uint64_t frames_drawn(ScreenCart& cart) {
  return cart.loop().screen().counts().frames;
}

// Set-up shows nothing that moves: its numbers are drawn once a second, and that is all.
TEST(Loop, IdleCostsAFrameASecond) {
  ScreenCart cart(in_scratch());
  cart.play("await live 5\nwait 2\ntap rail/set-up\nwait 1\n");
  const std::uint64_t before = frames_drawn(cart);
  const std::uint64_t sent = cart.loop().screen().counts().uploads;
  cart.play("wait 5\n");
  EXPECT_GE(frames_drawn(cart) - before, 4u);
  EXPECT_LE(frames_drawn(cart) - before, 7u);
  EXPECT_EQ(cart.loop().screen().counts().uploads, sent);
  EXPECT_EQ(cart.loop().may_sleep(), std::chrono::milliseconds(40));
}

// Live: a frame of the screen for each picture, and no more.
TEST(Loop, LiveDrawsEachPictureOnceAndTheNewest) {
  ScreenCart cart(in_scratch());
  cart.play("await live 5\nwait 2\n");
  const std::uint64_t before = frames_drawn(cart);
  cart.play("wait 3\n");
  const double pictures = 3 * 30;
  EXPECT_NEAR(static_cast<double>(frames_drawn(cart) - before), pictures, 6);
  // One frame of the display, the scanner's own delay aside.
  EXPECT_LT(cart.loop().view().status.scanner.age_ms, 1000.0 / 60 + 130);
  EXPECT_EQ(cart.loop().may_sleep(), std::chrono::milliseconds(4));
}

TEST(Loop, OldSweepsAreLetGoSoThatNewOnesHaveRoom) {
  ScreenCart cart(in_scratch());
  cart.play("await live 5\nwait 2\n");
  for (int i = 0; i < 9; ++i) cart.play("press\nwait 0.4\nrelease\nawait review 5\nwait 0.3\n");
  EXPECT_EQ(cart.loop().sweeps_taken(), 9u);
  EXPECT_LE(cart.loop().session().sweep_count(), 6u);
  EXPECT_EQ(cart.cart().status().sweeps_refused, 0u);
  EXPECT_EQ(cart.cart().status().cart.acquisition.ledger.presses_refused, 0u);
}

TEST(Loop, ASnapshotNeverReplacesAnother) {
  const ScreenCartSettings settings = in_scratch();
  for (int run = 0; run < 2; ++run) {
    ScreenCart cart(settings);
    cart.play("await live 5\ntap rail/snapshot\n");
  }
  EXPECT_TRUE(std::filesystem::exists(settings.screen.shots / "snapshot-1.png"));
  EXPECT_TRUE(std::filesystem::exists(settings.screen.shots / "snapshot-2.png"));
}

TEST(Loop, TheRecordButtonIsHeldLikeThePedal) {
  ScreenCart cart(in_scratch());
  cart.play("await live 5\nwait 2\nhold live/record 1.0\nawait review 5\nwait 0.2\n");
  EXPECT_EQ(cart.loop().session().sweep_count(), 1u);
  EXPECT_EQ(cart.loop().session().page(), ui::Page::review);
}

// A finger that lands on what will push the plane or make the band thicker: the layers are got ready before
// it moves, and its first step comes out of them.
TEST(Loop, AFingerThatLandsOnTheStripOrTheThicknessPreparesLayers) {
  for (const char* widget : {"reslice/normal", "tools/thickness"}) {
    ScreenCart cart(in_scratch());
    cart.play("await live 5\nwait 2\npress\nwait 1\nrelease\nawait review 5\nwait 0.3\n");
    const RenderWorker& worker = cart.loop().worker();
    const auto press = [&](const char* name, ui::Contact::Kind kind, ui::Vec2 off) {
      const auto place = cart.loop().screen().widgets().find(name);
      ASSERT_TRUE(place) << name;
      cart.player().input().contacts.push_back({cart.clock().now(), kind, 0, place->rect.centre() + off, 8});
      for (int i = 0; i < 3; ++i) cart.player().frame();
    };
    press("reslice/picture", ui::Contact::Kind::down, {});
    press("reslice/picture", ui::Contact::Kind::up, {});
    EXPECT_EQ(worker.counts().layer_bytes, 0U) << "nothing will be pushed";
    const std::uint64_t painted = worker.counts().done;
    press(widget, ui::Contact::Kind::down, {});
    EXPECT_GT(worker.counts().layer_bytes, 0U) << widget;
    EXPECT_GT(worker.counts().done, painted);
    EXPECT_EQ(worker.counts().from_layers, 0U);
    // Slowly, as far as it takes to be a drag and a little more.
    const ui::Vec2 along = std::string_view(widget) == "tools/thickness" ? ui::Vec2{1, 0} : ui::Vec2{0, 1};
    for (int i = 1; i <= 40; ++i) press(widget, ui::Contact::Kind::move, static_cast<float>(i) * along);
    EXPECT_GT(worker.counts().from_layers, 0U) << widget;
    press(widget, ui::Contact::Kind::up, {});
    EXPECT_TRUE(worker.newest()->planar->exact);
  }
}

TEST(Loop, TheWindowsCloseButtonQuits) {
  ScreenCart cart(in_scratch());
  EXPECT_FALSE(cart.loop().quits());
  cart.player().input().close = true;
  cart.loop().draw(cart.player().input(), cart.clock().now());
  EXPECT_TRUE(cart.loop().quits());
}

}  // namespace
}  // namespace sonoband::test
