// When a record left the device, from when records arrived: USB and the scheduler only ever delay, so the
// line that supports the arrivals from below, over the frame count, is the device's clock (plus its fixed
// latency and the shortest way through USB; both are left to the temporal calibration).
//
// t = a + b frame, with b within 200 ppm of the nominal period, over the arrivals of the last 4 s. Typical
// lateness is 0 to 2 ms and rarely 20 to 50 ms; the line is within 0.1 ms of the earliest ones.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/time.h"

namespace sonoband {

class ArrivalFilter {
 public:
  explicit ArrivalFilter(Duration period = from_seconds(1.0 / 240)) { restart(period); }

  // Forgets everything; for each new epoch.
  void restart(Duration period);

  // The record's time: at or before `arrived`, and later than that of every record before it. Empty for the
  // first 100 ms, while one late arrival could still fool it. Precondition: `frame` is after the frame given
  // before (modulo 2^32).
  std::optional<Stamp> on_arrival(std::uint32_t frame, Stamp arrived);

  // Counts each time the arrivals left the line: 20 ms early (the count skipped), or late by most of a period
  // for half a second (it stood still). The filter then starts anew by itself; times before and after are not
  // comparable.
  std::uint32_t broken() const { return broken_; }

 private:
  // The earliest arrival of an eighth of the window.
  struct Bucket {
    std::int64_t number = 0;
    double frame = 0;    // since the first
    double late_ns = 0;  // against the nominal line through the first arrival
  };
  struct Line {
    double middle = 0;     // frame it turns about
    double height_ns = 0;  // there
    double slope_ns = 0;   // per frame, on top of the nominal period
    double at(double frame) const { return height_ns + slope_ns * (frame - middle); }
  };

  void begin(std::uint32_t frame, Stamp arrived);
  void put(double frame, double late_ns);
  void fit();

  static constexpr int capacity = 16;

  Duration period_{};
  std::int64_t frames_per_bucket_ = 1;
  bool started_ = false;
  std::uint32_t last_frame_ = 0;
  std::int64_t frame_ = 0;  // since the first
  Stamp first_arrival_{};
  Stamp last_time_{};
  int arrivals_ = 0;
  Stamp on_the_line_{};  // the last arrival near it
  std::array<Bucket, capacity> buckets_{};
  int count_ = 0;
  Line line_;
  std::uint32_t broken_ = 0;
};

}  // namespace sonoband
