#include "app/exchange/dicom_commit.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmnet/scp.h>
#include <dcmtk/dcmnet/scu.h>
#include <dcmtk/dcmtls/tlslayer.h>
#include <dcmtk/dcmtls/tlsscu.h>
#include <fmt/format.h>

#include "app/bad_input.h"
#include "app/exchange/dicom_scu.h"

namespace sonoband::exchange {
namespace {

constexpr std::uint16_t unknown_transaction = 0x0110;  // "processing failure": PS3.7, C.5
constexpr std::uint16_t request_action = 1;            // PS3.4, J.3.2
constexpr unsigned association_s = 30;                 // silence after which an archive's association ends

std::string text(DcmItem& item, const DcmTagKey& tag) {
  OFString value;
  item.findAndGetOFString(tag, value);
  return value.c_str();
}

DicomReference reference(DcmItem& item) {
  return {text(item, DCM_ReferencedSOPClassUID), text(item, DCM_ReferencedSOPInstanceUID)};
}

CommitmentAnswer understood(DcmDataset& dataset) {
  CommitmentAnswer answer;
  answer.transaction = text(dataset, DCM_TransactionUID);
  DcmItem* item = nullptr;
  for (long i = 0;
       dataset.findAndGetSequenceItem(DCM_ReferencedSOPSequence, item, i).good() && item != nullptr; ++i)
    answer.kept.push_back(reference(*item));
  item = nullptr;
  for (long i = 0; dataset.findAndGetSequenceItem(DCM_FailedSOPSequence, item, i).good() && item != nullptr;
       ++i) {
    Uint16 reason = 0;
    item->findAndGetUint16(DCM_FailureReason, reason);
    answer.refused.push_back({reference(*item), reason});
  }
  return answer;
}

Uint16 taken(const TakeAnswer& take, DcmDataset* dataset) {
  return dataset != nullptr && take(understood(*dataset)) ? STATUS_Success : unknown_transaction;
}

// Base is DcmSCU or DcmTLSSCU.
template <class Base>
class Asking final : public Base {
 public:
  using Base::Base;
  TakeAnswer take;

 private:
  Uint16 checkEVENTREPORTRequest(T_DIMSE_N_EventReportRQ&, DcmDataset* dataset) override {
    return taken(take, dataset);
  }
};

}  // namespace

CommitmentAsked ask_commitment(const std::vector<DicomReference>& objects, const DicomPeer& peer,
                               const std::string& transaction, int stay_s, const TakeAnswer& take) {
  std::unique_ptr<DcmSCU> scu;
  if (peer.tls) {
    auto secure = std::make_unique<Asking<DcmTLSSCU>>(peer.host.c_str(), peer.title.c_str(), peer.port);
    secure->take = take;
    trust(*secure, *peer.tls);
    scu = std::move(secure);
  } else {
    auto plain = std::make_unique<Asking<DcmSCU>>();
    plain->take = take;
    scu = std::move(plain);
  }
  address(*scu, peer);
  offer(*scu, UID_StorageCommitmentPushModelSOPClass);
  if (const OFCondition made = scu->initNetwork(); made.bad())
    return {Asked::failed, trouble_with(peer, "no network", made)};
  if (const OFCondition made = scu->negotiateAssociation(); made.bad()) {
    // An association that offers nothing the other side knows is refused as a whole.
    if (made == NET_EC_NoAcceptablePresentationContexts)
      return {Asked::not_offered, place_of(peer) + " offers no storage commitment"};
    return {Asked::failed, trouble_with(peer, "no association", made)};
  }
  const T_ASC_PresentationContextID context =
      scu->findAnyPresentationContextID(UID_StorageCommitmentPushModelSOPClass, "");
  if (context == 0) {
    scu->releaseAssociation();
    return {Asked::not_offered, place_of(peer) + " offers no storage commitment"};
  }
  DcmDataset request;
  request.putAndInsertString(DCM_TransactionUID, transaction.c_str());
  for (const DicomReference& object : objects) {
    DcmItem* item = nullptr;
    request.findOrCreateSequenceItem(DCM_ReferencedSOPSequence, item, -2);
    item->putAndInsertString(DCM_ReferencedSOPClassUID, object.sop_class.c_str());
    item->putAndInsertString(DCM_ReferencedSOPInstanceUID, object.sop_instance.c_str());
  }
  Uint16 status = 0;
  const OFCondition sent = scu->sendACTIONRequest(context, UID_StorageCommitmentPushModelSOPInstance,
                                                  request_action, &request, status);
  if (sent.bad()) {
    scu->abortAssociation();
    return {Asked::failed, trouble_with(peer, "the connection was lost", sent)};
  }
  if (status != 0) {
    scu->releaseAssociation();
    return {Asked::failed, fmt::format("{}: the archive refused to answer for its storage (status {:04x}h)",
                                       place_of(peer), status)};
  }
  if (stay_s > 0) {
    DcmDataset* answer = nullptr;
    Uint16 type = 0;
    // Nothing within this time: the archive comes later, on an association of its own.
    scu->handleEVENTREPORTRequest(answer, type, stay_s);
    delete answer;
  }
  scu->releaseAssociation();
  return {Asked::asked, {}};
}

namespace {

// DCMTK 3.6.9 (Debian 13) wants to know for which profile a certificate is to do; 3.6.7 (Debian 12) does not.
template <typename Layer>
OFCondition set_certificate(Layer& layer, const std::filesystem::path& file, DcmTLSSecurityProfile profile) {
  if constexpr (requires { layer.setCertificateFile(file.c_str(), DCF_Filetype_PEM, profile); })
    return layer.setCertificateFile(file.c_str(), DCF_Filetype_PEM, profile);
  else
    return layer.setCertificateFile(file.c_str(), DCF_Filetype_PEM);
}

// The part of the one who is called.
std::unique_ptr<DcmTLSTransportLayer> answering_layer(const DicomTls& tls) {
  check_files(tls);
  constexpr DcmTLSSecurityProfile profile = TSP_Profile_BCP195;
  const auto sound = [](const OFCondition& done, const std::filesystem::path& file) {
    if (done.bad()) throw BadInput(fmt::format("{}: TLS cannot use it ({})", file.string(), done.text()));
  };
  auto layer = std::make_unique<DcmTLSTransportLayer>(NET_ACCEPTOR, nullptr, OFTrue);
  sound(layer->setTLSProfile(profile), tls.certificate);
  sound(layer->activateCipherSuites(), tls.certificate);
  sound(layer->setPrivateKeyFile(tls.key.c_str(), DCF_Filetype_PEM), tls.key);
  sound(set_certificate(*layer, tls.certificate, profile), tls.certificate);
  if (!layer->checkPrivateKeyMatchesCertificate())
    throw BadInput(tls.key.string() + ": this is not the key of " + tls.certificate.string());
  sound(layer->addTrustedCertificateFile(tls.trusted.c_str(), DCF_Filetype_PEM), tls.trusted);
  layer->setCertificateVerification(DCV_requireCertificate);
  return layer;
}

}  // namespace

struct CommitmentListener::Scp final : DcmSCP {
  std::unique_ptr<DcmTLSTransportLayer> layer;  // null: without TLS
  TakeAnswer take;
  const std::function<bool()>* enough = nullptr;

  OFCondition handleIncomingCommand(T_DIMSE_Message* message,
                                    const DcmPresentationContextInfo& context) override {
    if (message->CommandField != DIMSE_N_EVENT_REPORT_RQ)
      return DcmSCP::handleIncomingCommand(message, context);
    DcmDataset* dataset = nullptr;
    Uint16 type = 0;
    const OFCondition heard =
        handleEVENTREPORTRequest(message->msg.NEventReportRQ, context.presentationContextID, dataset, type);
    delete dataset;
    return heard;
  }
  Uint16 checkEVENTREPORTRequest(T_DIMSE_N_EventReportRQ&, DcmDataset* dataset) override {
    return taken(take, dataset);
  }
  OFBool stopAfterCurrentAssociation() override { return enough != nullptr && (*enough)(); }
  OFBool stopAfterConnectionTimeout() override { return enough != nullptr && (*enough)(); }
};

CommitmentListener::CommitmentListener(std::uint16_t port, const std::string& our_title, TakeAnswer take,
                                       const std::optional<DicomTls>& tls)
    : scp_(std::make_unique<Scp>()) {
  OFLog::configure(OFLogger::OFF_LOG_LEVEL);
  scp_->take = std::move(take);
  if (tls) {
    scp_->layer = answering_layer(*tls);
    scp_->getConfig().setTransportLayer(scp_->layer.get());
  }
  scp_->setPort(port);
  scp_->setAETitle(our_title.c_str());
  scp_->setConnectionBlockingMode(DUL_NOBLOCK);
  scp_->setConnectionTimeout(1);
  scp_->setDIMSEBlockingMode(DIMSE_NONBLOCKING);
  scp_->setDIMSETimeout(association_s);
  scp_->setACSETimeout(association_s);
  scp_->setHostLookupEnabled(OFFalse);
  // The archive keeps the part of the provider although it is the one that calls.
  OFList<OFString> syntaxes;
  syntaxes.push_back(UID_LittleEndianExplicitTransferSyntax);
  syntaxes.push_back(UID_LittleEndianImplicitTransferSyntax);
  scp_->addPresentationContext(UID_StorageCommitmentPushModelSOPClass, syntaxes, ASC_SC_ROLE_SCP);
  scp_->addPresentationContext(UID_VerificationSOPClass, syntaxes);
  if (const OFCondition opened = scp_->openListenPort(); opened.bad())
    throw BadInput(fmt::format("port {}: cannot be listened on for the archive's answer ({}); choose another",
                               port, opened.text()));
}

CommitmentListener::~CommitmentListener() = default;

void CommitmentListener::hear(const std::function<bool()>& enough) {
  if (enough()) return;
  scp_->enough = &enough;
  scp_->acceptAssociations();
  scp_->enough = nullptr;
}

}  // namespace sonoband::exchange
