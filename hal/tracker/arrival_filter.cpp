#include "hal/tracker/arrival_filter.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace sonoband {
namespace {

constexpr double max_drift = 200e-6;
constexpr double window_s = 4;
constexpr Duration settling = std::chrono::milliseconds(100);
constexpr int settling_arrivals = 5;
// Late by most of a period for this long, record after record: the count stood still meanwhile. A host that
// is only slow is on time now and then.
constexpr double broken_periods = 0.7;
constexpr Duration broken_after = std::chrono::milliseconds(500);
constexpr double early_ns = 20e6;

}  // namespace

void ArrivalFilter::restart(Duration period) {
  assert(period > Duration(0));
  period_ = period;
  frames_per_bucket_ = std::max<std::int64_t>(1, std::llround(window_s / capacity / seconds(period)));
  started_ = false;
  count_ = 0;
}

void ArrivalFilter::begin(std::uint32_t frame, Stamp arrived) {
  started_ = true;
  last_frame_ = frame;
  frame_ = 0;
  first_arrival_ = arrived;
  arrivals_ = 0;
  on_the_line_ = arrived;
  count_ = 0;
}

void ArrivalFilter::put(double frame, double late_ns) {
  const std::int64_t number = frame_ / frames_per_bucket_;
  if (count_ > 0 && buckets_[static_cast<std::size_t>(count_ - 1)].number == number) {
    Bucket& newest = buckets_[static_cast<std::size_t>(count_ - 1)];
    if (late_ns >= newest.late_ns) return;
    newest = {number, frame, late_ns};
  } else {
    const auto last = buckets_.begin() + count_;
    const auto kept =
        std::find_if(buckets_.begin(), last, [&](const Bucket& b) { return b.number > number - capacity; });
    count_ = static_cast<int>(std::move(kept, last, buckets_.begin()) - buckets_.begin());
    assert(count_ < capacity);
    buckets_[static_cast<std::size_t>(count_++)] = {number, frame, late_ns};
  }
  fit();
}

// The highest line at the window's middle that is nowhere above an arrival: a concave function of the slope,
// whose maximum lies at a bound or at the slope between two arrivals.
void ArrivalFilter::fit() {
  const double steepest = max_drift * static_cast<double>(period_.count());
  const auto n = static_cast<std::size_t>(count_);
  double middle = 0;
  for (std::size_t i = 0; i < n; ++i) middle += buckets_[i].frame / static_cast<double>(n);

  const auto height = [&](double slope) {
    double lowest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i)
      lowest = std::min(lowest, buckets_[i].late_ns - slope * (buckets_[i].frame - middle));
    return lowest;
  };
  // No drift first: it stays the answer where nothing tells slopes apart.
  line_ = {middle, height(0), 0};
  const auto consider = [&](double slope) {
    const double h = height(slope);
    if (h > line_.height_ns) line_ = {middle, h, slope};
  };
  consider(-steepest);
  consider(steepest);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      const double slope =
          (buckets_[j].late_ns - buckets_[i].late_ns) / (buckets_[j].frame - buckets_[i].frame);
      if (std::abs(slope) < steepest) consider(slope);
    }
}

std::optional<Stamp> ArrivalFilter::on_arrival(std::uint32_t frame, Stamp arrived) {
  if (!started_) begin(frame, arrived);
  frame_ += static_cast<std::int64_t>(frame - last_frame_);  // modulo 2^32, so a wrap is one step
  last_frame_ = frame;

  const auto nominal = [&] { return first_arrival_ + frame_ * period_; };
  double late_ns = static_cast<double>((arrived - nominal()).count());
  const bool settled = arrivals_ >= settling_arrivals && arrived - first_arrival_ >= settling;

  if (settled) {
    const double off_ns = late_ns - line_.at(static_cast<double>(frame_));
    if (off_ns <= broken_periods * static_cast<double>(period_.count())) on_the_line_ = arrived;
    if (off_ns < -early_ns || arrived - on_the_line_ > broken_after) {
      ++broken_;
      begin(frame, arrived);
      late_ns = 0;
    }
  }
  put(static_cast<double>(frame_), late_ns);
  ++arrivals_;
  if (arrivals_ <= settling_arrivals || arrived - first_arrival_ < settling) return std::nullopt;

  // An arrival that lowers the line may not turn time back.
  Stamp t = nominal() + Duration(std::llround(line_.at(static_cast<double>(frame_))));
  t = std::min(std::max(t, last_time_ + period_ / 16), std::max(arrived, last_time_ + Duration(1)));
  last_time_ = t;
  return t;
}

}  // namespace sonoband
