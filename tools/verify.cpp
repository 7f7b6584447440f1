#include <memory>

#include "app/exam/exam_reader.h"
#include "app/exam/journal.h"
#include "tools/exam_verbs.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

struct Options {
  std::string exam;
  std::filesystem::path folder;
};

void verify(const Options& options) {
  const std::filesystem::path file = find_exam(options.exam, options.folder);
  const exam::JournalState journal = exam::journal_state(file);  // before SQLite completes it
  bool stopped = false;
  const exam::ExamReader::Verification v = [&] {
    WorkProgress progress("verifying");
    return exam::ExamReader(file).verify([&](int permille) { return !(stopped = !progress(permille)); });
  }();
  if (stopped) throw BadInput(file.filename().string() + ": stopped before the end; nothing is known yet");
  std::printf("%lld sweeps, %lld frames, %lld raw readings, %lld review objects read\n",
              static_cast<long long>(v.sweeps), static_cast<long long>(v.frames),
              static_cast<long long>(v.poses), static_cast<long long>(v.reviews));
  std::vector<std::string> damage = v.damage;
  if (journal.damaged) damage.push_back("its journal is damaged; what came behind the damage is lost");
  for (const std::string& d : damage) std::printf("damaged: %s\n", d.c_str());
  if (!damage.empty())
    throw BadInput(file.filename().string() + ": " + damage.front() +
                   (damage.size() > 1 ? " (and " + std::to_string(damage.size() - 1) + " more places)" : "") +
                   "; export what is left, and check the disk");
}

}  // namespace

void add_verify(CLI::App& tool) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = tool.add_subcommand("verify", "Read every byte of an exam against its checksums");
  verb->add_option("EXAM", options->exam, "An exam's file, or its id")->required();
  verb->add_option("--exams", options->folder, "Folder in which an id is looked for")
      ->default_val(exam::default_exam_folder());
  verb->callback([options] { on_exams([&] { verify(*options); }); });
}

}  // namespace sonoband::tools
