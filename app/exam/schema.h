// The tables of an exam file, and how an older file becomes a newer one.
#pragma once

#include <span>
#include <string>

#include "app/exam/sqlite.h"

namespace sonoband::exam {

// PRAGMA application_id of every exam file: "SoBa".
constexpr std::int64_t application_id = 0x536f4261;

// Each step takes a file from schema i to i + 1; files say theirs in PRAGMA user_version.
std::span<const std::string> migrations();

// Brings the file up to date in one transaction per step; a file that another program made, or a newer
// Sonoband, is left alone and said (StoreError).
void migrate(Database& database, std::span<const std::string> steps);

// The same checks, changing nothing; false: it must be migrated before it can be read.
bool up_to_date(const Database& database, std::span<const std::string> steps);

// Frames of sweep s lie together: their rows are s << 32 | number.
constexpr std::int64_t frame_row(std::int64_t sweep, std::int64_t number) {
  return (sweep << 32) | number;
}

}  // namespace sonoband::exam
