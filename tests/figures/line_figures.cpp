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

namespace {

// Where two vertices of one front are one of the next: the shocks of the fast propagation.
PlaneLine shocks(const CurveFlow& flow, int side) {
  PlaneLine found;
  for (int k = 2; k <= flow.outermost(); ++k) {
    const auto &before = flow.layer(side * (k - 1)).front, &after = flow.layer(side * k).front;
    if (before.size() != 1 || after.size() != 1 || after[0].size() >= before[0].size()) continue;
    std::size_t closest = 1;
    const auto length = [&](std::size_t i) { return (before[0][i] - before[0][i - 1]).norm(); };
    for (std::size_t i = 2; i < before[0].size(); ++i)
      if (length(i) < length(closest)) closest = i;
    found.push_back(0.5 * (before[0][closest] + before[0][closest - 1]));
  }
  return found;
}

void draw_routes(Svg& svg, const CurveFlow& flow) {
  for (const FlowLayer& layer : flow.layers) {
    // A dot every quarter of a millimetre of the way, whatever the layers' distance.
    if (layer.k == 0 || layer.k % 10 != 0) continue;
    for (const PlaneLine& run : layer.front)
      for (const PlanePoint& vertex : run) svg.dot(vertex, 1.2, layer.k > 0 ? "steelblue" : "darkorange");
  }
}

void draw_layer(Svg& svg, const FlowLayer& layer) {
  for (const PlaneLine& run : layer.front) svg.line(run, {"black", 1});
}

}  // namespace

void figure_10(const std::string& folder) {
  Serial serial;
  const Curve c = bay();
  constexpr int last = 240;
  const CurveFlow flow = flow_curve(c, drawn(FlowMethod::route_map, last, 0.025), serial);
  Svg svg(folder + "/figure-10-route-map.svg", 42, 36, 14);
  draw_routes(svg, flow);
  for (const int k : {-last, -40, 40, last}) draw_layer(svg, flow.layer(k));
  for (const int side : {-1, 1})
    for (const PlanePoint& shock : shocks(flow, side)) svg.dot(shock, 4, "crimson");
  svg.line(c.vertices, {"black", 2.5});
  svg.text({1, 35}, "vertices run along their normals and merge in shocks (red); corners stay corners");
}

}  // namespace sonoband::figures
