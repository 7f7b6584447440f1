#include "app/exchange/sequence_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "app/bad_input.h"
#include "app/exchange/file_beside.h"
#include "app/exchange/metaimage.h"
#include "app/exchange/nrrd.h"
#include "app/exchange/text.h"

namespace sonoband::exchange {

namespace {

std::string cause() {
  return std::generic_category().message(errno);
}

}  // namespace

ReadSequence read_sequence(const std::filesystem::path& path) {
  return read_sequence(path, default_limits());
}

ReadSequence read_sequence(const std::filesystem::path& path, const SequenceLimits& limits) {
  const std::string file = path.string();
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw BadInput(fmt::format("{}: this is a folder; name a sequence file.", file));
  std::ifstream in(path, std::ios::binary);
  if (!in) throw BadInput(fmt::format("{}: cannot be opened ({}); check the name.", file, cause()));
  std::string line;
  read_line(in, line, 200);
  in.clear();
  in.seekg(0);
  const OpenBeside open_beside = [&](const std::string& name) -> std::unique_ptr<std::istream> {
    auto data = std::make_unique<std::ifstream>(path.parent_path() / name, std::ios::binary);
    return *data ? std::move(data) : nullptr;
  };
  if (is_metaimage(line)) return read_metaimage(in, file, limits, open_beside);
  if (is_nrrd(line)) return read_nrrd(in, file, limits, open_beside);
  if (line.starts_with("\x1A\x45\xDF\xA3"))
    throw BadInput(fmt::format("{}: Matroska video is not read; convert it to .mha with PLUS first.", file));
  throw BadInput(
      fmt::format("{}: neither a MetaImage (first line 'ObjectType = Image') nor an NRRD (NRRD0004); name a "
                  ".mha, .mhd or "
                  ".nrrd sequence.",
                  file));
}

void write_sequence(const TrackedSequence& sequence, const std::filesystem::path& path,
                    const Progress& progress) {
  const std::string extension = path.extension().string();
  const bool meta = same_name(extension, ".mha") || same_name(extension, ".mhd");
  if (!meta && !same_name(extension, ".nrrd") && !same_name(extension, ".nhdr"))
    throw BadInput(fmt::format("{}: the extension '{}' is not written; use .mha, .mhd, .nrrd or .nhdr.",
                               path.string(), extension));
  const auto write = meta ? write_metaimage : write_nrrd;
  const bool packed = sequence.compressed && !sequence.pixels.bytes().empty();
  // Packed it may be anything from a thousandth to all of it.
  const std::uint64_t bytes = packed ? 0 : sequence.pixels.bytes().size();
  if (same_name(extension, ".mha") || same_name(extension, ".nrrd")) {
    FileBeside file(path, progress, bytes);
    write(sequence, file.stream(), path.string(), file.stream(), "");
    file.commit();
    return;
  }
  std::filesystem::path data_path = path;
  data_path.replace_extension(!packed ? ".raw" : meta ? ".zraw" : ".raw.gz");
  FileBeside header(path);
  FileBeside data(data_path, progress, bytes);
  write(sequence, header.stream(), path.string(), data.stream(), data_path.filename().string());
  data.commit();
  header.commit();
}

}  // namespace sonoband::exchange
