// Storage commitment: asking an archive to answer for what it was sent, and hearing its answer.
// Source: DICOM PS3.4 2022, annex J (Storage Commitment Push Model).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/exchange/dicom_send.h"

namespace sonoband::exchange {

struct CommitmentAnswer {
  std::string transaction;
  std::vector<DicomReference> kept;
  struct Refused {
    DicomReference object;
    std::uint16_t reason = 0;  // PS3.3, C.14.1.1; 0: not said
  };
  std::vector<Refused> refused;
};

// Makes what the archive said last, on the disk, before the archive is told that we have it. False: no such
// transaction is known, and the archive is told so.
using TakeAnswer = std::function<bool(const CommitmentAnswer&)>;

enum class Asked : std::uint8_t {
  asked,        // the archive will answer, now or later
  not_offered,  // it knows no storage commitment
  failed,       // no connection, or refused
};
struct CommitmentAsked {
  Asked outcome = Asked::failed;
  std::string sentence;  // what is wrong; empty with `asked`
};

// One association: the request, and the answer if it comes within `stay_s` seconds on the same association. A
// `stay_s` of 0 does not wait.
CommitmentAsked ask_commitment(const std::vector<DicomReference>& objects, const DicomPeer& peer,
                               const std::string& transaction, int stay_s, const TakeAnswer& take);

// Where archives bring their answers on associations of their own. They know our title, host and port from
// their configuration.
class CommitmentListener {
 public:
  // Listens from now on, so that no answer is too quick. With `tls`, which then needs a certificate and key
  // of ours, only archives that show a trusted certificate are heard. Throws BadInput where the port cannot
  // be had or a file of `tls` is not what it should be.
  CommitmentListener(std::uint16_t port, const std::string& our_title, TakeAnswer take,
                     const std::optional<DicomTls>& tls = {});
  ~CommitmentListener();
  CommitmentListener(const CommitmentListener&) = delete;
  CommitmentListener& operator=(const CommitmentListener&) = delete;

  // Hears answers until `enough` gives true (asked after each association and each second).
  void hear(const std::function<bool()>& enough);

 private:
  struct Scp;
  std::unique_ptr<Scp> scp_;
};

}  // namespace sonoband::exchange
