#include "app/exchange/exam_dicom.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "app/bad_input.h"

namespace sonoband::exchange {
namespace {

// The equipment as the sweep names it; the board, if it is named.
std::string equipment(const exam::SweepSetup& setup) {
  for (const auto& [device, version] : setup.versions)
    if (device == "board") return version;
  return {};
}

}  // namespace

DicomExport dicom_from_exam(const exam::ExamReader& exam, std::int64_t sweep, bool with_label,
                            const std::filesystem::path& folder, const Progress& progress) {
  DicomExport out;
  const exam::ExamSummary summary = exam.summary();
  DicomStudy study;
  study.exam_id = summary.id;
  study.created_utc_ns = summary.created_utc_ns;
  if (with_label) study.label = summary.label;
  std::vector<exam::SweepSummary> sweeps = exam.sweeps();
  std::erase_if(sweeps,
                [&](const exam::SweepSummary& s) { return s.frames == 0 || (sweep != 0 && s.id != sweep); });
  // Each is read, then written.
  const auto parts = static_cast<int>(2 * sweeps.size());
  int part = 0;
  for (const exam::SweepSummary& s : sweeps) {
    const Progress reading = part_of(progress, part++, parts);
    const Progress writing = part_of(progress, part++, parts);
    const ExportedSweep exported = sequence_from_exam(exam, s.id, reading);
    out.damage.insert(out.damage.end(), exported.damage.begin(), exported.damage.end());
    const TrackedSequence& sequence = exported.sequence;
    if (sequence.frames.empty()) continue;
    DicomCine cine;
    cine.object = fmt::format("sweep {}", s.id);
    cine.number = static_cast<int>(s.id);
    cine.description = fmt::format("Sweep {}, freehand", s.id);
    // An imported sweep may not know when it was recorded.
    cine.utc_ns = exported.setup.pressed_utc_ns != 0 ? exported.setup.pressed_utc_ns : study.created_utc_ns;
    cine.width = sequence.width;
    cine.height = sequence.height;
    cine.kind = exported.setup.kind;
    cine.pixels = sequence.pixels.bytes();
    for (const SequenceFrame& f : sequence.frames) cine.times_s.push_back(timestamp_s(f).value_or(0));
    if (exported.setup.probe_from_image) {
      cine.x_mm = exported.setup.probe_from_image->linear.col(0).norm();
      cine.y_mm = exported.setup.probe_from_image->linear.col(1).norm();
    }
    cine.mask = exported.setup.mask.view();
    study.equipment = equipment(exported.setup);
    out.files.push_back(folder / fmt::format("{}-sweep{}.dcm", study.exam_id, s.id));
    write_dicom(study, cine, out.files.back(), writing);
  }
  if (sweep != 0) return out;
  int number = 0;
  for (const exam::ReviewObject& o : exam.review(out.damage)) {
    if (o.kind != exam::ReviewKind::snapshot || o.png.empty()) continue;
    DicomPicture p;
    p.object = "snapshot " + o.object;
    p.number = ++number;
    p.description = "Snapshots";
    p.derivation = "Sonoband snapshot, research use only: " + o.json;
    p.utc_ns = o.written_utc_ns != 0 ? o.written_utc_ns : study.created_utc_ns;
    std::istringstream png(std::string(o.png.begin(), o.png.end()));
    p.picture = read_png(png, p.object);
    out.files.push_back(folder / fmt::format("{}-snapshot{}.dcm", study.exam_id, number));
    write_dicom(study, p, out.files.back());
  }
  return out;
}

}  // namespace sonoband::exchange
