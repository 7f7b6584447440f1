// From the kernel's multi-touch events to contacts on the glass. Pure: events in, contacts out; any events in
// any order are survived. Protocols: the kernel's Documentation/input/multi-touch-protocol.rst.
#pragma once

#include <array>
#include <cstdint>

#include "hal/devices.h"
#include "hal/touch/touch_port.h"

namespace sonoband {

// How the panel's own axes lie on the picture.
struct TouchMapping {
  // Rows (x, y) of an affine map of parts of the panel, as libinput's calibration matrix.
  std::array<double, 6> calibration{1, 0, 0, 0, 1, 0};
  int rotation_deg = 0;  // of the panel against the picture, clockwise: 0, 90, 180 or 270; after calibration
  double width_mm = 0;   // of the panel's x axis, for panels that give no resolution; 0: not known
};

class ContactDecoder {
 public:
  static constexpr int most_contacts = 16;

  // Forgets all contacts.
  void begin(const TouchPanel& panel, const TouchMapping& mapping);

  // At the end of a packet (SYN_REPORT) the contacts that changed are ready, those that lifted first. Take
  // them all before the next event.
  void feed(const RawTouch& event, Stamp time);
  // Every contact lifts where it was last: the panel is gone.
  void lift_all(Stamp time);
  bool take(TouchEvent& out);

 private:
  struct Slot {
    std::int32_t id = -1;  // the panel's; -1: nobody is there
    std::int32_t x = 0;
    std::int32_t y = 0;
    std::int32_t major = 0;
    bool palm = false;    // the panel says so itself
    bool landed = false;  // another finger than the last packet's
    bool told = false;    // as down
    bool moved = false;
    TouchEvent last;  // as told
  };

  void feed_slots(const RawTouch& event);
  void feed_packets(const RawTouch& event);
  void feed_single(const RawTouch& event);
  void end_packet(Stamp time);
  void lift_those_gone(Stamp time);
  void match_packet();
  void place_newcomers(const std::array<bool, most_contacts>& placed);
  void put(const TouchEvent& event);
  TouchEvent event_of(const Slot& slot, Stamp time) const;
  float size_mm(const Slot& slot) const;

  TouchPanel::Protocol protocol_ = TouchPanel::Protocol::slots;
  TouchRange x_, y_, major_;
  TouchMapping mapping_;
  double units_per_mm_ = 0;  // of the contact's size; 0: not known
  std::array<Slot, most_contacts> slots_{};
  int slot_ = 0;           // that events speak of; outside of the array: of a finger too many
  std::int32_t next_ = 0;  // contact
  // Protocol A: the packet so far.
  std::array<Slot, most_contacts> packet_{};
  int packet_count_ = 0;
  Slot finger_{};
  bool finger_seen_ = false;
  bool skipping_ = false;

  // A packet gives each slot two events at most, a loss of the panel one more.
  std::array<TouchEvent, std::size_t{3} * most_contacts> ready_{};
  std::size_t ready_first_ = 0;
  std::size_t ready_count_ = 0;
};

}  // namespace sonoband
