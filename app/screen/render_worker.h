// Renders bands for the screen on a thread of its own: one job at a time, the newest wins, and a job in
// flight is given up when a newer one comes, but never two in a row: a finger that asks faster than a band is
// painted would see none until it rests. Nobody waits for it.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "core/geometry/plane.h"
#include "core/manifold/manifold_band.h"
#include "core/reslice/prepared_sweep.h"

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
  bool coarse = false;  // half the pixels each way: for a slow machine while a finger is down
};

struct Stretch {
  double from_mm = 0;  // arc length along the curve
  double to_mm = 0;
};

struct PlanarPicture {
  BandImage band;
  ReslicePlane plane;  // that it was rendered for
  int layers = 0;
  double ms = 0;
  double thread_ms = 0;  // processor time of the worker's own thread, which does its share of the work
  bool coarse = false;
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
  std::uint64_t version = 0;
};

// Of two results the pictures whose request did not change are the same ones.
struct RenderResult {
  std::shared_ptr<const PlanarPicture> planar;
  std::shared_ptr<const ManifoldPicture> manifold;  // null: none was asked for, or the curve makes none
  std::uint64_t sweep_version = 0;
  std::uint64_t version = 0;
};

class RenderWorker {
 public:
  // `finished` is called on the worker's thread after each picture, for a screen that sleeps.
  explicit RenderWorker(int threads, std::function<void()> finished = {});
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
    std::uint64_t given_up = 0;  // overtaken by a newer one, before or during their work
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
  };
  void serve();
  std::shared_ptr<RenderResult> render(const RenderRequest& job, Kept& kept, Parallel& parallel);
  std::shared_ptr<PlanarPicture> paint(const RenderRequest& job, PreparedSweep& sweep, Parallel& parallel);
  std::shared_ptr<ManifoldPicture> unroll(const RenderRequest& job, PreparedSweep& sweep, Flow& kept,
                                          Parallel& parallel);

  int threads_;
  std::function<void()> finished_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  mutable std::condition_variable idle_;
  std::optional<RenderRequest> next_;
  std::shared_ptr<const RenderResult> newest_;
  Counts counts_;
  bool working_ = false;
  bool finishes_ = false;       // the job in flight is painted to its end
  std::uint64_t pictures_ = 0;  // begun; the worker's own
  bool ending_ = false;
  StopFlag overtaken_{false};
  std::thread thread_;
};

}  // namespace sonoband
