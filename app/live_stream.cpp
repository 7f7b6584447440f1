#include "app/live_stream.h"

#include <chrono>

#include "app/exchange/png.h"

namespace sonoband {
namespace {

// Half the time between frames at 120 a second.
constexpr Duration look_every = std::chrono::milliseconds(4);
constexpr const char* world = "Tracker";  // of everything that the cart itself records

const char* word_of(DeviceState state) {
  switch (state) {
    case DeviceState::absent:
      return "not connected";
    case DeviceState::starting:
      return "starting";
    case DeviceState::running:
      return "running";
    case DeviceState::degraded:
      return "running, but look at it";
    case DeviceState::stalled:
      return "silent";
    case DeviceState::fault:
      break;
  }
  return "at fault";
}

bool delivers(DeviceState state) {
  return state == DeviceState::running || state == DeviceState::degraded;
}

bool is_loopback(const std::string& address) {
  return address.starts_with("127.");
}

}  // namespace

StreamSentence stream_sentence(const cart::ApplianceStatus& status) {
  const DeviceState scanner = status.frames.health.state;
  const DeviceState tracker = status.tracker.health.state;
  StreamSentence s;
  s.good = delivers(scanner) && delivers(tracker) && !status.frozen;
  s.text = std::string("Research use only. Cart: ") + cart::name_of(status.cart.state) +
           "; scanner: " + (status.frozen ? "frozen" : word_of(scanner)) + "; tracker: " + word_of(tracker);
  return s;
}

LiveStream::LiveStream(cart::Appliance& cart, const exchange::IgtlSettings& settings)
    : cart_(cart), server_(settings), beyond_(!is_loopback(settings.bind)) {
  const auto utc = std::chrono::system_clock::now().time_since_epoch();
  utc_of_zero_ns_ = std::chrono::duration_cast<std::chrono::nanoseconds>(utc).count() -
                    cart.clock().now().time_since_epoch().count();
  thread_ = ClockThread(cart.clock(), [this] { follow(); });
}

LiveStream::~LiveStream() {
  ending_ = true;
  thread_.join();
}

void LiveStream::follow() {
  Stamp last = Stamp::min();
  std::uint64_t seen = 0;
  while (!ending_) {
    if (const cart::ApplianceStatus* status = cart_.watch()) {
      const StreamSentence s = stream_sentence(*status);
      server_.set_status(s.good, s.text);
    }
    const std::uint64_t published = cart_.ring().status().published;
    if (const FrameLease lease = cart_.latest(); lease && lease.frame().tracked.captured > last) {
      const SweepFrame& newest = lease.frame();
      last = newest.tracked.captured;
      if (seen != 0 && published > seen + 1)
        skipped_.fetch_add(published - seen - 1, std::memory_order_relaxed);
      exchange::IgtlFrame f;
      f.utc_ns = utc_ns(last);
      f.pixels = newest.tracked.bscan.pixels;
      f.kind = newest.tracked.bscan.kind;
      f.world = world;
      if (newest.tracked.pose_status == PoseStatus::ok) {
        f.world_from_image = newest.tracked.world_from_image;
        f.tracker_from_probe = newest.tracker_from_probe;
      }
      server_.publish(f);
      seen = published;
    }
    send_band();
    cart_.clock().sleep_until(cart_.clock().now() + look_every);
  }
}

void LiveStream::show_band(const BandImage& band, const ReslicePlane& plane, int layers) {
  Band b;
  b.utc_ns = utc_ns(cart_.clock().now());
  b.picture = exchange::band_png(band);
  b.coverage = exchange::coverage_png(band, layers);
  b.world_from_image.linear.col(0) = plane.right.v * plane.pixel_mm;
  b.world_from_image.linear.col(1) = plane.down.v * plane.pixel_mm;
  b.world_from_image.linear.col(2) = plane.normal().v;
  b.world_from_image.translation = plane.origin.v;
  const std::lock_guard lock(mutex_);
  band_ = std::move(b);
}

void LiveStream::send_band() {
  std::optional<Band> b;
  {
    const std::lock_guard lock(mutex_);
    b.swap(band_);
  }
  if (!b) return;
  server_.keep("Band", exchange::igtl_image("Band", b->utc_ns, b->picture, b->world_from_image));
  server_.keep("BandCoverage",
               exchange::igtl_image("BandCoverage", b->utc_ns, b->coverage, b->world_from_image));
}

}  // namespace sonoband
