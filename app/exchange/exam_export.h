// An exam as files in a folder: what the tool's `export` and the screen's Export write.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/exchange/progress.h"
#include "core/reslice/band.h"

namespace sonoband::exchange {

enum class ExportFormat : std::uint8_t {
  mha,  // this and the next three with the calibration (.xml) and the mask (-mask.png) beside
  mhd,
  nrrd,
  nhdr,
  sx,      // Stradx
  sw,      // Stradwin
  dicom,   // snapshots as well
  png,     // one picture a frame
  webm,    // the B-scans as a movie
  turn,    // the band on a plane that turns once, as a movie
  review,  // what review made: JSON, and for Slicer (.mrk.json)
};

struct ExamExport {
  std::filesystem::path to;  // made if it is not there
  ExportFormat format = ExportFormat::mha;
  std::int64_t sweep = 0;   // 0: all
  bool with_label = false;  // the patient's, in DICOM; no other format has it
  int threads = 1;          // of the movie's encoder, and of what paints a band
  RenderSettings band;      // of a turn; its layers are a B-scan's pixel apart whatever is said here
};

struct ExportedExam {
  std::vector<std::filesystem::path> files;  // in the order written; of a sequence its own file comes first
  std::vector<std::string> damage;           // what is left out because it cannot be read, a sentence each
  std::vector<std::string> warnings;         // what else people should know, a sentence each
};

// Each file is written beside and then renamed: one that is there is whole, also after a stop or a failure.
// What is read of a sweep is held in memory: some 0.3 MB a frame. Throws exam::StoreError, BadInput.
ExportedExam export_exam(const std::filesystem::path& exam, const ExamExport& what,
                         const Progress& progress = {});

}  // namespace sonoband::exchange
