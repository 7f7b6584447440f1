#include "core/reslice/lattice.h"

namespace sonoband {

Lattice lattice_through(const Eigen::Vector3d& origin, const Eigen::Vector3d& per_sample,
                        const Eigen::Vector3d& last_row, const Eigen::Vector3d& last_layer, int samples,
                        int rows, int layers) {
  Lattice lattice{origin, per_sample, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), samples,
                  rows,   layers};
  if (rows > 1) lattice.per_row = (last_row - origin) / (rows - 1);
  if (layers > 1) lattice.per_layer = (last_layer - origin) / (layers - 1);
  return lattice;
}

std::optional<Lattice> lattice_of(const LineBundle& bundle) {
  if (bundle.rows <= 0 || bundle.layers <= 0) return std::nullopt;
  for (const std::uint8_t p : bundle.present)
    if (p == 0) return std::nullopt;
  const auto start = [&](int row, int layer) -> const Eigen::Vector3d& {
    return bundle.starts[static_cast<std::size_t>(row) * bundle.layers + layer].v;
  };
  const Lattice lattice =
      lattice_through(start(0, 0), bundle.step.v, start(bundle.rows - 1, 0), start(0, bundle.layers - 1),
                      bundle.samples, bundle.rows, bundle.layers);
  constexpr double off_mm = 1e-6;
  for (int row = 0; row < bundle.rows; ++row) {
    const Eigen::Vector3d first = lattice.at(0, row, 0);
    for (int layer = 0; layer < bundle.layers; ++layer) {
      if ((start(row, layer) - first - layer * lattice.per_layer).squaredNorm() > off_mm * off_mm)
        return std::nullopt;
    }
  }
  return lattice;
}

Lattice in_own_coordinates(const Lattice& lattice) {
  return {Eigen::Vector3d::Zero(),
          Eigen::Vector3d::UnitX(),
          Eigen::Vector3d::UnitY(),
          Eigen::Vector3d::UnitZ(),
          lattice.samples,
          lattice.rows,
          lattice.layers};
}

FrameTable seen_from(const Lattice& lattice, const FrameTable& table) {
  FrameTable seen = table;
  const auto see = [&](AffineScalar& f) {
    f.offset = f.at(lattice.origin);
    f.gradient = {f.gradient.dot(lattice.per_sample), f.gradient.dot(lattice.per_row),
                  f.gradient.dot(lattice.per_layer)};
  };
  for (FrameEntry& f : seen.frames) {
    see(f.x_px);
    see(f.y_px);
    see(f.z_mm);
  }
  return seen;
}

SampleBox box_of(const LatticeBlock& block) {
  SampleBox box;
  box.along = {(block.width - 1) / 2.0, (block.height - 1) / 2.0, (block.depth - 1) / 2.0};
  box.centre = Eigen::Vector3d(block.a, block.b, block.l) + box.along;
  return box;
}

}  // namespace sonoband
