#include "app/screen/status_view.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace sonoband {
namespace {

ui::Health health_of(const DeviceHealth& h) {
  switch (h.state) {
    case DeviceState::absent:
      return ui::Health::absent;
    case DeviceState::starting:
      return ui::Health::starting;
    case DeviceState::running:
      return ui::Health::good;
    case DeviceState::degraded:
      return ui::Health::degraded;
    case DeviceState::stalled:
      return ui::Health::silent;
    case DeviceState::fault:
      break;
  }
  return ui::Health::fault;
}

// What the ledger counts as lost, in the words of the screen.
constexpr std::array<std::pair<std::string_view, std::string_view>, 14> sentences = {{
    {"device_gap", "The scanner's interface skipped frames"},
    {"lost_bad_size", "The picture had another size than configured"},
    {"lost_bad_format", "The picture came in an unknown format"},
    {"lost_bad_stamp", "The picture's time stamp was wrong"},
    {"lost_late", "The picture came after its sweep had been closed"},
    {"lost_ring_full", "The memory for sweeps was full"},
    {"lost_stopped", "Acquisition was stopped first"},
    {"pose_not_yet", "No tracker reading came in time"},
    {"pose_gap", "The tracker's readings were too far apart"},
    {"pose_poor", "The tracker called its reading unusable"},
    {"pose_new_epoch", "The tracker was restarted"},
    {"poses_overrun", "Tracker readings came faster than they were taken"},
    {"pedal_overrun", "Pedal presses came faster than they were taken"},
    {"presses_refused", "A press could not start a sweep"},
}};

}  // namespace

LossLedger booked_since(const LossLedger& then, const LossLedger& now) {
  LossLedger d = now;
  d.received -= then.received;
  d.stored -= then.stored;
  for (std::size_t i = 0; i < d.lost.size(); ++i) d.lost[i] -= then.lost[i];
  for (std::size_t i = 0; i < d.by_pose.size(); ++i) d.by_pose[i] -= then.by_pose[i];
  d.device_gap -= then.device_gap;
  d.source_resets -= then.source_resets;
  d.poses -= then.poses;
  d.poses_refused -= then.poses_refused;
  d.poses_overrun -= then.poses_overrun;
  d.pedal_overrun -= then.pedal_overrun;
  d.presses_refused -= then.presses_refused;
  return d;
}

void fill_status(const cart::ApplianceStatus& status, const LossLedger& sweep, double storage_minutes,
                 double fps, std::uint32_t ring_slots, LossLines& losses, ui::StatusView& view) {
  const cart::AcquisitionStatus& acquisition = status.cart.acquisition;
  view.scanner.health = health_of(status.frames.health);
  view.scanner.reason = status.frames.health.reason;
  view.scanner.frames_per_s = acquisition.frames_hz;
  view.scanner.frozen = status.frozen;
  view.tracker.health = health_of(status.tracker.health);
  view.tracker.reason = status.tracker.health.reason;
  view.tracker.rate_hz = acquisition.poses_hz;
  view.tracker.quality = acquisition.pose_quality;
  view.pedal.health = health_of(status.pedal.health);
  view.pedal.reason = status.pedal.health.reason;
  view.pedal.down = status.cart.pedal_down;
  view.storage.minutes_left = storage_minutes;
  // Not the cart's own forecast: that is 0 while a frozen picture takes no room at all.
  view.ring.seconds_free = status.cart.ring.room / fps;
  view.ring.seconds_in_all = ring_slots / fps;

  // A picture shown twice is the scanner's own rate below the video's, not a loss of ours.
  const LossLedger& ledger = sweep;
  const std::uint64_t repeats = ledger.lost_for(LossCause::duplicate);
  const std::uint64_t unplaced = ledger.stored - ledger.with(PoseStatus::ok);
  view.losses.lost = ledger.all_lost() - repeats + ledger.device_gap + unplaced;
  view.losses.of = ledger.received + ledger.device_gap;
  std::size_t used = 0;
  for (const LedgerLine& line : lines(ledger)) {
    const auto sentence =
        std::find_if(sentences.begin(), sentences.end(), [&](const auto& s) { return s.first == line.name; });
    if (sentence != sentences.end() && line.value > 0) losses[used++] = {sentence->second, line.value};
  }
  view.losses.by_cause = std::span(losses).first(used);
}

ui::TouchscreenStatus touch_status(const DeviceHealth& health) {
  return {.expected = true, .health = health_of(health), .reason = health.reason};
}

}  // namespace sonoband
