// The tracker's electronics unit without its plug: commands in, bytes out, at times of its own.
//
// Simulated: the command set that a driver needs, with settings, read-back and error frames; ASCII and binary
// output in any list; counters; the self-test after `^Y`, deaf and silent; stored start-up settings;
// hemispheres, alignment, boresight and tip offset; noise by distance; latency between a reading and its
// bytes; drift of the unit's clock. Not simulated: what the adaptive filters do to the poses (they can be set
// and read back), sync, compensation maps, `^X`, `^Z`, LATUS markers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/sim/liberty_command_line.h"
#include "hal/sim/liberty_settings.h"
#include "hal/sim/liberty_wire.h"
#include "hal/sim/tracker_unit.h"

namespace sonoband::sim {

enum class TrackerModel : std::uint8_t { liberty, patriot };

struct LibertyUnitConfig {
  TrackerModel model = TrackerModel::liberty;
  int sensors = 1;             // plugged in from station 1 on; the second and later ones are at rest
  LibertySettings start_up{};  // of the start-up slot
  double clock_drift_ppm = 0;
  double noise = 1;  // times the vendor's resolution
  Duration self_test = std::chrono::seconds(10);
  std::uint64_t seed = 1;
};

class LibertyUnit final : public TrackerUnit {
 public:
  LibertyUnit(const LibertyUnitConfig& config, ProbePose pose, Sink sink, Stamp now);

  void receive(std::span<const std::uint8_t> bytes, Stamp now) override;
  void advance(Stamp now) override;
  Stamp next_send(Stamp now) const override;
  bool buffering() const override { return settings_.buffering; }
  void inject(const Fault& fault) override;
  void power_cycle(Stamp now) override;
  void usb_reset() override {
    if (deaf_ == Deaf::until_reset) deaf_ = Deaf::no;
  }

  liberty::Tag tag() const;
  Duration period() const;   // nominal
  Duration latency() const;  // from a reading to its bytes

 private:
  struct Until {
    Stamp end{};
    double value = 0;
    bool at(Stamp t) const { return t < end; }
  };

  Stamp time_of(std::uint64_t tick) const;
  void restart_ticks(Stamp now);
  void send_frame(Stamp reading, Stamp sent, std::uint8_t command);
  void send_record(Stamp reading, Stamp sent, int station, std::uint8_t command);
  Rigid<frame::Tracker, frame::Probe> sensor_pose(int station, Stamp t) const;
  WireReading reading_of(int station, Stamp t);
  void damage_reading(WireReading& reading, int station, Stamp t) const;
  std::uint8_t letter_at(int station, Stamp t) const;
  void send_garbage(Stamp sent, std::size_t bytes);
  void send_flood(Stamp sent, std::size_t bytes);
  bool silent(Stamp t) const { return t < deaf_until_ || deaf_ != Deaf::no; }
  bool connected(int station, Stamp t) const;
  int stations() const { return liberty::stations_of(tag()); }
  double uniform();
  double gauss();

  void run_line(Stamp now);
  void execute(const CommandLine& c, Stamp now);
  void execute_for_station(const CommandLine& c, int station, Stamp now);
  void set_number(const CommandLine& c, int& setting, int least, int most);
  void set_switch(const CommandLine& c, bool& setting);
  void set_vector(const CommandLine& c, int station, LibertySettings::PerStation& setting, int most);
  void set_filter(const CommandLine& c, std::array<float, 4>& setting);
  void set_output_list(const CommandLine& c, int station);
  void set_stations(const CommandLine& c);
  void set_alignment(const CommandLine& c, int station);
  void set_boresight(const CommandLine& c, int station, Stamp now);
  void reply_i32(int station, std::uint8_t command, std::int32_t v);
  void reply_f32(int station, std::uint8_t command, std::span<const float> v);
  void reply_output_list(int station);
  void reply_stations();
  void reply_identity(int station);
  void begin_reply(int station, std::uint8_t command, std::uint8_t error = 0);
  void finish_reply(std::uint8_t command);
  void error(std::uint8_t code, std::uint8_t command);

  LibertyUnitConfig config_;
  ProbePose pose_;
  Sink sink_;
  LibertySettings settings_;
  std::array<LibertySettings, 4> stored_;  // 0: the factory's
  int start_up_slot_ = 0;

  Stamp ticks_began_{};
  std::uint64_t ticks_ = 0;  // frames since then
  std::uint32_t frame_ = 0;
  double time_ms_ = 0;
  Stamp deaf_until_{};
  Stamp now_{};
  std::uint64_t random_ = 0;

  std::array<char, 256> line_{};
  std::size_t line_size_ = 0;
  WireBytes reply_;

  enum class Deaf : std::uint8_t { no, until_reset, until_reinitialise } deaf_ = Deaf::no;
  int ignored_starts_ = 0;
  std::array<Stamp, liberty::max_stations> unplugged_until_{};
  Until wrong_list_, negated_, mirrored_, distortion_, letter_;
  std::array<Fault, 16> once_{};  // for the next record of their station
  std::size_t once_count_ = 0;
  int missing_ = 0;
};

}  // namespace sonoband::sim
