// libgpiod 2 (Debian 13). Events carry the kernel's count for each line.
#include <gpiod.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <memory>
#include <vector>

#include "hal/footswitch/gpio_contacts.h"

namespace sonoband {
namespace {

template <auto free>
struct Free {
  template <class T>
  void operator()(T* p) const {
    free(p);
  }
};
using Chip = std::unique_ptr<gpiod_chip, Free<gpiod_chip_close>>;
using Settings = std::unique_ptr<gpiod_line_settings, Free<gpiod_line_settings_free>>;
using Config = std::unique_ptr<gpiod_line_config, Free<gpiod_line_config_free>>;
using RequestConfig = std::unique_ptr<gpiod_request_config, Free<gpiod_request_config_free>>;
using Request = std::unique_ptr<gpiod_line_request, Free<gpiod_line_request_release>>;
using Buffer = std::unique_ptr<gpiod_edge_event_buffer, Free<gpiod_edge_event_buffer_free>>;

struct Place {
  Chip chip;
  unsigned offset = 0;
  std::string chip_name;
  int error = 0;
};

Place find(const std::string& name) {
  Place place;
  std::vector<std::string> chips;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", none))
    if (entry.path().filename().string().starts_with("gpiochip")) chips.push_back(entry.path());
  std::sort(chips.begin(), chips.end());
  for (const std::string& path : chips) {
    Chip chip(gpiod_chip_open(path.c_str()));
    if (!chip) {
      place.error = errno;
      continue;
    }
    const int offset = gpiod_chip_get_line_offset_from_name(chip.get(), name.c_str());
    if (offset < 0) continue;
    place.chip = std::move(chip);
    place.offset = static_cast<unsigned>(offset);
    place.chip_name = path.substr(path.rfind('/') + 1);
    return place;
  }
  return place;
}

gpiod_line_bias bias_of(Bias bias) {
  switch (bias) {
    case Bias::pull_up:
      return GPIOD_LINE_BIAS_PULL_UP;
    case Bias::pull_down:
      return GPIOD_LINE_BIAS_PULL_DOWN;
    case Bias::off:
      return GPIOD_LINE_BIAS_DISABLED;
    default:
      return GPIOD_LINE_BIAS_AS_IS;
  }
}

ContactStatus status_of(int error, bool biased) {
  if (error == EBUSY) return ContactStatus::busy;
  if (error == EACCES || error == EPERM) return ContactStatus::access_denied;
  if (biased && (error == EINVAL || error == ENOTSUP)) return ContactStatus::no_bias;
  return error == ENODEV ? ContactStatus::gone : ContactStatus::no_such_line;
}

class Lines final : public ContactSource {
 public:
  // One request for each line: lines of a pedal may be on different chips.
  ContactStatus open(std::span<const ContactRequest> contacts) override {
    close();
    for (const ContactRequest& wanted : contacts) {
      Place place = find(wanted.name);
      if (!place.chip) {
        close();
        return place.error == EACCES || place.error == EPERM ? ContactStatus::access_denied
                                                             : ContactStatus::no_such_line;
      }
      const Settings settings(gpiod_line_settings_new());
      const Config config(gpiod_line_config_new());
      const RequestConfig who(gpiod_request_config_new());
      if (!settings || !config || !who) return close(), ContactStatus::no_such_line;
      gpiod_request_config_set_consumer(who.get(), "sonoband");
      gpiod_request_config_set_event_buffer_size(who.get(), 256);
      gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT);
      gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH);
      gpiod_line_settings_set_event_clock(settings.get(), GPIOD_LINE_CLOCK_MONOTONIC);
      gpiod_line_settings_set_active_low(settings.get(), wanted.active_low);
      gpiod_line_settings_set_bias(settings.get(), bias_of(wanted.bias));
      gpiod_line_config_add_line_settings(config.get(), &place.offset, 1, settings.get());
      Request request(gpiod_chip_request_lines(place.chip.get(), who.get(), config.get()));
      if (!request) {
        const int why = errno;
        close();
        return status_of(why, wanted.bias != Bias::as_is);
      }
      polls_.push_back({gpiod_line_request_get_fd(request.get()), POLLIN, 0});
      lines_.push_back({std::move(request), place.offset});
    }
    return ContactStatus::ok;
  }

  ContactStatus wait(ContactEdge& out, Duration timeout) override {
    const auto ms = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
    const int n = poll(polls_.data(), polls_.size(), static_cast<int>(std::min<std::int64_t>(ms, 10'000)));
    if (n == 0 || (n < 0 && errno == EINTR)) return ContactStatus::nothing_yet;
    for (std::size_t i = 0; i < polls_.size(); ++i) {
      if (polls_[i].revents == 0) continue;
      if ((polls_[i].revents & POLLIN) == 0 ||
          gpiod_line_request_read_edge_events(lines_[i].request.get(), buffer_.get(), 1) != 1)
        return ContactStatus::gone;
      gpiod_edge_event* event = gpiod_edge_event_buffer_get_event(buffer_.get(), 0);
      out.contact = static_cast<int>(i);
      out.active = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE;
      out.stamp_ns = static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(event));
      out.sequence = static_cast<std::uint32_t>(gpiod_edge_event_get_line_seqno(event));
      return ContactStatus::ok;
    }
    return ContactStatus::gone;
  }

  std::optional<bool> level(int contact) override {
    const Line& line = lines_[static_cast<std::size_t>(contact)];
    const gpiod_line_value value = gpiod_line_request_get_value(line.request.get(), line.offset);
    if (value == GPIOD_LINE_VALUE_ERROR) return std::nullopt;
    return value == GPIOD_LINE_VALUE_ACTIVE;
  }

  void close() override {
    lines_.clear();
    polls_.clear();
  }

 private:
  struct Line {
    Request request;
    unsigned offset = 0;
  };
  std::vector<Line> lines_;
  std::vector<pollfd> polls_;
  Buffer buffer_{gpiod_edge_event_buffer_new(1)};
};

}  // namespace

std::unique_ptr<ContactSource> gpio_contacts() {
  return std::make_unique<Lines>();
}

ContactReport find_gpio_line(const std::string& name) {
  const Place place = find(name);
  if (!place.chip) return {};
  return {true, place.chip_name + " line " + std::to_string(place.offset)};
}

}  // namespace sonoband
