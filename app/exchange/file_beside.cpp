#include "app/exchange/file_beside.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <system_error>
#include <utility>

#include "app/bad_input.h"

namespace sonoband::exchange {
namespace {

namespace fs = std::filesystem;

// What is written between two questions whether to go on: a slow stick takes 5 MB a second.
constexpr std::streamsize step_bytes = std::streamsize{1} << 20;
constexpr std::uint64_t fat_limit = 0xffffffffU;  // bytes of one file

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

std::string of_descriptor(int descriptor) {
  return fmt::format("/proc/self/fd/{}", descriptor);
}

std::string size_words(std::uint64_t bytes) {
  return bytes < 1'000'000'000 ? fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6)
                               : fmt::format("{:.1f} GB", static_cast<double>(bytes) / 1e9);
}

std::string too_large_for_fat(const fs::path& file) {
  return file.string() +
         ": cannot be written: a disk formatted as FAT has no file of 4 GiB and more; use one formatted as "
         "exFAT, or export one sweep at a time, as pictures (png) or as a movie";
}

// The reason and the cure.
std::string words_of(int why) {
  switch (why) {
    case ENOSPC:
    case EDQUOT:
      return "the disk is full; free some space on it, or choose another place";
    case EFBIG:
      return "files may not be that large there; choose another place, or export one sweep at a time";
    case EROFS:
      return "the disk is read-only; move its lock, or choose another place (damage makes disks read-only as "
             "well)";
    case EACCES:
    case EPERM:
      return "this user may not write there; choose another place";
    case ENOENT:
    case ENOTDIR:
      return "the folder is not there; check its name, and that the disk was not pulled";
    case EISDIR:
      return "this is a folder; name a file in it";
    case EIO:
    case ENODEV:
    case ENXIO:
      return "the disk does not answer; if it was pulled, put it back and export again, else use another";
    default:
      return std::generic_category().message(why) + "; check the folder";
  }
}

}  // namespace

Disk disk_of(const fs::path& file) {
  Disk disk;
  struct statfs s {};
  // Where it cannot be asked there is nothing to refuse; writing will tell.
  if (::statfs(folder_of(file).c_str(), &s) != 0) return {std::numeric_limits<std::uint64_t>::max(), false};
  disk.free_bytes = static_cast<std::uint64_t>(s.f_bavail) * static_cast<std::uint64_t>(s.f_bsize);
  disk.is_fat = s.f_type == MSDOS_SUPER_MAGIC;
  return disk;
}

std::string why_unwritable(const fs::path& file, int why, const Disk& disk) {
  if (why == EFBIG && disk.is_fat) return too_large_for_fat(file);
  return fmt::format("{}: cannot be written: {}", file.string(), words_of(why));
}

std::string why_unwritable(const fs::path& file, int why) {
  return why_unwritable(file, why, disk_of(file));
}

std::string why_no_room(const fs::path& file, std::uint64_t bytes, const Disk& disk) {
  if (bytes > fat_limit && disk.is_fat) return too_large_for_fat(file);
  if (bytes <= disk.free_bytes) return {};
  return fmt::format(
      "{}: cannot be written: it needs {} and the disk has {} left; free some space on it, or choose another "
      "place",
      file.string(), size_words(bytes), size_words(disk.free_bytes));
}

bool FileBeside::Bytes::finish() {
  return close() != nullptr && error_ == 0;
}

template <class Write>
auto FileBeside::Bytes::noting(const Write& write, decltype(write()) failed) {
  errno = 0;
  const auto got = write();
  if (got == failed && error_ == 0) error_ = errno != 0 ? errno : EIO;
  return got;
}

std::streamsize FileBeside::Bytes::xsputn(const char* bytes, std::streamsize count) {
  std::streamsize done = 0;
  while (done < count) {
    const std::streamsize part = std::min(count - done, step_bytes);
    errno = 0;
    const std::streamsize got = std::filebuf::xsputn(bytes + done, part);
    done += got;
    const std::uint64_t before = std::exchange(written_, written_ + static_cast<std::uint64_t>(got));
    if (got < part) {
      if (error_ == 0) error_ = errno != 0 ? errno : EIO;
      return done;
    }
    if (!progress_ || before / step_bytes == written_ / step_bytes) continue;
    const std::uint64_t of = std::max(expected_, written_);
    if (!progress_(static_cast<int>(1000 * written_ / of))) {
      stopped_ = true;
      return std::min(done, count - 1);  // the stream fails, so its writer ends
    }
  }
  return done;
}

FileBeside::Bytes::int_type FileBeside::Bytes::overflow(int_type c) {
  return noting([&] { return std::filebuf::overflow(c); }, traits_type::eof());
}

int FileBeside::Bytes::sync() {
  return noting([&] { return std::filebuf::sync(); }, -1);
}

bool FileBeside::open(const fs::path& file, std::ios::openmode mode) {
  errno = 0;
  return bytes_.open(file, mode | std::ios::out | std::ios::binary) != nullptr;
}

FileBeside::FileBeside(fs::path path, const Progress& progress, std::uint64_t bytes)
    : path_(std::move(path)), unfinished_(path_), bytes_(progress, bytes) {
  if (const std::string why = why_no_room(path_, bytes, disk_of(path_)); !why.empty()) throw BadInput(why);
  if (std::error_code none; fs::is_directory(path_, none)) throw BadInput(why_unwritable(path_, EISDIR));
  unfinished_ += fmt::format(".{}.unfinished", ::getpid());
  nameless_ = ::open(folder_of(path_).c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (nameless_ >= 0 && open(of_descriptor(nameless_), {})) return;
  if (!open(unfinished_, std::ios::trunc)) throw BadInput(why_unwritable(path_, errno));
}

FileBeside::~FileBeside() {
  if (nameless_ >= 0) ::close(nameless_);
  if (committed_) return;
  bytes_.close();
  std::error_code ignored;
  fs::remove(unfinished_, ignored);
}

void FileBeside::only_for_its_owner() {
  // Where the file system knows no owners (FAT) there is nobody to keep out.
  if (nameless_ >= 0)
    static_cast<void>(::fchmod(nameless_, S_IRUSR | S_IWUSR));
  else
    static_cast<void>(::chmod(unfinished_.c_str(), S_IRUSR | S_IWUSR));
}

void FileBeside::commit() {
  const bool whole = bytes_.finish() && stream_;
  if (bytes_.stopped()) throw BadInput(path_.string() + ": stopped before the end; it was not written");
  if (!whole) throw BadInput(why_unwritable(path_, bytes_.error() != 0 ? bytes_.error() : EIO));
  // A name can be given to a file but not taken from another one: hence the second step.
  if (nameless_ >= 0 && ::linkat(AT_FDCWD, of_descriptor(nameless_).c_str(), AT_FDCWD, unfinished_.c_str(),
                                 AT_SYMLINK_FOLLOW) != 0)
    throw BadInput(why_unwritable(path_, errno));
  std::error_code error;
  fs::rename(unfinished_, path_, error);
  if (error) throw BadInput(why_unwritable(path_, error.value()));
  committed_ = true;
}

}  // namespace sonoband::exchange
