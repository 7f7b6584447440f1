#include "hal/tracker/pose_continuity.h"

namespace sonoband {
namespace {

constexpr double max_speed_mm_per_s = 5000;
constexpr double position_slack_mm = 10;
constexpr double max_turn_deg_per_s = 1500;
constexpr double turn_slack_deg = 10;
constexpr double degrees = 180 / 3.14159265358979323846;

bool near(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Duration elapsed) {
  return (a - b).norm() <= position_slack_mm + max_speed_mm_per_s * seconds(elapsed);
}

bool near(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b, Duration elapsed) {
  return a.angularDistance(b) * degrees <= turn_slack_deg + max_turn_deg_per_s * seconds(elapsed);
}

}  // namespace

void PoseContinuity::take(const Pose& pose) {
  started_ = true;
  last_ = pose;
  since_last_ = Duration(0);
  odd_count_ = 0;
}

PoseContinuity::Step PoseContinuity::judge(const Eigen::Vector3d& position_mm, Eigen::Quaterniond& q,
                                           Duration elapsed) {
  constexpr Duration memory = std::chrono::milliseconds(500);  // after it a probe may be anywhere
  constexpr int confirmations = 3;

  if (!started_) {
    take({position_mm, q});
    return Step::follows;
  }
  q = nearer_sign(q, last_.q);
  since_last_ += elapsed;

  const double as_is = (position_mm - last_.position_mm).norm();
  const double mirrored_back = (-position_mm - last_.position_mm).norm();
  const bool turns = near(q, last_.q, since_last_);
  const bool forgotten = since_last_ > memory;

  if (forgotten && !mirrored_) {
    take({position_mm, q});
    return Step::follows;
  }
  // Near the source both signs are near; then the reading stands as it is.
  if (forgotten ? as_is <= mirrored_back : turns && near(position_mm, last_.position_mm, since_last_)) {
    mirrored_ = false;
    take({position_mm, q});
    return Step::follows;
  }
  if (forgotten || (turns && near(-position_mm, last_.position_mm, since_last_))) {
    mirrored_ = true;
    take({-position_mm, q});
    return Step::mirrored;
  }

  const bool agrees =
      odd_count_ > 0 && near(position_mm, odd_.position_mm, elapsed) && near(q, odd_.q, elapsed);
  odd_ = {position_mm, q};
  odd_count_ = agrees ? odd_count_ + 1 : 1;
  if (odd_count_ < confirmations) return Step::jumped;
  mirrored_ = false;
  take(odd_);
  return Step::new_place;
}

}  // namespace sonoband
