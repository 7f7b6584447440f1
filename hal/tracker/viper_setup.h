// From a quiet VIPER to a configured one: identify it, set everything the stream depends on, read back what
// matters. Every command is answered by ACK or NAK; pose frames may come in between.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/tracker/viper_protocol.h"

namespace sonoband {

class ViperSetup {
 public:
  void begin(const LinkConfig& config, Stamp now);
  // A frame that came since the last turn. Give all of them, then turn().
  void take(const viper::Frame& frame);
  SetupStatus turn(Stamp now, WireCommand& write);
  SetupProgress progress() const;

  const char* identity() const { return identity_.data(); }

 private:
  struct Exchange {
    WireCommand command;
    viper::Order order{};
    enum class Expect : std::uint8_t {
      ack,
      identity,
      units,
      rate,
      hemisphere,
      stations
    } expect = Expect::ack;
    bool may_be_refused = false;
  };

  void begin_stage(SetupStage stage);
  void set(viper::Order order, std::span<const std::uint8_t> payload, std::uint32_t arg2 = 0);
  void reset(viper::Order order);
  void ask(viper::Order order, Exchange::Expect expect, std::uint32_t sensor = 0);
  void add(const Exchange& e);
  bool judge(std::span<const std::uint8_t> payload);

  LinkConfig config_;
  SetupStage stage_ = SetupStage::identify;
  std::array<Exchange, 12> exchanges_{};
  std::size_t count_ = 0;
  std::size_t at_ = 0;
  int tries_ = 0;
  int rounds_ = 0;  // of configure and verify
  bool sent_ = false;
  Stamp deadline_{};

  enum class Answer : std::uint8_t { as_expected, otherwise, refused, hardware };
  std::optional<Answer> answer_;
  std::uint16_t sensors_ = 0;  // bit s: sensor s is detected
  std::uint32_t notices_ = 0;
  std::uint8_t last_error_ = 0;
  std::array<char, 64> identity_{};
};

}  // namespace sonoband
