// The touchscreen: contacts of whatever panel the port has, with its comings and goings.
#pragma once

#include <memory>

#include "hal/clock.h"
#include "hal/devices.h"
#include "hal/shared_health.h"
#include "hal/touch/contacts.h"
#include "hal/touch/touch_port.h"

namespace sonoband {

// One sentence with the cure; "" while all is well. For the screen and for the check.
const char* sentence_of(TouchStatus status);

class Touchscreen final : public Touch {
 public:
  // `clock` outlives it.
  Touchscreen(std::unique_ptr<TouchPort> port, Clock& clock, const TouchMapping& mapping = {});
  ~Touchscreen() override;

  void start() override;
  ReadStatus read(TouchEvent& out, Duration timeout) override;
  DeviceHealth health() const override;  // lost: times that the kernel dropped events
  void stop() override;

 private:
  void connect();
  void lose();
  void take(const RawTouch& raw);

  std::unique_ptr<TouchPort> port_;
  Clock& clock_;
  TouchMapping mapping_;
  ContactDecoder contacts_;
  TouchPanel panel_;
  bool started_ = false;
  bool open_ = false;
  Stamp next_open_{};
  SharedHealth health_;
};

}  // namespace sonoband
