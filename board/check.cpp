#include "board/check.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <ctime>

#include <algorithm>
#include <filesystem>

#include "board/device_checks.h"
#include "board/devices.h"
#include "hal/footswitch/gpio_contacts.h"
#include "hal/footswitch/key_contacts.h"
#include "hal/touch/evdev_port.h"

namespace sonoband {
namespace {

CheckLine check_tracker() {
  return tracker_line(*libusb_calls());
}

CheckLine check_video(const Profile& profile) {
  return video_line(*video_device(profile), profile);
}

CheckLine check_pedal(const Profile& profile) {
  const std::vector<ContactRequest> requests = contact_requests(pedal_wiring(profile));
  if (profile.pedal.wired == "usb")
    return pedal_line(*key_contacts(profile.pedal.device), profile,
                      find_key_pedal(profile.pedal.device, requests).where);
  std::string places;
  for (const ContactRequest& request : requests) {
    const ContactReport report = find_gpio_line(request.name);
    places += (places.empty() ? "" : ", ") + request.name +
              (report.found ? " is " + report.where : std::string(" is nowhere"));
  }
  return pedal_line(*gpio_contacts(), profile, places);
}

CheckLine check_touch(const Profile& profile) {
  return touch_line(*evdev_port(profile.touch.device), profile);
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
