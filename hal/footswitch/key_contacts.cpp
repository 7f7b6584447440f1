#include "hal/footswitch/key_contacts.h"

#include <fcntl.h>
#include <libevdev/libevdev.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <vector>

#include "hal/event_devices.h"

namespace sonoband {
namespace {

// PCsensor, Scythe and VEC Infinity pedals.
constexpr PedalUsbId pedals[] = {{0x0c45, 0x7403}, {0x0c45, 0x7404}, {0x413d, 0x2107}, {0x1a86, 0xe026},
                                 {0x3553, 0xb001}, {0x0426, 0x3011}, {0x055a, 0x0998}, {0x05f3, 0x00ff}};

class Keys final : public ContactSource {
 public:
  explicit Keys(std::string device) : device_(std::move(device)) {}
  ~Keys() override { Keys::close(); }

  ContactStatus open(std::span<const ContactRequest> contacts) override {
    close();
    const ContactStatus found = find(contacts);
    if (found != ContactStatus::ok) return found;
    if (libevdev_grab(keys_, LIBEVDEV_GRAB) != 0) return close(), ContactStatus::busy;
    libevdev_set_clock_id(keys_, CLOCK_MONOTONIC);
    return ContactStatus::ok;
  }

  ContactStatus wait(ContactEdge& out, Duration timeout) override {
    input_event event{};
    int result = libevdev_next_event(keys_, LIBEVDEV_READ_FLAG_NORMAL, &event);
    if (result == -EAGAIN) {
      pollfd ready{fd_, POLLIN, 0};
      const auto ms = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
      const int n = poll(&ready, 1, static_cast<int>(std::min<std::int64_t>(ms, 10'000)));
      if (n == 0 || (n < 0 && errno == EINTR)) return ContactStatus::nothing_yet;
      result = libevdev_next_event(keys_, LIBEVDEV_READ_FLAG_NORMAL, &event);
      // Of a pedal that is gone what it told before is still to be read; then there is nothing to wait for.
      if (result == -EAGAIN && (n < 0 || (ready.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0))
        return ContactStatus::gone;
    }
    if (result == -EAGAIN || result == -EINTR) return ContactStatus::nothing_yet;
    if (result == LIBEVDEV_READ_STATUS_SYNC) {
      // The kernel dropped events: let libevdev take the state over, then have every level read.
      while (libevdev_next_event(keys_, LIBEVDEV_READ_FLAG_SYNC, &event) == LIBEVDEV_READ_STATUS_SYNC) {
      }
      return ContactStatus::overflow;
    }
    if (result < 0) return ContactStatus::gone;
    constexpr int autorepeat = 2;
    if (event.type != EV_KEY || event.value == autorepeat) return ContactStatus::nothing_yet;
    for (std::size_t i = 0; i < codes_.size(); ++i) {
      if (codes_[i].code != event.code) continue;
      out.contact = static_cast<int>(i);
      out.active = (event.value != 0) != codes_[i].inverted;
      out.stamp_ns =
          std::int64_t{event.input_event_sec} * 1'000'000'000 + std::int64_t{event.input_event_usec} * 1000;
      out.sequence = 0;
      return ContactStatus::ok;
    }
    return ContactStatus::nothing_yet;
  }

  std::optional<bool> level(int contact) override {
    const Code& code = codes_[static_cast<std::size_t>(contact)];
    return (libevdev_get_event_value(keys_, EV_KEY, static_cast<unsigned>(code.code)) != 0) != code.inverted;
  }

  void close() override {
    if (keys_ != nullptr) libevdev_free(keys_);  // the grab ends with the file
    if (fd_ >= 0) ::close(fd_);
    keys_ = nullptr;
    fd_ = -1;
  }

  const std::string& path() const { return path_; }

  ContactStatus find(std::span<const ContactRequest> contacts) {
    if (device_ != "auto") return try_path(device_, contacts, false);
    ContactStatus best = ContactStatus::no_such_line;
    for (const std::string& path : event_devices()) {
      const ContactStatus status = try_path(path, contacts, true);
      if (status == ContactStatus::ok) return status;
      if (status == ContactStatus::access_denied) best = status;
    }
    return best;
  }

 private:
  struct Code {
    int code;
    bool inverted;
  };

  bool has_keys(std::span<const ContactRequest> contacts) {
    codes_.clear();
    for (const ContactRequest& request : contacts) {
      const int code = libevdev_event_code_from_name(EV_KEY, request.name.c_str());
      if (code < 0 || libevdev_has_event_code(keys_, EV_KEY, static_cast<unsigned>(code)) == 0) return false;
      codes_.push_back({code, request.active_low});
    }
    return true;
  }

  ContactStatus try_path(const std::string& path, std::span<const ContactRequest> contacts, bool known_only) {
    fd_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (fd_ < 0)
      return errno == EACCES || errno == EPERM ? ContactStatus::access_denied : ContactStatus::no_such_line;
    if (libevdev_new_from_fd(fd_, &keys_) != 0) {
      keys_ = nullptr;
      return close(), ContactStatus::no_such_line;
    }
    const int vendor = libevdev_get_id_vendor(keys_);
    const int product = libevdev_get_id_product(keys_);
    const bool known = std::any_of(std::begin(pedals), std::end(pedals), [&](const PedalUsbId& id) {
      return id.vendor == vendor && id.product == product;
    });
    if ((known_only && !known) || !has_keys(contacts)) return close(), ContactStatus::no_such_line;
    path_ = path;
    return ContactStatus::ok;
  }

  std::string device_;
  std::string path_;
  int fd_ = -1;
  libevdev* keys_ = nullptr;
  std::vector<Code> codes_;
};

}  // namespace

std::span<const PedalUsbId> known_pedals() {
  return pedals;
}

std::unique_ptr<ContactSource> key_contacts(std::string device) {
  return std::make_unique<Keys>(std::move(device));
}

ContactReport find_key_pedal(const std::string& device, std::span<const ContactRequest> contacts) {
  Keys keys(device);
  if (keys.find(contacts) != ContactStatus::ok) return {};
  return {true, keys.path()};
}

}  // namespace sonoband
