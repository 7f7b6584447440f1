// Keys, for whoever has a keyboard; nothing needs them.
#pragma once

#include "ui/host/surface.h"
#include "ui/ui.h"

namespace sonoband::ui {

void send_shortcuts(Ui& ui, const View& view, const Input& input);

}  // namespace sonoband::ui
