// The USB port over a bus of made-up answers: what libusb does, good and bad.
#include "hal/tracker/usb_port.h"

#include <gtest/gtest.h>

#include <deque>
#include <map>
#include <string>

namespace sonoband {
namespace {

struct Bus {
  std::vector<std::uint16_t> products{0xff20};
  UsbError opening = UsbError::none;
  UsbError writing = UsbError::none;
  UsbError submitting = UsbError::none;
  std::map<int, std::span<std::uint8_t>> queued;
  std::deque<UsbCompletion> done;
  std::uint8_t endpoint_in = 0;
  std::uint8_t endpoint_out = 0;
  std::string written;
  std::string calls;

  // The oldest queued transfer ends.
  void complete(std::size_t count, UsbError error = UsbError::none, std::uint8_t fill = 0) {
    ASSERT_FALSE(queued.empty());
    auto oldest = queued.begin();
    std::fill_n(oldest->second.begin(), std::min(count, oldest->second.size()), fill);
    done.push_back({oldest->first, error, count});
    queued.erase(oldest);
  }
};

class FakeCalls final : public UsbCalls {
 public:
  explicit FakeCalls(Bus& bus) : bus_(bus) {}
  std::vector<std::uint16_t> present(std::uint16_t vendor) override {
    EXPECT_EQ(vendor, 0x0f44);
    return bus_.products;
  }
  UsbError open(std::uint16_t, std::uint16_t product) override {
    opened_ = product;
    return bus_.opening;
  }
  std::uint8_t first_bulk(std::uint8_t direction) override { return direction == 0x80 ? 0x81 : 0x02; }
  UsbError submit(int slot, std::uint8_t endpoint, std::span<std::uint8_t> into) override {
    EXPECT_EQ(into.size() % 512, 0u) << "or a full packet overflows";
    if (bus_.submitting != UsbError::none) return bus_.submitting;
    bus_.endpoint_in = endpoint;
    bus_.queued[slot] = into;
    return UsbError::none;
  }
  bool wait(UsbCompletion& out, Duration) override {
    if (bus_.done.empty()) return false;
    out = bus_.done.front();
    bus_.done.pop_front();
    return true;
  }
  void cancel_all() override {
    bus_.queued.clear();
    bus_.done.clear();
    bus_.calls += "cancel ";
  }
  UsbError write(std::uint8_t endpoint, std::span<const std::uint8_t> bytes, Duration,
                 std::size_t& count) override {
    bus_.endpoint_out = endpoint;
    bus_.written.append(bytes.begin(), bytes.end());
    count = bytes.size();
    return bus_.writing;
  }
  UsbError clear_halt(std::uint8_t endpoint) override {
    EXPECT_TRUE(bus_.queued.empty());
    bus_.calls += "clear" + std::to_string(endpoint) + " ";
    return UsbError::none;
  }
  void reset() override { bus_.calls += "reset "; }
  void close() override {
    EXPECT_TRUE(bus_.queued.empty()) << "closed under a queued transfer";
    bus_.calls += "close ";
  }

 private:
  Bus& bus_;
  std::uint16_t opened_ = 0;
};

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
