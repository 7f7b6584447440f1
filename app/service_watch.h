// What the service manager (systemd) is told: that the cart is ready, and signs of life. They come from the
// beat of acquisition and not from the interface: a screen that hangs loses no picture, a capture that stands
// still loses all of them, and is started anew with the whole cart (WatchdogSec= in board/systemd).
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>

#include "core/time.h"

namespace sonoband {

enum class ServiceNotice : std::uint8_t {
  none,
  ready,         // the first beat
  alive,         // it beat since the last look
  stands_still,  // it did not; said once, until it beats again
};

// Told the number of beats so far at each look; 0: acquisition has not begun.
class Heartbeat {
 public:
  ServiceNotice look(std::uint64_t beats);

 private:
  std::uint64_t seen_ = 0;
  bool ready_ = false;
  bool still_ = false;
};

// A quarter of the time after which the manager loses patience, as it gives it in microseconds; a second
// where it gives none, or something that is no such time.
Duration look_every(std::optional<std::string_view> watchdog_usec);

// Looks at the beats on a thread of its own and tells the manager while it lives; at its end, that the cart
// stops. Without a manager (no NOTIFY_SOCKET) it does nothing.
class ServiceWatch {
 public:
  explicit ServiceWatch(std::function<std::uint64_t()> beats);
  ~ServiceWatch();
  ServiceWatch(const ServiceWatch&) = delete;
  ServiceWatch& operator=(const ServiceWatch&) = delete;

 private:
  void watch();

  std::function<std::uint64_t()> beats_;
  std::mutex mutex_;
  std::condition_variable ending_;
  bool end_ = false;
  std::thread thread_;
};

}  // namespace sonoband
