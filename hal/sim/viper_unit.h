// A VIPER's electronics unit without its plug. Written from the protocol's description apart from
// hal/tracker's decoder, so that an error in one does not hide in the other.
//
// Simulated: framed commands with ACK and NAK, units, frame rate, hemisphere, filter as a value, station map,
// identity, continuous output with its count. Not simulated: acceleration frames, tip offset, source
// rotation, virtual sensors, what filters do.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hal/sim/liberty_wire.h"
#include "hal/sim/tracker_unit.h"

namespace sonoband::sim {

struct ViperUnitConfig {
  int sensors = 1;                // the second and later ones are at rest
  bool streams_at_start = false;  // left so by whoever used it last
  bool refuses_filter = false;
  double clock_drift_ppm = 0;
  double noise = 1;  // times the LIBERTY's resolution
  Duration self_test = std::chrono::seconds(5);
  std::uint64_t seed = 1;
};

class ViperUnit final : public TrackerUnit {
 public:
  ViperUnit(const ViperUnitConfig& config, ProbePose pose, Sink sink, Stamp now);

  void receive(std::span<const std::uint8_t> bytes, Stamp now) override;
  void advance(Stamp now) override;
  Stamp next_send(Stamp now) const override;
  bool buffering() const override { return true; }
  void inject(const Fault& fault) override;
  void power_cycle(Stamp now) override;
  void usb_reset() override;

 private:
  struct Settings {
    bool continuous = false;
    std::uint32_t position_units = 0;
    std::uint32_t angle_units = 0;
    std::uint32_t rate = 3;
    std::array<std::uint8_t, 16> hemisphere{};
  };

  Duration period() const;
  Stamp time_of(std::uint64_t tick) const;
  void execute(std::span<const std::uint8_t> body, Stamp now);
  void answer(std::uint32_t order, std::uint32_t action, std::span<const std::uint8_t> payload);
  void refuse(std::uint32_t order, std::uint32_t code);
  void send_poses(Stamp reading, Stamp sent);
  void put_sensor(WireBytes& out, int sensor, Stamp t);
  void send(const WireBytes& body, char kind, int record_station, Stamp t);
  bool has(FaultKind kind, Stamp t) const;
  bool once(FaultKind kind, double& value);
  double gauss();

  ViperUnitConfig config_;
  ProbePose pose_;
  Sink sink_;
  Settings settings_;
  std::vector<std::uint8_t> heard_;  // at most one frame's worth
  Stamp now_{};
  Stamp deaf_until_{};
  bool hung_ = false;
  Stamp began_{};
  std::uint64_t ticks_ = 0;
  std::uint32_t frame_ = 0;
  int missing_ = 0;
  int ignored_starts_ = 0;
  std::array<Fault, 32> faults_{};  // circular
  std::size_t fault_ = 0;
  std::uint64_t random_ = 0;
};

}  // namespace sonoband::sim
