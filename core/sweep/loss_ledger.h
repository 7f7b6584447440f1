// Where every frame went. Plain counters: copy, add, subtract, print.
//
// The law (LossLedger::balanced): received = stored + the sum of lost, and stored = the sum of by_pose.
// Frames that still wait for their pose are not received yet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/sweep/tracked_frame.h"

namespace sonoband {

// Why a frame that reached the host was not stored.
enum class LossCause : std::uint8_t {
  duplicate,   // the same picture again: the scanner is frozen or slower than the video
  bad_size,    // not the configured size, or fewer bytes than its size needs
  bad_format,  // a pixel format that is not understood
  bad_stamp,   // not after the frame before it, or in the future
  late,        // taken before the release of a sweep that had been closed without it
  ring_full,   // the sweeps on hand hold all the room there is
  stopped,     // acquisition ended first
};
constexpr std::size_t loss_cause_count = 7;
constexpr std::size_t pose_status_count = 5;

// One word each, as they are printed and stored: "duplicate", "not_yet".
const char* name_of(LossCause cause);
const char* name_of(PoseStatus status);

struct LossLedger {
  std::uint64_t received = 0;  // frames the source handed over
  std::uint64_t stored = 0;    // with a pose or without
  std::array<std::uint64_t, loss_cause_count> lost{};
  std::array<std::uint64_t, pose_status_count> by_pose{};  // stored frames; all but `ok` are not rendered
  std::uint64_t device_gap = 0;       // frames the device numbered and never handed over: not in `received`
  std::uint64_t source_resets = 0;    // times the source began to number anew: what it lost then is unknown
  std::uint64_t poses = 0;            // readings of the tracker that reached acquisition
  std::uint64_t poses_refused = 0;    // not after the reading before, or in the future
  std::uint64_t poses_overrun = 0;    // the queue from the tracker's thread was full
  std::uint64_t pedal_overrun = 0;    // the queue from the pedal's thread, or of sweeps to come, was full
  std::uint64_t presses_refused = 0;  // a press that could not start a sweep

  std::uint64_t lost_for(LossCause c) const { return lost[static_cast<std::size_t>(c)]; }
  std::uint64_t with(PoseStatus s) const { return by_pose[static_cast<std::size_t>(s)]; }
  std::uint64_t all_lost() const;
  bool balanced() const;

  bool operator==(const LossLedger&) const = default;
};

// What became of one frame, or of a run of frames that never came.
struct FrameOutcome {
  enum class Kind : std::uint8_t { stored, lost, device_gap, source_reset } kind = Kind::stored;
  PoseStatus pose = PoseStatus::not_yet;   // for `stored`
  LossCause cause = LossCause::duplicate;  // for `lost`
  std::uint64_t count = 1;                 // for `device_gap`
  Stamp captured{};                        // after the latency offset; of the frame after a gap
};

void book(LossLedger& ledger, const FrameOutcome& outcome);
void unbook(LossLedger& ledger, const FrameOutcome& outcome);  // the exact opposite

// One counter as it is printed: "lost_duplicate", 12.
struct LedgerLine {
  const char* name = "";
  std::uint64_t value = 0;
};
constexpr std::size_t ledger_line_count = 2 + loss_cause_count + pose_status_count + 7;
std::array<LedgerLine, ledger_line_count> lines(const LossLedger& ledger);

}  // namespace sonoband
