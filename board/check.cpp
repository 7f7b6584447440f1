#include "board/check.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <ctime>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>

#include "board/devices.h"
#include "hal/footswitch/gpio_contacts.h"
#include "hal/footswitch/key_contacts.h"
#include "hal/touch/evdev_port.h"
#include "hal/touch/touchscreen.h"
#include "hal/tracker/usb_port.h"

namespace sonoband {
namespace {

const char* const udev_cure =
    "install the udev rules of board/ (the Debian package does) and plug it in again";

CheckLine check_tracker() {
  CheckLine line{CheckResult::missing, "tracker", "", ""};
  const auto calls = libusb_calls();
  std::string strangers;
  for (const std::uint16_t id : calls->present(polhemus_vendor)) {
    const UsbProduct* product = find_product(id);
    if (product == nullptr) {
      std::array<char, 32> text{};
      std::snprintf(text.data(), text.size(), " 0f44:%04x", id);
      strangers += text.data();
      continue;
    }
    line.what = std::string(product->name) + " on USB";
    if (product->loader) {
      line.cure = "name its firmware file for the loader, see board/README.md, and switch it off and on";
      return line;
    }
    const UsbError opened = calls->open(polhemus_vendor, id);
    const bool endpoints = opened == UsbError::none && (product->in != 0 || calls->first_bulk(0x80) != 0);
    calls->close();
    switch (opened) {
      case UsbError::none:
        if (endpoints) {
          line.result = CheckResult::found;
          return line;
        }
        line.what += ", without the endpoints of one";
        line.cure = "this is not the tracker it says it is: plug in the right one";
        return line;
      case UsbError::access:
        line.what += ", not to be opened";
        line.cure = udev_cure;
        return line;
      case UsbError::busy:
        line.what += ", held by another program";
        line.cure = "close that program";
        return line;
      default:
        line.what += ", not answering";
        line.cure = "unplug it, plug it in again";
        return line;
    }
  }
  line.what = strangers.empty() ? "none on USB" : "an unknown Polhemus device:" + strangers;
  line.cure = "switch the tracker on and plug in its USB cable";
  return line;
}

CheckLine check_video(const Profile& profile) {
  CheckLine line{CheckResult::missing, "video", "", ""};
  const auto opened = video_device(profile);
  VideoDevice& device = *opened;
  const auto fail = [&](const std::string& what, const std::string& cure) {
    line.what = what;
    line.cure = cure;
    return line;
  };
  switch (device.open()) {
    case VideoStatus::ok:
      break;
    case VideoStatus::access_denied:
      return fail("a grabber that may not be opened", udev_cure);
    case VideoStatus::busy:
      return fail("a grabber that another program holds", "close that program");
    default:
      return fail("no grabber as " + profile.capture.device + " for " + profile.capture.driver,
                  "plug it in, or name its device file (for libcamera its camera) in capture.device");
  }
  line.what = device.name();
  const auto formats = device.formats();
  if (formats.empty())
    return fail(line.what + ", with no format known here", "use a grabber of YUYV or NV12");
  std::string sizes;
  for (const PixelFormat format : formats) {
    VideoMode mode{
        .format = format, .width = profile.capture.size_px[0], .height = profile.capture.size_px[1]};
    switch (device.negotiate(mode, profile.capture.rate_hz)) {
      case VideoStatus::ok:
        break;
      case VideoStatus::no_signal:
        return fail(line.what + ", without a signal", "switch the scanner on and check the video cable");
      case VideoStatus::busy:
        return fail(line.what + ", streaming to another program", "close that program");
      default:
        continue;
    }
    if (mode.width == profile.capture.size_px[0] && mode.height == profile.capture.size_px[1]) {
      line.what += ", " + std::to_string(mode.width) + " x " + std::to_string(mode.height);
      const bool only_jpeg = format == PixelFormat::mjpeg && formats.size() == 1;
      line.result = only_jpeg ? CheckResult::warning : CheckResult::found;
      if (only_jpeg) line.cure = "motion JPEG blurs edges: use a grabber that does not compress";
      return line;
    }
    sizes = std::to_string(mode.width) + " x " + std::to_string(mode.height);
  }
  return fail(line.what + ", which sends " + (sizes.empty() ? "another size" : sizes),
              "set capture.size-px to the scanner's video mode, and calibrate");
}

CheckLine check_pedal(const Profile& profile) {
  CheckLine line{CheckResult::missing, "pedal", "", ""};
  const auto wiring = pedal_wiring(profile);
  std::vector<ContactRequest> requests;
  for (const PedalWiring& pedal : wiring) {
    requests.push_back(pedal.closes);
    if (pedal.opens) requests.push_back(*pedal.opens);
  }
  const bool usb = profile.pedal.wired == "usb";
  std::string places;
  if (usb) {
    places = find_key_pedal(profile.pedal.device).where;
  } else {
    for (const ContactRequest& request : requests) {
      const ContactReport report = find_gpio_line(request.name);
      places += (places.empty() ? "" : ", ") + request.name +
                (report.found ? " is " + report.where : std::string(" is nowhere"));
    }
  }
  line.what = places.empty() ? "no USB pedal" : places;
  const auto contacts = usb ? key_contacts(profile.pedal.device) : gpio_contacts();
  switch (contacts->open(requests)) {
    case ContactStatus::ok: {
      line.result = CheckResult::found;
      bool down = true;
      for (std::size_t i = 0; i < requests.size() && i < 2; ++i) {
        const bool active = contacts->level(static_cast<int>(i)).value_or(false);
        down = down && (i == 0 ? active : !active);
        if (wiring[0].opens == std::nullopt) break;
      }
      if (down) {
        line.result = CheckResult::warning;
        line.what += ", down";
        line.cure = "take the foot off; if nobody presses it, set pedal.active-low the other way";
      }
      return line;
    }
    case ContactStatus::access_denied:
      line.cure = udev_cure;
      return line;
    case ContactStatus::busy:
      line.what += ", held by another program";
      line.cure = "close that program";
      return line;
    case ContactStatus::no_bias:
      line.cure = "this controller cannot pull lines: leave pedal.bias out and fit a resistor";
      return line;
    default:
      line.cure = usb ? "plug the pedal in, or name it in pedal.device and its key in pedal.pin"
                      : "correct pedal.pin, or install the device-tree overlay that names the line";
      return line;
  }
}

// No touchscreen is a warning: a mouse does everything as well.
CheckLine check_touch(const Profile& profile) {
  TouchPanel panel;
  const TouchStatus status = evdev_port(profile.touch.device)->open(panel);
  const std::string what = panel.name.empty() ? "touchscreen" : panel.name + " at " + panel.path;
  switch (status) {
    case TouchStatus::ok:
      return {CheckResult::found, "touch", what, ""};
    case TouchStatus::access_denied:
      return {CheckResult::warning, "touch", "a touchscreen that may not be read", udev_cure};
    case TouchStatus::busy:
      return {CheckResult::warning, "touch", what + ", held by another program", "close that program"};
    default:
      return {CheckResult::warning, "touch", "no touchscreen as " + profile.touch.device,
              "plug its USB cable in, or name it in touch.device; a mouse works as well"};
  }
}

CheckLine check_display() {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/dri", none))
    if (entry.path().filename().string().starts_with("card"))
      return {CheckResult::found, "display", entry.path(), ""};
  return {CheckResult::missing, "display", "no graphics device", "connect the display and check its driver"};
}

double seconds_of(const timespec& t) {
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

CheckLine check_clock() {
  struct stat program {};
  ClockReadings now;
  timespec t{};
  clock_gettime(CLOCK_REALTIME, &t);
  now.day_s = seconds_of(t);
  if (stat("/proc/self/exe", &program) == 0) now.program_made_s = seconds_of(program.st_mtim);
  clock_gettime(CLOCK_MONOTONIC, &t);
  now.awake_s = seconds_of(t);
  clock_gettime(CLOCK_BOOTTIME, &t);
  now.since_boot_s = seconds_of(t);
  return clock_line(now);
}

CheckLine check_limits() {
  rlimit memory{};
  rlimit priority{};
  getrlimit(RLIMIT_MEMLOCK, &memory);
  getrlimit(RLIMIT_RTPRIO, &priority);
  if (memory.rlim_cur == RLIM_INFINITY && priority.rlim_cur > 0)
    return {CheckResult::found, "limits", "memory may be locked, real-time priority may be had", ""};
  return {CheckResult::warning, "limits", "memory cannot be locked whole, or no real-time priority",
          "start the cart by its systemd unit, which grants both"};
}

}  // namespace

CheckLine clock_line(const ClockReadings& now) {
  // A board without a battery for its clock begins in the past: exams would get dates that never were.
  if (now.day_s < now.program_made_s)
    return {CheckResult::warning, "clock", "the time of day is before this program was made",
            "set it with `timedatectl set-time`, and install systemd-timesyncd, which keeps it"};
  // The two are read one after the other.
  if (now.since_boot_s - now.awake_s < 0.001) return {CheckResult::found, "clock", "never suspended", ""};
  return {CheckResult::warning, "clock", "the machine was suspended since it booted",
          "switch suspend off: a cart that sleeps loses its devices' clocks"};
}

std::vector<CheckLine> check_board(const std::string& board, const Profile& profile) {
  if (board == "sim" || board == "replay") {
    return {{CheckResult::found, "devices", "simulated", ""}, check_clock(), check_limits()};
  }
  return {check_tracker(), check_video(profile), check_pedal(profile), check_touch(profile),
          check_display(), check_clock(),        check_limits()};
}

std::string text_of(const CheckLine& line) {
  const char* word = line.result == CheckResult::found     ? "found  "
                     : line.result == CheckResult::warning ? "warning"
                                                           : "MISSING";
  std::string device = line.device;
  device.resize(std::max<std::size_t>(device.size(), 8), ' ');
  return std::string(word) + "  " + device + " " + line.what + (line.cure.empty() ? "" : ": " + line.cure);
}

bool all_found(const std::vector<CheckLine>& lines) {
  return std::none_of(lines.begin(), lines.end(),
                      [](const CheckLine& line) { return line.result == CheckResult::missing; });
}

}  // namespace sonoband
