// Sweeps to record in tests: small, made of nothing but numbers, and judged pixel by pixel.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/exam/recorder.h"

namespace sonoband::exam::test {

// A folder of its own that goes away with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// Runs `body` on a file system of its own of so many bytes, in a child process that runs the same test up to
// here; what fails there fails here. Where the system lets nobody mount one, says so and runs nothing.
void on_small_disk(std::int64_t bytes, const std::function<void(const std::filesystem::path&)>& body);

// Pixels, pose and stamps of frame `number`: functions of the number and the seed alone. Each third picture
// is noise that does not compress, the others do.
void paint(std::int64_t number, std::uint64_t seed, ImageView<std::uint8_t> out);
FrameRecord record(std::int64_t number, std::uint64_t seed, ConstPixels pixels);
PoseSample reading(std::int64_t number, std::uint64_t seed);
SweepSetup small_setup(int width, int height);

// A sweep whose frames were all painted beforehand; publish() lets the recorder see them.
class MadeSweep final : public SweepSource {
 public:
  MadeSweep(int width, int height, std::int64_t frames, std::uint64_t seed);

  void publish(std::int64_t count) { published_.store(count, std::memory_order_release); }
  void finish() { finished_.store(true, std::memory_order_release); }
  std::int64_t frames() const { return static_cast<std::int64_t>(pictures_.size()); }

  bool finished() const override { return finished_.load(std::memory_order_acquire); }
  std::int64_t published() const override { return published_.load(std::memory_order_acquire); }
  FrameRecord frame(std::int64_t number) const override;
  std::size_t take_poses(std::span<PoseSample> out) override;  // four for each published frame
  std::vector<Counter> ledger() const override;

 private:
  std::uint64_t seed_;
  std::vector<Pixels> pictures_;
  std::atomic<std::int64_t> published_{0};
  std::atomic<bool> finished_{false};
  std::int64_t poses_taken_ = 0;
};

// Sentences about what differs between the sweep in the file and the one made; at least `frames` must be
// there.
std::vector<std::string> differences(const std::filesystem::path& exam, std::int64_t sweep,
                                     std::uint64_t seed, std::int64_t frames, const std::string& vfs = {});

// True as soon as `condition` holds; false after ten seconds.
template <class Condition>
bool eventually(const Condition& condition) {
  for (int i = 0; i < 5000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return condition();
}

}  // namespace sonoband::exam::test
