// What the cart sees, over OpenIGTLink: tracked frames as they come, the band on the screen, and how the
// devices are. Acquisition knows nothing of it: it looks at the newest frame, and at a copy of the status.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "app/cart/appliance.h"
#include "app/exchange/igtl_server.h"
#include "core/geometry/plane.h"
#include "core/reslice/band.h"

namespace sonoband {

// What GET_STATUS answers: whether frames and their places come, and a sentence.
struct StreamSentence {
  bool good = false;
  std::string text;
};
StreamSentence stream_sentence(const cart::ApplianceStatus& status);

class LiveStream {
 public:
  // Listens from now on. `cart` outlives this and is started or about to be. Throws BadInput where the port
  // cannot be had.
  LiveStream(cart::Appliance& cart, const exchange::IgtlSettings& settings);
  ~LiveStream();
  LiveStream(const LiveStream&) = delete;
  LiveStream& operator=(const LiveStream&) = delete;

  // Any thread. IMAGE "Band" in the colours of the screen with its place in space, and IMAGE "BandCoverage":
  // 0 where there is no data, which black is not. Whoever connects later gets the last ones. `layers` as in
  // coverage_png.
  void show_band(const BandImage& band, const ReslicePlane& plane, int layers);

  std::uint16_t port() const { return server_.port(); }
  bool beyond_this_machine() const { return beyond_; }
  exchange::IgtlStatus status() const { return server_.status(); }
  // Frames that came and went between two looks (a burst after the tracker's silence).
  std::uint64_t skipped() const { return skipped_.load(std::memory_order_relaxed); }

 private:
  // As the screen shows it, on its way to the thread that packs it.
  struct Band {
    std::int64_t utc_ns = 0;
    exchange::PngPicture picture;
    exchange::PngPicture coverage;
    Affine<frame::World, frame::Image> world_from_image;
  };
  void follow();
  void send_band();
  std::int64_t utc_ns(Stamp t) const { return utc_of_zero_ns_ + t.time_since_epoch().count(); }

  cart::Appliance& cart_;
  exchange::IgtlServer server_;
  bool beyond_;
  std::int64_t utc_of_zero_ns_;  // of the cart's clock, as it was at the start
  std::mutex mutex_;             // of band_, for moments
  std::optional<Band> band_;     // the newest, not yet sent
  std::atomic<std::uint64_t> skipped_{0};
  std::atomic<bool> ending_{false};
  ClockThread thread_;  // last: ends before anything it uses
};

}  // namespace sonoband
