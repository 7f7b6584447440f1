// Every key is taken, and whatever does not fit is refused with file, line and cure.
#include "board/profile.h"

#include <gtest/gtest.h>

namespace sonoband {
namespace {

std::string refusal(const std::string& text) {
  try {
    parse_profile(text, "cart.toml");
  } catch (const ProfileError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Profile, EmptyTextGivesTheDefaults) {
  const Profile p = parse_profile("", "cart.toml");
  EXPECT_EQ(p.capture.rate_hz, 30);
  EXPECT_EQ(p.pedal.mode, PedalMode::hold);
  EXPECT_EQ(p.simulation.scene, "foetus");
}

TEST(Profile, TakesEveryKey) {
  const Profile p = parse_profile(R"(
[capture]
rate-hz = 60
crop-px = [10, 20, 640, 480]
orientation = "UN"
colour = "doppler"
chroma = 30
towards = ["#400000", "#FF0000", "#ffffff"]
away = ["#002000", "#00ff80"]
latency-ms = 82.5
silent-ms = 2000
[tracking]
silent-ms = 300
gap-ms = 40
wait-ms = 120
[pedal]
mode = "toggle"
debounce-ms = 20
stuck-s = 90
[ring]
frames = 600
pre-roll-s = 0.5
[exams]
reserve-mb = 2048
export-to = "/srv/exports"
[simulation]
scene = "vessels"
sweep = "fan"
seed = 7
)",
                                  "cart.toml");
  EXPECT_EQ(p.capture.rate_hz, 60);
  EXPECT_EQ(p.capture.crop_px, (std::array<int, 4>{10, 20, 640, 480}));
  EXPECT_EQ(p.capture.orientation, "UN");
  EXPECT_EQ(p.capture.colour, "doppler");
  EXPECT_EQ(p.capture.chroma, 30);
  EXPECT_EQ(p.capture.towards,
            (std::vector<std::array<std::uint8_t, 3>>{{0x40, 0, 0}, {0xff, 0, 0}, {0xff, 0xff, 0xff}}));
  EXPECT_EQ(p.capture.away, (std::vector<std::array<std::uint8_t, 3>>{{0, 0x20, 0}, {0, 0xff, 0x80}}));
  EXPECT_EQ(p.capture.latency_ms, 82.5);
  EXPECT_EQ(p.capture.silent_ms, 2000);
  EXPECT_EQ(p.tracking.silent_ms, 300);
  EXPECT_EQ(p.tracking.gap_ms, 40);
  EXPECT_EQ(p.tracking.wait_ms, 120);
  EXPECT_EQ(p.pedal.mode, PedalMode::toggle);
  EXPECT_EQ(p.pedal.debounce_ms, 20);
  EXPECT_EQ(p.pedal.stuck_s, 90);
  EXPECT_EQ(p.ring.frames, 600);
  EXPECT_EQ(p.ring.pre_roll_s, 0.5);
  EXPECT_EQ(p.exams.reserve_mb, 2048);
  EXPECT_EQ(p.exams.export_to, "/srv/exports");
  EXPECT_EQ(p.simulation.scene, "vessels");
  EXPECT_EQ(p.simulation.sweep, "fan");
  EXPECT_EQ(p.simulation.seed, 7);
}

TEST(Profile, TakesTheKeysOfRealDevices) {
  const Profile p = parse_profile(R"(
[capture]
driver = "libcamera"
device = "/dev/v4l/by-id/grabber"
size-px = [1280, 720]
[tracking]
station = 2
rate-hz = 120
hemisphere = [0, 0, -1]
[pedal]
wired = "usb"
device = "/dev/input/by-id/pedal"
pin = "KEY_A"
opening-pin = "KEY_B"
second-pin = "KEY_C"
active-low = false
bias = "pull-up"
[screen]
width-mm = 217
[touch]
device = "/dev/input/by-id/panel"
rotation-deg = 270
calibration = [-1, 0, 1, 0, 1.5, -0.25]
)",
                                  "cart.toml");
  EXPECT_EQ(p.screen.width_mm, 217);
  EXPECT_EQ(p.touch.device, "/dev/input/by-id/panel");
  EXPECT_EQ(p.touch.rotation_deg, 270);
  EXPECT_EQ(p.touch.calibration, (std::array<double, 6>{-1, 0, 1, 0, 1.5, -0.25}));
  EXPECT_EQ(p.capture.driver, "libcamera");
  EXPECT_EQ(p.capture.device, "/dev/v4l/by-id/grabber");
  EXPECT_EQ(p.capture.size_px, (std::array<int, 2>{1280, 720}));
  EXPECT_EQ(p.tracking.station, 2);
  EXPECT_EQ(p.tracking.rate_hz, 120);
  EXPECT_EQ(p.tracking.hemisphere, (std::array<double, 3>{0, 0, -1}));
  EXPECT_EQ(p.pedal.wired, "usb");
  EXPECT_EQ(p.pedal.device, "/dev/input/by-id/pedal");
  EXPECT_EQ(p.pedal.pin, "KEY_A");
  EXPECT_EQ(p.pedal.opening_pin, "KEY_B");
  EXPECT_EQ(p.pedal.second_pin, "KEY_C");
  EXPECT_FALSE(p.pedal.active_low);
  EXPECT_EQ(p.pedal.bias, "pull-up");
  EXPECT_EQ(refusal("[tracking]\nrate-hz = 60\n"), "cart.toml:2: tracking.rate-hz must be 120 or 240");
  EXPECT_NE(refusal("[tracking]\nhemisphere = [0, 0, 0]\n"), "accepted");
  EXPECT_NE(refusal("[pedal]\nactive-low = 1\n"), "accepted");
  EXPECT_NE(refusal("[capture]\nsize-px = [0, 480]\n"), "accepted");
  EXPECT_EQ(refusal("[touch]\nrotation-deg = 45\n"),
            "cart.toml:2: touch.rotation-deg must be 0, 90, 180 or 270");
  EXPECT_NE(refusal("[touch]\ncalibration = [1, 0, 0, 0, 1]\n"), "accepted");
  EXPECT_NE(refusal("[screen]\nwidth-mm = -1\n"), "accepted");
}

TEST(Profile, EveryBoardHasOneAndAMachinesOwnGoesOverIt) {
  for (const char* board : {"sim", "replay", "cart", "raspberrypi", "virtual"})
    EXPECT_TRUE(board_profile(board)) << board;
  EXPECT_FALSE(board_profile("toaster"));
  EXPECT_EQ(board_profile("raspberrypi")->pedal.opening_pin, "GPIO27");
  const Profile own = parse_profile("[pedal]\npin = \"GPIO5\"\n", "own.toml", *board_profile("raspberrypi"));
  EXPECT_EQ(own.pedal.pin, "GPIO5");
  EXPECT_EQ(own.pedal.opening_pin, "GPIO27");
}

TEST(Profile, RefusalsNameFileLineAndCure) {
  EXPECT_EQ(refusal("[pedal]\nmode = \"push\"\n"),
            "cart.toml:2: pedal.mode must be one of \"hold\" \"toggle\"");
  EXPECT_EQ(refusal("[pedal]\n\ndebounce = 3\n"),
            "cart.toml:3: [pedal] has no key debounce; it has wired, device, pin, opening-pin, second-pin, "
            "active-low, bias, mode, debounce-ms, stuck-s");
  EXPECT_EQ(refusal("[ring]\nframes = 3\n"),
            "cart.toml:2: ring.frames must be a whole number from 16 to 100000");
  EXPECT_EQ(refusal("[ring]\nframes = 30.5\n"),
            "cart.toml:2: ring.frames must be a whole number from 16 to 100000");
  EXPECT_EQ(refusal("[capture]\ndriver = \"v4l\"\n"),
            "cart.toml:2: capture.driver must be one of \"v4l2\" \"libcamera\"");
  EXPECT_EQ(refusal("[capture]\nrate-hz = nan\n"),
            "cart.toml:2: capture.rate-hz must be a number from 1 to 240");
  for (const char* wrong : {"[]", "[\"#400000\"]", "[\"#400000\", \"red\"]", "[\"#400000\", \"#12345g\"]",
                            "[1, 2]", "\"#400000\""})
    EXPECT_EQ(refusal(std::string("[capture]\ntowards = ") + wrong + "\n"),
              "cart.toml:2: capture.towards must be 2 to 16 colours, dark to bright, such as [\"#400000\", "
              "\"#ff0000\"]");
  EXPECT_EQ(refusal("[capture]\ncrop-px = [1, 2, 3]\n"),
            "cart.toml:2: capture.crop-px must be four whole numbers [x, y, width, height] from 0 to 16384");
  EXPECT_TRUE(refusal("[lights]\nred = 1\n").starts_with("cart.toml:1: there is no table [lights]"))
      << refusal("[lights]\nred = 1\n");
  EXPECT_TRUE(refusal("x = ").starts_with("cart.toml:1: this is no TOML")) << refusal("x = ");
  EXPECT_TRUE(refusal("frames = 3").starts_with("cart.toml:1: there is no table [frames]"))
      << refusal("frames = 3");
}

TEST(Profile, AFileThatIsNotThereIsSaidToBeMissing) {
  EXPECT_THROW(read_profile("/nonexistent/cart.toml"), ProfileError);
  EXPECT_THROW(read_profile("/"), ProfileError);
}

}  // namespace
}  // namespace sonoband
