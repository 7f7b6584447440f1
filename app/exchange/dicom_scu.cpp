#include "app/exchange/dicom_scu.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmnet/scu.h>
#include <dcmtk/dcmtls/tlsscu.h>
#include <fmt/format.h>

#include "app/bad_input.h"

namespace sonoband::exchange {
namespace {

constexpr int connection_s = 10;
constexpr unsigned answer_s = 60;

}  // namespace

std::string place_of(const DicomPeer& peer) {
  return fmt::format("{}@{}:{}", peer.title, peer.host, peer.port);
}

std::string trouble_with(const DicomPeer& peer, const char* what, const OFCondition& cause) {
  std::string text = cause.text();
  for (char& c : text)
    if (c == '\n') c = ' ';
  return fmt::format("{}: {} ({}); check its address and that it knows {}", place_of(peer), what, text,
                     peer.our_title);
}

void address(DcmSCU& scu, const DicomPeer& peer) {
  OFLog::configure(OFLogger::OFF_LOG_LEVEL);  // what matters comes back as a sentence
  scu.setAETitle(peer.our_title.c_str());
  scu.setPeerAETitle(peer.title.c_str());
  scu.setPeerHostName(peer.host.c_str());
  scu.setPeerPort(peer.port);
  scu.setConnectionTimeout(connection_s);
  scu.setACSETimeout(answer_s);
  scu.setDIMSETimeout(answer_s);
  scu.setDIMSEBlockingMode(DIMSE_NONBLOCKING);
}

void check_files(const DicomTls& tls) {
  for (const auto& file : {tls.trusted, tls.certificate, tls.key})
    if (!file.empty() && !std::filesystem::is_regular_file(file))
      throw BadInput(file.string() + ": there is no such file; TLS needs it in PEM format");
}

void trust(DcmTLSSCU& scu, const DicomTls& tls) {
  check_files(tls);
  if (!tls.certificate.empty())
    scu.enableAuthentication(tls.key.c_str(), tls.certificate.c_str(), nullptr, DCF_Filetype_PEM);
  scu.addTrustedCertFile(tls.trusted.c_str());
  scu.setPeerCertVerification(DCV_requireCertificate);
}

void offer(DcmSCU& scu, const std::string& sop_class) {
  OFList<OFString> syntaxes;
  syntaxes.push_back(UID_LittleEndianExplicitTransferSyntax);
  syntaxes.push_back(UID_LittleEndianImplicitTransferSyntax);
  scu.addPresentationContext(sop_class.c_str(), syntaxes);
}

}  // namespace sonoband::exchange
