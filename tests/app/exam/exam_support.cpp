#include "tests/app/exam/exam_support.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <stdlib.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string_view>

#include "app/exam/exam_reader.h"

namespace sonoband::exam::test {

TemporaryFolder::TemporaryFolder() {
  // Memory is a disk that can be cut a thousand times without waiting for it.
  const std::filesystem::path memory = "/dev/shm";
  const std::filesystem::path base =
      ::access(memory.c_str(), W_OK) == 0 ? memory : std::filesystem::temp_directory_path();
  std::string name = (base / "sonoband-exam-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}
TemporaryFolder::~TemporaryFolder() {
  std::error_code none;
  std::filesystem::remove_all(path_, none);
}

// The child is this test anew, from its start: a process with threads (libraries start some when they are
// loaded) may fork, but what it forks may not start threads under the thread sanitizer.
void on_small_disk(std::int64_t bytes, const std::function<void(const std::filesystem::path&)>& body) {
  constexpr int not_permitted = 77;
  constexpr int passed = 42;                               // a child that never came to the call ends with 0
  constexpr const char* variable = "SONOBAND_SMALL_DISK";  // in the child: number of the call, mount point
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  static const ::testing::TestInfo* counted = nullptr;
  static int calls = 0;
  if (counted != test) calls = 0;
  counted = test;
  const std::string call = std::to_string(++calls) + ":";
  if (const char* disk = std::getenv(variable)) {
    if (!std::string_view(disk).starts_with(call)) return;
    body(disk + call.size());
    std::fflush(nullptr);
    ::_exit(::testing::Test::HasFailure() ? 1 : passed);
  }
  const TemporaryFolder mount_point;
  ::setenv(variable, (call + mount_point.path().string()).c_str(), 1);
  const std::string filter = std::string("--gtest_filter=") + test->test_suite_name() + "." + test->name();
  const std::string size = "size=" + std::to_string(bytes) + ",mode=700";
  std::fflush(nullptr);
  const ::pid_t child = ::fork();
  if (child == 0) {
    const int user = ::geteuid() == 0 ? 0 : CLONE_NEWUSER;
    if (::unshare(CLONE_NEWNS | user) != 0 ||
        ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        ::mount("none", mount_point.path().c_str(), "tmpfs", 0, size.c_str()) != 0)
      ::_exit(not_permitted);
    ::execl("/proc/self/exe", "app_tests", filter.c_str(), "--gtest_brief=1", nullptr);
    ::_exit(2);
  }
  ::unsetenv(variable);
  ASSERT_GE(child, 0);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << "the child ended by signal " << WTERMSIG(status);
  if (WEXITSTATUS(status) == not_permitted) {
    std::printf("this system lets nobody mount a small disk: not tested here\n");
    return;
  }
  EXPECT_EQ(WEXITSTATUS(status), passed) << "see what failed in the child above";
}

void paint(std::int64_t number, std::uint64_t seed, ImageView<std::uint8_t> out) {
  std::mt19937 random(static_cast<std::uint32_t>(seed * 1000003 + static_cast<std::uint64_t>(number)));
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      out(x, y) = number % 3 == 0 ? static_cast<std::uint8_t>(random())
                                  : static_cast<std::uint8_t>(number + (x / 8) * 3 + (y / 8) * 5 +
                                                              static_cast<std::int64_t>(seed));
}

FrameRecord record(std::int64_t number, std::uint64_t seed, ConstPixels pixels) {
  FrameRecord f;
  f.pixels = pixels;
  f.number = number;
  f.pre_roll = number < 3;
  f.pose_status = number % 5 == 4 ? PoseStatus::gap : PoseStatus::ok;
  const double n = static_cast<double>(number);
  f.tracker_from_probe = Rigid<frame::Tracker, frame::Probe>{
      Eigen::AngleAxisd(0.01 * n, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(),
      Eigen::Vector3d(n / 3, std::sqrt(n + static_cast<double>(seed)), -n / 7)};
  if (number % 5 == 4) f.tracker_from_probe.reset();
  if (f.tracker_from_probe) {
    f.world_from_image.linear = f.tracker_from_probe->rotation * 0.085;
    f.world_from_image.translation = f.tracker_from_probe->translation;
  }
  f.captured = Stamp(std::chrono::milliseconds(1000 + 16 * number));
  f.stamped = f.captured + std::chrono::microseconds(64800);
  f.arrived = f.stamped + std::chrono::microseconds(1234 + number);
  f.device_ns = 77'000'000'000 + number;
  f.device_count = static_cast<std::uint64_t>(number) * 2 + 1;
  return f;
}

PoseSample reading(std::int64_t number, std::uint64_t seed) {
  PoseSample p;
  p.time = Stamp(std::chrono::milliseconds(1000 + 4 * number));
  p.arrived = p.time + std::chrono::microseconds(900);
  p.quality = number % 11 == 10 ? PoseQuality::distorted : PoseQuality::good;
  p.epoch = 1;
  p.device_frame = static_cast<std::uint32_t>(number);
  p.device_ms = static_cast<std::uint32_t>(4 * number + static_cast<std::int64_t>(seed));
  p.tracker_from_probe.translation = {static_cast<double>(number) / 9, 2, 3};
  return p;
}

SweepSetup small_setup(int width, int height) {
  SweepSetup s;
  s.width = width;
  s.height = height;
  s.frames_per_second = 60;
  s.probe_from_image.emplace();
  s.probe_from_image->linear << 0.085, 0.003, 0, 0, 1.0 / 3, 0, 0, 0, 1;
  s.probe_from_image->translation << 0.1, -20, 1e-17;
  s.calibration_error_mm = 0.46;
  s.calibration_name = "test calibration";
  s.latency_offset = std::chrono::microseconds(64800);
  s.crop = {10, 20, width, height};
  s.mask = Pixels(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) s.mask.view()(x, y) = x + y > 6 ? 1 : 0;
  s.versions = {{"sonoband", "0"}, {"tracker", "simulated"}};
  s.pressed = Stamp(std::chrono::milliseconds(1040));
  s.pressed_utc_ns = 1'700'000'000'000'000'000;
  return s;
}

MadeSweep::MadeSweep(int width, int height, std::int64_t frames, std::uint64_t seed) : seed_(seed) {
  for (std::int64_t i = 0; i < frames; ++i) {
    pictures_.emplace_back(width, height);
    paint(i, seed, pictures_.back().view());
  }
}

FrameRecord MadeSweep::frame(std::int64_t number) const {
  return record(number, seed_, pictures_[static_cast<std::size_t>(number)].view());
}

std::size_t MadeSweep::take_poses(std::span<PoseSample> out) {
  std::size_t count = 0;
  while (count < out.size() && poses_taken_ < 4 * published()) out[count++] = reading(poses_taken_++, seed_);
  return count;
}

std::vector<Counter> MadeSweep::ledger() const {
  return {{"received", static_cast<std::uint64_t>(published() + 2)},
          {"stored", static_cast<std::uint64_t>(published())},
          {"lost_duplicate", 2}};
}

std::vector<std::string> differences(const std::filesystem::path& exam, std::int64_t sweep,
                                     std::uint64_t seed, std::int64_t frames, const std::string& vfs) {
  const ExamReader reader(exam, vfs);
  const SweepSetup setup = reader.setup(sweep);
  StoredFrames stored = reader.frames(sweep);
  std::vector<std::string> wrong = stored.damage;
  if (static_cast<std::int64_t>(stored.frames.size()) < frames)
    wrong.push_back("only " + std::to_string(stored.frames.size()) + " of " + std::to_string(frames) +
                    " frames");
  Pixels made(setup.width, setup.height);
  Pixels read(setup.width, setup.height);
  std::int64_t next = 0;
  for (const StoredFrame& f : stored.frames) {
    const std::string name = "frame " + std::to_string(f.record.number);
    if (f.record.number != next++) wrong.push_back(name + " follows out of order");
    std::string damage = reader.pixels(sweep, f, read.view());
    if (!damage.empty()) wrong.push_back(std::move(damage));
    paint(f.record.number, seed, made.view());
    for (int y = 0; y < setup.height; ++y)
      if (!std::equal(made.view().row(y), made.view().row(y) + setup.width, read.view().row(y))) {
        wrong.push_back(name + ": other pixels");
        break;
      }
    const FrameRecord e = record(f.record.number, seed, {});
    const FrameRecord& r = f.record;
    if (r.pre_roll != e.pre_roll || r.pose_status != e.pose_status || r.captured != e.captured ||
        r.stamped != e.stamped || r.arrived != e.arrived || r.device_ns != e.device_ns ||
        r.device_count != e.device_count ||
        r.tracker_from_probe.has_value() != e.tracker_from_probe.has_value() ||
        r.world_from_image.linear != e.world_from_image.linear ||
        r.world_from_image.translation != e.world_from_image.translation ||
        (r.tracker_from_probe && (r.tracker_from_probe->rotation != e.tracker_from_probe->rotation ||
                                  r.tracker_from_probe->translation != e.tracker_from_probe->translation)))
      wrong.push_back(name + ": other numbers");
  }
  std::int64_t expected = 0;
  for (const PoseSample& p : reader.poses(sweep, wrong)) {
    const PoseSample e = reading(expected++, seed);
    if (p.time != e.time || p.arrived != e.arrived || p.quality != e.quality || p.epoch != e.epoch ||
        p.device_frame != e.device_frame || p.device_ms != e.device_ms ||
        p.tracker_from_probe.translation != e.tracker_from_probe.translation) {
      wrong.push_back("raw reading " + std::to_string(expected - 1) + " differs");
      break;
    }
  }
  if (expected < 4 * frames) wrong.push_back("only " + std::to_string(expected) + " raw readings");
  return wrong;
}

}  // namespace sonoband::exam::test
