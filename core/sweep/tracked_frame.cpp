#include "core/sweep/tracked_frame.h"

#include <cassert>

namespace sonoband {

void set_pose(TrackedFrame& f, const Affine<frame::World, frame::Image>& world_from_image) {
  f.world_from_image = world_from_image;
  const Eigen::Vector3d normal = world_from_image.linear.col(0).cross(world_from_image.linear.col(1));
  assert(normal.allFinite() && normal.norm() > 0);
  f.world_from_image.linear.col(2) = normal.normalized();
  f.image_from_world = f.world_from_image.inverse();
  f.pose_status = PoseStatus::ok;
}

}  // namespace sonoband
