// Renders bands for the screen on a thread of its own: one job at a time, the newest wins, and a job in
// flight is given up when a newer one comes, but never two in a row that showed nothing: a finger that asks
// faster than a band is painted would see none until it rests. Nor three in a row that left out the manifold,
// which comes after the planar band. Nobody waits for it.
//
// While a finger moves the plane along its normal or changes the thickness, bands come out of layers that are
// got ready between jobs (drag_layers.h), and where a full band takes longer than the budget a coarse one
// comes first. The request that follows when the finger rests or leaves is answered by render_planar's own
// bits, whatever came before.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "app/screen/render_request.h"
#include "app/screen/request_painter.h"
#include "core/time.h"

namespace sonoband {

struct RenderLimits {
  std::size_t layer_bytes = std::size_t{256} << 20;  // of a drag's layers; 14 mm of 640x480 take up to 122 MB
  // Of the sweep's pictures kept turned: 61 MB of 200 of 640x480; none of a sweep that would take more.
  std::size_t turned_bytes = std::size_t{256} << 20;
  Duration layers_kept = std::chrono::seconds(10);  // they and turned pictures, after the last request
};

class RenderWorker {
 public:
  // `finished` is called on the worker's thread after each picture, for a screen that sleeps.
  explicit RenderWorker(int threads, std::function<void()> finished = {}, const RenderLimits& limits = {});
  ~RenderWorker();
  RenderWorker(const RenderWorker&) = delete;
  RenderWorker& operator=(const RenderWorker&) = delete;

  void ask(RenderRequest request);
  // Null before the first job is done.
  std::shared_ptr<const RenderResult> newest() const;
  bool busy() const;
  // Until nothing is asked for any more. For tests and for a screen whose clock stands still meanwhile.
  void wait() const;

  struct Counts {
    std::uint64_t asked = 0;
    std::uint64_t done = 0;
    std::uint64_t given_up = 0;      // overtaken by a newer one, before or during their work
    std::uint64_t from_layers = 0;   // of the planar pictures
    std::uint64_t coarse = 0;        // pictures shown before the full ones
    std::uint64_t early = 0;         // planar bands shown before their manifolds
    std::uint64_t layer_bytes = 0;   // kept now
    std::uint64_t turned_bytes = 0;  // likewise
    double layers_ms = 0;            // of the worker's thread, spent on getting layers ready
  };
  Counts counts() const;

 private:
  using SteadyClock = std::chrono::steady_clock;

  void serve(const RenderLimits& limits);
  RenderRequest next_request(RequestPainter& painter, const RenderLimits& limits, bool& ends);
  void answer(RequestPainter& painter, const RenderRequest& request);
  bool publish(RenderResult result, bool last);
  void tell(const RequestPainter& painter);

  int threads_;
  std::function<void()> finished_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  mutable std::condition_variable idle_;
  std::optional<RenderRequest> next_;
  std::shared_ptr<const RenderResult> newest_;
  Counts counts_;
  SteadyClock::time_point asked_at_;  // the next one
  double waited_ms_ = 0;              // the one in flight
  bool working_ = false;
  bool answered_ = false;  // the job in flight has shown its full answer
  bool finishes_ = false;  // the job in flight shows something before it is given up
  int given_up_ = 0;       // jobs before the one in flight, in a row
  std::uint64_t results_ = 0;
  bool ending_ = false;
  StopFlag overtaken_{false};
  StopFlag called_{false};  // a request waits
  std::thread thread_;
};

}  // namespace sonoband
