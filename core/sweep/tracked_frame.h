// A B-scan in space: the only input of rendering.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/transforms.h"
#include "core/image/image.h"
#include "core/time.h"

namespace sonoband {

// One ultrasound picture, cropped, in MF orientation.
struct BScan {
  ConstPixels pixels;
  PixelKind kind = PixelKind::grey;
};

// Why a frame has no place in space. Such a frame is kept and counted, never rendered.
enum class PoseStatus : std::uint8_t {
  ok,
  not_yet,    // no pose after the frame came within the bounded wait
  gap,        // the poses around it are farther apart than the limit
  poor,       // the tracker called one of them unusable (distortion, source fault, missing)
  new_epoch,  // the tracker was restarted between them
};

struct TrackedFrame {
  BScan bscan;
  Affine<frame::World, frame::Image> world_from_image;  // columns: mm per pixel along x and y; see set_pose
  Affine<frame::Image, frame::World>
      image_from_world;  // rows: x_px, y_px, and z_mm, signed distance from the B-scan
  PoseStatus pose_status = PoseStatus::not_yet;
  std::int32_t sweep_id = 0;  // frames are neighbours only within one sweep
  std::int64_t sequence = 0;  // order of capture within the sweep
  Stamp captured{};           // after the latency offset
};

// Places the frame. Of `world_from_image` only the translation and the first two columns count: the third is
// replaced by the unit normal x cross y, so that image_from_world gives the foot of the perpendicular in
// pixels, sheared or not, and the distance in mm. Sets pose_status to ok. Precondition: the first two columns
// are finite and not parallel (asserted).
void set_pose(TrackedFrame& f, const Affine<frame::World, frame::Image>& world_from_image);

// Which pixels of every B-scan of a sweep are ultrasound: non-zero counts, zero is outside. Empty: all of
// them.
using MaskView = ConstPixels;

// What a rendering sees of one or more sweeps. All frames have pose_status ok, in order of capture within a
// sweep. `mask` has the size of the frames or is empty. Frames may differ in size only if the mask is empty.
struct SweepView {
  std::span<const TrackedFrame* const> frames;
  MaskView mask;
};

}  // namespace sonoband
