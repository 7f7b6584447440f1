// How the simulated hand moves the probe: hovering, sweeping, going home.
#pragma once

#include <cstdint>
#include <vector>

#include "core/time.h"
#include "hal/sim/frames.h"

namespace sonoband::sim {

struct PathSettings {
  enum class Kind : std::uint8_t {
    linear,           // along z of the phantom, the picture across it
    fan,              // in one place on the skin, tilted from side to side
    reversed,         // linear, from the far end
    two_overlapping,  // two linear sweeps side by side, out and back, lifted over in between
  } kind = Kind::linear;
  double length_mm = 100;
  double fan_deg = 60;
  double speed_mm_s = 15;  // sonographers take 10 to 30; a fan's is measured at 60 mm depth
  double apart_mm = 24;    // between the two overlapping sweeps
  Duration hover = std::chrono::milliseconds(1500);  // before each sweep, and after the last
  double tremor_mm = 0.25;                           // standard deviation along each axis
  double tremor_deg = 0.4;
  std::uint64_t seed = 1;
};

// While the hand sweeps: when an operator would hold the pedal, from the path's start.
struct SweepTime {
  Duration begin;
  Duration end;
};

// A function of time alone, smooth enough for a tracker's filter: each stretch starts and ends at rest.
class ProbePath {
 public:
  ProbePath(const PathSettings& settings, const WorldFromPhantom& world_from_phantom);

  // `elapsed` since the path's start; before it and after `duration` the probe hovers where it starts. The
  // tremor goes on by `shake`, a time of its own, so that starting the path again makes no jump.
  WorldFromFace world_from_face(Duration elapsed, Duration shake) const;
  WorldFromFace world_from_face(Duration elapsed) const { return world_from_face(elapsed, elapsed); }

  const std::vector<SweepTime>& sweeps() const { return sweeps_; }
  Duration duration() const;  // until the probe is home again

 private:
  // Of the face in the phantom, without tremor.
  struct Station {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    double tilt_deg = 0;  // about x
    double turn_deg = 0;  // about y
  };
  struct Leg {
    Duration begin;
    Duration end;
    Station from;
    Station to;
    double lift_mm;  // off the skin half way
  };
  void go(const Station& to, Duration time, double lift_mm);
  void stay(Duration time);
  void sweep(const Station& to, Duration time);

  PathSettings settings_;
  WorldFromPhantom world_from_phantom_;
  std::vector<Leg> legs_;
  std::vector<SweepTime> sweeps_;
};

// The picture's place in the probe: about 10 cm from a sensor on the handle, turned so that no axes agree.
ProbeFromImage typical_calibration(const Affine<frame::Face, frame::Image>& face_from_image);

// The rigid part of a calibration: where the face is in the probe.
Rigid<frame::Probe, frame::Face> typical_mount();

}  // namespace sonoband::sim
