// The whole screen: makes a frame from a View and what happened, and says what the user asked for. The window
// and the headless host run this same function.
#pragma once

#include <memory>
#include <span>

#include "core/image/colour_bar.h"
#include "core/time.h"
#include "ui/command.h"
#include "ui/draw.h"
#include "ui/host/surface.h"
#include "ui/text.h"
#include "ui/view.h"
#include "ui/widgets.h"

namespace sonoband::ui {

struct ScreenSettings {
  float width_mm = 0;  // of the panel's picture area; 0: unknown
  float scale = 1;
  doppler::ColourBar bar = doppler::red_blue_bar();  // in which velocities are shown
};

// Lives on one thread, with its surface's context current whenever it is made, used or destroyed.
class Screen {
 public:
  // Throws std::runtime_error with one sentence when the fonts cannot be read or the driver is too old.
  Screen(const ScreenSettings& settings, const FontFiles& fonts, const Texts& texts);
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  // Draws what nobody is to see into the framebuffer that is bound, `size` pixels large: fonts and the
  // driver's code are made then, not in a frame. To be called once, before the first.
  void warm_up(Vec2 size);

  // Draws one frame into the framebuffer that is bound, `size` pixels large. What the input asked for is in
  // the commands returned, valid until the next call. `now` is the time of the frame on the clock of the
  // contacts.
  const Commands& frame(const View& view, const Input& input, Stamp now, Vec2 size);
  // The parts of it, in this order, to be timed apart: the panels' drawing commands; pictures sent; the
  // Outline drawn; the driver's work for the frame. `submit` no longer needs what the view lent.
  const Commands& build(const View& view, const Input& input, Stamp now, Vec2 size);
  void send_pictures();
  void draw_outline();
  void submit();

  // A finger rests and a long press may come of it: make another frame though nothing happens.
  bool wants_frame() const;

  // Of the last frame.
  const Widgets& widgets() const;
  const Metrics& metrics() const;

  struct Counts {
    std::uint64_t frames = 0;
    std::uint64_t gl_errors = 0;   // must stay 0
    std::uint64_t uploads = 0;     // pictures sent to the graphics processor
    std::uint64_t scenes = 0;      // times the Outline was drawn anew
    std::uint64_t kinds = 0;       // of draw call that the driver has met (draw_kinds.h)
    std::uint64_t late_kinds = 0;  // of them first in a frame, not in the warm-up; should be 0
  };
  Counts counts() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace sonoband::ui
