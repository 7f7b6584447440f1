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
    if (holes_.empty()) {
      if (to_ - from_ > least) front.push_back({element, from_, to_});
      return;
    }
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

// Vertices so many places along the curve bound an element's life well and at once: a bend closes on its own
// neighbourhood first, and what is known to die early needs a small search only.
constexpr int probes[] = {2, 3, 5, 8, 13, 21, 34, 55, 89};

}  // namespace

// The discs that touch one element from outside, from its first point and normal to its last: where something
// must lie to shade it. An edge has two points and one normal, a corner one point and two normals.
struct ExactSide::Lens {
  PlanePoint origin, along, out;
  double length = 0;                   // of an edge
  PlanePoint first{0, 1}, last{0, 1};  // normals, in the frame
  double spread = 0;                   // of a corner: |last - out|

  PlanePoint seen(const PlanePoint& p) const { return in_frame(p, origin, along, out); }

  // From the centre of the middle one of the discs of radius h; smaller discs lie within larger ones.
  double reach(double h) const { return h * (1 + spread) + length / 2; }

  // Whether nothing within `radius` of the point touches a disc of radius up to h.
  bool misses(double h, const PlanePoint& q, double radius) const {
    const double far = reach(h) + radius;
    return (q - PlanePoint(length / 2, h)).squaredNorm() >= far * far;
  }

  // The same for what is within `stray` of the segment.
  bool misses(double h, const PlanePoint& a, const PlanePoint& b, double stray) const {
    double rise = std::max(a.y(), b.y());
    if (spread > 0) rise = std::max({rise, first.dot(a), first.dot(b), last.dot(a), last.dot(b)});
    if (rise + stray <= 0) return true;
    return misses(h, nearest_on_segment({length / 2, h}, a, b), stray);
  }

  // The height at which a point has taken all of the element: what is lost at both ends is lost between them.
  double all_lost(const PlanePoint& q) const {
    if (first.dot(q) <= 0 || last.dot(q) <= 0) return never;
    return std::max(touch_radius(first, q), touch_radius(last, {q.x() - length, q.y()})) * (1 + bound_share);
  }

  // A lower bound of the height at which a segment begins to shade the element.
  double first_lost(const PlanePoint& a, const PlanePoint& b) const {
    if (spread == 0) return first_touch(length, a, b) * (1 - bound_share);
    // 1 / touch_radius is a support function of the inverted segment, which lies within 1 / distance: it
    // grows by at most that times the chord of the turn. And no disc reaches farther than its diameter.
    const double distance = distance_to_segment(PlanePoint::Zero(), a, b);
    const double turned = 1 / (1 / touch_radius({0, 1}, a, b) + 2 * spread / distance);
    return std::max(distance / 2, turned) * (1 - bound_share);
  }
};

ExactSide::ExactSide(const Side& side, const ChordTree& tree, int layers)
    : side_(side), tree_(tree), layers_(layers), edges_(side.edges.size()), corners_(side.corners.size()) {}

void ExactSide::prepare(int first, int last) {
  for (int e = first; e < last; ++e) {
    prepare_edge(e);
    if (side_.corner_after(e) != nullptr) prepare_corner(e);
  }
}

void ExactSide::prepare_edge(int edge) {
  const Side::Edge& e = side_.edges[edge];
  const int edges = static_cast<int>(side_.edges.size());
  const int before = edge > 0 ? edge - 1 : side_.closed ? edges - 1 : -1;
  const int after = edge + 1 < edges ? edge + 1 : side_.closed ? 0 : -1;
  Element& element = edges_[edge];
  element.dies = layers_ * (1 + bound_share);
  element.clear_until = element.dies;

  // Closing corners eat the edge from both ends at a constant rate while the neighbours are long enough.
  const auto eats = [&](const Side::Corner* corner, int neighbour) {
    if (corner == nullptr || corner->reach >= 0) return 0.0;
    element.clear_until = std::min(element.clear_until, side_.edges[neighbour].length / -corner->reach);
    return -corner->reach;
  };
  element.eaten_before = eats(side_.corner_before(edge), before);
  element.eaten_after = eats(side_.corner_after(edge), after);
  const double eaten = element.eaten_before + element.eaten_after;
  if (eaten > 0 && e.length / eaten <= element.clear_until)
    element.dies = std::min(element.dies, e.length / eaten * (1 + bound_share));

  const Lens lens{e.start, e.along, e.out, e.length};
  find_shades(lens, edge, {before, edge, after}, element);
}

void ExactSide::prepare_corner(int corner) {
  const Side::Corner& c = side_.corners[corner];
  if (c.half_angle == 0) return;
  const int edges = static_cast<int>(side_.edges.size());
  const double sine = std::sin(c.half_angle), cosine = std::cos(c.half_angle);
  Element& element = corners_[corner];
  element.dies = layers_ * (1 + bound_share);
  element.clear_until = element.dies;
  const Lens lens{c.at, c.along, c.out, 0, {-sine, cosine}, {sine, cosine}, 2 * std::sin(c.half_angle / 2)};
  const int after = corner + 1 < edges ? corner + 1 : 0;
  find_shades(lens, corner, {corner, corner, after}, element);
}

void ExactSide::find_shades(const Lens& lens, int edge, const std::array<int, 3>& own, Element& element) {
  const int vertices = static_cast<int>(side_.vertices.size());
  for (const int probe : probes) {
    for (const int v : {edge + 1 - probe, edge + probe})
      if (v >= 0 && v < vertices)
        element.dies = std::min(element.dies, lens.all_lost(lens.seen(side_.vertices[v])));
  }
  const auto reject = [&](const ChordTree::Run& run) {
    return lens.misses(element.dies, lens.seen(run.middle), run.radius) ||
           lens.misses(element.dies, lens.seen(run.a), lens.seen(run.b), run.stray);
  };
  tree_.visit(reject, [&](int j) {
    if (j == own[0] || j == own[1] || j == own[2]) return;
    const PlanePoint a = lens.seen(side_.vertices[j]);
    const PlanePoint b = lens.seen(side_.vertices[j + 1]);
    if (lens.misses(element.dies, a, b, 0)) return;
    const double from = lens.first_lost(a, b);
    if (!(from < element.dies)) return;
    element.shades.push_back({from, a, b});
    element.dies = std::min({element.dies, lens.all_lost(a), lens.all_lost(b)});
  });
  const auto late = [&](const Shade& s) { return s.from >= element.dies; };
  element.shades.erase(std::remove_if(element.shades.begin(), element.shades.end(), late),
                       element.shades.end());
  if (element.shades.empty()) return;
  // The tie of equal heights is the order along the curve, in which the tree gave them.
  std::stable_sort(element.shades.begin(), element.shades.end(),
                   [](const Shade& a, const Shade& b) { return a.from < b.from; });
  element.clear_until = std::min(element.clear_until, element.shades.front().from);
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
  double from = h * element.eaten_before;
  double to = e.length - h * element.eaten_after;
  if (h <= element.clear_until) {
    if (to - from > least_piece) front.push_back({edge_element(edge), from, to});
    return;
  }
  // A neighbour beyond a closing corner that is too short for the bisector shades like any other edge.
  const int edges = static_cast<int>(side_.edges.size());
  const int before = edge > 0 ? edge - 1 : edges - 1;
  const int after = edge + 1 < edges ? edge + 1 : 0;
  const bool short_before = from > side_.edges[before].length;
  const bool short_after = e.length - to > side_.edges[after].length;
  Remainder rest(short_before ? 0 : from, short_after ? e.length : to);
  if (short_before)
    rest.take(cut_parallel(h, in_frame(side_.vertices[before], e.start, e.along, e.out), {0, 0}));
  if (short_after)
    rest.take(cut_parallel(h, {e.length, 0}, in_frame(side_.vertices[after + 1], e.start, e.along, e.out)));
  for (const Shade& shade : element.shades) {
    if (shade.from >= h || rest.empty(least_piece)) break;
    rest.take(cut_parallel(h, shade.a, shade.b));
  }
  rest.add_to(front, edge_element(edge), least_piece);
}

void ExactSide::add_corner(int corner, double h, Front& front) const {
  const Side::Corner& c = side_.corners[corner];
  const Element& element = corners_[corner];
  if (h > element.dies) return;
  const double least = least_piece / h;
  if (h <= element.clear_until) {
    if (2 * c.half_angle > least) front.push_back({corner_element(corner), -c.half_angle, c.half_angle});
    return;
  }
  Remainder rest(-c.half_angle, c.half_angle);
  for (const Shade& shade : element.shades) {
    if (shade.from >= h || rest.empty(least)) break;
    const ArcCuts lost = cut_arc(h, c.half_angle, shade.a, shade.b);
    for (int i = 0; i < lost.count; ++i) rest.take(lost.cuts[i]);
  }
  rest.add_to(front, corner_element(corner), least);
}

}  // namespace sonoband::flow
