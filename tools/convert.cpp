#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/exchange/sequence_file.h"
#include "tools/sweep_options.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

struct Options {
  std::filesystem::path in;
  std::filesystem::path out;
  bool compress = false;
  bool no_compress = false;
};

void convert(const Options& options) {
  exchange::ReadSequence read = [&] {
    Progress progress("reading");
    progress.show(0, 1);
    return exchange::read_sequence(options.in);
  }();
  for (const std::string& warning : read.warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
  if (options.compress) read.sequence.compressed = true;
  if (options.no_compress) read.sequence.compressed = false;
  Progress progress("writing");
  progress.show(0, 1);
  exchange::write_sequence(read.sequence, options.out);
}

}  // namespace

void add_convert(CLI::App& tool) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = tool.add_subcommand(
      "convert", "Write a sequence in another format (.mha, .mhd, .nrrd, .nhdr), turned to MF orientation");
  verb->add_option("IN", options->in, "Sequence to read: MetaImage or NRRD, told by its content")->required();
  verb->add_option("OUT", options->out, "File to write; its extension says the format")->required();
  CLI::Option* compress =
      verb->add_flag("--compress", options->compress, "Pack the pixels with zlib or gzip");
  verb->add_flag("--no-compress", options->no_compress, "Leave the pixels unpacked (default: as IN has them)")
      ->excludes(compress);
  verb->callback([options] { convert(*options); });
}

}  // namespace sonoband::tools
