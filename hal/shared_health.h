// A device's health, written by the thread that serves the device and read by any other.
#pragma once

#include <atomic>

#include "hal/devices.h"

namespace sonoband {

// Relaxed throughout: each value stands for itself, none tells that another was written.
struct SharedHealth {
  std::atomic<DeviceState> state{DeviceState::absent};
  std::atomic<const char*> reason{""};
  std::atomic<std::uint64_t> delivered{0};
  std::atomic<std::uint64_t> lost{0};
  std::atomic<std::uint32_t> recoveries{0};

  void say(DeviceState now, const char* why) {
    reason.store(why, std::memory_order_relaxed);
    state.store(now, std::memory_order_relaxed);
  }
  DeviceHealth read() const {
    return {.state = state.load(std::memory_order_relaxed),
            .reason = reason.load(std::memory_order_relaxed),
            .delivered = delivered.load(std::memory_order_relaxed),
            .lost = lost.load(std::memory_order_relaxed),
            .recoveries = recoveries.load(std::memory_order_relaxed)};
  }
};

}  // namespace sonoband
