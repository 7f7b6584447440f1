#include "hal/touch/contacts.h"

#include <linux/input-event-codes.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sonoband {
namespace {

// The size told of a contact that the panel itself calls a palm; a gloved thumb is up to 18 mm.
constexpr float palm_mm = 60;
constexpr int tool_is_palm = 2;  // MT_TOOL_PALM of linux/input.h, which is not for every header

double units_in(const TouchRange& range) {
  return 1.0 + range.most - double{1.0} * range.least;
}

// The middle of a unit is where it is: a panel of 1280 units over 1280 pixels gives the pixels' centres.
double part_of(std::int32_t value, const TouchRange& range) {
  return units_in(range) > 0 ? (0.5 + value - double{1.0} * range.least) / units_in(range) : 0;
}

float on_panel(double part) {
  return static_cast<float>(std::clamp(part, 0.0, 1.0));
}

}  // namespace

void ContactDecoder::begin(const TouchPanel& panel, const TouchMapping& mapping) {
  const std::int32_t next = next_;  // a contact of before must not be taken for a new one
  *this = {};
  next_ = next;
  protocol_ = panel.protocol;
  x_ = panel.x;
  y_ = panel.y;
  major_ = panel.major;
  mapping_ = mapping;
  // The kernel's rule: sizes are in the units of positions, unless they have a resolution of their own.
  units_per_mm_ = major_.per_mm > 0 ? major_.per_mm : x_.per_mm;
  if (units_per_mm_ <= 0 && mapping.width_mm > 0) units_per_mm_ = units_in(x_) / mapping.width_mm;
}

float ContactDecoder::size_mm(const Slot& slot) const {
  if (slot.palm) return palm_mm;
  if (major_.most <= major_.least || units_per_mm_ <= 0 || slot.major <= 0) return 0;
  return static_cast<float>(slot.major / units_per_mm_);
}

TouchEvent ContactDecoder::event_of(const Slot& slot, Stamp time) const {
  const double u = part_of(slot.x, x_);
  const double v = part_of(slot.y, y_);
  const auto& c = mapping_.calibration;
  double x = c[0] * u + c[1] * v + c[2];
  double y = c[3] * u + c[4] * v + c[5];
  if (mapping_.rotation_deg == 90) {
    x = 1 - std::exchange(y, x);
  } else if (mapping_.rotation_deg == 180) {
    x = 1 - x;
    y = 1 - y;
  } else if (mapping_.rotation_deg == 270) {
    y = 1 - std::exchange(x, y);
  }
  return {.time = time,
          .kind = TouchEvent::Kind::move,
          .contact = slot.last.contact,
          .x = on_panel(x),
          .y = on_panel(y),
          .major_mm = size_mm(slot)};
}

void ContactDecoder::put(const TouchEvent& event) {
  if (ready_count_ < ready_.size()) ready_[(ready_first_ + ready_count_++) % ready_.size()] = event;
}

bool ContactDecoder::take(TouchEvent& out) {
  if (ready_count_ == 0) return false;
  out = ready_[ready_first_];
  ready_first_ = (ready_first_ + 1) % ready_.size();
  --ready_count_;
  return true;
}

void ContactDecoder::feed(const RawTouch& event, Stamp time) {
  if (event.type == EV_SYN && event.code == SYN_REPORT) return end_packet(time);
  switch (protocol_) {
    case TouchPanel::Protocol::slots:
      return feed_slots(event);
    case TouchPanel::Protocol::packets:
      return feed_packets(event);
    case TouchPanel::Protocol::single:
      return feed_single(event);
  }
}

void ContactDecoder::feed_slots(const RawTouch& event) {
  if (event.type != EV_ABS) return;
  if (event.code == ABS_MT_SLOT) {
    slot_ = event.value;
    return;
  }
  if (slot_ < 0 || slot_ >= most_contacts) return;
  Slot& slot = slots_[static_cast<std::size_t>(slot_)];
  switch (event.code) {
    case ABS_MT_TRACKING_ID:
      // One packet may lift a finger and land another: then the id is a new one.
      slot.landed = event.value >= 0 && (slot.landed || event.value != slot.id);
      slot.id = std::max(event.value, -1);
      slot.palm = false;
      break;
    case ABS_MT_POSITION_X:
      slot.x = event.value;
      break;
    case ABS_MT_POSITION_Y:
      slot.y = event.value;
      break;
    case ABS_MT_TOUCH_MAJOR:
      slot.major = event.value;
      break;
    case ABS_MT_TOOL_TYPE:
      slot.palm = event.value == tool_is_palm;
      break;
    default:
      return;
  }
  slot.moved = true;
}

void ContactDecoder::feed_single(const RawTouch& event) {
  Slot& slot = slots_[0];
  if (event.type == EV_KEY && event.code == BTN_TOUCH) {
    slot.landed = event.value != 0 && (slot.landed || slot.id < 0);
    slot.id = event.value != 0 ? 0 : -1;
  }
  if (event.type != EV_ABS || (event.code != ABS_X && event.code != ABS_Y)) return;
  (event.code == ABS_X ? slot.x : slot.y) = event.value;
  slot.moved = true;
}

void ContactDecoder::feed_packets(const RawTouch& event) {
  if (event.type == EV_SYN && event.code == SYN_DROPPED) {
    skipping_ = true;  // what follows up to the packet's end tells nothing of these fingers
    return;
  }
  if (event.type == EV_SYN && event.code == SYN_MT_REPORT) {
    if (finger_seen_ && packet_count_ < most_contacts)
      packet_[static_cast<std::size_t>(packet_count_++)] = finger_;
    finger_ = {};
    finger_seen_ = false;
    return;
  }
  if (event.type != EV_ABS) return;
  finger_seen_ = finger_seen_ || event.code == ABS_MT_POSITION_X || event.code == ABS_MT_POSITION_Y;
  if (event.code == ABS_MT_TRACKING_ID) finger_.id = std::max(event.value, -1);
  if (event.code == ABS_MT_POSITION_X) finger_.x = event.value;
  if (event.code == ABS_MT_POSITION_Y) finger_.y = event.value;
  if (event.code == ABS_MT_TOUCH_MAJOR) finger_.major = event.value;
  if (event.code == ABS_MT_TOOL_TYPE) finger_.palm = event.value == tool_is_palm;
}

namespace {

template <class Slot>
void move_to(Slot& slot, const Slot& finger) {
  slot.x = finger.x;
  slot.y = finger.y;
  slot.major = finger.major;
  slot.palm = finger.palm;
  slot.moved = true;
}

}  // namespace

// Whose finger is whose: by the panel's ids, else the nearest of the last packet, the closest pair first.
void ContactDecoder::match_packet() {
  std::array<bool, most_contacts> kept{};
  std::array<bool, most_contacts> placed{};
  for (;;) {
    double nearest = std::numeric_limits<double>::max();
    std::size_t finger = 0;
    std::size_t slot = slots_.size();
    for (std::size_t i = 0; i < static_cast<std::size_t>(packet_count_); ++i) {
      for (std::size_t s = 0; s < slots_.size() && !placed[i]; ++s) {
        if (slots_[s].id < 0 || kept[s] || (packet_[i].id >= 0 && slots_[s].id != packet_[i].id)) continue;
        const double away =
            std::hypot(double{1.0} * packet_[i].x - slots_[s].x, double{1.0} * packet_[i].y - slots_[s].y);
        if (away >= nearest) continue;
        nearest = away;
        finger = i;
        slot = s;
      }
    }
    if (slot == slots_.size()) break;
    placed[finger] = kept[slot] = true;
    move_to(slots_[slot], packet_[finger]);
  }
  for (std::size_t s = 0; s < slots_.size(); ++s)
    if (!kept[s]) slots_[s].id = -1;
  place_newcomers(placed);
}

void ContactDecoder::place_newcomers(const std::array<bool, most_contacts>& placed) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(packet_count_); ++i) {
    if (placed[i]) continue;
    const auto free = std::find_if(slots_.begin(), slots_.end(),
                                   [](const Slot& slot) { return slot.id < 0 && !slot.told; });
    if (free == slots_.end()) return;
    move_to(*free, packet_[i]);
    free->id = std::max(packet_[i].id, 0);
    free->landed = true;
  }
}

void ContactDecoder::lift_those_gone(Stamp time) {
  for (Slot& slot : slots_) {
    if (!slot.told || (slot.id >= 0 && !slot.landed)) continue;
    slot.told = false;
    slot.last.kind = TouchEvent::Kind::up;
    slot.last.time = time;
    put(slot.last);
  }
}

void ContactDecoder::end_packet(Stamp time) {
  if (protocol_ == TouchPanel::Protocol::packets) {
    if (!skipping_) match_packet();
    packet_count_ = 0;
    finger_ = {};
    finger_seen_ = false;
    if (std::exchange(skipping_, false)) return;
  }
  lift_those_gone(time);
  for (Slot& slot : slots_) {
    const bool moved = std::exchange(slot.moved, false);
    const bool landed = std::exchange(slot.landed, false);
    if (slot.id < 0 || !(landed || (slot.told && moved))) continue;
    if (landed) {
      slot.last.contact = next_;
      next_ = next_ == std::numeric_limits<std::int32_t>::max() ? 0 : next_ + 1;
      slot.told = true;
    }
    slot.last = event_of(slot, time);
    if (landed) slot.last.kind = TouchEvent::Kind::down;
    put(slot.last);
  }
}

void ContactDecoder::lift_all(Stamp time) {
  for (Slot& slot : slots_) slot.id = -1;
  lift_those_gone(time);
}

}  // namespace sonoband
