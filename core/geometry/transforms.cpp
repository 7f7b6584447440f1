#include "core/geometry/transforms.h"

namespace sonoband {

bool is_rotation(const Eigen::Matrix3d& m, double tolerance) {
  if (!m.allFinite()) return false;
  const Eigen::Matrix3d residual = m * m.transpose() - Eigen::Matrix3d::Identity();
  return residual.cwiseAbs().maxCoeff() <= tolerance && m.determinant() > 0;
}

}  // namespace sonoband
