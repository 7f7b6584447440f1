#include "app/exchange/dicom_send.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmnet/scu.h>
#include <dcmtk/dcmtls/tlsscu.h>
#include <fmt/format.h>

#include <memory>
#include <set>

#include "app/bad_input.h"
#include "app/exchange/dicom_scu.h"
#include "app/exchange/text.h"

namespace sonoband::exchange {
namespace {

constexpr std::size_t longest_title = 16;  // PS3.5, 6.2, AE

std::unique_ptr<DcmSCU> make_scu(const DicomPeer& peer) {
  if (!peer.tls) return std::make_unique<DcmSCU>();
  auto scu = std::make_unique<DcmTLSSCU>(peer.host.c_str(), peer.title.c_str(), peer.port);
  trust(*scu, *peer.tls);
  return scu;
}

}  // namespace

DicomPeer parse_dicom_peer(const std::string& text) {
  DicomPeer peer;
  const std::size_t at = text.find('@');
  const std::size_t colon = text.rfind(':');
  std::optional<std::int64_t> port;
  if (at != std::string::npos && colon != std::string::npos && colon > at) {
    peer.title = text.substr(0, at);
    peer.host = text.substr(at + 1, colon - at - 1);
    if (peer.host.starts_with('[') && peer.host.ends_with(']'))
      peer.host = peer.host.substr(1, peer.host.size() - 2);
    port = parse_integer(std::string_view(text).substr(colon + 1));
  }
  if (peer.title.empty() || peer.title.size() > longest_title || peer.host.empty() || !port || *port < 1 ||
      *port > 65535) {
    throw BadInput(fmt::format(
        "'{}' is no DICOM peer: write its title (at most 16 characters), host and port as AET@HOST:PORT",
        text));
  }
  peer.port = static_cast<std::uint16_t>(*port);
  return peer;
}

DicomReference dicom_reference(const std::filesystem::path& file) {
  DcmFileFormat head;
  OFString name;
  OFString instance;
  if (head.loadFileUntilTag(file.c_str(), EXS_Unknown, EGL_noChange, DCM_MaxReadLength, ERM_autoDetect,
                            DCM_PatientName)
          .bad())
    return {};
  DcmMetaInfo& meta = *head.getMetaInfo();
  if (meta.findAndGetOFString(DCM_MediaStorageSOPClassUID, name).bad() ||
      meta.findAndGetOFString(DCM_MediaStorageSOPInstanceUID, instance).bad())
    return {};
  return {name.c_str(), instance.c_str()};
}

std::string send_dicom(const std::vector<std::filesystem::path>& files, const DicomPeer& peer,
                       const std::function<void(std::size_t, const std::string&)>& answered) {
  const std::unique_ptr<DcmSCU> scu = make_scu(peer);
  address(*scu, peer);
  std::set<std::string> classes;
  std::vector<bool> readable;
  for (const std::filesystem::path& file : files) {
    const std::string name = dicom_reference(file).sop_class;
    readable.push_back(!name.empty());
    if (!name.empty()) classes.insert(name);
  }
  for (const std::string& name : classes) offer(*scu, name);
  if (const OFCondition made = scu->initNetwork(); made.bad()) return trouble_with(peer, "no network", made);
  if (const OFCondition made = scu->negotiateAssociation(); made.bad())
    return trouble_with(peer, "no association", made);
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!readable[i]) {
      answered(i, files[i].string() + ": this is no DICOM file");
      continue;
    }
    Uint16 status = 0;
    const OFCondition sent = scu->sendSTORERequest(0, files[i].c_str(), nullptr, status);
    if (sent.bad()) {
      scu->abortAssociation();
      return trouble_with(peer, "the connection was lost", sent);
    }
    // 0xBxxx are warnings: the object is stored. PS3.4, B.2.3.
    const bool stored = status == 0 || (status & 0xf000) == 0xb000;
    answered(i, stored
                    ? std::string()
                    : fmt::format("{}: the archive refused it (status {:04x}h)", files[i].string(), status));
  }
  scu->releaseAssociation();
  return {};
}

}  // namespace sonoband::exchange
