#include "hal/tracker/setup.h"

#include <cassert>
#include <cmath>

#include "hal/tracker/liberty_commands.h"

namespace sonoband {

using namespace liberty;

namespace {

constexpr Duration error_look = std::chrono::milliseconds(30);
constexpr Duration format_look =
    std::chrono::milliseconds(50);  // after F1, which others are still in ASCII for
constexpr Duration answer_wait = std::chrono::milliseconds(500);
constexpr int max_tries = 3;
constexpr int max_rounds = 2;

Rate rate_of(const LinkConfig& config) {
  return config.rate == RecordRate::hz_240 ? Rate::hz_240 : Rate::hz_120;
}

}  // namespace

void Setup::begin(const LinkConfig& config, Stamp now) {
  *this = Setup();
  config_ = config;
  deadline_ = now;
  begin_stage(Stage::identify);
}

void Setup::add(const Exchange& e) {
  assert(count_ < exchanges_.size());
  exchanges_[count_++] = e;
}

void Setup::set(const Command& c, bool may_be_refused) {
  add({.command = c, .wait = error_look, .may_be_refused = may_be_refused});
}

void Setup::ask(const Command& c, char reply, Exchange::Expect expect) {
  add({.command = c, .reply = static_cast<std::uint8_t>(reply), .wait = answer_wait, .expect = expect});
}

void Setup::begin_stage(Stage stage) {
  using Expect = Exchange::Expect;
  stage_ = stage;
  count_ = at_ = 0;
  tries_ = 0;
  sent_ = false;
  const bool has_rates = identity_.tag != Tag::patriot;
  switch (stage) {
    case Stage::identify:
      add({.command = command::binary(true), .wait = format_look, .may_be_refused = true});
      ask(command::ask_identity(), static_cast<char>(control('V')), Expect::identity);
      break;
    case Stage::configure:
      ++rounds_;
      set(command::echo(false), true);
      set(command::centimetres(true));
      set(command::output_list(all_stations, tracking_list));
      set(command::position_filter_off());
      set(command::attitude_filter_off());
      if (has_rates) set(command::rate(rate_of(config_)));
      set(command::usb_buffering(false), true);
      set(command::hemisphere(all_stations,
                              {config_.hemisphere[0], config_.hemisphere[1], config_.hemisphere[2]}));
      // Left by someone else these would turn or shift every calibration.
      set(command::clear_boresight(all_stations));
      set(command::clear_alignment(all_stations));
      set(command::clear_tip_offset(all_stations));
      if (has_rates) set(command::clear_mounting_frame());
      break;
    case Stage::verify:
      ask(command::ask_binary(), 'F', Expect::one);
      ask(command::ask_units(), 'U', Expect::one);
      ask(command::ask_output_list(config_.probe_station), 'O', Expect::list);
      ask(command::ask_hemisphere(config_.probe_station), 'H', Expect::hemisphere);
      ask(command::ask_position_filter(), 'X', Expect::filter_off);
      ask(command::ask_attitude_filter(), 'Y', Expect::filter_off);
      if (has_rates) ask(command::ask_rate(), 'R', Expect::rate);
      ask(command::ask_stations(), static_cast<char>(control('U')), Expect::stations);
      break;
  }
}

bool Setup::judge(const Packet& packet) {
  switch (exchanges_[at_].expect) {
    case Exchange::Expect::nothing:
      return true;
    case Exchange::Expect::identity: {
      const auto identity = decode_identity(packet);
      if (identity) identity_ = *identity;
      return identity.has_value();
    }
    case Exchange::Expect::one:
      return decode_number(packet) == 1;
    case Exchange::Expect::list:
      return decode_output_list(packet) == tracking_list;
    case Exchange::Expect::rate:
      return decode_number(packet) == static_cast<std::int32_t>(rate_of(config_));
    case Exchange::Expect::filter_off: {
      const auto f = decode_filter(packet);
      return f && (*f)[0] == 0 && (*f)[1] == 1;
    }
    case Exchange::Expect::hemisphere: {
      const auto v = decode_vector(packet);
      if (!v) return false;
      const Eigen::Vector3f set(config_.hemisphere.data());
      // The length means nothing; the unit may have made it 1.
      return (Eigen::Vector3f(v->data()).normalized() - set.normalized()).norm() < 1e-3F;
    }
    case Exchange::Expect::stations: {
      const auto map = decode_stations(packet);
      if (map) stations_ = *map;
      return map.has_value();
    }
  }
  return false;
}

void Setup::take(const Packet& packet) {
  if (!sent_ || at_ >= count_) return;
  const Exchange& now = exchanges_[at_];
  const ErrorKind error = classify(packet.error);
  if (packet.command != stream_command && error != ErrorKind::none) {
    last_error_ = packet.error;
    if (error == ErrorKind::hardware)
      failed_ = Status::hardware;
    else if (error == ErrorKind::configuration && !now.may_be_refused && stage_ != Stage::identify)
      failed_ = Status::refused;
    else
      ++notices_;
    return;
  }
  // An echo looks like an answer but comes to a setting, where none is waited for.
  if (now.reply != 0 && packet.command == now.reply && !answer_) answer_ = judge(packet);
}

void Setup::send(Stamp now, Command& write) {
  write = exchanges_[at_].command;
  sent_ = true;
  ++tries_;
  answer_.reset();
  deadline_ = now + exchanges_[at_].wait;
}

Setup::Status Setup::turn(Stamp now, Command& write) {
  write = {};
  if (failed_) {
    if (*failed_ == Status::hardware || rounds_ >= max_rounds) return *failed_;
    failed_.reset();
    begin_stage(Stage::configure);
  }
  if (sent_) {
    const bool silent_is_fine = exchanges_[at_].reply == 0;
    if (answer_ && !*answer_) {
      if (stage_ == Stage::identify || rounds_ >= max_rounds) return Status::mismatch;
      begin_stage(Stage::configure);
    } else if (answer_ || (silent_is_fine && now >= deadline_)) {
      ++at_;
      tries_ = 0;
      sent_ = false;
    } else if (now < deadline_) {
      return Status::busy;
    } else if (tries_ >= max_tries) {
      return Status::no_answer;
    } else {
      sent_ = false;
    }
  }
  if (at_ >= count_) {
    if (stage_ == Stage::verify) return Status::done;
    begin_stage(stage_ == Stage::identify ? Stage::configure : Stage::verify);
  }
  send(now, write);
  return Status::busy;
}

}  // namespace sonoband
