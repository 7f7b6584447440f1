#include "core/manifold/curve_edit.h"

#include <gtest/gtest.h>

#include "tests/core/manifold/shapes.h"

namespace sonoband {
namespace {

TEST(CurveEdit, DragTakesNeighboursAlongByArcLength) {
  std::vector<PlanePoint> points;
  for (int i = 0; i <= 20; ++i) points.emplace_back(i, 0);
  const Curve line = test::open_curve(points);
  const Curve bent = drag_vertex(line, 10, {10, 4}, 6);
  EXPECT_EQ(bent.vertices[10], PlanePoint(10, 4));
  EXPECT_NEAR(bent.vertices[13].y(), 2, 1e-12);  // half way out, half of it
  EXPECT_NEAR(bent.vertices[7].y(), 2, 1e-12);
  EXPECT_EQ(bent.vertices[16], line.vertices[16]);
  EXPECT_EQ(bent.vertices[4], line.vertices[4]);
  const Curve spike = drag_vertex(line, 10, {10, 4}, 0);
  EXPECT_EQ(spike.vertices[9], line.vertices[9]);
  EXPECT_EQ(spike.vertices[10], PlanePoint(10, 4));
}

TEST(CurveEdit, DragOfAClosedCurveGoesRoundItsSeam) {
  const Curve ring = test::circle(10, 60);
  const Curve bent = drag_vertex(ring, 0, {14, 0}, 8);
  EXPECT_GT(bent.vertices[59].x(), ring.vertices[59].x() + 3);
  EXPECT_NEAR(bent.vertices[59].x() - ring.vertices[59].x(), bent.vertices[1].x() - ring.vertices[1].x(),
              1e-9);
  EXPECT_EQ(bent.vertices[30], ring.vertices[30]);
}

TEST(CurveEdit, InsertEraseAndHold) {
  const Curve v = test::open_curve({{0, 0}, {10, 0}, {10, 10}});
  EXPECT_EQ(nearest_vertex(v, {9, 8}), 2u);
  EXPECT_EQ(nearest_vertex(v, {5, 0}), 0u);
  EXPECT_EQ(erase_vertex(insert_vertex(v, 1, {12, 5}), 2).vertices, v.vertices);
  EXPECT_EQ(erase_vertex(test::open_curve({{0, 0}, {1, 0}}), 0).vertices.size(), 2u);
}

TEST(CurveEdit, HistoryGoesBackAndForth) {
  const auto curve = [](double x) { return test::open_curve({{0, 0}, {x, 1}}); };
  const auto end = [](const CurveHistory& history) { return history.now().vertices[1].x(); };
  CurveHistory history(curve(0));
  history.undo();
  EXPECT_EQ(end(history), 0);
  history.change(curve(1));
  history.change(curve(2));
  history.undo();
  history.undo();
  EXPECT_EQ(end(history), 0);
  history.redo();
  EXPECT_EQ(end(history), 1);
  history.change(curve(7));
  EXPECT_FALSE(history.can_redo());
  history.undo();
  EXPECT_EQ(end(history), 1);
  for (int i = 0; i < 200; ++i) history.change(curve(100 + i));
  int steps = 0;
  for (; history.can_undo(); ++steps) history.undo();
  EXPECT_EQ(steps, static_cast<int>(CurveHistory::max_undo));
}

}  // namespace
}  // namespace sonoband
