// Renders bands for the screen on a thread of its own: one job at a time, the newest wins, and a job in
// flight is given up when a newer one comes. Nobody waits for it.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "core/geometry/plane.h"
#include "core/parallel.h"
#include "core/reslice/band.h"

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
  std::vector<Eigen::Vector2d> curve_mm;  // on the plane; fewer than two points: no manifold is asked for
  double reach_mm = 0;                    // the paper's r
  bool coarse = false;  // half the pixels each way: for a slow machine while a finger is down
};

struct Stretch {
  double from_mm = 0;  // arc length along the curve
  double to_mm = 0;
};

// The unrolled surface: columns follow the curve, rows the normal.
struct ManifoldPicture {
  BandImage band;
  double pixel_mm = 0;
  double length_mm = 0;
  int layers = 0;
  double thickness_mm = 0;
  std::vector<Eigen::Vector2d> upwind;    // c_u(s), plane mm; gaps where the front has vanished are bridged
  std::vector<Eigen::Vector2d> downwind;  // c_d(s)
  std::vector<Stretch> smeared;           // where outer layers share one point of the front
};

struct RenderResult {
  BandImage band;
  ReslicePlane plane;  // that it was rendered for
  double band_ms = 0;
  bool coarse = false;
  std::optional<ManifoldPicture> manifold;
  std::uint64_t version = 0;  // ascending
};

// A pure function of its arguments, for tests and for the worker.
ManifoldPicture unroll(const SweepView& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                       const std::vector<Eigen::Vector2d>& curve_mm, double reach_mm, Parallel& parallel);

class RenderWorker {
 public:
  explicit RenderWorker(int threads);
  ~RenderWorker();
  RenderWorker(const RenderWorker&) = delete;
  RenderWorker& operator=(const RenderWorker&) = delete;

  void ask(RenderRequest request);
  // Null before the first job is done.
  std::shared_ptr<const RenderResult> newest() const;
  bool busy() const;

  struct Counts {
    std::uint64_t asked = 0;
    std::uint64_t done = 0;
    std::uint64_t given_up = 0;  // overtaken by a newer one, before or during their work
  };
  Counts counts() const;

 private:
  void serve();

  int threads_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<RenderRequest> next_;
  std::shared_ptr<const RenderResult> newest_;
  Counts counts_;
  bool working_ = false;
  bool ending_ = false;
  std::atomic<bool> overtaken_{false};
  std::thread thread_;
};

}  // namespace sonoband
