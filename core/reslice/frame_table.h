// What a rendering needs of each frame, gathered in order of capture so that of equal distances the greater
// index wins.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/reslice/band.h"

namespace sonoband {

// One row of image_from_world: value(P) = gradient . P + offset. P is in World, or in the coordinates of a
// lattice where `seen_from` (lattice.h) made the table.
struct AffineScalar {
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double offset = 0;
  double at(const Eigen::Vector3d& p) const { return gradient.dot(p) + offset; }
};

struct FrameEntry {
  AffineScalar x_px, y_px, z_mm;                     // of image_from_world; z along the frame's own normal
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // z_mm's gradient in World, whatever P is in
  double gap_mm = 0;                                 // d of the definition
  bool flipped = false;  // its sweep's normals count reversed (the definition's sides)
  const std::uint8_t* pixels = nullptr;
  std::ptrdiff_t stride = 0;
  int width = 0;
  int height = 0;
  // The same picture turned, as rows of `height` pixels (turned_frames.h); null: it is not kept.
  const std::uint8_t* turned = nullptr;
  std::ptrdiff_t turned_stride = 0;
};

// How many pixels of a rectangle the mask keeps, in constant time: is a foot's neighbourhood all ultrasound?
class MaskSums {
 public:
  MaskSums() = default;
  explicit MaskSums(MaskView mask);
  bool empty() const { return sums_ == nullptr; }
  // Pixels kept with x0 <= x <= x1, y0 <= y <= y1, which must lie in the picture.
  std::uint32_t kept(int x0, int y0, int x1, int y1) const;

 private:
  int width_ = 0;
  // (width + 1) x (height + 1), of the pixels above and to the left; shared by the copies of a table.
  std::shared_ptr<const std::vector<std::uint32_t>> sums_;
};

struct FrameTable {
  std::vector<FrameEntry> frames;  // earliest first
  MaskView mask;
  MaskSums mask_sums;
  PixelKind kind = PixelKind::grey;
  bool complete = true;  // false: frames of the sweep were left out (thinning.h)
};

// Their indices, ascending.
std::vector<int> all_frames(const FrameTable& table);

FrameTable make_frame_table(const SweepView& sweep, const GapLimit& gap);

}  // namespace sonoband
