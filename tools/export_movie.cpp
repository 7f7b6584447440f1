#include "tools/export_movie.h"

#include <functional>

#include "app/exam/exam_reader.h"
#include "app/exam/sweep_loader.h"
#include "app/exchange/exam_movie.h"
#include "app/exchange/file_beside.h"
#include "app/workers.h"
#include "tools/exam_verbs.h"

namespace sonoband::tools {

namespace {

namespace fs = std::filesystem;

fs::path write_turn(const MovieOptions& options, const fs::path& file, std::int64_t sweep,
                    const std::string& name, const fs::path& folder, std::vector<std::string>& damage) {
  exam::SweepLoader loader(file, sweep);
  loader.wait();
  // As on the cart: what was recorded before the press is kept, and not painted.
  std::vector<const TrackedFrame*> swept;
  for (std::int64_t i = 0; i < loader.total(); ++i)
    if (loader.ready(i) && !loader.stored(i).record.pre_roll && loader.frame(i).pose_status == PoseStatus::ok)
      swept.push_back(&loader.frame(i));
  for (const std::string& d : loader.damage()) damage.push_back(d);
  const SweepView view{swept, loader.mask()};
  exchange::TurnTable turn;
  turn.axis = options.axis == "down" ? exchange::TurnAxis::down : exchange::TurnAxis::right;
  turn.pictures = options.pictures;
  turn.pictures_per_second = options.pictures_per_second;
  fs::path path = folder / (name + "-turn.webm");
  if (swept.empty())
    throw BadInput(name +
                   ": no frame of it has a place in space, so there is nothing to turn; export it without "
                   "--turn-table");
  turn.settings = settings_of(*options.render, pixel_width_mm(view));
  if (options.plane->origin.empty()) {
    turn.plane = *exchange::turn_table_plane(view, turn.axis);
    if (options.plane->pixel_mm > 0) {
      const double scale = turn.plane.pixel_mm / options.plane->pixel_mm;
      turn.plane.width = std::max(1, static_cast<int>(turn.plane.width * scale));
      turn.plane.height = std::max(1, static_cast<int>(turn.plane.height * scale));
      turn.plane.pixel_mm = options.plane->pixel_mm;
    }
  } else {
    turn.plane = choose_plane(*options.plane, view).plane;
  }
  check_picture_size(turn.plane, turn.settings.band);
  Workers workers(threads_of(*options.render));
  WorkProgress progress("turning " + name);
  exchange::write_turn_table(view, turn, name, path, workers, std::ref(progress));
  return path;
}

}  // namespace

std::shared_ptr<MovieOptions> add_movie_options(CLI::App& verb) {
  auto o = std::make_shared<MovieOptions>();
  CLI::Option* turn = verb.add_flag("--turn-table", o->turn_table,
                                    "webm: not the B-scans but the band on a plane that turns once")
                          ->group("Movie");
  verb.add_option("--turn-axis", o->axis,
                  "Axis of the plane through its middle that it turns about: down or right")
      ->check(CLI::IsMember({"down", "right"}))
      ->needs(turn)
      ->capture_default_str()
      ->group("Movie");
  verb.add_option("--pictures", o->pictures, "Pictures of the whole turn")
      ->check(CLI::Range(2, 3600))
      ->needs(turn)
      ->capture_default_str()
      ->group("Movie");
  verb.add_option("--per-second", o->pictures_per_second, "Pictures a second")
      ->check(CLI::Range(1.0, 120.0))
      ->needs(turn)
      ->capture_default_str()
      ->group("Movie");
  o->plane = add_plane_options(verb);
  o->render = add_render_options(verb);
  add_band_options(verb, o->render);
  return o;
}

void check_movie_options(const MovieOptions& options) {
  check_plane_options(*options.plane);
  settings_of(*options.render, 1);
}

exchange::ExportedExam write_turns(const MovieOptions& options, const fs::path& file,
                                   const exchange::ExamExport& what) {
  std::error_code error;
  fs::create_directories(what.to, error);
  if (error) throw BadInput(exchange::why_unwritable(what.to, error.value()));
  exchange::ExportedExam out;
  for (const exam::SweepSummary& s : exam::ExamReader(file).sweeps()) {
    if (what.sweep != 0 && s.id != what.sweep) continue;
    const std::string name = file.stem().string() + "-sweep" + std::to_string(s.id);
    out.files.push_back(write_turn(options, file, s.id, name, what.to, out.damage));
  }
  if (out.files.empty())
    throw BadInput(file.filename().string() + ": there is no sweep " + std::to_string(what.sweep) + " in it");
  return out;
}

}  // namespace sonoband::tools
