// Writes the paper's figures, made anew, into a folder, or compares them with those that a folder has.
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <string_view>

#include "tests/figures/compare.h"
#include "tests/figures/figures.h"

namespace {

void paint(const std::string& folder) {
  using namespace sonoband::figures;
  std::filesystem::create_directories(folder);
  for (const auto figure :
       {figure_8, figure_9, figure_10, figure_3, figures_4_and_5, figure_6, figures_11_to_13}) {
    figure(folder);
  }
}

int compare(const std::string& kept) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("sonoband_figures_" + std::to_string(::getpid()));
  paint(folder);
  const std::vector<std::string> sentences = sonoband::figures::outdated(folder, kept);
  std::filesystem::remove_all(folder);
  for (const std::string& sentence : sentences) std::fprintf(stderr, "figures: %s\n", sentence.c_str());
  return sentences.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const bool comparing = argc == 3 && std::string_view(argv[1]) == "--compare";
  if (argc != 2 && !comparing) {
    std::fprintf(stderr, "usage: figures [--compare] FOLDER\n");
    return 2;
  }
  try {
    const std::string folder = argv[argc - 1];
    if (comparing) return compare(folder);
    paint(folder);
    std::printf("The figures are in %s\n", folder.c_str());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "figures: %s\n", e.what());
    return 1;
  }
  return 0;
}
