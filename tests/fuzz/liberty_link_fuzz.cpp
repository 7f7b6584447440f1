// The whole link on hostile bytes, transfer results, port states and times. Each step takes two bytes of
// choice and then as many as they say of wire.
// Held: no crash; readings are finite, in order of time, and never of an older epoch; with nothing to
// hear it lets time go on (no busy loop).
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <span>

#include "hal/tracker/link.h"

namespace {

using namespace sonoband;

// Records that arrive at one instant after the newest time possible still follow each other, 1 ns apart.
constexpr Duration one_by_one = std::chrono::microseconds(1);

void require(bool held, const char* what) {
  if (held) return;
  std::fprintf(stderr, "not held: %s\n", what);
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Link link{LinkConfig{}};
  std::span<const std::uint8_t> rest(data, size);
  // Inputs that begin with a V are talked to as a VIPER.
  const bool viper = !rest.empty() && rest[0] == 'V';
  if (viper) rest = rest.subspan(1);
  Stamp now{std::chrono::seconds(1000)};
  PortState port = PortState::absent;
  LinkOutput out;
  int turns_without_time = 0;
  Stamp last_turn{};
  std::array<std::optional<PoseSample>, static_cast<std::size_t>(most_stations) + 1> last;

  while (rest.size() >= 2) {
    const std::uint8_t choice = rest[0];
    const std::size_t wanted = rest[1];
    rest = rest.subspan(2);
    LinkInput in;
    in.recording = (choice & 0x80) != 0;
    // Mostly what a healthy port does.
    if (out.action == LinkOutput::PortAction::open)
      port = (choice & 0x70) == 0x70 ? static_cast<PortState>(1 + wanted % 5) : PortState::open;
    if (out.action == LinkOutput::PortAction::reset || out.action == LinkOutput::PortAction::release)
      port = PortState::absent;
    if (port == PortState::open && (choice & 0x0f) >= 0x0c) {
      in.transfer = static_cast<TransferStatus>((choice & 0x0f) - 0x0b);
      if (in.transfer == TransferStatus::gone) port = PortState::gone;
    }
    in.port = port;
    in.family = viper ? TrackerFamily::viper : TrackerFamily::liberty;
    if (port == PortState::open && out.listen) {
      in.bytes = rest.first(std::min(wanted, rest.size()));
      rest = rest.subspan(in.bytes.size());
    }
    if (in.bytes.empty())
      now = std::max(now, out.wake);
    else
      now += std::chrono::milliseconds((choice & 0x30) >> 4);
    turns_without_time = now == last_turn && in.bytes.empty() ? turns_without_time + 1 : 0;
    last_turn = in.now = now;
    out = link.turn(in);
    require(turns_without_time < 20, "time goes on");
    require(out.write.size() <= 64, "one transfer");
    require(operator_sentence(link.reason()) != nullptr, "a sentence for each reason");
    for (const Reading& r : link.readings()) {
      require(r.station >= 1 && r.station <= most_stations, "a station that exists");
      auto& previous = last[static_cast<std::size_t>(r.station)];
      const PoseSample& p = r.pose;
      if (previous)
        require(p.time > previous->time && p.epoch >= previous->epoch, "in order of time and epoch");
      if (usable(p.quality)) {
        require(p.tracker_from_probe.translation.allFinite(), "a finite place");
        require(is_rotation(p.tracker_from_probe.rotation, 1e-9), "a rotation");
        require(p.time <= p.arrived + one_by_one, "measured before it arrived");
      }
      previous = p;
    }
  }
  return 0;
}
