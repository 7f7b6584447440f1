// Small helps with OpenGL ES 3. Names are GL's plain integers, so that GL's headers stay in .cpp files.
#pragma once

#include "ui/host/surface.h"

namespace sonoband::ui::gl {

// Compiles and links; throws std::runtime_error with the driver's log when it cannot, which is our bug or a
// driver without ES 3.0.
unsigned make_program(const char* vertex_source, const char* fragment_source);

// Number of errors GL had stored, now cleared; `last` is the last of them.
int take_errors(unsigned& last);

// What the framebuffer that is bound holds.
Rgba read_pixels(int width, int height);

}  // namespace sonoband::ui::gl
