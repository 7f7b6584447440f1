#include "tools/export_movie.h"

#include <functional>

#include "app/exam/exam_reader.h"
#include "app/exchange/exam_turn.h"
#include "app/exchange/file_beside.h"
#include "app/workers.h"
#include "tools/argument_checks.h"
#include "tools/exam_verbs.h"

namespace sonoband::tools {

namespace {

namespace fs = std::filesystem;

exchange::TurnTable turn_of(const MovieOptions& options, const SweepView& view) {
  exchange::TurnTable turn;
  turn.axis = options.axis == "down" ? exchange::TurnAxis::down : exchange::TurnAxis::right;
  turn.pictures = options.pictures;
  turn.pictures_per_second = options.pictures_per_second;
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
  return turn;
}

fs::path write_turn(const MovieOptions& options, const fs::path& file, std::int64_t sweep,
                    const std::string& name, const fs::path& folder, std::vector<std::string>& damage) {
  fs::path path = folder / (name + "-turn.webm");
  Workers workers(threads_of(*options.render));
  WorkProgress progress("turning " + name);
  const auto turn = [&](const SweepView& view) { return turn_of(options, view); };
  exchange::write_stored_turn({file, sweep, name, turn}, path, workers, std::ref(progress), damage);
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
      ->check(number_between(1, 120))
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
