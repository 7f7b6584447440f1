#include <algorithm>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/exam/exam_reader.h"
#include "app/exchange/exam_dicom.h"
#include "app/exchange/exam_sequence.h"
#include "app/exchange/markups.h"
#include "app/exchange/png.h"
#include "app/exchange/removable.h"
#include "app/exchange/sequence_file.h"
#include "app/exchange/stradwin.h"
#include "core/reslice/band.h"
#include "tools/exam_verbs.h"
#include "tools/export_movie.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

namespace fs = std::filesystem;

struct Options {
  std::string exam;
  fs::path folder;
  fs::path to;
  std::string format = "mha";
  std::int64_t sweep = 0;
  bool with_label = false;
  bool eject = false;
  std::shared_ptr<MovieOptions> movie;
};

void write_text(const fs::path& path, const std::string& text) {
  exchange::FileBeside file(path);
  file.stream() << text;
  file.commit();
}

void write_mask(const fs::path& path, ConstPixels mask) {
  Pixels shown(mask.width, mask.height);
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) shown.view()(x, y) = mask(x, y) != 0 ? 255 : 0;
  exchange::write_png(exchange::grey_png(shown.view()), path);
}

void write_pictures(const exchange::ExportedSweep& sweep, const fs::path& stem, const std::string& exam) {
  const exchange::TrackedSequence& s = sweep.sequence;
  WorkProgress progress("writing the pictures of " + exam);
  for (int i = 0; i < s.frame_count(); ++i) {
    if (!progress(static_cast<int>(1000LL * i / s.frame_count())))
      throw BadInput(exam + ": stopped after " + std::to_string(i) + " of " +
                     std::to_string(s.frame_count()) + " pictures; those are whole");
    BandImage image;
    image.pixels = Pixels(s.width, s.height);
    std::copy_n(s.frame_pixels(i).data(), s.frame_bytes(), image.pixels.view().data);
    image.kind = sweep.setup.kind;
    exchange::PngPicture picture = exchange::band_png(image);
    if (sweep.setup.probe_from_image) picture.pixel_mm = sweep.setup.probe_from_image->linear.col(0).norm();
    const std::string* time = exchange::find_field(s.frames[i].fields, "Timestamp");
    picture.texts = {
        {"Software", "Sonoband"},
        {"Source", exam + ", frame " + std::to_string(i)},
        {"Comment", "Research use only. Captured at " + (time == nullptr ? "?" : *time) + " s."}};
    char number[16];
    std::snprintf(number, sizeof number, "-%05d.png", i);
    exchange::write_png(picture, stem.string() + number);
  }
  std::printf("%s-*.png, %d pictures\n", stem.c_str(), s.frame_count());
}

void export_dicom(const Options& options, const exam::ExamReader& exam) {
  WorkProgress progress("exporting " + options.exam);
  const exchange::DicomExport made =
      exchange::dicom_from_exam(exam, options.sweep, options.with_label, options.to, std::ref(progress));
  for (const fs::path& file : made.files) std::printf("%s\n", file.c_str());
  if (made.files.empty()) throw BadInput(options.exam + ": there is nothing in it to export");
  if (!made.damage.empty())
    throw BadInput(options.exam + ": exported without what is damaged: " + made.damage.front());
}

// What review made: for Slicer, and every object in force with its JSON as it is.
void export_review(const Options& options, const exam::ExamReader& exam, const std::string& id) {
  std::vector<std::string> damage;
  const std::vector<exam::ReviewObject> objects = exam.review(damage);
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const exam::ReviewObject& o : objects)
    all.push_back({{"object", o.object},
                   {"kind", exam::name_of(o.kind)},
                   {"version", o.version},
                   {"holds", nlohmann::ordered_json::parse(o.json, nullptr, false)}});
  const auto write = [&](const fs::path& path, const std::string& text) {
    write_text(path, text);
    std::printf("%s\n", path.c_str());
  };
  write(options.to / (id + "-review.json"),
        nlohmann::ordered_json({{"exam", id}, {"review", all}})
                .dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) +
            "\n");
  if (const std::string markups = exchange::slicer_markups(objects); !markups.empty())
    write(options.to / (id + ".mrk.json"), markups);
  if (!damage.empty()) throw BadInput(options.exam + ": exported without what is damaged: " + damage.front());
}

void export_exam(const Options& options) {
  const fs::path file = find_exam(options.exam, options.folder);
  const exam::ExamReader exam(file);
  std::error_code error;
  fs::create_directories(options.to, error);
  if (error) throw BadInput(options.to.string() + ": cannot be made: " + error.message());
  if (options.format == "dicom") return export_dicom(options, exam);
  if (options.format == "review") return export_review(options, exam, file.stem().string());
  int written = 0;
  std::vector<std::string> damage;
  for (const exam::SweepSummary& summary : exam.sweeps()) {
    if (options.sweep != 0 && summary.id != options.sweep) continue;
    ++written;
    if (options.format == "webm") {
      const fs::path path = write_movie(*options.movie, exam, file, summary.id, options.to, damage);
      std::printf("%s\n", path.c_str());
      continue;
    }
    const std::string name = file.stem().string() + "-sweep" + std::to_string(summary.id);
    const exchange::ExportedSweep sweep = [&] {
      WorkProgress progress("exporting " + name);
      return exchange::sequence_from_exam(exam, summary.id, std::ref(progress));
    }();
    damage.insert(damage.end(), sweep.damage.begin(), sweep.damage.end());
    const fs::path stem = options.to / name;
    if (options.format == "png") {
      write_pictures(sweep, stem, name);
      continue;
    }
    const Interruptible interruptible;  // what is begun is finished
    if (options.format == "sx" || options.format == "sw") {
      const fs::path path = stem.string() + "." + options.format;
      const int left_out = exchange::write_strad(sweep.sequence, sweep.setup.world,
                                                 sweep.setup.kind == PixelKind::doppler, path);
      if (left_out > 0)
        std::fprintf(stderr, "warning: %d frames without a place in space are left out\n", left_out);
      std::printf("%s\n", path.c_str());
    } else {
      const fs::path path = stem.string() + ".igs." + options.format;
      if (const std::string xml = exchange::plus_config_xml(sweep.setup); !xml.empty())
        write_text(stem.string() + ".xml", xml);
      if (sweep.setup.mask.width() > 0) write_mask(stem.string() + "-mask.png", sweep.setup.mask.view());
      exchange::write_sequence(sweep.sequence, path);
      std::printf("%s\n", path.c_str());
    }
    if (interruptible.asked_to_stop())
      throw BadInput(name + ": stopped here; the files that are there are whole");
  }
  if (written == 0)
    throw BadInput(file.filename().string() + ": there is no sweep " + std::to_string(options.sweep) +
                   " in it");
  if (!damage.empty())
    throw BadInput(file.filename().string() + ": exported without what is damaged: " + damage.front() +
                   (damage.size() > 1 ? " (and " + std::to_string(damage.size() - 1) + " more places)" : ""));
}

void eject(const Options& options) {
  const std::string trouble = [&] {
    sonoband::tools::Progress progress("writing out to " + options.to.string());
    progress.show(0, 1);
    return exchange::release(options.to);
  }();
  if (!trouble.empty()) throw BadInput(trouble);
  std::printf("everything is written and unmounted: it can be pulled\n");
}

}  // namespace

void add_export(CLI::App& tool) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = tool.add_subcommand(
      "export",
      "Write the sweeps of an exam as files: sequences with calibration (.xml) and mask (-mask.png)");
  verb->add_option("EXAM", options->exam, "An exam's file, or its id")->required();
  verb->add_option("--exams", options->folder, "Folder in which an id is looked for")
      ->default_val(exam::default_exam_folder());
  verb->add_option("--to", options->to, "Folder to write into")->required();
  verb->add_option(
          "--format", options->format,
          "mha, mhd, nrrd, nhdr, sx (Stradx), sw (Stradwin), dicom, png: one picture a frame, "
          "webm: a movie, or review: landmarks, contours and the like as JSON and for Slicer (.mrk.json)")
      ->check(CLI::IsMember({"mha", "mhd", "nrrd", "nhdr", "sx", "sw", "dicom", "png", "webm", "review"}))
      ->capture_default_str();
  verb->add_option("--sweep", options->sweep, "Only this one, from 1 (default: all)")
      ->check(CLI::PositiveNumber);
  verb->add_flag("--with-label", options->with_label, "DICOM: write the patient's label as name and id");
  verb->add_flag("--eject", options->eject, "Then write out and unmount the stick or card that --to lies on");
  options->movie = add_movie_options(*verb);
  verb->callback([options] {
    if (options->movie->turn_table && options->format != "webm")
      throw CLI::ValidationError("--turn-table", "a turn-table is a movie: add --format webm");
    check_movie_options(*options->movie);
    on_exams([&] { export_exam(*options); });
    if (options->eject) eject(*options);
  });
}

}  // namespace sonoband::tools
