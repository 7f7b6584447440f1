#include "hal/tracker/quiesce.h"

namespace sonoband {
namespace {

constexpr Duration silence = std::chrono::milliseconds(100);
constexpr Duration longest_drain = std::chrono::seconds(2);
constexpr std::size_t largest_drain = 64 * 1024;
constexpr int max_attempts = 3;

}  // namespace

void Quiesce::begin(Purpose purpose, const QuietWords& words, Stamp now) {
  words_ = words;
  purpose_ = purpose;
  stage_ = Stage::stop;
  attempts_ = 0;
  drained_ = 0;
  sent_ = last_bytes_ = now;
}

void Quiesce::send(Stage next, Stamp now) {
  stage_ = next;
  drained_ = 0;
  sent_ = last_bytes_ = now;
}

Stamp Quiesce::wake() const {
  return last_bytes_ + silence;
}

Quiesce::Status Quiesce::turn(Stamp now, std::size_t bytes, WireCommand& write) {
  write = {};
  if (bytes > 0) last_bytes_ = now;
  drained_ += bytes;
  const bool quiet = now - last_bytes_ >= silence;
  const bool flooded = now - sent_ >= longest_drain || drained_ >= largest_drain;

  switch (stage_) {
    case Stage::stop:
      write = attempts_ == 0 ? words_.stop : words_.stop_again;
      ++attempts_;
      send(Stage::stopping, now);
      return Status::busy;
    case Stage::stopping:
    case Stage::ending_line:
      if (!quiet) {
        if (!flooded) return Status::busy;
        if (attempts_ == max_attempts) return Status::no_quiet;
        stage_ = Stage::stop;
        return turn(now, 0, write);
      }
      if (stage_ == Stage::ending_line || purpose_ == Purpose::leave || words_.end_line.size == 0)
        return Status::quiet;
      stage_ = Stage::end_line;
      [[fallthrough]];
    case Stage::end_line:
      write = words_.end_line;
      send(Stage::ending_line, now);
      return Status::busy;
  }
  return Status::busy;
}

}  // namespace sonoband
