// What the cart does, in lines of JSON for whoever looks on from outside: a log, or a test of a board whose
// pedal, tracker and power are worked by somebody else.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "app/cart/appliance.h"

namespace sonoband::script {

class Watch {
 public:
  // A line as soon as a state has changed since the last one, and twice a second for the counts; empty
  // otherwise.
  //   {"at":12.5, "state":"recording", "note":"", "tracker":"running", "video":"running", "pedal":"running",
  //    "down":true, "armed":true, "lost_edges":0, "readings":840, "pictures":41, "frames":20, "saved":18}
  // at: s of the cart's clock. readings, pictures: received since start. frames: of all sweeps of this exam;
  // saved: those of them that would survive a power cut. Both stay 0 where nothing is to be saved.
  std::optional<std::string> line(const cart::ApplianceStatus& status);

 private:
  nlohmann::ordered_json told_;
  std::optional<Stamp> told_at_;
};

}  // namespace sonoband::script
