// Whether a pose can follow the one before it.
//
// A hand moves a probe at up to 2 m/s, and turns it at up to 1000 degrees/s. A step beyond that and 10 mm or
// 10 degrees (18 mm and 14 degrees from one record to the next at 240 Hz; 60 mm and 35 degrees over any gap)
// is no motion. Two things make such steps:
//  - the hemisphere: an AC field is the same at p and at -p, so a sensor that crosses the hemisphere plane
//    comes back mirrored through the source. Mirrored poses stay refused until the sensor is back.
//  - damage that the value ranges do not show. One such record is refused. Three in a row that agree with
//  each
//    other are a new place: in a new epoch, or, after half a second without a pose, simply where the probe
//    is.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "core/time.h"

namespace sonoband {

// The one of q and -q nearer to `previous`: both mean the same rotation, but not to an interpolation.
inline Eigen::Quaterniond nearer_sign(const Eigen::Quaterniond& q, const Eigen::Quaterniond& previous) {
  return q.dot(previous) < 0 ? Eigen::Quaterniond(-q.coeffs()) : q;
}

class PoseContinuity {
 public:
  enum class Step : std::uint8_t {
    follows,
    mirrored,   // on the wrong side of the hemisphere plane: position and what is seen from it are wrong
    jumped,     // refused for now
    new_place,  // confirmed by its predecessors: take it, in a new epoch
  };

  // `elapsed` since the pose judged before; `q` is normalised and gets the nearer sign.
  Step judge(const Eigen::Vector3d& position_mm, Eigen::Quaterniond& q, Duration elapsed);

  void restart() { *this = PoseContinuity(); }

 private:
  struct Pose {
    Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  };
  void take(const Pose& pose);

  bool started_ = false;
  bool mirrored_ = false;
  Pose last_;              // where the sensor truly was: already mirrored back if it was mirrored
  Duration since_last_{};  // over refused poses
  Pose odd_;
  int odd_count_ = 0;
};

}  // namespace sonoband
