// An exam as DICOM objects: each sweep as an Ultrasound Multi-frame, each snapshot as a Secondary Capture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/exchange/dicom.h"
#include "app/exchange/exam_sequence.h"

namespace sonoband::exchange {

struct DicomExport {
  std::vector<std::filesystem::path> files;  // in the order written
  std::vector<std::string> damage;           // what is left out, one sentence each
};

// Writes into `folder` (which exists) as ID-sweepN.dcm and ID-snapshotN.dcm; sweep 0: all. The patient's
// label goes along only when asked for. Throws exam::StoreError, BadInput.
DicomExport dicom_from_exam(const exam::ExamReader& exam, std::int64_t sweep, bool with_label,
                            const std::filesystem::path& folder, const Progress& progress = {});

}  // namespace sonoband::exchange
