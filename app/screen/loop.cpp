#include "app/screen/loop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <system_error>
#include <thread>

#include "app/bad_input.h"
#include "app/exchange/png.h"
#include "app/screen/cues.h"
#include "app/screen/fonts.h"
#include "app/thread_time.h"

namespace sonoband {
namespace {

constexpr Duration growth_every = std::chrono::milliseconds(120);
constexpr Duration numbers_every = std::chrono::seconds(1);  // of the lamps, while nothing else is drawn
constexpr std::size_t most_sweeps = 6;                       // the ring holds 8, one of them grows
// Of new recording that old sweeps must make way for; in a small ring a quarter of it.
constexpr double room_s = 15;

std::string local_time() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  localtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%d %b %Y, %H:%M:%S", &parts);
  return text.data();
}

// What a start found of several exams: the newest that was cut off, else the newest.
const std::string& most_telling(const std::vector<std::string>& recovered) {
  const auto cut_off = std::find_if(recovered.rbegin(), recovered.rend(), [](const std::string& sentence) {
    return exam::was_cut_off(std::span(&sentence, 1), sentence.substr(0, sentence.find(':')));
  });
  return cut_off == recovered.rend() ? recovered.back() : *cut_off;
}

int threads_for_rendering() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()) - 1);
}

}  // namespace

ScreenLoop::ScreenLoop(cart::Appliance& cart, const Foot& foot, const ScreenOptions& options,
                       ui::Surface& surface, const std::function<void()>& rendered)
    : cart_(cart),
      foot_(foot),
      options_(options),
      surface_(surface),
      worker_(threads_for_rendering(), rendered),
      session_(worker_, options.pedal == PedalMode::toggle ? ui::PedalMode::toggle : ui::PedalMode::hold),
      screen_((surface.begin_frame(), ui::ScreenSettings{options.width_mm, options.scale, options.bar}),
              load_fonts(), ui::Texts{}) {
  screen_.warm_up(surface.size_px());
  const ProbeOptions& probe = options_.probe;
  probes_[0] = {probe.name, probe.depth_mm, probe.calibrated, -1};
  if (cart_.exams() != nullptr)
    desk_ = std::make_unique<ExamDesk>(*cart_.exams(), session_, options_.exports, rendered);
  if (cart_.exams() != nullptr && !cart_.exams()->recovered().empty())
    session_.say(most_telling(cart_.exams()->recovered()), std::chrono::seconds(20));
}

void ScreenLoop::follow_sweep(Stamp now) {
  while (auto sweep = cart_.take_sweep()) {
    growing_ = std::make_shared<Sweep>(std::move(*sweep));
    session_.begin_sweep(static_cast<std::uint64_t>(growing_->id()));
    next_growth_ = now;
    ++sweeps_taken_;
    at_press_ = cart_.status().cart.acquisition.ledger;
  }
  if (!growing_) return;
  sweep_ledger_ = booked_since(at_press_, cart_.status().cart.acquisition.ledger);
  const auto released = growing_->released();
  if (!released && now < *next_growth_) return;
  next_growth_ = now + growth_every;
  RunSweep sweep;
  sweep.held = without_drawings({growing_->view(), growing_});
  sweep.id = static_cast<std::uint64_t>(growing_->id());
  if (released) {
    sweep.when = local_time();
    sweep.seconds = seconds(*released - growing_->pressed());
  }
  session_.grow_sweep(sweep, released.has_value());
  if (!released) return;
  if (growing_->ledger() != nullptr) sweep_ledger_ = *growing_->ledger();
  growing_.reset();
  const cart::ApplianceStatus& status = cart_.status();
  const double ring_s = cart_.ring().settings().slots / fps_;
  const double room = std::min(room_s, ring_s / 4);
  while (session_.sweep_count() > most_sweeps || status.cart.ring.room < room * fps_) {
    if (!session_.let_go_oldest()) break;
    if (session_.sweep_count() <= most_sweeps) break;  // the ring's own count follows a moment later
  }
}

void ScreenLoop::tell_touch(const DeviceHealth& health) {
  const bool said = touch_ && touch_->state == health.state && touch_->reason == health.reason;
  touch_ = health;
  if (said) return;
  if (*health.reason != '\0') session_.say(health.reason, std::chrono::seconds(10));
  next_numbers_.reset();
}

bool ScreenLoop::listen(Stamp now) {
  const cart::ApplianceStatus& status = cart_.status();
  const Lamps lamps{status.frames.health.state,
                    status.tracker.health.state,
                    status.pedal.health.state,
                    status.cart.state,
                    status.frozen,
                    status.cart.pedal_down,
                    status.cart.acquisition.pose_quality};
  bool news = lamps != lamps_;
  lamps_ = lamps;
  cart::Note noted = cart::Note::none;
  if (status.cart.note != cart::Note::none && status.cart.noted != noted_) {
    noted_ = status.cart.noted;
    noted = status.cart.note;
    session_.say(cart::sentence_of(status.cart.note));
    news = true;
  }
  const auto cue = cue_of(std::exchange(state_, status.cart.state), status.cart.state, noted);
  if (cue && cues_ != nullptr && session_.sound()) cues_->play(*cue);
  follow_sweep(now);
  if (desk_) news = desk_->listen(now) || news;
  session_.tick(now);
  hand_on_band();
  if (!next_numbers_ || now >= *next_numbers_) {
    next_numbers_ = now + numbers_every;
    news = true;
  }
  if (session_.page() == ui::Page::live) {
    const FrameLease lease = cart_.latest();
    news = news || (lease && lease.frame().tracked.captured != drawn_picture_);
  }
  return news || session_.moving() || session_.changed() || screen_.wants_frame() || rendered();
}

void ScreenLoop::hand_on_band() {
  if (!options_.on_band) return;
  const auto result = worker_.newest();
  // A coarse one is gone in a moment.
  if (!result || !result->planar || result->planar->coarse || result->planar->version == handed_band_) return;
  handed_band_ = result->planar->version;
  options_.on_band(result->planar->band, result->planar->plane, result->planar->layers);
}

bool ScreenLoop::rendered() const {
  const auto result = worker_.newest();
  return result && result->version != drawn_result_;
}

Duration ScreenLoop::may_sleep() const {
  // A picture comes every 16 to 40 ms on the Live page; looking every 4 shows it within a frame.
  const bool awake = session_.page() == ui::Page::live || session_.moving() || screen_.wants_frame();
  return awake ? std::chrono::milliseconds(4) : std::chrono::milliseconds(40);
}

void ScreenLoop::draw(const ui::Input& input, Stamp now) {
  const Duration t0 = thread_time();
  fill(now);
  const Duration t1 = thread_time();
  surface_.begin_frame();
  const ui::Commands& commands = screen_.build(view_, input, now, surface_.size_px());
  const Duration t2 = thread_time();
  screen_.send_pictures();
  const Duration t3 = thread_time();
  screen_.draw_outline();
  lease_ = {};
  const Duration t4 = thread_time();
  // At once, not after the frame: the worker paints while this one is drawn and shown.
  for (const ui::Command& command : commands) carry_out(command);
  if (input.close) quits_ = true;
  session_.ask_if_changed();
  const Duration t5 = thread_time();
  screen_.submit();
  if (const auto window = session_.take_snapshot()) take_snapshot(*window);
  times_ = {t1 - t0, t2 - t1, t3 - t2, (t4 - t3) + (thread_time() - t5), t5 - t4};
  surface_.end_frame();
}

void ScreenLoop::take_snapshot(ui::Window window) {
  constexpr std::array<std::string_view, 5> parts = {"", "review/picture", "reslice/picture",
                                                     "manifold/picture", "outline/picture"};
  std::error_code error;
  std::string file;
  do {
    file = "snapshot-" + std::to_string(++snapshots_) + ".png";
  } while (std::filesystem::exists(options_.shots / file, error));
  save(file, parts[static_cast<std::size_t>(window)]);
  if (desk_) desk_->keep_snapshot(options_.shots / file, window);
  session_.say("Saved as " + (options_.shots / file).string() + ".");
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
  if (desk_ && desk_->carry_out(command)) return;
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
