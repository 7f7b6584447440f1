// The one place where pictures, poses and the pedal meet. Values and times go in; published frames, sweeps
// and notices come out. It reads no clock, and after its construction takes no heap and no lock.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "app/cart/picture.h"
#include "app/cart/rate_meter.h"
#include "core/sweep/frame_ring.h"
#include "core/sweep/pairing.h"
#include "core/sweep/pose_track.h"
#include "hal/devices.h"

namespace sonoband::cart {

struct AcquisitionSettings {
  int source_width = 640;  // of the raw capture; any other size is refused as bad_size
  int source_height = 480;
  Crop crop;
  std::shared_ptr<const FlowKeys> flow;  // of a ring of Doppler pictures; null: grey
  // Of the cropped and flipped picture: moving the crop changes it.
  Affine<frame::Probe, frame::Image> probe_from_image;
  Rigid<frame::World, frame::Tracker> world_from_tracker;
  PairingSettings pairing;  // the latency offset is here
  PoseLimits pose;
  std::size_t readings = 2048;  // kept; 8 s at 240 Hz, and pictures wait less than one
  Duration pre_roll = std::chrono::seconds(1);
  // How long after a release the pictures taken before it are waited for, besides the latency offset. Usual:
  // 500 ms, ten times the delay of a USB grabber.
  Duration settle = std::chrono::milliseconds(500);
  // A picture that differs from the last by less than this mean number of grey levels (over the mask) is the
  // same one: a scanner slower than its video, or frozen. 0 turns it off. Usual: 0.5.
  double duplicate_levels = 0.5;
  // A stamp so far in the future is wrong. More than the jitter filters of the drivers can run ahead.
  Duration ahead = std::chrono::milliseconds(100);
};

// What happened to a sweep.
struct Notice {
  enum class Kind : std::uint8_t {
    started,  // `sweep` holds it; it grows
    refused,  // no room for it, or too many are held
    full,     // it takes no more; `at`: when the first frame refused was captured. End it.
    ended,    // it is complete and has its ledger
  } kind = Kind::started;
  std::int32_t sweep_id = 0;
  Stamp at{};
  Sweep sweep;  // for started
};

struct AcquisitionStatus {
  LossLedger ledger;     // since start
  double frames_hz = 0;  // handed over by the source
  double unique_hz = 0;  // of which new pictures
  double poses_hz = 0;   // readings, usable or not
  // When the last of each came.
  std::optional<Stamp> last_frame;
  std::optional<Stamp> last_picture;  // that was no duplicate
  std::optional<Stamp> last_reading;
  std::optional<Stamp> last_pose;                   // that is usable
  PoseQuality pose_quality = PoseQuality::missing;  // of the newest reading
  PoseStatus frame_pose = PoseStatus::not_yet;      // of the newest published frame
  std::size_t waiting = 0;                          // frames without pose yet
};

// One thread: the writer of the ring. The ring must outlive it and have no other writer.
class Acquisition {
 public:
  // Asserts that the crop, of the ring's size, lies within the source's.
  Acquisition(FrameRing& ring, const AcquisitionSettings& settings);

  void on_pose(const PoseSample& sample, Stamp now);
  void on_frame(const Frame& frame, Stamp now);
  // Lets frames go whose wait is over and sweeps end whose pictures are all there. Call some 50 times a
  // second or more, also when nothing came.
  void tick(Stamp now);

  // The stamps are the events' own, in order; the news may come late. The sweep has every frame captured from
  // `pressed` to `released`, both included, whenever either became known, as far as the ring remembers. A
  // sweep ends when a later frame comes or when `settle` is over; the next may be asked for before that.
  // A begin without an end in between is our bug (asserted). Gives the sweep's id, from 1; 0: too much is
  // asked for at once, no sweep will come.
  std::int32_t begin_sweep(Stamp pressed);
  void end_sweep(Stamp released);

  // The oldest notice not yet taken.
  std::optional<Notice> take_notice();

  // Readings and pedal edges that never reached this thread because a queue was full.
  void count_overruns(std::uint64_t poses, std::uint64_t edges);
  void count_refused_press() { ++ledger_.presses_refused; }

  // The end: frames that wait are booked as stopped, an open sweep ends at its last frame.
  void stop(Stamp now);

  AcquisitionStatus status(Stamp now) const;
  const LossLedger& ledger() const { return ledger_; }
  bool busy() const { return ring_.growing() || commands_size_ > 0; }  // a sweep grows or is asked for

 private:
  struct Command {
    std::int32_t begin = 0;  // the new sweep's id; 0: an end
    Stamp at{};
  };
  // What was booked for a frame, kept for a while: the news of a press or release comes later than frames.
  struct Entry {
    FrameOutcome outcome;
    FrameOutcome for_sweep;  // differs where the sweep lost what the live view has
    bool in_sweep = false;
  };

  bool push_command(const Command& command);
  void run_commands();  // as far as is possible without knowing more
  void start_sweep(std::int32_t id, Stamp pressed);
  void finish_sweep();
  void publish_ready(Stamp now);
  void publish(const PairedFrame& paired);
  std::optional<LossCause> refusal(const Frame& frame, Stamp now) const;
  void note_sequence(const Frame& frame);
  void account(const FrameOutcome& outcome, const FrameOutcome& for_sweep);
  void account(const FrameOutcome& outcome) { account(outcome, outcome); }
  void lose(LossCause cause, Stamp captured);
  bool repeats(const RingSlot& slot) const;
  void notify(Notice notice);

  FrameRing& ring_;
  AcquisitionSettings settings_;
  PoseTrack track_;
  Pairing pairing_;
  std::uint64_t duplicate_limit_ = 0;

  std::optional<std::uint64_t> last_sequence_;
  std::optional<Stamp> last_stamped_;
  std::optional<std::uint32_t> last_slot_;  // waiting or the newest published: not overwritten either way

  std::array<Command, 32> commands_{};  // circular
  std::size_t commands_first_ = 0;
  std::size_t commands_size_ = 0;
  std::optional<Stamp> ending_;  // the open sweep's release, once known
  bool full_told_ = false;
  std::int32_t last_id_ = 0;   // given out
  std::int32_t sweep_id_ = 0;  // of the sweep begun last
  Stamp pressed_{};            // of the sweep begun last
  Stamp last_published_ = Stamp::min();
  struct Span {
    Stamp pressed{};
    Stamp released{};
  };
  std::optional<Span> closed_;  // the sweep ended last: what was taken within it and comes now is late

  LossLedger ledger_;
  LossLedger at_start_;  // ledger_ when the open sweep began
  LossLedger sweep_ledger_;
  std::array<Entry, 1024> log_{};  // circular, 17 s of frames at 60 Hz
  std::uint64_t log_count_ = 0;

  std::array<Notice, 64> notices_{};  // circular
  std::size_t notices_first_ = 0;
  std::size_t notices_size_ = 0;

  AcquisitionStatus status_;
  RateMeter frames_rate_;
  RateMeter unique_rate_;
  RateMeter poses_rate_;
};

}  // namespace sonoband::cart
