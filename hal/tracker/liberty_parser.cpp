#include "hal/tracker/liberty_parser.h"

#include <algorithm>
#include <cstring>

#include "hal/tracker/little_endian.h"

namespace sonoband::liberty {
namespace {

constexpr std::array<Tag, 3> known_tags{Tag::liberty, Tag::patriot, Tag::latus};

bool is_command_error(std::uint8_t error) {
  return error >= 0x01 && error <= 0x18;
}

}  // namespace

void StreamParser::reset() {
  begin_ = end_ = 0;
  resync_ = false;
}

std::size_t StreamParser::push(std::span<const std::uint8_t> bytes, Stamp now) {
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, held());
    end_ -= begin_;
    begin_ = 0;
  }
  const std::size_t n = std::min(bytes.size(), capacity - end_);
  if (n > 0) {
    std::memcpy(buffer_.data() + end_, bytes.data(), n);
    end_ += n;
    last_push_ = now;
  }
  return n;
}

// As far as the bytes held allow: a wrong tag shows in two bytes.
StreamParser::Judgement StreamParser::judge(std::size_t at) const {
  const std::uint8_t* p = buffer_.data() + at;
  const std::size_t n = end_ - at;
  if (n == 0) return Judgement::incomplete;

  std::optional<Tag> tag;
  for (const Tag t : known_tags) {
    if (expected_.tag && *expected_.tag != t) continue;
    const auto letters = static_cast<std::uint16_t>(t);
    if (p[0] != (letters & 0xff)) continue;
    if (n == 1) return Judgement::incomplete;
    if (p[1] == letters >> 8) tag = t;
  }
  if (!tag) return Judgement::bad;
  if (n < header_bytes) return Judgement::incomplete;

  const std::uint8_t station = p[2];
  const std::uint8_t command = p[3];
  const std::size_t size = wire::load_u16(p + 6);
  if (station > stations_of(*tag)) return Judgement::bad;
  if (size > max_body_bytes) return Judgement::bad;
  if (command == stream_command && !is_command_error(p[4])) {
    if (station == 0) return Judgement::bad;
    if (expected_.stream_body_bytes != 0 && size != expected_.stream_body_bytes) return Judgement::bad;
  }
  return Judgement::good;
}

Packet StreamParser::packet_at(std::size_t at) const {
  const std::uint8_t* p = buffer_.data() + at;
  return {.tag = static_cast<Tag>(wire::load_u16(p)),
          .station = p[2],
          .command = p[3],
          .error = p[4],
          .body = {p + header_bytes, wire::load_u16(p + 6)},
          .arrived = last_push_};
}

void StreamParser::drop(std::size_t bytes) {
  if (!resync_) ++counters_.resync_events;
  resync_ = true;
  counters_.resync_bytes += bytes;
  begin_ += bytes;
}

void StreamParser::take(Packet& out) {
  out = packet_at(begin_);
  begin_ += header_bytes + out.body.size();
  resync_ = false;
  ++counters_.frames;
}

bool StreamParser::next(Packet& out, Stamp now) {
  while (held() > 0) {
    const Judgement here = judge(begin_);
    if (here == Judgement::bad) {
      drop(1);
      continue;
    }
    if (here == Judgement::good) {
      const std::size_t total = header_bytes + packet_at(begin_).body.size();
      if (held() >= total) {
        const Judgement after = resync_ ? judge(begin_ + total) : Judgement::good;
        if (after == Judgement::bad) {
          drop(1);
          continue;
        }
        if (after == Judgement::good) {
          take(out);
          return true;
        }
      }
    }
    return now - last_push_ > expected_.incomplete_limit && on_silence(out);
  }
  return false;
}

// Nothing more came for too long: a lone whole reply stands, everything else goes.
bool StreamParser::on_silence(Packet& out) {
  if (judge(begin_) == Judgement::good) {
    const Packet p = packet_at(begin_);
    if (p.command != stream_command && held() == header_bytes + p.body.size()) {
      take(out);
      return true;
    }
  }
  ++counters_.truncated;
  drop(held());
  return false;
}

}  // namespace sonoband::liberty
