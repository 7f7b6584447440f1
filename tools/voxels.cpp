#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>

#include "app/bad_input.h"
#include "app/exchange/text.h"
#include "app/exchange/volume.h"
#include "app/interrupt.h"
#include "app/workers.h"
#include "tools/argument_checks.h"
#include "tools/plane_options.h"
#include "tools/render_options.h"
#include "tools/sweep_options.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

constexpr int max_side = 32'768;
constexpr double max_voxels = 64e9;

struct LatticeOptions {
  double spacing_mm = 0;
  std::string origin;
  std::string dims;
  std::filesystem::path out;
};

std::array<int, 3> dims_of(const std::string& text) {
  const auto n = comma_numbers(text, 3, "--dims");
  std::array<int, 3> dims{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (n[i] != std::floor(n[i]) || n[i] < 1 || n[i] > max_side)
      throw CLI::ValidationError("--dims",
                                 "'" + text + "' is not three counts of 1 to " + std::to_string(max_side));
    dims[i] = static_cast<int>(n[i]);
  }
  return dims;
}

void check(const LatticeOptions& o) {
  if (o.origin.empty() != o.dims.empty())
    throw CLI::ValidationError("--origin", "--origin and --dims belong together");
  if (o.origin.empty()) return;
  comma_vector(o.origin, "--origin");
  dims_of(o.dims);
}

// World axes, around the outermost masked pixels of every frame.
exchange::VoxelLattice around(const SweepView& sweep, double spacing_mm) {
  int left = 0;
  int top = 0;
  int right = sweep.frames.front()->bscan.pixels.width - 1;
  int bottom = sweep.frames.front()->bscan.pixels.height - 1;
  if (!sweep.mask.empty()) {
    std::swap(left, right);
    std::swap(top, bottom);
    for (int y = 0; y < sweep.mask.height; ++y)
      for (int x = 0; x < sweep.mask.width; ++x)
        if (sweep.mask(x, y) != 0) {
          left = std::min(left, x);
          right = std::max(right, x);
          top = std::min(top, y);
          bottom = std::max(bottom, y);
        }
  }
  Eigen::Vector3d least = Eigen::Vector3d::Constant(std::numeric_limits<double>::max());
  Eigen::Vector3d most = -least;
  for (const TrackedFrame* f : sweep.frames)
    for (const int x : {left, right})
      for (const int y : {top, bottom}) {
        const auto p = f->world_from_image * Point<frame::Image>{{double(x), double(y), 0}};
        least = least.cwiseMin(p.v);
        most = most.cwiseMax(p.v);
      }
  exchange::VoxelLattice lattice{.origin_mm = {least.x(), least.y(), least.z()}, .spacing_mm = spacing_mm};
  for (int axis = 0; axis < 3; ++axis) {
    const double count = std::ceil((most[axis] - least[axis]) / spacing_mm) + 1;
    if (count > max_side)
      throw BadInput("the recording's bounding box has " + exchange::format_number(count) +
                     " voxels on one side; give a larger --spacing-mm, or --origin and --dims.");
    lattice.dims[axis] = static_cast<int>(count);
  }
  return lattice;
}

void voxels(const SweepOptions& sweep_options, const RenderOptions& render_options, const LatticeOptions& o) {
  check_sweep_options(sweep_options);
  check(o);
  check_files_apart(files_read(sweep_options), {{"--out", o.out}});
  const RenderSettings settings = settings_of(render_options, o.spacing_mm);

  const exchange::SequenceSweep sweep = load_sweep(sweep_options);
  const SweepView view = sweep.view();
  exchange::VoxelLattice lattice;
  if (o.origin.empty()) {
    lattice = around(view, o.spacing_mm);
  } else {
    const Eigen::Vector3d origin = comma_vector(o.origin, "--origin");
    lattice = {{origin.x(), origin.y(), origin.z()}, dims_of(o.dims), o.spacing_mm};
  }
  const auto [columns, rows, slices] = lattice.dims;
  if (double(columns) * rows * slices > max_voxels)
    throw BadInput("the lattice has more than 64 thousand million voxels; give a larger --spacing-mm.");

  Workers workers(threads_of(render_options));
  exchange::VolumeWriter writer(o.out, lattice,
                                "Resliced by sonoband-tool in " + sweep.world + ", research use only");
  Progress progress("voxels");
  const Interruptible interruptible;
  std::int64_t covered = 0;
  for (int k = 0; k < slices; ++k) {
    progress.show(k, slices);
    if (interruptible.asked_to_stop())
      throw BadInput(o.out.string() + ": stopped before the volume was whole; nothing is left of it");
    const Eigen::Vector3d origin(lattice.origin_mm[0], lattice.origin_mm[1],
                                 lattice.origin_mm[2] + k * lattice.spacing_mm);
    const auto plane = make_plane(origin, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), columns, rows,
                                  lattice.spacing_mm);
    const BandImage slice = render_planar(view, *plane, settings, workers);
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) covered += slice.coverage.view()(x, y) != 0;
    writer.write_slice(slice.pixels.view());
  }
  writer.finish();
  std::printf("%s: %d x %d x %d voxels of %s mm from (%s, %s, %s) mm in %s, %zu frames, %.1f %% covered\n",
              o.out.c_str(), columns, rows, slices, exchange::format_number(lattice.spacing_mm).c_str(),
              exchange::format_number(lattice.origin_mm[0]).c_str(),
              exchange::format_number(lattice.origin_mm[1]).c_str(),
              exchange::format_number(lattice.origin_mm[2]).c_str(), sweep.world.c_str(), sweep.frames.size(),
              100.0 * static_cast<double>(covered) / (double(columns) * rows * slices));
  for (const exchange::LeftOut& l : sweep.left_out)
    std::printf("left out: %d frames, %s\n", l.frames, l.cause.c_str());
}

}  // namespace

void add_voxels(CLI::App& tool) {
  CLI::App* verb =
      tool.add_subcommand("voxels", "Reslice a recording into a voxel array (MetaImage, 0 = no data)");
  const auto sweep = add_sweep_options(*verb);
  const auto render_options = add_render_options(*verb);
  auto o = std::make_shared<LatticeOptions>();
  verb->add_option("--spacing-mm", o->spacing_mm, "Side of a voxel in mm")
      ->required()
      ->check(number_between(1e-3, 1e3))
      ->group("Lattice");
  verb->add_option("--origin", o->origin, "X,Y,Z: centre of the first voxel in mm of the world")
      ->group("Lattice");
  verb->add_option("--dims", o->dims, "I,J,K: voxels along x, y, z (default: around the whole sweep)")
      ->group("Lattice");
  verb->add_option("--out", o->out, "Volume to write (.mha)")->required();
  verb->callback([=] { voxels(*sweep, *render_options, *o); });
}

}  // namespace sonoband::tools
