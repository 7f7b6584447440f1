// What --check says of each device: found, or what is wrong and the cure, word by word.
#include "board/device_checks.h"

#include <gtest/gtest.h>

#include "hal/sim/sim_panel.h"
#include "hal/tracker/usb_port.h"
#include "tests/hal/capture/fake_video.h"
#include "tests/hal/footswitch/fake_contacts.h"
#include "tests/hal/tracker/fake_usb.h"

namespace sonoband {
namespace {

const std::string udev = ": install the udev rules of board/ (the Debian package does) and plug it in again";

std::string tracker(std::vector<std::uint16_t> products, UsbError opening = UsbError::none,
                    std::optional<std::vector<std::uint8_t>> bulk = {}) {
  test::usb::Bus bus;
  bus.products = std::move(products);
  bus.opening = opening;
  bus.bulk = std::move(bulk);
  test::usb::FakeCalls calls(bus);
  std::string said = text_of(tracker_line(calls));
  EXPECT_TRUE(bus.queued.empty() && bus.written.empty()) << "it only looks";
  return said;
}

TEST(CheckOfTheTracker, NamesWhatItIs) {
  EXPECT_EQ(tracker({0xff20}), "found    tracker  LIBERTY HS on USB");
  EXPECT_EQ(tracker({0xcf01, 0xef12}), "found    tracker  PATRIOT on USB");
  EXPECT_EQ(tracker({0xbf01}), "found    tracker  VIPER on USB");
}

TEST(CheckOfTheTracker, SaysWhatIsWrongAndTheCure) {
  const std::string missing = "MISSING  tracker  ";
  EXPECT_EQ(tracker({}), missing + "none on USB: switch the tracker on and plug in its USB cable");
  EXPECT_EQ(tracker({0xcf01, 0x0002}),
            missing +
                "an unknown Polhemus device: 0f44:cf01 0f44:0002: plug in a LIBERTY, "
                "PATRIOT or VIPER; this is none of them");
  EXPECT_EQ(tracker({0xff21}),
            missing +
                "LIBERTY HS without firmware on USB: name its firmware file for the loader, see "
                "board/README.md, and switch it off and on");
  EXPECT_EQ(tracker({0xff20}, UsbError::access), missing + "LIBERTY HS on USB, not to be opened" + udev);
  EXPECT_EQ(tracker({0xff20}, UsbError::busy),
            missing + "LIBERTY HS on USB, held by another program: close that program");
  EXPECT_EQ(tracker({0xff20}, UsbError::other),
            missing + "LIBERTY HS on USB, not answering: unplug it, plug it in again");
}

// The driver cannot use it either.
TEST(CheckOfTheTracker, IsNotTakenInByAnIdAlone) {
  const std::string fake =
      ", without the endpoints of one: this is not the tracker it says it is: plug in the right one";
  EXPECT_EQ(tracker({0xff20}, UsbError::none, {{0x02, 0x82}}), "MISSING  tracker  LIBERTY HS on USB" + fake);
  EXPECT_EQ(tracker({0xbf01}, UsbError::none, std::vector<std::uint8_t>{}),
            "MISSING  tracker  VIPER on USB" + fake);
}

class CheckOfTheVideo : public ::testing::Test {
 protected:
  CheckOfTheVideo() {
    profile.capture.size_px = {test::video::width, test::video::height};
    profile.capture.rate_hz = 60;
    profile.capture.device = "/dev/video7";
  }
  std::string said() {
    std::string text = text_of(video_line(device, profile));
    EXPECT_FALSE(device.is_open);
    EXPECT_EQ(device.starts, 0);
    return text;
  }
  test::SteppedClock clock;
  test::video::FakeVideo device{clock};
  Profile profile;
};

TEST_F(CheckOfTheVideo, NamesTheGrabberAndItsSize) {
  EXPECT_EQ(said(), "found    video    made up, 64 x 48");
}

TEST_F(CheckOfTheVideo, WarnsOfWhatTheDriverWillTakeForWantOfABetterOne) {
  device.offered = {PixelFormat::mjpeg};
  EXPECT_EQ(said(),
            "warning  video    made up, 64 x 48 as motion JPEG: compression blurs edges: use a grabber that "
            "does not, or a USB 3 port");
  device.offered = {PixelFormat::yuyv};
  device.rate_hz = 5;
  EXPECT_EQ(said(),
            "warning  video    made up, 64 x 48, 5 a second: plug it into a USB 3 port, or correct "
            "capture.rate-hz, which is 60");
}

TEST_F(CheckOfTheVideo, SaysWhatIsWrongAndTheCure) {
  const std::pair<VideoStatus, std::string> refusals[] = {
      {VideoStatus::absent,
       "no grabber as /dev/video7 for v4l2: plug it in, or name its device file (for libcamera its camera) "
       "in "
       "capture.device"},
      {VideoStatus::access_denied, "a grabber that may not be opened" + udev},
      {VideoStatus::busy, "a grabber that another program holds: close that program"}};
  for (const auto& [status, text] : refusals) {
    device.opening = status;
    EXPECT_EQ(said(), "MISSING  video    " + text);
  }
  device.opening = VideoStatus::ok;
  const std::pair<VideoStatus, std::string> answers[] = {
      {VideoStatus::no_signal, "without a signal: switch the scanner on and check the video cable"},
      {VideoStatus::no_lock, "which cannot lock to the signal: use a shorter video cable"},
      {VideoStatus::interlaced,
       "which gets interlaced video: choose a progressive mode (p, not i) on the scanner"},
      {VideoStatus::out_of_range,
       "which sends another size: set capture.size-px to the scanner's video mode, and calibrate"},
      {VideoStatus::busy, "streaming to another program: close that program"},
      {VideoStatus::absent, "not answering: unplug it, plug it in again"},
      {VideoStatus::failed, "not answering: unplug it, plug it in again"}};
  for (const auto& [status, text] : answers) {
    device.negotiating = status;
    EXPECT_EQ(said(), "MISSING  video    made up, " + text);
  }
  device.negotiating = VideoStatus::ok;
  device.actual_width = 80;
  EXPECT_EQ(
      said(),
      "MISSING  video    made up, which sends 80 x 48: set capture.size-px to the scanner's video mode, and "
      "calibrate");
  device.actual_width = test::video::width;
  profile.capture.colour = "doppler";
  device.offered = {PixelFormat::nv12};
  EXPECT_EQ(said(),
            "MISSING  video    made up, with no format that gives colour: use a grabber of YUYV, UYVY, RGB "
            "or motion "
            "JPEG, or set capture.colour to grey");
  device.offered = {};
  EXPECT_EQ(said(), "MISSING  video    made up, with no format known here: use a grabber of YUYV or NV12");
}

class CheckOfThePedal : public ::testing::Test {
 protected:
  std::string said(const std::string& where = "FOOTSWITCH_NO is gpiochip0 line 3") {
    test::pedal::FakeContacts contacts(wires, clock);
    std::string text = text_of(pedal_line(contacts, profile, where));
    EXPECT_FALSE(wires.is_open);
    return text;
  }
  test::SteppedClock clock;
  test::pedal::Wires wires;
  Profile profile = *board_profile("cart");
};

TEST_F(CheckOfThePedal, SaysWhereItIsAndWhetherItIsDown) {
  EXPECT_EQ(said(), "found    pedal    FOOTSWITCH_NO is gpiochip0 line 3");
  wires.levels = {true};
  EXPECT_EQ(said(),
            "warning  pedal    FOOTSWITCH_NO is gpiochip0 line 3, down: take the foot off; if nobody presses "
            "it, set "
            "pedal.active-low the other way");
}

TEST_F(CheckOfThePedal, APairThatContradictsItselfIsACutWire) {
  profile.pedal.opening_pin = "FOOTSWITCH_NC";
  wires.levels = {false, true};
  EXPECT_EQ(said("both"), "found    pedal    both");
  wires.levels = {true, false};
  EXPECT_EQ(said("both").substr(0, 27), "warning  pedal    both, dow");
  for (const bool level : {false, true}) {
    wires.levels = {level, level};
    EXPECT_EQ(
        said("both"),
        "MISSING  pedal    both, which contradict each other: check the pedal's cable for a cut wire, and "
        "pedal.active-low");
  }
}

TEST_F(CheckOfThePedal, SaysWhatIsWrongAndTheCure) {
  const std::pair<ContactStatus, std::string> refusals[] = {
      {ContactStatus::no_such_line,
       ": correct pedal.pin, or install the device-tree overlay that names the line"},
      {ContactStatus::access_denied, udev},
      {ContactStatus::busy, ", held by another program: close that program"},
      {ContactStatus::no_bias,
       ": this controller cannot pull lines: leave pedal.bias out and fit a resistor"}};
  for (const auto& [status, text] : refusals) {
    wires.opening = status;
    EXPECT_EQ(said("X is nowhere"), "MISSING  pedal    X is nowhere" + text);
  }
  wires.opening = ContactStatus::ok;
  wires.dead = true;
  EXPECT_EQ(said("X"), "MISSING  pedal    X, not answering: unplug it, plug it in again");
  profile.pedal.wired = "usb";
  wires.opening = ContactStatus::no_such_line;
  EXPECT_EQ(said(""),
            "MISSING  pedal    no USB pedal: plug the pedal in, or name it in pedal.device and its key in "
            "pedal.pin");
}

TEST(CheckOfTheTouchscreen, NamesItOrWarns) {
  test::SteppedClock clock;
  sim::SimPanel panel(clock);
  Profile profile;
  profile.touch.device = "/dev/input/event9";
  EXPECT_EQ(text_of(touch_line(panel, profile)).substr(0, 18), "found    touch    ");
  const std::pair<TouchStatus, std::string> refusals[] = {
      {TouchStatus::absent,
       "no touchscreen as /dev/input/event9: plug its USB cable in, or name it in touch.device; a mouse "
       "works as "
       "well"},
      {TouchStatus::access_denied, "a touchscreen that may not be read" + udev},
      {TouchStatus::busy, "touchscreen, held by another program: close that program"}};
  for (const auto& [status, text] : refusals) {
    panel.refuse(status);
    EXPECT_EQ(text_of(touch_line(panel, profile)), "warning  touch    " + text);
  }
}

}  // namespace
}  // namespace sonoband
