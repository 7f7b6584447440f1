// An OpenIGTLink server for research programs beside the cart: tracked frames, bands, status. Whoever
// publishes never waits for a client; a client that does not keep up is dropped.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/exchange/igtl_messages.h"

namespace sonoband::exchange {

struct IgtlSettings {
  std::string bind = "127.0.0.1";  // an address of this machine; "0.0.0.0" is every one
  std::uint16_t port = 18944;      // the protocol's usual; 0: any free one
  std::size_t most_clients = 16;
  // Unsent bytes at which a client is dropped: 32 MiB are a hundred pictures of 640 x 480.
  std::size_t most_unsent_bytes = std::size_t{32} << 20;
};

struct IgtlStatus {
  std::size_t clients = 0;
  std::uint64_t messages = 0;        // published
  std::uint64_t dropped_slow = 0;    // clients
  std::uint64_t dropped_broken = 0;  // that sent what is no message
  std::uint64_t refused = 0;         // beyond most_clients
};

// A B-scan in space for every client. The pixels are copied.
struct IgtlFrame {
  std::int64_t utc_ns = 0;
  ConstPixels pixels;
  PixelKind kind = PixelKind::grey;  // Doppler keys are sent as colours, as in band_png
  std::string image = "Image";       // device name of the picture
  std::string world = "Tracker";     // the world's name, for the names of the transforms
  // Empty: the frame has no usable pose, and goes nowhere: a picture without a place would be a wrong one.
  std::optional<Affine<frame::World, frame::Image>> world_from_image;
  std::optional<Rigid<frame::Tracker, frame::Probe>> tracker_from_probe;
};

class IgtlServer {
 public:
  // Throws BadInput where the address or port cannot be had.
  explicit IgtlServer(const IgtlSettings& settings);
  ~IgtlServer();
  IgtlServer(const IgtlServer&) = delete;
  IgtlServer& operator=(const IgtlServer&) = delete;

  std::uint16_t port() const { return port_; }

  // Any thread; these never wait for a client. IMAGE `image`, TRANSFORM ImageTo<world> and ProbeToTracker to
  // all; TDATA to those who asked for it, as often as they asked.
  void publish(const IgtlFrame& frame);
  // To all.
  void publish(IgtlBytes message);
  // To all, and to whoever connects later: the newest of this name, for example a band.
  void keep(const std::string& name, IgtlBytes message);
  // Answers GET_STATUS from now on, and goes to all when it changes.
  void set_status(bool good, const std::string& sentence);

  IgtlStatus status() const;

 private:
  struct Client;
  struct Waiting {
    IgtlBytes message;
    bool tracking = false;  // only for those who asked
    std::int64_t utc_ns = 0;
  };

  void serve();
  void take_published();
  void take_clients();
  bool hear(Client& client);   // false: it is gone or broken
  bool write(Client& client);  // false: it is gone
  void give(Client& client, const IgtlBytes& message);

  IgtlSettings settings_;
  std::uint16_t port_ = 0;
  int listening_ = -1;
  int wake_ = -1;                                 // eventfd
  std::vector<std::unique_ptr<Client>> clients_;  // the server's thread only
  mutable std::mutex mutex_;                      // held for moments
  std::vector<Waiting> published_;
  IgtlBytes status_message_;
  std::map<std::string, IgtlBytes> kept_;
  IgtlStatus status_;
  std::atomic<bool> anyone_{false};
  std::atomic<bool> trackers_{false};
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace sonoband::exchange
