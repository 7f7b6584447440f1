// Curve flow: the curves c_u(s) and c_d(s) at equal distances on both sides of c(s), and for every ruling of
// c(s) the ruling of each of them that is compounded with it. Source: the paper, "Non-planar narrow-band
// volume rendering" and "A fast algorithm for approximate normal flow", Figures 8 to 10.
//
// Layer k lies k steps away, for k > 0 on the side of n x e, a quarter turn from right towards down of the
// direction of travel e (n = right x down is the plane's normal). A picture whose columns run along n and
// whose rows go down along e has exactly n x e as its normal, so a straight curve's layers are those of the
// plane that holds it.
#pragma once

#include <cstdint>
#include <optional>

#include "core/manifold/curve.h"
#include "core/parallel.h"

namespace sonoband {

enum class FlowMethod : std::uint8_t {
  // Everything at distance exactly k steps on that side: parallel segments and arcs, trimmed by what lies
  // nearer to another part of the curve. The entropy-satisfying solution; empty where the front has vanished.
  exact,
  // The paper's Figure 10: vertices run along their normals and merge where neighbouring normals meet. No
  // arcs; parts of the curve that are not neighbours do not see each other.
  route_map,
  // The paper's Figure 9b: every ruling's normal, whatever it crosses. For teaching and tests.
  naive,
};

enum class Fronts : std::uint8_t { none, outermost, all };

struct FlowSettings {
  FlowMethod method = FlowMethod::exact;
  double step_mm = 0.2;               // d, between neighbouring layers; the paper's is one B-scan pixel
  int layers = 0;                     // K, on each side; at most max_flow_layers
  double ruling_mm = 0.2;             // between rulings along the curve, see ruling_feet
  Fronts fronts = Fronts::outermost;  // which layers' fronts come out as lines, for drawing
};

constexpr int max_flow_layers = 4096;

struct FlowLayer {
  int k = 0;
  // In the order of the curve, one line per unbroken run; empty unless asked for. Arcs are drawn by chords
  // that stray less than 0.002 steps from them.
  std::vector<PlaneLine> front;
  // Per ruling, the nearest point of the front on this side, in plane mm; empty where there is none.
  //   A ruling whose own point k steps along its normal is part of the front gets that point. Of the others,
  //   each run between two such rulings looks only at the front between theirs, in order: neither does a run
  //   overtake another nor reach for another turn of a spiral. If the front is broken there, or a run has no
  //   such ruling on one side, the straight line to the nearest point must not cross c(s), else there is
  //   none. Of equally near points (to 1e-9) the earlier along the curve; a ruling on a vertex takes the
  //   middle of its arc.
  std::vector<std::optional<PlanePoint>> feet;
};

struct CurveFlow {
  std::vector<RulingFoot> rulings;
  std::vector<FlowLayer> layers;  // k = -K .. K

  int outermost() const { return static_cast<int>(layers.size()) / 2; }
  const FlowLayer& layer(int k) const { return layers[k + outermost()]; }
};

// `curve` is as make_curve gives it, step and ruling distance are positive. Same bits for any Parallel.
CurveFlow flow_curve(const Curve& curve, const FlowSettings& settings, Parallel& parallel);

}  // namespace sonoband
