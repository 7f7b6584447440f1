// What is on its way to an archive. Files wait on the disk until the archive has taken them, or, where that
// was asked for, has said that it will keep them (storage commitment); whatever happens to this program, the
// network or the archive meanwhile.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/exam/sqlite.h"
#include "app/exchange/dicom_commit.h"
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
  // peer takes the place of the first. `commit`: until the archive has said that it will keep it.
  void add(const std::filesystem::path& file, const DicomPeer& peer, bool commit = false);

  struct Item {
    std::int64_t id = 0;
    std::filesystem::path file;
    DicomPeer peer;
    std::int64_t attempts = 0;
    std::string trouble;  // of the last attempt
    bool commit = false;
    bool sent = false;        // and waits for the archive's word only
    std::string transaction;  // that the archive was asked in last
    DicomReference object;    // known once sent
  };
  std::vector<Item> waiting() const;  // oldest first

  // One attempt for everything that waits, peer by peer. What was taken is deleted here. Gives a sentence for
  // each trouble. `progress` gets how many were taken, and of how many.
  std::vector<std::string> send(const std::function<void(std::size_t, std::size_t)>& progress = {});

  // Asks the archives, peer by peer, to answer for all that is sent and waits for their word, and hears their
  // answers. `port`: where archives bring answers later, as their configuration says; 0: they are heard only
  // on the association of the question. An object that is kept is deleted here; one that is not kept waits to
  // be sent again. Where an archive offers no storage commitment, having taken an object is all there is: it
  // is deleted, and said in `without`. Answers that do not come within `wait_s` seconds are asked for again
  // next time. Throws BadInput where the port cannot be had.
  struct Committed {
    std::size_t kept = 0;
    std::size_t refused = 0;
    std::size_t unanswered = 0;
    std::vector<std::string> without;  // one sentence for each such archive
    std::vector<std::string> trouble;  // one sentence each
  };
  Committed commit(std::uint16_t port, int wait_s);

 private:
  bool take_answer(const CommitmentAnswer& answer, Committed& outcome);
  void remove(std::int64_t id, const std::filesystem::path& file);
  void note(std::int64_t id, const std::string& trouble);

  std::filesystem::path folder_;
  int lock_ = -1;
  exam::Database database_;
};

}  // namespace sonoband::exchange
