// The LIBERTY codec on hostile bytes: first byte chooses the session, the second the sizes of the reads.
// Held: no crash, every byte is accounted for exactly once, and every frame handed out obeys the header
// rules.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "hal/tracker/liberty_parser.h"
#include "hal/tracker/liberty_records.h"

namespace {

using namespace sonoband;
using namespace sonoband::liberty;

void require(bool held) {
  if (!held) std::abort();
}

void decode_all(const Packet& p) {
  const OutputList lists[] = {
      tracking_list,
      {Item::position, Item::angles, Item::crlf},
      {Item::position, Item::quaternion, Item::time_ms, Item::frame_count, Item::distortion, Item::sync}};
  for (const OutputList& list : lists)
    if (const auto r = decode_record(p, list, Units::centimetres);
        r && check_values(*r) == ValueFault::none) {
      if (r->position_mm) require(r->position_mm->allFinite());
      if (r->quaternion_wxyz) require(r->quaternion_wxyz->norm() > 0.98);
    }
  static_cast<void>(decode_number(p));
  static_cast<void>(decode_filter(p));
  static_cast<void>(decode_vector(p));
  static_cast<void>(decode_stations(p));
  if (const auto list = decode_output_list(p)) require(list->count <= OutputList::capacity);
  if (const auto identity = decode_identity(p)) require(identity->text.back() == 0);
  require(error_text(p.error) != nullptr);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  Expectation expected;
  if ((data[0] & 1) != 0) expected.tag = (data[0] & 2) != 0 ? Tag::patriot : Tag::liberty;
  if ((data[0] & 4) != 0) expected.stream_body_bytes = tracking_list.body_bytes();
  const std::size_t step = 1U + data[1];
  std::span<const std::uint8_t> rest(data + 2, size - 2);

  StreamParser parser(expected);
  Stamp now{};
  std::size_t framed = 0;
  std::uint64_t frames = 0;
  const auto drain = [&] {
    Packet p;
    while (parser.next(p, now)) {
      ++frames;
      framed += header_bytes + p.body.size();
      require(p.body.size() <= max_body_bytes);
      require(p.station <= stations_of(p.tag));
      if (expected.tag) require(p.tag == *expected.tag);
      decode_all(p);
    }
  };
  while (!rest.empty()) {
    // A read of every third size brings nothing for a long time first.
    now += rest.size() % 3 == 0 ? from_seconds(1) : from_seconds(0.001);
    drain();
    const std::size_t taken = parser.push(rest.first(std::min(step, rest.size())), now);
    require(taken > 0);
    rest = rest.subspan(taken);
    drain();
  }
  now += from_seconds(10);
  drain();
  require(framed + parser.counters().resync_bytes == size - 2);
  require(frames == parser.counters().frames);
  return 0;
}
