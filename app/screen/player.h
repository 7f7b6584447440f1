// A scripted hand: plays a script's actions on the screen and the pedal, frame by frame of the cart's clock.
#pragma once

#include <functional>
#include <string>

#include "app/screen/loop.h"
#include "app/screen/touch_reader.h"
#include "app/script/script.h"

namespace sonoband {

class Player {
 public:
  // `foot` presses the cart's simulated pedal and may be empty; `file` names the script in sentences. The
  // calling thread is a member of the cart's clock.
  Player(cart::Appliance& cart, const std::function<bool(bool down)>& foot, ScreenLoop& loop,
         std::string file)
      : cart_(cart), foot_(foot), loop_(loop), file_(std::move(file)) {}

  // Throws script::ScriptFailed when the pedal, a widget or a state is not there.
  void play(const script::Step& step);
  // 1/60 s passes and the screen is drawn if there is anything new, with the renderings it asked for: the
  // simulated clock stands still meanwhile, so pictures do not depend on how fast the machine renders.
  void frame();

  // From here on fingers on the board's own touchscreen count as well; `panel_px` is the screen. `fingers`
  // outlives the player.
  void give_touch(TouchReader& fingers, const ui::Rect& panel_px);

  // What the fingers do between frames, for those who play without a script.
  ui::Input& input() { return input_; }

 private:
  [[noreturn]] void fail(const std::string& sentence) const;
  void frames(int count);
  ui::Rect find(const std::string& name) const;
  void contact(ui::Contact::Kind kind, int id, ui::Vec2 at);

  void act(const script::Wait& wait);
  void act(const script::Press&) { step_on(true); }
  void act(const script::Release&) { step_on(false); }
  void act(const script::Await& await);
  void act(const script::WatchCart&) { fail("watch works without the screen"); }
  void act(const script::Render&) { fail("render works without the screen"); }
  void act(const script::Manifold&) { fail("manifold works without the screen"); }
  void act(const script::ScreenAction& action);
  void step_on(bool down);
  void touch(const script::Tap& tap);
  void touch(const script::Hold& hold);
  void touch(const script::Drag& drag);
  void touch(const script::TwoFingers& two);
  void touch(const script::KeyPress& press);
  void touch(const script::Shot& shot);
  void touch(const script::Where& where);
  void touch(const script::AwaitPage& await);

  cart::Appliance& cart_;
  const std::function<bool(bool)>& foot_;
  ScreenLoop& loop_;
  std::string file_;
  ui::Input input_;
  TouchReader* fingers_ = nullptr;  // null: the board has no touchscreen
  ui::Rect panel_px_;
  int line_ = 0;
};

}  // namespace sonoband
