// From a quiet LIBERTY or PATRIOT to a configured one: identify it, set everything the stream depends on,
// read it back.
//
// Nothing of what the unit was set to before is believed: settings survive whoever used it last, and a stored
// start-up set can hold any of them. A setting is answered by silence, so each is followed by a short look
// for an error frame, and what matters most is asked for afterwards.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/tracker/codec.h"
#include "hal/tracker/liberty_records.h"

namespace sonoband {

class Setup {
 public:
  using Status = SetupStatus;
  using Stage = SetupStage;

  void begin(const LinkConfig& config, Stamp now);
  // A frame that came since the last turn. Give all of them, then turn().
  void take(const liberty::Packet& packet);
  Status turn(Stamp now, WireCommand& write);
  Stamp wake() const { return deadline_; }
  Stage stage() const { return stage_; }

  const liberty::Identity& identity() const { return identity_; }  // of the unit that answered
  liberty::StationMap stations() const { return stations_; }
  std::uint32_t notices() const { return notices_; }
  std::uint8_t last_error() const { return last_error_; }

 private:
  // One command, and what comes back: an answer that `expect` judges, or silence.
  struct Exchange {
    WireCommand command;
    std::uint8_t reply = 0;  // command byte of the answer; 0: none comes
    Duration wait{};         // for the answer, or for an error
    enum class Expect : std::uint8_t {
      nothing,
      identity,
      one,
      list,
      rate,
      filter_off,
      hemisphere,
      stations,
    } expect = Expect::nothing;
    bool may_be_refused = false;
  };

  void begin_stage(Stage stage);
  void add(const Exchange& e);
  void set(const WireCommand& c, bool may_be_refused = false);
  void ask(const WireCommand& c, char reply, Exchange::Expect expect);
  void send(Stamp now, WireCommand& write);
  bool judge(const liberty::Packet& packet);  // of an answer: as expected?

  LinkConfig config_;
  Stage stage_ = Stage::identify;
  std::array<Exchange, 16> exchanges_{};
  std::size_t count_ = 0;
  std::size_t at_ = 0;
  int tries_ = 0;
  int rounds_ = 0;  // of configure and verify
  bool sent_ = false;
  Stamp deadline_{};

  std::optional<bool> answer_;  // to the exchange in progress: as expected or not
  std::optional<Status> failed_;
  liberty::Identity identity_;
  liberty::StationMap stations_;
  std::uint32_t notices_ = 0;
  std::uint8_t last_error_ = 0;
};

}  // namespace sonoband
