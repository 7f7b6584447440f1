// Movies of a sweep: its B-scans as they came (cine), and its band on a plane that turns about an axis
// (turn-table), painted straight from the B-scans like every other band.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/exchange/exam_sequence.h"
#include "core/geometry/plane.h"
#include "core/parallel.h"
#include "core/reslice/band.h"

namespace sonoband::exchange {

// Every frame at its own time, to the millisecond. `source` says which sweep, for people. Throws BadInput
// where the sweep is empty or its times go back, the disk refuses, or `progress` stops it; then no file is
// there.
void write_cine(const ExportedSweep& sweep, const std::string& source, const std::filesystem::path& path,
                int threads, const Progress& progress = {});

enum class TurnAxis : std::uint8_t { down, right };  // of the plane to begin with, through its middle

// A plane along the probe's travel and into the body, just large enough that the whole sweep stays in the
// picture as it turns. Pixels as wide as the B-scans', or wider where a side would exceed `most_px`. Empty
// without frames.
std::optional<ReslicePlane> turn_table_plane(const SweepView& sweep, TurnAxis axis, int most_px = 1024);

// `plane` by `angle` about `axis`, right-handed.
ReslicePlane turned_about(const ReslicePlane& plane, TurnAxis axis, double angle_rad);

struct TurnTable {
  ReslicePlane plane;  // to begin with
  TurnAxis axis = TurnAxis::down;
  RenderSettings settings;
  int pictures = 120;  // of one whole turn, which plays without a seam when repeated
  double pictures_per_second = 15;
};

// Throws as write_cine.
void write_turn_table(const SweepView& sweep, const TurnTable& turn, const std::string& source,
                      const std::filesystem::path& path, Parallel& parallel, const Progress& progress = {});

}  // namespace sonoband::exchange
