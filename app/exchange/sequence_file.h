// Sequences by path: read by content, written by extension.
#pragma once

#include <filesystem>
#include <fstream>

#include "app/exchange/sequence.h"

namespace sonoband::exchange {

// MetaImage or NRRD, told by the first line whatever the file is called. Throws BadInput.
ReadSequence read_sequence(const std::filesystem::path& path);
ReadSequence read_sequence(const std::filesystem::path& path, const SequenceLimits& limits);

// .mha, .mhd (pixels in .raw or .zraw beside), .nrrd, .nhdr (pixels in .raw or .raw.gz beside). Throws
// BadInput where the extension is another or the disk refuses; then the old file, if any, is still there.
void write_sequence(const TrackedSequence& sequence, const std::filesystem::path& path);

// A file without a name, which takes its own when it is whole: whatever ends the program before, nothing is
// left behind. Where the file system has no such files (FAT), it is under another name in the same folder
// meanwhile.
class FileBeside {
 public:
  explicit FileBeside(std::filesystem::path path);  // throws BadInput where the folder refuses
  ~FileBeside();                                    // takes away what was not committed
  FileBeside(const FileBeside&) = delete;
  FileBeside& operator=(const FileBeside&) = delete;

  std::ofstream& stream() { return stream_; }
  void commit();  // throws BadInput where a write failed (disk full)

 private:
  std::filesystem::path path_;
  std::filesystem::path unfinished_;
  std::ofstream stream_;
  int nameless_ = -1;
  bool committed_ = false;
};

}  // namespace sonoband::exchange
