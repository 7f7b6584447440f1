// A camera of made-up answers behind the seam to libcamera: what the device, and the source above it, make of
// one that behaves and of one that lies.
#include "hal/capture/camera_device.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>
#include <utility>
#include <vector>

#include "hal/capture/luma.h"
#include "hal/capture/video_source.h"
#include "tests/hal/tracker/tracker_rig.h"

namespace sonoband {
namespace {

using test::at;

constexpr int width = 64;
constexpr int height = 48;
constexpr std::uint32_t yuyv = 0x56595559;  // "YUYV", first letter lowest
constexpr std::uint32_t bgr888 = 0x34324742;
constexpr std::uint32_t rgb888 = 0x34324752;

struct MadeUpCamera {
  CameraError opening = CameraError::none;
  CameraError configuring = CameraError::none;
  CameraError starting = CameraError::none;
  std::vector<std::uint32_t> offered{rgb888, yuyv};
  CameraMode agreed{.width = width, .height = height, .stride_bytes = 2 * width, .bytes = 2 * width * height};
  std::size_t buffers = 4;
  std::size_t buffer_bytes = 2 * width * height;
  bool gone = false;
  std::deque<CameraCompletion> said;  // what it says instead of the usual, one at a time
  Stamp silent_until{};
  std::uint32_t sequence = 0;
  int starts = 0;
  int stops = 0;
  int closes = 0;
  std::deque<int> queued;
};

class FakeCalls final : public CameraCalls {
 public:
  FakeCalls(MadeUpCamera& camera, Clock& clock) : camera_(camera), clock_(clock) {}

  CameraError open(const std::string& /*id*/) override { return camera_.opening; }
  std::string name() const override { return "made up"; }
  std::vector<std::uint32_t> formats() override { return camera_.offered; }
  CameraError configure(CameraMode& mode) override {
    const std::uint32_t fourcc = camera_.agreed.fourcc == 0 ? mode.fourcc : camera_.agreed.fourcc;
    mode = camera_.agreed;
    mode.fourcc = fourcc;
    return camera_.configuring;
  }
  CameraError start(double /*rate_hz*/, std::vector<std::span<const std::uint8_t>>& buffers) override {
    ++camera_.starts;
    memory_.assign(camera_.buffers, std::vector<std::uint8_t>(camera_.buffer_bytes, 0x55));
    buffers.assign(memory_.begin(), memory_.end());
    camera_.queued.clear();
    for (std::size_t i = 0; i < camera_.buffers; ++i) camera_.queued.push_back(static_cast<int>(i));
    next_ = clock_.now() + period;
    return camera_.starting;
  }
  bool wait(CameraCompletion& out, Duration timeout) override {
    if (camera_.gone) return false;
    const Stamp until = clock_.now() + timeout;
    while (next_ < camera_.silent_until) next_ += period;
    if (next_ > until || camera_.queued.empty()) {
      clock_.sleep_until(until);
      return false;
    }
    clock_.sleep_until(next_);
    out = {.slot = camera_.queued.front(),
           .sequence = camera_.sequence++,
           .stamp_ns = (next_ - std::chrono::milliseconds(3)).time_since_epoch().count(),
           .bytes = camera_.buffer_bytes,
           .whole = true};
    next_ += period;
    if (!camera_.said.empty()) {
      out = camera_.said.front();
      camera_.said.pop_front();
    }
    std::erase(camera_.queued, out.slot);
    return true;
  }
  bool gone() const override { return camera_.gone; }
  CameraError queue(int slot) override {
    EXPECT_EQ(std::count(camera_.queued.begin(), camera_.queued.end(), slot), 0) << "given back twice";
    camera_.queued.push_back(slot);
    return CameraError::none;
  }
  void stop() override { ++camera_.stops; }
  void close() override { ++camera_.closes; }

 private:
  static constexpr Duration period = std::chrono::milliseconds(20);
  MadeUpCamera& camera_;
  Clock& clock_;
  Stamp next_{};
  std::vector<std::vector<std::uint8_t>> memory_;
};

struct Rig {
  Rig() { source.start(); }
  void run_to(double s) {
    Frame f;
    while (clock.now() < at(s)) {
      const Duration patience = std::min<Duration>(std::chrono::milliseconds(30), at(s) - clock.now());
      if (source.read(f, patience) != ReadStatus::ok) continue;
      EXPECT_EQ(check_frame(f, width, height), FrameFault::none);
      // Every byte that the frame claims can be read: the address sanitizer looks on.
      EXPECT_EQ(std::count(f.data, f.data + f.bytes, 0x55), static_cast<std::ptrdiff_t>(f.bytes));
      ++frames;
    }
  }
  DeviceHealth health() const { return source.health(); }

  test::SteppedClock clock;
  MadeUpCamera camera;
  CameraDevice device{std::make_unique<FakeCalls>(camera, clock), "auto"};
  VideoSource source{device, clock, {.width = width, .height = height, .rate_hz = 50}};
  int frames = 0;
};

TEST(CameraDevice, StreamsAndCountsGaps) {
  Rig rig;
  rig.run_to(1);
  EXPECT_NEAR(rig.frames, 50, 2);
  EXPECT_EQ(rig.health().state, DeviceState::running);
  EXPECT_EQ(rig.source.mode()->format, PixelFormat::yuyv);
  rig.camera.sequence += 3;
  rig.run_to(2);
  EXPECT_EQ(rig.health().lost, 3u);
}

TEST(CameraDevice, RedIsInTheFirstByteOfWhatLinuxCallsBgr888) {
  test::SteppedClock clock;
  MadeUpCamera camera;
  camera.offered = {rgb888, bgr888, 0, yuyv};
  CameraDevice device(std::make_unique<FakeCalls>(camera, clock), "auto");
  ASSERT_EQ(device.open(), VideoStatus::ok);
  EXPECT_EQ(device.formats(), (std::vector<PixelFormat>{PixelFormat::rgb24, PixelFormat::yuyv}));
  EXPECT_EQ(device.name(), "made up of libcamera");
}

TEST(CameraDevice, UnpluggedSilentAndBack) {
  Rig rig;
  rig.run_to(1);
  rig.camera.gone = true;
  rig.camera.opening = CameraError::absent;
  rig.run_to(2.5);
  EXPECT_EQ(rig.health().state, DeviceState::absent);
  rig.camera.gone = false;
  rig.camera.opening = CameraError::none;
  rig.camera.sequence = 0;
  rig.run_to(4);
  EXPECT_EQ(rig.health().state, DeviceState::running);
  rig.camera.silent_until = at(7);
  rig.run_to(6);
  EXPECT_EQ(rig.health().state, DeviceState::stalled);
  rig.run_to(9);
  EXPECT_EQ(rig.health().state, DeviceState::running);
  EXPECT_EQ(rig.health().lost, 0u);
  EXPECT_GE(rig.camera.stops, rig.camera.starts - 1) << "each start is undone";
}

TEST(CameraDevice, EveryReasonItCannotBeUsedIsSaid) {
  for (const CameraError why :
       {CameraError::absent, CameraError::busy, CameraError::refused, CameraError::failed}) {
    for (CameraError MadeUpCamera::*where :
         {&MadeUpCamera::opening, &MadeUpCamera::configuring, &MadeUpCamera::starting}) {
      Rig rig;
      rig.camera.*where = why;
      rig.run_to(1.5);
      EXPECT_EQ(rig.frames, 0);
      EXPECT_STRNE(rig.health().reason, "");
      rig.camera.*where = CameraError::none;
      rig.run_to(3);
      EXPECT_EQ(rig.health().state, DeviceState::running);
    }
  }
}

TEST(CameraDevice, AnotherSizeFormatOrAnAbsurdOneIsRefused) {
  for (const CameraMode& mode : {CameraMode{yuyv, 80, height, 160, 7680}, CameraMode{rgb888, width, height},
                                 CameraMode{yuyv, 0xffffffff, height}, CameraMode{yuyv, 0, 0}}) {
    Rig rig;
    rig.camera.agreed = mode;
    rig.run_to(1.5);
    EXPECT_EQ(rig.frames, 0);
    EXPECT_EQ(rig.health().state, DeviceState::fault);
    EXPECT_EQ(rig.camera.starts, 0);
  }
}

TEST(CameraDevice, TooFewOrTooSmallBuffersGiveNoPicture) {
  for (const std::size_t buffers : {std::size_t{0}, std::size_t{1}}) {
    Rig rig;
    rig.camera.buffers = buffers;
    rig.run_to(1.5);
    EXPECT_EQ(rig.frames, 0);
    EXPECT_EQ(rig.health().state, DeviceState::fault);
  }
  Rig rig;
  rig.camera.buffer_bytes = 2 * width * height - 1;
  rig.run_to(1);
  EXPECT_EQ(rig.frames, 0);
  EXPECT_GT(rig.health().lost, 40u);
}

TEST(CameraDevice, ABufferThatIsBeingReadIsNotHandedOutAgain) {
  test::SteppedClock clock;
  MadeUpCamera camera;
  CameraDevice device(std::make_unique<FakeCalls>(camera, clock), "auto");
  VideoMode mode{.format = PixelFormat::yuyv, .width = width, .height = height};
  ASSERT_EQ(device.open(), VideoStatus::ok);
  ASSERT_EQ(device.negotiate(mode, 50), VideoStatus::ok);
  ASSERT_EQ(device.start(), VideoStatus::ok);
  VideoBuffer buffer;
  ASSERT_EQ(device.take(buffer, std::chrono::seconds(1)), VideoStatus::ok);
  camera.said.push_back({.slot = buffer.index, .bytes = 1, .whole = true});
  VideoBuffer again;
  EXPECT_EQ(device.take(again, std::chrono::seconds(1)), VideoStatus::failed);
  EXPECT_EQ(device.give_back(buffer.index), VideoStatus::ok);
  EXPECT_EQ(device.give_back(buffer.index), VideoStatus::failed) << "once is enough";
  EXPECT_EQ(device.give_back(-1), VideoStatus::failed);
}

TEST(CameraDevice, LiesAboutBuffersEndInARestartAndNeverInAForeignPicture) {
  std::mt19937 random(5);
  Rig rig;
  rig.run_to(0.5);
  for (int round = 0; round < 300; ++round) {
    CameraCompletion lie;
    lie.slot = std::uniform_int_distribution<int>(-2, 6)(random);
    lie.sequence = random();
    lie.stamp_ns = static_cast<std::int64_t>(random()) << (random() % 32);
    lie.bytes = random() % 3 == 0 ? ~std::size_t{0} : random() % (3 * width * height);
    lie.whole = random() % 4 != 0;
    rig.camera.said.push_back(lie);
  }
  rig.run_to(400);
  EXPECT_TRUE(rig.camera.said.empty());
  EXPECT_GT(rig.health().recoveries, 10u);
  EXPECT_EQ(rig.health().state, DeviceState::running);
}

}  // namespace
}  // namespace sonoband
