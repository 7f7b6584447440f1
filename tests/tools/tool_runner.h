// Runs a verb in this process and keeps what it prints; and files for it to work on.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tools/verbs.h"

namespace sonoband::test {

struct ToolRun {
  int exit_code = 0;
  std::string out;
  std::string err;
};

inline ToolRun run_tool(const std::vector<std::string>& words) {
  std::vector<const char*> argv{"sonoband-tool"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  ToolRun run;
  run.exit_code = tools::run_tool(static_cast<int>(argv.size()), argv.data());
  run.out = ::testing::internal::GetCapturedStdout();
  run.err = ::testing::internal::GetCapturedStderr();
  return run;
}

// A folder of its own for each test, gone afterwards.
class ToolTest : public ::testing::Test {
 protected:
  ToolTest() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("sonoband_") + test->test_suite_name() + "_" + test->name();
    for (char& c : name)
      if (c == '/') c = '_';
    folder = std::filesystem::temp_directory_path() / (name + "_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
  }
  ~ToolTest() override { std::filesystem::remove_all(folder); }

  std::string path(const std::string& name) const { return (folder / name).string(); }

  std::filesystem::path folder;
};

}  // namespace sonoband::test
