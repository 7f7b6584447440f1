#include "app/exchange/dicom_send.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmnet/scu.h>
#include <dcmtk/dcmtls/tlsscu.h>
#include <fmt/format.h>

#include <memory>
#include <set>

#include "app/bad_input.h"
#include "app/exchange/text.h"

namespace sonoband::exchange {
namespace {

constexpr int connection_s = 10;
constexpr unsigned answer_s = 60;
constexpr std::size_t longest_title = 16;  // PS3.5, 6.2, AE

std::string place(const DicomPeer& peer) {
  return fmt::format("{}@{}:{}", peer.title, peer.host, peer.port);
}

// The SOP class of a file, from its head; empty: it is no DICOM file.
std::string sop_class(const std::filesystem::path& file) {
  DcmFileFormat head;
  OFString value;
  if (head.loadFileUntilTag(file.c_str(), EXS_Unknown, EGL_noChange, DCM_MaxReadLength, ERM_autoDetect,
                            DCM_PatientName)
          .bad())
    return {};
  if (head.getMetaInfo()->findAndGetOFString(DCM_MediaStorageSOPClassUID, value).bad()) return {};
  return value.c_str();
}

std::unique_ptr<DcmSCU> make_scu(const DicomPeer& peer) {
  if (!peer.tls) return std::make_unique<DcmSCU>();
  auto scu = std::make_unique<DcmTLSSCU>(peer.host.c_str(), peer.title.c_str(), peer.port);
  for (const auto& file : {peer.tls->trusted, peer.tls->certificate, peer.tls->key})
    if (!file.empty() && !std::filesystem::is_regular_file(file))
      throw BadInput(file.string() + ": there is no such file; TLS needs it in PEM format");
  if (!peer.tls->certificate.empty())
    scu->enableAuthentication(peer.tls->key.c_str(), peer.tls->certificate.c_str(), nullptr,
                              DCF_Filetype_PEM);
  scu->addTrustedCertFile(peer.tls->trusted.c_str());
  scu->setPeerCertVerification(DCV_requireCertificate);
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

std::string send_dicom(const std::vector<std::filesystem::path>& files, const DicomPeer& peer,
                       const std::function<void(std::size_t, const std::string&)>& answered) {
  OFLog::configure(OFLogger::OFF_LOG_LEVEL);  // what matters comes back as a sentence
  std::set<std::string> classes;
  std::vector<bool> readable;
  for (const std::filesystem::path& file : files) {
    const std::string name = sop_class(file);
    readable.push_back(!name.empty());
    if (!name.empty()) classes.insert(name);
  }
  const std::unique_ptr<DcmSCU> scu = make_scu(peer);
  scu->setAETitle(peer.our_title.c_str());
  scu->setPeerAETitle(peer.title.c_str());
  scu->setPeerHostName(peer.host.c_str());
  scu->setPeerPort(peer.port);
  scu->setConnectionTimeout(connection_s);
  scu->setACSETimeout(answer_s);
  scu->setDIMSETimeout(answer_s);
  scu->setDIMSEBlockingMode(DIMSE_NONBLOCKING);
  OFList<OFString> syntaxes;
  syntaxes.push_back(UID_LittleEndianExplicitTransferSyntax);
  syntaxes.push_back(UID_LittleEndianImplicitTransferSyntax);
  for (const std::string& name : classes) scu->addPresentationContext(name.c_str(), syntaxes);

  const auto trouble = [&](const char* what, const OFCondition& cause) {
    std::string text = cause.text();
    for (char& c : text)
      if (c == '\n') c = ' ';
    return fmt::format("{}: {} ({}); check its address and that it knows {}", place(peer), what, text,
                       peer.our_title);
  };
  if (const OFCondition made = scu->initNetwork(); made.bad()) return trouble("no network", made);
  if (const OFCondition made = scu->negotiateAssociation(); made.bad())
    return trouble("no association", made);
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!readable[i]) {
      answered(i, files[i].string() + ": this is no DICOM file");
      continue;
    }
    Uint16 status = 0;
    const OFCondition sent = scu->sendSTORERequest(0, files[i].c_str(), nullptr, status);
    if (sent.bad()) {
      scu->abortAssociation();
      return trouble("the connection was lost", sent);
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
