// Coordinate frames that only the simulation has. World is the tracker's frame here.
//
// | frame   | origin                             | axes                                               | unit
// |
// |---------|------------------------------------|----------------------------------------------------|------|
// | Phantom | on the skin, middle of the phantom | x across, y into the body, z along it              | mm |
// | Face    | middle of the transducer's face    | x to the marked side, y into the body, z elevation | mm |
#pragma once

#include "core/geometry/transforms.h"

namespace sonoband::frame {
struct Phantom;
struct Face;
}  // namespace sonoband::frame

namespace sonoband::sim {

using WorldFromPhantom = Rigid<frame::World, frame::Phantom>;
using WorldFromFace = Rigid<frame::World, frame::Face>;
using TrackerFromProbe = Rigid<frame::Tracker, frame::Probe>;
using ProbeFromImage = Affine<frame::Probe, frame::Image>;
using WorldFromImage = Affine<frame::World, frame::Image>;

}  // namespace sonoband::sim
