// The VIPER codec on hostile bytes: the first byte says how long the reads are, and whether checksums are set
// right (else hardly a frame would pass).
// Held: no crash, every byte is accounted for exactly once, frames obey the rules of their header.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "hal/tracker/little_endian.h"
#include "hal/tracker/streaming.h"
#include "hal/tracker/viper_codec.h"

namespace {

using namespace sonoband;

void require(bool held) {
  if (!held) std::abort();
}

void mend_checksums(std::vector<std::uint8_t>& b) {
  for (std::size_t at = 0; at + 8 < b.size();) {
    const std::size_t size = wire::load_u32(b.data() + at + 4);
    const bool begins = b[at] == 'V' && b[at + 1] == 'P' && b[at + 2] == 'R';
    if (!begins || size <= 4 || size > viper::max_size || at + 8 + size > b.size()) {
      ++at;
      continue;
    }
    const std::size_t covered = 4 + size;
    wire::store_u32(b.data() + at + covered, viper::crc16({b.data() + at, covered}));
    at += 8 + size;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  std::vector<std::uint8_t> bytes(data + 1, data + size);
  if ((data[0] & 0x80) != 0) mend_checksums(bytes);
  const std::size_t step = 1U + 8U * (data[0] & 0x7f);

  viper::Parser parser;
  ViperCodec codec;
  Streaming streaming(1);
  LinkCounters counters;
  WireCommand write;
  Stamp now{std::chrono::seconds(1000)};
  codec.begin_setup(LinkConfig{}, now);
  streaming.begin(LinkConfig{}, codec.begin_stream(LinkConfig{}), now);
  std::size_t framed = 0;
  const auto drain = [&] {
    viper::Frame frame;
    while (parser.next(frame, now, from_seconds(0.1))) {
      framed += frame.body.size() + viper::frame_overhead;
      require(frame.body.size() <= viper::max_size);
      if (const auto header = viper::decode_pose_header(frame))
        for (int i = 0; i < header->sensors; ++i) require(viper::decode_sensor(frame, i).sensor < 128);
    }
  };
  for (std::size_t from = 0; from < bytes.size(); from += step) {
    const auto piece = std::span(bytes).subspan(from, std::min(step, bytes.size() - from));
    now += piece.size() % 3 == 0 ? from_seconds(1) : from_seconds(0.004);
    require(parser.push(piece, now) == piece.size());
    drain();
    codec.hear_answers(piece, now);
    static_cast<void>(codec.setup_turn(now, write));
    require(write.size <= write.storage.size());
    streaming.clear_readings();
    codec.hear_records(piece, now, streaming, counters);
    for (const Reading& r : streaming.readings())
      if (usable(r.pose.quality)) require(r.pose.tracker_from_probe.translation.allFinite());
  }
  now += from_seconds(10);
  drain();
  now += from_seconds(10);
  drain();
  require(framed + parser.counters().resync_bytes == bytes.size());
  return 0;
}
