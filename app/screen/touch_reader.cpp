#include "app/screen/touch_reader.h"

#include <utility>

namespace sonoband {

ui::Contact contact_of(const TouchEvent& event, const ui::Rect& panel_px) {
  const auto kind = event.kind == TouchEvent::Kind::down   ? ui::Contact::Kind::down
                    : event.kind == TouchEvent::Kind::move ? ui::Contact::Kind::move
                                                           : ui::Contact::Kind::up;
  const ui::Vec2 at{panel_px.x + event.x * panel_px.width, panel_px.y + event.y * panel_px.height};
  return {event.time, kind, event.contact, at, event.major_mm};
}

TouchReader::TouchReader(Touch& touch, Clock& clock, std::function<void()> wake)
    : touch_(touch), clock_(clock), wake_(std::move(wake)), thread_(clock, [this] { read(); }) {}

TouchReader::~TouchReader() {
  stop_ = true;
  thread_.join();
}

void TouchReader::read() {
  constexpr Duration stop_heard = std::chrono::milliseconds(50);
  constexpr Duration frame_soon = std::chrono::milliseconds(2);
  touch_.start();
  TouchEvent event;
  while (!stop_) {
    if (touch_.read(event, stop_heard) != ReadStatus::ok) continue;
    while (!events_.try_emplace(event) && !stop_) clock_.sleep_until(clock_.now() + frame_soon);
    wake_();
  }
  touch_.stop();
}

void TouchReader::take(const ui::Rect& panel_px, ui::Input& input) {
  for (const TouchEvent* event = events_.front(); event != nullptr; event = events_.front()) {
    input.contacts.push_back(contact_of(*event, panel_px));
    events_.pop();
  }
}

}  // namespace sonoband
