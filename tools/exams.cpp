#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/exam_verbs.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

struct Options {
  std::filesystem::path folder;
  bool json = false;
};

void exams(const Options& options) {
  const exam::ExamFolder folder(options.folder, exam::ExamFolder::Use::look);
  const std::vector<exam::ExamSummary> all = folder.list();
  if (options.json) {
    nlohmann::json list = nlohmann::json::array();
    for (const exam::ExamSummary& e : all)
      list.push_back({{"id", e.id},
                      {"path", e.path},
                      {"frames", e.frames},
                      {"sweeps", e.sweeps},
                      {"bytes", e.bytes},
                      {"created_utc_ns", e.created_utc_ns},
                      {"closed", e.closed},
                      {"damage", e.damage}});
    std::printf("%s\n", nlohmann::json({{"exams", list}}).dump(2).c_str());
    return;
  }
  for (const exam::ExamSummary& e : all) {
    std::printf("%s  %lld sweeps  %lld frames  %.1f MB%s%s\n", e.id.c_str(), static_cast<long long>(e.sweeps),
                static_cast<long long>(e.frames), static_cast<double>(e.bytes) / 1e6,
                e.closed || !e.damage.empty() ? "" : "  (open, or cut off)",
                e.damage.empty() ? "" : ("  DAMAGED: " + e.damage).c_str());
  }
  if (all.empty()) std::printf("no exams in %s\n", options.folder.c_str());
}

}  // namespace

void add_exams(CLI::App& tool) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = tool.add_subcommand("exams", "List the exams of a folder, newest first");
  verb->add_option("DIR", options->folder, "Folder of exams")->default_val(exam::default_exam_folder());
  verb->add_flag("--json", options->json, "As {\"exams\":[{\"id\", \"path\", \"frames\", ...}]}");
  verb->callback([options] { on_exams([&] { exams(*options); }); });
}

}  // namespace sonoband::tools
