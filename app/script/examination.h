// Runs a scripted examination on a cart and says what came of it.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/cart/appliance.h"
#include "app/script/script.h"
#include "board/devices.h"
#include "core/geometry/plane.h"
#include "core/parallel.h"
#include "core/reslice/band.h"
#include "hal/clock.h"

namespace sonoband::script {

struct Stage {
  cart::Appliance& cart;                       // started; the calling thread is its owner
  const std::function<bool(bool down)>& foot;  // of a simulated pedal; may be empty
  const std::vector<BoardView>& views;
  Clock& clock;
  Parallel& workers;
  std::filesystem::path out;  // exists; pictures go here
  // Gets every planar band that is painted. May be empty.
  std::function<void(const BandImage& band, const ReslicePlane& plane, int layers)> on_band = {};
};

// On the cart's clock, by a thread that is its member. Gives {"sweeps": [...], "pictures": [...], "ledger":
// {...}}: per sweep its frames and ledger, per picture its file, band, size, coverage and milliseconds.
// Throws ScriptFailed, or BadInput where a picture cannot be written.
nlohmann::ordered_json run(const std::vector<Step>& steps, const std::string& file, Stage& stage);

}  // namespace sonoband::script
