// Sequences by path: read by content, written by extension.
#pragma once

#include <filesystem>

#include "app/exchange/progress.h"
#include "app/exchange/sequence.h"

namespace sonoband::exchange {

// MetaImage or NRRD, told by the first line whatever the file is called. Throws BadInput.
ReadSequence read_sequence(const std::filesystem::path& path);
ReadSequence read_sequence(const std::filesystem::path& path, const SequenceLimits& limits);

// .mha, .mhd (pixels in .raw or .zraw beside), .nrrd, .nhdr (pixels in .raw or .raw.gz beside). Throws
// BadInput where the extension is another, the disk refuses or `progress` stops it; then the old file, if
// any, is still there.
void write_sequence(const TrackedSequence& sequence, const std::filesystem::path& path,
                    const Progress& progress = {});

}  // namespace sonoband::exchange
