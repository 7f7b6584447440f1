#include "tests/app/screen/screen_support.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "app/cart_on_board.h"
#include "app/exchange/png.h"
#include "hal/sim/probe_path.h"
#include "hal/sim/scene.h"
#include "hal/tracker/polhemus_tracker.h"

namespace sonoband::test {
namespace {

struct Parts {
  sim::SimulatedScene scene;
  std::unique_ptr<sim::LibertySim> liberty;
};

void make_coarser(sim::SimulatedScene& scene, int factor) {
  sim::ScannerSettings& scanner = scene.scanner;
  scanner.width_px /= factor;
  scanner.height_px /= factor;
  scanner.pixel_mm *= factor;
  scanner.face_row_px /= factor;
  scanner.beams /= factor;
  scene.probe_from_image = sim::typical_calibration(sim::face_from_image(scanner));
}

// As board/sim_board.cpp does, with faults.
BoardDevices faulty_board(const ScreenCartSettings& settings, Clock& clock) {
  auto parts = std::make_shared<Parts>();
  parts->scene = sim::make_scene({.preset = settings.doppler ? "vessels" : "foetus"});
  if (!settings.pixels) parts->scene.scanner.beams = 48;  // a quarter of the echoes, where nobody looks
  if (settings.coarser > 1) make_coarser(parts->scene, settings.coarser);
  const sim::SimulatedScene& scene = parts->scene;
  sim::LibertySimConfig liberty;
  liberty.unit.seed = scene.seed;
  liberty.faults = settings.faults.tracker;
  parts->liberty = std::make_unique<sim::LibertySim>(
      clock, liberty, [hand = scene.hand](Stamp t) { return hand->tracker_from_probe(t); });
  sim::FrameSourceSettings frames;
  frames.rate_hz = settings.frames_hz;
  frames.faults = settings.faults.frames;
  sim::FootswitchSettings pedal;
  pedal.faults = settings.faults.pedal;
  pedal.on_live_press = [hand = scene.hand](Stamp t) { hand->pressed(t); };

  BoardDevices board;
  board.board = "sim";
  auto tracker = std::make_unique<PolhemusTracker>(*parts->liberty, clock, LinkConfig{});
  board.on_recording = [t = tracker.get()](bool recording) { t->set_recording(recording); };
  board.tracker = std::move(tracker);
  board.frames = std::make_unique<sim::SimFrameSource>(clock, scene.frame_settings(frames), scene.painter());
  auto footswitch = std::make_unique<sim::SimFootswitch>(clock, pedal);
  board.foot = [foot = footswitch.get()](bool down) { return down ? foot->press() : foot->release(); };
  board.footswitch = std::move(footswitch);
  board.width_px = scene.scanner.width_px;
  board.height_px = scene.scanner.height_px;
  board.mask = sim::body_mask(scene.scanner);
  board.probe_from_image = scene.probe_from_image;
  board.latency_offset = scene.scanner_latency - std::chrono::microseconds(3500);
  board.parts = std::move(parts);
  return board;
}

}  // namespace

ScreenCart::ScreenCart(ScreenCartSettings settings) : settings_(std::move(settings)) {
  settings_.pixels = settings_.pixels || std::getenv("SONOBAND_SHOTS") != nullptr;
  BoardDevices board = faulty_board(settings_, *clock_);
  Profile profile;
  profile.ring.frames = static_cast<int>(settings_.ring_frames);
  profile.pedal.mode = settings_.screen.pedal;
  profile.exams.reserve_mb = 1;
  if (settings_.doppler) profile.capture.colour = "doppler";
  cart_ = make_appliance(board, profile, clock_, settings_.exams);
  foot_ = board.foot;
  member_.emplace(*clock_);
  cart_->start();
  surface_ = std::make_unique<ui::HeadlessSurface>(settings_.screen.width, settings_.screen.height);
  if (!settings_.pixels) surface_->without_pixels();
  loop_ = std::make_unique<ScreenLoop>(*cart_, foot_, settings_.screen, *surface_);
  player_ = std::make_unique<Player>(*cart_, foot_, *loop_, "script");
  player_->frame();
}

ScreenCart::~ScreenCart() {
  EXPECT_EQ(loop_->screen().counts().gl_errors, 0u);
  EXPECT_EQ(loop_->screen().counts().late_kinds, 0u) << "a frame waited for the driver (ui/draw_kinds.h)";
  player_.reset();
  loop_.reset();
  cart_->stop();
  cart_.reset();
}

void ScreenCart::play(const std::string& script) {
  for (const script::Step& step : script::parse(script, "script")) player_->play(step);
}

void ScreenCart::draw() {
  loop_->wait_for_renderings();
  for (int i = 0; i < 2; ++i) loop_->draw({}, clock_->now());
  EXPECT_EQ(loop_->screen().counts().gl_errors, 0u);
}

ui::Rgba ScreenCart::shot() {
  EXPECT_TRUE(settings_.pixels) << "ask for ScreenCartSettings::pixels";
  draw();
  surface_->begin_frame();
  return surface_->read();
}

void ScreenCart::show(const std::string& name) {
  draw();
  const char* folder = std::getenv("SONOBAND_SHOTS");
  if (folder == nullptr) return;
  const ui::Rgba all = shot();
  exchange::PngPicture png{all.width, all.height, 3, {}, 0, {}};
  for (std::size_t i = 0; i < all.bytes.size(); i += 4)
    png.bytes.insert(png.bytes.end(), &all.bytes[i], &all.bytes[i] + 3);
  exchange::write_png(png, std::filesystem::path(folder) / (name + ".png"));
}

std::filesystem::path scratch_folder() {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string("sonoband-") + test->test_suite_name() + "-" + test->name();
  for (char& c : name) c = c == '/' ? '-' : c;
  auto folder = std::filesystem::temp_directory_path() / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace sonoband::test
