// Small things drawn over pictures: scales, the orientation mark, badges, rings round points.
#pragma once

#include "ui/interact/orbit.h"
#include "ui/ui.h"

namespace sonoband::ui {

// Ticks every 10 mm down the right edge of a B-scan, with the depth in mm.
void draw_depth_scale(Ui& ui, const Rect& picture, float px_per_mm);
// A bar of a round number of mm in the bottom left corner, with its length.
void draw_scale_bar(Ui& ui, const Rect& picture, double px_per_mm);
// A round length in mm whose bar is at most `most_px` long: 1, 2, 5, 10, ...
double scale_length_mm(double px_per_mm, double most_px);
// Where the marked side of the probe is: at the right of a picture in the house's orientation (MF).
void draw_orientation_mark(Ui& ui, const Rect& picture);
// In other pictures, whose sides turn with the plane: two arms from the top left corner, to the probe's
// marked side (it ends in the same disc) and away from the probe. Directions on the screen, of length 1 where
// they lie in the picture and shorter as they leave it.
void draw_orientation_arms(Ui& ui, const Rect& picture, Vec2 marked, Vec2 deep);
void draw_badge(Ui& ui, Vec2 centre, Colour c, std::string_view words);
// A point the user set, with its number beside it.
void draw_point(Ui& ui, Vec2 at, Colour c, std::string_view label);
// A value at the right of a point, legible on whatever is there.
void draw_tag(Ui& ui, Vec2 point, Colour c, std::string_view words);

// Drag turns, two fingers slide and zoom, a double tap goes back.
void orbit_by_gestures(Ui& ui, std::string_view name, const Rect& r, const Orbit& orbit);

}  // namespace sonoband::ui
