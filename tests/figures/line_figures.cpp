// Figures 8, 9 and 10 of the paper: rulings and their partners, naive against normal flow, the fast
// propagation.
#include "core/manifold/flow.h"
#include "tests/figures/figures.h"
#include "tests/figures/svg.h"

namespace sonoband::figures {
namespace {

PlaneLine moved(const PlaneLine& line, double dx) {
  PlaneLine result = line;
  for (PlanePoint& p : result) p.x() += dx;
  return result;
}

// A bay between two corners, as in the paper's drawings.
Curve bay() {
  const std::vector<PlanePoint> points{{4, 10}, {12, 9}, {16, 24}, {24, 25}, {29, 11}, {38, 10}};
  return make_curve(points, {.pixel_mm = 0.5, .smooth_px = 0, .closed = false}).curve;
}

// Only the drawing of the figure is 1 mm a layer; a band's layers are one pixel apart.
FlowSettings drawn(FlowMethod method, int layers, double step_mm) {
  FlowSettings settings;
  settings.method = method;
  settings.step_mm = step_mm;
  settings.layers = layers;
  settings.ruling_mm = 1;
  settings.fronts = Fronts::all;
  return settings;
}

void draw_fronts(Svg& svg, const CurveFlow& flow, double dx, const Pen& up, const Pen& down) {
  for (const FlowLayer& layer : flow.layers) {
    if (layer.k == 0) continue;
    for (const PlaneLine& run : layer.front) svg.line(moved(run, dx), layer.k > 0 ? up : down);
  }
}

}  // namespace

void figure_8(const std::string& folder) {
  Serial serial;
  const Curve c = bay();
  const CurveFlow flow = flow_curve(c, drawn(FlowMethod::exact, 1, 3), serial);
  Svg svg(folder + "/figure-08-rulings.svg", 42, 34, 14);
  draw_fronts(svg, flow, 0, {"steelblue", 1.5}, {"darkorange", 1.5});
  svg.line(c.vertices, {"black", 2});
  for (const FlowLayer& layer : flow.layers) {
    if (layer.k == 0) continue;
    for (std::size_t i = 0; i < flow.rulings.size(); ++i) {
      if (!layer.feet[i]) continue;
      svg.line({flow.rulings[i].at, *layer.feet[i]}, {"grey", 0.7});
      svg.dot(*layer.feet[i], 2, "grey");
    }
  }
  for (const RulingFoot& ruling : flow.rulings) svg.dot(ruling.at, 3, "black");
  svg.text({1, 32.5}, "c (black), c_u (blue) and c_d (orange); each ruling of c with its nearest on both");
}

void figure_9(const std::string& folder) {
  Serial serial;
  const Curve c = bay();
  Svg svg(folder + "/figure-09-naive-and-exact.svg", 82, 36, 11);
  double dx = 0;
  for (const FlowMethod method : {FlowMethod::naive, FlowMethod::exact}) {
    const CurveFlow flow = flow_curve(c, drawn(method, 4, 1.5), serial);
    draw_fronts(svg, flow, dx, {"steelblue", 1}, {"darkorange", 1});
    svg.line(moved(c.vertices, dx), {"black", 2});
    svg.text({dx + 3, 35}, method == FlowMethod::naive ? "naive: the fronts cross themselves"
                                                       : "exact: shocks and rarefaction fans");
    dx += 41;
  }
}

void figure_10(const std::string& folder) {
  Serial serial;
  const Curve c = bay();
  const CurveFlow flow = flow_curve(c, drawn(FlowMethod::route_map, 24, 0.25), serial);
  Svg svg(folder + "/figure-10-route-map.svg", 42, 36, 14);
  for (const FlowLayer& layer : flow.layers) {
    const bool solid = layer.k == 4 || layer.k == -4 || layer.k == 24 || layer.k == -24;
    if (layer.k == 0) continue;
    for (const PlaneLine& run : layer.front) {
      if (solid) svg.line(run, {"black", 1});
      // The vertices of every front, one after another, are the routes.
      for (const PlanePoint& vertex : run) svg.dot(vertex, 1.2, layer.k > 0 ? "steelblue" : "darkorange");
    }
  }
  svg.line(c.vertices, {"black", 2.5});
  svg.text({1, 35}, "vertices run along their normals and merge; corners stay corners");
}

}  // namespace sonoband::figures
