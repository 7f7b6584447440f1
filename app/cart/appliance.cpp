#include "app/cart/appliance.h"

#include <array>
#include <cassert>
#include <utility>

#include "app/cart/thread_priority.h"

namespace sonoband::cart {
namespace {

bool delivers(DeviceState s) {
  return s == DeviceState::running || s == DeviceState::degraded;
}

std::optional<Duration> age(const std::optional<Stamp>& last, Stamp now) {
  if (!last) return std::nullopt;
  return now - *last;
}

}  // namespace

Appliance::Appliance(Devices devices, const ApplianceSettings& settings, MaskView mask,
                     std::unique_ptr<exam::CartExams> exams)
    : devices_(std::move(devices)),
      settings_(settings),
      ring_(settings.ring, mask),
      exams_(std::move(exams)),
      cart_(ring_, settings.cart) {
  assert(devices_.clock && devices_.tracker && devices_.frames && devices_.pedal);
  if (settings.lock_memory) locked_.emplace(ring_.memory());
}

Appliance::~Appliance() {
  stop();
}

const std::string& Appliance::memory_warning() const {
  static const std::string none;
  return locked_ ? locked_->warning() : none;
}

void Appliance::start() {
  assert(!started_);
  started_ = true;
  const BeforeOthers before(settings_.priority);
  priority_warning_ = before.warning();
  // The readers of poses and presses first, so that the first pictures find them there.
  tracker_thread_ = ClockThread(clock(), [this] { read_tracker(); });
  pedal_thread_ = ClockThread(clock(), [this] { read_pedal(); });
  capture_thread_ = ClockThread(clock(), [this] { capture(); });
}

void Appliance::stop() {
  if (!started_) return;
  // Capture last: it takes what the others still delivered, ends a recording and gives the last status.
  stop_devices_.store(true, std::memory_order_release);
  tracker_thread_.join();
  pedal_thread_.join();
  stop_capture_.store(true, std::memory_order_release);
  capture_thread_.join();
  if (exams_) exams_->finish();
}

void Appliance::read_tracker() {
  devices_.tracker->start();
  std::array<PoseSample, 64> readings;
  while (!stop_devices_.load(std::memory_order_acquire)) {
    std::size_t count = 0;
    const ReadStatus got = devices_.tracker->read(readings, count, settings_.device_wait);
    for (std::size_t i = 0; i < count; ++i) {
      if (!poses_.try_emplace(readings[i])) poses_overrun_.fetch_add(1, std::memory_order_relaxed);
    }
    if (got == ReadStatus::ended) {
      tracker_ended_.store(true, std::memory_order_relaxed);
      break;
    }
  }
  devices_.tracker->stop();
}

void Appliance::read_pedal() {
  devices_.pedal->start();
  bool was_there = false;
  const auto tell = [this](const PedalNews& news) {
    if (!pedal_news_.try_emplace(news)) pedal_overrun_.fetch_add(1, std::memory_order_relaxed);
  };
  while (!stop_devices_.load(std::memory_order_acquire)) {
    PedalEdge edge;
    const ReadStatus got = devices_.pedal->read(edge, settings_.device_wait);
    if (got == ReadStatus::ended) break;
    const bool there = delivers(devices_.pedal->health().state);
    if (was_there && !there) tell({{}, true});
    was_there = there;
    if (got == ReadStatus::ok) tell({edge, false});
  }
  devices_.pedal->stop();
}

void Appliance::capture() {
  devices_.frames->start();
  while (!stop_capture_.load(std::memory_order_acquire)) {
    Frame frame;
    ReadStatus got = ReadStatus::ended;
    if (frames_ended_)
      clock().sleep_until(clock().now() + settings_.capture_wait);
    else
      got = devices_.frames->read(frame, settings_.capture_wait);
    frames_ended_ = got == ReadStatus::ended;
    const Stamp now = clock().now();
    take_news(now);
    if (exams_) cart_.on_disk(exams_->has_room(), now);
    if (got == ReadStatus::ok) cart_.on_frame(frame, now);
    cart_.tick(now);
    hand_over();
    publish_status(now);
    beats_.fetch_add(1, std::memory_order_relaxed);
  }
  const Stamp now = clock().now();
  take_news(now);
  cart_.stop(now);
  devices_.frames->stop();
  next_status_.reset();
  hand_over();
  publish_status(now);
}

void Appliance::take_news(Stamp now) {
  while (const PoseSample* sample = poses_.front()) {
    if (exams_) exams_->on_reading(*sample);
    cart_.on_pose(*sample, now);
    poses_.pop();
  }
  while (const PedalNews* news = pedal_news_.front()) {
    if (news->lost) {
      cart_.on_pedal_lost(now);
    } else {
      last_edge_ = news->edge.time;
      cart_.on_edge(news->edge, now);
    }
    pedal_news_.pop();
  }
  while (const Command* command = commands_.front()) {
    cart_.on_command(*command, now);
    commands_.pop();
  }
  const std::uint64_t poses = poses_overrun_.load(std::memory_order_relaxed);
  const std::uint64_t edges = pedal_overrun_.load(std::memory_order_relaxed);
  cart_.count_overruns(poses - poses_overrun_told_, edges - pedal_overrun_told_);
  poses_overrun_told_ = poses;
  pedal_overrun_told_ = edges;
}

void Appliance::hand_over() {
  while (std::optional<Sweep> sweep = cart_.take_sweep()) {
    if (exams_) exams_->begin(*sweep);
    if (sweeps_.try_emplace(std::move(*sweep)))
      ++sweeps_handed_;
    else
      ++sweeps_refused_;
  }
  const bool grows = ring_.growing();
  if (exams_ && grew_ && !grows) exams_->ended();
  grew_ = grows;
}

void Appliance::publish_status(Stamp now) {
  const State state = cart_.state();
  const bool changed = state != told_;
  if (changed && devices_.on_recording && (state == State::recording || told_ == State::recording))
    devices_.on_recording(state == State::recording);
  told_ = state;
  if (!changed && next_status_ && now < *next_status_) return;
  next_status_ = now + settings_.status_every;

  ApplianceStatus s;
  s.at = now;
  s.cart = cart_.status(now);
  const AcquisitionStatus& a = s.cart.acquisition;
  s.tracker = {devices_.tracker->health(), a.poses_hz, age(a.last_reading, now),
               tracker_ended_.load(std::memory_order_relaxed)};
  s.frames = {devices_.frames->health(), a.frames_hz, age(a.last_frame, now), frames_ended_};
  s.pedal = {devices_.pedal->health(), 0, age(last_edge_, now), false};
  s.frozen = a.frames_hz > 0 && a.last_picture && now - *a.last_picture > std::chrono::seconds(1);
  s.sweeps_handed = sweeps_handed_;
  s.sweeps_refused = sweeps_refused_;
  statuses_.put(s);
  watched_.put(s);
}

const ApplianceStatus& Appliance::status() {
  if (const ApplianceStatus* newest = statuses_.take()) status_ = *newest;
  if (exams_) status_.saving = exams_->status();
  return status_;
}

std::optional<Sweep> Appliance::take_sweep() {
  Sweep* front = sweeps_.front();
  if (front == nullptr) return std::nullopt;
  Sweep sweep = std::move(*front);
  sweeps_.pop();
  return sweep;
}

}  // namespace sonoband::cart
