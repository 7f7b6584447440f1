#include "core/manifold/flow.h"

#include <cassert>

#include "core/manifold/exact_flow.h"
#include "core/manifold/naive.h"
#include "core/manifold/nearest.h"
#include "core/manifold/route_map.h"

namespace sonoband {

namespace {

using flow::Front;

// Edges per task: about 20 us of work, and enough tasks for any board.
constexpr int task_edges = 64;

class Flow {
 public:
  Flow(const Curve& curve, const FlowSettings& settings)
      : settings_(settings),
        curve_(curve),
        offset_(curve, settings.step_mm),
        tree_(offset_.side(1).vertices) {
    flow_.rulings = ruling_feet(curve, settings.ruling_mm);
    flow_.layers.resize(2 * settings.layers + 1);
    for (int i = 0; i < 2; ++i) standing_[i] = offset_.stand(side(i), flow_.rulings);
  }

  CurveFlow run(Parallel& parallel) {
    surface();
    const int layers = settings_.layers;
    if (settings_.method == FlowMethod::exact) {
      for (int i = 0; i < 2; ++i) exact_.emplace_back(side(i), tree_, layers);
      const int edges = curve_.edges();
      const int tasks = (edges + task_edges - 1) / task_edges;
      parallel.for_each(2 * tasks, [&](int task) {
        const int first = task / 2 * task_edges;
        exact_[task % 2].prepare(first, std::min(edges, first + task_edges));
      });
    } else if (settings_.method == FlowMethod::route_map) {
      parallel.for_each(2, [&](int i) { routes_[i] = flow::route_map_fronts(side(i), layers); });
    }
    parallel.for_each(2 * layers, [&](int task) { layer(task % 2, 1 + task / 2); });
    return std::move(flow_);
  }

 private:
  // 0: layers above, 1: layers below.
  const flow::Side& side(int i) const { return offset_.side(i == 0 ? 1 : -1); }

  bool wants_front(int k) const {
    return settings_.fronts == Fronts::all ||
           (settings_.fronts == Fronts::outermost && k == settings_.layers);
  }

  // Layer 0 is the curve itself.
  void surface() {
    FlowLayer& layer = flow_.layers[settings_.layers];
    for (const RulingFoot& ruling : flow_.rulings) layer.feet.emplace_back(ruling.at);
    if (!wants_front(0)) return;
    layer.front.push_back(curve_.vertices);
    if (curve_.closed) layer.front.back().push_back(curve_.vertices.front());
  }

  void layer(int i, int k) {
    FlowLayer& out = flow_.layers[settings_.layers + (i == 0 ? k : -k)];
    out.k = i == 0 ? k : -k;
    if (settings_.method == FlowMethod::naive) {
      const PlaneLine line = flow::naive_front(side(i), k, standing_[i]);
      out.feet.assign(line.begin(), line.end());
      if (wants_front(k)) out.front = {line};
    } else {
      const bool paper = settings_.method == FlowMethod::route_map;
      const Front front = paper ? std::move(routes_[i][k - 1]) : exact_[i].front(k);
      out.feet = flow::find_feet(side(i), front, k, standing_[i], paper ? nullptr : &tree_);
      if (wants_front(k)) out.front = flow::draw_front(side(i), front, k, paper);
    }
    for (std::optional<PlanePoint>& foot : out.feet)
      if (foot) foot = offset_.to_mm(*foot);
    for (PlaneLine& line : out.front)
      for (PlanePoint& p : line) p = offset_.to_mm(p);
  }

  const FlowSettings& settings_;
  const Curve& curve_;
  flow::OffsetCurve offset_;
  ChordTree tree_;
  std::vector<flow::Standing> standing_[2];
  std::vector<flow::ExactSide> exact_;
  std::vector<Front> routes_[2];
  CurveFlow flow_;
};

}  // namespace

CurveFlow flow_curve(const Curve& curve, const FlowSettings& settings, Parallel& parallel) {
  assert(curve.edges() > 0 && settings.step_mm > 0 && settings.ruling_mm > 0);
  assert(settings.layers >= 0 && settings.layers <= max_flow_layers);
  return Flow(curve, settings).run(parallel);
}

}  // namespace sonoband
