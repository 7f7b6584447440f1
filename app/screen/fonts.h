// The type and the symbols of the screen, from Debian's font packages.
#pragma once

#include <filesystem>

#include "ui/draw.h"

namespace sonoband {

// Inter (fonts-inter) and Font Awesome (fonts-font-awesome), looked for under `root`. Throws BadInput naming
// the file and the package.
ui::FontFiles load_fonts(const std::filesystem::path& root = "/usr/share/fonts");

}  // namespace sonoband
