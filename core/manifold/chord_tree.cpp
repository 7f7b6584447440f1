#include "core/manifold/chord_tree.h"

namespace sonoband {

namespace {
constexpr int leaf_edges = 4;
}

ChordTree::ChordTree(const std::vector<PlanePoint>& vertices) {
  const int edges = static_cast<int>(vertices.size()) - 1;
  if (edges < 1) return;
  nodes_.reserve(2 * (edges / leaf_edges + 1) + 1);
  build(vertices, 0, edges);
}

int ChordTree::build(const std::vector<PlanePoint>& vertices, int first, int last) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Node node;
  node.run.a = vertices[first];
  node.run.b = vertices[last];
  node.first = first;
  node.last = last;
  if (last - first <= leaf_edges) {
    for (int i = first + 1; i < last; ++i)
      node.run.stray = std::max(node.run.stray, distance_to_segment(vertices[i], node.run.a, node.run.b));
  } else {
    const int middle = first + (last - first) / 2;
    node.left = build(vertices, first, middle);
    node.right = build(vertices, middle, last);
    // Both half chords lie within the triangle of a, middle, b. The sum bounds the true stray from above, by
    // a third on a circle.
    node.run.stray = std::max(nodes_[node.left].run.stray, nodes_[node.right].run.stray) +
                     distance_to_segment(vertices[middle], node.run.a, node.run.b);
  }
  node.run.middle = 0.5 * (node.run.a + node.run.b);
  node.run.radius = 0.5 * (node.run.b - node.run.a).norm() + node.run.stray;
  nodes_[index] = node;
  return index;
}

}  // namespace sonoband
