// The panels: free functions over a const View. None keeps anything between frames; what the user did goes
// out as commands.
#pragma once

#include "ui/ui.h"
#include "ui/view.h"

namespace sonoband::ui {

// Everything; the only one that the screen calls.
void draw_screen(Ui& ui, const View& view);

void draw_status_bar(Ui& ui, const Rect& r, const View& view);
void draw_rail(Ui& ui, const Rect& r, const View& view);
void draw_live(Ui& ui, const Rect& r, const View& view);
void draw_review(Ui& ui, const Rect& r, const View& view);
void draw_exams(Ui& ui, const Rect& r, const View& view);
void draw_set_up(Ui& ui, const Rect& r, const View& view);
void draw_sheet(Ui& ui, const View& view);
void draw_export_sheet(Ui& ui, const View& view);

// The four windows of Review (the paper's Figure 2).
void draw_bscan_window(Ui& ui, const Rect& r, const View& view);
void draw_reslice_window(Ui& ui, const Rect& r, const View& view);
void draw_manifold_window(Ui& ui, const Rect& r, const View& view);
void draw_outline_window(Ui& ui, const Rect& r, const View& view);
void draw_tools(Ui& ui, const Rect& r, const View& view);

}  // namespace sonoband::ui
