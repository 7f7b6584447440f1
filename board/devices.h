// The devices of a board, made at run time from its profile. Real and simulated boards give the same struct.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "board/profile.h"
#include "core/geometry/plane.h"
#include "core/image/image.h"
#include "hal/capture/video_device.h"
#include "hal/clock.h"
#include "hal/devices.h"
#include "hal/footswitch/contact_footswitch.h"
#include "hal/touch/contacts.h"
#include "hal/tracker/link_types.h"

namespace sonoband {

struct Recording;  // hal/replay/replay.h

// A plane worth looking at, which only a simulated scene can know.
struct BoardView {
  std::string name;
  ReslicePlane plane;
  std::vector<Eigen::Vector2d> curve_mm;  // on the plane; may be empty
  double reach_mm = 0;                    // of the curve's rulings
};

struct BoardDevices {
  std::string board;
  std::shared_ptr<void> parts;  // what the devices borrow; outlives them
  std::unique_ptr<Tracker> tracker;
  std::unique_ptr<FrameSource> frames;
  std::unique_ptr<Footswitch> footswitch;
  std::unique_ptr<Touch> touch;  // null: the board has none, and the window system's pointer is all there is

  int width_px = 0;  // of the captured picture
  int height_px = 0;
  Pixels mask;                                          // which pixels show the body; empty: all
  Affine<frame::Probe, frame::Image> probe_from_image;  // the calibration, of the captured picture
  Duration latency_offset{};                            // see core/sweep/pairing.h

  // To be called when a recording starts and ends, on the thread that records; takes no heap and no time. May
  // be empty.
  std::function<void(bool recording)> on_recording;
  // Puts a foot on a simulated pedal (true: down). Empty where the pedal is real. By one thread.
  std::function<bool(bool down)> foot;
  std::vector<BoardView> views;
};

// Phantom, hand, scanner, LIBERTY and pedal of the simulated cart, all from one scene. The clock outlives
// them.
BoardDevices make_sim_board(const Profile& profile, Clock& clock);

// A recorded sequence behind the same interfaces, looped; a simulated pedal beside it.
BoardDevices make_replay_board(std::shared_ptr<const Recording> recording,
                               const Affine<frame::Probe, frame::Image>& probe_from_image, Pixels mask,
                               const Profile& profile, Clock& clock);

// What only a calibration, or a scene that is known, can say.
struct BoardCalibration {
  Affine<frame::Probe, frame::Image> probe_from_image;
  Pixels mask;                // which pixels show the body; empty: all
  Duration latency_offset{};  // unless the profile has one
};

// Tracker on USB, video grabber, pedal and touchscreen, as the profile names them. Devices that are missing
// are waited for.
BoardDevices make_hardware_board(const std::string& name, const BoardCalibration& calibration,
                                 const Profile& profile, Clock& clock);

// The calibration of the simulated scene: for the board `virtual`, whose hardware shows that scene.
BoardCalibration scene_calibration(const Profile& profile);

// Parts of the above, for the check and for tests. capture.driver and capture.device name the grabber.
std::unique_ptr<VideoDevice> video_device(const Profile& profile);
std::vector<PedalWiring> pedal_wiring(const Profile& profile);
LinkConfig tracker_config(const Profile& profile);
TouchMapping touch_mapping(const Profile& profile);

}  // namespace sonoband
