#include "app/exchange/exam_turn.h"

#include <chrono>
#include <thread>

#include "app/bad_input.h"
#include "app/exam/sweep_loader.h"
#include "core/sweep/drawings.h"

namespace sonoband::exchange {
namespace {

constexpr int reading_permille = 100;
constexpr auto look_every = std::chrono::milliseconds(20);

// Until all is read that can be.
void read(const exam::SweepLoader& loader, const std::filesystem::path& path, const Progress& progress) {
  while (!loader.done()) {
    const auto permille = static_cast<int>(reading_permille * loader.visited() / loader.total());
    if (progress && !progress(permille))
      throw BadInput(path.string() + ": stopped before the movie was begun; nothing of it is there");
    std::this_thread::sleep_for(look_every);
  }
}

}  // namespace

TurnTable whole_turn(const SweepView& sweep, const RenderSettings& settings) {
  TurnTable turn;
  turn.settings = settings;
  turn.settings.band.step_mm = pixel_width_mm(sweep);
  if (const auto plane = turn_table_plane(sweep, turn.axis)) turn.plane = *plane;
  return turn;
}

void write_stored_turn(const StoredTurn& what, const std::filesystem::path& path, Parallel& parallel,
                       const Progress& progress, std::vector<std::string>& damage) {
  const exam::SweepLoader loader(what.exam, what.sweep);
  read(loader, path, progress);
  std::vector<const TrackedFrame*> swept;
  for (std::int64_t i = 0; i < loader.total(); ++i)
    if (loader.ready(i) && !loader.stored(i).record.pre_roll && loader.frame(i).pose_status == PoseStatus::ok)
      swept.push_back(&loader.frame(i));
  for (const std::string& d : loader.damage()) damage.push_back(d);
  if (swept.empty())
    throw BadInput(
        what.name +
        ": no frame of it has a place in space, so there is nothing to turn; export its B-scans as a "
        "movie (webm)");
  const Pixels mask = mask_without_drawings({swept, loader.mask()});
  const SweepView view{swept, mask.view()};
  Progress turning;
  if (progress)
    turning = [&progress](int permille) {
      return progress(reading_permille + permille * (1000 - reading_permille) / 1000);
    };
  write_turn_table(view, what.turn(view), what.name, path, parallel, turning);
}

}  // namespace sonoband::exchange
