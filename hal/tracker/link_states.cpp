// What the link does in each state of an open port.
#include <algorithm>

#include "hal/tracker/link.h"

namespace sonoband {

namespace {

constexpr Duration first_record = std::chrono::milliseconds(250);
constexpr int start_tries = 3;  // a unit may ignore the first one or two `C`
constexpr Duration start_again = std::chrono::seconds(2);
constexpr Duration ask_stations_again = std::chrono::seconds(5);

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

}  // namespace

void Link::parse(const LinkInput& in) {
  const bool streams = state_ == LinkState::starting || state_ == LinkState::streaming;
  if (!streams && !in_setup()) return;
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
      if (in.now >= deadline_) close_to_reset(in.now);
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
    streamed_ = true;
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

}  // namespace sonoband
