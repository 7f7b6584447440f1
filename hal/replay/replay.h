// A recording played back behind the interfaces of the devices. Loading one from a file is app's job.
//
// Stamps are moved to the clock's present: the recording's first stamp is when the first of its devices
// starts, and all distances in time stay. On the system clock it plays at the speed it was recorded, on a
// virtual clock as fast as it can be worked on. Nothing is left out for a slow reader; it gets the rest late.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "hal/clock.h"
#include "hal/devices.h"
#include "hal/shared_health.h"

namespace sonoband {

struct RecordedFrame {
  const std::uint8_t* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride_bytes = 0;
  PixelFormat format = PixelFormat::grey8;
  Stamp captured{};            // on the recording's clock, any origin
  std::uint64_t sequence = 0;  // a jump is a loss while recording
};

struct RecordedPose {
  Stamp time{};  // on the same clock as the frames
  Rigid<frame::Tracker, frame::Probe> tracker_from_probe = {};
  PoseQuality quality = PoseQuality::good;
};

// Both lists in order of time; at least one frame or pose.
struct Recording {
  std::vector<RecordedFrame> frames = {};
  std::vector<RecordedPose> poses = {};
  std::shared_ptr<const void> pixels = {};  // keeps what the frames point to alive
};

enum class ReplayMode : std::uint8_t {
  once,  // then read says ended
  loop,  // again and again, each lap a new tracker epoch
};

// Where on the clock the recording is; shared by the devices that play it.
class ReplayTimeline {
 public:
  ReplayTimeline(Clock& clock, std::shared_ptr<const Recording> recording, ReplayMode mode);

  void start();  // the first call counts
  Stamp play_time(Stamp recorded, std::uint32_t lap) const;
  Clock& clock() const { return clock_; }
  const Recording& recording() const { return *recording_; }
  bool loops() const { return mode_ == ReplayMode::loop; }

 private:
  Clock& clock_;
  std::shared_ptr<const Recording> recording_;
  ReplayMode mode_;
  Stamp first_{};   // recorded
  Duration lap_{};  // from the first reading to the first of the next lap
  std::atomic<Duration> started_;
};

class ReplayTracker final : public Tracker {
 public:
  explicit ReplayTracker(std::shared_ptr<ReplayTimeline> timeline) : timeline_(std::move(timeline)) {}

  void start() override;
  ReadStatus read(std::span<PoseSample> out, std::size_t& count, Duration timeout) override;
  DeviceHealth health() const override;
  void stop() override;

 private:
  std::shared_ptr<ReplayTimeline> timeline_;
  std::size_t next_ = 0;
  std::uint32_t lap_ = 0;
  SharedHealth health_;
};

class ReplayFrameSource final : public FrameSource {
 public:
  explicit ReplayFrameSource(std::shared_ptr<ReplayTimeline> timeline) : timeline_(std::move(timeline)) {}

  void start() override;
  ReadStatus read(Frame& out, Duration timeout) override;
  DeviceHealth health() const override;
  void stop() override;

 private:
  std::shared_ptr<ReplayTimeline> timeline_;
  std::size_t next_ = 0;
  std::uint32_t lap_ = 0;
  std::optional<std::uint64_t> last_sequence_;
  SharedHealth health_;
};

}  // namespace sonoband
