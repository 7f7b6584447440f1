// What sheets have in common.
#pragma once

#include "ui/ui.h"

namespace sonoband::ui {

inline constexpr command::OpenSheet close_sheet{};

// The paper of a sheet `width` x `height` units with its title and a way out; returns what is inside.
Rect sheet_paper(Ui& ui, float width, float height, std::string_view title, bool can_close);

// `part` from 0 to 1.
void progress_bar(Ui& ui, const Rect& r, double part);

}  // namespace sonoband::ui
