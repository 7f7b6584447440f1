#include "app/screen/loop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <system_error>
#include <thread>

#include "app/bad_input.h"
#include "app/exchange/png.h"
#include "app/screen/fonts.h"

namespace sonoband {
namespace {

constexpr Duration growth_every = std::chrono::milliseconds(120);
constexpr Duration status_every = std::chrono::milliseconds(200);
constexpr std::size_t most_sweeps = 6;  // the ring holds 8, one of them grows
constexpr double room_s = 15;           // of new recording that old sweeps must make way for

std::string local_time() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  localtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%d %b %Y, %H:%M:%S", &parts);
  return text.data();
}

double minutes_on_disk(const std::filesystem::path& folder, double bytes_per_s) {
  std::error_code error;
  const auto space = std::filesystem::space(std::filesystem::exists(folder) ? folder : std::filesystem::current_path(), error);
  if (error || bytes_per_s <= 0) return 0;
  return static_cast<double>(space.available) / bytes_per_s / 60;
}

int threads_for_rendering() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()) - 1);
}

}  // namespace

ScreenLoop::ScreenLoop(cart::Appliance& cart, const std::function<bool(bool down)>& foot, const ScreenOptions& options,
                       ui::Surface& surface)
    : cart_(cart),
      foot_(foot),
      options_(options),
      surface_(surface),
      worker_(threads_for_rendering()),
      session_(worker_, options.toggle_pedal ? ui::PedalMode::toggle : ui::PedalMode::hold),
      screen_((surface.begin_frame(), ui::ScreenSettings{options.width_mm, options.scale}), load_fonts(), ui::Texts{}) {}

void ScreenLoop::measure_speed(const TrackedFrame& frame) {
  if (frame.pose_status != PoseStatus::ok) return;
  const Eigen::Vector3d centre(0.5 * frame.bscan.pixels.width, 0.5 * frame.bscan.pixels.height, 0);
  const Motion now{(frame.world_from_image * Point<frame::Image>{centre}).v, frame.world_from_image.linear.col(2), frame.captured};
  if (motion_ && now.at > motion_->at) {
    const double dt = seconds(now.at - motion_->at);
    if (dt < 0.1) return;  // shorter is the tracker's noise
    speed_mm_s_ = std::abs(motion_->normal.dot(now.middle - motion_->middle)) / dt;
  }
  motion_ = now;
}

void ScreenLoop::follow_sweep(Stamp now) {
  while (auto sweep = cart_.take_sweep()) {
    growing_ = std::make_shared<Sweep>(std::move(*sweep));
    session_.begin_sweep(static_cast<std::uint64_t>(growing_->id()));
    next_growth_ = now;
    recorded_ = true;
  }
  if (!growing_) return;
  const auto released = growing_->released();
  if (!released && now < *next_growth_) return;
  next_growth_ = now + growth_every;
  RunSweep sweep;
  sweep.held = {growing_->view(), growing_};
  sweep.id = static_cast<std::uint64_t>(growing_->id());
  if (released) {
    sweep.when = local_time();
    sweep.seconds = seconds(*released - growing_->pressed());
  }
  session_.grow_sweep(sweep, released.has_value());
  if (!released) return;
  growing_.reset();
  const cart::ApplianceStatus& status = cart_.status();
  while (session_.sweep_count() > most_sweeps || (status.cart.ring_seconds > 0 && status.cart.ring_seconds < room_s)) {
    if (!session_.let_go_oldest()) break;
    if (session_.sweep_count() <= most_sweeps) break;  // the ring's own count follows a moment later
  }
}

bool ScreenLoop::listen(Stamp now) {
  const cart::ApplianceStatus& status = cart_.status();
  bool news = status.cart.state != state_;
  state_ = status.cart.state;
  follow_sweep(now);
  session_.tick(now);
  if (!next_status_ || now >= *next_status_) {
    next_status_ = now + status_every;
    news = true;
  }
  const auto result = worker_.newest();
  const bool live = session_.page() == ui::Page::live;
  return news || session_.moving() || screen_.wants_frame() || (result && result->version != drawn_result_) ||
         (live && status.cart.ring.published != drawn_picture_) || state_ == cart::State::recording;
}

void ScreenLoop::draw(const ui::Input& input, Stamp now) {
  const cart::ApplianceStatus& status = cart_.status();
  const RingSettings& ring = cart_.ring().settings();
  const double fps = std::max(1.0, status.cart.acquisition.frames_hz);
  view_ = {};
  fill_status(status, minutes_on_disk(options_.shots, fps * ring.width * ring.height), ring.slots / fps, losses_,
              view_.status);
  view_.status.pedal.mode = session_.pedal_mode();

  const FrameLease lease = cart_.latest();
  ui::LiveView& live = view_.live;
  if (lease) {
    const SweepFrame& newest = lease.frame();
    live.picture = {newest.tracked.bscan.pixels, {}, newest.tracked.bscan.kind, status.cart.ring.published};
    // The stamp itself is the version: published counts ahead of the status.
    live.picture.version = static_cast<std::uint64_t>(newest.tracked.captured.time_since_epoch().count());
    if (newest.tracked.pose_status == PoseStatus::ok) live.pose = newest.tracked.world_from_image;
    view_.status.scanner.age_ms = seconds(now - newest.tracked.captured) * 1e3;
    measure_speed(newest.tracked);
  }
  const bool silent = view_.status.scanner.health == ui::Health::absent || view_.status.scanner.health == ui::Health::silent;
  if (silent) live.picture = {};  // an old picture must not pass for a live one
  drawn_picture_ = status.cart.ring.published;
  live.recording = state_ == cart::State::recording;
  live.first_time = !recorded_;
  live.widest_gap_mm = options_.beam_width_mm;
  live.seconds_left = status.cart.ring_seconds;
  if (live.recording) {
    live.recorded = now - status.cart.recording_since;
    live.speed_mm_s = speed_mm_s_;
    live.gap_mm = speed_mm_s_ / fps;
    if (growing_) live.frames = static_cast<std::int64_t>(growing_->swept().size());
  }
  view_.set_up.version = options_.version;
  const std::string place = options_.shots.string();
  view_.set_up.storage_place = place;
  const std::array<ui::DeviceLine, 3> devices = {
      {{"Scanner", view_.status.scanner.reason, view_.status.scanner.health},
       {"Tracker", view_.status.tracker.reason, view_.status.tracker.health},
       {"Pedal", view_.status.pedal.reason, view_.status.pedal.health}}};
  view_.set_up.devices = devices;
  session_.fill(view_);
  if (const auto result = worker_.newest()) drawn_result_ = result->version;

  surface_.begin_frame();
  const ui::Commands& commands = screen_.frame(view_, input, now, surface_.size_px());
  for (const ui::Command& command : commands) carry_out(command);
  if (input.close) quits_ = true;
  if (const auto window = session_.take_snapshot()) {
    constexpr std::array<std::string_view, 5> parts = {"", "review/picture", "reslice/picture", "manifold/picture", "outline/picture"};
    const std::string file = "snapshot-" + std::to_string(++snapshots_) + ".png";
    save(file, parts[static_cast<std::size_t>(*window)]);
    session_.say("Saved " + (options_.shots / file).string());
  }
  surface_.end_frame();
}

void ScreenLoop::press(bool down) {
  if (foot_) {
    if (!foot_(down)) session_.say("The pedal did not take that press: try again.");
    return;
  }
  // Without a pedal to press, the record button toggles; in hold mode its release is the second press.
  const bool hold = session_.pedal_mode() == ui::PedalMode::hold;
  if (!down && !(hold && button_started_)) return;
  button_started_ = down;
  if (!cart_.command(cart::Command::record_button)) session_.say("The cart is busy: press again.");
}

void ScreenLoop::carry_out(const ui::Command& command) {
  namespace c = ui::command;
  if (const auto* pedal = std::get_if<c::Pedal>(&command)) return press(pedal->down);
  if (std::holds_alternative<c::Quit>(command)) quits_ = true;
  if (std::holds_alternative<c::ToggleFullScreen>(command)) toggle_ = true;
  if (const auto* to = std::get_if<c::GoTo>(&command)) {
    if (to->page == ui::Page::live && state_ == cart::State::review) {
      // Refused only while 16 others wait; the state changes nothing that the Live page shows.
      static_cast<void>(cart_.command(cart::Command::show_live));
    }
  }
  session_.apply(command);
}

void ScreenLoop::save(const std::string& file, std::string_view part) {
  std::error_code error;
  std::filesystem::create_directories(options_.shots, error);
  const ui::Rgba all = surface_.read();
  ui::Rect r{0, 0, static_cast<float>(all.width), static_cast<float>(all.height)};
  if (const auto widget = screen_.widgets().find(part)) r = widget->rect;
  exchange::PngPicture png;
  const int left = std::clamp(static_cast<int>(r.x), 0, all.width - 1);
  const int top = std::clamp(static_cast<int>(r.y), 0, all.height - 1);
  png.width = std::clamp(static_cast<int>(r.width), 1, all.width - left);
  png.height = std::clamp(static_cast<int>(r.height), 1, all.height - top);
  png.channels = 3;
  png.texts = {{"Software", "Sonoband " + options_.version}, {"Disclaimer", "Research use only."}};
  png.bytes.reserve(static_cast<std::size_t>(png.width) * png.height * 3);
  for (int y = top; y < top + png.height; ++y) {
    for (int x = left; x < left + png.width; ++x) {
      const std::uint8_t* p = all.bytes.data() + (static_cast<std::size_t>(y) * all.width + x) * 4;
      png.bytes.insert(png.bytes.end(), p, p + 3);
    }
  }
  exchange::write_png(png, options_.shots / file);
}

}  // namespace sonoband
