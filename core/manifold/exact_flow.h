// The exact front: trimmed parallels and arcs. Not for use outside.
#pragma once

#include <array>

#include "core/manifold/chord_tree.h"
#include "core/manifold/offset_curve.h"

namespace sonoband::flow {

// One side of a curve with, for every element, the edges that come to shade it. Each layer is then made by
// itself, in any order and on any thread. Memory O(elements + shading pairs).
class ExactSide {
 public:
  // `tree` is over side.vertices; both outlive this. Does nothing heavy: prepare does.
  ExactSide(const Side& side, const ChordTree& tree, int layers);

  // Finds what shades edges [first, last) and the corners after them. Calls for disjoint ranges may run at
  // the same time; all must be done before front.
  void prepare(int first, int last);

  Front front(int k) const;

 private:
  // An edge of the curve in the frame of the element it shades, from height `from` on.
  struct Shade {
    double from;
    PlanePoint a, b;
  };
  struct Element {
    double dies = 0;                           // nothing of it is left above this height
    double clear_until = 0;                    // up to this height only its closing corners take from it
    double eaten_before = 0, eaten_after = 0;  // by those, per unit of height; an edge's
    std::vector<Shade> shades;                 // by ascending height
  };
  struct Lens;

  void prepare_edge(int edge);
  void prepare_corner(int corner);
  // Finds the edges, other than the element's `own`, that shade it before it dies. `edge`: about where on the
  // curve it is.
  void find_shades(const Lens& lens, int edge, const std::array<int, 3>& own, Element& element);
  void add_edge(int edge, double h, Front& front) const;
  void add_corner(int corner, double h, Front& front) const;

  const Side& side_;
  const ChordTree& tree_;
  int layers_;
  std::vector<Element> edges_, corners_;
};

}  // namespace sonoband::flow
