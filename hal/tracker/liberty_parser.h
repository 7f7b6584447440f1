// Bytes to frames. Where a USB transfer ends means nothing: a frame may be split over several and share one.
//
// A header is good when
//   - its tag is the session's (any known tag until the session has one);
//   - its station is 1..16 (a PATRIOT: 1..2), or 0 in a reply;
//   - its size is 0..992, and in a stream record exactly that of the configured list, unless the error byte
//     is a command error (01..18 hex), when the body is text.
// A bad header costs one byte, not the buffer: the next good one may begin at the second byte. After that a
// header counts only when the frame it announces is followed by another good header ("resync"), because
// payload can look like a header by chance. A lone reply has no successor: silence after its last byte
// serves as one. A frame that stays incomplete for longer than `incomplete_limit` is thrown away.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/tracker/codec.h"
#include "hal/tracker/liberty_protocol.h"

namespace sonoband::liberty {

struct Expectation {
  std::optional<Tag> tag;                         // known once the unit has identified itself
  std::size_t stream_body_bytes = 0;              // of the configured list; 0 while any list may be set
  Duration incomplete_limit = from_seconds(0.1);  // three frame periods while streaming
};

class StreamParser {
 public:
  static constexpr std::size_t capacity = 8192;

  explicit StreamParser(const Expectation& expected = {}) : expected_(expected) {}

  // Bytes already held are judged anew against it.
  void expect(const Expectation& expected) { expected_ = expected; }

  // Forgets bytes held and any resync, keeps the counters. For a fresh start of the conversation.
  void reset();

  // Takes as many of `bytes` as fit and says how many; all of them do if next() was called until it had no
  // more and there are at most `capacity` - 1000.
  std::size_t push(std::span<const std::uint8_t> bytes, Stamp now);

  // The next whole frame. Call until false after each push, and once after each read that brought nothing.
  bool next(Packet& out, Stamp now);

  const WireCounters& counters() const { return counters_; }

 private:
  enum class Judgement : std::uint8_t { good, bad, incomplete };

  Judgement judge(std::size_t at) const;
  Packet packet_at(std::size_t at) const;
  std::size_t held() const { return end_ - begin_; }
  void drop(std::size_t bytes);
  void take(Packet& out);
  bool on_silence(Packet& out);

  Expectation expected_;
  std::array<std::uint8_t, capacity> buffer_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  Stamp last_push_{};
  bool resync_ = false;
  WireCounters counters_;
};

}  // namespace sonoband::liberty
