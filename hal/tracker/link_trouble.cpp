// What the link does about trouble: of a transfer, or that a state found.
#include "hal/tracker/link.h"

namespace sonoband {

namespace {

constexpr Duration after_reset = std::chrono::milliseconds(500);
constexpr Duration self_test = std::chrono::seconds(10);
constexpr Duration fault_pause = std::chrono::seconds(10);
constexpr Duration stall_window = std::chrono::seconds(10);
constexpr int max_io_errors = 3;

}  // namespace

// True if this turn is over.
bool Link::on_transfer_trouble(const LinkInput& in) {
  if (in.transfer != TransferStatus::io_error) io_errors_in_a_row_ = 0;
  if (in.transfer == TransferStatus::stalled) {
    on_stall(in);
    return true;
  }
  if (in.transfer == TransferStatus::io_error) {
    ++counters_.io_errors;
    if (++io_errors_in_a_row_ >= max_io_errors) {
      io_errors_in_a_row_ = 0;
      trouble(LinkReason::io_error, in);
      return true;
    }
    // A setting that may not have arrived is as good as lost: silence would look like success.
    if (state_ == LinkState::quiescing || in_setup()) begin_quiesce(Quiesce::Purpose::connect, in.now);
  }
  return false;
}

void Link::on_stall(const LinkInput& in) {
  ++counters_.stalls;
  codec_->forget_bytes();
  stalls_[stall_] = in.now;
  stall_ = (stall_ + 1) % stalls_.size();
  const bool third = counters_.stalls >= stalls_.size() && in.now - stalls_[stall_] < stall_window;
  if (state_ == LinkState::closing) {
    state_ = LinkState::closed;
    out_.action = LinkOutput::PortAction::release;
    return;
  }
  if (third) {
    stalls_.fill(in.now - 2 * stall_window);
    trouble(LinkReason::stalled, in);
  } else if (state_ == LinkState::streaming || state_ == LinkState::starting) {
    ++counters_.recoveries;
    streaming_.mark_all_missing(in.now);
    streaming_.begin(config_, period_, in.now);
  } else {
    begin_quiesce(Quiesce::Purpose::connect, in.now);
  }
  if (out_.action == LinkOutput::PortAction::none) out_.action = LinkOutput::PortAction::clear_halt;
}

void Link::close_to_reset(Stamp now) {
  out_.action = LinkOutput::PortAction::reset;
  out_.listen = false;
  out_.wake = now + after_reset;
  state_ = LinkState::reopening;
  resetting_ = true;
  reset_at_ = now;
  next_open_ = now + after_reset;
}

// While cures are being tried: nobody should switch off what tests itself, or is being started again.
LinkReason Link::for_the_operator(LinkReason why, Stamp now) const {
  if (why == LinkReason::no_answer && ladder_.young(now)) return LinkReason::waking;
  if (why == LinkReason::no_records && streamed_) return LinkReason::silent;
  return why;
}

void Link::trouble(LinkReason why, const LinkInput& in) {
  ++counters_.recoveries;
  reason_ = for_the_operator(why, in.now);
  streaming_.mark_all_missing(in.now);
  codec_->forget_bytes();
  switch (ladder_.next(why, in.now, in.recording)) {
    case Rung::none:
    case Rung::restart:
      begin_start(1, in.now);
      break;
    case Rung::reconfigure:
      begin_quiesce(Quiesce::Purpose::connect, in.now);
      break;
    case Rung::reset_port:
      close_to_reset(in.now);
      break;
    case Rung::reinitialise:
      send(codec_->reinitialise());
      reason_ = LinkReason::reinitialising;
      ladder_.restarted(in.now);
      state_ = LinkState::reinitialising;
      deadline_ = in.now + self_test;
      out_.listen = false;
      out_.wake = deadline_;
      break;
    case Rung::give_up:
      gave_up_ = true;
      reason_ = why;
      state_ = LinkState::fault;
      deadline_ = in.now + fault_pause;
      out_.listen = false;
      out_.wake = deadline_;
      break;
  }
}

}  // namespace sonoband
