#include "app/screen/run.h"

#include <chrono>
#include <optional>

#include "app/interrupt.h"
#include "app/screen/loop.h"
#include "app/screen/player.h"
#include "app/screen/touch_reader.h"
#include "ui/host/headless.h"
#include "ui/host/window.h"

namespace sonoband {

void run_window(cart::Appliance& cart, const Foot& foot, const ScreenOptions& options, Touch* touch,
                CuePlayer* cues) {
  ui::WindowSurface window({"Sonoband", options.width, options.height, options.full_screen});
  ScreenLoop loop(cart, foot, options, window, [&window] { window.wake(); });
  loop.give_sound(cues);
  std::optional<TouchReader> fingers;
  if (touch != nullptr) fingers.emplace(*touch, cart.clock(), [&window] { window.wake(); });
  ui::Input input;
  const Interruptible interruptible;
  while (!loop.quits() && !interruptible.asked_to_stop()) {
    window.poll(input, cart.clock().now(), loop.may_sleep());
    if (fingers) {
      fingers->take(window.panel_px(), input);
      loop.tell_touch(fingers->health());
    }
    const Stamp now = cart.clock().now();
    const bool news = loop.listen(now);
    if (!news && input.empty()) continue;
    loop.draw(input, now);
    input.clear();
    if (loop.wants_full_screen_toggle()) window.toggle_full_screen();
  }
}

void run_headless(cart::Appliance& cart, const Foot& foot, const ScreenOptions& options,
                  const std::vector<script::Step>& steps, const std::string& script_name, Touch* touch) {
  ui::HeadlessSurface surface(options.width, options.height);
  ScreenLoop loop(cart, foot, options, surface);
  Player player(cart, foot, loop, script_name);
  std::optional<TouchReader> fingers;
  if (touch != nullptr) {
    fingers.emplace(*touch, cart.clock(), [] {});  // the player looks at each frame
    player.give_touch(*fingers, {0, 0, surface.size_px().x, surface.size_px().y});
  }
  player.frame();
  for (const script::Step& step : steps) {
    if (loop.quits()) break;
    player.play(step);
  }
}

}  // namespace sonoband
