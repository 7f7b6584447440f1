// Renders bands for the screen on a thread of its own: one job at a time, the newest wins, and a job in
// flight is given up when a newer one comes, but never two in a row that showed nothing: a finger that asks
// faster than a band is painted would see none until it rests. Nobody waits for it.
//
// While a finger moves the plane along its normal or changes the thickness, bands come out of layers that are
// got ready between jobs (drag_layers.h), and where a full band takes longer than the budget a coarse one
// comes first. The request that follows when the finger rests or leaves is answered by render_planar's own
// bits, whatever came before.
#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "app/screen/drag_layers.h"
#include "core/geometry/plane.h"
#include "core/manifold/manifold_band.h"
#include "core/reslice/prepared_sweep.h"
#include "core/time.h"

namespace sonoband {

// Frames, and what keeps them alive.
struct HeldSweep {
  SweepView view;
  std::shared_ptr<const void> keeper;
};

struct RenderRequest {
  HeldSweep sweep;
  std::uint64_t sweep_version = 0;  // changes with the frames
  ReslicePlane plane;
  RenderSettings settings;
  // On a plane of its own, which in-plane moves of the other leave where it is. Fewer than two points: no
  // manifold is asked for.
  std::vector<Eigen::Vector2d> curve_mm;
  ReslicePlane curve_plane;
  double reach_mm = 0;  // the paper's r
  // By a finger: another request follows, the last one without it. Frames denser than pixels are left out.
  bool moving = false;
  double budget_ms = 0;  // while moving: from when on a coarse picture is better than none; 0: never
  // The plane will move along its normal next, or its thickness change.
  bool drag_ahead = false;
};

struct Stretch {
  double from_mm = 0;  // arc length along the curve
  double to_mm = 0;
};

struct PlanarPicture {
  BandImage band;
  ReslicePlane plane;  // of its pixels
  int layers = 0;
  double ms = 0;
  double thread_ms = 0;  // processor time of the worker's own thread, which does its share of the work
  bool coarse = false;
  bool exact = true;          // render_planar's bits of what was asked, no frame left out
  std::uint64_t version = 0;  // ascending
};

// The unrolled surface as the screen shows it: columns follow the curve, rows its normal n.
struct ManifoldPicture {
  BandImage band;
  double pixel_mm = 0;
  double length_mm = 0;
  int layers = 0;
  double thickness_mm = 0;
  std::vector<PlaneLine> up, down;  // the paper's c_u and c_d, plane mm
  std::vector<Stretch> smeared;     // where some layer shows one ruling in several columns
  double ms = 0;
  bool coarse = false;
  bool exact = true;
  std::uint64_t version = 0;
};

// Of two results the pictures whose request did not change are the same ones.
struct RenderResult {
  std::shared_ptr<const PlanarPicture> planar;
  std::shared_ptr<const ManifoldPicture> manifold;  // null: none was asked for, or the curve makes none
  std::uint64_t sweep_version = 0;
  std::uint64_t version = 0;
};

struct RenderLimits {
  std::size_t layer_bytes = std::size_t{256} << 20;  // of a drag's layers; 14 mm of 640x480 take up to 102 MB
  Duration layers_kept = std::chrono::seconds(10);   // after the last request
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
    std::uint64_t given_up = 0;     // overtaken by a newer one, before or during their work
    std::uint64_t from_layers = 0;  // of the planar pictures
    std::uint64_t coarse = 0;       // pictures shown before the full ones
    std::uint64_t layer_bytes = 0;  // kept now
    double layers_ms = 0;           // of the worker's thread, spent on getting layers ready
  };
  Counts counts() const;

 private:
  // The flow of the last curve: the same while only the plane, the reach or the sweep change.
  struct Flow {
    std::vector<Eigen::Vector2d> curve_mm;
    double pixel_mm = 0;
    int layers = 0;
    Curve curve;
    CurveFlow flow;
  };
  // No frames: the ring needs their room.
  struct Kept {
    Flow flow;
    RenderRequest done;  // that the newest result answers; its sweep is let go
    RenderResult result;
    DragLayers layers;
    std::array<double, 2> ms_per_sample{};  // of the last full band, by interpolation; 0: not known
    double manifold_ms = 0;                 // the last full one took
  };
  // What a job is worked on with.
  struct Job {
    const RenderRequest& request;
    PreparedSweep sweep;
    Parallel& parallel;  // which does nothing more once the job is overtaken
    Parallel& workers;   // which goes on
    Kept& kept;
  };
  void serve(const RenderLimits& limits);
  RenderRequest next_request(Kept& kept, const RenderLimits& limits, bool& ends);
  void answer(Job& job);
  bool publish(std::shared_ptr<RenderResult> result, bool last);
  void get_layers_ready(Job& job);
  void tell_layers(const DragLayers& layers, double ms);
  std::shared_ptr<PlanarPicture> picture_for(const Job& job);
  std::shared_ptr<const PlanarPicture> planar(Job& job);
  std::shared_ptr<PlanarPicture> from_layers(Job& job);
  std::shared_ptr<PlanarPicture> paint(Job& job);
  void show_coarse(Job& job, BandImage band, double ms, double thread_ms);
  std::shared_ptr<const ManifoldPicture> manifold(Job& job,
                                                  const std::shared_ptr<const PlanarPicture>& planar);
  std::shared_ptr<ManifoldPicture> unroll(Job& job, int factor);

  int threads_;
  std::function<void()> finished_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  mutable std::condition_variable idle_;
  std::optional<RenderRequest> next_;
  std::shared_ptr<const RenderResult> newest_;
  Counts counts_;
  bool working_ = false;
  bool finishes_ = false;  // the job in flight shows something before it is given up
  std::uint64_t results_ = 0;
  std::uint64_t pictures_ = 0;  // begun; the worker's own
  bool ending_ = false;
  StopFlag overtaken_{false};
  StopFlag called_{false};  // a request waits
  std::thread thread_;
};

}  // namespace sonoband
