#include "hal/tracker/liberty_commands.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstdio>

namespace sonoband::liberty {
namespace {

constexpr char carriage_return = 0x0d;

class Writer {
 public:
  Writer& put(char c) {
    assert(command_.size < command_.storage.size());
    command_.storage[command_.size++] = static_cast<std::uint8_t>(c);
    return *this;
  }
  Writer& caret(char letter) { return put(static_cast<char>(control(letter))); }
  Writer& text(const char* s) {
    for (; *s != 0; ++s) put(*s);
    return *this;
  }
  Writer& number(int n) {
    std::array<char, 16> digits{};
    std::snprintf(digits.data(), digits.size(), "%d", n);
    return text(digits.data());
  }
  // Seven digits bring any float back.
  Writer& number(float f) {
    assert(std::isfinite(f));
    std::array<char, 24> digits{};
    std::snprintf(digits.data(), digits.size(), "%.7g", static_cast<double>(f));
    return text(digits.data());
  }
  Writer& station(int s) {
    assert(s >= 0 && s <= max_stations);
    return s == all_stations ? put('*') : number(s);
  }
  Command line() { return put(carriage_return).command_; }
  Command bare() const { return command_; }

 private:
  Command command_;
};

}  // namespace

namespace command {

Command start_continuous() {
  return Writer().put('C').line();
}
Command poll() {
  return Writer().put('P').bare();
}
Command end_line() {
  return Writer().line();
}
Command binary(bool on) {
  return Writer().put('F').number(on ? 1 : 0).line();
}
Command centimetres(bool on) {
  return Writer().put('U').number(on ? 1 : 0).line();
}
Command output_list(int station, const OutputList& list) {
  Writer w;
  w.put('O').station(station);
  for (const std::uint8_t code : list.items()) w.put(',').number(static_cast<int>(code));
  return w.line();
}
Command rate(Rate r) {
  return Writer().put('R').number(static_cast<int>(r)).line();
}
Command hemisphere(int station, Vector3 towards) {
  return Writer()
      .put('H')
      .station(station)
      .put(',')
      .number(towards.x)
      .put(',')
      .number(towards.y)
      .put(',')
      .number(towards.z)
      .line();
}
Command position_filter_off() {
  return Writer().text("X0,1,0,0").line();
}
Command attitude_filter_off() {
  return Writer().text("Y0,1,0,0").line();
}
Command external_sync(bool on) {
  return Writer().put('Z').number(on ? 1 : 0).line();
}
Command clear_boresight(int station) {
  return Writer().caret('B').station(station).line();
}
Command clear_alignment(int station) {
  return Writer().caret('R').station(station).line();
}
Command clear_tip_offset(int station) {
  return Writer().put('N').station(station).text(",0,0,0").line();
}
Command clear_mounting_frame() {
  return Writer().text("G0,0,0").line();
}
Command reset_counters() {
  return Writer().text("Q0").line();
}
Command echo(bool on) {
  return Writer().caret('E').number(on ? 1 : 0).line();
}
Command usb_buffering(bool on) {
  return Writer().text("@B").number(on ? 1 : 0).line();
}
Command clear_self_test() {
  return Writer().caret('T').number(0).line();
}
Command reinitialise() {
  return Writer().caret('Y').line();
}
Command ask_binary() {
  return Writer().put('F').line();
}
Command ask_units() {
  return Writer().put('U').line();
}
Command ask_output_list(int station) {
  return Writer().put('O').station(station).line();
}
Command ask_rate() {
  return Writer().put('R').line();
}
Command ask_position_filter() {
  return Writer().put('X').line();
}
Command ask_attitude_filter() {
  return Writer().put('Y').line();
}
Command ask_usb_buffering() {
  return Writer().text("@B").line();
}
Command ask_hemisphere(int station) {
  return Writer().put('H').station(station).line();
}
Command ask_stations() {
  return Writer().caret('U').number(0).line();
}
Command ask_identity() {
  return Writer().caret('V').line();
}
Command ask_sensor_identity(int station) {
  return Writer().caret('V').station(station).line();
}
Command ask_self_test() {
  return Writer().caret('T').line();
}

}  // namespace command
}  // namespace sonoband::liberty
