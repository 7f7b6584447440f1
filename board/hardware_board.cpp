#include "board/devices.h"
#include "hal/capture/camera_device.h"
#include "hal/capture/v4l2_device.h"
#include "hal/capture/video_source.h"
#include "hal/footswitch/contact_footswitch.h"
#include "hal/footswitch/gpio_contacts.h"
#include "hal/footswitch/key_contacts.h"
#include "hal/touch/evdev_port.h"
#include "hal/touch/touchscreen.h"
#include "hal/tracker/polhemus_tracker.h"
#include "hal/tracker/usb_port.h"

namespace sonoband {
namespace {

Bias bias_of(const std::string& word) {
  if (word == "pull-up") return Bias::pull_up;
  if (word == "pull-down") return Bias::pull_down;
  return word == "off" ? Bias::off : Bias::as_is;
}

// What the tracker and the frames borrow.
struct HardwareParts {
  std::unique_ptr<UsbPort> port;
  std::unique_ptr<VideoDevice> video;
};

}  // namespace

std::vector<PedalWiring> pedal_wiring(const Profile& profile) {
  const Bias bias = bias_of(profile.pedal.bias);
  const auto contact = [&](const std::string& name) {
    return ContactRequest{.name = name, .active_low = profile.pedal.active_low, .bias = bias};
  };
  PedalWiring record{.closes = contact(profile.pedal.pin), .opens = {}};
  if (!profile.pedal.opening_pin.empty()) record.opens = contact(profile.pedal.opening_pin);
  std::vector<PedalWiring> pedals{record};
  if (!profile.pedal.second_pin.empty())
    pedals.push_back({.closes = contact(profile.pedal.second_pin), .opens = {}});
  return pedals;
}

std::unique_ptr<VideoDevice> video_device(const Profile& profile) {
  if (profile.capture.driver == "libcamera")
    return std::make_unique<CameraDevice>(libcamera_calls(), profile.capture.device);
  return std::make_unique<V4l2Device>(profile.capture.device);
}

LinkConfig tracker_config(const Profile& profile) {
  LinkConfig config;
  config.probe_station = profile.tracking.station;
  config.rate = profile.tracking.rate_hz == 240 ? RecordRate::hz_240 : RecordRate::hz_120;
  for (std::size_t i = 0; i < config.hemisphere.size(); ++i)
    config.hemisphere[i] = static_cast<float>(profile.tracking.hemisphere[i]);
  config.silent = from_seconds(profile.tracking.silent_ms / 1000);
  return config;
}

TouchMapping touch_mapping(const Profile& profile) {
  TouchMapping mapping;
  mapping.calibration = profile.touch.calibration;
  mapping.rotation_deg = profile.touch.rotation_deg;
  // The panel's x axis lies along the picture's width only if it is not turned on its side.
  if (profile.touch.rotation_deg % 180 == 0) mapping.width_mm = profile.screen.width_mm;
  return mapping;
}

BoardDevices make_hardware_board(const std::string& name, const BoardCalibration& calibration,
                                 const Profile& profile, Clock& clock) {
  auto parts = std::make_shared<HardwareParts>();
  parts->port = std::make_unique<UsbPort>(libusb_calls());
  parts->video = video_device(profile);

  BoardDevices devices;
  devices.board = name;
  devices.width_px = profile.capture.size_px[0];
  devices.height_px = profile.capture.size_px[1];
  auto tracker = std::make_unique<PolhemusTracker>(*parts->port, clock, tracker_config(profile));
  devices.on_recording = [t = tracker.get()](bool recording) { t->set_recording(recording); };
  devices.tracker = std::move(tracker);
  devices.frames =
      std::make_unique<VideoSource>(*parts->video, clock,
                                    VideoSettings{.width = devices.width_px,
                                                  .height = devices.height_px,
                                                  .rate_hz = profile.capture.rate_hz,
                                                  .silent = from_seconds(profile.capture.silent_ms / 1000),
                                                  .colour = profile.capture.colour == "doppler"});
  devices.footswitch = std::make_unique<ContactFootswitch>(
      profile.pedal.wired == "usb" ? key_contacts(profile.pedal.device) : gpio_contacts(), clock,
      pedal_wiring(profile));
  devices.touch =
      std::make_unique<Touchscreen>(evdev_port(profile.touch.device), clock, touch_mapping(profile));
  devices.probe_from_image = calibration.probe_from_image;
  if (!calibration.mask.view().empty()) devices.mask = calibration.mask.copy();
  devices.latency_offset = profile.capture.latency_ms ? from_seconds(*profile.capture.latency_ms / 1000)
                                                      : calibration.latency_offset;
  devices.parts = std::move(parts);
  return devices;
}

}  // namespace sonoband
