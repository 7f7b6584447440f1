#include "app/service_watch.h"

#include <systemd/sd-daemon.h>

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace sonoband {
namespace {

const char* words(ServiceNotice notice) {
  switch (notice) {
    case ServiceNotice::ready:
      return "READY=1\nSTATUS=Acquisition runs.";
    case ServiceNotice::alive:
      return "WATCHDOG=1";
    case ServiceNotice::stands_still:
      return "STATUS=Acquisition stands still; unless it goes on the cart is started anew.";
    default:
      return nullptr;
  }
}

std::optional<std::string_view> environment(const char* name) {
  const char* value = std::getenv(name);
  if (value == nullptr) return std::nullopt;
  return value;
}

}  // namespace

ServiceNotice Heartbeat::look(std::uint64_t beats) {
  if (beats == 0) return ServiceNotice::none;
  const bool moved = std::exchange(seen_, beats) != beats;
  if (!std::exchange(ready_, true)) return ServiceNotice::ready;
  if (moved) {
    still_ = false;
    return ServiceNotice::alive;
  }
  return std::exchange(still_, true) ? ServiceNotice::none : ServiceNotice::stands_still;
}

Duration look_every(std::optional<std::string_view> watchdog_usec) {
  constexpr Duration usual = std::chrono::seconds(1);
  constexpr std::int64_t longest_us = 3'600'000'000;  // an hour: beyond it nobody watches
  if (!watchdog_usec) return usual;
  std::int64_t us = 0;
  const char* end = watchdog_usec->data() + watchdog_usec->size();
  const auto [rest, error] = std::from_chars(watchdog_usec->data(), end, us);
  if (error != std::errc() || rest != end || us < 4 || us > longest_us) return usual;
  return std::chrono::microseconds(us / 4);
}

// The manager names the process it started in WATCHDOG_PID. That is xinit, not this one, so it is not asked.
ServiceWatch::ServiceWatch(std::function<std::uint64_t()> beats) : beats_(std::move(beats)) {
  if (environment("NOTIFY_SOCKET")) thread_ = std::thread([this] { watch(); });
}

ServiceWatch::~ServiceWatch() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  ending_.notify_one();
  thread_.join();
  sd_notify(0, "STOPPING=1");
}

void ServiceWatch::watch() {
  const Duration period = look_every(environment("WATCHDOG_USEC"));
  Heartbeat heartbeat;
  bool told = false;
  std::unique_lock lock(mutex_);
  do {
    const char* state = words(heartbeat.look(beats_()));
    const int error = state == nullptr ? 0 : sd_notify(0, state);
    if (error < 0 && !std::exchange(told, true)) {
      std::fprintf(stderr,
                   "sonoband: the service manager does not hear this cart (%s); check NotifyAccess=all in "
                   "the service file, or start without NOTIFY_SOCKET\n",
                   std::strerror(-error));
    }
  } while (!ending_.wait_for(lock, period, [this] { return end_; }));
}

}  // namespace sonoband
