// Coordinate frames as types, so that a wrong product of transforms does not compile.
//
// A transform is named to_from_from: tracker_from_image = tracker_from_probe * probe_from_image; equal names
// touch.
//
// | frame   | origin                         | axes                                              | unit |
// |---------|--------------------------------|---------------------------------------------------|------|
// | Image   | centre of pixel (0,0)          | x to the marked side, y away from the probe ("MF") | px   |
// | Probe   | position sensor on the probe   | the sensor's                                      | mm   |
// | Tracker | the tracker's source           | the tracker's                                     | mm   |
// | World   | fixed frame a sweep is seen in | Tracker's, a reference sensor's or a phantom's    | mm   |
// | Plane   | centre of output pixel (0,0)   | x right, y down, z = right x down of a reslice    | mm   |
#pragma once

#include <Eigen/Core>

namespace sonoband {

namespace frame {
struct Image;
struct Probe;
struct Tracker;
struct World;
struct Plane;
}  // namespace frame

// A place, in the unit of its frame.
template <class Frame>
struct Point {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
};

// A direction or displacement, in the unit of its frame.
template <class Frame>
struct Direction {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
};

template <class Frame>
Point<Frame> operator+(const Point<Frame>& p, const Direction<Frame>& d) {
  return {p.v + d.v};
}
template <class Frame>
Direction<Frame> operator-(const Point<Frame>& a, const Point<Frame>& b) {
  return {a.v - b.v};
}
template <class Frame>
Direction<Frame> operator*(double s, const Direction<Frame>& d) {
  return {s * d.v};
}

}  // namespace sonoband
