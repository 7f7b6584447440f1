// MetaImage sequences (.mha, .mhd with .raw or .zraw) as PLUS and 3D Slicer write them.
#pragma once

#include <filesystem>
#include <functional>
#include <istream>
#include <memory>
#include <string>

#include "app/exchange/sequence.h"

namespace sonoband::exchange {

// Opens the file of that name in the header's own folder; null where there is none.
using OpenBeside = std::function<std::unique_ptr<std::istream>(const std::string& name)>;

// The first line names a field ObjectType.
bool is_metaimage(std::string_view first_line);

// `file` names the input in every sentence. Throws BadInput.
ReadSequence read_metaimage(std::istream& in, const std::string& file, const SequenceLimits& limits,
                            const OpenBeside& open_beside);

// The payload goes to `data` under the name `data_name`; with an empty name into `out` itself (LOCAL).
void write_metaimage(const TrackedSequence& sequence, std::ostream& out, const std::string& file,
                     std::ostream& data, const std::string& data_name);

}  // namespace sonoband::exchange
