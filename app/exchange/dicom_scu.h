// What every association that we open has in common.
#pragma once

#include <string>

#include "app/exchange/dicom_send.h"

class DcmSCU;
class DcmTLSSCU;
class OFCondition;

namespace sonoband::exchange {

std::string place_of(const DicomPeer& peer);
// One line, with what to check.
std::string trouble_with(const DicomPeer& peer, const char* what, const OFCondition& cause);

// Titles, host, port and how long to wait.
void address(DcmSCU& scu, const DicomPeer& peer);
// Throws BadInput where a file that is named is not there.
void check_files(const DicomTls& tls);
// The same.
void trust(DcmTLSSCU& scu, const DicomTls& tls);
// The class with both uncompressed little-endian syntaxes.
void offer(DcmSCU& scu, const std::string& sop_class);

}  // namespace sonoband::exchange
