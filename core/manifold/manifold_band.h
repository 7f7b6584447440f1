// The narrow band about a curved surface, unrolled. Source: the paper, "Non-planar narrow-band volume
// rendering", Figures 7, 8, 11 and 12.
//
// The surface stands on c(s), parallel to the plane's normal n, to reach_mm on both sides of the plane (the
// paper's r). One ruling is one row of the picture, from -reach at the left to +reach at the right. Layers
// lie on the flowed curves of flow.h: every row is compounded from the rulings on them that belong to its
// own. The picture is true to scale on the surface itself; on the outside of a bend it is squashed along the
// rows, in the shock of a tight inside it is smeared.
#pragma once

#include "core/manifold/flow.h"
#include "core/reslice/band.h"

namespace sonoband {

// The flow that a band about `curve` needs, with rulings a plane's pixel apart. It depends neither on where
// the plane is nor on the reach: while the plane is dragged it may be kept; a thinner band may use a thicker
// one's.
CurveFlow band_flow(const Curve& curve, const ReslicePlane& plane, const Band& band, FlowMethod method,
                    Parallel& parallel);

// Rows: rulings of `flow`; samples: 2 round(reach / pixel) + 1 along n; layers: the band's, layer l of offset
// (l - (N-1)/2) step on the front of that k. Lines that have no front are not present. `flow` must reach to
// the band's outermost layer (asserted). A straight curve gives the lines of its plane to the last bit where
// its length is a multiple of a pixel (see ruling_feet).
LineBundle manifold_lines(const ReslicePlane& plane, const Curve& curve, const CurveFlow& flow,
                          double reach_mm, const Band& band);

// Per row, 255 where some layer up to k on either side shows it the ruling of a row beside it: anatomy there
// is smeared over the rows. Else 0.
std::vector<std::uint8_t> smeared_rows(const CurveFlow& flow, int k);

struct ManifoldSettings {
  double reach_mm = 20;  // r, usually 10 to 60
  FlowMethod flow = FlowMethod::exact;
  RenderSettings render;
};

struct ManifoldBand {
  BandImage image;
  std::vector<std::uint8_t> smeared;  // per row
  std::vector<PlaneLine> up, down;    // the paper's c_u and c_d: fronts of the outermost layers, plane mm
};

// Thread-safe for the caller. Same bits for any Parallel.
ManifoldBand render_manifold(const SweepView& sweep, const ReslicePlane& plane, const Curve& curve,
                             const ManifoldSettings& settings, Parallel& parallel);

}  // namespace sonoband
