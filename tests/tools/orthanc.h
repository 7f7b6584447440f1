// Orthanc, a DICOM archive of Debian's, with an empty store of its own while this lives.
#pragma once

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "tests/tools/processes.h"

namespace sonoband::test {

class Orthanc {
 public:
  // `our_port`: where it brings the answers of storage commitment, to the title SONOBAND; 0: it does not know
  // us.
  // With `tls` it speaks nothing else: FOLDER/../archive.pem and .key are its own, and it trusts ours.pem.
  explicit Orthanc(const std::filesystem::path& folder, std::uint16_t our_port = 0, bool tls = false)
      : dicom_port_(free_port()) {
    while (http_port_ == 0 || http_port_ == dicom_port_) http_port_ = free_port();
    std::filesystem::create_directory(folder);
    nlohmann::json config{{"Name", "test"},
                          {"StorageDirectory", folder.string()},
                          {"IndexDirectory", folder.string()},
                          {"DicomAet", "ORTHANC"},
                          {"DicomPort", dicom_port_},
                          {"HttpPort", http_port_},
                          {"DicomAlwaysAllowStore", true},
                          {"RemoteAccessAllowed", false},
                          {"AuthenticationEnabled", false},
                          {"Plugins", nlohmann::json::array()}};
    if (our_port != 0) config["DicomModalities"] = {{"us", {"SONOBAND", "127.0.0.1", our_port}}};
    if (tls) {
      const std::filesystem::path keys = folder.parent_path();
      config["DicomTlsEnabled"] = true;
      config["DicomTlsCertificate"] = (keys / "archive.pem").string();
      config["DicomTlsPrivateKey"] = (keys / "archive.key").string();
      config["DicomTlsTrustedCertificates"] = (keys / "ours.pem").string();
      config["DicomModalities"] = {
          {"us", {{"AET", "SONOBAND"}, {"Host", "127.0.0.1"}, {"Port", our_port}, {"UseDicomTls", true}}}};
    }
    const std::filesystem::path file = folder / "orthanc.json";
    std::ofstream(file) << config.dump();
    server_ = std::make_unique<Server>(std::vector<std::string>{"Orthanc", file.string()}, http_port_,
                                       folder / "orthanc.log");
  }

  bool up() const { return server_->up(); }
  std::string peer() const { return "ORTHANC@127.0.0.1:" + std::to_string(dicom_port_); }

  // The body of its answer.
  std::string http(const std::string& verb, const std::string& what) const {
    const int s = connected(http_port_);
    if (s < 0) return {};
    const std::string request = verb + " " + what + " HTTP/1.0\r\nHost: localhost\r\n\r\n";
    static_cast<void>(::send(s, request.data(), request.size(), MSG_NOSIGNAL));
    std::string reply;
    char buffer[65536];
    for (ssize_t n; (n = ::recv(s, buffer, sizeof buffer, 0)) > 0;)
      reply.append(buffer, static_cast<std::size_t>(n));
    ::close(s);
    const std::size_t body = reply.find("\r\n\r\n");
    return body == std::string::npos ? std::string() : reply.substr(body + 4);
  }

 private:
  std::uint16_t dicom_port_;
  std::uint16_t http_port_ = 0;
  std::unique_ptr<Server> server_;
};

}  // namespace sonoband::test
