#include "tests/virtual_board/tracker_device.h"

#include <algorithm>

namespace sonoband::virtual_board {
namespace {

constexpr std::uint16_t viper_product = 0xbf01;

}  // namespace

TrackerDevice::TrackerDevice(std::uint16_t product, Clock& clock, const sim::ProbePose& hand)
    : viper_(product == viper_product) {
  device_ = Fields()
                .u8(18)
                .u8(1)
                .u16(0x200)
                .u8(255)
                .u8(0)
                .u8(0)
                .u8(64)
                .u16(0x0f44)
                .u16(product)
                .u16(0x100)
                .u8(1)
                .u8(2)
                .u8(0)
                .u8(1)
                .out;
  // The HS units have two more bulk endpoints than records use, and the unused IN comes first.
  Fields endpoints;
  const auto endpoint = [&](unsigned address) { endpoints.u8(7).u8(5).u8(address).u8(2).u16(512).u8(0); };
  unsigned count = 0;
  for (const unsigned address :
       viper_ ? std::vector<unsigned>{0x02, 0x81} : std::vector<unsigned>{0x82, 0x04, 0x06, 0x88}) {
    endpoint(address);
    ++count;
  }
  Fields configuration;
  configuration.u8(9)
      .u8(2)
      .u16(static_cast<unsigned>(18 + endpoints.out.size()))
      .u8(1)
      .u8(1)
      .u8(0)
      .u8(0x80)
      .u8(50);
  configuration.u8(9).u8(4).u8(0).u8(0).u8(count).u8(255).u8(0).u8(0).u8(0).bytes(endpoints.out);
  configuration_ = configuration.out;

  if (viper_) {
    bus_ = std::make_unique<sim::ViperSim>(clock, sim::ViperSimConfig{}, hand);
  } else {
    sim::LibertySimConfig config;
    config.bus.bursts_per_minute = 0;  // the emulated bus has its own
    bus_ = std::make_unique<sim::LibertySim>(clock, config, hand);
  }
}

Bytes TrackerDevice::string(int index) const {
  if (index == 0) return language_descriptor();
  if (index == 1) return string_descriptor("Polhemus");
  return index == 2 ? string_descriptor(viper_ ? "VIPER" : "Liberty 2.0") : Bytes{};
}

std::optional<Bytes> TrackerDevice::class_request(const Setup& /*setup*/,
                                                  std::span<const std::uint8_t> /*data*/) {
  return std::nullopt;
}

void TrackerDevice::plugged() {
  const std::lock_guard lock(mutex_);
  bus_->open();
}

void TrackerDevice::unplugged() {
  const std::lock_guard lock(mutex_);
  bus_->close(BytePort::Closing::release);
}

std::optional<Bytes> TrackerDevice::bulk_in(std::size_t most) {
  Bytes bytes(std::max<std::size_t>(most, 4096));
  Transfer got;
  {
    const std::lock_guard lock(mutex_);
    got = bus_->read(bytes, Duration(0));
  }
  if (got.count == 0) return std::nullopt;
  bytes.resize(std::min(got.count, most));
  return bytes;
}

void TrackerDevice::bulk_out(std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  bus_->write(bytes);
}

}  // namespace sonoband::virtual_board
