// Landmarks, contours and measured distances for 3D Slicer (.mrk.json).
// Source: Slicer's markups schema 1.0.3. Positions are the sweep's world in mm, named RAS as PLUS and our
// OpenIGTLink server name it: no axis is turned.
#pragma once

#include <string>
#include <vector>

#include "app/exam/records.h"

namespace sonoband::exchange {

// What review objects of these kinds hold as JSON, and all that is read here:
//   landmark     {"label": "...", "position_mm": [x, y, z]}
//   contour      {"label": "...", "closed": true, "points_mm": [[x, y, z], ...]}
//   measurement  {"label": "...", "points_mm": [[x, y, z], [x, y, z]]}
// Landmarks become one Fiducial list, contours a ClosedCurve or Curve each, measurements of two points a Line
// each; other kinds are passed over. Empty: there is none of these. Throws BadInput naming an object that
// holds something else.
std::string slicer_markups(const std::vector<exam::ReviewObject>& objects);

}  // namespace sonoband::exchange
