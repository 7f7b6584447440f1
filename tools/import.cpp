#include <functional>
#include <memory>

#include "app/exchange/exam_sequence.h"
#include "app/exchange/png.h"
#include "app/exchange/sequence_file.h"
#include "app/exchange/stradwin.h"
#include "tools/exam_verbs.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

namespace fs = std::filesystem;

struct Options {
  fs::path file;
  fs::path into;
  std::vector<fs::path> config;
};

// NAME-mask.png beside NAME.igs.mha, as `export` writes it.
Pixels mask_beside(const fs::path& file) {
  const std::string name = file.filename().string();
  const fs::path path = file.parent_path() / (name.substr(0, name.find('.')) + "-mask.png");
  if (!fs::exists(path)) return {};
  const exchange::PngPicture picture = exchange::read_png(path);
  if (picture.channels != 1)
    throw BadInput(path.string() + ": a mask is a grey picture; this one has colours");
  Pixels mask(picture.width, picture.height);
  for (std::size_t i = 0; i < picture.bytes.size(); ++i) mask.view().data[i] = picture.bytes[i] != 0 ? 1 : 0;
  return mask;
}

// Whatever happens, no half exam stays behind.
struct RemoveUnfinished {
  fs::path file;
  ~RemoveUnfinished() {
    std::error_code none;
    for (const char* end : {"", "-wal", "-shm"}) fs::remove(file.string() + end, none);
  }
};

void import_file(const Options& options) {
  exchange::ReadSequence read = exchange::is_strad(options.file) ? exchange::read_strad(options.file)
                                                                 : exchange::read_sequence(options.file);
  const exchange::PlusConfig config = exchange::read_plus_configs(options.config);
  std::error_code error;
  if (!fs::exists(options.into)) {
    fs::create_directories(options.into, error);
    if (!error) fs::permissions(options.into, fs::perms::owner_all, error);
    if (error) throw BadInput(options.into.string() + ": cannot be made: " + error.message());
  }
  const exam::ExamFolder folder(options.into, exam::ExamFolder::Use::look);
  const exam::ExamFolder::NewExam made = folder.new_exam();
  const RemoveUnfinished unfinished{made.file.string() + ".importing"};
  {
    exam::ExamWriter writer = exam::ExamWriter::create(unfinished.file, made.id);
    WorkProgress progress("importing");
    const std::vector<std::string> said =
        exchange::sequence_into_exam(std::move(read), config, mask_beside(options.file),
                                     options.file.string(), writer, std::ref(progress));
    for (const std::string& s : said) std::fprintf(stderr, "warning: %s\n", s.c_str());
    writer.add_event("imported", options.file.filename().string());
    writer.close();
  }
  fs::rename(unfinished.file, made.file, error);
  if (error) throw BadInput(made.file.string() + ": cannot be written: " + error.message());
  std::printf("%s\n", made.file.c_str());
}

}  // namespace

void add_import(CLI::App& tool) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = tool.add_subcommand("import", "Make an exam of a tracked sequence");
  verb->add_option("FILE", options->file, "MetaImage or NRRD sequence, Stradx .sx or Stradwin .sw")
      ->required();
  verb->add_option("--into", options->into, "Folder of exams")->required();
  verb->add_option("--calibration", options->config,
                   "PLUS configuration with ImageToProbe, clip and fan; may be repeated");
  verb->callback([options] { on_exams([&] { import_file(*options); }); });
}

}  // namespace sonoband::tools
