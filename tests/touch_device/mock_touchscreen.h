// A touchscreen of the kernel's as umockdev emulates it: /dev/input/event5 answers libevdev's ioctls, and
// what the test writes there is read.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
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
  bool clock_was_set() const;

  struct State;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace sonoband::test
