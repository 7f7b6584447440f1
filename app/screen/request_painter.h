// How a request of the screen is painted, and what is kept for the next: pictures that did not change, the
// flow of the curve, layers of a drag, what a picture took. On one thread, with helpers; the thread and who
// waits are the render worker's.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "app/screen/drag_layers.h"
#include "app/screen/render_request.h"
#include "core/reslice/turned_frames.h"

namespace sonoband {

class RequestPainter {
 public:
  // `parallel` does nothing more once `overtaken` is set; `workers` go on. What is painted then is rubbish.
  struct Hands {
    Parallel& parallel;
    Parallel& workers;
    const StopFlag& overtaken;
  };
  // Takes what can be shown before the rest is done. False: the job is overtaken, give it up.
  using Show = std::function<bool(RenderResult)>;

  RequestPainter(const Hands& hands, std::size_t most_layer_bytes, std::size_t most_turned_bytes)
      : hands_(hands), layers_(most_layer_bytes), most_turned_bytes_(most_turned_bytes) {}

  // The full answer; before it, to `show`, a coarse picture where the full one takes too long, and the planar
  // band where the manifold is still to be painted. Rubbish once the job is overtaken: then `keep` must not
  // be called.
  RenderResult answer(const RenderRequest& request, PreparedSweep& sweep, const Show& show);
  // The answer was shown: the next request is compared with it.
  void keep(const RenderRequest& request, const RenderResult& result);
  // Layers for the next step of a drag, if this was one; the sweep's pictures turned, if parts of them had to
  // be for this band and the sweep had stopped to change. Ends soon after `stop` is set.
  void get_ready(const RenderRequest& request, PreparedSweep& sweep, const StopFlag& stop);

  std::size_t layer_bytes() const { return layers_.bytes(); }
  std::size_t turned_bytes() const { return turned_.bytes(); }
  void give_back();
  std::uint64_t from_layers() const { return from_layers_; }  // planar pictures, since the start
  double layers_ms() const { return layers_ms_; }             // processor time of getting ready, likewise

 private:
  // What a job is worked on with.
  struct Job {
    const RenderRequest& request;
    PreparedSweep& sweep;
    const Show& show;
  };
  // The flow of the last curve: the same while only the plane, the reach or the sweep change.
  struct Flow {
    std::vector<Eigen::Vector2d> curve_mm;
    double pixel_mm = 0;
    int layers = 0;
    Curve curve;
    CurveFlow flow;
  };
  std::shared_ptr<PlanarPicture> picture_for(const RenderRequest& request);
  std::shared_ptr<const PlanarPicture> planar(const Job& job);
  std::shared_ptr<PlanarPicture> from_layers(const Job& job);
  std::shared_ptr<PlanarPicture> paint(const Job& job);
  void show_coarse(const Job& job, BandImage band, double ms, double thread_ms);
  void show_planar(const Job& job, const std::shared_ptr<const PlanarPicture>& planar);
  bool show(const Job& job, RenderResult result);
  bool of_shown_sweep(const RenderRequest& request) const;
  bool keeps_manifold(const RenderRequest& request) const;
  std::shared_ptr<const ManifoldPicture> manifold(const Job& job,
                                                  const std::shared_ptr<const PlanarPicture>& planar);
  std::shared_ptr<ManifoldPicture> unroll(const Job& job, int factor);
  bool ready_flow(const RenderRequest& request, const ReslicePlane& plane, const Band& band);
  double& pace(const RenderRequest& request) {
    return ms_per_sample_[static_cast<std::size_t>(request.settings.interpolation)];
  }

  Hands hands_;
  DragLayers layers_;
  TurnedFrames turned_;  // of the sweep version painted last
  std::uint64_t turned_version_ = 0;
  std::size_t most_turned_bytes_;
  bool turned_parts_ = false;  // the last band had parts of pictures turned, of a version seen before
  Flow flow_;
  RenderRequest done_;  // that the newest full result answers; its sweep is let go: the ring needs the room
  RenderResult result_;
  std::shared_ptr<const ManifoldPicture> seen_;  // the manifold that is shown, coarse or not
  bool dragged_ = false;                         // from `done_` before the last
  std::array<double, 2> ms_per_sample_{};        // of the last full band, by interpolation; 0: not known
  double manifold_ms_ = 0;                       // the last full one took
  std::uint64_t pictures_ = 0;                   // begun
  std::uint64_t from_layers_ = 0;
  double layers_ms_ = 0;
};

}  // namespace sonoband
