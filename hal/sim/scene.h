// Everything the simulated devices of one cart share: phantom, scanner, calibration, and the hand that moves
// the probe. board/ makes the devices from it.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/plane.h"
#include "hal/sim/bscan_simulator.h"
#include "hal/sim/phantom.h"
#include "hal/sim/probe_path.h"
#include "hal/sim/scanner.h"
#include "hal/sim/sim_footswitch.h"
#include "hal/sim/sim_frame_source.h"

namespace sonoband::sim {

// Moves along a path from a start that may be set while others ask for poses. Thread-safe, no lock.
class SimulatedHand {
 public:
  SimulatedHand(const ProbePath& path, const Rigid<frame::Probe, frame::Face>& probe_from_face);

  // The path starts at t. Until the first call the probe hovers.
  void begin(Stamp t);
  // An operator pressed the pedal: the sweep begins shortly after, unless the hand is still on its way.
  void pressed(Stamp t);

  WorldFromFace world_from_face(Stamp t) const;
  TrackerFromProbe tracker_from_probe(Stamp t) const;

  const ProbePath& path() const { return path_; }

 private:
  ProbePath path_;
  Rigid<frame::Face, frame::Probe> face_from_probe_;
  std::atomic<Duration> started_;
};

// A rendering worth looking at: a plane that suits the phantom, and where it shows more, a curve on it.
struct SuggestedView {
  std::string name = {};
  ReslicePlane plane = {};
  double thickness_mm = 0;
  std::vector<Eigen::Vector2d> curve_mm = {};  // plane mm: x along right, y along down; empty: none
  double reach_mm = 0;                         // half length of the curve's rulings
  double curve_thickness_mm = 0;
};

struct SceneSettings {
  std::string preset = "foetus";
  PathSettings path = {};
  Duration scanner_latency = std::chrono::milliseconds(80);  // from echo to the scanner's output
  std::uint64_t seed = 1;
};

// A value with shared parts: copies move with the same hand.
struct SimulatedScene {
  std::shared_ptr<const Phantom> phantom;
  WorldFromPhantom world_from_phantom;
  ScannerSettings scanner;
  ProbeFromImage probe_from_image;  // the true calibration
  Duration scanner_latency{};       // the true one: a frame shows the pose at captured - scanner_latency
  std::uint64_t seed = 1;
  std::shared_ptr<SimulatedHand> hand;
  std::vector<SuggestedView> views;

  // Frames of the scene; `faults`, rate and times from `settings`, size and format from the scanner.
  FrameSourceSettings frame_settings(FrameSourceSettings settings = {}) const;
  PaintFrame painter() const;  // one per thread: it keeps buffers

  // Where the picture of a frame stamped `captured` truly was.
  WorldFromImage world_from_image(Stamp captured) const;
};

// Names that make_scene knows.
const std::vector<std::string>& scene_presets();

// Precondition: the preset is one of scene_presets().
SimulatedScene make_scene(const SceneSettings& settings);

}  // namespace sonoband::sim
