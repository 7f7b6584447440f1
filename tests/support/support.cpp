#include "tests/support/support.h"

#include <cstdlib>

namespace sonoband::test {

std::optional<std::filesystem::path> data_folder() {
  // The project's root is where this file was compiled from.
  static const std::filesystem::path beside = std::filesystem::path(SONOBAND_SOURCE_DIR) / "../shared/data";
  const char* named = std::getenv("SONOBAND_DATA");
  const std::filesystem::path folder = named != nullptr ? std::filesystem::path(named) : beside;
  if (std::filesystem::is_directory(folder)) return folder;
  if (std::getenv("CI") != nullptr)
    ADD_FAILURE() << "CI must have the recordings, but there is no " << folder;
  return std::nullopt;
}

Eigen::Matrix3d random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> gauss;
  return Eigen::Quaterniond(gauss(random), gauss(random), gauss(random), gauss(random))
      .normalized()
      .toRotationMatrix();
}

::testing::AssertionResult says(const std::string& sentence, std::string_view part) {
  if (sentence.find(part) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "it says '" << sentence << "', without '" << part << "'";
}

}  // namespace sonoband::test
