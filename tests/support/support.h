// What every test may lean on: where the real recordings are, and a seeded source of random geometry.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <string_view>

#include "core/geometry/transforms.h"

namespace sonoband::test {

// The folder of real recordings: $SONOBAND_DATA, else ../shared/data beside the project. Empty when neither
// is there; in CI ($CI set) that fails the test instead, because there the recordings must not be skipped.
std::optional<std::filesystem::path> data_folder();

// Uniform on the rotations (a normalised Gaussian quaternion).
Eigen::Matrix3d random_rotation(std::mt19937_64& random);

// Whether a sentence to people holds this part; shows the sentence if not.
::testing::AssertionResult says(const std::string& sentence, std::string_view part);

}  // namespace sonoband::test

// First line of a test that needs recordings: gives `folder` or skips, saying so.
// NOLINTBEGIN(bugprone-macro-parentheses): it declares the name it is given
#define SONOBAND_DATA_OR_SKIP(folder)                                                                    \
  const auto folder##_found = ::sonoband::test::data_folder();                                           \
  if (!folder##_found) GTEST_SKIP() << "no recordings: set SONOBAND_DATA or put them in ../shared/data"; \
  const std::filesystem::path& folder = *folder##_found
// NOLINTEND(bugprone-macro-parentheses)

#define EXPECT_SAYS(sentence, part) EXPECT_TRUE(::sonoband::test::says(sentence, part))
