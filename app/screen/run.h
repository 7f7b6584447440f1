// The screen at work: the appliance's news in, a frame out, the operator's commands back.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/cart/appliance.h"
#include "app/screen/exporter.h"
#include "app/script/script.h"
#include "board/profile.h"
#include "core/geometry/plane.h"
#include "core/image/colour_bar.h"
#include "core/reslice/band.h"
#include "hal/sound/cue_player.h"
#include "ui/rect.h"
#include "ui/view.h"

namespace sonoband {

// What Set-up says of the pictures.
struct ProbeOptions {
  std::string name;
  double depth_mm = 0;
  bool calibrated = true;
  ui::Rect crop_px;
  int capture_width = 0;
  int capture_height = 0;
};

struct ScreenOptions {
  bool full_screen = false;
  int width = 1280;
  int height = 800;
  float width_mm = 0;  // of the panel; 0: unknown
  float scale = 1;
  doppler::ColourBar bar = doppler::red_blue_bar();  // in which velocities are shown
  std::filesystem::path shots = "out";               // folder of snapshots; made when the first is taken
  // Width of the scanner's beam across its picture, mm: B-scans farther apart leave gaps. Usual: 1 to 3.
  double beam_width_mm = 1;
  PedalMode pedal = PedalMode::hold;
  ProbeOptions probe;
  std::string version;
  ExporterSettings exports;
  // Gets every band that is shown whole, on the screen's thread. May be empty.
  std::function<void(const BandImage& band, const ReslicePlane& plane, int layers)> on_band;
  // What is sent to other programs, for the status bar. Empty: nothing is.
  std::function<ui::StreamStatus()> stream;
};

// Presses the cart's simulated pedal (true: down). Empty where the pedal is real: then the screen's button
// and the space bar work through the cart's record button.
using Foot = std::function<bool(bool down)>;

// In a window, until it is closed or the program is told to end (SIGINT, SIGTERM). `cart` is started and
// owned by the calling thread. `touch` is the board's touchscreen, read on a thread of its own; null: fingers
// come through the window system. `cues` makes the sounds; null: none. Throws std::runtime_error with one
// sentence when there is no display, BadInput where a font or a folder fails.
void run_window(cart::Appliance& cart, const Foot& foot, const ScreenOptions& options, Touch* touch = nullptr,
                CuePlayer* cues = nullptr);

// In memory, until the script is over. `touch` as above; null: only the script's fingers. The calling thread
// is a member of the cart's clock. The same script gives the same pictures on a simulated clock. Throws
// script::ScriptFailed, and as above.
void run_headless(cart::Appliance& cart, const Foot& foot, const ScreenOptions& options,
                  const std::vector<script::Step>& steps, const std::string& script_name,
                  Touch* touch = nullptr);

}  // namespace sonoband
