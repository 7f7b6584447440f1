// The part of a frame's picture that a tile takes: asked for ahead, or turned, so that pixel columns lie
// along memory where lanes run along them.
#pragma once

#include <cstddef>
#include <vector>

#include "core/reslice/chain.h"
#include "core/reslice/lattice.h"
#include "core/reslice/patch.h"

namespace sonoband {

// Columns left .. right, rows top .. bottom of a picture, or a little beyond it.
struct PicturePart {
  int left = 0, right = 0, top = 0, bottom = 0;
  int columns() const { return right - left + 1; }
  int rows() const { return bottom - top + 1; }
};

// Every pixel, and every tap, that samples of `tile` take which are within `reach_mm` of the candidate. `at`
// gives the positions.
PicturePart part_within(double reach_mm, const FrameEntry& frame, const Candidate& candidate,
                        const Lattice& lattice, const LatticeBlock& tile, const ChainFrame& at);

// Its rows as far as they are the picture's, none of them asked for yet.
RowsAhead rows_ahead(const FrameEntry& frame, const PicturePart& part);

// How far a candidate of a chain may be from the samples that take it, in mm: half the widest gaps beside it,
// or with blends all of them; at an end of the chain its own reach. By candidate.
std::vector<double> chain_reaches(const FrameTable& table, const std::vector<Candidate>& candidates,
                                  const Chain& chain, const SampleBox& box, Interpolation interpolation);

// The same of the picture turned.
inline PicturePart turned_part(const PicturePart& part) {
  return {part.top, part.bottom, part.left, part.right};
}
void turn_positions(ChainFrame& at);

// Parts of pictures turned, one after another.
class TurnedParts {
 public:
  void clear();
  // `at`, of the frame's own picture, becomes the part's.
  void add(const FrameEntry& frame, const PicturePart& part, ChainFrame& at);
  // The i-th added as a picture, once there is room; its pixels are there once they are turned.
  FrameEntry picture(std::size_t i) const;
  // Tells a patch of the i-th which pixels of the part are the picture's.
  void bound(std::size_t i, PatchFrame& patch) const;
  // Makes room for those added.
  void lay_out() { pixels_.resize(size_); }
  // Turns them.
  void turn();

 private:
  struct Part {
    const FrameEntry* frame;
    PicturePart part;
    std::size_t first;      // in pixels_
    std::ptrdiff_t stride;  // from one pixel column to the next
  };
  std::vector<Part> parts_;
  std::size_t size_ = 0;
  std::vector<std::uint8_t> pixels_;
};

}  // namespace sonoband
