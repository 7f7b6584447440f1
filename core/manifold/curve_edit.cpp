#include "core/manifold/curve_edit.h"

#include <cassert>
#include <cmath>

namespace sonoband {

std::size_t nearest_vertex(const Curve& curve, const PlanePoint& p) {
  assert(!curve.vertices.empty());
  std::size_t best = 0;
  for (std::size_t i = 1; i < curve.vertices.size(); ++i)
    if ((curve.vertices[i] - p).squaredNorm() < (curve.vertices[best] - p).squaredNorm()) best = i;
  return best;
}

Curve drag_vertex(const Curve& curve, std::size_t vertex, const PlanePoint& to, double reach_mm) {
  assert(vertex < curve.vertices.size());
  const std::size_t count = curve.vertices.size();
  const PlanePoint move = to - curve.vertices[vertex];
  // Arc length from the vertex, the shorter way round a closed curve.
  std::vector<double> away(count, length_mm(curve) + reach_mm + 1);
  away[vertex] = 0;
  for (const bool forth : {true, false}) {
    double length = 0;
    for (std::size_t step = 1, here = vertex; step < count; ++step) {
      if (!curve.closed && here == (forth ? count - 1 : 0)) break;
      const std::size_t next = (here + (forth ? 1 : count - 1)) % count;
      length += (curve.vertices[next] - curve.vertices[here]).norm();
      away[next] = std::min(away[next], length);
      here = next;
    }
  }
  Curve moved = curve;
  for (std::size_t i = 0; i < count; ++i)
    if (i != vertex && away[i] < reach_mm)
      moved.vertices[i] += 0.5 * (1 + std::cos(M_PI * away[i] / reach_mm)) * move;
  moved.vertices[vertex] = to;
  return moved;
}

Curve insert_vertex(const Curve& curve, std::size_t after, const PlanePoint& p) {
  assert(after < curve.vertices.size());
  Curve longer = curve;
  longer.vertices.insert(longer.vertices.begin() + static_cast<std::ptrdiff_t>(after) + 1, p);
  return longer;
}

Curve erase_vertex(const Curve& curve, std::size_t vertex) {
  assert(vertex < curve.vertices.size());
  Curve shorter = curve;
  if (curve.vertices.size() <= (curve.closed ? 3u : 2u)) return shorter;
  shorter.vertices.erase(shorter.vertices.begin() + static_cast<std::ptrdiff_t>(vertex));
  return shorter;
}

void CurveHistory::change(Curve next) {
  states_.resize(at_ + 1);
  states_.push_back(std::move(next));
  if (states_.size() > max_undo + 1) states_.erase(states_.begin());
  at_ = states_.size() - 1;
}

}  // namespace sonoband
