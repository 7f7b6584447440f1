// LIBERTY and PATRIOT: commands of text, answers and records in binary frames without a checksum.
#pragma once

#include "hal/tracker/codec.h"
#include "hal/tracker/liberty_parser.h"
#include "hal/tracker/setup.h"

namespace sonoband {

class LibertyCodec final : public Codec {
 public:
  QuietWords quiet_words() const override;
  void forget_bytes() override { parser_.reset(); }
  const WireCounters& wire_counters() const override { return parser_.counters(); }

  void begin_setup(const LinkConfig& config, Stamp now) override;
  void hear_answers(std::span<const std::uint8_t> bytes, Stamp now) override;
  SetupStatus setup_turn(Stamp now, WireCommand& write) override { return setup_.turn(now, write); }
  SetupProgress setup_progress() const override;
  const char* identity() const override { return setup_.identity().text.data(); }

  Duration begin_stream(const LinkConfig& config) override;
  WireCommand start(bool reset_counters) const override;
  void hear_records(std::span<const std::uint8_t> bytes, Stamp now, Streaming& streaming,
                    LinkCounters& counters) override;

  WireCommand reinitialise() const override;

 private:
  void hear_record(const liberty::Packet& packet, Streaming& streaming, LinkCounters& counters);

  liberty::StreamParser parser_;
  Setup setup_;
};

}  // namespace sonoband
