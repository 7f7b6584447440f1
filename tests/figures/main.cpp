// Writes the paper's figures, made anew, into a folder.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "tests/figures/figures.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: figures FOLDER\n");
    return 2;
  }
  try {
    using namespace sonoband::figures;
    const std::string folder = argv[1];
    std::filesystem::create_directories(folder);
    for (const auto figure :
         {figure_8, figure_9, figure_10, figure_3, figures_4_and_5, figure_6, figures_11_to_13}) {
      figure(folder);
    }
    std::printf("The figures are in %s\n", folder.c_str());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "figures: %s\n", e.what());
    return 1;
  }
  return 0;
}
