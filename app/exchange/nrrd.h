// NRRD sequences (.nrrd, .nhdr with a data file) as PLUS writes them: version 4, raw or gzip.
#pragma once

#include <istream>
#include <string>

#include "app/exchange/metaimage.h"
#include "app/exchange/sequence.h"

namespace sonoband::exchange {

bool is_nrrd(std::string_view first_line);

// `file` names the input in every sentence. Throws BadInput.
ReadSequence read_nrrd(std::istream& in, const std::string& file, const SequenceLimits& limits,
                       const OpenBeside& open_beside);

// As write_metaimage. NRRD has no empty pictures: 0 x 0 becomes 1 x 1 with one dummy byte, as PLUS does.
void write_nrrd(const TrackedSequence& sequence, std::ostream& out, const std::string& file,
                std::ostream& data, const std::string& data_name);

}  // namespace sonoband::exchange
