// What is on its way to an archive. Files wait on the disk until the archive has taken them, whatever happens
// to this program, the network or the archive meanwhile.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/exam/sqlite.h"
#include "app/exchange/dicom_send.h"

namespace sonoband::exchange {

class DicomOutbox {
 public:
  // Makes the folder (0700). One program at a time: throws BadInput where another one has it, or the disk
  // refuses.
  explicit DicomOutbox(const std::filesystem::path& folder);
  ~DicomOutbox();
  DicomOutbox(const DicomOutbox&) = delete;
  DicomOutbox& operator=(const DicomOutbox&) = delete;

  // Where a file is to be written that `add` takes: in the outbox, so that nothing is copied.
  std::filesystem::path new_file(const std::string& name) const;
  // From its return on the file waits, also after a power cut. A second file of the same name for the same
  // peer takes the place of the first.
  void add(const std::filesystem::path& file, const DicomPeer& peer);

  struct Item {
    std::int64_t id = 0;
    std::filesystem::path file;
    DicomPeer peer;
    std::int64_t attempts = 0;
    std::string trouble;  // of the last attempt
  };
  std::vector<Item> waiting() const;  // oldest first

  // One attempt for everything that waits, peer by peer. What was taken is deleted here. Gives a sentence for
  // each trouble. `progress` gets how many were taken, and of how many.
  std::vector<std::string> send(const std::function<void(std::size_t, std::size_t)>& progress = {});

 private:
  std::filesystem::path folder_;
  int lock_ = -1;
  exam::Database database_;
};

}  // namespace sonoband::exchange
