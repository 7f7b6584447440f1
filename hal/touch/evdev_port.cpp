#include "hal/touch/evdev_port.h"

#include <fcntl.h>
#include <libevdev/libevdev.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <fstream>
#include <ios>
#include <vector>

#include "hal/event_devices.h"

namespace sonoband {
namespace {

constexpr std::array<unsigned, 4> told_at_start = {ABS_MT_POSITION_X, ABS_MT_POSITION_Y, ABS_MT_TOUCH_MAJOR,
                                                   ABS_MT_TOOL_TYPE};

bool has(const libevdev* device, unsigned type, unsigned code) {
  return libevdev_has_event_code(device, type, code) != 0;
}

// A display tablet lies on a display as well, and tells of its pen in a device of its own.
bool is_touchscreen(const libevdev* device) {
  const bool places = has(device, EV_ABS, ABS_MT_POSITION_X) ||
                      (has(device, EV_ABS, ABS_X) && has(device, EV_KEY, BTN_TOUCH));
  return places && libevdev_has_property(device, INPUT_PROP_DIRECT) != 0 &&
         !has(device, EV_KEY, BTN_TOOL_PEN);
}

// Of a device that may not be opened the kernel still says whether it lies on a display.
bool said_to_lie_on_a_display(const std::string& path) {
  std::ifstream in("/sys/class/input" + path.substr(path.rfind('/')) + "/device/properties");
  unsigned long bits = 0;
  return (in >> std::hex >> bits) && (bits >> INPUT_PROP_DIRECT & 1) != 0;
}

TouchRange range_of(const libevdev* device, unsigned code) {
  const input_absinfo* info = libevdev_get_abs_info(device, code);
  if (info == nullptr) return {};
  return {info->minimum, info->maximum, std::max(0.0, double{1.0} * info->resolution)};
}

class EvdevPort final : public TouchPort {
 public:
  explicit EvdevPort(std::string device) : wanted_(std::move(device)) {}
  ~EvdevPort() override { EvdevPort::close(); }
  EvdevPort(const EvdevPort&) = delete;
  EvdevPort& operator=(const EvdevPort&) = delete;

  TouchStatus open(TouchPanel& panel) override {
    close();
    const TouchStatus found = find(panel);
    if (found != TouchStatus::ok) return found;
    if (libevdev_grab(device_, LIBEVDEV_GRAB) != 0) {
      close();
      return errno == ENODEV ? TouchStatus::absent : TouchStatus::busy;
    }
    monotonic_ = libevdev_set_clock_id(device_, CLOCK_MONOTONIC) == 0;
    describe(panel);
    tell_start();
    return TouchStatus::ok;
  }

  TouchStatus wait(RawTouch& out, Duration timeout) override {
    if (next_at_start_ < at_start_.size()) {
      out = at_start_[next_at_start_++];
      return TouchStatus::ok;
    }
    input_event event{};
    if (syncing_) {
      if (libevdev_next_event(device_, LIBEVDEV_READ_FLAG_SYNC, &event) == LIBEVDEV_READ_STATUS_SYNC)
        return give(event, out);
      syncing_ = false;
    }
    int result = libevdev_next_event(device_, LIBEVDEV_READ_FLAG_NORMAL, &event);
    if (result == -EAGAIN) {
      pollfd ready{fd_, POLLIN, 0};
      const auto ms =
          std::chrono::ceil<std::chrono::milliseconds>(std::max(timeout, Duration::zero())).count();
      const int n = poll(&ready, 1, static_cast<int>(std::min<std::int64_t>(ms, 10'000)));
      if (n == 0 || (n < 0 && errno == EINTR)) return TouchStatus::nothing_yet;
      result = libevdev_next_event(device_, LIBEVDEV_READ_FLAG_NORMAL, &event);
      // Of a device that is gone what it told before is still to be read.
      if (result == -EAGAIN && (n < 0 || (ready.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0))
        return TouchStatus::gone;
    }
    if (result == -EAGAIN || result == -EINTR) return TouchStatus::nothing_yet;
    if (result == LIBEVDEV_READ_STATUS_SYNC) syncing_ = true;
    if (result < 0) return TouchStatus::gone;
    return give(event, out);
  }

  void close() override {
    if (device_ != nullptr) libevdev_free(device_);  // the grab ends with the file
    if (fd_ >= 0) ::close(fd_);
    device_ = nullptr;
    fd_ = -1;
    syncing_ = false;
    at_start_.clear();
    next_at_start_ = 0;
  }

 private:
  TouchStatus find(TouchPanel& panel) {
    if (wanted_ != "auto") return try_path(wanted_, panel);
    TouchStatus best = TouchStatus::absent;
    for (const std::string& path : event_devices()) {
      const TouchStatus status = try_path(path, panel);
      if (status == TouchStatus::ok) return status;
      if (status == TouchStatus::access_denied && said_to_lie_on_a_display(path)) best = status;
    }
    return best;
  }

  TouchStatus try_path(const std::string& path, TouchPanel& panel) {
    fd_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (fd_ < 0) return errno == EACCES || errno == EPERM ? TouchStatus::access_denied : TouchStatus::absent;
    if (libevdev_new_from_fd(fd_, &device_) != 0) device_ = nullptr;
    if (device_ == nullptr || !is_touchscreen(device_)) {
      close();
      return TouchStatus::absent;
    }
    panel.path = path;
    return TouchStatus::ok;
  }

  void describe(TouchPanel& panel) const {
    const char* name = libevdev_get_name(device_);
    panel.name = name == nullptr ? "" : name;
    const bool many = has(device_, EV_ABS, ABS_MT_POSITION_X);
    panel.protocol = !many                               ? TouchPanel::Protocol::single
                     : has(device_, EV_ABS, ABS_MT_SLOT) ? TouchPanel::Protocol::slots
                                                         : TouchPanel::Protocol::packets;
    panel.x = range_of(device_, many ? ABS_MT_POSITION_X : ABS_X);
    panel.y = range_of(device_, many ? ABS_MT_POSITION_Y : ABS_Y);
    panel.major = range_of(device_, ABS_MT_TOUCH_MAJOR);
  }

  void tell_start() {
    const int slots = std::max(0, libevdev_get_num_slots(device_));
    const auto say = [&](unsigned code, int value) {
      at_start_.push_back({EV_ABS, static_cast<std::uint16_t>(code), value, 0});
    };
    for (int s = 0; s < slots; ++s) {
      say(ABS_MT_SLOT, s);
      for (const unsigned code : told_at_start)
        if (has(device_, EV_ABS, code))
          say(code, libevdev_get_slot_value(device_, static_cast<unsigned>(s), code));
    }
    if (slots > 0) say(ABS_MT_SLOT, libevdev_get_current_slot(device_));
    for (const unsigned code : {ABS_X, ABS_Y})
      if (slots == 0 && has(device_, EV_ABS, code))
        say(code, libevdev_get_event_value(device_, EV_ABS, code));
  }

  TouchStatus give(const input_event& event, RawTouch& out) const {
    const std::int64_t ns =
        std::int64_t{event.input_event_sec} * 1'000'000'000 + std::int64_t{event.input_event_usec} * 1000;
    out = {event.type, event.code, event.value, monotonic_ ? ns : 0};
    return TouchStatus::ok;
  }

  std::string wanted_;
  int fd_ = -1;
  libevdev* device_ = nullptr;
  bool monotonic_ = false;
  bool syncing_ = false;
  std::vector<RawTouch> at_start_;
  std::size_t next_at_start_ = 0;
};

}  // namespace

std::unique_ptr<TouchPort> evdev_port(std::string device) {
  return std::make_unique<EvdevPort>(std::move(device));
}

}  // namespace sonoband
