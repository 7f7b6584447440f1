// What this machine's devices are and how they are set: one TOML file, every key checked.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace sonoband {

enum class PedalMode : std::uint8_t {
  hold,    // down records, up ends: released, unplugged or cut all stop (the safe choice)
  toggle,  // down starts, the next down ends
};

// Defaults are those of the simulated cart. Units are in the names; comments give the usual range.
struct Profile {
  struct Capture {
    double rate_hz = 30;  // of the scanner's video: 25, 30, 50 or 60
    std::array<int, 4> crop_px{0, 0, 0,
                               0};   // x, y, width, height in the captured picture; all 0: the whole picture
    std::string orientation = "MF";  // of the captured picture: MF, MN, UF or UN
    // doppler: the scanner shows colour Doppler, whose colours become velocities; a pixel counts as coloured
    // from this difference of its largest and smallest of red, green and blue on (about 30 for motion JPEG).
    std::string colour = "grey";
    int chroma = 24;
    // The scanner's bar, dark to bright, evenly spaced, for flow towards the probe and away from it. Empty:
    // red to yellow and blue to cyan.
    std::vector<std::array<std::uint8_t, 3>> towards, away;
    // Scanner and grabber against tracker, from temporal calibration: 50 to 300. Empty: what the board itself
    // knows (a simulation does), else 0.
    std::optional<double> latency_ms;
    // Of the boards with a grabber. By Video4Linux a device file (a link below /dev/v4l/by-id stays with its
    // grabber), by libcamera (sensors; it sees no HDMI bridge) its name for the camera; or "auto" for the
    // first that streams pictures. And the size of the whole captured picture.
    std::string driver = "v4l2";  // or libcamera
    std::string device = "auto";
    std::array<int, 2> size_px{1920, 1080};
    double silent_ms = 1000;  // without a picture for longer the video is gone, and a recording ends
  } capture;

  struct Tracking {
    double gap_ms = 50;    // poses farther apart than this are not bridged
    double wait_ms = 100;  // how long a frame waits for the pose after it
    // Of the boards with a tracker on USB.
    int station = 1;                            // where the probe's sensor is plugged in
    int rate_hz = 240;                          // 120 or 240; a PATRIOT always gives 60
    std::array<double, 3> hemisphere{1, 0, 0};  // from the source towards the couch
    double silent_ms = 250;                     // without a reading for longer its stream is started anew
  } tracking;

  struct Pedal {
    PedalMode mode = PedalMode::hold;
    double debounce_ms = 25;
    double stuck_s = 120;  // a pedal down for longer is taken for stuck and released
    // Of the boards with a pedal: on GPIO lines (by the device tree's names) or on USB (by key names).
    std::string wired = "gpio";         // gpio or usb
    std::string device = "auto";        // of a USB pedal: its event device file, or the first known pedal
    std::string pin = "FOOTSWITCH_NO";  // the record pedal's contact that closes
    std::string opening_pin;            // its contact that opens (NC), which shows a cut wire; empty: none
    std::string second_pin;             // a second pedal's; empty: none
    bool active_low = true;             // a closed contact pulls its line to ground
    std::string bias = "as-is";         // as-is, pull-up, pull-down or off
  } pedal;

  struct Screen {
    double width_mm = 0;  // of the picture: 217 of a 10.1 inch panel, 344 of 15.6 inch. 0: 150 dots per inch
  } screen;

  // Of the boards with a touchscreen.
  struct Touch {
    std::string device = "auto";  // its event device file, or the first touchscreen
    int rotation_deg = 0;         // of the panel against the picture, clockwise: 0, 90, 180 or 270
    std::array<double, 6> calibration{1, 0, 0, 0, 1, 0};  // libinput's matrix, of parts of the panel
  } touch;

  struct Ring {
    int frames = 1200;      // 1200 of 640 x 480 are 370 MB, 40 s at 30 frames a second
    double pre_roll_s = 1;  // kept from before a press
  } ring;

  struct Exams {
    int reserve_mb = 512;   // of the disk, kept free: below it no sweep starts
    std::string export_to;  // folder that exports may go to besides sticks and cards; empty: none
  } exams;

  // The simulated scanner, tracker and pedal; used by the board `sim`.
  struct Simulation {
    std::string scene = "foetus";  // foetus, vessels, wires, spheres, ramp or constant
    std::string sweep = "linear";  // linear, fan, reversed or overlapping
    std::int64_t seed = 1;         // of speckle, tremor, noise and bounce
  } simulation;
};

// what() is one sentence with file, line, key and cure.
class ProfileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Reads TOML text over the defaults. `file` names it in sentences. Throws ProfileError for text that is no
// TOML, a key that does not exist, a value of the wrong type or out of its range.
Profile parse_profile(std::string_view toml_text, const std::string& file, const Profile& defaults = {});
Profile read_profile(const std::string& file, const Profile& defaults = {});

// The profile a board comes with (board/profiles/NAME.toml): sim, replay, cart, raspberrypi, virtual. Empty
// for any other name.
std::optional<Profile> board_profile(std::string_view board);

}  // namespace sonoband
