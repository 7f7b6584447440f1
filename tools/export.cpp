#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "app/exchange/exam_export.h"
#include "app/exchange/removable.h"
#include "tools/exam_verbs.h"
#include "tools/export_movie.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

namespace fs = std::filesystem;
using exchange::ExportFormat;

constexpr std::array<std::pair<const char*, ExportFormat>, 10> formats = {{{"mha", ExportFormat::mha},
                                                                           {"mhd", ExportFormat::mhd},
                                                                           {"nrrd", ExportFormat::nrrd},
                                                                           {"nhdr", ExportFormat::nhdr},
                                                                           {"sx", ExportFormat::sx},
                                                                           {"sw", ExportFormat::sw},
                                                                           {"dicom", ExportFormat::dicom},
                                                                           {"png", ExportFormat::png},
                                                                           {"webm", ExportFormat::webm},
                                                                           {"review", ExportFormat::review}}};

struct Options {
  std::string exam;
  fs::path folder;
  std::string format = "mha";
  exchange::ExamExport what;
  bool eject = false;
  std::shared_ptr<MovieOptions> movie;
};

std::vector<std::string> names_of_formats() {
  std::vector<std::string> names;
  for (const auto& [name, format] : formats) names.emplace_back(name);
  return names;
}

ExportFormat format_of(const std::string& name) {
  const auto* found =
      std::find_if(formats.begin(), formats.end(), [&](const auto& f) { return name == f.first; });
  return found->second;
}

void export_exam(const Options& options) {
  const fs::path file = find_exam(options.exam, options.folder);
  exchange::ExportedExam made;
  if (options.movie->turn_table) {
    made = write_turns(*options.movie, file, options.what);
  } else {
    exchange::ExamExport what = options.what;
    what.format = format_of(options.format);
    what.threads = threads_of(*options.movie->render);
    WorkProgress progress("exporting " + file.stem().string());
    made = exchange::export_exam(file, what, std::ref(progress));
  }
  for (const std::string& w : made.warnings) std::fprintf(stderr, "warning: %s\n", w.c_str());
  if (options.format == "png") {
    std::printf("%s, %zu pictures\n", (options.what.to / (file.stem().string() + "-*.png")).c_str(),
                made.files.size());
  } else {
    for (const fs::path& f : made.files) std::printf("%s\n", f.c_str());
  }
  if (!made.damage.empty())
    throw BadInput(
        file.filename().string() + ": exported without what is damaged: " + made.damage.front() +
        (made.damage.size() > 1 ? " (and " + std::to_string(made.damage.size() - 1) + " more places)" : ""));
}

void eject(const Options& options) {
  const std::string trouble = [&] {
    sonoband::tools::Progress progress("writing out to " + options.what.to.string());
    progress.show(0, 1);
    return exchange::release(options.what.to);
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
  verb->add_option("--to", options->what.to, "Folder to write into")->required();
  verb->add_option(
          "--format", options->format,
          "mha, mhd, nrrd, nhdr, sx (Stradx), sw (Stradwin), dicom, png: one picture a frame, "
          "webm: a movie, or review: landmarks, contours and the like as JSON and for Slicer (.mrk.json)")
      ->check(CLI::IsMember(names_of_formats()))
      ->capture_default_str();
  verb->add_option("--sweep", options->what.sweep, "Only this one, from 1 (default: all)")
      ->check(CLI::PositiveNumber);
  verb->add_flag("--with-label", options->what.with_label, "DICOM: write the patient's label as name and id");
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
