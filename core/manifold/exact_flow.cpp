#include "core/manifold/exact_flow.h"

#include <cmath>

#include "core/manifold/trim.h"

namespace sonoband::flow {

namespace {

// What is shorter than this, in steps, is a rounding slit between two cuts.
constexpr double least_piece = 1e-6;
// Bounds of heights are kept open by this share, so that rounding in a bound never removes a point.
constexpr double bound_share = 1e-7;

// The part of an element that no cut has taken. Nearly always none or one cut is left to apply.
class Remainder {
 public:
  Remainder(double from, double to) : from_(from), to_(to) {}

  bool empty(double least) const { return !(to_ - from_ > least); }

  void take(const Cut& cut) {
    if (cut.empty() || cut.to <= from_ || cut.from >= to_) return;
    if (cut.from <= from_) {
      from_ = cut.to;
    } else if (cut.to >= to_) {
      to_ = cut.from;
    } else {
      holes_.push_back(cut);
    }
  }

  void add_to(Front& front, int element, double least) {
    std::sort(holes_.begin(), holes_.end(), [](const Cut& a, const Cut& b) { return a.from < b.from; });
    double from = from_;
    for (const Cut& hole : holes_) {
      const double to = std::min(hole.from, to_);
      if (to - from > least) front.push_back({element, from, to});
      from = std::max(from, hole.to);
    }
    if (to_ - from > least) front.push_back({element, from, to_});
  }

 private:
  double from_, to_;
  std::vector<Cut> holes_;
};

PlanePoint in_frame(const PlanePoint& p, const PlanePoint& origin, const PlanePoint& along,
                    const PlanePoint& out) {
  const PlanePoint offset = p - origin;
  return {along.dot(offset), out.dot(offset)};
}

}  // namespace

ExactSide::ExactSide(const Side& side, const ChordTree& tree, int layers)
    : side_(side), tree_(tree), layers_(layers), edges_(side.edges.size()), corners_(side.corners.size()) {}

void ExactSide::prepare(int first, int last) {
  for (int e = first; e < last; ++e) {
    prepare_edge(e);
    if (side_.corner_after(e) != nullptr) prepare_corner(e);
  }
}

void ExactSide::settle(Element& element) {
  const auto late = [&](const Shade& s) { return s.from >= element.dies; };
  element.shades.erase(std::remove_if(element.shades.begin(), element.shades.end(), late),
                       element.shades.end());
  // The tie of equal heights is the order along the curve, in which the tree gave them.
  std::stable_sort(element.shades.begin(), element.shades.end(),
                   [](const Shade& a, const Shade& b) { return a.from < b.from; });
}

void ExactSide::prepare_edge(int edge) {
  const Side::Edge& e = side_.edges[edge];
  const int edges = static_cast<int>(side_.edges.size());
  const int before = edge > 0 ? edge - 1 : side_.closed ? edges - 1 : -1;
  const int after = edge + 1 < edges ? edge + 1 : side_.closed ? 0 : -1;
  Element& element = edges_[edge];
  element.dies = layers_ * (1 + bound_share);

  // Closing corners eat the edge from both ends at a constant rate while the neighbours are long enough.
  double eaten = 0;
  double valid = never;
  const auto corner_eats = [&](const Side::Corner* corner, int neighbour) {
    if (corner == nullptr || corner->reach >= 0) return;
    eaten -= corner->reach;
    valid = std::min(valid, side_.edges[neighbour].length / -corner->reach);
  };
  corner_eats(side_.corner_before(edge), before);
  corner_eats(side_.corner_after(edge), after);
  if (eaten > 0 && e.length / eaten <= valid)
    element.dies = std::min(element.dies, e.length / eaten * (1 + bound_share));

  const PlanePoint out(0, 1);
  const PlanePoint end(e.length, 0);
  // Discs that touch the edge and are no larger than it lives fill a capsule about this segment's parallel.
  const auto reject = [&](const PlanePoint& wa, const PlanePoint& wb, double stray) {
    const PlanePoint a = in_frame(wa, e.start, e.along, e.out);
    const PlanePoint b = in_frame(wb, e.start, e.along, e.out);
    if (std::max(a.y(), b.y()) + stray <= 0) return true;
    const PlanePoint centre(e.length / 2, element.dies);
    const double reach = element.dies + stray + e.length / 2;
    return (centre - nearest_on_segment(centre, a, b)).squaredNorm() >= reach * reach;
  };
  tree_.visit(reject, [&](int j) {
    if (j == edge || j == before || j == after) return;
    const PlanePoint a = in_frame(side_.vertices[j], e.start, e.along, e.out);
    const PlanePoint b = in_frame(side_.vertices[j + 1], e.start, e.along, e.out);
    if (std::max(a.y(), b.y()) <= 0) return;
    const double from = first_touch(e.length, a, b) * (1 - bound_share);
    if (from >= element.dies) return;
    element.shades.push_back({from, a, b});
    // What is lost at both ends is lost between them.
    const double all = std::max(touch_radius(out, a, b), touch_radius(out, a - end, b - end));
    element.dies = std::min(element.dies, all * (1 + bound_share));
  });
  settle(element);
}

void ExactSide::prepare_corner(int corner) {
  const Side::Corner& c = side_.corners[corner];
  if (c.half_angle == 0) return;
  const int edges = static_cast<int>(side_.edges.size());
  const int after = corner + 1 < edges ? corner + 1 : 0;
  Element& element = corners_[corner];
  element.dies = layers_ * (1 + bound_share);

  const PlanePoint out(0, 1);
  const PlanePoint first(-std::sin(c.half_angle), std::cos(c.half_angle));
  const PlanePoint last(-first.x(), first.y());
  const double spread = 2 * std::sin(c.half_angle / 2);
  // Behind both ends of the arc and its middle is behind all of it.
  const auto behind = [&](const PlanePoint& a, const PlanePoint& b, double stray) {
    return std::max({a.y(), b.y(), first.dot(a), first.dot(b), last.dot(a), last.dot(b)}) + stray <= 0;
  };
  const auto reject = [&](const PlanePoint& wa, const PlanePoint& wb, double stray) {
    const PlanePoint a = in_frame(wa, c.at, c.along, c.out);
    const PlanePoint b = in_frame(wb, c.at, c.along, c.out);
    if (behind(a, b, stray)) return true;
    const PlanePoint centre(0, element.dies);
    const double reach = element.dies * (1 + spread) + stray;
    return (centre - nearest_on_segment(centre, a, b)).squaredNorm() >= reach * reach;
  };
  tree_.visit(reject, [&](int j) {
    if (j == corner || j == after) return;
    const PlanePoint a = in_frame(side_.vertices[j], c.at, c.along, c.out);
    const PlanePoint b = in_frame(side_.vertices[j + 1], c.at, c.along, c.out);
    if (behind(a, b, 0)) return;
    // 1 / touch_radius is a support function of the inverted segment, which lies within 1 / distance: it
    // grows by at most that times the chord of the turn. And no disc reaches farther than its diameter.
    const double distance = distance_to_segment(PlanePoint::Zero(), a, b);
    const double turned = 1 / (1 / touch_radius(out, a, b) + 2 * spread / distance);
    const double from = std::max(distance / 2, turned) * (1 - bound_share);
    if (!(from < element.dies)) return;
    element.shades.push_back({from, a, b});
    for (const PlanePoint& q : {a, b}) {
      const double all = std::max(touch_radius(first, q), touch_radius(last, q));
      element.dies = std::min(element.dies, all * (1 + bound_share));
    }
  });
  settle(element);
}

Front ExactSide::front(int k) const {
  Front front;
  const int edges = static_cast<int>(side_.edges.size());
  front.reserve(2 * edges);
  for (int e = 0; e < edges; ++e) {
    add_edge(e, k, front);
    if (side_.corner_after(e) != nullptr) add_corner(e, k, front);
  }
  return front;
}

void ExactSide::add_edge(int edge, double h, Front& front) const {
  const Element& element = edges_[edge];
  if (h > element.dies) return;
  const Side::Edge& e = side_.edges[edge];
  const int edges = static_cast<int>(side_.edges.size());
  Remainder rest(0, e.length);
  // A closing corner: the parallels of both edges meet on its bisector, as far as the neighbour goes.
  if (const Side::Corner* corner = side_.corner_before(edge); corner != nullptr && corner->reach < 0) {
    const int j = edge > 0 ? edge - 1 : edges - 1;
    const double eaten = -corner->reach * h;
    if (eaten <= side_.edges[j].length) {
      rest.take({-never, eaten});
    } else {
      rest.take(cut_parallel(h, in_frame(side_.vertices[j], e.start, e.along, e.out), {0, 0}));
    }
  }
  if (const Side::Corner* corner = side_.corner_after(edge); corner != nullptr && corner->reach < 0) {
    const int j = edge + 1 < edges ? edge + 1 : 0;
    const double eaten = -corner->reach * h;
    if (eaten <= side_.edges[j].length) {
      rest.take({e.length - eaten, never});
    } else {
      rest.take(cut_parallel(h, {e.length, 0}, in_frame(side_.vertices[j + 1], e.start, e.along, e.out)));
    }
  }
  for (const Shade& shade : element.shades) {
    if (shade.from >= h || rest.empty(least_piece)) break;
    rest.take(cut_parallel(h, shade.a, shade.b));
  }
  rest.add_to(front, edge_element(edge), least_piece);
}

void ExactSide::add_corner(int corner, double h, Front& front) const {
  const Side::Corner& c = side_.corners[corner];
  const Element& element = corners_[corner];
  if (c.half_angle == 0 || h > element.dies) return;
  Remainder rest(-c.half_angle, c.half_angle);
  const double least = least_piece / h;
  for (const Shade& shade : element.shades) {
    if (shade.from >= h || rest.empty(least)) break;
    const ArcCuts lost = cut_arc(h, c.half_angle, shade.a, shade.b);
    for (int i = 0; i < lost.count; ++i) rest.take(lost.cuts[i]);
  }
  rest.add_to(front, corner_element(corner), least);
}

}  // namespace sonoband::flow
