#include "app/workers.h"
#include "hal/clock.h"
#include "tools/picture_output.h"
#include "tools/plane_options.h"
#include "tools/render_options.h"
#include "tools/sweep_options.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

void render(const SweepOptions& sweep_options, const PlaneOptions& plane_options,
            const RenderOptions& render_options, const PictureOutputs& out) {
  check_sweep_options(sweep_options);
  check_plane_options(plane_options);
  settings_of(render_options, 1);
  check_outputs(sweep_options, out);

  const exchange::SequenceSweep sweep = load_sweep(sweep_options);
  const SweepView view = sweep.view();
  const ReslicePlane plane = plane_of(plane_options, view, sweep.world);
  const RenderSettings settings = settings_of(render_options, pixel_width_mm(view));

  check_picture_size(plane, settings.band);

  SystemClock clock;
  Workers workers(threads_of(render_options));
  const Stamp begin = clock.now();
  const BandImage image = [&] {
    Progress progress("rendering");
    progress.show(0, 1);
    return render_planar(view, plane, settings, workers);
  }();
  const double milliseconds = seconds(clock.now() - begin) * 1e3;

  Json json = picture_json(sweep_options, sweep, plane, settings, image, milliseconds);
  write_picture(image, colour_bar(sweep_options), settings, json, out);
  print_picture(sweep, settings, image, milliseconds, out);
}

}  // namespace

void add_render(CLI::App& tool) {
  CLI::App* verb =
      tool.add_subcommand("render", "Paint a slice, thin or thick, straight from the B-scans of a recording");
  const auto sweep = add_sweep_options(*verb);
  add_colour_option(*verb, sweep);
  const auto plane = add_plane_options(*verb);
  const auto render_options = add_render_options(*verb);
  add_band_options(*verb, render_options);
  const auto out = add_picture_outputs(*verb);
  verb->callback([=] { render(*sweep, *plane, *render_options, *out); });
}

}  // namespace sonoband::tools
