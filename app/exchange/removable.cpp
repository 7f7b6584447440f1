#include "app/exchange/removable.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>

namespace sonoband::exchange {
namespace {

namespace fs = std::filesystem;

struct Mount {
  std::string device;  // "8:17"
  fs::path path;
  std::string source;  // "/dev/sdb1"
};

// A character written as a backslash and its number: three octal digits (the kernel's) or x and two
// hexadecimal ones (udev's).
std::string unescaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool hexadecimal = i + 3 < text.size() && text[i + 1] == 'x';
    if (text[i] == '\\' && i + 3 < text.size()) {
      const std::string digits = hexadecimal ? text.substr(i + 2, 2) : text.substr(i + 1, 3);
      std::size_t used = 0;
      int value = -1;
      try {
        value = std::stoi(digits, &used, hexadecimal ? 16 : 8);
      } catch (const std::logic_error&) {
        used = 0;
      }
      if (used == digits.size() && value >= 0 && value < 256) {
        out.push_back(static_cast<char>(value));
        i += 3;
        continue;
      }
    }
    out.push_back(text[i]);
  }
  return out;
}

// "36 35 8:17 / /media/stick rw,noatime shared:1 - vfat /dev/sdb1 rw"
std::vector<Mount> mounts(const MediaSources& sources) {
  std::vector<Mount> all;
  std::ifstream in(sources.mounts);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string id;
    std::string parent;
    std::string root;
    std::string path;
    std::string word;
    Mount m;
    if (!(words >> id >> parent >> m.device >> root >> path)) continue;
    while (words >> word && word != "-") {
    }
    if (!(words >> word >> m.source)) continue;
    m.path = unescaped(path);
    m.source = unescaped(m.source);
    all.push_back(std::move(m));
  }
  return all;
}

// The sysfs folder of the whole disk that has the device; empty: it is no disk's.
fs::path disk_of(const std::string& device, const MediaSources& sources) {
  std::error_code error;
  fs::path folder = fs::canonical(sources.sysfs / "dev/block" / device, error);
  if (error) return {};
  if (fs::exists(folder / "partition", error)) folder = folder.parent_path();
  return folder;
}

bool can_be_pulled(const fs::path& disk) {
  std::ifstream in(disk / "removable");
  int removable = 0;
  in >> removable;
  // A disk in a USB box says that its medium cannot be removed; the box can.
  return removable == 1 || disk.string().find("/usb") != std::string::npos;
}

// What would end the system if it were pulled.
bool is_of_the_system(const fs::path& path) {
  if (path == "/") return true;
  for (const char* folder : {"/boot", "/usr", "/var", "/home", "/etc", "/opt", "/nix"}) {
    const fs::path relative = path.lexically_relative(folder);
    if (!relative.empty() && *relative.begin() != "..") return true;
  }
  return false;
}

std::vector<Mount> removable_mounts(const MediaSources& sources) {
  std::vector<Mount> all = mounts(sources);
  std::set<fs::path> system;
  for (const Mount& m : all)
    if (is_of_the_system(m.path)) system.insert(disk_of(m.device, sources));
  std::erase_if(all, [&](const Mount& m) {
    const fs::path disk = disk_of(m.device, sources);
    return disk.empty() || system.contains(disk) || !can_be_pulled(disk);
  });
  // A service that may write to few places sees a disk twice at one place, the second time above the first.
  for (auto m = all.begin(); m != all.end();) {
    const bool covered = std::any_of(std::next(m), all.end(), [&](const Mount& later) {
      return later.path == m->path && later.device == m->device;
    });
    m = covered ? all.erase(m) : std::next(m);
  }
  return all;
}

std::string label_of(const Mount& mount, const MediaSources& sources) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(sources.labels, error)) {
    const fs::path target = fs::read_symlink(entry.path(), error);
    if (!error && target.filename() == fs::path(mount.source).filename())
      return unescaped(entry.path().filename().string());
  }
  return mount.path.filename().string();
}

// The removable mount that `path` lies on: of those it lies in the innermost one.
std::optional<Mount> mount_of(const fs::path& path, const MediaSources& sources) {
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(path, error);
  std::optional<Mount> innermost;
  for (const Mount& m : removable_mounts(sources)) {
    const fs::path relative = whole.lexically_relative(m.path);
    if (relative.empty() || *relative.begin() == "..") continue;
    if (!innermost || m.path.string().size() >= innermost->path.string().size()) innermost = m;
  }
  return innermost;
}

bool succeeds(std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  ::pid_t child = 0;
  const int failed = ::posix_spawnp(&child, argv[0], &quiet, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&quiet);
  int status = 0;
  return failed == 0 && ::waitpid(child, &status, 0) == child && WIFEXITED(status) &&
         WEXITSTATUS(status) == 0;
}

// By the system's own programs, which know what others than root may unmount: fstab and udisks by the first,
// what board/sticks mounts for the cart by the second.
bool unmount_as_user(const fs::path& path) {
  return succeeds({"umount", path.string()}) ||
         succeeds({"systemd-umount", "--no-ask-password", path.string()});
}

}  // namespace

std::vector<Place> removable_places(const MediaSources& sources) {
  std::vector<Place> places;
  for (const Mount& m : removable_mounts(sources)) places.push_back({label_of(m, sources), m.path, true});
  return places;
}

std::string write_out(const fs::path& path) {
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool failed = folder < 0 || ::syncfs(folder) != 0;
  const int why = errno;
  if (folder >= 0) ::close(folder);
  if (!failed) return {};
  return fmt::format("{}: not everything reached the disk ({}); export again, to another one", path.string(),
                     std::strerror(why));
}

std::string release(const fs::path& path, const MediaSources& sources) {
  const std::optional<Mount> mount = mount_of(path, sources);
  if (!mount)
    return path.string() + ": this lies on no disk that can be pulled, so there is nothing to unmount";
  if (std::string trouble = write_out(mount->path); !trouble.empty()) return trouble;
  if (::umount2(mount->path.c_str(), UMOUNT_NOFOLLOW) != 0) {
    const int why = errno;
    if (why == EBUSY)
      return mount->path.string() +
             ": everything is written, but another program uses it; close that, then unmount it, before "
             "pulling it";
    if (why != EPERM || !unmount_as_user(mount->path))
      return fmt::format(
          "{}: everything is written, but it could not be unmounted ({}); unmount it by hand before pulling "
          "it",
          mount->path.string(), std::strerror(why));
  }
  for (const Mount& m : mounts(sources))
    if (m.device == mount->device)
      return fmt::format(
          "{}: unmounted, but the same disk is still at {}; unmount that as well before pulling it",
          mount->path.string(), m.path.string());
  return {};
}

}  // namespace sonoband::exchange
