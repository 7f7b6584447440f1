// Eight-bit grey from whatever a recording holds.
#pragma once

#include <string>
#include <vector>

#include "app/exchange/sequence.h"

namespace sonoband::exchange {

// In place, so that a large recording is never held twice. See sweep_from_sequence for the rule. `file` names
// the recording in warnings. Throws BadInput where samples are not finite.
void make_grey(TrackedSequence& sequence, const std::string& file, std::vector<std::string>& warnings);

}  // namespace sonoband::exchange
