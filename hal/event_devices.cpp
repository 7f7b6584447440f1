#include "hal/event_devices.h"

#include <dirent.h>

#include <algorithm>

namespace sonoband {

std::vector<std::string> event_devices() {
  std::vector<std::string> paths;
  const std::string folder = "/dev/input/";
  DIR* all = opendir(folder.c_str());
  if (all == nullptr) return paths;
  while (const dirent* entry = readdir(all)) {
    const std::string name = entry->d_name;
    if (name.starts_with("event")) paths.push_back(folder + name);
  }
  closedir(all);
  std::sort(paths.begin(), paths.end(), [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  return paths;
}

}  // namespace sonoband
