// A screen to try things on: a sweep over the simulated foetus, views of every page, and fingers.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/reslice/band.h"
#include "tests/support/test_sweep.h"
#include "ui/host/headless.h"
#include "ui/screen.h"

namespace sonoband::test {

// Made once and shared by all tests of the process: B-scans of the simulated foetus, and bands of them.
struct ShowExam {
  TestSweep sweep;
  SweepView view;
  ReslicePlane plane;
  BandImage band;
  BandImage thin;
};
const ShowExam& show_exam();

// A cart in good order on each page; borrows from show_exam.
ui::View live_view();
ui::View recording_view();
ui::View review_view();
ui::View exams_view();
ui::View set_up_view();

// A screen in memory whose time moves 1/60 s a frame.
class Bench {
 public:
  // Without `pixels` nothing is rasterised, unless SONOBAND_SHOTS is set: for tests that look at no picture.
  explicit Bench(int width = 1280, int height = 800, float scale = 1, bool pixels = false);

  const ui::Commands& frame(const ui::View& view);
  // Commands of a finger that does this on the widget called `name` (fails the test when there is none), over
  // as many frames as it takes.
  std::vector<ui::Command> tap(const ui::View& view, const std::string& name);
  std::vector<ui::Command> tap_at(const ui::View& view, ui::Vec2 at);
  std::vector<ui::Command> drag(const ui::View& view, ui::Vec2 from, ui::Vec2 to, int frames = 6);
  std::vector<ui::Command> pinch(const ui::View& view, ui::Vec2 centre, float from_px, float to_px,
                                 float turn_rad = 0);
  ui::Rect find(const std::string& name);  // in the last frame

  // With `SONOBAND_SHOTS` set, writes the last frame there as NAME.ppm.
  void shot(const std::string& name);

  ui::HeadlessSurface surface;
  std::unique_ptr<ui::Screen> screen;
  ui::Input input;
  Stamp now{std::chrono::seconds(100)};
};

// All commands of type C among `all`.
template <class C>
std::vector<C> only(const std::vector<ui::Command>& all) {
  std::vector<C> found;
  for (const ui::Command& c : all) {
    if (const C* it = std::get_if<C>(&c)) found.push_back(*it);
  }
  return found;
}

}  // namespace sonoband::test
