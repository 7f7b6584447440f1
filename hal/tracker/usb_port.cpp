#include "hal/tracker/usb_port.h"

#include <algorithm>
#include <cassert>

namespace sonoband {
namespace {

constexpr Duration write_patience = std::chrono::seconds(1);

// HS units have a first bulk IN (0x82) that is not the one records come from.
constexpr UsbProduct products[] = {
    {0xff20, "LIBERTY HS", false, TrackerFamily::liberty, 0x04, 0x88},
    {0xef20, "PATRIOT HS", false, TrackerFamily::liberty, 0x04, 0x88},
    {0xff12, "LIBERTY", false, TrackerFamily::liberty, 0x02, 0x82},
    {0xef12, "PATRIOT", false, TrackerFamily::liberty, 0x02, 0x82},
    {0xbf01, "VIPER", false, TrackerFamily::viper, 0, 0},
    {0xff21, "LIBERTY HS without firmware", true, TrackerFamily::liberty, 0, 0},
    {0xef21, "PATRIOT HS without firmware", true, TrackerFamily::liberty, 0, 0},
    {0xff11, "LIBERTY without firmware", true, TrackerFamily::liberty, 0, 0},
    {0xef11, "PATRIOT without firmware", true, TrackerFamily::liberty, 0, 0},
};

TransferStatus status_of(UsbError error) {
  switch (error) {
    case UsbError::none:
      return TransferStatus::ok;
    case UsbError::timeout:
      return TransferStatus::timed_out;
    case UsbError::pipe:
      return TransferStatus::stalled;
    case UsbError::no_device:
      return TransferStatus::gone;
    default:
      return TransferStatus::io_error;
  }
}

}  // namespace

const UsbProduct* find_product(std::uint16_t id) {
  const auto* found =
      std::find_if(std::begin(products), std::end(products), [&](const UsbProduct& p) { return p.id == id; });
  return found == std::end(products) ? nullptr : found;
}

std::optional<UsbEndpoints> endpoints_of(const UsbProduct& product, std::span<const std::uint8_t> bulk) {
  constexpr std::uint8_t inwards = 0x80;
  const auto pick = [&](std::uint8_t known, std::uint8_t direction) {
    const auto found = std::find_if(bulk.begin(), bulk.end(), [&](std::uint8_t e) {
      return (e & inwards) == direction && (known == 0 || e == known);
    });
    return found == bulk.end() ? std::uint8_t{0} : *found;
  };
  const UsbEndpoints e{.out = pick(product.out, 0), .in = pick(product.in, inwards)};
  return e.out != 0 && e.in != 0 ? std::optional(e) : std::nullopt;
}

UsbPort::~UsbPort() {
  UsbPort::close(Closing::release);
}

PortState UsbPort::open() {
  if (product_ != nullptr && !gone_) return PortState::open;
  close(Closing::release);
  PortState best = PortState::absent;
  for (const std::uint16_t id : calls_->present(polhemus_vendor)) {
    const UsbProduct* product = find_product(id);
    if (product == nullptr) {
      if (best == PortState::absent) best = PortState::stranger;
      continue;
    }
    if (product->loader) {
      if (best == PortState::absent || best == PortState::stranger) best = PortState::loader;
      continue;
    }
    switch (calls_->open(polhemus_vendor, id)) {
      case UsbError::none:
        break;
      case UsbError::access:
        best = PortState::access_denied;
        continue;
      case UsbError::busy:
        best = PortState::busy;
        continue;
      default:
        continue;
    }
    product_ = product;
    halted_ = gone_ = false;
    const auto endpoints = endpoints_of(*product, calls_->bulk_endpoints());
    endpoints_ = endpoints.value_or(UsbEndpoints{});
    if (endpoints && queue_all()) return PortState::open;
    if (!endpoints && best == PortState::absent) best = PortState::stranger;
    close(Closing::release);
  }
  return best;
}

bool UsbPort::queue_all() {
  for (std::size_t i = 0; i < queued; ++i)
    if (calls_->submit(static_cast<int>(i), endpoints_.in, buffers_[i]) != UsbError::none) return false;
  return true;
}

Transfer UsbPort::write(std::span<const std::uint8_t> bytes) {
  assert(product_ != nullptr);
  if (gone_) return {TransferStatus::gone, 0};
  std::size_t count = 0;
  const UsbError error = calls_->write(endpoints_.out, bytes, write_patience, count);
  gone_ = error == UsbError::no_device;
  halted_ = halted_ || error == UsbError::pipe;
  return {status_of(error), count};
}

Transfer UsbPort::read(std::span<std::uint8_t> into, Duration timeout) {
  assert(product_ != nullptr && into.size() >= transfer_bytes);
  if (gone_) return {TransferStatus::gone, 0};
  UsbCompletion done;
  if (!calls_->wait(done, timeout)) return {TransferStatus::timed_out, 0};
  if (done.slot < 0 || done.slot >= static_cast<int>(queued)) return {TransferStatus::io_error, 0};
  auto& buffer = buffers_[static_cast<std::size_t>(done.slot)];
  const std::size_t count = std::min({done.count, buffer.size(), into.size()});
  std::copy_n(buffer.begin(), count, into.begin());
  TransferStatus status = status_of(done.error);
  if (done.error == UsbError::no_device) {
    gone_ = true;
  } else if (done.error == UsbError::pipe) {
    halted_ = true;  // the others fail as well; clear_halt queues all anew
  } else if (!halted_) {
    const UsbError again = calls_->submit(done.slot, endpoints_.in, buffer);
    gone_ = again == UsbError::no_device;
    if (again != UsbError::none && status == TransferStatus::ok) status = status_of(again);
  }
  return {status, count};
}

void UsbPort::clear_halt() {
  if (product_ == nullptr || gone_) return;
  calls_->cancel_all();
  calls_->clear_halt(endpoints_.in);
  calls_->clear_halt(endpoints_.out);
  halted_ = false;
  // What cannot be queued shows at the next read, as silence that the link's watchdog hears.
  gone_ = !queue_all() && calls_->present(polhemus_vendor).empty();
}

void UsbPort::close(Closing how) {
  if (product_ == nullptr) return;
  calls_->cancel_all();
  if (how == Closing::reset && !gone_) calls_->reset();
  calls_->close();
  product_ = nullptr;
  halted_ = gone_ = false;
}

}  // namespace sonoband
