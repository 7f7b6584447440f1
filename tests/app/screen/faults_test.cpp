// Every state has a screen: what goes wrong with a device is said across the page, with the cure, and the
// cart comes back by itself.
#include <gtest/gtest.h>

#include "tests/app/screen/screen_support.h"
#include "ui/panels/lamps.h"

namespace sonoband::test {
namespace {

using std::chrono::seconds;
const Stamp start{seconds(1000)};

std::string fault_of(ScreenCart& cart) {
  const ui::Texts texts;
  cart.draw();
  return std::string(ui::worst_fault(cart.loop().view(), texts).title);
}

ScreenCartSettings with(CartFaults faults) {
  ScreenCartSettings settings;
  settings.faults = std::move(faults);
  settings.screen.shots = scratch_folder();
  return settings;
}

TEST(Faults, TrackerUnplugged) {
  ScreenCart cart(with({{}, {{start + seconds(4), sim::FaultKind::unplugged, 0, seconds(3)}}, {}}));
  const ui::Texts t;
  cart.play("await live 5\nwait 2\n");
  EXPECT_EQ(fault_of(cart), "");
  cart.play("wait 2.5\n");
  EXPECT_EQ(fault_of(cart), t.no_tracker);
  cart.show("fault-tracker");
  EXPECT_FALSE(cart.loop().view().live.pose);
  cart.play("wait 6\n");
  EXPECT_EQ(fault_of(cart), "");
}

TEST(Faults, VideoStallsInASweepAndTheSweepIsKept) {
  sim::FrameFault stall;
  stall.kind = sim::FrameFault::Kind::stall;
  stall.from = seconds(4);
  stall.until = seconds(7);
  ScreenCart cart(with({{stall}, {}, {}}));
  const ui::Texts t;
  cart.play("await live 5\nwait 2\npress\nwait 3.5\n");
  cart.show("fault-video");
  EXPECT_EQ(fault_of(cart), t.scanner_silent);
  EXPECT_TRUE(cart.loop().view().live.picture.pixels.empty()) << "an old picture passes for a live one";
  EXPECT_EQ(cart.loop().session().sweep_count(), 1u);
  cart.play("release\nwait 4\n");
  EXPECT_EQ(fault_of(cart), "");
}

TEST(Faults, ScannerFrozenAndVideoCableOut) {
  sim::FrameFault freeze;
  freeze.kind = sim::FrameFault::Kind::freeze;
  freeze.from = seconds(2);
  freeze.until = seconds(5);
  sim::FrameFault out;
  out.kind = sim::FrameFault::Kind::cable_out;
  out.from = seconds(7);
  out.until = seconds(10);
  ScreenCart cart(with({{freeze, out}, {}, {}}));
  const ui::Texts t;
  cart.play("await live 5\nwait 4\n");
  cart.show("fault-frozen");
  EXPECT_EQ(fault_of(cart), t.scanner_frozen);
  cart.play("wait 4\n");
  cart.show("fault-cable");
  EXPECT_EQ(fault_of(cart), t.no_scanner);
  cart.play("wait 4\n");
  EXPECT_EQ(fault_of(cart), "");
}

TEST(Faults, PedalUnplugged) {
  ScreenCart cart(with({{}, {}, {{sim::PedalFault::Kind::unplug, seconds(2), seconds(60)}}}));
  const ui::Texts t;
  cart.play("await live 5\nwait 3\n");
  cart.show("fault-pedal");
  EXPECT_EQ(fault_of(cart), t.no_pedal);
}

TEST(Faults, MemoryForASweepIsFull) {
  ScreenCartSettings settings = with({});
  settings.ring_frames = 90;
  ScreenCart cart(settings);
  cart.play("await live 5\nwait 1.5\npress\nwait 5\n");
  cart.show("fault-full");
  // What was recorded is kept and shown.
  EXPECT_EQ(cart.loop().state(), cart::State::review);
  EXPECT_EQ(cart.loop().session().sweep_count(), 1u);
  EXPECT_EQ(cart.loop().session().page(), ui::Page::review);
  EXPECT_FALSE(cart.loop().view().notice.empty());
}

}  // namespace
}  // namespace sonoband::test
