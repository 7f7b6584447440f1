// The four linked windows of the paper's Figure 2, and the tools under them.
#include "ui/panels/panels.h"

namespace sonoband::ui {

void draw_review(Ui& ui, const Rect& r, const View& view) {
  Rect rest = r;
  const float gap = ui.px(8);
  const float line = std::max(ui.metrics.target, ui.px(50));
  draw_tools(ui, rest.cut_bottom(2 * line + gap), view);
  rest.cut_bottom(gap);
  switch (view.review.full) {
    case Window::review:
      return draw_bscan_window(ui, rest, view);
    case Window::reslice:
      return draw_reslice_window(ui, rest, view);
    case Window::manifold:
      return draw_manifold_window(ui, rest, view);
    case Window::outline:
      return draw_outline_window(ui, rest, view);
    case Window::none:
      break;
  }
  const Rect above = row(rest, 0, 2, gap);
  const Rect below = row(rest, 1, 2, gap);
  draw_bscan_window(ui, column(above, 0, 2, gap), view);
  draw_reslice_window(ui, column(above, 1, 2, gap), view);
  draw_manifold_window(ui, column(below, 0, 2, gap), view);
  draw_outline_window(ui, column(below, 1, 2, gap), view);
}

}  // namespace sonoband::ui
