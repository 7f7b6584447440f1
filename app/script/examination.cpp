#include "app/script/examination.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <optional>
#include <sstream>

#include "app/exchange/png.h"
#include "app/script/watch.h"
#include "core/manifold/manifold_band.h"
#include "core/reslice/default_plane.h"
#include "core/sweep/drawings.h"

namespace sonoband::script {
namespace {

using Json = nlohmann::ordered_json;

Json ledger_json(const LossLedger& ledger) {
  Json json;
  for (const LedgerLine& line : lines(ledger)) json[line.name] = line.value;
  return json;
}

Json sweep_json(const Sweep& sweep) {
  Json json{{"id", sweep.id()},
            {"frames", sweep.swept().size()},
            {"frames_with_pose", sweep.view().frames.size()},
            {"pre_roll_frames", sweep.pre_roll().size()},
            {"start_complete", sweep.start_complete()}};
  if (const auto released = sweep.released()) json["seconds"] = seconds(*released - sweep.pressed());
  if (!sweep.swept().empty()) {
    json["first_frame_after_press_ms"] =
        1000 * seconds(sweep.swept().front().tracked.captured - sweep.pressed());
  }
  if (sweep.ledger() != nullptr) json["ledger"] = ledger_json(*sweep.ledger());
  return json;
}

const char* word(Compounding c) {
  return c == Compounding::maximum ? "max" : c == Compounding::minimum ? "min" : "mean";
}

// Everything a picture is made from.
struct Chosen {
  ReslicePlane plane;
  std::vector<Eigen::Vector2d> curve_mm;
  double reach_mm = 0;
};

class Runner {
 public:
  Runner(const std::string& file, Stage& stage) : file_(file), stage_(stage) {}

  void operator()(const Step& step) {
    line_ = step.line;
    take_sweeps();
    std::visit([this](const auto& action) { act(action); }, step.action);
  }

  Json summary() {
    take_sweeps();
    Json sweeps = Json::array();
    for (const Sweep& sweep : sweeps_) sweeps.push_back(sweep_json(sweep));
    return {{"sweeps", sweeps},
            {"pictures", pictures_},
            {"ledger", ledger_json(stage_.cart.status().cart.acquisition.ledger)}};
  }

 private:
  [[noreturn]] void fail(const std::string& sentence) const {
    throw ScriptFailed(file_ + ":" + std::to_string(line_) + ": " + sentence);
  }

  void take_sweeps() {
    while (auto sweep = stage_.cart.take_sweep()) sweeps_.push_back(std::move(*sweep));
  }

  // Until then, or until `enough` says so; whoever watches is told meanwhile.
  bool pass_until(Stamp end, const std::function<bool()>& enough) {
    for (;;) {
      if (watch_) watch();
      if (enough()) return true;
      const Stamp now = stage_.clock.now();
      if (now >= end) return false;
      stage_.clock.sleep_until(now + std::chrono::milliseconds(10));
    }
  }

  void watch() {
    take_sweeps();
    for (; sweeps_told_ < sweeps_.size() && sweeps_[sweeps_told_].ledger() != nullptr; ++sweeps_told_)
      say(Json{{"sweep", sweep_json(sweeps_[sweeps_told_])}}.dump());
    if (const auto line = watch_->line(stage_.cart.status())) say(*line);
  }

  // At once: who reads along may cut the power next.
  static void say(const std::string& line) {
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  }

  void act(const WatchCart&) { watch_.emplace(); }
  void act(const Wait& wait) {
    const Stamp end = stage_.clock.now() + wait.time;
    if (!watch_) return stage_.clock.sleep_until(end);
    pass_until(end, [] { return false; });
  }
  void act(const Press&) { step_on(true); }
  void act(const Release&) { step_on(false); }
  void step_on(bool down) {
    if (!stage_.foot) fail("this board's pedal is real; step on it, or use the board sim");
    if (!stage_.foot(down)) fail("the simulated pedal has too many presses waiting; wait between them");
  }

  void act(const Await& await) {
    std::string state;
    const auto there = [&] {
      return (state = cart::name_of(stage_.cart.status().cart.state)) == await.state;
    };
    if (pass_until(stage_.clock.now() + await.at_most, there)) return;
    std::ostringstream within;
    within << seconds(await.at_most);
    fail("the cart was to be in " + await.state + " within " + within.str() + " s and is in " + state);
  }

  void act(const ScreenAction&) { fail("there is no screen here for a finger to touch"); }

  SweepView last_sweep() {
    if (sweeps_.empty()) fail("there is no sweep yet to make a picture of; press, wait, release first");
    const SweepView view = sweeps_.back().view();
    if (view.frames.empty())
      fail("no frame of the last sweep has a pose, so there is nothing to make a picture of");
    mask_ = mask_without_drawings(view);
    return {view.frames, mask_.view()};
  }

  Chosen choose(const SweepView& sweep, const Render& render) const {
    if (render.view == "level" || render.view == "upright") {
      const auto plane =
          default_plane(sweep, render.view == "level" ? PlaneView::level : PlaneView::upright, render.at);
      return {*plane, {}, 0};
    }
    std::string names = "level, upright";
    for (const BoardView& view : stage_.views) {
      if (view.name == render.view) return {view.plane, view.curve_mm, view.reach_mm};
      names += ", " + view.name;
    }
    fail("there is no view " + render.view + "; there are " + names);
  }

  RenderSettings settings_for(const SweepView& sweep, const Render& render) const {
    RenderSettings settings = render.settings;
    settings.band.step_mm = pixel_width_mm(sweep);
    return settings;
  }

  void act(const Render& render) {
    const SweepView sweep = last_sweep();
    const Chosen chosen = choose(sweep, render);
    const RenderSettings settings = settings_for(sweep, render);
    const auto start = std::chrono::steady_clock::now();
    const BandImage image = render_planar(sweep, chosen.plane, settings, stage_.workers);
    keep(render, image, settings, chosen.plane.pixel_mm, start);
    if (stage_.on_band) stage_.on_band(image, chosen.plane, settings.band.layers());
  }

  void act(const Manifold& manifold) {
    const SweepView sweep = last_sweep();
    const Chosen chosen = choose(sweep, manifold.plane);
    const auto& stroke = manifold.curve_mm.empty() ? chosen.curve_mm : manifold.curve_mm;
    const double reach_mm = manifold.reach_mm.value_or(chosen.reach_mm);
    if (stroke.empty() || reach_mm <= 0)
      fail("the view " + manifold.plane.view + " suggests no curve; give curve= and reach-mm=");
    CurveSettings curve_settings;
    curve_settings.pixel_mm = chosen.plane.pixel_mm;
    const CurveResult curve = make_curve(stroke, curve_settings);
    if (curve.fault != CurveFault::none) fail("the curve " + std::string(describe(curve.fault)));
    ManifoldSettings settings;
    settings.reach_mm = reach_mm;
    settings.render = settings_for(sweep, manifold.plane);
    const auto start = std::chrono::steady_clock::now();
    const ManifoldBand band = render_manifold(sweep, chosen.plane, curve.curve, settings, stage_.workers);
    keep(manifold.plane, band.image, settings.render, chosen.plane.pixel_mm, start);
  }

  void keep(const Render& render, const BandImage& image, const RenderSettings& settings, double pixel_mm,
            std::chrono::steady_clock::time_point start) {
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    exchange::PngPicture png = exchange::band_png(image);
    png.pixel_mm = pixel_mm;
    png.texts.emplace_back("Comment", "Sonoband. Research use only.");
    exchange::write_png(png, stage_.out / render.file);

    const auto coverage = image.coverage.view();
    std::int64_t covered = 0;
    for (int y = 0; y < coverage.height; ++y)
      covered += coverage.width - std::count(coverage.row(y), coverage.row(y) + coverage.width, 0);
    pictures_.push_back(
        {{"file", render.file},
         {"view", render.view},
         {"thickness_mm", settings.band.thickness_mm},
         {"layers", settings.band.layers()},
         {"compounding", word(settings.compounding)},
         {"interpolation", settings.interpolation == Interpolation::nearest ? "nearest" : "linear"},
         {"width", coverage.width},
         {"height", coverage.height},
         {"pixel_mm", pixel_mm},
         {"covered", static_cast<double>(covered) /
                         std::max<std::int64_t>(1, std::int64_t{coverage.width} * coverage.height)},
         {"ms", took.count()}});
    if (watch_) say(Json{{"picture", pictures_.back()}}.dump());
    std::printf("  %-32s %4d x %-4d %6.1f mm %-4s %8.2f ms\n", render.file.c_str(), coverage.width,
                coverage.height, settings.band.thickness_mm, word(settings.compounding), took.count());
  }

  const std::string& file_;
  Stage& stage_;
  int line_ = 0;
  std::vector<Sweep> sweeps_;
  Pixels mask_;  // of the last one that a picture was made of
  Json pictures_ = Json::array();
  std::optional<Watch> watch_;
  std::size_t sweeps_told_ = 0;
};

}  // namespace

Json run(const std::vector<Step>& steps, const std::string& file, Stage& stage) {
  Runner runner(file, stage);
  for (const Step& step : steps) runner(step);
  return runner.summary();
}

}  // namespace sonoband::script
