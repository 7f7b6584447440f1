// Every fault of the tracker against the cart, as a table: what the cart did, what the operator reads, how
// many readings were lost, and for how long there was no usable pose. hal/README.md holds the table; this
// test holds hal/README.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "hal/sim/viper_sim.h"
#include "tests/hal/tracker/tracker_rig.h"

namespace sonoband {
namespace {

using sim::Fault;
using sim::FaultKind;

// Of which trackers' wires it can be.
enum class Of : std::uint8_t { both, liberty };

struct Named {
  const char* name;
  std::vector<Fault> faults;
  Of of = Of::both;
};

constexpr Duration second = std::chrono::seconds(1);
constexpr Stamp start = Stamp(std::chrono::seconds(1000));
constexpr Stamp from = start + 20 * second;  // no longer a unit that just came
constexpr Stamp until = start + 55 * second;

const Named while_streaming[] = {
    {"1000 bytes of garbage between records", {{from, FaultKind::garbage, 1000}}},
    {"a byte lost in a record", {{from, FaultKind::dropped_byte, 20}}},
    {"a size field damaged", {{from, FaultKind::flipped_size, 2}}},
    {"records of another list for 2 s", {{from, FaultKind::wrong_list, 0, 2 * second}}, Of::liberty},
    {"10 000 bytes of ASCII records at once", {{from, FaultKind::flood, 10'000}}, Of::liberty},
    {"an error text between records", {{from, FaultKind::error_text, 0x14}}, Of::liberty},
    {"a value that is no number", {{from, FaultKind::not_finite, 1}}},
    {"a value that is infinite", {{from, FaultKind::infinite, 1}}, Of::liberty},
    {"a quaternion of zeros", {{from, FaultKind::zero_quaternion}}},
    {"quaternions of the other sign for 1 s",
     {{from, FaultKind::negated_quaternion, 0, second}},
     Of::liberty},
    {"positions mirrored for 1 s", {{from, FaultKind::mirrored, 0, second}}, Of::liberty},
    {"a position 200 mm off in one record", {{from, FaultKind::displaced, 200}}},
    {"some distortion for 1 s", {{from, FaultKind::distortion, 1, second}}, Of::liberty},
    {"high distortion for 1 s", {{from, FaultKind::distortion, 2, second}}, Of::liberty},
    {"error a (source failure; so b to g, A to G) for 1 s",
     {{from, FaultKind::error_letter, 'a', second}},
     Of::liberty},
    {"error I (self-test) for 1 s", {{from, FaultKind::error_letter, 'I', second}}, Of::liberty},
    {"error u (outside the map) for 1 s", {{from, FaultKind::error_letter, 'u', second}}, Of::liberty},
    {"a record twice", {{from, FaultKind::duplicate_record}}},
    {"five records missing", {{from, FaultKind::missing_records, 5}}},
    {"one count damaged", {{from, FaultKind::damaged_counter, 77}}, Of::liberty},
    {"counters step back by 300", {{from, FaultKind::counters_back, 300}}},
    {"counters jump to just before 2^32, and wrap", {{from, FaultKind::counters_near_wrap, 100}}},
    {"arrivals late by 50 ms", {{from, FaultKind::late, 0, std::chrono::milliseconds(50)}}},
    {"probe's sensor unplugged for 1 s", {{from, FaultKind::station_silent, 0, second}}},
    {"the stream stops by itself", {{from, FaultKind::stream_stops}}},
    {"the unit loses its settings", {{from, FaultKind::settings_lost}}},
    {"the unit hangs until a USB reset", {{from, FaultKind::deaf_until_reset}}},
    {"the unit hangs until it restarts itself", {{from, FaultKind::deaf_until_reinitialise}}, Of::liberty},
    {"the endpoint halts once", {{from, FaultKind::stall}}},
    {"the endpoint halts for 2 s", {{from, FaultKind::stall, 0, 2 * second}}},
    {"three transfers fail", {{from, FaultKind::io_error, 3}}},
    {"USB cable out for 2 s", {{from, FaultKind::unplugged, 0, 2 * second}}},
    {"the unit off for 1 s, back through its loader",
     {{from, FaultKind::power_cycle, 0, second}},
     Of::liberty},
    {"USB cable out for 1 s, then held by another program for 3 s",
     {{from, FaultKind::unplugged, 0, second}, {from, FaultKind::busy, 0, 4 * second}}},
    {"USB cable out for 1 s, then not to be opened for 3 s",
     {{from, FaultKind::unplugged, 0, second}, {from, FaultKind::access_denied, 0, 4 * second}}},
};

enum class Left : std::uint8_t { quiet, ascii_stream, binary_stream, echo };

// Of a unit as somebody else left it, or that is hard to start.
struct AtStart {
  const char* name;
  Left left = Left::quiet;
  std::vector<Fault> faults;
  Of of = Of::both;
};
const AtStart at_start[] = {
    {"at the start: nothing wrong", Left::quiet, {}},
    {"at the start: left streaming in ASCII", Left::ascii_stream, {}, Of::liberty},
    {"at the start: left streaming", Left::binary_stream, {}},
    {"at the start: left echoing commands", Left::echo, {}, Of::liberty},
    {"at the start: a flood of 10 000 bytes",
     Left::quiet,
     {{start + second / 20, FaultKind::flood, 10'000}},
     Of::liberty},
    {"at the start: two start commands not heard", Left::quiet, {{start, FaultKind::ignored_starts, 2}}},
    {"at the start: its self-test, 9 s", Left::quiet, {{start, FaultKind::deaf, 0, 9 * second}}},
};

// What the operator reads, and for how long.
class Sentences {
 public:
  void hear(const DeviceHealth& health, Duration time) {
    if (*health.reason == 0) return;
    for (auto& [said, how_long] : heard_)
      if (said == health.reason) return static_cast<void>(how_long += time);
    heard_.emplace_back(health.reason, time);
  }
  std::string longest() const {
    const auto at = std::max_element(heard_.begin(), heard_.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
    return at == heard_.end() ? "-" : at->first;
  }

 private:
  std::vector<std::pair<std::string, Duration>> heard_;
};

std::string what_it_did(std::uint32_t cures, std::uint32_t epochs) {
  if (cures > 0) return std::to_string(cures) + (cures == 1 ? " cure" : " cures");
  return epochs > 0 ? "new epoch" : "went on";
}

// Of a tracker behind `port`, with the fault already in it.
std::string row(const char* name, const char* device, BytePort& port, test::SteppedClock& clock,
                bool starting) {
  PolhemusTracker tracker(port, clock, {});
  tracker.start();
  std::array<PoseSample, 64> batch;
  Sentences sentences;
  Stamp last_good = start;
  std::uint32_t first_epoch = 0;
  std::uint32_t last_epoch = 0;
  Duration longest{};
  const Stamp watched = starting ? start : from;
  while (clock.now() < until) {
    std::size_t n = 0;
    const Stamp before = clock.now();
    tracker.read(batch, n, std::chrono::milliseconds(5));
    for (std::size_t i = 0; i < n; ++i) {
      if (!usable(batch[i].quality)) continue;
      if (last_good > watched - second) longest = std::max(longest, Duration(batch[i].time - last_good));
      last_good = batch[i].time;
      last_epoch = batch[i].epoch;
      if (first_epoch == 0) first_epoch = last_epoch;
    }
    if (before >= watched) sentences.hear(tracker.health(), clock.now() - before);
  }
  EXPECT_EQ(tracker.health().state, DeviceState::running) << name;
  const LinkCounters& c = tracker.counters();
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "| %s | %s | %s | %s | %llu | %.1f s |", name, device,
                what_it_did(c.recoveries, last_epoch - first_epoch).c_str(), sentences.longest().c_str(),
                static_cast<unsigned long long>(c.lost) + c.jumps, seconds(longest));
  return text.data();
}

std::string of_liberty(const char* name, std::vector<Fault> faults, Left left, bool starting) {
  test::SteppedClock clock;
  sim::LibertySimConfig config;
  config.bus.bursts_per_minute = 0;
  config.faults = std::move(faults);
  config.unit.start_up.continuous = left == Left::ascii_stream || left == Left::binary_stream;
  config.unit.start_up.binary = left == Left::binary_stream;
  config.unit.start_up.echo = left == Left::echo;
  sim::LibertySim port(clock, config, test::hand);
  return row(name, "LIBERTY", port, clock, starting);
}

std::string of_viper(const char* name, std::vector<Fault> faults, Left left, bool starting) {
  test::SteppedClock clock;
  sim::ViperSimConfig config;
  config.bus.bursts_per_minute = 0;
  config.faults = std::move(faults);
  config.unit.streams_at_start = left != Left::quiet;
  sim::ViperSim port(clock, config, test::hand);
  return row(name, "VIPER", port, clock, starting);
}

// Every row of the README's table, and no other.
TEST(FaultTable, IsWhatTheReadmeSays) {
  std::ifstream in(std::string(SONOBAND_SOURCE_DIR) + "/hal/README.md");
  std::vector<std::string> readme;
  for (std::string line; std::getline(in, line);)
    if (line.find("| LIBERTY |") != std::string::npos || line.find("| VIPER |") != std::string::npos)
      readme.push_back(line);
  std::vector<std::string> rows;
  for (const Named& f : while_streaming) rows.push_back(of_liberty(f.name, f.faults, Left::quiet, false));
  for (const AtStart& f : at_start) rows.push_back(of_liberty(f.name, f.faults, f.left, true));
  for (const Named& f : while_streaming)
    if (f.of == Of::both) rows.push_back(of_viper(f.name, f.faults, Left::quiet, false));
  for (const AtStart& f : at_start)
    if (f.of == Of::both) rows.push_back(of_viper(f.name, f.faults, f.left, true));
  for (const std::string& said : rows) {
    std::printf("%s\n", said.c_str());
    EXPECT_EQ(std::count(readme.begin(), readme.end(), said), 1)
        << "hal/README.md has another row than: " << said;
  }
  EXPECT_EQ(readme.size(), rows.size());
}

// One row stands for all of them.
TEST(FaultTable, EveryLetterOfASourceFailureIsThatRow) {
  constexpr const char* letters = "bcdefgABCDEFG";
  const std::string of_a = of_liberty("", {{from, FaultKind::error_letter, 'a', second}}, Left::quiet, false);
  for (const char* letter = letters; *letter != 0; ++letter)
    EXPECT_EQ(of_liberty("", {{from, FaultKind::error_letter, static_cast<double>(*letter), second}},
                         Left::quiet, false),
              of_a)
        << *letter;
}

}  // namespace
}  // namespace sonoband
