#include "app/screen/player.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>

namespace sonoband {
namespace {

using ui::Contact;
using ui::Vec2;

constexpr Duration frame_time = std::chrono::nanoseconds(16'666'667);

int frames_of(Duration time) {
  return std::max(1, static_cast<int>(std::lround(seconds(time) / seconds(frame_time))));
}

// At once: whoever reads along acts on it.
void say(const nlohmann::ordered_json& line) {
  std::printf("%s\n", line.dump().c_str());
  std::fflush(stdout);
}

Vec2 inside(const ui::Rect& r, Vec2 part) {
  return {r.x + part.x * r.width, r.y + part.y * r.height};
}

}  // namespace

void Player::play(const script::Step& step) {
  line_ = step.line;
  std::visit([this](const auto& action) { act(action); }, step.action);
}

void Player::frame() {
  cart_.clock().sleep_until(cart_.clock().now() + frame_time);
  const Stamp now = cart_.clock().now();
  if (fingers_ != nullptr) {
    fingers_->take(panel_px_, input_);
    loop_.tell_touch(fingers_->health());
  }
  const bool news = loop_.listen(now);
  loop_.wait_for_renderings();
  // As in a window: a frame is drawn only when there is something new in it.
  if (!news && input_.empty() && !loop_.rendered()) return;
  loop_.draw(input_, now);
  input_.clear();
}

void Player::give_touch(TouchReader& fingers, const ui::Rect& panel_px) {
  fingers_ = &fingers;
  panel_px_ = panel_px;
}

void Player::fail(const std::string& sentence) const {
  throw script::ScriptFailed(file_ + ":" + std::to_string(line_) + ": " + sentence);
}

void Player::frames(int count) {
  for (int i = 0; i < count; ++i) frame();
}

ui::Rect Player::find(const std::string& name) const {
  const auto widget = loop_.screen().widgets().find(name);
  if (!widget) fail("nothing on the screen is called " + name);
  if (!widget->enabled) fail(name + " cannot be used now");
  return widget->rect;
}

void Player::contact(Contact::Kind kind, int id, Vec2 at) {
  input_.contacts.push_back({cart_.clock().now(), kind, id, at, 0});
}

void Player::act(const script::Wait& wait) {
  frames(frames_of(wait.time));
}

void Player::step_on(bool down) {
  if (!foot_) fail("this board's pedal is real; step on it, or use the board sim");
  if (!foot_(down)) fail("the simulated pedal has too many presses waiting; wait between them");
  frame();
}

void Player::act(const script::Await& await) {
  for (int left = frames_of(await.at_most); cart::name_of(loop_.state()) != await.state; --left) {
    if (left == 0) {
      std::ostringstream within;
      within << seconds(await.at_most);
      fail("the cart was to be in " + await.state + " within " + within.str() + " s and is in " +
           cart::name_of(loop_.state()));
    }
    frame();
  }
  frames(2);
}

void Player::act(const script::ScreenAction& action) {
  std::visit([this](const auto& what) { touch(what); }, action);
}

void Player::touch(const script::Tap& tap) {
  const Vec2 at = find(tap.widget).centre();
  for (int i = 0; i < tap.times; ++i) {
    contact(Contact::Kind::down, 0, at);
    frames(3);
    contact(Contact::Kind::up, 0, at);
    frames(3);
  }
  // Until the next tap cannot be taken for its second.
  frames(24);
}

void Player::touch(const script::Hold& hold) {
  const Vec2 at = find(hold.widget).centre();
  contact(Contact::Kind::down, 0, at);
  frames(frames_of(hold.time));
  contact(Contact::Kind::up, 0, at);
  frames(3);
}

void Player::touch(const script::Drag& drag) {
  const ui::Rect r = find(drag.widget);
  contact(Contact::Kind::down, 0, inside(r, drag.way.front()));
  frame();
  const int count = frames_of(drag.time);
  const auto legs = static_cast<float>(drag.way.size() - 1);
  for (int i = 1; i <= count; ++i) {
    const float along = legs * static_cast<float>(i) / static_cast<float>(count);
    const auto leg = std::min(static_cast<std::size_t>(along), drag.way.size() - 2);
    const Vec2 part = drag.way[leg] + (along - static_cast<float>(leg)) * (drag.way[leg + 1] - drag.way[leg]);
    contact(Contact::Kind::move, 0, inside(r, part));
    frame();
  }
  frames(8);  // at rest before it lifts: no flick
  contact(Contact::Kind::up, 0, inside(r, drag.way.back()));
  frames(3);
}

void Player::touch(const script::TwoFingers& two) {
  const ui::Rect r = find(two.widget);
  const float from = 0.2f * std::min(r.width, r.height) / std::max(1.0f, two.scale);
  constexpr int count = 24;
  const auto place = [&](int finger, int i) {
    const float part = static_cast<float>(i) / static_cast<float>(count);
    const float spread = from * (1 + part * (two.scale - 1));
    const float angle = part * two.turn_rad;
    const Vec2 arm{spread * std::cos(angle), spread * std::sin(angle)};
    return finger == 0 ? r.centre() - arm : r.centre() + arm;
  };
  for (const int finger : {0, 1}) contact(Contact::Kind::down, finger, place(finger, 0));
  frame();
  for (int i = 1; i <= count; ++i) {
    for (const int finger : {0, 1}) contact(Contact::Kind::move, finger, place(finger, i));
    frame();
  }
  for (const int finger : {0, 1}) contact(Contact::Kind::up, finger, place(finger, count));
  frames(3);
}

void Player::touch(const script::KeyPress& press) {
  input_.keys.push_back(press.key);
  frames(2);
  ui::KeyEvent up = press.key;
  up.down = false;
  input_.keys.push_back(up);
  frame();
}

void Player::touch(const script::Shot& shot) {
  frames(2);
  loop_.draw(input_, cart_.clock().now());
  loop_.save(shot.file);
}

void Player::touch(const script::Where& where) {
  const Vec2 at = find(where.widget).centre();
  const Vec2 size = loop_.size_px();
  say({{"widget", where.widget}, {"x", at.x / size.x}, {"y", at.y / size.y}});
}

void Player::touch(const script::AwaitPage& await) {
  const Stamp until = cart_.clock().now() + await.at_most;
  while (loop_.session().page() != await.page) {
    if (cart_.clock().now() >= until) {
      std::ostringstream sentence;
      sentence << "the page " << script::name_of(await.page) << " was to be shown within "
               << seconds(await.at_most) << " s and " << script::name_of(loop_.session().page()) << " is";
      fail(sentence.str());
    }
    frame();
  }
  say({{"page", script::name_of(await.page)}});
}

}  // namespace sonoband
