#include "hal/tracker/link.h"

#include <algorithm>
#include <cassert>

namespace sonoband {

namespace {

constexpr Duration look_for_device = std::chrono::seconds(1);
constexpr Duration after_reset = std::chrono::milliseconds(500);
constexpr Duration back_after_reset = std::chrono::seconds(5);  // later, it was taken away or switched off
constexpr Duration first_record = std::chrono::milliseconds(250);
constexpr int start_tries = 3;  // a unit may ignore the first one or two `C`
constexpr Duration start_again = std::chrono::seconds(2);
constexpr Duration ask_stations_again = std::chrono::seconds(5);
constexpr Duration self_test = std::chrono::seconds(10);
constexpr Duration fault_pause = std::chrono::seconds(10);
constexpr Duration stall_window = std::chrono::seconds(10);
constexpr int max_io_errors = 3;
constexpr Duration watch_every = std::chrono::milliseconds(10);

LinkReason reason_of(SetupStatus status) {
  switch (status) {
    case SetupStatus::refused:
      return LinkReason::refused;
    case SetupStatus::mismatch:
      return LinkReason::mismatch;
    case SetupStatus::hardware:
      return LinkReason::hardware;
    default:
      return LinkReason::no_answer;
  }
}

LinkState state_of(SetupStage stage) {
  switch (stage) {
    case SetupStage::identify:
      return LinkState::identifying;
    case SetupStage::configure:
      return LinkState::configuring;
    case SetupStage::verify:
      return LinkState::verifying;
  }
  return LinkState::identifying;
}

bool in_setup(LinkState s) {
  return s == LinkState::identifying || s == LinkState::configuring || s == LinkState::verifying;
}

}  // namespace

LinkOutput Link::turn(const LinkInput& in) {
  assert(in.bytes.size() <= LinkOutput::max_read);
  out_ = {};
  out_.wake = in.now + watch_every;
  sending_ = {};
  streaming_.clear_readings();

  if (in.port != PortState::open) {
    on_closed_port(in);
    return out_;
  }
  if (!opened_) on_opened(in);
  if (leaving_ && state_ != LinkState::closing && state_ != LinkState::closed)
    begin_quiesce(Quiesce::Purpose::leave, in.now);

  if (on_transfer_trouble(in)) return out_;
  parse(in);
  run_state(in);
  return out_;
}

void Link::on_closed_port(const LinkInput& in) {
  if (opened_) {
    opened_ = false;
    streaming_.mark_all_missing(in.now);
    codec_->forget_bytes();
    if (!resetting_) {
      out_.action = LinkOutput::PortAction::release;
      next_open_ = in.now;
    }
  }
  if (leaving_) {
    state_ = LinkState::closed;
    return;
  }
  if (in.port == PortState::loader || in.now - reset_at_ > back_after_reset) resetting_ = false;
  if (!resetting_) {
    switch (in.port) {
      case PortState::loader:
        state_ = LinkState::loader;
        reason_ = LinkReason::loader;
        break;
      case PortState::access_denied:
        state_ = LinkState::access_denied;
        reason_ = LinkReason::access_denied;
        break;
      case PortState::busy:
        state_ = LinkState::busy;
        reason_ = LinkReason::busy;
        break;
      case PortState::stranger:
        state_ = LinkState::stranger;
        reason_ = LinkReason::stranger;
        break;
      default:
        state_ = LinkState::absent;
        reason_ = LinkReason::no_device;
        break;
    }
  }
  if (out_.action == LinkOutput::PortAction::none && in.now >= next_open_) {
    out_.action = LinkOutput::PortAction::open;
    out_.wake = in.now;
    next_open_ = in.now + look_for_device;
    return;
  }
  out_.wake = std::max(next_open_, in.now);
}

void Link::on_opened(const LinkInput& in) {
  codec_ = in.family == TrackerFamily::viper ? static_cast<Codec*>(&viper_) : &liberty_;
  opened_ = true;
  if (!resetting_) {
    ladder_.came(in.now);
    gave_up_ = false;
    reason_ = LinkReason::none;
  }
  resetting_ = false;
  io_errors_in_a_row_ = 0;
  begin_quiesce(Quiesce::Purpose::connect, in.now);
}

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
    if (state_ == LinkState::quiescing || in_setup(state_)) begin_quiesce(Quiesce::Purpose::connect, in.now);
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

void Link::parse(const LinkInput& in) {
  const bool streams = state_ == LinkState::starting || state_ == LinkState::streaming;
  if (!streams && !in_setup(state_)) return;
  if (streams) {
    codec_->hear_records(in.bytes, in.now, streaming_, counters_);
  } else {
    const std::uint32_t notices = codec_->setup_progress().notices;
    codec_->hear_answers(in.bytes, in.now);
    counters_.notices += codec_->setup_progress().notices - notices;
  }
  const WireCounters& wire = codec_->wire_counters();
  counters_.resync_events = wire.resync_events;
  counters_.resync_bytes = wire.resync_bytes;
  counters_.truncated = wire.truncated;
}

void Link::run_state(const LinkInput& in) {
  WireCommand command;
  out_.listen = true;
  switch (state_) {
    case LinkState::quiescing:
      switch (quiesce_.turn(in.now, in.bytes.size(), command)) {
        case Quiesce::Status::busy:
          break;
        case Quiesce::Status::quiet:
          codec_->begin_setup(config_, in.now);
          state_ = LinkState::identifying;
          run_state({.now = in.now, .port = in.port, .recording = in.recording});
          return;
        case Quiesce::Status::no_quiet:
          trouble(LinkReason::no_quiet, in);
          return;
      }
      send(command);
      out_.wake = quiesce_.wake();
      return;

    case LinkState::identifying:
    case LinkState::configuring:
    case LinkState::verifying: {
      const SetupStatus status = codec_->setup_turn(in.now, command);
      const SetupProgress progress = codec_->setup_progress();
      if (progress.last_error != 0) counters_.last_error = progress.last_error;
      state_ = state_of(progress.stage);
      if (status == SetupStatus::busy) {
        send(command);
        out_.wake = progress.wake;
      } else if (status == SetupStatus::done) {
        begin_start(start_tries, in.now);
      } else {
        trouble(reason_of(status), in);
      }
      return;
    }

    case LinkState::starting:
      run_starting(in.now);
      if (state_ == LinkState::starting && in.now >= deadline_ && start_tries_left_ == 0)
        trouble(LinkReason::no_records, in);
      return;

    case LinkState::streaming:
      run_streaming(in);
      return;

    case LinkState::reinitialising:
      out_.listen = false;
      out_.wake = deadline_;
      if (in.now >= deadline_) begin_quiesce(Quiesce::Purpose::connect, in.now);
      return;

    case LinkState::fault:
      out_.listen = false;
      out_.wake = deadline_;
      if (in.now >= deadline_) close_to_reset(after_reset, in.now);
      return;

    case LinkState::closing:
      if (quiesce_.turn(in.now, in.bytes.size(), command) == Quiesce::Status::busy) {
        send(command);
        out_.wake = quiesce_.wake();
        return;
      }
      state_ = LinkState::closed;
      out_.action = LinkOutput::PortAction::release;
      return;

    default:
      return;
  }
}

void Link::run_starting(Stamp now) {
  if (streaming_.heard()) {
    state_ = LinkState::streaming;
    return;
  }
  if (now < deadline_) return;
  if (!codec_->setup_progress().sensor_present) {
    // The unit answered and there is nothing to hear: it finds a sensor by itself once it is plugged in.
    reason_ = LinkReason::probe_silent;
    if (now - waiting_since_ >= ask_stations_again) {
      begin_quiesce(Quiesce::Purpose::connect, now);
      return;
    }
    deadline_ = now + start_again;
    send(codec_->start(false));
    return;
  }
  if (start_tries_left_ > 0) {
    --start_tries_left_;
    deadline_ = now + first_record;
    send(codec_->start(false));
  }
}

void Link::run_streaming(const LinkInput& in) {
  const LinkReason verdict = streaming_.watch(in.now, codec_->wire_counters().resync_bytes);
  if (verdict != LinkReason::none) {
    trouble(verdict, in);
    return;
  }
  if (streaming_.heard()) {
    ladder_.healthy(in.now);
    gave_up_ = false;
    reason_ = streaming_.complaint(in.now);
  }
}

void Link::begin_quiesce(Quiesce::Purpose purpose, Stamp now) {
  state_ = purpose == Quiesce::Purpose::leave ? LinkState::closing : LinkState::quiescing;
  quiesce_.begin(purpose, codec_->quiet_words(), now);
  out_.listen = true;
  out_.wake = now;
}

void Link::begin_start(int tries, Stamp now) {
  period_ = codec_->begin_stream(config_);
  streaming_.begin(config_, period_, now);
  state_ = LinkState::starting;
  start_tries_left_ = tries - 1;
  deadline_ = now + first_record;
  waiting_since_ = now;
  send(codec_->start(true));
}

void Link::close_to_reset(Duration pause, Stamp now) {
  out_.action = LinkOutput::PortAction::reset;
  out_.listen = false;
  out_.wake = now + pause;
  state_ = LinkState::reopening;
  resetting_ = true;
  reset_at_ = now;
  next_open_ = now + pause;
}

void Link::trouble(LinkReason why, const LinkInput& in) {
  ++counters_.recoveries;
  reason_ = why;
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
      close_to_reset(after_reset, in.now);
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
      state_ = LinkState::fault;
      deadline_ = in.now + fault_pause;
      out_.listen = false;
      out_.wake = deadline_;
      break;
  }
}

void Link::send(const WireCommand& c) {
  sending_ = c;
  out_.write = sending_.bytes();
}

}  // namespace sonoband
