#include "app/exchange/sequence_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "app/bad_input.h"
#include "app/exchange/metaimage.h"
#include "app/exchange/nrrd.h"
#include "app/exchange/text.h"

namespace sonoband::exchange {

namespace {

std::string of_descriptor(int descriptor) {
  return fmt::format("/proc/self/fd/{}", descriptor);
}

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

void write_sequence(const TrackedSequence& sequence, const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  const bool meta = same_name(extension, ".mha") || same_name(extension, ".mhd");
  if (!meta && !same_name(extension, ".nrrd") && !same_name(extension, ".nhdr"))
    throw BadInput(fmt::format("{}: the extension '{}' is not written; use .mha, .mhd, .nrrd or .nhdr.",
                               path.string(), extension));
  const auto write = meta ? write_metaimage : write_nrrd;
  FileBeside header(path);
  if (same_name(extension, ".mha") || same_name(extension, ".nrrd")) {
    write(sequence, header.stream(), path.string(), header.stream(), "");
    header.commit();
    return;
  }
  std::filesystem::path data_path = path;
  const bool packed = sequence.compressed && !sequence.pixels.bytes().empty();
  data_path.replace_extension(!packed ? ".raw" : meta ? ".zraw" : ".raw.gz");
  FileBeside data(data_path);
  write(sequence, header.stream(), path.string(), data.stream(), data_path.filename().string());
  data.commit();
  header.commit();
}

FileBeside::FileBeside(std::filesystem::path path) : path_(std::move(path)), unfinished_(path_) {
  unfinished_ += fmt::format(".{}.unfinished", ::getpid());
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  nameless_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (nameless_ >= 0) stream_.open(of_descriptor(nameless_), std::ios::binary);
  if (nameless_ >= 0 && stream_) return;
  stream_.clear();
  stream_.open(unfinished_, std::ios::binary | std::ios::trunc);
  if (!stream_)
    throw BadInput(fmt::format("{}: cannot be written ({}); check the folder.", path_.string(), cause()));
}

FileBeside::~FileBeside() {
  if (nameless_ >= 0) ::close(nameless_);
  if (committed_) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(unfinished_, ignored);
}

void FileBeside::commit() {
  stream_.close();
  if (!stream_)
    throw BadInput(
        fmt::format("{}: writing failed ({}); free some space on the disk.", path_.string(), cause()));
  // A name can be given to a file but not taken from another one: hence the second step.
  if (nameless_ >= 0 && ::linkat(AT_FDCWD, of_descriptor(nameless_).c_str(), AT_FDCWD, unfinished_.c_str(),
                                 AT_SYMLINK_FOLLOW) != 0)
    throw BadInput(fmt::format("{}: cannot be written ({}); check the folder.", path_.string(), cause()));
  std::error_code error;
  std::filesystem::rename(unfinished_, path_, error);
  if (error)
    throw BadInput(
        fmt::format("{}: cannot be written ({}); check the folder.", path_.string(), error.message()));
  committed_ = true;
}

}  // namespace sonoband::exchange
