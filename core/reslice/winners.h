// Which frame each sample of a patch takes, for any geometry: crossing frames, gaps, edges of pictures and
// masks.
//
// "Nearer than" between two frames is |zi| < |zj|, that is (zi - zj)(zi + zj) < 0, and "within reach" is two
// more conditions; all of them are half spaces of the patch, because z is affine. So the winners follow from
// boolean algebra on words of 64 lanes, exactly and without a search.
#pragma once

#include <span>
#include <vector>

#include "core/reslice/cull.h"
#include "core/reslice/patch.h"

namespace sonoband {

// Where a patch's samples are.
struct PatchPlace {
  int layers = 0;                            // up to patch_layers
  std::array<double, patch_layers> x, y, z;  // World mm of lane 0 of each layer
  std::array<LaneMask, patch_layers> lanes;  // that exist, of each layer
  Eigen::Vector3d sample_step = Eigen::Vector3d::Zero(), row_step = Eigen::Vector3d::Zero();  // mm
  LaneShape shape;
};

// Values of an affine function at lane 0 of each layer.
void values_at(const PatchPlace& place, const AffineScalar& f, double* values);

class Winners {
 public:
  // One candidate's share of the patch: layers first <= l < last.
  struct Share {
    int first = 0, last = 0;
    double reach_mm = 0;  // the farthest that counts
    double z_per_sample = 0, z_per_row = 0;
    std::array<double, patch_layers> z;                // at lane 0
    std::array<FixedPx, patch_layers> x, y;            // of the foot at lane 0
    std::array<LaneMask, patch_layers> support, wins;  // lanes in reach; lanes it is the nearest of
    // Linear only: lanes on the positive side; within twice the reach; nearest of its side there.
    std::array<LaneMask, patch_layers> positive, far_support, side_wins;
  };

  // frames[c] is candidates[c]'s, which are in order of capture.
  void find(const FrameTable& table, std::span<const Candidate> candidates,
            std::span<const PatchFrame* const> frames, const PatchPlace& place, const LaneGrid& grid,
            Interpolation interpolation);
  const Share& share(std::size_t candidate) const { return shares_[candidate]; }
  // Candidates that may both be in reach of a lane; others keep one another from nothing. By the later's
  // place.
  struct Meeting {
    std::size_t earlier, later;
  };
  const std::vector<Meeting>& meetings() const { return meetings_; }
  // Linear only: lanes of a layer that have a frame on the side that `share` is not on.
  LaneMask opposed(const Share& share, int layer) const {
    return (share.positive[layer] & negative_[layer]) | (~share.positive[layer] & positive_[layer]);
  }

 private:
  void support(const FrameTable& table, const Candidate& candidate, const PatchFrame& frame,
               const PatchPlace& place, const LaneGrid& grid, Share& share);
  bool may_meet(const Share& a, const Share& b) const;
  void contest(Share& earlier, Share& later, const PatchPlace& place, const LaneGrid& grid);

  bool linear_ = false;
  LaneShape shape_;
  std::array<LaneMask, patch_layers> positive_, negative_;  // lanes with a frame on that side
  std::vector<Share> shares_;
  std::vector<Meeting> meetings_;
};

}  // namespace sonoband
