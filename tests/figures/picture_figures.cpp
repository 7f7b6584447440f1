// Figures 3 to 6 and 11 to 13 of the paper, from the simulated foetus and the simulated vessels.
#include <algorithm>
#include <cmath>

#include "app/exchange/png.h"
#include "app/workers.h"
#include "core/manifold/manifold_band.h"
#include "tests/figures/drawn_lines.h"
#include "tests/figures/figures.h"
#include "tests/figures/swept_scene.h"

namespace sonoband::figures {
namespace {

constexpr int frames = 240;  // of a 100 mm sweep: 0.4 mm apart

const sim::SuggestedView& view_of(const SweptScene& swept, const std::string& name) {
  const auto& views = swept.scene.views;
  return *std::find_if(views.begin(), views.end(),
                       [&](const sim::SuggestedView& v) { return v.name == name; });
}

RenderSettings settings_of(const SweptScene& swept, double thickness_mm, Compounding compounding) {
  RenderSettings settings;
  settings.band = {thickness_mm, pixel_width_mm(swept.view())};
  settings.compounding = compounding;
  return settings;
}

void save(const BandImage& image, const std::string& file) {
  exchange::write_png(exchange::band_png(image), file);
}

BandImage planar(const SweptScene& swept, const ReslicePlane& plane, double thickness_mm,
                 Compounding compounding) {
  Workers workers(2);
  return render_planar(swept.view(), plane, settings_of(swept, thickness_mm, compounding), workers);
}

void planar(const SweptScene& swept, const ReslicePlane& plane, double thickness_mm, Compounding compounding,
            const std::string& file) {
  save(planar(swept, plane, thickness_mm, compounding), file);
}

// The plane's picture with c(s) and, where the curved band is thick, c_u and c_d.
void save_with_curves(const BandImage& image, const ReslicePlane& plane, const Curve& curve,
                      const ManifoldBand* thick, const std::string& file) {
  constexpr doppler::Rgb yellow{255, 220, 0}, blue{90, 170, 255}, orange{255, 140, 0};
  exchange::PngPicture picture = exchange::band_png(image);
  if (thick != nullptr) {
    for (const PlaneLine& line : thick->up) draw_line(picture, line, plane.pixel_mm, blue);
    for (const PlaneLine& line : thick->down) draw_line(picture, line, plane.pixel_mm, orange);
  }
  draw_line(picture, curve.vertices, plane.pixel_mm, yellow);
  exchange::write_png(picture, file);
}

// Turned about the middle of the plane by `degrees` round its own `down`.
ReslicePlane turned(const ReslicePlane& plane, double degrees) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(degrees * M_PI / 180, plane.down.v).toRotationMatrix();
  const Eigen::Vector3d half =
      0.5 * plane.pixel_mm * ((plane.width - 1) * plane.right.v + (plane.height - 1) * plane.down.v);
  const Eigen::Vector3d middle = plane.origin.v + half;
  return *make_plane(middle - turn * half, turn * plane.right.v, plane.down.v, plane.width, plane.height,
                     plane.pixel_mm);
}

}  // namespace

void figure_3(const std::string& folder) {
  const SweptScene foetus = sweep("foetus", frames);
  const ReslicePlane plane = view_of(foetus, "sagittal").plane;
  for (const int degrees : {-15, 0, 15}) {
    planar(foetus, turned(plane, degrees), 40, Compounding::maximum,
           folder + "/figure-03-viewpoint-" +
               (degrees < 0   ? "left"
                : degrees > 0 ? "right"
                              : "front") +
               ".png");
  }
}

void figures_4_and_5(const std::string& folder) {
  const SweptScene foetus = sweep("foetus", frames);
  const ReslicePlane hand = view_of(foetus, "hand").plane;
  planar(foetus, hand, 0, Compounding::maximum, folder + "/figure-04-a-thin.png");
  planar(foetus, hand, 14, Compounding::maximum, folder + "/figure-04-b-maximum-14mm.png");
  const ReslicePlane ribs = view_of(foetus, "ribs").plane;
  planar(foetus, ribs, 0, Compounding::mean, folder + "/figure-05-a-thin.png");
  planar(foetus, ribs, 13, Compounding::mean, folder + "/figure-05-b-mean-13mm.png");
}

void figure_6(const std::string& folder) {
  const SweptScene boxed = sweep("vessels", frames, false);
  planar(boxed, view_of(boxed, "coronal").plane, 20, Compounding::maximum,
         folder + "/figure-06-with-the-box.png");
  const SweptScene clean = sweep("vessels", frames, true);
  planar(clean, view_of(clean, "coronal").plane, 20, Compounding::maximum,
         folder + "/figure-06-doppler-20mm.png");
}

void figures_11_to_13(const std::string& folder) {
  const SweptScene foetus = sweep("foetus", frames);
  const sim::SuggestedView& view = view_of(foetus, "sagittal");
  const Curve curve =
      make_curve(view.curve_mm, {.pixel_mm = view.plane.pixel_mm, .smooth_px = 4, .closed = false}).curve;
  Workers workers(2);
  for (const double thickness_mm : {0.0, view.curve_thickness_mm}) {
    const bool thin = thickness_mm == 0;
    ManifoldSettings settings;
    settings.reach_mm = view.reach_mm;
    settings.render = settings_of(foetus, thickness_mm, Compounding::maximum);
    const ManifoldBand band = render_manifold(foetus.view(), view.plane, curve, settings, workers);
    save(band.image, folder + (thin ? "/figure-11-b-unrolled-thin.png" : "/figure-12-b-unrolled-7.2mm.png"));
    save_with_curves(planar(foetus, view.plane, thin ? 0 : 5.1, Compounding::maximum), view.plane, curve,
                     thin ? nullptr : &band,
                     folder + (thin ? "/figure-11-a-planar-thin.png" : "/figure-12-a-planar-5.1mm.png"));
  }
  const ConstPixels raw = foetus.frames[frames / 2].bscan.pixels;
  exchange::write_png(exchange::grey_png(raw), folder + "/figure-13-a-raw-bscan.png");
}

}  // namespace sonoband::figures
