// A simulated touch panel that speaks the kernel's multi-touch protocol B: fingers in, events out.
#pragma once

#include <array>
#include <cstdint>
#include <deque>

#include "hal/clock.h"
#include "hal/touch/touch_port.h"

namespace sonoband::sim {

struct SimPanelSettings {
  // Of a 10.1 inch panel of 217 x 136 mm, fine enough that a pixel of any display is some units.
  TouchRange x{0, 32767, 151};
  TouchRange y{0, 20479, 151};
  TouchRange major{0, 32767, 151};
};

// One thread: whoever puts fingers on it reads it as well.
class SimPanel final : public TouchPort {
 public:
  static constexpr int most_fingers = 10;

  explicit SimPanel(Clock& clock, const SimPanelSettings& settings = {});

  // In parts of the panel. Lands if the finger was not down, else moves; each call is one packet.
  void touch(int finger, double x, double y, double major_mm = 8);
  void lift(int finger);

  // Faults.
  void drop();  // what waits to be read is lost; the state is told anew, as libevdev does
  void unplug() { plugged_ = false; }
  void plug_in() { plugged_ = true; }
  void refuse(TouchStatus how) { refusal_ = how; }  // to be opened; ok: no more

  TouchStatus open(TouchPanel& panel) override;
  TouchStatus wait(RawTouch& out, Duration timeout) override;
  void close() override;

 private:
  struct Slot {
    std::int32_t id = -1;
    std::int32_t x = 0;
    std::int32_t y = 0;
    std::int32_t major = 0;
  };
  void say(std::uint16_t type, std::uint16_t code, std::int32_t value);
  void choose(int slot);

  Clock& clock_;
  SimPanelSettings settings_;
  std::array<Slot, most_fingers> slots_{};
  int slot_ = 0;
  std::int32_t next_id_ = 0;
  std::deque<RawTouch> waiting_;
  bool open_ = false;
  bool plugged_ = true;
  TouchStatus refusal_ = TouchStatus::ok;
};

}  // namespace sonoband::sim
