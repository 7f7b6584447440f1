// What a recording holds, in numbers: for `info` and for whoever wants to know before rendering.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "app/exchange/plus_config.h"
#include "app/exchange/sequence.h"

namespace sonoband::exchange {

// Keys:
//   frames width height slices components element_type orientation orientation_in_file image_type
//   compressed
//   time        {stamped, first_s, last_s, duration_s, rate_hz, median_interval_s, not_increasing,
//                gaps: [{after_frame, s}]}
//   pictures    {ok, invalid}
//   transforms  [{name, frames, status: {OK: n, ...}, status_missing, not_a_pose}]
//   motion      {of, in, frames, path_mm, spacing_mm: {median, max}, speed_mm_s: {median, max},
//                jumps: [{after_frame, mm}], without_pose: [[first, last], ...],
//                pixel_mm: [x, y], axes_deg}; null where nothing is tracked
//   warnings    [sentence, ...]
// rate is intervals per duration; a gap is an interval above 1.75 medians; a jump is a step above 1 mm and 5
// medians; pixel_mm and axes_deg only where a calibration leads to Image.
nlohmann::ordered_json summarise(const ReadSequence& read, const std::optional<PlusConfig>& config,
                                 const std::string& file);

}  // namespace sonoband::exchange
