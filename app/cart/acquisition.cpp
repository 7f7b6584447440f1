#include "app/cart/acquisition.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace sonoband::cart {
namespace {

// A jump of the source's numbers beyond this is no loss but a new numbering: half an hour at 60 Hz.
constexpr std::uint64_t longest_gap = 100000;

std::uint64_t mask_pixels(const FrameRing& ring) {
  const MaskView mask = ring.mask();
  if (mask.empty()) return static_cast<std::uint64_t>(ring.settings().width) * ring.settings().height;
  std::uint64_t count = 0;
  for (int y = 0; y < mask.height; ++y)
    count += static_cast<std::uint64_t>(
        std::count_if(mask.row(y), mask.row(y) + mask.width, [](std::uint8_t m) { return m != 0; }));
  return count;
}

}  // namespace

Acquisition::Acquisition(FrameRing& ring, const AcquisitionSettings& settings)
    : ring_(ring),
      settings_(settings),
      track_(settings.readings, settings.pose),
      pairing_(settings.pairing),
      duplicate_limit_(
          static_cast<std::uint64_t>(settings.duplicate_levels * static_cast<double>(mask_pixels(ring)))) {
  assert(settings.crop.x >= 0 && settings.crop.x + ring.settings().width <= settings.source_width);
  assert(settings.crop.y >= 0 && settings.crop.y + ring.settings().height <= settings.source_height);
  assert((ring.settings().kind == PixelKind::doppler) == (settings.flow != nullptr));
  assert(ring.settings().reserve >= settings.pairing.capacity + ring.settings().leases + 2);
}

void Acquisition::on_pose(const PoseSample& sample, Stamp now) {
  ++ledger_.poses;
  poses_rate_.happened(now);
  status_.last_reading = now;
  status_.pose_quality = sample.quality;
  if (sample.time > now + settings_.ahead || !track_.add(sample))
    ++ledger_.poses_refused;
  else if (usable(track_.newest().quality))
    status_.last_pose = now;
  publish_ready(now);
}

std::optional<LossCause> Acquisition::refusal(const Frame& frame, Stamp now) const {
  if (const auto cause = unusable(frame, settings_.source_width, settings_.source_height)) return cause;
  if (frame.captured > now + settings_.ahead) return LossCause::bad_stamp;
  if (last_stamped_ && frame.captured <= *last_stamped_) return LossCause::bad_stamp;
  const Stamp captured = pairing_.captured(frame.captured);
  if (closed_ && captured >= closed_->pressed && captured <= closed_->released) return LossCause::late;
  return std::nullopt;
}

void Acquisition::note_sequence(const Frame& frame) {
  if (last_sequence_ && frame.sequence != *last_sequence_ + 1) {
    FrameOutcome outcome;
    outcome.captured = pairing_.captured(frame.captured);
    const bool gap = frame.sequence > *last_sequence_ && frame.sequence - *last_sequence_ <= longest_gap;
    outcome.kind = gap ? FrameOutcome::Kind::device_gap : FrameOutcome::Kind::source_reset;
    outcome.count = gap ? frame.sequence - *last_sequence_ - 1 : 1;
    account(outcome);
  }
  last_sequence_ = frame.sequence;
}

bool Acquisition::repeats(const RingSlot& slot) const {
  return duplicate_limit_ > 0 && last_slot_ &&
         differ_less(slot.pixels, ring_.slot(*last_slot_).pixels, duplicate_limit_);
}

void Acquisition::on_frame(const Frame& frame, Stamp now) {
  frames_rate_.happened(now);
  status_.last_frame = now;
  note_sequence(frame);
  const Stamp captured = pairing_.captured(frame.captured);
  if (const auto cause = refusal(frame, now)) {
    lose(*cause, captured);
    return;
  }
  publish_ready(now);
  RingSlot* slot = ring_.claim();
  if (slot == nullptr) {  // not with the reserve that the constructor asks for
    lose(LossCause::ring_full, captured);
    return;
  }
  last_stamped_ = frame.captured;
  if (settings_.flow)
    settings_.flow->copy(frame, settings_.crop, slot->pixels);
  else
    copy_luma(frame, settings_.crop, slot->pixels);
  if (repeats(*slot)) {
    ring_.discard(*slot);
    lose(LossCause::duplicate, captured);
    return;
  }
  slot->frame.raw = {frame.captured, frame.arrived, frame.device_stamp_ns, frame.sequence};
  [[maybe_unused]] const bool taken = pairing_.push({slot->index, frame.captured, now});
  assert(taken);  // publish_ready leaves room
  last_slot_ = slot->index;
  unique_rate_.happened(now);
  status_.last_picture = now;
  publish_ready(now);
}

void Acquisition::publish_ready(Stamp now) {
  while (const auto paired = pairing_.pop(track_, now)) publish(*paired);
}

void Acquisition::publish(const PairedFrame& paired) {
  RingSlot& slot = ring_.slot(paired.ticket);
  TrackedFrame& tracked = slot.frame.tracked;
  tracked.captured = paired.captured;
  tracked.pose_status = paired.pose.status;
  if (paired.pose.status == PoseStatus::ok) {
    slot.frame.tracker_from_probe = paired.pose.tracker_from_probe;
    set_pose(tracked,
             settings_.world_from_tracker * (paired.pose.tracker_from_probe * settings_.probe_from_image));
  }
  status_.frame_pose = paired.pose.status;
  while (ending_ && paired.captured > *ending_) finish_sweep();
  const Published published = ring_.publish(slot);
  last_published_ = paired.captured;

  FrameOutcome outcome;
  outcome.pose = paired.pose.status;
  outcome.captured = paired.captured;
  FrameOutcome for_sweep = outcome;
  if (published == Published::ring_full) {
    for_sweep.kind = FrameOutcome::Kind::lost;
    for_sweep.cause = LossCause::ring_full;
  }
  account(outcome, for_sweep);
  if (published == Published::ring_full && !ending_ && !full_told_) {
    full_told_ = true;
    notify({Notice::Kind::full, sweep_id_, paired.captured, {}});
  }
}

void Acquisition::tick(Stamp now) {
  publish_ready(now);
  // A release in the far past waits no longer: whatever was taken before it has come or will be late.
  if (ending_ && pairing_.waiting() == 0 &&
      now > *ending_ + std::max(settings_.pairing.latency_offset, Duration{}) + settings_.settle)
    finish_sweep();
}

std::int32_t Acquisition::begin_sweep(Stamp pressed) {
  return push_command({++last_id_, pressed}) ? last_id_ : 0;
}

void Acquisition::end_sweep(Stamp released) {
  push_command({0, released});
}

bool Acquisition::push_command(const Command& command) {
  if (commands_size_ == commands_.size()) {
    ++ledger_.pedal_overrun;
    return false;
  }
  commands_[(commands_first_ + commands_size_) % commands_.size()] = command;
  ++commands_size_;
  run_commands();
  return true;
}

void Acquisition::run_commands() {
  while (commands_size_ > 0 && !ending_) {
    const Command command = commands_[commands_first_];
    commands_first_ = (commands_first_ + 1) % commands_.size();
    --commands_size_;
    if (command.begin != 0)
      start_sweep(command.begin, command.at);
    else if (ring_.growing())  // else its begin was refused
      ending_ = std::max(command.at, pressed_);
    if (ending_ && last_published_ > *ending_) finish_sweep();
  }
}

void Acquisition::start_sweep(std::int32_t id, Stamp pressed) {
  assert(!ring_.growing());
  sweep_id_ = id;
  Sweep sweep = ring_.begin_sweep(sweep_id_, pressed, settings_.pre_roll);
  if (!sweep) {
    ++ledger_.presses_refused;
    notify({Notice::Kind::refused, sweep_id_, pressed, {}});
    return;
  }
  pressed_ = pressed;
  full_told_ = false;
  sweep_ledger_ = {};
  at_start_ = ledger_;
  // Books what came between the press and the news of it.
  const auto swept = sweep.swept();
  const std::uint64_t remembered = std::min<std::uint64_t>(log_count_, log_.size());
  for (std::uint64_t n = log_count_ - remembered; n < log_count_; ++n) {
    Entry& entry = log_[n % log_.size()];
    entry.in_sweep = entry.outcome.captured >= pressed;
    if (!entry.in_sweep) continue;
    entry.for_sweep = entry.outcome;
    if (entry.outcome.kind == FrameOutcome::Kind::stored) {
      // The ring has forgotten it, or had no room for it.
      const bool forgotten =
          swept.empty() ? !sweep.start_complete() : entry.outcome.captured < swept.front().tracked.captured;
      const bool refused =
          !forgotten && (swept.empty() || entry.outcome.captured > swept.back().tracked.captured);
      if (forgotten || refused) {
        entry.for_sweep.kind = FrameOutcome::Kind::lost;
        entry.for_sweep.cause = forgotten ? LossCause::late : LossCause::ring_full;
      }
    }
    book(sweep_ledger_, entry.for_sweep);
  }
  notify({Notice::Kind::started, sweep_id_, pressed, std::move(sweep)});
}

void Acquisition::finish_sweep() {
  const Stamp released = *ending_;
  const std::uint64_t remembered = std::min<std::uint64_t>(log_count_, log_.size());
  for (std::uint64_t n = log_count_ - remembered; n < log_count_; ++n) {
    Entry& entry = log_[n % log_.size()];
    if (entry.in_sweep && entry.outcome.captured > released) unbook(sweep_ledger_, entry.for_sweep);
    entry.in_sweep = false;
  }
  sweep_ledger_.poses = ledger_.poses - at_start_.poses;
  sweep_ledger_.poses_refused = ledger_.poses_refused - at_start_.poses_refused;
  sweep_ledger_.poses_overrun = ledger_.poses_overrun - at_start_.poses_overrun;
  sweep_ledger_.pedal_overrun = ledger_.pedal_overrun - at_start_.pedal_overrun;
  ring_.end_sweep(released, sweep_ledger_);
  closed_ = {pressed_, released};
  ending_.reset();
  notify({Notice::Kind::ended, sweep_id_, released, {}});
  run_commands();
}

void Acquisition::account(const FrameOutcome& outcome, const FrameOutcome& for_sweep) {
  book(ledger_, outcome);
  const bool in_sweep = ring_.growing() && outcome.captured >= pressed_;
  if (in_sweep) book(sweep_ledger_, for_sweep);
  log_[log_count_ % log_.size()] = {outcome, for_sweep, in_sweep};
  ++log_count_;
}

void Acquisition::lose(LossCause cause, Stamp captured) {
  FrameOutcome outcome;
  outcome.kind = FrameOutcome::Kind::lost;
  outcome.cause = cause;
  outcome.captured = captured;
  account(outcome);
}

std::optional<Notice> Acquisition::take_notice() {
  if (notices_size_ == 0) return std::nullopt;
  Notice notice = std::move(notices_[notices_first_]);
  notices_first_ = (notices_first_ + 1) % notices_.size();
  --notices_size_;
  return notice;
}

void Acquisition::notify(Notice notice) {
  assert(notices_size_ < notices_.size());  // the owner takes them in every round
  if (notices_size_ == notices_.size()) return;
  notices_[(notices_first_ + notices_size_) % notices_.size()] = std::move(notice);
  ++notices_size_;
}

void Acquisition::count_overruns(std::uint64_t poses, std::uint64_t edges) {
  ledger_.poses_overrun += poses;
  ledger_.pedal_overrun += edges;
}

void Acquisition::stop(Stamp now) {
  publish_ready(now);
  while (const auto waiting = pairing_.pop_now(track_)) {
    ring_.discard(ring_.slot(waiting->ticket));
    lose(LossCause::stopped, waiting->captured);
  }
  while (ring_.growing()) {
    if (!ending_) ending_ = std::max(pressed_, pairing_.captured(last_stamped_.value_or(now)));
    finish_sweep();
  }
  last_slot_.reset();
}

AcquisitionStatus Acquisition::status(Stamp now) const {
  AcquisitionStatus s = status_;
  s.ledger = ledger_;
  s.frames_hz = frames_rate_.hz(now);
  s.unique_hz = unique_rate_.hz(now);
  s.poses_hz = poses_rate_.hz(now);
  s.waiting = pairing_.waiting();
  return s;
}

}  // namespace sonoband::cart
