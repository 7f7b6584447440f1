// What the fuzz targets of both sequence formats share.
#pragma once

#include <algorithm>

#include "app/bad_input.h"
#include "app/exchange/sequence.h"
#include "app/exchange/sequence_summary.h"

namespace sonoband::fuzz {

constexpr exchange::SequenceLimits limits{
    .max_pixel_bytes = 1 << 20, .max_frames = 2'000, .max_side_px = 4096};

// Everything that is done with a sequence before it is rendered.
inline void touch(const exchange::TrackedSequence& s) {
  exchange::ReadSequence copy;
  copy.sequence.frames = s.frames;
  copy.sequence.fields = s.fields;
  copy.sequence.width = s.width;
  copy.sequence.height = s.height;
  try {
    exchange::summarise(copy, std::nullopt, "fuzz");
  } catch (const BadInput&) {
    return;
  }
}

// Not the geometry: lengths and directions are multiplied and divided on the way through NRRD.
inline bool same(const exchange::TrackedSequence& a, const exchange::TrackedSequence& b) {
  const auto pa = a.pixels.bytes();
  const auto pb = b.pixels.bytes();
  return a.width == b.width && a.height == b.height && a.slices == b.slices && a.components == b.components &&
         a.element_type == b.element_type && a.fields == b.fields && a.orientation == b.orientation &&
         a.image_type == b.image_type &&
         std::equal(a.frames.begin(), a.frames.end(), b.frames.begin(), b.frames.end(),
                    [](const auto& x, const auto& y) { return x.fields == y.fields; }) &&
         std::equal(pa.begin(), pa.end(), pb.begin(), pb.end());
}

}  // namespace sonoband::fuzz
