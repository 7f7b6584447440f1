#include "hal/tracker/polhemus_tracker.h"

#include <algorithm>

namespace sonoband {
namespace {

DeviceState device_state(const Link& link) {
  if (link.gave_up()) return DeviceState::fault;
  switch (link.state()) {
    case LinkState::absent:
    case LinkState::closing:
    case LinkState::closed:
      return DeviceState::absent;
    case LinkState::loader:
    case LinkState::access_denied:
    case LinkState::busy:
    case LinkState::stranger:
    case LinkState::fault:
      return DeviceState::fault;
    case LinkState::streaming:
      if (link.reason() == LinkReason::none) return DeviceState::running;
      return link.reason() == LinkReason::source_fault ? DeviceState::fault : DeviceState::degraded;
    default:
      return link.reason() == LinkReason::none || link.reason() == LinkReason::waking ? DeviceState::starting
                                                                                      : DeviceState::stalled;
  }
}

}  // namespace

PolhemusTracker::PolhemusTracker(BytePort& port, Clock& clock, const LinkConfig& config)
    : port_(port), clock_(clock), config_(config), link_(std::make_unique<Link>(config)) {}

PolhemusTracker::~PolhemusTracker() {
  PolhemusTracker::stop();
}

void PolhemusTracker::start() {
  if (started_) return;
  link_ = std::make_unique<Link>(config_, link_->next_epoch());
  port_state_ = PortState::absent;
  kept_count_ = kept_from_ = 0;
  next_ = {};
  next_.wake = clock_.now();
  health_.delivered = 0;
  started_ = true;
  publish();
}

ReadStatus PolhemusTracker::read(std::span<PoseSample> out, std::size_t& count, Duration timeout) {
  count = 0;
  if (!started_) return ReadStatus::ended;
  const Stamp until = clock_.now() + timeout;
  do {
    if (kept_from_ == kept_count_) take_turn(until);
    count = std::min(out.size(), kept_count_ - kept_from_);
    std::copy_n(kept_.begin() + static_cast<std::ptrdiff_t>(kept_from_), count, out.begin());
    kept_from_ += count;
  } while (count == 0 && clock_.now() < until);
  if (count == 0) return ReadStatus::nothing_yet;
  health_.delivered.fetch_add(count, std::memory_order_relaxed);
  return ReadStatus::ok;
}

// Does what the link asked for, waits for bytes as long as both allow, and gives the link its next turn.
void PolhemusTracker::take_turn(Stamp until) {
  LinkInput in;
  in.recording = recording_.load(std::memory_order_relaxed);

  switch (next_.action) {
    case LinkOutput::PortAction::none:
      break;
    case LinkOutput::PortAction::open:
      port_state_ = port_.open();
      break;
    case LinkOutput::PortAction::clear_halt:
      port_.clear_halt();
      break;
    case LinkOutput::PortAction::reset:
      port_.close(BytePort::Closing::reset);
      port_state_ = PortState::absent;
      break;
    case LinkOutput::PortAction::release:
      port_.close(BytePort::Closing::release);
      port_state_ = PortState::absent;
      break;
  }
  next_.action = LinkOutput::PortAction::none;

  if (port_state_ == PortState::open && !next_.write.empty()) {
    const Transfer wrote = port_.write(next_.write);
    in.transfer = wrote.status == TransferStatus::timed_out ? TransferStatus::io_error : wrote.status;
  }
  next_.write = {};

  const Stamp wake = std::min(until, next_.wake);
  const Duration patience = std::max(Duration(0), wake - clock_.now());
  if (port_state_ == PortState::open && next_.listen && in.transfer == TransferStatus::ok) {
    const Transfer got = port_.read(buffer_, patience);
    in.bytes = std::span(buffer_).first(got.count);
    if (got.status != TransferStatus::timed_out) in.transfer = got.status;
  } else if (port_state_ != PortState::open || !next_.listen) {
    if (patience > Duration(0)) clock_.sleep_until(wake);
  }
  in.now = clock_.now();
  if (in.transfer == TransferStatus::gone) port_state_ = PortState::gone;
  in.port = port_state_;
  if (port_state_ == PortState::open) in.family = port_.family();

  const Stamp asked = next_.wake;
  if (in.bytes.empty() && in.transfer == TransferStatus::ok && !next_.listen && in.now < asked) return;
  next_ = link_->turn(in);
  keep_readings();
  publish();
}

void PolhemusTracker::keep_readings() {
  kept_from_ = kept_count_ = 0;
  for (const Reading& r : link_->readings())
    if (r.station == config_.probe_station) kept_[kept_count_++] = r.pose;
}

void PolhemusTracker::publish() {
  health_.say(device_state(*link_), operator_sentence(link_->reason()));
  health_.lost.store(link_->counters().lost, std::memory_order_relaxed);
  health_.recoveries.store(link_->counters().recoveries, std::memory_order_relaxed);
}

DeviceHealth PolhemusTracker::health() const {
  return health_.read();
}

void PolhemusTracker::stop() {
  if (!started_) return;
  started_ = false;
  link_->leave();
  const Stamp until = clock_.now() + std::chrono::seconds(8);
  next_.wake = clock_.now();
  while (link_->state() != LinkState::closed && clock_.now() < until) take_turn(until);
  port_.close(BytePort::Closing::release);
  port_state_ = PortState::absent;
  publish();
}

}  // namespace sonoband
