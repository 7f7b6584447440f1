#include "hal/tracker/pose_continuity.h"

#include <algorithm>

namespace sonoband {
namespace {

constexpr double max_speed_mm_per_s = 2000;
constexpr double position_slack_mm = 10;
constexpr double max_turn_deg_per_s = 1000;
constexpr Duration longest_guess =
    std::chrono::milliseconds(25);  // farther than 60 mm or 35 degrees is never near
constexpr double turn_slack_deg = 10;
constexpr double degrees = 180 / 3.14159265358979323846;

bool near(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Duration elapsed) {
  return (a - b).norm() <= position_slack_mm + max_speed_mm_per_s * seconds(std::min(elapsed, longest_guess));
}

bool near(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b, Duration elapsed) {
  return a.angularDistance(b) * degrees <=
         turn_slack_deg + max_turn_deg_per_s * seconds(std::min(elapsed, longest_guess));
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
  constexpr Duration memory = std::chrono::milliseconds(500);
  constexpr int confirmations = 3;

  if (!started_) {
    take({position_mm, q});
    return Step::follows;
  }
  q = nearer_sign(q, last_.q);
  since_last_ += elapsed;

  const bool turns = near(q, last_.q, since_last_);
  // Near the source both signs are near; then the reading stands as it is.
  if (turns && near(position_mm, last_.position_mm, since_last_)) {
    mirrored_ = false;
    take({position_mm, q});
    return Step::follows;
  }
  const bool forgotten = since_last_ > memory;
  const bool nearer_mirrored =
      (-position_mm - last_.position_mm).norm() < (position_mm - last_.position_mm).norm();
  if (forgotten ? mirrored_ && nearer_mirrored
                : turns && near(-position_mm, last_.position_mm, since_last_)) {
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
  return forgotten ? Step::follows : Step::new_place;
}

}  // namespace sonoband
