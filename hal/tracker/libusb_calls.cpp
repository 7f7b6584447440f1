#include <libusb.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <new>

#include "hal/tracker/usb_calls.h"

namespace sonoband {
namespace {

constexpr int interface = 0;
constexpr int configuration = 1;
constexpr std::size_t most_transfers = 8;

UsbError error_of(int code) {
  switch (code) {
    case LIBUSB_SUCCESS:
      return UsbError::none;
    case LIBUSB_ERROR_ACCESS:
      return UsbError::access;
    case LIBUSB_ERROR_BUSY:
      return UsbError::busy;
    case LIBUSB_ERROR_NO_DEVICE:
    case LIBUSB_ERROR_NOT_FOUND:
      return UsbError::no_device;
    case LIBUSB_ERROR_PIPE:
      return UsbError::pipe;
    case LIBUSB_ERROR_TIMEOUT:
      return UsbError::timeout;
    default:
      return UsbError::other;
  }
}

UsbError error_of(libusb_transfer_status status) {
  switch (status) {
    case LIBUSB_TRANSFER_COMPLETED:
      return UsbError::none;
    case LIBUSB_TRANSFER_TIMED_OUT:
      return UsbError::timeout;
    case LIBUSB_TRANSFER_CANCELLED:
      return UsbError::cancelled;
    case LIBUSB_TRANSFER_STALL:
      return UsbError::pipe;
    case LIBUSB_TRANSFER_NO_DEVICE:
      return UsbError::no_device;
    default:
      return UsbError::other;
  }
}

timeval timeval_of(Duration d) {
  const auto us = std::chrono::ceil<std::chrono::microseconds>(d).count();
  return {static_cast<time_t>(us / 1'000'000), static_cast<suseconds_t>(us % 1'000'000)};
}

class Libusb final : public UsbCalls {
 public:
  Libusb() {
    // A machine without USB (a container): present() then finds nothing.
    if (libusb_init(&context_) != LIBUSB_SUCCESS) context_ = nullptr;
    for (std::size_t i = 0; i < transfers_.size(); ++i) {
      slots_[i] = {this, static_cast<int>(i), false};
      transfers_[i] = libusb_alloc_transfer(0);
      if (transfers_[i] == nullptr) throw std::bad_alloc();
    }
    hotplug_ = context_ != nullptr && libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) != 0 &&
               libusb_hotplug_register_callback(
                   context_, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT,
                   LIBUSB_HOTPLUG_NO_FLAGS, LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY,
                   LIBUSB_HOTPLUG_MATCH_ANY, &Libusb::on_plug, this, &callback_) == LIBUSB_SUCCESS;
  }
  ~Libusb() override {
    cancel_all();
    Libusb::close();
    if (hotplug_) libusb_hotplug_deregister_callback(context_, callback_);
    for (libusb_transfer* t : transfers_) libusb_free_transfer(t);
    if (context_ != nullptr) libusb_exit(context_);
  }
  Libusb(const Libusb&) = delete;
  Libusb& operator=(const Libusb&) = delete;

  std::vector<std::uint16_t> present(std::uint16_t vendor) override {
    if (context_ == nullptr) return {};
    if (hotplug_) {
      timeval now{0, 0};
      libusb_handle_events_timeout_completed(context_, &now, nullptr);
      if (!changed_ && vendor == known_vendor_) return known_;
    }
    changed_ = false;
    known_vendor_ = vendor;
    known_.clear();
    libusb_device** list = nullptr;
    const auto n = libusb_get_device_list(context_, &list);
    for (ssize_t i = 0; i < n; ++i) {
      libusb_device_descriptor about{};
      if (libusb_get_device_descriptor(list[i], &about) == 0 && about.idVendor == vendor)
        known_.push_back(about.idProduct);
    }
    if (n >= 0) libusb_free_device_list(list, 1);
    return known_;
  }

  UsbError open(std::uint16_t vendor, std::uint16_t product) override {
    if (context_ == nullptr) return UsbError::no_device;
    libusb_device** list = nullptr;
    const auto n = libusb_get_device_list(context_, &list);
    int result = LIBUSB_ERROR_NO_DEVICE;
    for (ssize_t i = 0; i < n && handle_ == nullptr; ++i) {
      libusb_device_descriptor about{};
      if (libusb_get_device_descriptor(list[i], &about) == 0 && about.idVendor == vendor &&
          about.idProduct == product)
        result = libusb_open(list[i], &handle_);
    }
    if (n >= 0) libusb_free_device_list(list, 1);
    if (handle_ == nullptr) return error_of(result);
    libusb_set_auto_detach_kernel_driver(handle_, 1);
    int current = 0;
    // Setting what is set already would reset the device.
    if (libusb_get_configuration(handle_, &current) == 0 && current != configuration)
      libusb_set_configuration(handle_, configuration);
    result = libusb_claim_interface(handle_, interface);
    if (result != LIBUSB_SUCCESS) close();
    return error_of(result);
  }

  std::vector<std::uint8_t> bulk_endpoints() override {
    std::vector<std::uint8_t> found;
    libusb_config_descriptor* config = nullptr;
    if (handle_ == nullptr || libusb_get_active_config_descriptor(libusb_get_device(handle_), &config) != 0)
      return found;
    if (config->bNumInterfaces > 0 && config->interface[0].num_altsetting > 0) {
      const libusb_interface_descriptor& about = config->interface[0].altsetting[0];
      for (int i = 0; i < about.bNumEndpoints; ++i) {
        const libusb_endpoint_descriptor& e = about.endpoint[i];
        if ((e.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) == LIBUSB_TRANSFER_TYPE_BULK)
          found.push_back(e.bEndpointAddress);
      }
    }
    libusb_free_config_descriptor(config);
    return found;
  }

  UsbError submit(int slot, std::uint8_t endpoint, std::span<std::uint8_t> into) override {
    const auto at = static_cast<std::size_t>(slot);
    if (handle_ == nullptr || at >= most_transfers || slots_[at].queued) return UsbError::other;
    libusb_fill_bulk_transfer(transfers_[at], handle_, endpoint, into.data(), static_cast<int>(into.size()),
                              &Libusb::on_done, &slots_[at], 0);
    const int result = libusb_submit_transfer(transfers_[at]);
    slots_[at].queued = result == LIBUSB_SUCCESS;
    return error_of(result);
  }

  bool wait(UsbCompletion& out, Duration timeout) override {
    if (done_count_ == 0) {
      timeval patience = timeval_of(std::max(timeout, Duration(0)));
      libusb_handle_events_timeout_completed(context_, &patience, nullptr);
    }
    if (done_count_ == 0) return false;
    out = done_[done_first_];
    done_first_ = (done_first_ + 1) % most_transfers;
    --done_count_;
    return true;
  }

  void cancel_all() override {
    for (std::size_t i = 0; i < most_transfers; ++i)
      if (slots_[i].queued) libusb_cancel_transfer(transfers_[i]);
    // The memory of a queued transfer is the kernel's: wait for each.
    const auto any = [&] {
      return std::any_of(slots_.begin(), slots_.end(), [](const Slot& s) { return s.queued; });
    };
    for (int tries = 0; any() && tries < 100; ++tries) {
      timeval patience{0, 50'000};
      libusb_handle_events_timeout_completed(context_, &patience, nullptr);
    }
    done_count_ = 0;
  }

  UsbError write(std::uint8_t endpoint, std::span<const std::uint8_t> bytes, Duration timeout,
                 std::size_t& count) override {
    int sent = 0;
    // libusb does not write to it; its interface is of C.
    auto* data = const_cast<std::uint8_t*>(bytes.data());
    const auto ms = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
    const int result = libusb_bulk_transfer(handle_, endpoint, data, static_cast<int>(bytes.size()), &sent,
                                            static_cast<unsigned>(ms));
    count = static_cast<std::size_t>(std::max(sent, 0));
    return error_of(result);
  }

  UsbError clear_halt(std::uint8_t endpoint) override {
    return error_of(libusb_clear_halt(handle_, endpoint));
  }

  void reset() override { libusb_reset_device(handle_); }

  void close() override {
    if (handle_ == nullptr) return;
    libusb_release_interface(handle_, interface);
    libusb_close(handle_);
    handle_ = nullptr;
  }

 private:
  struct Slot {
    Libusb* owner = nullptr;
    int number = 0;
    bool queued = false;
  };

  static void on_done(libusb_transfer* transfer) {
    auto& slot = *static_cast<Slot*>(transfer->user_data);
    slot.queued = false;
    Libusb& self = *slot.owner;
    if (self.done_count_ == most_transfers) return;
    self.done_[(self.done_first_ + self.done_count_++) % most_transfers] = {
        slot.number, error_of(transfer->status),
        static_cast<std::size_t>(std::max(transfer->actual_length, 0))};
  }

  // No input or output here: libusb forbids it.
  static int on_plug(libusb_context* /*context*/, libusb_device* /*device*/, libusb_hotplug_event /*event*/,
                     void* self) {
    static_cast<Libusb*>(self)->changed_ = true;
    return 0;
  }

  libusb_context* context_ = nullptr;
  libusb_device_handle* handle_ = nullptr;
  libusb_hotplug_callback_handle callback_{};
  bool hotplug_ = false;
  bool changed_ = true;
  std::uint16_t known_vendor_ = 0;
  std::vector<std::uint16_t> known_;
  std::array<libusb_transfer*, most_transfers> transfers_{};
  std::array<Slot, most_transfers> slots_{};
  std::array<UsbCompletion, most_transfers> done_{};  // circular
  std::size_t done_first_ = 0;
  std::size_t done_count_ = 0;
};

}  // namespace

std::unique_ptr<UsbCalls> libusb_calls() {
  return std::make_unique<Libusb>();
}

}  // namespace sonoband
