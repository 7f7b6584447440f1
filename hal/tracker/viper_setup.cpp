#include "hal/tracker/viper_setup.h"

#include <algorithm>
#include <cassert>

#include "hal/tracker/little_endian.h"

namespace sonoband {

using namespace viper;

namespace {

constexpr Duration answer_wait = std::chrono::milliseconds(500);
constexpr int max_tries = 3;
constexpr int max_rounds = 2;
constexpr std::uint8_t self_test_failed = 3;  // code of a NAK

using Payload = std::array<std::uint8_t, 16>;

Payload units_payload() {
  Payload p{};
  wire::store_u32(p.data(), static_cast<std::uint32_t>(PositionUnits::centimetre));
  wire::store_u32(p.data() + 4, static_cast<std::uint32_t>(AngleUnits::quaternion));
  return p;
}

std::uint32_t rate_code(RecordRate rate) {
  return rate == RecordRate::hz_240 ? 3 : 2;
}

Payload rate_payload(RecordRate rate) {
  Payload p{};
  wire::store_u32(p.data(), rate_code(rate));
  return p;
}

// Automatic following of the sensor off, then the direction.
Payload hemisphere_payload(const std::array<float, 3>& towards) {
  Payload p{};
  for (std::size_t i = 0; i < towards.size(); ++i) wire::store_f32(p.data() + 4 + 4 * i, towards[i]);
  return p;
}

// The four numbers of the LIBERTY's filter: 0,1,0,0 is off. That the VIPER takes the same four is an
// assumption from its manual, so a refusal is only noted.
Payload filter_off_payload() {
  Payload p{};
  wire::store_f32(p.data() + 4, 1);
  return p;
}

}  // namespace

void ViperSetup::begin(const LinkConfig& config, Stamp now) {
  *this = ViperSetup();
  config_ = config;
  deadline_ = now;
  begin_stage(SetupStage::identify);
}

void ViperSetup::add(const Exchange& e) {
  assert(count_ < exchanges_.size());
  exchanges_[count_++] = e;
}

void ViperSetup::set(Order order, std::span<const std::uint8_t> payload, std::uint32_t arg2) {
  add({.command = make_order(order, Action::set, all_sensors, arg2, payload), .order = order});
}

void ViperSetup::reset(Order order) {
  add({.command = make_order(order, Action::reset, all_sensors), .order = order, .may_be_refused = true});
}

void ViperSetup::ask(Order order, Exchange::Expect expect, std::uint32_t sensor) {
  add({.command = make_order(order, Action::get, sensor), .order = order, .expect = expect});
}

void ViperSetup::begin_stage(SetupStage stage) {
  using Expect = Exchange::Expect;
  stage_ = stage;
  count_ = at_ = 0;
  tries_ = 0;
  sent_ = false;
  answer_.reset();
  switch (stage) {
    case SetupStage::identify:
      ask(Order::identity, Expect::identity);
      break;
    case SetupStage::configure: {
      ++rounds_;
      const Payload units = units_payload();
      set(Order::units, std::span(units).first(8));
      const Payload rate = rate_payload(config_.rate);
      set(Order::frame_rate, std::span(rate).first(4));
      const Payload hemisphere = hemisphere_payload(config_.hemisphere);
      set(Order::hemisphere, hemisphere);
      const Payload off = filter_off_payload();
      for (const std::uint32_t of_position_then_attitude : {0U, 1U}) {
        set(Order::filter, off, of_position_then_attitude);
        exchanges_[count_ - 1].may_be_refused = true;
      }
      // Left by someone else these would turn or shift every calibration.
      reset(Order::boresight);
      reset(Order::tip_offset);
      reset(Order::source_rotation);
      reset(Order::increment);
      break;
    }
    case SetupStage::verify:
      ask(Order::units, Expect::units);
      ask(Order::frame_rate, Expect::rate);
      ask(Order::hemisphere, Expect::hemisphere, static_cast<std::uint32_t>(config_.probe_station - 1));
      ask(Order::station_map, Expect::stations);
      break;
  }
}

bool ViperSetup::judge(std::span<const std::uint8_t> payload) {
  using Expect = Exchange::Expect;
  switch (exchanges_[at_].expect) {
    case Expect::ack:
      return true;
    case Expect::identity: {
      // Its layout is not public; the readable part of it names the unit.
      identity_ = {};
      std::size_t n = 0;
      for (const std::uint8_t c : payload)
        if (c >= 0x20 && c < 0x7f && n + 1 < identity_.size()) identity_[n++] = static_cast<char>(c);
      return true;
    }
    case Expect::units: {
      const Payload wanted = units_payload();
      return payload.size() >= 8 && std::equal(wanted.begin(), wanted.begin() + 8, payload.begin());
    }
    case Expect::rate:
      return payload.size() >= 4 && wire::load_u32(payload.data()) == rate_code(config_.rate);
    case Expect::hemisphere: {
      if (payload.size() < 16 || wire::load_u32(payload.data()) != 0) return false;
      Eigen::Vector3f is;
      for (int i = 0; i < 3; ++i) is[i] = wire::load_f32(payload.data() + 4 + 4 * i);
      // The length means nothing; the unit may have made it 1.
      const Eigen::Vector3f wanted(config_.hemisphere.data());
      return is.allFinite() && (is.normalized() - wanted.normalized()).norm() < 1e-3F;
    }
    case Expect::stations:
      if (payload.size() < 4) return false;
      sensors_ = wire::load_u16(payload.data());
      return true;
  }
  return false;
}

void ViperSetup::take(const Frame& frame) {
  const auto reply = decode_reply(frame);
  if (!reply || !sent_ || at_ >= count_ || reply->order != exchanges_[at_].order || answer_) return;
  switch (reply->action) {
    case Action::ack:
      answer_ = judge(reply->payload) ? Answer::as_expected : Answer::otherwise;
      break;
    case Action::nak:
    case Action::nak_warning:
      last_error_ = reply->payload.empty() ? std::uint8_t{0} : reply->payload[0];
      if (reply->action == Action::nak && last_error_ == self_test_failed)
        answer_ = Answer::hardware;
      else if (reply->action == Action::nak && !exchanges_[at_].may_be_refused)
        answer_ = Answer::refused;
      else
        ++notices_, answer_ = Answer::as_expected;
      break;
    default:  // our own command, echoed
      break;
  }
}

SetupStatus ViperSetup::turn(Stamp now, WireCommand& write) {
  write = {};
  if (sent_) {
    if (answer_ == Answer::as_expected) {
      ++at_;
      tries_ = 0;
      sent_ = false;
      answer_.reset();
    } else if (answer_) {
      const Answer why = *answer_;
      if (why == Answer::hardware) return SetupStatus::hardware;
      if (stage_ == SetupStage::identify || rounds_ >= max_rounds)
        return why == Answer::refused ? SetupStatus::refused : SetupStatus::mismatch;
      begin_stage(SetupStage::configure);
    } else if (now < deadline_) {
      return SetupStatus::busy;
    } else if (tries_ >= max_tries) {
      return SetupStatus::no_answer;
    } else {
      sent_ = false;
    }
  }
  if (at_ >= count_) {
    if (stage_ == SetupStage::verify) return SetupStatus::done;
    begin_stage(stage_ == SetupStage::identify ? SetupStage::configure : SetupStage::verify);
  }
  write = exchanges_[at_].command;
  sent_ = true;
  ++tries_;
  answer_.reset();
  deadline_ = now + answer_wait;
  return SetupStatus::busy;
}

SetupProgress ViperSetup::progress() const {
  return {.stage = stage_,
          .wake = deadline_,
          .notices = notices_,
          .last_error = last_error_,
          .sensor_present = sensors_ != 0};
}

}  // namespace sonoband
