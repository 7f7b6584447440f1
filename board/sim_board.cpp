#include "board/devices.h"
#include "hal/sim/liberty_sim.h"
#include "hal/sim/scene.h"
#include "hal/sim/sim_footswitch.h"
#include "hal/sim/sim_frame_source.h"
#include "hal/tracker/polhemus_tracker.h"

namespace sonoband {
namespace {

// LIBERTY's own latency (its manual): readings are stamped when they reach the host, this much after the
// pose.
constexpr Duration tracker_latency = std::chrono::microseconds(3500);

sim::PathSettings::Kind path_kind(const std::string& word) {
  using Kind = sim::PathSettings::Kind;
  if (word == "fan") return Kind::fan;
  if (word == "reversed") return Kind::reversed;
  if (word == "overlapping") return Kind::two_overlapping;
  return Kind::linear;
}

sim::SimulatedScene scene_of(const Profile& profile) {
  sim::SceneSettings settings;
  settings.preset = profile.simulation.scene;
  settings.path.kind = path_kind(profile.simulation.sweep);
  settings.path.seed = static_cast<std::uint64_t>(profile.simulation.seed);
  settings.seed = settings.path.seed;
  return sim::make_scene(settings);
}

// What the tracker and the pedal borrow.
struct SimParts {
  sim::SimulatedScene scene;
  std::unique_ptr<sim::LibertySim> liberty;
};

}  // namespace

BoardCalibration scene_calibration(const Profile& profile) {
  const sim::SimulatedScene scene = scene_of(profile);
  return {.probe_from_image = scene.probe_from_image,
          .mask = sim::body_mask(scene.scanner),
          .latency_offset = scene.scanner_latency - tracker_latency};
}

BoardDevices make_sim_board(const Profile& profile, Clock& clock) {
  auto parts = std::make_shared<SimParts>();
  parts->scene = scene_of(profile);
  const sim::SimulatedScene& scene = parts->scene;

  sim::LibertySimConfig liberty;
  liberty.unit.seed = scene.seed;
  parts->liberty = std::make_unique<sim::LibertySim>(
      clock, liberty, [hand = scene.hand](Stamp t) { return hand->tracker_from_probe(t); });

  sim::FrameSourceSettings frames;
  frames.rate_hz = profile.capture.rate_hz;
  frames.seed = scene.seed;

  sim::FootswitchSettings pedal;
  pedal.seed = scene.seed;
  pedal.on_live_press = [hand = scene.hand](Stamp t) { hand->pressed(t); };

  BoardDevices devices;
  devices.board = "sim";
  auto tracker = std::make_unique<PolhemusTracker>(*parts->liberty, clock, LinkConfig{});
  devices.on_recording = [t = tracker.get()](bool recording) { t->set_recording(recording); };
  devices.tracker = std::move(tracker);
  devices.frames =
      std::make_unique<sim::SimFrameSource>(clock, scene.frame_settings(frames), scene.painter());
  auto footswitch = std::make_unique<sim::SimFootswitch>(clock, pedal);
  devices.foot = [foot = footswitch.get()](bool down) { return down ? foot->press() : foot->release(); };
  devices.footswitch = std::move(footswitch);

  devices.width_px = scene.scanner.width_px;
  devices.height_px = scene.scanner.height_px;
  devices.mask = sim::body_mask(scene.scanner);
  devices.probe_from_image = scene.probe_from_image;
  devices.latency_offset = profile.capture.latency_ms ? from_seconds(*profile.capture.latency_ms / 1000)
                                                      : scene.scanner_latency - tracker_latency;
  for (const sim::SuggestedView& view : scene.views) {
    devices.views.push_back({view.name, view.plane, view.curve_mm, view.reach_mm});
  }
  devices.parts = std::move(parts);
  return devices;
}

}  // namespace sonoband
