// The conversation with a tracker as a machine that owns no port, no thread and no clock: each
// turn takes the time, what came in and how the port is, and gives what to send and what to do with the port.
// So every state and every watchdog is tested with made-up time.
//
//   absent -> loader                                       | the port opens
//   absent -> quiescing -> identifying -> configuring -> verifying -> starting -> streaming
//   any trouble -> a rung of the recovery ladder -> back into that row; see recovery_ladder.h
//
// Every way back to `streaming` begins a new epoch: the counters restarted, so no pose may be interpolated
// across.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "hal/tracker/liberty_codec.h"
#include "hal/tracker/link_types.h"
#include "hal/tracker/quiesce.h"
#include "hal/tracker/recovery_ladder.h"
#include "hal/tracker/streaming.h"
#include "hal/tracker/viper_codec.h"

namespace sonoband {

class Link {
 public:
  // Epoch ids count up from `first_epoch`; a link after another takes next_epoch() of the one before.
  explicit Link(const LinkConfig& config, std::uint32_t first_epoch = 1)
      : config_(config), streaming_(first_epoch) {}
  std::uint32_t next_epoch() const { return streaming_.next_epoch(); }

  LinkOutput turn(const LinkInput& in);

  // From now on only stop the unit and close: turn() until `closed`.
  void leave() { leaving_ = true; }

  // Of the last turn, oldest first for each station.
  std::span<const Reading> readings() const { return streaming_.readings(); }

  LinkState state() const { return state_; }
  // What is wrong, in any state; none if all is well or on the way.
  LinkReason reason() const { return reason_; }
  // Every cure was tried; it still tries, but the operator is needed.
  bool gave_up() const { return gave_up_; }
  const LinkCounters& counters() const { return counters_; }
  const char* identity() const { return codec_->identity(); }

 private:
  bool in_setup() const {
    return state_ == LinkState::identifying || state_ == LinkState::configuring ||
           state_ == LinkState::verifying;
  }
  void on_closed_port(const LinkInput& in);
  void on_opened(const LinkInput& in);
  bool on_transfer_trouble(const LinkInput& in);
  void on_stall(const LinkInput& in);
  void parse(const LinkInput& in);
  void run_state(const LinkInput& in);
  void run_starting(Stamp now);
  void run_streaming(const LinkInput& in);

  void begin_quiesce(Quiesce::Purpose purpose, Stamp now);
  void begin_start(int tries, Stamp now);
  void close_to_reset(Stamp now);
  void trouble(LinkReason why, const LinkInput& in);
  LinkReason for_the_operator(LinkReason why, Stamp now) const;
  void send(const WireCommand& c);

  LinkConfig config_;
  LinkState state_ = LinkState::absent;
  LinkReason reason_ = LinkReason::no_device;
  bool gave_up_ = false;  // until records come again
  bool leaving_ = false;
  bool streamed_ = false;   // since the device came
  bool opened_ = false;     // the port was open in the last turn
  bool resetting_ = false;  // we closed it ourselves, to open it again
  Stamp reset_at_{};
  Stamp next_open_{};

  LibertyCodec liberty_;
  ViperCodec viper_;
  Codec* codec_ = &liberty_;  // of the open port
  Quiesce quiesce_;
  Streaming streaming_;
  RecoveryLadder ladder_;
  LinkCounters counters_;

  Duration period_{};
  int start_tries_left_ = 0;
  Stamp waiting_since_{};
  Stamp deadline_{};  // of the state
  std::array<Stamp, 3> stalls_{};
  std::size_t stall_ = 0;
  int io_errors_in_a_row_ = 0;

  WireCommand sending_;
  LinkOutput out_;
};

}  // namespace sonoband
