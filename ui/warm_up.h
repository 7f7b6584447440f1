// Frames that nobody sees: between them they hold every kind of draw call there is (draw_kinds.h), so that
// the driver has made its code for each before the first frame is shown. Without them the first frame with a
// picture took 183 ms and the first of Review 187, with a driver that finds nothing of an earlier run on the
// disk.
#pragma once

#include <vector>

#include "ui/draw.h"
#include "ui/pictures.h"
#include "ui/scene.h"

namespace sonoband::ui {

class WarmUp {
 public:
  static constexpr int frames = 6;  // grey smooth or not and Doppler, each covered or not

  WarmUp(Pictures& pictures, Scene& scene);
  ~WarmUp();  // the pictures it used are gone
  WarmUp(const WarmUp&) = delete;
  WarmUp& operator=(const WarmUp&) = delete;

  // Frame `i`; it must be sent before the next.
  void draw(int i, Draw& draw);

 private:
  Pictures& pictures_;
  Scene& scene_;
  TrackedFrame bscan_;
  std::vector<const TrackedFrame*> crowd_;  // the same one
};

}  // namespace sonoband::ui
