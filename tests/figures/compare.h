// Whether the figures that the READMEs show are those that are painted now.
#pragma once

#include <string>
#include <vector>

namespace sonoband::figures {

// One sentence for each figure of `painted` that is missing in `kept` or is another picture there: another
// size, or in more than a thousandth of its bytes more than two levels away (another instruction set may
// choose otherwise at half-pixel ties). Drawings are the same text. Empty: all are current.
std::vector<std::string> outdated(const std::string& painted, const std::string& kept);

}  // namespace sonoband::figures
