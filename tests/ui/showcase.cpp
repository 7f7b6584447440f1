#include "tests/ui/showcase.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>

#include "app/screen/fonts.h"
#include "core/reslice/default_plane.h"
#include "hal/sim/bscan_simulator.h"
#include "hal/sim/probe_path.h"

namespace sonoband::test {
namespace {

// Small enough to make in a moment: pictures of 320 x 240 at 0.4 mm, 1.4 mm apart.
ShowExam make_exam() {
  ShowExam exam;
  sim::ScannerSettings scanner = sim::abdominal();
  scanner.width_px = 320;
  scanner.height_px = 240;
  scanner.pixel_mm = 0.4;
  scanner.face_row_px = 5;
  scanner.beams = 128;
  scanner.decorations = false;
  const auto phantom = std::make_shared<const sim::Phantom>(sim::foetus());
  sim::BscanSimulator simulator(phantom, {}, scanner, 7);
  constexpr int frames = 72;
  Pixels picture(scanner.width_px, scanner.height_px);
  for (int i = 0; i < frames; ++i) {
    const double part = static_cast<double>(i) / (frames - 1);
    sim::WorldFromFace face;
    const double tilt = 0.06 * std::sin(5 * part);
    face.rotation = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
    face.translation = {1.5 * std::sin(3 * part), 0.8 * std::cos(4 * part), -50 + 100 * part};
    const auto world_from_image = face.affine() * sim::face_from_image(scanner);
    simulator.paint(world_from_image, Stamp{}, picture.view().data, picture.width());
    exam.sweep.add(scanner.width_px, scanner.height_px, world_from_image,
                   [&](int x, int y, const Eigen::Vector3d&) { return picture.view()(x, y); });
  }
  exam.sweep.set_mask(sim::body_mask(scanner));
  exam.view = exam.sweep.view();

  // The long plane through the middle of the body, head to feet: along z, and down into it.
  exam.plane = *make_plane({0, 4, -56}, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY(), 280, 220, 0.4);
  RenderSettings settings;
  settings.band.step_mm = 0.4;
  Serial serial;
  exam.thin = render_planar(exam.view, exam.plane, settings, serial);
  settings.band.thickness_mm = 14;
  exam.band = render_planar(exam.view, exam.plane, settings, serial);
  return exam;
}

ui::Picture picture_of(const BandImage& band, std::uint64_t version) {
  return {band.pixels.view(), band.coverage.view(), band.kind, version};
}

constexpr std::array<ui::LossLine, 4> losses = {{{"the scanner skipped a frame", 2},
                                                 {"no pose in time", 1},
                                                 {"the tracker was distorted", 0},
                                                 {"the ring was full", 0}}};

ui::View good_view() {
  ui::View view;
  view.status.scanner = {ui::Health::good, "", 60.0, 21, false};
  view.status.tracker = {ui::Health::good, "", 240, PoseQuality::good};
  view.status.pedal = {ui::Health::good, "", ui::PedalMode::hold, false};
  view.status.storage = {ui::Health::good, "", 412};
  view.status.ring = {48, 60};
  view.status.losses = {0, 3412, losses};
  const ShowExam& exam = show_exam();
  view.live.picture = {exam.view.frames[36]->bscan.pixels, {}, PixelKind::grey, 36};
  view.live.pose = exam.view.frames[36]->world_from_image;
  view.live.first_time = true;
  view.live.widest_gap_mm = 0.25;
  return view;
}

}  // namespace

// The software rasteriser's own threads are not built for the thread sanitizer, and on the two cores of a CI
// machine they only get into the way of the other tests.
const int one_thread = setenv("LP_NUM_THREADS", "0", 1);

const ShowExam& show_exam() {
  static const ShowExam exam = make_exam();
  return exam;
}

ui::View live_view() {
  return good_view();
}

ui::View recording_view() {
  ui::View view = good_view();
  const ShowExam& exam = show_exam();
  view.live.recording = true;
  view.live.first_time = false;
  view.live.recorded = std::chrono::milliseconds(6400);
  view.live.frames = 384;
  view.live.seconds_left = 41;
  view.live.speed_mm_s = 9.8;
  view.live.gap_mm = 0.16;
  view.live.growing = picture_of(exam.band, 1);
  view.live.growing_mm = 14.2;
  view.live.sweep_version = 1;
  view.status.pedal.down = true;
  view.review.frames = exam.view.frames.first(52);
  view.live.pose = exam.view.frames[52]->world_from_image;
  return view;
}

ui::View review_view() {
  ui::View view = good_view();
  const ShowExam& exam = show_exam();
  view.page = ui::Page::review;
  ui::ReviewView& review = view.review;
  review.frames = exam.view.frames;
  review.sweep_version = 2;
  review.current = 36;
  review.bscan = {exam.view.frames[36]->bscan.pixels, {}, PixelKind::grey, 36};
  review.plane = review.band_plane = exam.plane;
  review.settings.band = {14.2, 0.4};
  review.band = picture_of(exam.band, 1);
  review.band_ms = 3.1;
  static const std::vector<Eigen::Vector2d> vertices = {{12, 38}, {30, 52}, {52, 55}, {74, 48}, {94, 40}};
  static const std::vector<Eigen::Vector2d> line = [] {
    std::vector<Eigen::Vector2d> all;
    for (int i = 0; i <= 80; ++i) {
      const double x = 12 + 82.0 * i / 80;
      all.emplace_back(x, 38 + 17 * std::sin((x - 12) / 82 * std::numbers::pi * 0.92));
    }
    return all;
  }();
  const auto moved = [](double by) {
    std::vector<Eigen::Vector2d> all = line;
    for (Eigen::Vector2d& p : all) p.y() += by;
    return all;
  };
  static const std::vector<PlaneLine> up = {moved(-3.6)}, down = {moved(3.6)};
  static const std::array<ui::CurveView::Smear, 1> smeared = {{{46, 52}}};
  review.curve = {vertices, line, up, down, smeared, 24, 92, 36, false, true, false};
  review.manifold = picture_of(exam.thin, 3);
  review.manifold_thickness_mm = 7.2;
  review.manifold_pixel_mm = 0.4;
  return view;
}

ui::View exams_view() {
  ui::View view = good_view();
  const ShowExam& exam = show_exam();
  view.page = ui::Page::exams;
  static const std::array<ui::ExamView, 5> exams = {{
      {5, "Phantom, morning check", "22 Nov 2026, 09:41", 1, 384, 6.4, ui::ExamState::complete,
       picture_of(exam.band, 1), true},
      {4, "", "22 Nov 2026, 09:12", 3, 1180, 19.7, ui::ExamState::complete, picture_of(exam.thin, 2), false,
       2},
      {3, "MK 16 weeks", "21 Nov 2026, 16:55", 4, 2410, 40.2, ui::ExamState::recovered,
       picture_of(exam.band, 3), false},
      {2, "Training", "20 Nov 2026, 11:03", 2, 905, 15.1, ui::ExamState::complete, {}, false},
      {1, "Thyroid volunteer 7", "19 Nov 2026, 14:20", 1, 512, 8.5, ui::ExamState::complete,
       picture_of(exam.thin, 5), false},
  }};
  view.exams.exams = exams;
  view.exams.selected = 4;
  static const std::array<ui::PlaceView, 2> places = {{{"ULTRASOUND", true}, {"/data/exports", false}}};
  view.exams.on_disk = true;
  view.exams.transfer.places = places;
  return view;
}

ui::View set_up_view() {
  ui::View view = good_view();
  view.page = ui::Page::set_up;
  static const std::array<ui::ProbeView, 3> probes = {{{"Convex 3.5 MHz", 160, true, 12},
                                                       {"Convex 3.5 MHz", 240, false, 0},
                                                       {"Linear 7.5 MHz", 40, true, 0.2}}};
  view.set_up.probes = probes;
  view.set_up.crop_px = {100, 60, 640, 480};
  view.set_up.capture_width = 1024;
  view.set_up.capture_height = 768;
  view.set_up.storage_place = "out/exams";
  view.set_up.has_sound = true;
  view.set_up.version = "0.1.0";
  return view;
}

Bench::Bench(int width, int height, float scale, bool pixels) : surface(width, height) {
  if (!pixels && std::getenv("SONOBAND_SHOTS") == nullptr) surface.without_pixels();
  surface.begin_frame();
  screen = std::make_unique<ui::Screen>(ui::ScreenSettings{0, scale}, load_fonts(), ui::Texts{});
}

const ui::Commands& Bench::frame(const ui::View& view) {
  constexpr Duration step = std::chrono::microseconds(16667);
  now += step;
  surface.begin_frame();
  const ui::Commands& commands = screen->frame(view, input, now, surface.size_px());
  surface.end_frame();
  input.clear();
  EXPECT_EQ(screen->counts().gl_errors, 0u);
  return commands;
}

ui::Rect Bench::find(const std::string& name) {
  const auto widget = screen->widgets().find(name);
  EXPECT_TRUE(widget.has_value()) << "no widget is called " << name;
  return widget ? widget->rect : ui::Rect{};
}

std::vector<ui::Command> Bench::tap_at(const ui::View& view, ui::Vec2 at) {
  std::vector<ui::Command> all;
  input.contacts.push_back({now, ui::Contact::Kind::down, 0, at, 0});
  for (const ui::Command& c : frame(view)) all.push_back(c);
  input.contacts.push_back({now, ui::Contact::Kind::up, 0, at, 0});
  for (const ui::Command& c : frame(view)) all.push_back(c);
  now += std::chrono::seconds(1);  // two taps shall not make a double one
  return all;
}

std::vector<ui::Command> Bench::tap(const ui::View& view, const std::string& name) {
  frame(view);
  return tap_at(view, find(name).centre());
}

std::vector<ui::Command> Bench::drag(const ui::View& view, ui::Vec2 from, ui::Vec2 to, int frames) {
  frame(view);
  std::vector<ui::Command> all;
  const auto collect = [&] {
    for (const ui::Command& c : frame(view)) all.push_back(c);
  };
  input.contacts.push_back({now, ui::Contact::Kind::down, 0, from, 0});
  collect();
  for (int i = 1; i <= frames; ++i) {
    const float part = static_cast<float>(i) / static_cast<float>(frames);
    input.contacts.push_back({now, ui::Contact::Kind::move, 0, from + part * (to - from), 0});
    collect();
  }
  now += std::chrono::milliseconds(200);  // at rest before it lifts: no flick
  input.contacts.push_back({now, ui::Contact::Kind::up, 0, to, 0});
  collect();
  now += std::chrono::seconds(1);
  return all;
}

std::vector<ui::Command> Bench::pinch(const ui::View& view, ui::Vec2 centre, float from_px, float to_px,
                                      float turn_rad) {
  frame(view);
  std::vector<ui::Command> all;
  const auto collect = [&] {
    for (const ui::Command& c : frame(view)) all.push_back(c);
  };
  constexpr int steps = 8;
  const auto place = [&](int finger, int step) {
    const float part = static_cast<float>(step) / steps;
    const float spread = (from_px + part * (to_px - from_px)) / 2;
    const float angle = part * turn_rad;
    const ui::Vec2 arm{spread * std::cos(angle), spread * std::sin(angle)};
    return finger == 0 ? centre - arm : centre + arm;
  };
  for (const int finger : {0, 1})
    input.contacts.push_back({now, ui::Contact::Kind::down, finger, place(finger, 0), 0});
  collect();
  for (int i = 1; i <= steps; ++i) {
    for (const int finger : {0, 1})
      input.contacts.push_back({now, ui::Contact::Kind::move, finger, place(finger, i), 0});
    collect();
  }
  for (const int finger : {0, 1})
    input.contacts.push_back({now, ui::Contact::Kind::up, finger, place(finger, steps), 0});
  collect();
  now += std::chrono::seconds(1);
  return all;
}

void Bench::shot(const std::string& name) {
  const char* folder = std::getenv("SONOBAND_SHOTS");
  if (folder == nullptr) return;
  const ui::Rgba rgba = surface.read();
  std::ofstream out(std::string(folder) + "/" + name + ".ppm", std::ios::binary);
  out << "P6\n" << rgba.width << " " << rgba.height << "\n255\n";
  for (std::size_t i = 0; i < rgba.bytes.size(); i += 4) {
    out.write(reinterpret_cast<const char*>(rgba.bytes.data() + i), 3);
  }
}

}  // namespace sonoband::test
