// Every fault of the tracker against the cart, as a table: what the operator reads, how many readings were
// lost, and for how long there was no usable pose. hal/README.md holds the table; this test holds
// hal/README.md.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "hal/sim/viper_sim.h"
#include "tests/hal/tracker/tracker_rig.h"

namespace sonoband {
namespace {

using sim::Fault;
using sim::FaultKind;
using test::at;

struct Named {
  const char* name;
  Fault fault;
};

constexpr Stamp from = Stamp(std::chrono::seconds(1003));
constexpr Duration second = std::chrono::seconds(1);

const Named faults[] = {
    {"1000 bytes of garbage between records", {from, FaultKind::garbage, 1000}},
    {"a byte lost in a record", {from, FaultKind::dropped_byte, 20}},
    {"a size field damaged", {from, FaultKind::flipped_size, 2}},
    {"a value that is no number", {from, FaultKind::not_finite, 1}},
    {"a quaternion of zeros", {from, FaultKind::zero_quaternion}},
    {"a position 200 mm off in one record", {from, FaultKind::displaced, 200}},
    {"a record twice", {from, FaultKind::duplicate_record}},
    {"five records missing", {from, FaultKind::missing_records, 5}},
    {"counters step back by 300", {from, FaultKind::counters_back, 300}},
    {"counters wrap at 2^32", {from, FaultKind::counters_near_wrap, 100}},
    {"arrivals late by 50 ms", {from, FaultKind::late, 0, std::chrono::milliseconds(50)}},
    {"probe's sensor unplugged for 1 s", {from, FaultKind::station_silent, 0, second}},
    {"the stream stops by itself", {from, FaultKind::stream_stops}},
    {"the unit loses its settings", {from, FaultKind::settings_lost}},
    {"the unit hangs until a USB reset", {from, FaultKind::deaf_until_reset}},
    {"the endpoint halts once", {from, FaultKind::stall}},
    {"the endpoint halts for 2 s", {from, FaultKind::stall, 0, 2 * second}},
    {"three transfers fail", {from, FaultKind::io_error, 3}},
    {"USB cable out for 2 s", {from, FaultKind::unplugged, 0, 2 * second}},
};

// Of a tracker behind `port`, with the fault already in it.
std::string row(const char* name, const char* device, BytePort& port, test::SteppedClock& clock) {
  PolhemusTracker tracker(port, clock, {});
  tracker.start();
  std::array<PoseSample, 64> batch;
  std::string said;
  Stamp last_good{};
  Duration longest{};
  while (clock.now() < at(22)) {
    std::size_t n = 0;
    tracker.read(batch, n, std::chrono::milliseconds(5));
    for (std::size_t i = 0; i < n; ++i) {
      if (!usable(batch[i].quality)) continue;
      if (last_good > from - second) longest = std::max(longest, Duration(batch[i].time - last_good));
      last_good = batch[i].time;
    }
    const DeviceHealth health = tracker.health();
    if (clock.now() > from && health.state != DeviceState::running && said.empty()) said = health.reason;
  }
  EXPECT_EQ(tracker.health().state, DeviceState::running) << name;
  const LinkCounters& c = tracker.counters();
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "| %s | %s | %s | %llu | %.1f s |", name, device,
                said.empty() ? "went on" : said.c_str(), static_cast<unsigned long long>(c.lost) + c.jumps,
                seconds(longest));
  return text.data();
}

TEST(FaultTable, IsWhatTheReadmeSays) {
  std::ifstream in(std::string(SONOBAND_SOURCE_DIR) + "/hal/README.md");
  const std::string readme{std::istreambuf_iterator<char>(in), {}};
  for (const Named& f : faults) {
    test::SteppedClock clock;
    sim::LibertySimConfig liberty;
    liberty.bus.bursts_per_minute = 0;
    liberty.faults = {f.fault};
    sim::LibertySim port(clock, liberty, test::hand);
    const std::string said = row(f.name, "LIBERTY", port, clock);
    std::printf("%s\n", said.c_str());
    EXPECT_NE(readme.find(said), std::string::npos) << "hal/README.md has another row than: " << said;
  }
  for (const Named& f : faults) {
    test::SteppedClock clock;
    sim::ViperSimConfig viper;
    viper.bus.bursts_per_minute = 0;
    viper.faults = {f.fault};
    sim::ViperSim port(clock, viper, test::hand);
    const std::string said = row(f.name, "VIPER", port, clock);
    std::printf("%s\n", said.c_str());
    EXPECT_NE(readme.find(said), std::string::npos) << "hal/README.md has another row than: " << said;
  }
}

}  // namespace
}  // namespace sonoband
