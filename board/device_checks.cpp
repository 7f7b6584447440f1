#include "board/device_checks.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "board/devices.h"
#include "hal/capture/agreement.h"
#include "hal/tracker/usb_port.h"

namespace sonoband {
namespace {

const char* const udev_cure =
    "install the udev rules of board/ (the Debian package does) and plug it in again";
const char* const close_cure = "close that program";

CheckLine missing(const char* device, const std::string& what, const std::string& cure) {
  return {CheckResult::missing, device, what, cure};
}

CheckLine known_tracker(UsbCalls& usb, const UsbProduct& product) {
  const std::string name = std::string(product.name) + " on USB";
  if (product.loader)
    return missing("tracker", name,
                   "name its firmware file for the loader, see board/README.md, and switch it off and on");
  const UsbError opened = usb.open(polhemus_vendor, product.id);
  const bool endpoints = opened == UsbError::none && endpoints_of(product, usb.bulk_endpoints());
  usb.close();
  switch (opened) {
    case UsbError::none:
      if (endpoints) return {CheckResult::found, "tracker", name, ""};
      return missing("tracker", name + ", without the endpoints of one",
                     "this is not the tracker it says it is: plug in the right one");
    case UsbError::access:
      return missing("tracker", name + ", not to be opened", udev_cure);
    case UsbError::busy:
      return missing("tracker", name + ", held by another program", close_cure);
    default:
      return missing("tracker", name + ", not answering", "unplug it, plug it in again");
  }
}

std::string size_of(const VideoMode& mode) {
  return std::to_string(mode.width) + " x " + std::to_string(mode.height);
}

CheckLine agreed_line(const std::string& name, const Agreement& agreed, const Profile& profile) {
  CheckLine line{CheckResult::found, "video", name + ", " + size_of(agreed.mode), ""};
  if (agreed.mode.format == PixelFormat::mjpeg) {
    line.result = CheckResult::warning;
    line.what += " as motion JPEG";
    line.cure = "compression blurs edges: use a grabber that does not, or a USB 3 port";
  }
  if (agreed.slow) {
    line.result = CheckResult::warning;
    line.what += ", " + std::to_string(std::lround(agreed.mode.rate_hz)) + " a second";
    line.cure = "plug it into a USB 3 port, or correct capture.rate-hz, which is " +
                std::to_string(std::lround(profile.capture.rate_hz));
  }
  return line;
}

}  // namespace

CheckLine tracker_line(UsbCalls& usb) {
  std::string strangers;
  for (const std::uint16_t id : usb.present(polhemus_vendor)) {
    if (const UsbProduct* product = find_product(id)) return known_tracker(usb, *product);
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), " 0f44:%04x", id);
    strangers += text.data();
  }
  if (strangers.empty())
    return missing("tracker", "none on USB", "switch the tracker on and plug in its USB cable");
  return missing("tracker", "an unknown Polhemus device:" + strangers,
                 "plug in a LIBERTY, PATRIOT or VIPER; this is none of them");
}

CheckLine video_line(VideoDevice& device, const Profile& profile) {
  const auto fail = [](const std::string& what, const std::string& cure) {
    return missing("video", what, cure);
  };
  switch (device.open()) {
    case VideoStatus::ok:
      break;
    case VideoStatus::access_denied:
      return fail("a grabber that may not be opened", udev_cure);
    case VideoStatus::busy:
      return fail("a grabber that another program holds", close_cure);
    default:
      return fail("no grabber as " + profile.capture.device + " for " + profile.capture.driver,
                  "plug it in, or name its device file (for libcamera its camera) in capture.device");
  }
  const std::string name = device.name();
  const Agreement agreed = agree(device, {.width = profile.capture.size_px[0],
                                          .height = profile.capture.size_px[1],
                                          .rate_hz = profile.capture.rate_hz,
                                          .colour = profile.capture.colour == "doppler"});
  device.close();
  switch (agreed.status) {
    case VideoStatus::ok:
      return agreed_line(name, agreed, profile);
    case VideoStatus::not_video:
      return fail(name + ", with no format known here", "use a grabber of YUYV or NV12");
    case VideoStatus::no_colour:
      return fail(name + ", with no format that gives colour",
                  "use a grabber of YUYV, UYVY, RGB or motion JPEG, or set capture.colour to grey");
    case VideoStatus::no_signal:
      return fail(name + ", without a signal", "switch the scanner on and check the video cable");
    case VideoStatus::no_lock:
      return fail(name + ", which cannot lock to the signal", "use a shorter video cable");
    case VideoStatus::interlaced:
      return fail(name + ", which gets interlaced video",
                  "choose a progressive mode (p, not i) on the scanner");
    case VideoStatus::busy:
      return fail(name + ", streaming to another program", close_cure);
    case VideoStatus::out_of_range:
      return fail(name + ", which sends " +
                      (agreed.mode.width == profile.capture.size_px[0] &&
                               agreed.mode.height == profile.capture.size_px[1]
                           ? "another size"
                           : size_of(agreed.mode)),
                  "set capture.size-px to the scanner's video mode, and calibrate");
    default:
      return fail(name + ", not answering", "unplug it, plug it in again");
  }
}

CheckLine pedal_line(ContactSource& contacts, const Profile& profile, const std::string& where) {
  const bool usb = profile.pedal.wired == "usb";
  const auto wiring = pedal_wiring(profile);
  const std::vector<ContactRequest> requests = contact_requests(wiring);
  const std::string what = where.empty() ? "no USB pedal" : where;
  switch (contacts.open(requests)) {
    case ContactStatus::ok:
      break;
    case ContactStatus::access_denied:
      return missing("pedal", what, udev_cure);
    case ContactStatus::busy:
      return missing("pedal", what + ", held by another program", close_cure);
    case ContactStatus::no_bias:
      return missing("pedal", what,
                     "this controller cannot pull lines: leave pedal.bias out and fit a resistor");
    default:
      return missing("pedal", what,
                     usb ? "plug the pedal in, or name it in pedal.device and its key in pedal.pin"
                         : "correct pedal.pin, or install the device-tree overlay that names the line");
  }
  // The record pedal's contacts are the first.
  const auto closes = contacts.level(0);
  const auto opens = wiring[0].opens ? contacts.level(1) : std::optional(closes && !*closes);
  contacts.close();
  if (!closes || !opens) return missing("pedal", what + ", not answering", "unplug it, plug it in again");
  if (*closes == *opens)
    return missing("pedal", what + ", which contradict each other",
                   "check the pedal's cable for a cut wire, and pedal.active-low");
  if (*closes)
    return {CheckResult::warning, "pedal", what + ", down",
            "take the foot off; if nobody presses it, set pedal.active-low the other way"};
  return {CheckResult::found, "pedal", what, ""};
}

CheckLine touch_line(TouchPort& port, const Profile& profile) {
  TouchPanel panel;
  const TouchStatus status = port.open(panel);
  port.close();
  const std::string what = panel.name.empty() ? "touchscreen" : panel.name + " at " + panel.path;
  switch (status) {
    case TouchStatus::ok:
      return {CheckResult::found, "touch", what, ""};
    case TouchStatus::access_denied:
      return {CheckResult::warning, "touch", "a touchscreen that may not be read", udev_cure};
    case TouchStatus::busy:
      return {CheckResult::warning, "touch", what + ", held by another program", close_cure};
    default:
      return {CheckResult::warning, "touch", "no touchscreen as " + profile.touch.device,
              "plug its USB cable in, or name it in touch.device; a mouse works as well"};
  }
}

}  // namespace sonoband
