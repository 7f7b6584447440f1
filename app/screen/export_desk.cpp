#include "app/screen/export_desk.h"

#include <algorithm>
#include <array>
#include <utility>

namespace sonoband {
namespace {

using exchange::ExportFormat;
using ui::ExportPhase;

constexpr Duration look_every = std::chrono::seconds(1);  // for sticks, while the sheet is open

// In the order of ui::ExportAs.
constexpr std::array<ExportFormat, 9> formats = {
    ExportFormat::mha, ExportFormat::nrrd, ExportFormat::sx,   ExportFormat::sw,    ExportFormat::dicom,
    ExportFormat::png, ExportFormat::webm, ExportFormat::turn, ExportFormat::review};

}  // namespace

ExportDesk::ExportDesk(exam::CartExams& exams, Session& session, ExamShelf& shelf, ExporterSettings settings,
                       std::function<void()> news)
    : exams_(exams), session_(session), shelf_(shelf), exporter_(std::move(settings), std::move(news)) {}

bool ExportDesk::listen(Stamp now) {
  const bool open = session_.sheet() == ui::Sheet::export_exam;
  if (open && (!next_look_ || now >= *next_look_)) {
    next_look_ = now + look_every;
    exporter_.look();
  }
  if (exporter_.version() != state_.version) {
    const ExportPhase before = state_.phase;
    state_ = exporter_.state();
    // Whoever has closed the sheet hears of it all the same.
    if (!open && state_.phase != before) say_outcome();
    changed_ = true;
  }
  const int permille = exporter_.permille();
  return std::exchange(shown_permille_, permille) != permille || std::exchange(changed_, false);
}

void ExportDesk::say_outcome() {
  constexpr Duration long_enough = std::chrono::seconds(10);
  if (state_.phase == ExportPhase::done)
    session_.say("Exported to " + state_.where + ". " + state_.sentence, long_enough);
  if (state_.phase == ExportPhase::failed)
    session_.say("The export did not succeed: " + state_.sentence, long_enough);
  if (state_.phase == ExportPhase::removed) session_.say(state_.where + " can be pulled now.", long_enough);
}

void ExportDesk::fill(ui::ExportView& view) {
  places_.clear();
  int chosen = 0;
  for (const exchange::Place& p : state_.places) {
    if (p.path == place_) chosen = static_cast<int>(places_.size());
    places_.push_back({p.label, p.removable});
  }
  view.places = places_;
  view.choice = choice_;
  view.choice.place = chosen;
  view.phase = state_.phase;
  view.done = exporter_.permille() / 1000.0;
  view.files = state_.files;
  view.where = state_.where;
  view.sentence = state_.sentence;
}

bool ExportDesk::open(const std::optional<SweepKey>& shown) {
  exporter_.look();
  exporter_.forget();
  if (session_.page() != ui::Page::review) {
    choice_.one_sweep = false;
    return true;
  }
  choice_.one_sweep = true;
  return shown && shelf_.select(*shown);
}

void ExportDesk::choose(const ui::ExportChoice& choice) {
  choice_ = choice;
  if (choice.place >= 0 && choice.place < static_cast<int>(state_.places.size()))
    place_ = state_.places[static_cast<std::size_t>(choice.place)].path;
  exporter_.forget();
}

void ExportDesk::start(std::uint64_t row) {
  const auto key = shelf_.key_of(row);
  if (!key || state_.places.empty()) return;
  const auto chosen = std::find_if(state_.places.begin(), state_.places.end(),
                                   [&](const exchange::Place& p) { return p.path == place_; });
  // The one that was chosen may have been pulled: then none of the others is meant.
  if (chosen == state_.places.end() && !place_.empty()) {
    place_.clear();
    return session_.say("That place is no longer there: choose another.");
  }
  const exchange::Place& place = chosen == state_.places.end() ? state_.places.front() : *chosen;
  ExportJob job;
  job.exam = shelf_.file_of(row);
  job.what.to = place.path / ("sonoband-" + key->first);
  job.what.format = formats[static_cast<std::size_t>(choice_.format)];
  job.what.sweep = choice_.one_sweep ? key->second : 0;
  job.what.band = session_.settings();
  job.what.with_label = choice_.with_label && choice_.format == ui::ExportAs::dicom;
  job.saved = [&exams = exams_, exam = key->first] { return exams.review_saved(exam); };
  if (!exporter_.start(std::move(job))) session_.say("Another export still runs: wait for it or cancel it.");
}

bool ExportDesk::carry_out(const ui::Command& command) {
  namespace c = ui::command;
  if (const auto* chooses = std::get_if<c::ChooseExport>(&command)) {
    choose(chooses->choice);
  } else if (const auto* starts = std::get_if<c::StartExport>(&command)) {
    start(starts->id);
  } else if (std::holds_alternative<c::CancelExport>(command)) {
    exporter_.cancel();
  } else if (const auto* removes = std::get_if<c::RemoveSafely>(&command)) {
    if (removes->place >= 0 && removes->place < static_cast<int>(state_.places.size()))
      static_cast<void>(exporter_.take_away(state_.places[static_cast<std::size_t>(removes->place)]));
  } else {
    return false;
  }
  changed_ = true;
  return true;
}

}  // namespace sonoband
