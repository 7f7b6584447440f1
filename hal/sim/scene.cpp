#include "hal/sim/scene.h"

#include <algorithm>
#include <cassert>

#include "hal/sim/foetus_skeleton.h"

namespace sonoband::sim {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

// An operator who has pressed moves off after about this.
constexpr Duration reaction = std::chrono::milliseconds(300);

// The patient lies 30 cm along x from the tracker's source, whose z points down; sweeps run along its x.
WorldFromPhantom place_of_patient() {
  WorldFromPhantom w;
  w.rotation << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  w.translation = Vector3d(300, 20, 40);
  return w;
}

ReslicePlane plane_at(const WorldFromPhantom& world_from_phantom, const Vector3d& origin,
                      const Vector3d& right, const Vector3d& down, double width_mm, double height_mm,
                      double pixel_mm) {
  ReslicePlane p;
  p.origin = world_from_phantom * Point<frame::Phantom>{origin};
  p.right = world_from_phantom * Direction<frame::Phantom>{right.normalized()};
  p.down = world_from_phantom *
           Direction<frame::Phantom>{(down - down.dot(right) / right.squaredNorm() * right).normalized()};
  p.width = static_cast<int>(width_mm / pixel_mm);
  p.height = static_cast<int>(height_mm / pixel_mm);
  p.pixel_mm = pixel_mm;
  return p;
}

std::vector<SuggestedView> foetus_views(const WorldFromPhantom& w) {
  SuggestedView sagittal{.name = "sagittal", .plane = {}, .thickness_mm = 14};
  const Vector3d corner(1, 8, -52);  // 1 mm off the middle: nobody aims better
  sagittal.plane = plane_at(w, corner, Vector3d::UnitZ(), Vector3d::UnitY(), 104, 88, 0.2);
  for (const Vector2d& yz : foetus_curve())
    sagittal.curve_mm.emplace_back(yz.y() - corner.z(), yz.x() - corner.y());
  sagittal.reach_mm = 22;
  sagittal.curve_thickness_mm = 7.2;

  // Figure 4: the open hand, nearly in the plane of its palm.
  const std::vector<Digit> digits = fingers(-1);
  const Vector3d palm = digits[2].joint[1].cast<double>();
  const Vector3d along = (digits[2].joint[3] - digits[2].joint[0]).cast<double>().normalized();
  const Vector3d across = (digits[4].joint[1] - digits[1].joint[1]).cast<double>().normalized();
  SuggestedView hand{.name = "hand", .plane = {}, .thickness_mm = 14};
  const Vector3d askew = across + 0.25 * across.cross(along);
  hand.plane = plane_at(w, palm - 20 * askew - 20 * along, askew, along, 40, 40, 0.1);

  // Figure 5: spine and rib cage from the front.
  SuggestedView ribs{.name = "ribs", .plane = {}, .thickness_mm = 13};
  ribs.plane = plane_at(w, {-24, 67, -30}, Vector3d::UnitX(), Vector3d::UnitZ(), 48, 75, 0.2);
  return {sagittal, hand, ribs};
}

std::vector<SuggestedView> vessel_views(const WorldFromPhantom& w) {
  SuggestedView coronal{.name = "coronal", .plane = {}, .thickness_mm = 20};
  coronal.plane = plane_at(w, {-18, 20, -50}, Vector3d::UnitX(), Vector3d::UnitZ(), 36, 100, 0.1);
  return {coronal};
}

std::vector<SuggestedView> plain_views(const WorldFromPhantom& w) {
  SuggestedView across{.name = "along", .plane = {}, .thickness_mm = 5};
  across.plane = plane_at(w, {0, 0, -50}, Vector3d::UnitZ(), Vector3d::UnitY(), 100, 90, 0.2);
  return {across};
}

}  // namespace

SimulatedHand::SimulatedHand(const ProbePath& path, const Rigid<frame::Probe, frame::Face>& probe_from_face)
    : path_(path), face_from_probe_(probe_from_face.inverse()), started_(Stamp::max().time_since_epoch()) {}

void SimulatedHand::begin(Stamp t) {
  started_ = t.time_since_epoch();
}

void SimulatedHand::pressed(Stamp t) {
  const Stamp started(started_.load());
  if (started <= t && t < started + path_.duration()) return;
  begin(t + reaction - path_.sweeps().front().begin);
}

WorldFromFace SimulatedHand::world_from_face(Stamp t) const {
  const Stamp started(started_.load());
  return path_.world_from_face(started == Stamp::max() ? Duration(0) : t - started, t.time_since_epoch());
}

TrackerFromProbe SimulatedHand::tracker_from_probe(Stamp t) const {
  const Rigid<frame::World, frame::Probe> world_from_probe = world_from_face(t) * face_from_probe_;
  return {world_from_probe.rotation, world_from_probe.translation};
}

FrameSourceSettings SimulatedScene::frame_settings(FrameSourceSettings settings) const {
  settings.width_px = scanner.width_px;
  settings.height_px = scanner.height_px;
  settings.format = scanner.format;
  return settings;
}

PaintFrame SimulatedScene::painter() const {
  auto simulator = std::make_shared<BscanSimulator>(phantom, world_from_phantom, scanner, seed);
  return [scene = *this, simulator](Stamp captured, std::uint8_t* out, std::ptrdiff_t stride_bytes) {
    simulator->paint(scene.world_from_image(captured), captured - scene.scanner_latency, out, stride_bytes);
  };
}

WorldFromImage SimulatedScene::world_from_image(Stamp captured) const {
  const TrackerFromProbe at = hand->tracker_from_probe(captured - scanner_latency);
  // World is the tracker's frame.
  return Rigid<frame::World, frame::Probe>{at.rotation, at.translation} * probe_from_image;
}

const std::vector<std::string>& scene_presets() {
  static const std::vector<std::string> names{"foetus", "vessels", "wires", "spheres", "ramp", "constant"};
  return names;
}

SimulatedScene make_scene(const SceneSettings& settings) {
  SimulatedScene s;
  s.world_from_phantom = place_of_patient();
  s.scanner = abdominal();
  s.views = plain_views(s.world_from_phantom);
  const auto phantom = [&]() -> Phantom {
    if (settings.preset == "vessels") return vessels();
    if (settings.preset == "wires") return wires(n_wires());
    if (settings.preset == "spheres") return spheres(ball_rack());
    if (settings.preset == "ramp") return ramp(128, {0.5, -0.6, 0.4});
    if (settings.preset == "constant") return constant(100);
    assert(settings.preset == "foetus");
    return foetus();
  };
  s.phantom = std::make_shared<const Phantom>(phantom());
  if (settings.preset == "vessels") {
    s.scanner = vascular();
    s.views = vessel_views(s.world_from_phantom);
  }
  if (settings.preset == "foetus") s.views = foetus_views(s.world_from_phantom);
  s.probe_from_image = typical_calibration(face_from_image(s.scanner));
  s.scanner_latency = settings.scanner_latency;
  s.seed = settings.seed;
  PathSettings path = settings.path;
  path.seed += settings.seed;
  s.hand = std::make_shared<SimulatedHand>(ProbePath(path, s.world_from_phantom), typical_mount());
  return s;
}

}  // namespace sonoband::sim
