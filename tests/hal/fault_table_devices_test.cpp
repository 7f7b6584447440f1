// The faults of grabber and pedal as a table, as fault_table_test.cpp does for the tracker: what the operator
// reads, what was lost, for how long nothing came. hal/README.md holds the rows; this test holds
// hal/README.md.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "hal/footswitch/debounce.h"
#include "tests/hal/capture/fake_video.h"
#include "tests/hal/footswitch/fake_contacts.h"

namespace sonoband {
namespace {

using test::at;

void expect_in_readme(const std::string& row) {
  static const std::string readme = [] {
    std::ifstream in(std::string(SONOBAND_SOURCE_DIR) + "/hal/README.md");
    return std::string{std::istreambuf_iterator<char>(in), {}};
  }();
  std::printf("%s\n", row.c_str());
  EXPECT_NE(readme.find(row), std::string::npos) << "hal/README.md has another row than: " << row;
}

// The last cell is `format` filled with a number.
std::string row_of(const char* name, const std::string& said, std::uint64_t lost, const char* format,
                   double number) {
  std::array<char, 100> last{};
  std::snprintf(last.data(), last.size(), format, number);
  return std::string("| ") + name + " | " + (said.empty() ? "went on" : said) + " | " + std::to_string(lost) +
         " | " + last.data() + " |";
}

struct VideoFault {
  const char* name;
  std::function<void(test::video::FakeVideo&)> begin;  // at 2 s
  double lasts_s = 0;
  std::function<void(test::video::FakeVideo&)> end = [](test::video::FakeVideo&) {};
};

using Video = test::video::FakeVideo;
const VideoFault video_faults[] = {
    {"three frames missing, by its count", [](Video& v) { v.sequence += 3; }},
    {"a frame twice", [](Video& v) { --v.sequence; }},
    {"a buffer that the driver calls damaged", [](Video& v) { v.damage_next = true; }},
    {"buffers too short for a picture for 0.5 s", [](Video& v) { v.bytes_per_picture -= 1; }, 0.5,
     [](Video& v) { v.bytes_per_picture += 1; }},
    {"no picture for 4 s", [](Video& v) { v.silent_until = at(6); }, 4},
    {"the same picture 10 000 times a second for 2 s",
     [](Video& v) {
       v.period = std::chrono::microseconds(100);
       v.counts = false;
     },
     2,
     [](Video& v) {
       v.period = std::chrono::milliseconds(20);
       v.counts = true;
     }},
    {"the scanner changes its video mode and back",
     [](Video& v) {
       v.trouble = VideoStatus::changed;
       v.actual_width = 80;
     },
     2, [](Video& v) { v.actual_width = test::video::width; }},
    {"the video cable out for 2 s",
     [](Video& v) {
       v.trouble = VideoStatus::no_signal;
       v.negotiating = VideoStatus::no_signal;
     },
     2, [](Video& v) { v.negotiating = VideoStatus::ok; }},
    {"the grabber's USB cable out for 2 s",
     [](Video& v) {
       v.trouble = VideoStatus::absent;
       v.opening = VideoStatus::absent;
     },
     2, [](Video& v) { v.opening = VideoStatus::ok; }},
    {"stamps of another clock for 1 s", [](Video& v) { v.stamp_shift_ns = 5'000'000'000; }, 1,
     [](Video& v) { v.stamp_shift_ns = 0; }},
};

TEST(FaultTable, OfTheVideoIsWhatTheReadmeSays) {
  for (const VideoFault& fault : video_faults) {
    test::video::Rig rig;
    std::string said;
    const auto run_to = [&](double s) {
      while (rig.clock.now() < at(s)) {
        rig.run_to(std::min(s, seconds(rig.clock.now() - at(0)) + 0.02));
        if (said.empty() && rig.health().state != DeviceState::running) said = rig.health().reason;
      }
    };
    rig.run_to(2);
    fault.begin(rig.device);
    run_to(2 + fault.lasts_s);
    fault.end(rig.device);
    run_to(10);
    EXPECT_EQ(rig.health().state, DeviceState::running) << fault.name;
    Duration longest{};
    for (std::size_t i = 1; i < rig.frames.size(); ++i)
      longest = std::max(longest, Duration(rig.frames[i].captured - rig.frames[i - 1].captured));
    expect_in_readme(row_of(fault.name, said, rig.health().lost, "%.2f s", seconds(longest)));
  }
}

struct PedalFault {
  const char* name;
  bool pair = false;
  std::vector<test::pedal::Wires::Event> events = {};  // after a press at 1 s
  std::function<void(test::pedal::Wires&)> at_2_s = [](test::pedal::Wires&) {};
  std::function<void(test::pedal::Wires&)> at_4_s = [](test::pedal::Wires&) {};
};

using Wires = test::pedal::Wires;
const PedalFault pedal_faults[] = {
    {.name = "bounce of 8 ms at the release",
     .events = {{3, 0, false}, {3.002, 0, true}, {3.004, 0, false}, {3.006, 0, true}, {3.008, 0, false}}},
    {.name = "the kernel's queue overflows, the release in it",
     .events = {{1.94, 0, false, 0, ContactStatus::overflow}},
     .at_2_s = [](Wires& w) { w.levels[0] = false; }},
    {.name = "the release lost alone, 1 s after the press", .at_2_s = [](Wires& w) { w.levels[0] = false; }},
    {.name = "the wire of the contact that opens cut while up",
     .pair = true,
     .events = {{2, 0, false}, {2.01, 1, true}, {3, 1, false}, {4, 1, true}}},
    {.name = "both contacts shorted while down", .pair = true, .events = {{3, 1, true}, {4, 0, false}}},
    {.name = "unplugged while down, back after 2 s with the foot up",
     .events = {{2, 0, true, 0, ContactStatus::gone}},
     .at_2_s =
         [](Wires& w) {
           w.opening = ContactStatus::no_such_line;
           w.levels[0] = false;
         },
     .at_4_s = [](Wires& w) { w.opening = ContactStatus::ok; }},
};

TEST(FaultTable, OfThePedalIsWhatTheReadmeSays) {
  for (const PedalFault& fault : pedal_faults) {
    test::pedal::Rig rig(fault.pair);
    if (fault.pair) rig.wires.events.push_back({1 - 0.01, 1, false});
    rig.wires.events.push_back({1, 0, true});
    rig.wires.events.insert(rig.wires.events.end(), fault.events.begin(), fault.events.end());
    std::string said;
    const auto run_to = [&](double s) {
      while (rig.clock.now() < at(s)) {
        rig.run_to(std::min(s, seconds(rig.clock.now() - at(0)) + 0.02));
        if (said.empty() && rig.health().state != DeviceState::running) said = rig.health().reason;
      }
    };
    rig.run_to(1.9);
    fault.at_2_s(rig.wires);
    run_to(4);
    fault.at_4_s(rig.wires);
    run_to(8);
    EXPECT_EQ(rig.health().state, DeviceState::running) << fault.name;
    Debounce debounce;
    int presses = 0;
    int releases = 0;
    Stamp released{};
    const auto count = [&](const std::optional<PedalEvent>& event) {
      if (!event) return;
      ++(event->pressed ? presses : releases);
      if (!event->pressed) released = event->time;
    };
    for (const PedalEdge& edge : rig.edges) {
      count(debounce.tick(edge.time));
      count(debounce.edge(edge));
    }
    count(debounce.tick(rig.clock.now()));
    EXPECT_EQ(presses, 1) << fault.name;
    EXPECT_EQ(releases, 1) << fault.name;
    expect_in_readme(row_of(fault.name, said, rig.health().lost, "%.2f s", seconds(released - at(1))));
  }
}

}  // namespace
}  // namespace sonoband
