// A recording made ready for rendering: pixels, poses in one world, mask; and what was left out, by cause.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/exchange/plus_config.h"
#include "app/exchange/sequence.h"
#include "app/exchange/transform_graph.h"
#include "core/image/colour_bar.h"
#include "core/sweep/tracked_frame.h"

namespace sonoband::exchange {

// What the colours of an RGB recording are taken for.
enum class ColourUse : std::uint8_t {
  automatic,  // Doppler if the recording shows flow (shows_flow), else grey
  doppler,
  grey,  // luma
};

struct SweepRequest {
  std::string world;                          // empty: default_world
  std::optional<std::pair<int, int>> frames;  // first and last, both included, from 0
  std::optional<ClipRectangle> clip;          // besides the configuration's
  bool mask = true;  // false: neither the configuration's clip and fan nor `clip` nor the scanner's drawings
  ColourUse colour = ColourUse::automatic;
  doppler::ColourBar bar = doppler::red_blue_bar();  // the scanner's, by which colours become velocities
};

struct LeftOut {
  std::string cause;
  int frames = 0;
};

// Owns what its view() borrows; may be moved, the view may not outlive it.
struct SequenceSweep {
  TrackedSequence sequence;  // its pixels are one byte each now, of the kind below
  PixelKind kind = PixelKind::grey;
  std::string world;
  std::vector<std::string> links;    // the way from Image to world, for people
  std::vector<TrackedFrame> frames;  // those that can be rendered, in the order of the file
  std::vector<const TrackedFrame*> frame_pointers;
  Pixels mask;  // empty: every pixel counts
  std::vector<LeftOut> left_out;
  std::vector<std::string> warnings;

  SweepView view() const { return {frame_pointers, mask.view()}; }
};

// Header-level transforms of the file and those of the configuration (may be null).
TransformGraph shared_transforms(const TrackedSequence& sequence, const PlusConfig* config,
                                 const std::string& file);

// "Reference" if a transform of the file, in any frame or its header, has it; else "Tracker"; empty: neither.
// Configurations do not count: they may know of frames that were not tracked in this recording.
std::string default_world(const TrackedSequence& sequence);

// Every frame that has a picture and a usable way from Image to the world. RGB becomes Doppler keys by the
// request's bar, with what the scanner draws masked out (make_doppler), or luma (BT.601); samples other than
// 8-bit grey are taken as they are where all lie in 0..255, else stretched linearly from the sequence's
// smallest and largest value to 0..255; a warning says which. Frames keep the order of the file; their stamps
// count only where every frame has one and they never fall. Throws BadInput where nothing can be rendered, or
// a pose or calibration is none.
SequenceSweep sweep_from_sequence(ReadSequence&& read, const PlusConfig& config, const SweepRequest& request,
                                  const std::string& file);

}  // namespace sonoband::exchange
