// From contacts on the glass to what the hand meant. Pure: events and times in, gestures out.
//
// Positions are in pixels, times on the one clock. A finger that lands is a press at once; what else it means
// shows later. A gesture that has begun counts from where the finger landed, so the picture stays under it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/time.h"
#include "ui/rect.h"

namespace sonoband::ui {

// One change of one contact. The mouse's left button is contact -1 of no size.
struct Contact {
  Stamp time{};
  enum class Kind : std::uint8_t { down, move, up } kind = Kind::down;
  std::int32_t id = 0;  // the same from down to up
  Vec2 at;
  float major_mm = 0;  // 0 where the panel does not say
};

struct Gesture {
  enum class Kind : std::uint8_t {
    press,            // the first finger landed
    release,          // it left, having been alone
    tap,              // a short press that stayed in place
    double_tap,       // a second tap soon and near; the first has been told as a tap
    long_press,       // told while the finger is still down
    drag,             // one finger: step
    flick,            // a drag that ended in motion: velocity; follows the drag's end
    pinch,            // two fingers: scale
    twist,            // two fingers: turn_rad, clockwise on the screen
    two_finger_drag,  // step of the point between them
  };
  enum class Phase : std::uint8_t { once, begin, change, end };
  Kind kind = Kind::press;
  Phase phase = Phase::once;
  Vec2 start;          // where the first finger landed
  Vec2 at;             // now; of two fingers the point between them
  Vec2 step;           // since the last of this gesture
  float scale = 1;     // since the last of this gesture
  float turn_rad = 0;  // since the last of this gesture
  Vec2 velocity;       // px/s
  Stamp time{};
  std::uint64_t target = 0;  // what lay under `start`; filled in by the screen
};

struct GestureLimits {
  float slop_px = 12;          // 2 mm: a finger held still rolls about a millimetre
  float near_px = 60;          // two taps within 10 mm are one place
  float palm_mm = 22;          // a gloved thumb is up to 18 mm; the edge of a hand starts at 25
  float flick_px_per_s = 900;  // 150 mm/s
  float twist_rad = 0.09f;     // 5 degrees before a pinch becomes a twist as well
  Duration long_press = std::chrono::milliseconds(600);
  Duration double_tap = std::chrono::milliseconds(350);  // between the two lifts
};

GestureLimits limits_for(float px_per_mm);

class GestureRecogniser {
 public:
  explicit GestureRecogniser(const GestureLimits& limits) : limits_(limits) {}

  // Adds what `contact` completes to `out`. Contacts come in order of time; one that never went down here (it
  // began before, or as a palm) is ignored.
  void feed(const Contact& contact, std::vector<Gesture>& out);

  // Time passes with no contact changing: only a long press can come of it.
  void tick(Stamp now, std::vector<Gesture>& out);

  // A long press may still come, so the screen must not sleep.
  bool waiting() const { return state_ == State::pressed; }

  // Where the first finger is; false when none is down.
  bool finger(Vec2& at) const;

 private:
  enum class State : std::uint8_t {
    idle,
    pressed,  // one finger, has not moved
    held,     // after its long press
    dragging,
    two,
    spent,  // fingers are still down but mean nothing more
  };
  struct Finger {
    std::int32_t id = 0;
    bool down = false;
    bool palm = false;
    Vec2 start;
    Vec2 at;
    Stamp since{};
  };
  struct Sample {
    Stamp time{};
    Vec2 at;
  };

  void land(const Contact& contact, std::vector<Gesture>& out);
  void move(Finger& finger, const Contact& contact, std::vector<Gesture>& out);
  void lift(Finger& finger, const Contact& contact, std::vector<Gesture>& out);
  void begin_two(Stamp time);
  void change_two(Stamp time, std::vector<Gesture>& out);
  void end_two(Stamp time, std::vector<Gesture>& out);
  void cancel_one(Stamp time, std::vector<Gesture>& out);
  void remember(Stamp time, Vec2 at);
  Vec2 velocity(Stamp now) const;
  Gesture make(Gesture::Kind kind, Gesture::Phase phase, Stamp time) const;

  GestureLimits limits_;
  State state_ = State::idle;
  std::array<Finger, 10> fingers_{};
  int first_ = -1;
  int second_ = -1;
  Vec2 told_;  // where the drag was last told
  std::array<Sample, 16> trail_{};
  int trail_count_ = 0;
  Stamp last_tap_{};
  Vec2 last_tap_at_;
  bool tapped_ = false;
  // Two fingers: what was last told, and which of the three gestures have begun.
  Vec2 told_centre_, start_centre_;
  float told_spread_ = 1, start_spread_ = 1;
  float told_angle_ = 0, turned_ = 0;
  bool pinching_ = false, twisting_ = false, sliding_ = false;
};

}  // namespace sonoband::ui
