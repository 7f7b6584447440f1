// A disk that fails on command, under SQLite (a VFS over the usual one): full, gone, or without power.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <vector>

struct sqlite3_vfs;
struct sqlite3_file;

namespace sonoband::exam::test {

// Files opened through it are real files, so anyone may look at them. Beside each it keeps what a disk would
// have on the platter: the bytes of the last sync, and the writes since. One disk at a time may be cut.
class FaultyDisk {
 public:
  enum class Fault : std::uint8_t {
    full,   // writing fails, reading and syncing go on
    gone,   // everything fails
    power,  // everything fails; cut_power() then says what the platter kept
  };

  explicit FaultyDisk(std::uint64_t seed);
  ~FaultyDisk();
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;

  const std::string& name() const { return name_; }  // for SQLite, and RecorderSettings::vfs
  // The `change`-th change from now (write, truncation, sync; the first is 0) and all that follow fail.
  void fail_at(std::int64_t change, Fault fault);
  void heal();
  std::int64_t changes() const;  // since the last fail_at or heal

  // To be called when every file is closed again. Of the writes after its last sync each file keeps any,
  // in any combination; the last one kept of each may be torn at a sector of 512 bytes.
  void cut_power();

  // For the file methods.
  enum class Operation : std::uint8_t { read, write, other };
  int answer(Operation operation);  // SQLITE_OK or how it fails
  void opened(const std::string& path);
  void wrote(const std::string& path, const void* data, int bytes, std::int64_t offset);
  void truncated(const std::string& path, std::int64_t size);
  void synced(const std::string& path);
  void deleted(const std::string& path);
  sqlite3_vfs* below() const { return below_; }

 private:
  struct Change {
    std::int64_t offset = 0;  // of a write; the size of a truncation
    std::vector<std::uint8_t> bytes;
    bool truncation = false;
  };
  struct Platter {
    std::vector<std::uint8_t> synced;
    std::vector<Change> since;
  };
  static void apply(std::vector<std::uint8_t>& content, const Change& change, std::size_t bytes);

  mutable std::mutex mutex_;
  std::mt19937_64 random_;
  std::string name_;
  sqlite3_vfs* below_ = nullptr;
  sqlite3_vfs* vfs_ = nullptr;
  std::map<std::string, Platter> files_;
  std::int64_t changes_ = 0;
  std::int64_t fails_at_ = -1;
  Fault fault_ = Fault::full;
  bool failing_ = false;
};

}  // namespace sonoband::exam::test
