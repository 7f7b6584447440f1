// The turn-table of a stored sweep, as the tool and the screen write it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/exchange/exam_movie.h"

namespace sonoband::exchange {

struct StoredTurn {
  std::filesystem::path exam;
  std::int64_t sweep = 1;
  std::string name;  // for people
  // How the frames of the sweep are to turn; they are at least one.
  std::function<TurnTable(const SweepView&)> turn;
};

// About the vertical, on a plane that holds the sweep at every angle. `settings.band.step_mm` is made the
// width of the B-scans' pixels.
TurnTable whole_turn(const SweepView& sweep, const RenderSettings& settings);

// Of the frames from the press on, as the cart paints them: what was recorded before it is not. Reading is
// the first tenth of the progress. Adds a sentence to `damage` for each picture that cannot be read. Throws
// exam::StoreError, and BadInput as write_turn_table.
void write_stored_turn(const StoredTurn& what, const std::filesystem::path& path, Parallel& parallel,
                       const Progress& progress, std::vector<std::string>& damage);

}  // namespace sonoband::exchange
