#include "hal/tracker/recovery_ladder.h"

#include <algorithm>

namespace sonoband {
namespace {

constexpr Duration forgets = std::chrono::seconds(10);
constexpr Duration patience = std::chrono::seconds(15);
constexpr Duration lasting = std::chrono::seconds(5);
constexpr Duration last_resort_again = std::chrono::seconds(60);

Rung mildest(LinkReason trouble) {
  switch (trouble) {
    case LinkReason::silent:
      return Rung::restart;
    case LinkReason::io_error:
      return Rung::reset_port;
    case LinkReason::hardware:
      return Rung::reinitialise;
    default:
      return Rung::reconfigure;
  }
}

}  // namespace

void RecoveryLadder::came(Stamp now) {
  came_ = now;
  climbed_ = Rung::none;
}

void RecoveryLadder::restarted(Stamp now) {
  came_ = now;
  restarted_ = now;
}

void RecoveryLadder::healthy(Stamp now) {
  if (climbed_ != Rung::none && now - last_trouble_ > forgets) climbed_ = Rung::none;
}

bool RecoveryLadder::young(Stamp now) const {
  return now - came_ < patience;
}

Rung RecoveryLadder::next(LinkReason trouble, Stamp now, bool recording) {
  last_trouble_ = now;
  if (climbed_ == Rung::none) began_ = now;
  Rung rung = mildest(trouble);
  if (climbed_ != Rung::none)
    rung = std::max(rung, static_cast<Rung>(std::min<int>(static_cast<int>(climbed_) + 1,
                                                          static_cast<int>(Rung::give_up))));
  if (rung > Rung::reconfigure && young(now) && trouble == LinkReason::no_answer) return Rung::reconfigure;
  const bool passing = trouble != LinkReason::hardware && now - began_ < lasting;
  if (rung > Rung::reset_port && climbed_ < Rung::reinitialise && (recording || young(now) || passing))
    rung = Rung::reset_port;  // again, until the last resort is allowed
  if (rung == Rung::give_up && !recording && now - restarted_ > last_resort_again) rung = Rung::reinitialise;
  climbed_ = std::max(climbed_, rung);
  return rung;
}

}  // namespace sonoband
