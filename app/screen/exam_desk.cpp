#include "app/screen/exam_desk.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

namespace sonoband {
namespace {

// Sweeps that this run has not recorded are numbered from here; the ring's ids are small.
constexpr std::uint64_t first_opened_id = std::uint64_t{1} << 31;
constexpr Duration grow_every = std::chrono::milliseconds(300);

constexpr std::array<const char*, 5> window_names = {"screen", "review", "reslice", "manifold", "outline"};

}  // namespace

ExamDesk::ExamDesk(exam::CartExams& exams, Session& session, const ExporterSettings& exports,
                   const std::function<void()>& news)
    : exams_(exams), session_(session), shelf_(exams, news), export_(exams, session, shelf_, exports, news) {}

ExamDesk::~ExamDesk() {
  save_review({}, true);
}

std::optional<SweepKey> ExamDesk::key_of(std::uint64_t sweep) {
  if (const auto known = keys_.find(sweep); known != keys_.end()) return known->second;
  if (sweep == 0 || sweep >= first_opened_id) return std::nullopt;
  const auto stored = exams_.where(static_cast<std::int32_t>(sweep));
  if (!stored) return std::nullopt;
  const SweepKey key{stored->exam, stored->sweep};
  keys_[sweep] = key;
  ids_[key] = sweep;
  return key;
}

std::uint64_t ExamDesk::id_of(const SweepKey& key) {
  const auto [known, fresh] = ids_.try_emplace(key, first_opened_id + ids_.size());
  if (fresh) keys_[known->second] = key;
  return known->second;
}

void ExamDesk::save_review(Stamp now, bool all) {
  for (const std::uint64_t sweep : session_.take_changed(now, all)) {
    const auto key = key_of(sweep);
    if (!key) {
      session_.note_change(sweep);
      continue;
    }
    for (exam::ReviewObject& o : logs_[sweep].changes(objects_of(session_.review_of(sweep), key->second))) {
      o.written_utc_ns = exam::utc_now_ns();
      exams_.add_review(key->first, std::move(o));
    }
  }
}

void ExamDesk::open(const SweepKey& key) {
  // As it is in memory it is shown at once, with changes that are on their way to the disk.
  for (const RunSweep& s : session_.sweeps()) key_of(s.id);
  key_of(session_.shown_id());
  if (const auto known = ids_.find(key); known != ids_.end() && session_.show_again(known->second)) return;
  shelf_.open(key);
}

void ExamDesk::take_opened() {
  auto opened = shelf_.take_opened();
  if (!opened) return;
  if (!opened->loader) return session_.say("It does not open: " + opened->trouble, std::chrono::seconds(10));
  HeldSweep held = held_of(opened->loader);
  if (held.view.frames.empty()) {
    // The first picture is damaged or has no place; perhaps the others are there.
    opened->loader->wait();
    held = held_of(opened->loader);
  }
  if (held.view.frames.empty())
    return session_.say("No B-scan of that sweep has a place in space, so there is nothing to show.");
  const std::uint64_t id = id_of(opened->key);
  std::vector<std::string> refused;
  const SweepReview review = review_of(opened->review, opened->key.second, refused);
  if (!logs_.contains(id)) logs_[id].know(objects_of(review, opened->key.second));
  RunSweep sweep;
  sweep.held = std::move(held);
  sweep.id = id;
  sweep.label = opened->label;
  sweep.when = opened->when;
  session_.open(std::move(sweep), review);
  if (!refused.empty()) opened->trouble = refused.front();
  if (!opened->trouble.empty()) session_.say(opened->trouble, std::chrono::seconds(10));
  loading_ = Loading{id, opened->loader, 0, std::nullopt};
}

bool ExamDesk::load_on(Stamp now) {
  if (!loading_) return false;
  if (loading_->id != session_.shown_id()) {
    loading_.reset();  // and with it, perhaps, the loading
    return false;
  }
  const std::int64_t visited = loading_->loader->visited();
  const bool done = visited == loading_->loader->total();
  if (!done && (visited == loading_->shown || (loading_->next && now < *loading_->next))) return false;
  loading_->shown = visited;
  loading_->next = now + grow_every;
  session_.grow_opened(held_of(loading_->loader));
  if (!done) {
    session_.say("Loading: " + std::to_string(visited * 100 / loading_->loader->total()) + " %");
    return true;
  }
  const std::vector<std::string> damage = loading_->loader->damage();
  if (!damage.empty())
    session_.say(std::to_string(damage.size()) + " pictures are damaged and left out: " + damage.front(),
                 std::chrono::seconds(10));
  loading_.reset();
  return true;
}

bool ExamDesk::listen(Stamp now) {
  bool news = shelf_.listen() || std::exchange(changed_, false);
  take_opened();
  news = load_on(now) || news;
  save_review(now, false);
  news = export_.listen(now) || news;
  const exam::CartExams::Removal removal = exams_.removal();
  if (removal.done != removals_answered_) {
    removals_answered_ = removal.done;
    if (!removal.sentence.empty()) session_.say(removal.sentence);
    news = true;
  }
  return news;
}

void ExamDesk::fill(ui::ExamsView& view, bool recording) {
  view.on_disk = true;
  shelf_.fill(view, key_of(session_.shown_id()), recording);
  export_.fill(view.transfer);
}

void ExamDesk::remove(const std::string& exam) {
  for (const RunSweep& s : session_.sweeps()) key_of(s.id);
  key_of(session_.shown_id());
  // The store keeps it while the deletion can be undone; it comes back from there.
  save_review({}, true);
  exams_.remove(exam);
  for (auto known = ids_.begin(); known != ids_.end();) {
    if (known->first.first != exam) {
      ++known;
      continue;
    }
    session_.forget(known->second);
    logs_.erase(known->second);
    keys_.erase(known->second);
    known = ids_.erase(known);
  }
}

bool ExamDesk::carry_out(const ui::Command& command) {
  namespace c = ui::command;
  if (const auto* to = std::get_if<c::GoTo>(&command)) {
    if (to->page == ui::Page::exams) exams_.ask_for_list();
    return false;
  }
  if (const auto* sheet = std::get_if<c::OpenSheet>(&command)) {
    if (sheet->sheet != ui::Sheet::export_exam || export_.open(key_of(session_.shown_id()))) return false;
    exams_.ask_for_list();
    session_.say("This sweep is still being saved: try again in a moment.");
    return true;
  }
  // What was just drawn goes along.
  if (std::holds_alternative<c::StartExport>(command)) save_review({}, true);
  if (export_.carry_out(command)) return true;
  if (std::holds_alternative<c::NewExam>(command)) {
    exams_.new_exam(session_.typed_label());
    return false;
  }
  if (const auto* select = std::get_if<c::SelectExam>(&command)) {
    shelf_.select(select->id);
  } else if (const auto* choose = std::get_if<c::ChooseSweep>(&command)) {
    shelf_.choose_sweep(choose->by);
  } else if (const auto* scroll = std::get_if<c::ScrollExams>(&command)) {
    shelf_.scroll(scroll->by);
  } else if (const auto* opens = std::get_if<c::OpenExam>(&command)) {
    shelf_.select(opens->id);
    if (const auto key = shelf_.key_of(opens->id)) open(*key);
  } else if (const auto* removes = std::get_if<c::DeleteExam>(&command)) {
    if (const auto key = shelf_.key_of(removes->id)) remove(key->first);
  } else if (std::holds_alternative<c::UndoDelete>(command)) {
    exams_.put_back();
  } else {
    return false;
  }
  changed_ = true;
  return true;
}

void ExamDesk::keep_snapshot(const std::filesystem::path& png, ui::Window window) {
  const std::uint64_t sweep = session_.shown_id();
  const auto key = key_of(sweep);
  if (!key) return;
  std::ifstream in(png, std::ios::binary);
  exam::ReviewObject o;
  o.written_utc_ns = exam::utc_now_ns();
  o.kind = exam::ReviewKind::snapshot;
  o.object = "sweep" + std::to_string(key->second) + "/snapshot-" + std::to_string(o.written_utc_ns);
  o.json = nlohmann::ordered_json({{"window", window_names[static_cast<std::size_t>(window)]},
                                   {"sweep", key->second},
                                   {"note", "Research use only."}})
               .dump();
  o.png.assign(std::istreambuf_iterator<char>(in), {});
  exams_.add_review(key->first, std::move(o));
}

}  // namespace sonoband
