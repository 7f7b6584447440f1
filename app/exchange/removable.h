// Sticks and cards: where results can be taken away on, and how to take them away safely.
// Source: proc(5), mountinfo; Documentation/ABI/stable/sysfs-block of the kernel, "removable".
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sonoband::exchange {

// A folder that somebody may choose to write into.
struct Place {
  std::string label;  // for people: the file system's own, or the folder's name
  std::filesystem::path path;
  bool removable = false;
};

// What the kernel and udev say; other paths are for tests.
struct MediaSources {
  std::filesystem::path mounts = "/proc/self/mountinfo";
  std::filesystem::path sysfs = "/sys";
  std::filesystem::path labels = "/dev/disk/by-label";
};

// The mounted file systems of disks that can be pulled: those that say so themselves, and all on USB. The
// disk that the system itself runs from is none of them, wherever it is plugged in. In order of mounting.
// Nothing is found where the kernel says nothing.
std::vector<Place> removable_places(const MediaSources& sources = {});

// Waits until all that is on its way to the file system of `path` is on its disk. Empty: it is. Otherwise a
// sentence with the cure.
std::string write_out(const std::filesystem::path& path);

// Writes out all that is still on its way to the file system of `path` and unmounts it; may take as long as
// the stick is slow. Empty: it can be pulled. Otherwise a sentence with what stands in the way and the cure,
// and it must not be pulled yet.
std::string release(const std::filesystem::path& path, const MediaSources& sources = {});

}  // namespace sonoband::exchange
