#include "core/sweep/loss_ledger.h"

#include <cassert>
#include <numeric>

namespace sonoband {
namespace {

// In the order of the enumerators; the names are those of the printed lines behind a common prefix.
constexpr std::array<const char*, loss_cause_count> lost_lines = {
    "lost_duplicate", "lost_bad_size",  "lost_bad_format", "lost_bad_stamp",
    "lost_late",      "lost_ring_full", "lost_stopped"};
constexpr std::array<const char*, pose_status_count> pose_lines = {"pose_ok", "pose_not_yet", "pose_gap",
                                                                   "pose_poor", "pose_new_epoch"};
static_assert(static_cast<std::size_t>(LossCause::stopped) + 1 == loss_cause_count);
static_assert(static_cast<std::size_t>(PoseStatus::new_epoch) + 1 == pose_status_count);

void book_times(LossLedger& ledger, const FrameOutcome& outcome, std::uint64_t times) {
  // Unsigned arithmetic wraps, so "minus one" is an ordinary factor.
  switch (outcome.kind) {
    case FrameOutcome::Kind::stored:
      ledger.received += times;
      ledger.stored += times;
      ledger.by_pose[static_cast<std::size_t>(outcome.pose)] += times;
      return;
    case FrameOutcome::Kind::lost:
      ledger.received += times;
      ledger.lost[static_cast<std::size_t>(outcome.cause)] += times;
      return;
    case FrameOutcome::Kind::device_gap:
      ledger.device_gap += times * outcome.count;
      return;
    case FrameOutcome::Kind::source_reset:
      ledger.source_resets += times;
      return;
  }
}

}  // namespace

const char* name_of(LossCause cause) {
  return lost_lines[static_cast<std::size_t>(cause)] + sizeof("lost_") - 1;
}

const char* name_of(PoseStatus status) {
  return pose_lines[static_cast<std::size_t>(status)] + sizeof("pose_") - 1;
}

std::uint64_t LossLedger::all_lost() const {
  return std::accumulate(lost.begin(), lost.end(), std::uint64_t{0});
}

bool LossLedger::balanced() const {
  return received == stored + all_lost() &&
         stored == std::accumulate(by_pose.begin(), by_pose.end(), std::uint64_t{0});
}

void book(LossLedger& ledger, const FrameOutcome& outcome) {
  book_times(ledger, outcome, 1);
}

void unbook(LossLedger& ledger, const FrameOutcome& outcome) {
  book_times(ledger, outcome, ~std::uint64_t{0});
}

std::array<LedgerLine, ledger_line_count> lines(const LossLedger& ledger) {
  std::array<LedgerLine, ledger_line_count> out{};
  std::size_t n = 0;
  const auto line = [&](const char* name, std::uint64_t value) { out[n++] = {name, value}; };
  line("received", ledger.received);
  line("stored", ledger.stored);
  for (std::size_t i = 0; i < loss_cause_count; ++i) line(lost_lines[i], ledger.lost[i]);
  for (std::size_t i = 0; i < pose_status_count; ++i) line(pose_lines[i], ledger.by_pose[i]);
  line("device_gap", ledger.device_gap);
  line("source_resets", ledger.source_resets);
  line("poses", ledger.poses);
  line("poses_refused", ledger.poses_refused);
  line("poses_overrun", ledger.poses_overrun);
  line("pedal_overrun", ledger.pedal_overrun);
  line("presses_refused", ledger.presses_refused);
  assert(n == ledger_line_count);
  return out;
}

}  // namespace sonoband
