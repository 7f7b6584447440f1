// One video track of VP9 as a WebM file. Source: webmproject.org, "WebM Container Guidelines"; RFC 9559.
#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace sonoband::exchange {

struct WebmTrack {
  int width = 0;  // of the coded pictures
  int height = 0;
  int shown_width = 0;  // the same picture with square pixels
  int shown_height = 0;
  std::int64_t duration_ms = 0;
  // Names (upper case by custom, TITLE and COMMENT are shown by players) and UTF-8 texts.
  std::vector<std::pair<std::string, std::string>> tags;
};

class WebmWriter {
 public:
  // `out` must be seekable and outlive this. Writes the head.
  WebmWriter(std::ostream& out, const WebmTrack& track);
  ~WebmWriter();
  WebmWriter(const WebmWriter&) = delete;
  WebmWriter& operator=(const WebmWriter&) = delete;

  // A coded picture; the first is a key picture, times do not go back.
  void add(std::span<const std::uint8_t> picture, std::int64_t time_ms, bool key);
  // Without it the file is not whole. Whether the disk took everything is to be asked of `out`.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sonoband::exchange
