#include "core/manifold/naive.h"

namespace sonoband::flow {

PlaneLine naive_front(const Side& side, double h, const std::vector<Standing>& rulings) {
  PlaneLine front;
  front.reserve(rulings.size());
  for (const Standing& r : rulings) front.push_back(point_at(side, r.element, r.along, h));
  return front;
}

}  // namespace sonoband::flow
