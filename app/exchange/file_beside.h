// A file that is there when it is whole, and not before.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>

#include "app/exchange/progress.h"

namespace sonoband::exchange {

// A file without a name, which takes its own when it is whole: whatever ends the program before, nothing is
// left behind. Where the file system has no such files (FAT), it is under another name in the same folder
// meanwhile.
class FileBeside {
 public:
  // `bytes` that will come, as far as that is known (0: not): where there is no room for them it says so at
  // once and not after minutes, and `progress` is told how many of them are written. Throws BadInput where
  // the folder refuses.
  explicit FileBeside(std::filesystem::path path, const Progress& progress = {}, std::uint64_t bytes = 0);
  ~FileBeside();  // takes away what was not committed
  FileBeside(const FileBeside&) = delete;
  FileBeside& operator=(const FileBeside&) = delete;

  std::ostream& stream() { return stream_; }
  void only_for_its_owner();  // others may not read it
  void commit();              // throws BadInput where a write failed (disk full) or was stopped

 private:
  // Remembers why a write failed: the stream does not.
  class Bytes : public std::filebuf {
   public:
    Bytes(const Progress& progress, std::uint64_t expected) : progress_(progress), expected_(expected) {}
    int error() const { return error_; }  // errno; 0: none
    bool stopped() const { return stopped_; }
    bool finish();  // everything handed to the system; false: it refused

   protected:
    std::streamsize xsputn(const char* bytes, std::streamsize count) override;
    int_type overflow(int_type c) override;
    int sync() override;

   private:
    template <class Write>
    auto noting(const Write& write, decltype(write()) failed);
    Progress progress_;
    std::uint64_t expected_;
    std::uint64_t written_ = 0;
    int error_ = 0;
    bool stopped_ = false;
  };
  bool open(const std::filesystem::path& file, std::ios::openmode mode);

  std::filesystem::path path_;
  std::filesystem::path unfinished_;
  Bytes bytes_;
  std::ostream stream_{&bytes_};
  int nameless_ = -1;
  bool committed_ = false;
};

// What a file meets where it is to be written.
struct Disk {
  std::uint64_t free_bytes = 0;
  bool is_fat = false;  // no file of 4 GiB and more
};
Disk disk_of(const std::filesystem::path& file);  // its folder need not be there

// One sentence: why the system (errno `why`) does not let this file be written there, and the cure.
std::string why_unwritable(const std::filesystem::path& file, int why, const Disk& disk);
std::string why_unwritable(const std::filesystem::path& file, int why);

// The same where `bytes` will not fit the disk, or not into one file of it. Empty: they will.
std::string why_no_room(const std::filesystem::path& file, std::uint64_t bytes, const Disk& disk);

}  // namespace sonoband::exchange
