#include "tests/virtual_board/redir_server.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "hal/tracker/little_endian.h"

namespace sonoband::virtual_board {
namespace {

// Message types of the usbredir protocol.
enum Type : std::uint32_t {
  hello = 0,
  device_connect = 1,
  reset = 3,
  interface_info = 4,
  ep_info = 5,
  set_configuration = 6,
  get_configuration = 7,
  configuration_status = 8,
  set_alt_setting = 9,
  get_alt_setting = 10,
  alt_setting_status = 11,
  cancel_data_packet = 21,
  control_packet = 100,
  bulk_packet = 101,
};
// Capabilities: device version, endpoint packet sizes and 64-bit ids (QEMU's xhci asks for both), long bulk.
constexpr std::uint32_t capabilities = 1U << 1 | 1U << 4 | 1U << 5 | 1U << 6;
constexpr std::uint8_t success = 0;
constexpr std::uint8_t cancelled = 1;
constexpr std::uint8_t stall = 4;
constexpr std::size_t longest_message = 1 << 20;
constexpr std::size_t most_pending = 256;
constexpr unsigned invalid_type = 255;

}  // namespace

RedirSession::RedirSession(UsbDevice& device) : device_(device) {}

void RedirSession::say(std::uint32_t type, std::uint64_t id, std::span<const std::uint8_t> body,
                       Bytes& out) const {
  Fields f;
  f.u32(type).u32(static_cast<unsigned>(body.size())).u32(static_cast<unsigned>(id));
  if (type != hello) f.u32(static_cast<unsigned>(id >> 32));  // ids are long once both have said hello
  out.insert(out.end(), f.out.begin(), f.out.end());
  out.insert(out.end(), body.begin(), body.end());
}

bool RedirSession::hear(std::span<const std::uint8_t> bytes, Bytes& out) {
  if (!said_hello_) {
    said_hello_ = true;
    Bytes greeting(64, 0);
    std::snprintf(reinterpret_cast<char*>(greeting.data()), 64, "sonoband virtual board");
    const Bytes able = Fields().u32(capabilities).out;
    greeting.insert(greeting.end(), able.begin(), able.end());
    say(hello, 0, greeting, out);
  }
  heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  std::size_t at = 0;
  while (true) {
    const std::size_t header = greeted_ ? 16 : 12;
    if (heard_.size() - at < header) break;
    const std::uint8_t* p = heard_.data() + at;
    const std::uint32_t type = wire::load_u32(p);
    const std::size_t length = wire::load_u32(p + 4);
    const std::uint64_t id =
        wire::load_u32(p + 8) | (greeted_ ? std::uint64_t{wire::load_u32(p + 12)} << 32 : 0);
    if (length > longest_message || (!greeted_ && type != hello)) return false;
    if (heard_.size() - at < header + length) break;
    if (!handle(type, id, {p + header, length}, out)) return false;
    at += header + length;
  }
  heard_.erase(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(at));
  return true;
}

bool RedirSession::handle(std::uint32_t type, std::uint64_t id, std::span<const std::uint8_t> body,
                          Bytes& out) {
  switch (type) {
    case hello:
      if (body.size() < 64 || greeted_) return false;
      greeted_ = true;
      announce(out);
      return true;
    case set_configuration:
      if (body.empty()) return false;
      say(configuration_status, id, Bytes{success, body[0]}, out);
      return true;
    case get_configuration:
      say(configuration_status, id, Bytes{success, 1}, out);
      return true;
    case set_alt_setting:
      if (body.size() < 2) return false;
      say(alt_setting_status, id, Bytes{success, body[0], body[1]}, out);
      return true;
    case get_alt_setting:
      if (body.empty()) return false;
      say(alt_setting_status, id, Bytes{success, body[0], 0}, out);
      return true;
    case cancel_data_packet: {
      const auto found =
          std::find_if(pending_.begin(), pending_.end(), [&](const Pending& p) { return p.id == id; });
      if (found == pending_.end()) return true;
      say(bulk_packet, id, Fields().u8(found->endpoint).u8(cancelled).u16(0).u32(0).u16(0).out, out);
      pending_.erase(found);
      return true;
    }
    case control_packet:
      return control(id, body, out);
    case bulk_packet:
      return bulk(id, body, out);
    default:  // reset, and what this device has no use for
      return true;
  }
}

void RedirSession::announce(Bytes& out) {
  const Bytes& c = device_.configuration();
  struct Interface {
    unsigned number = 0, of_class = 0, subclass = 0, protocol = 0;
  };
  std::vector<Interface> interfaces;
  std::array<unsigned, 32> type{}, interval{}, of_interface{}, packet{};
  type.fill(invalid_type);
  type[0] = type[16] = 0;
  packet[0] = packet[16] = 64;
  unsigned current = 0;
  for (std::size_t i = 0; i + 1 < c.size() && c[i] > 0; i += c[i]) {
    if (c[i + 1] == 4 && c[i + 3] == 0) {
      interfaces.push_back({c[i + 2], c[i + 5], c[i + 6], c[i + 7]});
      current = c[i + 2];
    }
    if (c[i + 1] == 5) {
      const unsigned address = c[i + 2];
      const std::size_t k = (address & 0x80) >> 3 | (address & 15);
      type[k] = c[i + 3] & 3;
      packet[k] = wire::load_u16(c.data() + i + 4);
      interval[k] = c[i + 6];
      of_interface[k] = current;
    }
  }
  Fields info;
  info.u32(static_cast<unsigned>(interfaces.size()));
  const auto column = [&](auto member) {
    for (std::size_t i = 0; i < 32; ++i) info.u8(i < interfaces.size() ? interfaces[i].*member : 0);
  };
  column(&Interface::number);
  column(&Interface::of_class);
  column(&Interface::subclass);
  column(&Interface::protocol);
  say(interface_info, 0, info.out, out);
  Fields endpoints;
  for (const unsigned v : type) endpoints.u8(v);
  for (const unsigned v : interval) endpoints.u8(v);
  for (const unsigned v : of_interface) endpoints.u8(v);
  for (const unsigned v : packet) endpoints.u16(v);
  say(ep_info, 0, endpoints.out, out);
  const Bytes& d = device_.device_descriptor();
  constexpr unsigned high_speed = 2;
  say(device_connect, 0,
      Fields()
          .u8(high_speed)
          .u8(d[4])
          .u8(d[5])
          .u8(d[6])
          .u16(wire::load_u16(d.data() + 8))
          .u16(wire::load_u16(d.data() + 10))
          .u16(wire::load_u16(d.data() + 12))
          .out,
      out);
}

std::optional<Bytes> RedirSession::standard_request(const Setup& setup) {
  switch (setup.request) {
    case 6: {  // descriptor
      const int kind = setup.value >> 8;
      if (kind == 1) return device_.device_descriptor();
      if (kind == 2) return device_.configuration();
      if (kind == 6) {  // the other speed
        const Bytes& d = device_.device_descriptor();
        return Fields().u8(10).u8(6).u16(0x200).u8(d[4]).u8(d[5]).u8(d[6]).u8(64).u8(1).u8(0).out;
      }
      Bytes text = kind == 3 ? device_.string(setup.value & 0xff) : Bytes{};
      if (text.empty()) return std::nullopt;
      return text;
    }
    case 0:
      return Bytes{0, 0};
    case 8:
      return Bytes{1};
    case 10:
      return Bytes{0};
    case 1:
    case 3:
    case 9:
    case 11:
      return Bytes{};
    default:
      return std::nullopt;
  }
}

bool RedirSession::control(std::uint64_t id, std::span<const std::uint8_t> body, Bytes& out) {
  if (body.size() < 10) return false;
  const Setup setup{.request_type = body[2],
                    .request = body[1],
                    .value = wire::load_u16(body.data() + 4),
                    .index = wire::load_u16(body.data() + 6),
                    .length = wire::load_u16(body.data() + 8)};
  auto answer = (setup.request_type & 0x60) == 0 ? standard_request(setup)
                                                 : device_.class_request(setup, body.subspan(10));
  const bool in = (body[0] & 0x80) != 0;
  const std::uint8_t status = answer ? success : stall;
  if (answer && answer->size() > setup.length) answer->resize(setup.length);
  const std::size_t length = !answer ? 0 : in ? answer->size() : setup.length;
  Fields reply;
  reply.u8(body[0])
      .u8(setup.request)
      .u8(setup.request_type)
      .u8(status)
      .u16(setup.value)
      .u16(setup.index)
      .u16(static_cast<unsigned>(length));
  if (in && answer) reply.bytes(*answer);
  say(control_packet, id, reply.out, out);
  return true;
}

bool RedirSession::bulk(std::uint64_t id, std::span<const std::uint8_t> body, Bytes& out) {
  if (body.size() < 10) return false;
  const std::uint8_t endpoint = body[0];
  const std::size_t length = wire::load_u16(body.data() + 2) | std::size_t{wire::load_u16(body.data() + 8)}
                                                                   << 16;
  if ((endpoint & 0x80) != 0) {
    if (pending_.size() >= most_pending) return false;
    pending_.push_back({id, endpoint, std::min(length, longest_message)});
    return true;
  }
  device_.bulk_out(body.subspan(10));
  say(bulk_packet, id,
      Fields()
          .u8(endpoint)
          .u8(success)
          .u16(static_cast<unsigned>(length & 0xffff))
          .u32(0)
          .u16(static_cast<unsigned>(length >> 16))
          .out,
      out);
  return true;
}

bool RedirSession::pump(Bytes& out) {
  if (pending_.empty()) return false;
  const Pending p = pending_.front();
  const auto data = device_.bulk_in(p.length);
  if (!data) return false;
  pending_.pop_front();
  Fields reply;
  reply.u8(p.endpoint)
      .u8(success)
      .u16(static_cast<unsigned>(data->size() & 0xffff))
      .u32(0)
      .u16(static_cast<unsigned>(data->size() >> 16))
      .bytes(*data);
  say(bulk_packet, p.id, reply.out, out);
  return true;
}

void serve(UsbDevice& device, const std::string& socket_path, const std::atomic<bool>& stop,
           const std::atomic<bool>& unplugged) {
  ::unlink(socket_path.c_str());
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  std::strncpy(name.sun_path, socket_path.c_str(), sizeof name.sun_path - 1);
  if (listener < 0 || bind(listener, reinterpret_cast<const sockaddr*>(&name), sizeof name) != 0 ||
      listen(listener, 1) != 0) {
    std::fprintf(stderr, "%s: this socket cannot be made\n", socket_path.c_str());
    std::exit(1);
  }
  while (!stop) {
    pollfd waiting{listener, POLLIN, 0};
    if (unplugged || poll(&waiting, 1, 100) <= 0) {
      if (unplugged) usleep(50'000);
      continue;
    }
    const int peer = accept(listener, nullptr, nullptr);
    if (peer < 0) continue;
    RedirSession session(device);
    device.plugged();
    Bytes out;
    std::array<std::uint8_t, 65536> in{};
    bool good = session.hear({}, out);
    bool answered = false;
    while (good && !stop && !unplugged) {
      for (std::size_t sent = 0; sent < out.size();) {
        const ssize_t n = send(peer, out.data() + sent, out.size() - sent, MSG_NOSIGNAL);
        if (n <= 0) {
          good = false;
          break;
        }
        sent += static_cast<std::size_t>(n);
      }
      out.clear();
      pollfd ready{peer, POLLIN, 0};
      const int patience_ms = answered ? 0 : session.waiting() ? 1 : 20;
      if (!good || poll(&ready, 1, patience_ms) < 0) break;
      if (ready.revents != 0) {
        const ssize_t n = recv(peer, in.data(), in.size(), 0);
        good = n > 0 && session.hear({in.data(), static_cast<std::size_t>(n)}, out);
      }
      answered = good && session.pump(out);
    }
    device.unplugged();
    ::close(peer);
  }
  ::close(listener);
  ::unlink(socket_path.c_str());
}

}  // namespace sonoband::virtual_board
