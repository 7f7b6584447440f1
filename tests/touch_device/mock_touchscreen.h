// A touchscreen of the kernel's as umockdev emulates it: /dev/input/event5 answers libevdev's ioctls, and
// what the test writes there is read.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "hal/touch/touch_port.h"

namespace sonoband::test {

struct MockSlot {
  std::int32_t id = -1;
  std::int32_t x = 0;
  std::int32_t y = 0;
};

struct MockSettings {
  bool direct = true;     // lies on a display
  bool slots = true;      // protocol B
  bool grabbed = false;   // by another program
  std::int32_t slot = 0;  // that the kernel's next events speak of
  std::uint16_t vendor = 0x222a;
  std::uint16_t product = 1;
  std::optional<int> key;   // a pedal's beside the panel's
  bool with_mouse = false;  // /dev/input/event4 is of the same USB device, and has no key of its own
  std::array<MockSlot, 5> at_start{};
};

class MockTouchscreen {
 public:
  explicit MockTouchscreen(const MockSettings& settings = {});
  ~MockTouchscreen();
  MockTouchscreen(const MockTouchscreen&) = delete;
  MockTouchscreen& operator=(const MockTouchscreen&) = delete;

  static constexpr const char* path = "/dev/input/event5";

  void write(const std::vector<RawTouch>& events);  // stamped now
  void unplug();
  // What the driver asked for.
  bool was_grabbed() const;
  bool mouse_was_grabbed() const;
  bool clock_was_set() const;

  struct State;

 private:
  std::unique_ptr<State> state_;
  std::unique_ptr<State> mouse_;
};

}  // namespace sonoband::test
