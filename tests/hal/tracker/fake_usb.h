// A USB bus of made-up answers: what libusb does, good and bad.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/tracker/usb_calls.h"

namespace sonoband::test::usb {

struct Bus {
  std::vector<std::uint16_t> products{0xff20};
  UsbError opening = UsbError::none;
  UsbError writing = UsbError::none;
  UsbError submitting = UsbError::none;
  std::optional<std::vector<std::uint8_t>> bulk;  // of the device; empty: as its product has them
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
  std::vector<std::uint8_t> bulk_endpoints() override { return bus_.bulk.value_or(of_product()); }
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
  std::vector<std::uint8_t> of_product() const {
    if (opened_ == 0xbf01) return {0x02, 0x81};
    if (opened_ == 0xff20 || opened_ == 0xef20) return {0x82, 0x04, 0x06, 0x88};
    return {0x82, 0x02, 0x06};
  }

  Bus& bus_;
  std::uint16_t opened_ = 0;
};

}  // namespace sonoband::test::usb
