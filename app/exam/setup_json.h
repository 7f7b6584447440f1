// SweepSetup and counters as the JSON text of a row. Doubles come back bit for bit.
#pragma once

#include <string>
#include <vector>

#include "app/exam/records.h"

namespace sonoband::exam {

std::string to_json(const SweepSetup& setup);  // without the mask
// Throws std::exception (of the JSON library) when the text is not such an object.
SweepSetup setup_from_json(const std::string& text);

std::string to_json(const std::vector<Counter>& counters);
std::vector<Counter> counters_from_json(const std::string& text);

}  // namespace sonoband::exam
