// What this machine's devices are and how they are set: one TOML file, every key checked.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

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
    // Scanner and grabber against tracker, from temporal calibration: 50 to 300. Empty: what the board itself
    // knows (a simulation does), else 0.
    std::optional<double> latency_ms;
  } capture;

  struct Tracking {
    double gap_ms = 50;    // poses farther apart than this are not bridged
    double wait_ms = 100;  // how long a frame waits for the pose after it
  } tracking;

  struct Pedal {
    PedalMode mode = PedalMode::hold;
    double debounce_ms = 25;
    double stuck_s = 120;  // a pedal down for longer is taken for stuck and released
  } pedal;

  struct Ring {
    int frames = 1200;      // 1200 of 640 x 480 are 370 MB, 40 s at 30 frames a second
    double pre_roll_s = 1;  // kept from before a press
  } ring;

  struct Exams {
    int reserve_mb = 512;  // of the disk, kept free: below it no sweep starts
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
Profile parse_profile(std::string_view toml_text, const std::string& file);
Profile read_profile(const std::string& file);

}  // namespace sonoband
