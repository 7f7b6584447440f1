#include "ui/gesture.h"

#include <numbers>

namespace sonoband::ui {
namespace {

using Kind = Gesture::Kind;
using Phase = Gesture::Phase;

float angle_of(Vec2 v) {
  return std::atan2(v.y, v.x);
}

// Into (-pi, pi].
float wrapped(float angle) {
  constexpr float pi = std::numbers::pi_v<float>;
  while (angle > pi) angle -= 2 * pi;
  while (angle <= -pi) angle += 2 * pi;
  return angle;
}

}  // namespace

GestureLimits limits_for(float px_per_mm) {
  GestureLimits limits;
  limits.slop_px = 2 * px_per_mm;
  limits.near_px = 10 * px_per_mm;
  limits.flick_px_per_s = 150 * px_per_mm;
  return limits;
}

Gesture GestureRecogniser::make(Kind kind, Phase phase, Stamp time) const {
  Gesture g;
  g.kind = kind;
  g.phase = phase;
  g.time = time;
  if (first_ >= 0) {
    g.start = fingers_[first_].start;
    g.at = fingers_[first_].at;
  }
  return g;
}

bool GestureRecogniser::finger(Vec2& at) const {
  if (state_ == State::idle || state_ == State::spent || first_ < 0) return false;
  at = fingers_[first_].at;
  return true;
}

void GestureRecogniser::remember(Stamp time, Vec2 at) {
  if (trail_count_ == static_cast<int>(trail_.size())) {
    std::move(trail_.begin() + 1, trail_.end(), trail_.begin());
    --trail_count_;
  }
  trail_[trail_count_++] = {time, at};
}

// Over the last 80 ms: shorter is noise of one report, longer still feels the start of the stroke.
Vec2 GestureRecogniser::velocity(Stamp now) const {
  constexpr Duration window = std::chrono::milliseconds(80);
  int oldest = trail_count_;
  while (oldest > 0 && now - trail_[oldest - 1].time <= window) --oldest;
  if (trail_count_ - oldest < 2) return {};
  const Sample& a = trail_[oldest];
  const Sample& b = trail_[trail_count_ - 1];
  const float dt = static_cast<float>(seconds(b.time - a.time));
  return dt > 0 ? (1 / dt) * (b.at - a.at) : Vec2{};
}

void GestureRecogniser::feed(const Contact& contact, std::vector<Gesture>& out) {
  tick(contact.time, out);
  if (contact.kind == Contact::Kind::down) return land(contact, out);
  for (Finger& finger : fingers_) {
    if (!finger.down || finger.id != contact.id) continue;
    if (contact.kind == Contact::Kind::move) {
      move(finger, contact, out);
    } else {
      lift(finger, contact, out);
    }
    return;
  }
}

void GestureRecogniser::tick(Stamp now, std::vector<Gesture>& out) {
  if (state_ != State::pressed || now - fingers_[first_].since < limits_.long_press) return;
  state_ = State::held;
  out.push_back(make(Kind::long_press, Phase::once, fingers_[first_].since + limits_.long_press));
}

void GestureRecogniser::land(const Contact& contact, std::vector<Gesture>& out) {
  int free = -1;
  for (int i = 0; i < static_cast<int>(fingers_.size()); ++i) {
    if (fingers_[i].down && fingers_[i].id == contact.id) return;  // landed twice: the panel repeats itself
    if (!fingers_[i].down && free < 0) free = i;
  }
  if (free < 0) return;
  fingers_[free] = {contact.id, true,       contact.major_mm > limits_.palm_mm,
                    contact.at, contact.at, contact.time};
  if (fingers_[free].palm) return;
  if (state_ == State::idle) {
    first_ = free;
    state_ = State::pressed;
    told_ = contact.at;
    trail_count_ = 0;
    remember(contact.time, contact.at);
    out.push_back(make(Kind::press, Phase::once, contact.time));
  } else if (state_ == State::pressed || state_ == State::held || state_ == State::dragging) {
    if (state_ == State::dragging) out.push_back(make(Kind::drag, Phase::end, contact.time));
    second_ = free;
    begin_two(contact.time);
  }
}

void GestureRecogniser::move(Finger& finger, const Contact& contact, std::vector<Gesture>& out) {
  finger.at = contact.at;
  const int index = static_cast<int>(&finger - fingers_.data());
  if (!finger.palm && contact.major_mm > limits_.palm_mm) {
    finger.palm = true;  // the hand has come down after its finger
    if (index == first_ || index == second_) cancel_one(contact.time, out);
    return;
  }
  if (finger.palm) return;
  if (state_ == State::two && (index == first_ || index == second_)) return change_two(contact.time, out);
  if (index != first_) return;
  remember(contact.time, contact.at);
  if ((state_ == State::pressed || state_ == State::held) &&
      length(finger.at - finger.start) > limits_.slop_px) {
    state_ = State::dragging;
    Gesture g = make(Kind::drag, Phase::begin, contact.time);
    g.step = finger.at - finger.start;
    told_ = finger.at;
    out.push_back(g);
  } else if (state_ == State::dragging) {
    Gesture g = make(Kind::drag, Phase::change, contact.time);
    g.step = finger.at - told_;
    told_ = finger.at;
    out.push_back(g);
  }
}

void GestureRecogniser::lift(Finger& finger, const Contact& contact, std::vector<Gesture>& out) {
  const int index = static_cast<int>(&finger - fingers_.data());
  finger.down = false;
  if (!finger.palm && index == first_ && state_ != State::two && state_ != State::spent) {
    finger.at = contact.at;
    if (state_ == State::pressed) {
      out.push_back(make(Kind::tap, Phase::once, contact.time));
      const bool again = tapped_ && contact.time - last_tap_ <= limits_.double_tap &&
                         length(contact.at - last_tap_at_) <= limits_.near_px;
      if (again) out.push_back(make(Kind::double_tap, Phase::once, contact.time));
      tapped_ = !again;  // a third tap begins anew
      last_tap_ = contact.time;
      last_tap_at_ = contact.at;
    } else if (state_ == State::dragging) {
      Gesture g = make(Kind::drag, Phase::end, contact.time);
      g.step = finger.at - told_;
      out.push_back(g);
      const Vec2 v = velocity(contact.time);
      if (length(v) >= limits_.flick_px_per_s) {
        g = make(Kind::flick, Phase::once, contact.time);
        g.velocity = v;
        out.push_back(g);
      }
    }
    out.push_back(make(Kind::release, Phase::once, contact.time));
    state_ = State::idle;
    first_ = -1;
  } else if (state_ == State::two && (index == first_ || index == second_)) {
    end_two(contact.time, out);
    state_ = State::spent;  // the finger that stays would otherwise drag the picture away
  }
  const bool any =
      std::any_of(fingers_.begin(), fingers_.end(), [](const Finger& f) { return f.down && !f.palm; });
  if (!any) {
    state_ = State::idle;
    first_ = second_ = -1;
  }
}

void GestureRecogniser::cancel_one(Stamp time, std::vector<Gesture>& out) {
  if (state_ == State::dragging) out.push_back(make(Kind::drag, Phase::end, time));
  if (state_ == State::two) end_two(time, out);
  state_ = State::spent;
}

void GestureRecogniser::begin_two(Stamp) {
  const Vec2 a = fingers_[first_].at;
  const Vec2 b = fingers_[second_].at;
  state_ = State::two;
  start_centre_ = told_centre_ = 0.5f * (a + b);
  start_spread_ = told_spread_ = std::max(1.0f, length(b - a));
  told_angle_ = angle_of(b - a);
  turned_ = 0;
  pinching_ = twisting_ = sliding_ = false;
}

void GestureRecogniser::change_two(Stamp time, std::vector<Gesture>& out) {
  const Vec2 a = fingers_[first_].at;
  const Vec2 b = fingers_[second_].at;
  const Vec2 centre = 0.5f * (a + b);
  const float spread = std::max(1.0f, length(b - a));
  const auto tell = [&](Kind kind, bool& begun) -> Gesture& {
    Gesture g = make(kind, begun ? Phase::change : Phase::begin, time);
    begun = true;
    g.at = centre;
    out.push_back(g);
    return out.back();
  };

  if (sliding_ || length(centre - start_centre_) > limits_.slop_px) {
    tell(Kind::two_finger_drag, sliding_).step = centre - told_centre_;
    told_centre_ = centre;
  }
  if (pinching_ || std::abs(spread - start_spread_) > limits_.slop_px) {
    tell(Kind::pinch, pinching_).scale = spread / told_spread_;
    told_spread_ = spread;
  }
  // Angles close up only through many small steps, so the turn is summed, not taken from the start.
  const float angle = angle_of(b - a);
  turned_ += wrapped(angle - told_angle_);
  told_angle_ = angle;
  if (twisting_ || std::abs(turned_) > limits_.twist_rad) {
    tell(Kind::twist, twisting_).turn_rad = turned_;
    turned_ = 0;
  }
}

void GestureRecogniser::end_two(Stamp time, std::vector<Gesture>& out) {
  const auto tell = [&](Kind kind, bool begun) {
    if (!begun) return;
    Gesture g = make(kind, Phase::end, time);
    g.at = told_centre_;
    out.push_back(g);
  };
  tell(Kind::two_finger_drag, sliding_);
  tell(Kind::pinch, pinching_);
  tell(Kind::twist, twisting_);
}

}  // namespace sonoband::ui
