#include "app/screen/run.h"

#include <chrono>
#include <cmath>
#include <thread>

#include "app/bad_input.h"
#include "app/screen/loop.h"
#include "app/screen/screen_script.h"
#include "ui/host/headless.h"
#include "ui/host/window.h"

namespace sonoband {
namespace {

namespace script = screen_script;
using ui::Contact;
using ui::Vec2;

constexpr Duration frame_time = std::chrono::nanoseconds(16'666'667);

// Plays a script with one finger or two, frame by frame of the cart's clock.
class Player {
 public:
  Player(cart::Appliance& cart, const std::function<bool(bool)>& foot, const ScreenOptions& options, ScreenLoop& loop)
      : cart_(cart), foot_(foot), options_(options), loop_(loop) {}

  void play(const script::Step& step) {
    line_ = step.line;
    std::visit([this](const auto& action) { act(action); }, step.action);
  }

  void frame() {
    cart_.clock().sleep_until(now_ = cart_.clock().now() + frame_time);
    loop_.listen(now_);
    // The simulated clock waits for this thread, so pictures do not depend on how fast the machine renders.
    while (loop_.rendering()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    loop_.draw(input_, now_);
    input_.clear();
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw BadInput(options_.script_name + ":" + std::to_string(line_) + ": " + why);
  }
  int frames_of(Duration time) const { return std::max(1, static_cast<int>(std::lround(seconds(time) / seconds(frame_time)))); }
  void frames(int count) {
    for (int i = 0; i < count; ++i) frame();
  }
  ui::Rect find(const std::string& name) const {
    const auto widget = loop_.screen().widgets().find(name);
    if (!widget) refuse("nothing on the screen is called " + name);
    if (!widget->enabled) refuse(name + " cannot be used now");
    return widget->rect;
  }
  void contact(Contact::Kind kind, int id, Vec2 at) { input_.contacts.push_back({cart_.clock().now(), kind, id, at, 0}); }
  static Vec2 inside(const ui::Rect& r, Vec2 part) { return {r.x + part.x * r.width, r.y + part.y * r.height}; }

  void act(const script::Wait& wait) { frames(frames_of(wait.time)); }
  void act(const script::Pedal& pedal) {
    if (!foot_ || !foot_(pedal.down)) refuse("this board's pedal is real: a script cannot press it");
    frame();
  }
  void act(const script::Await& await) {
    for (int left = frames_of(await.at_most); cart::name_of(loop_.state()) != await.state; --left) {
      if (left == 0) refuse("the cart did not become " + await.state + " in time; it is " + cart::name_of(loop_.state()));
      frame();
    }
    frames(2);
  }
  void act(const script::Tap& tap) {
    const Vec2 at = find(tap.widget).centre();
    for (int i = 0; i < tap.times; ++i) {
      contact(Contact::Kind::down, 0, at);
      frames(3);
      contact(Contact::Kind::up, 0, at);
      frames(3);
    }
    frames(2);
  }
  void act(const script::Hold& hold) {
    const Vec2 at = find(hold.widget).centre();
    contact(Contact::Kind::down, 0, at);
    frames(frames_of(hold.time));
    contact(Contact::Kind::up, 0, at);
    frames(3);
  }
  void act(const script::Drag& drag) {
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
  void act(const script::Pinch& pinch) {
    const ui::Rect r = find(pinch.widget);
    const float from = 0.2f * std::min(r.width, r.height) / std::max(1.0f, pinch.scale);
    const int count = 24;
    const auto place = [&](int finger, int i) {
      const float part = static_cast<float>(i) / static_cast<float>(count);
      const float spread = from * (1 + part * (pinch.scale - 1));
      const float angle = part * pinch.turn_rad;
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
  void act(const script::KeyPress& press) {
    input_.keys.push_back(press.key);
    frames(2);
    ui::KeyEvent up = press.key;
    up.down = false;
    input_.keys.push_back(up);
    frame();
  }
  void act(const script::Shot& shot) {
    frames(2);
    loop_.save(shot.file);
  }

  cart::Appliance& cart_;
  const std::function<bool(bool)>& foot_;
  const ScreenOptions& options_;
  ScreenLoop& loop_;
  ui::Input input_;
  Stamp now_{};
  int line_ = 0;
};

}  // namespace

void run_window(cart::Appliance& cart, const std::function<bool(bool down)>& foot, const ScreenOptions& options) {
  ui::WindowSurface window({"Sonoband", options.width, options.height, options.full_screen});
  ScreenLoop loop(cart, foot, options, window);
  ui::Input input;
  // A new picture comes every 16 to 40 ms; looking every 4 costs nothing and shows it within a frame.
  constexpr Duration look_every = std::chrono::milliseconds(4);
  while (!loop.quits()) {
    window.poll(input, cart.clock().now(), look_every);
    const Stamp now = cart.clock().now();
    const bool news = loop.listen(now);
    if (!news && input.empty()) continue;
    loop.draw(input, now);
    input.clear();
    if (loop.wants_full_screen_toggle()) window.toggle_full_screen();
  }
}

void run_headless(cart::Appliance& cart, const std::function<bool(bool down)>& foot, const ScreenOptions& options) {
  const auto steps = script::parse(options.script, options.script_name);
  ui::HeadlessSurface surface(options.width, options.height);
  ScreenLoop loop(cart, foot, options, surface);
  Player player(cart, foot, options, loop);
  player.frame();
  for (const script::Step& step : steps) {
    if (loop.quits()) break;
    player.play(step);
  }
}

}  // namespace sonoband
