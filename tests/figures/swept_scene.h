// One sweep of a simulated scene, pictures and true poses, without devices or threads.
#pragma once

#include <string>
#include <vector>

#include "core/sweep/tracked_frame.h"
#include "hal/sim/scene.h"

namespace sonoband::figures {

struct SweptScene {
  sim::SimulatedScene scene;
  std::vector<Pixels> pictures;  // grey, or Doppler keys where the scanner shows colour
  std::vector<TrackedFrame> frames;
  std::vector<const TrackedFrame*> pointers;
  Pixels mask;  // of the body; without what the scanner draws over it

  SweepView view() const { return {pointers, mask.view()}; }
};

// `frames` of the hand's first sweep. Colour is classified from the screen as a grabber would deliver it;
// `mask_overlay` leaves the scanner's white box out, as the cart does.
SweptScene sweep(const std::string& preset, int frames, bool mask_overlay = true);

}  // namespace sonoband::figures
