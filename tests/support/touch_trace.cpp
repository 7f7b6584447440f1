#include "tests/support/touch_trace.h"

#include <linux/input-event-codes.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace sonoband::test {
namespace {

class TracePort final : public TouchPort {
 public:
  TracePort(TouchTrace trace, Clock& clock) : trace_(std::move(trace)), clock_(clock) {}
  TouchStatus open(TouchPanel& panel) override {
    if (next_ == trace_.events.size()) return TouchStatus::absent;
    panel = trace_.panel;
    start_ = clock_.now();
    return TouchStatus::ok;
  }
  TouchStatus wait(RawTouch& out, Duration timeout) override {
    if (next_ == trace_.events.size()) return TouchStatus::gone;
    const Stamp due = start_ + std::chrono::nanoseconds(trace_.events[next_].stamp_ns);
    const Stamp until = clock_.now() + timeout;
    clock_.sleep_until(std::min(due, until));
    if (due > until) return TouchStatus::nothing_yet;
    out = trace_.events[next_++];
    out.stamp_ns = due.time_since_epoch().count();
    return TouchStatus::ok;
  }
  void close() override {}

 private:
  TouchTrace trace_;
  Clock& clock_;
  Stamp start_{};
  std::size_t next_ = 0;
};

}  // namespace

TouchTrace read_touch_trace(const std::string& name) {
  const auto file = std::filesystem::path(SONOBAND_SOURCE_DIR) / "tests/hal/touch/traces" / (name + ".evemu");
  std::ifstream in(file);
  TouchTrace trace;
  trace.panel.protocol = TouchPanel::Protocol::packets;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line.size() > 3 ? line.substr(3) : "");
    if (line.starts_with("N: ")) trace.panel.name = line.substr(3);
    if (line.starts_with("A: ")) {
      int code = 0;
      TouchRange range;
      int fuzz = 0;
      int flat = 0;
      words >> std::hex >> code >> std::dec >> range.least >> range.most >> fuzz >> flat >> range.per_mm;
      if (code == ABS_MT_POSITION_X) trace.panel.x = range;
      if (code == ABS_MT_POSITION_Y) trace.panel.y = range;
      if (code == ABS_MT_TOUCH_MAJOR) trace.panel.major = range;
      if (code == ABS_MT_SLOT) trace.panel.protocol = TouchPanel::Protocol::slots;
    }
    if (line.starts_with("E: ")) {
      RawTouch raw;
      double t_s = 0;
      words >> t_s >> std::hex >> raw.type >> raw.code >> std::dec >> raw.value;
      raw.stamp_ns = std::llround(t_s * 1e9);
      if (words.fail()) throw std::runtime_error(file.string() + ": no event of evemu's: " + line);
      trace.events.push_back(raw);
    }
  }
  if (trace.events.empty()) throw std::runtime_error(file.string() + ": no trace");
  return trace;
}

std::unique_ptr<TouchPort> trace_port(TouchTrace trace, Clock& clock) {
  return std::make_unique<TracePort>(std::move(trace), clock);
}

}  // namespace sonoband::test
