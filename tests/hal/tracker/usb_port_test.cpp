// The USB port over a bus of made-up answers.
#include "hal/tracker/usb_port.h"

#include <gtest/gtest.h>

#include "tests/hal/tracker/fake_usb.h"

namespace sonoband {
namespace {

using test::usb::Bus;
using test::usb::FakeCalls;

struct Rig {
  Bus bus;
  UsbPort port{std::make_unique<FakeCalls>(bus)};
  std::array<std::uint8_t, 4096> into{};
  Transfer read() { return port.read(into, Duration(0)); }
};

TEST(UsbPort, EndpointsAndFamilyFollowTheProduct) {
  struct Case {
    std::uint16_t product;
    std::uint8_t out, in;
    TrackerFamily family;
  };
  for (const Case& c :
       {Case{0xff20, 0x04, 0x88, TrackerFamily::liberty}, Case{0xef20, 0x04, 0x88, TrackerFamily::liberty},
        Case{0xff12, 0x02, 0x82, TrackerFamily::liberty}, Case{0xef12, 0x02, 0x82, TrackerFamily::liberty},
        Case{0xbf01, 0x02, 0x81, TrackerFamily::viper}}) {
    Rig rig;
    rig.bus.products = {0xcf01, c.product};  // an unknown product of the vendor beside it
    ASSERT_EQ(rig.port.open(), PortState::open);
    EXPECT_EQ(rig.port.family(), c.family);
    EXPECT_EQ(rig.bus.endpoint_in, c.in);
    EXPECT_EQ(rig.bus.queued.size(), 4u);
    rig.port.write(std::array<std::uint8_t, 1>{'P'});
    EXPECT_EQ(rig.bus.endpoint_out, c.out);
    EXPECT_EQ(rig.bus.written, "P");
  }
}

TEST(UsbPort, EveryWayNotToOpen) {
  Rig rig;
  rig.bus.products = {};
  EXPECT_EQ(rig.port.open(), PortState::absent);
  for (const std::uint16_t loader : {0xff21, 0xef21, 0xff11, 0xef11}) {
    rig.bus.products = {loader};
    EXPECT_EQ(rig.port.open(), PortState::loader);
  }
  rig.bus.products = {0xff20};
  rig.bus.opening = UsbError::access;
  EXPECT_EQ(rig.port.open(), PortState::access_denied);
  rig.bus.opening = UsbError::busy;
  EXPECT_EQ(rig.port.open(), PortState::busy);
  rig.bus.opening = UsbError::no_device;
  EXPECT_EQ(rig.port.open(), PortState::absent);
  rig.bus.opening = UsbError::none;
  rig.bus.submitting = UsbError::other;
  EXPECT_EQ(rig.port.open(), PortState::absent);
  rig.bus.submitting = UsbError::none;
  EXPECT_EQ(rig.port.open(), PortState::open);
  EXPECT_EQ(rig.port.open(), PortState::open) << "an open port stays open";
}

// Another product of the vendor's, or the id of a tracker on a device without its endpoints.
TEST(UsbPort, WhatIsNoTrackerIsAStrangerAndLetGo) {
  Rig rig;
  rig.bus.products = {0xcf01};
  EXPECT_EQ(rig.port.open(), PortState::stranger);
  EXPECT_EQ(rig.bus.calls, "") << "not even opened";
  rig.bus.products = {0xcf01, 0xff21};
  EXPECT_EQ(rig.port.open(), PortState::loader) << "a tracker that waits for its firmware is the one to name";
  for (const auto& bulk : {std::vector<std::uint8_t>{}, {0x04}, {0x88}, {0x02, 0x82}, {0x82, 0x04}}) {
    rig.bus.products = {0xff20};
    rig.bus.bulk = bulk;
    rig.bus.calls.clear();
    EXPECT_EQ(rig.port.open(), PortState::stranger);
    EXPECT_EQ(rig.bus.calls, "cancel close ");
    EXPECT_TRUE(rig.bus.queued.empty());
  }
  rig.bus.products = {0xff20, 0xef20};
  rig.bus.bulk.reset();
  EXPECT_EQ(rig.port.open(), PortState::open);
}

TEST(UsbPort, BytesCountWhateverTheStatusAndTransfersStayQueued) {
  Rig rig;
  ASSERT_EQ(rig.port.open(), PortState::open);
  EXPECT_EQ(rig.read().status, TransferStatus::timed_out);
  for (int i = 0; i < 20; ++i) {
    rig.bus.complete(48, UsbError::none, static_cast<std::uint8_t>(i));
    const Transfer t = rig.read();
    EXPECT_EQ(t.status, TransferStatus::ok);
    ASSERT_EQ(t.count, 48u);
    EXPECT_EQ(rig.into[47], i);
    EXPECT_EQ(rig.bus.queued.size(), 4u);
  }
  rig.bus.complete(10, UsbError::timeout);
  EXPECT_EQ(rig.read().count, 10u);
  rig.bus.complete(0);
  const Transfer empty = rig.read();
  EXPECT_EQ(empty.status, TransferStatus::ok);
  EXPECT_EQ(empty.count, 0u);
  rig.bus.complete(7, UsbError::other);
  const Transfer bad = rig.read();
  EXPECT_EQ(bad.status, TransferStatus::io_error);
  EXPECT_EQ(bad.count, 7u);
  EXPECT_EQ(rig.bus.queued.size(), 4u);
}

TEST(UsbPort, ACountBeyondTheBufferIsNotBelieved) {
  Rig rig;
  ASSERT_EQ(rig.port.open(), PortState::open);
  rig.bus.complete(1'000'000);
  EXPECT_EQ(rig.read().count, 4096u);
}

TEST(UsbPort, AStallIsClearedOnBothEndpointsWithNothingQueued) {
  Rig rig;
  ASSERT_EQ(rig.port.open(), PortState::open);
  rig.bus.complete(0, UsbError::pipe);
  EXPECT_EQ(rig.read().status, TransferStatus::stalled);
  EXPECT_EQ(rig.bus.queued.size(), 3u) << "not queued again on a halted endpoint";
  rig.bus.calls.clear();
  rig.port.clear_halt();
  EXPECT_EQ(rig.bus.calls, "cancel clear136 clear4 ");
  EXPECT_EQ(rig.bus.queued.size(), 4u);
  rig.bus.complete(48);
  EXPECT_EQ(rig.read().count, 48u);
}

TEST(UsbPort, UnpluggedIsGoneUntilOpenedAgain) {
  Rig rig;
  ASSERT_EQ(rig.port.open(), PortState::open);
  rig.bus.complete(20, UsbError::no_device);
  const Transfer last = rig.read();
  EXPECT_EQ(last.status, TransferStatus::gone);
  EXPECT_EQ(last.count, 20u);
  EXPECT_EQ(rig.read().status, TransferStatus::gone);
  EXPECT_EQ(rig.port.write(std::array<std::uint8_t, 1>{'P'}).status, TransferStatus::gone);
  rig.bus.calls.clear();
  rig.port.close(BytePort::Closing::release);
  EXPECT_EQ(rig.bus.calls, "cancel close ");
  EXPECT_EQ(rig.port.open(), PortState::open);
}

TEST(UsbPort, ClosingCancelsFirstAndResetsWhenAsked) {
  Rig rig;
  ASSERT_EQ(rig.port.open(), PortState::open);
  rig.port.close(BytePort::Closing::reset);
  EXPECT_EQ(rig.bus.calls, "cancel reset close ");
  rig.port.close(BytePort::Closing::reset);
  EXPECT_EQ(rig.bus.calls, "cancel reset close ") << "nothing to do for a closed port";
}

}  // namespace
}  // namespace sonoband
