// The plan of the house: which folder may include which, and what may stand at the top level.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace sonoband {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

const std::map<std::string, Names>& may_include() {
  static const std::map<std::string, Names> arrows = {
      {"core", {"core"}},
      {"hal", {"core", "hal"}},
      {"board", {"core", "hal", "board"}},
      {"ui", {"core", "ui"}},
      {"app", {"core", "hal", "board", "ui", "app"}},
      {"tools", {"core", "hal", "board", "ui", "app", "tools"}},
      {"tests", {"core", "hal", "board", "ui", "app", "tools", "tests"}},
  };
  return arrows;
}

// Core is given time, memory and threads; it fetches none of them.
const Names& not_in_core() {
  static const Names headers = {"thread",     "mutex",        "condition_variable",
                                "future",     "shared_mutex", "filesystem",
                                "fstream",    "iostream",     "cstdio",
                                "unistd.h",   "sys/mman.h",   "pthread.h",
                                "sched.h",    "stdio.h",      "ctime",
                                "sys/stat.h", "fcntl.h",      "time.h",
                                "semaphore"};
  return headers;
}

std::string folder_of(const std::string& path) {
  return path.substr(0, path.find('/'));
}

// Sentences about what a file at `path` (from the root) includes against the plan.
std::vector<std::string> violations(const std::string& path, const std::string& text) {
  static const std::regex include(R"rx(^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"])rx");
  std::vector<std::string> found;
  const std::string folder = folder_of(path);
  const bool header = path.ends_with(".h");
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::smatch match;
    if (!std::regex_search(line, match, include)) continue;
    const std::string target = match[2];
    const std::string where = path + ":" + std::to_string(number) + " includes " + target;
    const bool ours = may_include().contains(folder_of(target)) && target.find('/') != std::string::npos;
    if (ours && !may_include().at(folder).contains(folder_of(target))) found.push_back(where);
    if (match[1] == "\"" && !ours) found.push_back(where + ", not by its path from the root");
    if (folder != "core" || ours) {
      const bool third_party = !ours && target.find('/') != std::string::npos &&
                               !target.starts_with("Eigen/") && !target.starts_with("sys/");
      if (folder == "hal" && header && third_party) found.push_back(where + " in a header of hal");
      continue;
    }
    const bool library = target.find('/') != std::string::npos;
    const bool allowed_library = target.starts_with("Eigen/") || target.starts_with("hwy/");
    if (not_in_core().contains(target) || (library && !allowed_library)) found.push_back(where);
  }
  return found;
}

fs::path root() {
  return SONOBAND_SOURCE_DIR;
}

TEST(House, IncludesFollowTheArrows) {
  int files = 0;
  for (const auto& [folder, unused] : may_include()) {
    if (!fs::exists(root() / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root() / folder)) {
      const std::string extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp") continue;
      ++files;
      std::ifstream in(entry.path());
      const std::string text{std::istreambuf_iterator<char>(in), {}};
      for (const std::string& v : violations(fs::relative(entry.path(), root()), text)) ADD_FAILURE() << v;
    }
  }
  EXPECT_GT(files, 20);
}

TEST(House, PlantedViolationsAreFound) {
  EXPECT_EQ(violations("core/a.h", "#include \"hal/devices.h\"\n").size(), 1u);
  EXPECT_EQ(violations("core/a.cpp", "#include <thread>\n").size(), 1u);
  EXPECT_EQ(violations("core/a.cpp", "#include <png/png.h>\n").size(), 1u);
  EXPECT_EQ(violations("ui/a.cpp", "#include \"app/workers.h\"\n").size(), 1u);
  EXPECT_EQ(violations("hal/a.cpp", "#include \"board/board.h\"\n").size(), 1u);
  EXPECT_EQ(violations("hal/a.h", "#include <libusb-1.0/libusb.h>\n").size(), 1u);
  EXPECT_EQ(violations("app/a.cpp", "#include \"workers.h\"\n").size(), 1u);
  EXPECT_TRUE(violations("app/a.cpp", "#include \"core/time.h\"\n#include <thread>\n").empty());
  EXPECT_TRUE(violations("core/a.cpp", "#include <Eigen/Core>\n#include <vector>\n").empty());
}

TEST(House, TopLevelHoldsItsNineEntries) {
  const Names allowed = {"CMakeLists.txt", "app",   "hal",       "core",    "ui",
                         "board",          "tests", "README.md", "LICENSE", "CMakePresets.json",
                         "tools"};
  const Names made_here = {"build", "out"};
  for (const auto& entry : fs::directory_iterator(root())) {
    const std::string name = entry.path().filename();
    if (name.starts_with(".") || made_here.contains(name)) continue;
    EXPECT_TRUE(allowed.contains(name)) << name << " does not belong at the top level";
  }
}

}  // namespace
}  // namespace sonoband
