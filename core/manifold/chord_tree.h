// A search tree over the edges of a polyline: each node knows the chord of a run of edges and how far the run
// strays from it. On a curve drawn by hand the runs are nearly straight, so that the thick chords fit far
// closer than boxes, and a query about a narrow lens beside the curve touches a few nodes only.
#pragma once

#include "core/manifold/plane_point.h"

namespace sonoband {

class ChordTree {
 public:
  // Edge i joins vertices[i] and vertices[i + 1].
  explicit ChordTree(const std::vector<PlanePoint>& vertices);

  // A run of edges: it stays within `stray` of the segment a b, and within `radius` of its middle.
  struct Run {
    PlanePoint a, b, middle;
    double stray = 0, radius = 0;
  };

  // Calls edge(i) for the edges of all runs that `reject` lets through, in ascending order. reject(run) ->
  // true when nothing of the run can matter.
  template <class Reject, class Edge>
  void visit(const Reject& reject, const Edge& edge) const {
    int stack[64];  // depth of the tree is at most 17 for max_curve_px
    int size = 0;
    if (!nodes_.empty()) stack[size++] = 0;
    while (size > 0) {
      const Node& node = nodes_[stack[--size]];
      if (reject(node.run)) continue;
      if (node.right < 0) {
        for (int i = node.first; i < node.last; ++i) edge(i);
      } else {
        stack[size++] = node.right;
        stack[size++] = node.left;
      }
    }
  }

 private:
  struct Node {
    Run run;
    int first = 0, last = 0;    // edges [first, last)
    int left = -1, right = -1;  // children
  };
  int build(const std::vector<PlanePoint>& vertices, int first, int last);

  std::vector<Node> nodes_;
};

}  // namespace sonoband
