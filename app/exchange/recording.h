// A recorded sequence as a replay plays it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/exchange/plus_config.h"
#include "app/exchange/sequence.h"
#include "hal/replay/replay.h"

namespace sonoband::exchange {

struct ReplayMaterial {
  std::shared_ptr<const Recording> recording;
  Affine<frame::Probe, frame::Image> probe_from_image;
  Pixels mask;  // empty: every pixel counts
  std::vector<std::string> warnings;
};

// Poses are those of the probe in the sequence's default world (Reference if there is one, else Tracker), one
// for each frame at the frame's own stamp; a frame whose chain is not OK has a pose that is missing. Needs a
// frame called Probe, and time stamps that rise. Grey or RGB pictures of 8 bits; others are brought to grey
// as sweep_from_sequence does. Throws BadInput.
ReplayMaterial replay_material(ReadSequence&& read, const PlusConfig& config, const std::string& file);

// The calibration of a cart, from its configuration alone. Throws BadInput naming `file` if no transform
// leads from Image to Probe.
Affine<frame::Probe, frame::Image> probe_from_image(const PlusConfig& config, const std::string& file);

}  // namespace sonoband::exchange
