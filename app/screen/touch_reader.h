// The board's touchscreen, read on a thread of its own: contacts wait here until the next frame takes them.
#pragma once

#include <atomic>
#include <functional>

#include "core/concurrency/spsc_queue.h"
#include "hal/clock.h"
#include "hal/devices.h"
#include "ui/host/surface.h"

namespace sonoband {

// Of one change on the panel whose picture is `panel_px`.
ui::Contact contact_of(const TouchEvent& event, const ui::Rect& panel_px);

class TouchReader {
 public:
  // `touch` and `clock` outlive it. `wake` is called on the thread whenever contacts have come.
  TouchReader(Touch& touch, Clock& clock, std::function<void()> wake);
  ~TouchReader();
  TouchReader(const TouchReader&) = delete;
  TouchReader& operator=(const TouchReader&) = delete;

  // Adds what has come to `input`; the panel's picture is `panel_px` of it.
  void take(const ui::Rect& panel_px, ui::Input& input);
  DeviceHealth health() const { return touch_.health(); }

 private:
  void read();

  Touch& touch_;
  Clock& clock_;
  std::function<void()> wake_;
  // Ten fingers at 100 packets a second for a second. When it is full the thread waits, and the kernel keeps
  // what comes: no lift is ever lost.
  SpscQueue<TouchEvent> events_{1024};
  std::atomic<bool> stop_{false};
  ClockThread thread_;
};

}  // namespace sonoband
