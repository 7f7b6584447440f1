#include "hal/tracker/link.h"

#include <algorithm>
#include <cassert>

namespace sonoband {

namespace {

constexpr Duration look_for_device = std::chrono::seconds(1);
constexpr Duration back_after_reset = std::chrono::seconds(5);  // later, it was taken away or switched off
constexpr Duration watch_every = std::chrono::milliseconds(10);

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
    streamed_ = false;
    gave_up_ = false;
    reason_ = LinkReason::none;
  }
  resetting_ = false;
  io_errors_in_a_row_ = 0;
  begin_quiesce(Quiesce::Purpose::connect, in.now);
}

void Link::send(const WireCommand& c) {
  sending_ = c;
  out_.write = sending_.bytes();
}

}  // namespace sonoband
