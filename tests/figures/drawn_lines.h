// Curves drawn over a picture of the plane that they lie on.
#pragma once

#include "app/exchange/png.h"
#include "core/image/colour_bar.h"
#include "core/manifold/plane_point.h"

namespace sonoband::figures {

// `line` in plane mm, one pixel wide; what lies beside the picture is left out. The picture becomes RGB.
void draw_line(exchange::PngPicture& picture, const PlaneLine& line, double pixel_mm, doppler::Rgb colour);

}  // namespace sonoband::figures
