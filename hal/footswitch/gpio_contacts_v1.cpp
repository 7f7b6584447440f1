// libgpiod 1.6 (Debian 12). Its events carry no count: a lost edge shows as two in the same direction.
#include <gpiod.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>

#include "hal/footswitch/gpio_contacts.h"

namespace sonoband {
namespace {

constexpr int most_contacts = 8;

int flags_of(const ContactRequest& request) {
  int flags = request.active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  switch (request.bias) {
    case Bias::as_is:
      break;
    case Bias::pull_up:
      flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
      break;
    case Bias::pull_down:
      flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
      break;
    case Bias::off:
      flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
      break;
  }
  return flags;
}

ContactStatus status_of(int error, bool biased) {
  if (error == EBUSY) return ContactStatus::busy;
  if (error == EACCES || error == EPERM) return ContactStatus::access_denied;
  if (biased && (error == EINVAL || error == ENOTSUP)) return ContactStatus::no_bias;
  return error == ENODEV ? ContactStatus::gone : ContactStatus::no_such_line;
}

class Lines final : public ContactSource {
 public:
  ~Lines() override { Lines::close(); }

  ContactStatus open(std::span<const ContactRequest> contacts) override {
    close();
    for (const ContactRequest& request : contacts) {
      if (count_ == most_contacts) return close(), ContactStatus::no_such_line;
      errno = 0;
      gpiod_line* line = gpiod_line_find(request.name.c_str());
      if (line == nullptr) {
        const int why = errno;
        close();
        return why == EACCES || why == EPERM ? ContactStatus::access_denied : ContactStatus::no_such_line;
      }
      if (gpiod_line_request_both_edges_events_flags(line, "sonoband", flags_of(request)) != 0) {
        const int why = errno;
        gpiod_line_close_chip(line);
        close();
        return status_of(why, request.bias != Bias::as_is);
      }
      polls_[static_cast<std::size_t>(count_)] = {gpiod_line_event_get_fd(line), POLLIN, 0};
      lines_[static_cast<std::size_t>(count_++)] = line;
    }
    return ContactStatus::ok;
  }

  ContactStatus wait(ContactEdge& out, Duration timeout) override {
    const auto ms = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
    const int n = poll(polls_.data(), static_cast<nfds_t>(count_),
                       static_cast<int>(std::min<std::int64_t>(ms, 10'000)));
    if (n == 0 || (n < 0 && errno == EINTR)) return ContactStatus::nothing_yet;
    for (int i = 0; i < count_; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (polls_[at].revents == 0) continue;
      gpiod_line_event event{};
      if ((polls_[at].revents & POLLIN) == 0 || gpiod_line_event_read(lines_[at], &event) != 0)
        return ContactStatus::gone;
      out.contact = i;
      out.active = event.event_type == GPIOD_LINE_EVENT_RISING_EDGE;
      out.stamp_ns = std::int64_t{event.ts.tv_sec} * 1'000'000'000 + event.ts.tv_nsec;
      out.sequence = 0;
      return ContactStatus::ok;
    }
    return ContactStatus::gone;
  }

  std::optional<bool> level(int contact) override {
    const int value = gpiod_line_get_value(lines_[static_cast<std::size_t>(contact)]);
    if (value < 0) return std::nullopt;
    return value != 0;
  }

  void close() override {
    for (int i = 0; i < count_; ++i) gpiod_line_close_chip(lines_[static_cast<std::size_t>(i)]);
    count_ = 0;
  }

 private:
  std::array<gpiod_line*, most_contacts> lines_{};
  std::array<pollfd, most_contacts> polls_{};
  int count_ = 0;
};

}  // namespace

std::unique_ptr<ContactSource> gpio_contacts() {
  return std::make_unique<Lines>();
}

ContactReport find_gpio_line(const std::string& name) {
  gpiod_line* line = gpiod_line_find(name.c_str());
  if (line == nullptr) return {};
  ContactReport report{true, std::string(gpiod_chip_name(gpiod_line_get_chip(line))) + " line " +
                                 std::to_string(gpiod_line_offset(line))};
  gpiod_line_close_chip(line);
  return report;
}

}  // namespace sonoband
