// VIPER: framed commands that are answered, and pose frames with a checksum and a count.
#pragma once

#include "hal/tracker/codec.h"
#include "hal/tracker/viper_protocol.h"
#include "hal/tracker/viper_setup.h"

namespace sonoband {

class ViperCodec final : public Codec {
 public:
  QuietWords quiet_words() const override;
  void forget_bytes() override { parser_.reset(); }
  const WireCounters& wire_counters() const override { return parser_.counters(); }

  void begin_setup(const LinkConfig& config, Stamp now) override;
  void hear_answers(std::span<const std::uint8_t> bytes, Stamp now) override;
  SetupStatus setup_turn(Stamp now, WireCommand& write) override { return setup_.turn(now, write); }
  SetupProgress setup_progress() const override { return setup_.progress(); }
  const char* identity() const override { return setup_.identity(); }

  Duration begin_stream(const LinkConfig& config) override;
  WireCommand start(bool reset_counters) const override;
  void hear_records(std::span<const std::uint8_t> bytes, Stamp now, Streaming& streaming,
                    LinkCounters& counters) override;

  WireCommand reinitialise() const override;

 private:
  bool hear_poses(const viper::Frame& frame, Streaming& streaming, LinkCounters& counters);
  void hear_reply(const viper::Frame& frame, LinkCounters& counters);

  viper::Parser parser_;
  ViperSetup setup_;
  Duration patience_ = from_seconds(0.1);
};

}  // namespace sonoband
