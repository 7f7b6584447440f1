// The screen at work: the appliance's news in, a frame out, the operator's commands back.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "app/cart/appliance.h"

namespace sonoband {

struct ScreenOptions {
  bool full_screen = false;
  int width = 1280;
  int height = 800;
  float width_mm = 0;  // of the panel; 0: unknown
  float scale = 1;
  std::string script;                       // text of a script (app/screen/screen_script.h); empty: none
  std::string script_name = "the script";   // in sentences
  std::filesystem::path shots = "out";      // folder of snapshots; made when the first is taken
  // Width of the scanner's beam across its picture, mm: B-scans farther apart leave gaps. Usual: 1 to 3.
  double beam_width_mm = 1;
  bool toggle_pedal = false;  // the pedal's mode, from the machine's profile
  std::string version;
};

// In a window, until it is closed. `cart` is started and owned by the calling thread; `foot` presses its pedal
// (true: down) and may be empty: then the record button is used. Throws std::runtime_error with one sentence when
// there is no display, BadInput where a font or a folder fails.
void run_window(cart::Appliance& cart, const std::function<bool(bool down)>& foot, const ScreenOptions& options);

// In memory, until the script is over. The calling thread is a member of the cart's clock; renderings are waited
// for, so the same script gives the same pictures on a simulated clock. Throws BadInput when a widget is not there
// or a state does not come, naming the line.
void run_headless(cart::Appliance& cart, const std::function<bool(bool down)>& foot, const ScreenOptions& options);

}  // namespace sonoband
