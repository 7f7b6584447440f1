#include "app/exchange/igtl_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <deque>

#include "app/bad_input.h"

namespace sonoband::exchange {

struct IgtlServer::Client {
  explicit Client(int s) : socket(s) {}
  ~Client() { ::close(socket); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  int socket;
  IgtlRequests requests;
  std::deque<IgtlBytes> unsent;
  std::size_t unsent_bytes = 0;
  std::size_t sent_of_first = 0;
  bool tracking = false;
  std::int64_t tracking_every_ns = 0;
  std::optional<std::int64_t> tracked_utc_ns;
};

IgtlServer::IgtlServer(const IgtlSettings& settings) : settings_(settings) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(settings.port);
  if (::inet_pton(AF_INET, settings.bind.c_str(), &address.sin_addr) != 1)
    throw BadInput(settings.bind + ": this is no address to listen on; write one as 127.0.0.1");
  listening_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int on = 1;
  ::setsockopt(listening_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (::bind(listening_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(listening_, 16) != 0) {
    const std::string why = std::strerror(errno);
    ::close(listening_);
    throw BadInput(fmt::format("port {} of {} cannot be listened on: {}; choose another", settings.port,
                               settings.bind, why));
  }
  socklen_t size = sizeof address;
  ::getsockname(listening_, reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
  wake_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  thread_ = std::thread([this] { serve(); });
}

IgtlServer::~IgtlServer() {
  ending_ = true;
  ::eventfd_write(wake_, 1);
  thread_.join();
  clients_.clear();
  ::close(listening_);
  ::close(wake_);
}

void IgtlServer::publish(IgtlBytes message) {
  {
    const std::lock_guard lock(mutex_);
    ++status_.messages;
    if (!anyone_) return;
    published_.push_back({std::move(message), false, 0});
  }
  ::eventfd_write(wake_, 1);
}

void IgtlServer::publish(const IgtlFrame& f) {
  if (!anyone_ || !f.world_from_image) {
    const std::lock_guard lock(mutex_);
    ++status_.messages;
    return;
  }
  publish(igtl_transform(f.image + "To" + f.world, f.utc_ns, f.world_from_image->linear,
                         f.world_from_image->translation));
  publish(f.kind == PixelKind::grey
              ? igtl_image(f.image, f.utc_ns, f.pixels, *f.world_from_image)
              : igtl_image(f.image, f.utc_ns, picture_png(f.pixels, f.kind), *f.world_from_image));
  if (!f.tracker_from_probe) return;
  publish(igtl_transform("ProbeToTracker", f.utc_ns, f.tracker_from_probe->rotation,
                         f.tracker_from_probe->translation));
  if (!trackers_) return;
  IgtlBytes tracking = igtl_tracking("Tracker", f.utc_ns, {{"Probe", *f.tracker_from_probe}});
  {
    const std::lock_guard lock(mutex_);
    published_.push_back({std::move(tracking), true, f.utc_ns});
  }
  ::eventfd_write(wake_, 1);
}

void IgtlServer::keep(const std::string& name, IgtlBytes message) {
  {
    const std::lock_guard lock(mutex_);
    kept_[name] = message;
  }
  publish(std::move(message));
}

void IgtlServer::set_status(bool good, const std::string& sentence) {
  const IgtlBytes message = igtl_status("Sonoband", 0, good, sentence);
  {
    const std::lock_guard lock(mutex_);
    if (status_message_ && *status_message_ == *message) return;
    status_message_ = message;
  }
  publish(message);
}

IgtlStatus IgtlServer::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void IgtlServer::give(Client& client, const IgtlBytes& message) {
  client.unsent_bytes += message->size();
  client.unsent.push_back(message);
}

void IgtlServer::take_published() {
  std::vector<Waiting> news;
  {
    const std::lock_guard lock(mutex_);
    news.swap(published_);
  }
  for (const Waiting& w : news) {
    for (const auto& client : clients_) {
      if (!w.tracking) {
        give(*client, w.message);
        continue;
      }
      if (!client->tracking) continue;
      // Going back in time is a recording that starts anew.
      if (client->tracked_utc_ns && w.utc_ns >= *client->tracked_utc_ns &&
          w.utc_ns < *client->tracked_utc_ns + client->tracking_every_ns)
        continue;
      client->tracked_utc_ns = w.utc_ns;
      give(*client, w.message);
    }
  }
}

void IgtlServer::take_clients() {
  for (;;) {
    const int s = ::accept4(listening_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (s < 0) return;
    if (clients_.size() >= settings_.most_clients) {
      ::close(s);
      const std::lock_guard lock(mutex_);
      ++status_.refused;
      continue;
    }
    const int on = 1;
    ::setsockopt(s, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    clients_.push_back(std::make_unique<Client>(s));
    const std::lock_guard lock(mutex_);
    if (status_message_) give(*clients_.back(), status_message_);
    for (const auto& [name, message] : kept_) give(*clients_.back(), message);
  }
}

bool IgtlServer::hear(Client& client) {
  std::array<std::uint8_t, 4096> bytes;
  for (int rounds = 0; rounds < 16; ++rounds) {
    const ssize_t got = ::recv(client.socket, bytes.data(), bytes.size(), 0);
    if (got == 0) return false;
    if (got < 0) return errno == EAGAIN || errno == EINTR;
    bool good = true;
    for (const IgtlRequest& r :
         client.requests.feed(std::span(bytes).first(static_cast<std::size_t>(got)), good)) {
      if (r.kind == IgtlRequest::Kind::start_tracking) {
        client.tracking = true;
        client.tracking_every_ns = r.interval.count();
        client.tracked_utc_ns.reset();
      } else if (r.kind == IgtlRequest::Kind::stop_tracking) {
        client.tracking = false;
      } else if (r.kind == IgtlRequest::Kind::get_status) {
        const std::lock_guard lock(mutex_);
        if (status_message_) give(client, status_message_);
      }
    }
    if (!good) {
      const std::lock_guard lock(mutex_);
      ++status_.dropped_broken;
      return false;
    }
  }
  return true;
}

bool IgtlServer::write(Client& client) {
  while (!client.unsent.empty()) {
    const std::vector<std::uint8_t>& first = *client.unsent.front();
    const ssize_t sent = ::send(client.socket, first.data() + client.sent_of_first,
                                first.size() - client.sent_of_first, MSG_NOSIGNAL);
    if (sent < 0) return errno == EAGAIN || errno == EINTR;
    client.sent_of_first += static_cast<std::size_t>(sent);
    if (client.sent_of_first < first.size()) return true;
    client.unsent_bytes -= first.size();
    client.sent_of_first = 0;
    client.unsent.pop_front();
  }
  return true;
}

void IgtlServer::serve() {
  std::vector<pollfd> polled;
  while (!ending_) {
    polled.clear();
    polled.push_back({listening_, POLLIN, 0});
    polled.push_back({wake_, POLLIN, 0});
    for (const auto& client : clients_)
      polled.push_back(
          {client->socket, static_cast<short>(client->unsent.empty() ? POLLIN : POLLIN | POLLOUT), 0});
    ::poll(polled.data(), polled.size(), -1);
    eventfd_t count = 0;
    ::eventfd_read(wake_, &count);
    for (std::size_t i = 0; i < clients_.size(); ++i) {
      const short happened = polled[i + 2].revents;
      if ((happened & (POLLIN | POLLHUP | POLLERR)) != 0 && !hear(*clients_[i])) clients_[i].reset();
    }
    std::erase(clients_, nullptr);
    take_clients();
    take_published();
    std::uint64_t slow = 0;
    bool trackers = false;
    for (auto& client : clients_) {
      if (!write(*client)) {
        client.reset();
      } else if (client->unsent_bytes > settings_.most_unsent_bytes) {
        client.reset();
        ++slow;
      } else {
        trackers = trackers || client->tracking;
      }
    }
    std::erase(clients_, nullptr);
    anyone_ = !clients_.empty();
    trackers_ = trackers;
    const std::lock_guard lock(mutex_);
    status_.clients = clients_.size();
    status_.dropped_slow += slow;
  }
}

}  // namespace sonoband::exchange
