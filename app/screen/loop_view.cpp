// What the cart and the session have to say, as the view of a frame.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "app/screen/loop.h"

namespace sonoband {
namespace {

constexpr Duration disk_every = std::chrono::seconds(5);

std::uintmax_t bytes_on_disk(const std::filesystem::path& folder) {
  std::error_code error;
  const bool there = std::filesystem::exists(folder, error);
  const auto space = std::filesystem::space(there ? folder : std::filesystem::current_path(error), error);
  return error ? 0 : space.available;
}

}  // namespace

void ScreenLoop::measure_speed(const TrackedFrame& frame) {
  if (frame.pose_status != PoseStatus::ok) return;
  const Eigen::Vector3d centre(0.5 * frame.bscan.pixels.width, 0.5 * frame.bscan.pixels.height, 0);
  const Motion now{(frame.world_from_image * Point<frame::Image>{centre}).v,
                   frame.world_from_image.linear.col(2), frame.captured};
  if (motion_ && now.at > motion_->at) {
    const double dt = seconds(now.at - motion_->at);
    if (dt < 0.1) return;  // shorter is the tracker's noise
    speed_mm_s_ = std::abs(motion_->normal.dot(now.middle - motion_->middle)) / dt;
  }
  motion_ = now;
}

void ScreenLoop::fill_live(Stamp now, double fps) {
  ui::LiveView& live = view_.live;
  const cart::ApplianceStatus& status = cart_.status();
  // The probe's picture is drawn from the lease, so it stays out until the frame is made.
  lease_ = cart_.latest();
  if (lease_) {
    const TrackedFrame& newest = lease_.frame().tracked;
    const auto captured = newest.captured.time_since_epoch().count();
    live.picture = {newest.bscan.pixels, {}, newest.bscan.kind, static_cast<std::uint64_t>(captured)};
    if (newest.pose_status == PoseStatus::ok) live.pose = newest.world_from_image;
    view_.status.scanner.age_ms = seconds(now - newest.captured) * 1e3;
    drawn_picture_ = newest.captured;
    measure_speed(newest);
  }
  const ui::Health scanner = view_.status.scanner.health;
  // An old picture must not pass for a live one.
  if (scanner == ui::Health::absent || scanner == ui::Health::silent) live.picture = {};
  live.recording = state_ == cart::State::recording;
  live.first_time = sweeps_taken_ == 0;
  live.widest_gap_mm = options_.beam_width_mm;
  live.seconds_left = view_.status.ring.seconds_free;
  if (!live.recording) return;
  live.recorded = now - status.cart.recording_since;
  live.speed_mm_s = speed_mm_s_;
  live.gap_mm = speed_mm_s_ / fps;
  if (growing_) live.frames = static_cast<std::int64_t>(growing_->swept().size());
}

void ScreenLoop::fill(Stamp now) {
  const cart::ApplianceStatus& status = cart_.status();
  const RingSettings& ring = cart_.ring().settings();
  // While the scanner is silent, what it sent before is the best forecast.
  const double now_hz = status.cart.acquisition.frames_hz;
  if (now_hz > 0.9 * fps_ || status.frames.health.state == DeviceState::running) fps_ = std::max(5.0, now_hz);
  const double fps = fps_;
  view_ = {};
  if (!disk_asked_ || now - *disk_asked_ > disk_every) {
    disk_asked_ = now;
    disk_bytes_ = bytes_on_disk(storage());
  }
  const double minutes = static_cast<double>(disk_bytes_) / (fps * ring.width * ring.height * 60);
  fill_status(status, sweep_ledger_, minutes, fps, ring.slots, losses_, view_.status);
  view_.status.pedal.mode = session_.pedal_mode();
  if (options_.stream) view_.status.stream = options_.stream();
  if (touch_) view_.status.touch = touch_status(*touch_);
  fill_live(now, fps);
  view_.set_up.version = options_.version;
  view_.set_up.has_sound = cues_ != nullptr && cues_->works();
  view_.set_up.sound_missing = cues_ != nullptr && !cues_->works();
  if (cart_.exams() != nullptr) {
    saving_ = cart_.exams()->status().sentence;
    view_.status.storage.reason = saving_;
    if (!saving_.empty()) view_.status.storage.health = ui::Health::fault;
  }
  view_.set_up.storage_place = storage().native();
  view_.set_up.probes = probes_;
  view_.set_up.crop_px = options_.probe.crop_px;
  view_.set_up.capture_width = options_.probe.capture_width;
  view_.set_up.capture_height = options_.probe.capture_height;
  session_.fill(view_);
  if (desk_) desk_->fill(view_.exams, state_ == cart::State::recording);
  if (const auto result = worker_.newest()) drawn_result_ = result->version;
}

const std::filesystem::path& ScreenLoop::storage() const {
  return cart_.exams() != nullptr ? cart_.exams()->place() : options_.shots;
}

}  // namespace sonoband
