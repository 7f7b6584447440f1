// Handing DICOM files to an archive: C-STORE, with or without TLS.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace sonoband::exchange {

struct DicomTls {
  std::filesystem::path trusted;      // PEM: who may have signed the peer's certificate
  std::filesystem::path certificate;  // our own, PEM; empty: anonymous
  std::filesystem::path key;
  bool operator==(const DicomTls&) const = default;
};

struct DicomPeer {
  std::string title;  // its AE title
  std::string host;
  std::uint16_t port = 0;
  std::string our_title = "SONOBAND";
  std::optional<DicomTls> tls;
};

// "AET@HOST:PORT"; a host in brackets may have colons. Throws BadInput.
DicomPeer parse_dicom_peer(const std::string& text);

// What an object is called all over the world.
struct DicomReference {
  std::string sop_class;
  std::string sop_instance;
  bool operator==(const DicomReference&) const = default;
};
// Of a file, from its head; empty: it is no DICOM file.
DicomReference dicom_reference(const std::filesystem::path& file);

// One association for all files. `answered` is called for each in order: an empty sentence when the peer has
// taken it, else why not. Gives why nothing more could be sent (no connection, refused, lost); empty: all
// were answered. Waits at most 10 s for a connection and 60 s for an answer.
std::string send_dicom(const std::vector<std::filesystem::path>& files, const DicomPeer& peer,
                       const std::function<void(std::size_t file, const std::string& sentence)>& answered);

}  // namespace sonoband::exchange
