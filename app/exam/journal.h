// What an interrupted journal (SQLite's write-ahead log) still holds, told without touching it. SQLite itself
// stops silently at the first bad page of a journal: right after a power cut, wrong after damage.
// Source: "The WAL file format", https://www.sqlite.org/fileformat2.html#the_write_ahead_log
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace sonoband::exam {

struct JournalState {
  std::int64_t bytes = 0;    // of the file; 0: there is none, or it is empty
  std::int64_t commits = 0;  // whole transactions that SQLite will take over
  bool torn = false;         // behind them lies a part of one more: it was never promised
  bool damaged = false;      // behind them lie later commits that cannot be reached: they were promised
};

// Of the journal beside `exam` (its path with "-wal"). Reads it once, in bounded memory.
JournalState journal_state(const std::filesystem::path& exam);

}  // namespace sonoband::exam
