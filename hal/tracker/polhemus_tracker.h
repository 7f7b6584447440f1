// The position tracker of the cart: a Polhemus LIBERTY or PATRIOT behind a byte port.
//
// start() does not wait for the device: read() brings the connection up, keeps it up, and hands out the
// probe's readings as they come. After start, read takes no heap and no lock.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>

#include "hal/clock.h"
#include "hal/devices.h"
#include "hal/shared_health.h"
#include "hal/tracker/link.h"

namespace sonoband {

class PolhemusTracker final : public Tracker {
 public:
  // `port` and `clock` outlive the tracker.
  PolhemusTracker(BytePort& port, Clock& clock, const LinkConfig& config);
  ~PolhemusTracker() override;

  void start() override;
  ReadStatus read(std::span<PoseSample> out, std::size_t& count, Duration timeout) override;
  DeviceHealth health() const override;
  void stop() override;  // leaves the unit quiet; takes up to 0.3 s

  // While a sweep is recorded the unit is not made to restart itself, which takes 10 s. Any thread.
  void set_recording(bool on) { recording_.store(on, std::memory_order_relaxed); }

  // For logs and tests, on the thread that reads.
  const LinkCounters& counters() const { return link_->counters(); }
  const Link& link() const { return *link_; }

 private:
  void take_turn(Stamp until);
  void obey(const LinkOutput& next);
  void keep_readings();
  void publish();

  BytePort& port_;
  Clock& clock_;
  const LinkConfig config_;
  std::unique_ptr<Link> link_;
  PortState port_state_ = PortState::absent;
  LinkOutput next_;
  bool started_ = false;
  std::array<std::uint8_t, LinkOutput::max_read> buffer_{};

  // Readings of one turn, handed out before the next turn is taken.
  std::array<PoseSample, Streaming::max_readings> kept_;
  std::size_t kept_from_ = 0;
  std::size_t kept_count_ = 0;

  std::atomic<bool> recording_{false};
  SharedHealth health_;
};

}  // namespace sonoband
