#include "ui/panels/lamps.h"

#include <algorithm>
#include <cmath>

namespace sonoband::ui {
namespace {

constexpr double disk_low_minutes = 30;
constexpr double disk_full_minutes = 1;
constexpr double ring_low_s = 10;
constexpr double late_ms = 150;  // a hand notices the picture lagging from about here

Colour colour_of(Health h) {
  switch (h) {
    case Health::good:
      return colour::good;
    case Health::starting:
    case Health::degraded:
      return colour::warning;
    case Health::silent:
    case Health::absent:
    case Health::fault:
      break;
  }
  return colour::alarm;
}

std::string_view word_for(Health h, const Texts& t) {
  switch (h) {
    case Health::good:
      return {};
    case Health::starting:
      return t.starting;
    case Health::degraded:
      return t.degraded;
    case Health::silent:
      return t.silent;
    case Health::absent:
      return t.absent;
    case Health::fault:
      break;
  }
  return t.fault;
}

bool delivers(Health h) {
  return h == Health::good || h == Health::degraded;
}

}  // namespace

Lamp scanner_lamp(const ScannerStatus& s, const Texts& t) {
  if (!delivers(s.health)) return {colour_of(s.health), Line(word_for(s.health, t), {})};
  if (s.frozen) return {colour::warning, Line(t.frozen, {})};
  const bool late = s.age_ms > late_ms || s.health == Health::degraded;
  return {late ? colour::warning : colour::good,
          Line(t.scanner_rate, {number(s.frames_per_s, 1), number(s.age_ms, 0)})};
}

Lamp tracker_lamp(const TrackerStatus& s, const Texts& t) {
  if (!delivers(s.health)) return {colour_of(s.health), Line(word_for(s.health, t), {})};
  switch (s.quality) {
    case PoseQuality::good:
      return {colour_of(s.health), Line(t.tracker_rate, {number(s.rate_hz, 0), t.clean})};
    case PoseQuality::degraded:
      return {colour::warning, Line(t.tracker_rate, {number(s.rate_hz, 0), t.some_distortion})};
    case PoseQuality::distorted:
      return {colour::alarm, Line(t.distorted, {})};
    case PoseQuality::outside:
      return {colour::alarm, Line(t.out_of_range, {})};
    case PoseQuality::fault:
      return {colour::alarm, Line(t.fault, {})};
    case PoseQuality::missing:
      break;
  }
  return {colour::alarm, Line(t.silent, {})};
}

Lamp pedal_lamp(const PedalStatus& s, const Texts& t) {
  if (!delivers(s.health)) {
    // Recording works without it, from the screen and the keyboard.
    return {s.health == Health::fault ? colour::alarm : colour::warning, Line(word_for(s.health, t), {})};
  }
  if (s.down) return {colour::good, Line(t.pressed, {})};
  return {colour_of(s.health), Line(s.mode == PedalMode::hold ? t.hold_to_record : t.press_to_record, {})};
}

// A mouse does everything as well: never an alarm.
Lamp touchscreen_lamp(const TouchscreenStatus& s, const Texts& t) {
  if (delivers(s.health)) return {colour_of(s.health), Line(t.works, {})};
  return {colour::warning, Line(word_for(s.health, t), {})};
}

Lamp storage_lamp(const StorageStatus& s, const Texts& t) {
  if (!delivers(s.health)) return {colour_of(s.health), Line(word_for(s.health, t), {})};
  if (s.minutes_left < disk_full_minutes) return {colour::alarm, Line(t.full, {})};
  return {s.minutes_left < disk_low_minutes ? colour::warning : colour::good,
          Line(t.minutes_left, {number(std::floor(s.minutes_left), 0)})};
}

Lamp ring_lamp(const RingStatus& s, const Texts& t) {
  if (s.seconds_free <= 0) return {colour::alarm, Line(t.full, {})};
  return {s.seconds_free < ring_low_s ? colour::warning : colour::good,
          Line(t.seconds_free, {number(std::floor(s.seconds_free), 0)})};
}

Lamp loss_lamp(const LossStatus& s, const Texts& t) {
  // One in a thousand leaves a gap nobody sees; one in fifty leaves holes in a band.
  Colour c = colour::good;
  if (s.lost > 0) c = s.lost * 50 > s.of ? colour::alarm : colour::warning;
  if (s.lost == 0) return {c, Line(t.none_lost, {})};
  return {c, Line(t.lost_of, {count(s.lost), count(s.of)})};
}

Lamp stream_lamp(const StreamStatus& s, const Texts& t) {
  return {
      s.beyond_this_machine ? colour::warning : colour::good,
      Line(s.beyond_this_machine ? t.stream_network : t.stream_here, {number(s.port, 0), count(s.programs)})};
}

Fault worst_fault(const View& view, const Texts& t) {
  const StatusView& s = view.status;
  const auto cure = [](std::string_view reason, std::string_view otherwise) {
    return Line(reason.empty() ? otherwise : reason, {});
  };
  if (s.storage.minutes_left < disk_full_minutes || s.storage.health == Health::fault) {
    return {colour::alarm, t.disk_full, cure(s.storage.reason, t.disk_full_cure)};
  }
  if (s.scanner.health == Health::absent || s.scanner.health == Health::fault) {
    return {colour::alarm, t.no_scanner, cure(s.scanner.reason, t.no_scanner_cure)};
  }
  if (s.scanner.health == Health::silent) {
    return {colour::alarm, t.scanner_silent, cure(s.scanner.reason, t.scanner_silent_cure)};
  }
  if (s.tracker.health == Health::absent || s.tracker.health == Health::fault ||
      s.tracker.health == Health::silent) {
    return {colour::alarm, t.no_tracker, cure(s.tracker.reason, t.no_tracker_cure)};
  }
  if (s.ring.seconds_free <= 0 && s.ring.seconds_in_all > 0) {
    return {colour::alarm, t.ring_full, Line(t.ring_full_cure, {})};
  }
  if (s.tracker.health != Health::starting) {
    if (s.tracker.quality == PoseQuality::distorted) {
      return {colour::alarm, t.tracker_distorted, cure(s.tracker.reason, t.tracker_distorted_cure)};
    }
    if (s.tracker.quality == PoseQuality::outside) {
      return {colour::alarm, t.tracker_outside, cure(s.tracker.reason, t.tracker_outside_cure)};
    }
  }
  if (s.scanner.frozen)
    return {colour::warning, t.scanner_frozen, cure(s.scanner.reason, t.scanner_frozen_cure)};
  if (!view.review.calibrated) return {colour::warning, t.no_calibration, Line(t.no_calibration_cure, {})};
  if (s.storage.minutes_left < disk_low_minutes) {
    return {colour::warning, t.disk_low,
            Line(t.disk_low_cure, {number(std::floor(s.storage.minutes_left), 0)})};
  }
  if (s.pedal.health == Health::absent || s.pedal.health == Health::fault) {
    return {colour::warning, t.no_pedal, cure(s.pedal.reason, t.no_pedal_cure)};
  }
  return {};
}

}  // namespace sonoband::ui
