#include "app/exchange/exam_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/bad_input.h"
#include "app/exam/exam_reader.h"
#include "app/exchange/exam_dicom.h"
#include "app/exchange/exam_movie.h"
#include "app/exchange/exam_sequence.h"
#include "app/exchange/exam_turn.h"
#include "app/exchange/file_beside.h"
#include "app/exchange/markups.h"
#include "app/exchange/png.h"
#include "app/exchange/sequence_file.h"
#include "app/exchange/stradwin.h"
#include "app/workers.h"

namespace sonoband::exchange {
namespace {

namespace fs = std::filesystem;

void write_text(const fs::path& path, const std::string& text) {
  FileBeside file(path);
  file.stream() << text;
  file.commit();
}

void write_mask(const fs::path& path, ConstPixels mask) {
  Pixels shown(mask.width, mask.height);
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) shown.view()(x, y) = mask(x, y) != 0 ? 255 : 0;
  write_png(grey_png(shown.view()), path);
}

void write_pictures(const ExportedSweep& sweep, const fs::path& stem, const std::string& name,
                    const Progress& progress, ExportedExam& out) {
  const TrackedSequence& s = sweep.sequence;
  for (int i = 0; i < s.frame_count(); ++i) {
    if (progress && !progress(static_cast<int>(1000LL * i / s.frame_count())))
      throw BadInput(
          fmt::format("{}: stopped after {} of {} pictures; those are whole", name, i, s.frame_count()));
    PngPicture picture =
        picture_png({s.frame_pixels(i).data(), s.width, s.height, s.width}, sweep.setup.kind);
    if (sweep.setup.probe_from_image) picture.pixel_mm = sweep.setup.probe_from_image->linear.col(0).norm();
    const std::string* time = find_field(s.frames[i].fields, "Timestamp");
    picture.texts = {
        {"Software", "Sonoband"},
        {"Source", name + ", frame " + std::to_string(i)},
        {"Comment", "Research use only. Captured at " + (time == nullptr ? "?" : *time) + " s."}};
    out.files.emplace_back(fmt::format("{}-{:05}.png", stem.string(), i));
    write_png(picture, out.files.back());
  }
}

// For Slicer, and every object in force with its JSON as it is.
void write_review(const exam::ExamReader& exam, const std::string& id, const fs::path& to,
                  ExportedExam& out) {
  using Json = nlohmann::ordered_json;
  const std::vector<exam::ReviewObject> objects = exam.review(out.damage);
  Json all = Json::array();
  for (const exam::ReviewObject& o : objects)
    all.push_back({{"object", o.object},
                   {"kind", exam::name_of(o.kind)},
                   {"version", o.version},
                   {"holds", Json::parse(o.json, nullptr, false)}});
  out.files.push_back(to / (id + "-review.json"));
  write_text(
      out.files.back(),
      Json({{"exam", id}, {"review", all}}).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  if (const std::string markups = slicer_markups(objects); !markups.empty()) {
    out.files.push_back(to / (id + ".mrk.json"));
    write_text(out.files.back(), markups);
  }
}

const char* extension_of(ExportFormat format) {
  switch (format) {
    case ExportFormat::mhd:
      return ".mhd";
    case ExportFormat::nrrd:
      return ".nrrd";
    case ExportFormat::nhdr:
      return ".nhdr";
    case ExportFormat::sx:
      return ".sx";
    case ExportFormat::sw:
      return ".sw";
    default:
      return ".mha";
  }
}

void write_sweep(const ExportedSweep& sweep, const ExamExport& what, const std::string& name,
                 const Progress& progress, ExportedExam& out) {
  const fs::path stem = what.to / name;
  switch (what.format) {
    case ExportFormat::png:
      return write_pictures(sweep, stem, name, progress, out);
    case ExportFormat::webm:
      out.files.emplace_back(stem.string() + ".webm");
      return write_cine(sweep, name, out.files.back(), what.threads, progress);
    case ExportFormat::sx:
    case ExportFormat::sw: {
      out.files.emplace_back(stem.string() + extension_of(what.format));
      const int left_out = write_strad(sweep.sequence, sweep.setup.world,
                                       sweep.setup.kind == PixelKind::doppler, out.files.back(), progress);
      if (left_out > 0)
        out.warnings.push_back(
            fmt::format("{}: {} frames without a place in space are left out", name, left_out));
      return;
    }
    default:
      break;
  }
  out.files.emplace_back(stem.string() + ".igs" + extension_of(what.format));
  const std::size_t own = out.files.size() - 1;
  if (const std::string xml = plus_config_xml(sweep.setup); !xml.empty()) {
    out.files.emplace_back(stem.string() + ".xml");
    write_text(out.files.back(), xml);
  }
  if (sweep.setup.mask.width() > 0) {
    out.files.emplace_back(stem.string() + "-mask.png");
    write_mask(out.files.back(), sweep.setup.mask.view());
  }
  write_sequence(sweep.sequence, out.files[own], progress);
}

void write_turn(const fs::path& exam, const exam::SweepSummary& sweep, const ExamExport& what,
                const std::string& name, const Progress& progress, ExportedExam& out) {
  const fs::path path = what.to / (name + "-turn.webm");
  Workers workers(what.threads);
  const auto turn = [&](const SweepView& view) { return whole_turn(view, what.band); };
  write_stored_turn({exam, sweep.id, name, turn}, path, workers, progress, out.damage);
  out.files.push_back(path);
}

// What the kernel would give without taking it from other programs; most there is where it does not say.
std::uint64_t available_memory() {
  std::ifstream in("/proc/meminfo");
  std::string name;
  std::uint64_t kib = 0;
  while (in >> name >> kib) {
    if (name == "MemAvailable:") return kib * 1024;
    in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return std::numeric_limits<std::uint64_t>::max();
}

// Beside a cart that records, running out of memory would end the recording.
void check_memory(const exam::ExamReader& exam, const exam::SweepSummary& sweep, ExportFormat format,
                  const std::string& name) {
  const exam::SweepSetup setup = exam.setup(sweep.id);
  // DICOM's library makes a copy; colours take three bytes for each of ours.
  const std::uint64_t copies = format != ExportFormat::dicom ? 1 : (setup.kind == PixelKind::doppler ? 7 : 2);
  const std::uint64_t bytes = copies * static_cast<std::uint64_t>(sweep.frames) *
                              static_cast<std::uint64_t>(setup.width) *
                              static_cast<std::uint64_t>(setup.height);
  const std::uint64_t there = available_memory();
  if (bytes > there / 10 * 9)
    throw BadInput(fmt::format(
        "{}: exporting it takes {:.1f} GB of memory and {:.1f} GB are left; export it when the cart has been "
        "restarted, or by sonoband-tool on another machine",
        name, static_cast<double>(bytes) / 1e9, static_cast<double>(there) / 1e9));
}

}  // namespace

ExportedExam export_exam(const fs::path& file, const ExamExport& what, const Progress& progress) {
  const exam::ExamReader exam(file);
  const std::string id = file.stem().string();
  std::error_code error;
  fs::create_directories(what.to, error);
  if (error) throw BadInput(why_unwritable(what.to, error.value()));
  ExportedExam out;
  if (what.format == ExportFormat::review) {
    write_review(exam, id, what.to, out);
    return out;
  }
  std::vector<exam::SweepSummary> sweeps = exam.sweeps();
  if (what.sweep != 0) std::erase_if(sweeps, [&](const exam::SweepSummary& s) { return s.id != what.sweep; });
  if (sweeps.empty())
    throw BadInput(file.filename().string() + ": there is no sweep " +
                   (what.sweep != 0 ? std::to_string(what.sweep) + " " : "") + "in it");
  const auto name_of = [&](const exam::SweepSummary& s) { return id + "-sweep" + std::to_string(s.id); };
  for (const exam::SweepSummary& s : sweeps) {
    check_memory(exam, s, what.format, name_of(s));
    if (!s.ended)
      out.warnings.push_back(name_of(s) +
                             ": it is still being recorded; what comes later is not in the files");
  }
  if (what.format == ExportFormat::dicom) {
    DicomExport made = dicom_from_exam(exam, what.sweep, what.with_label, what.to, progress);
    out.files = std::move(made.files);
    out.damage = std::move(made.damage);
    if (out.files.empty()) throw BadInput(file.filename().string() + ": there is nothing in it to export");
    return out;
  }
  if (what.format == ExportFormat::turn) {
    const auto all = static_cast<int>(sweeps.size());
    for (int i = 0; i < all; ++i)
      write_turn(file, sweeps[i], what, name_of(sweeps[i]), part_of(progress, i, all), out);
    return out;
  }
  // Each sweep is read, then written.
  const auto parts = static_cast<int>(2 * sweeps.size());
  int part = 0;
  for (const exam::SweepSummary& s : sweeps) {
    const Progress reading = part_of(progress, part++, parts);
    const Progress writing = part_of(progress, part++, parts);
    const ExportedSweep sweep = sequence_from_exam(exam, s.id, reading);
    out.damage.insert(out.damage.end(), sweep.damage.begin(), sweep.damage.end());
    write_sweep(sweep, what, name_of(s), writing, out);
  }
  return out;
}

}  // namespace sonoband::exchange
