#include "app/screen/exam_shelf.h"

#include <algorithm>
#include <array>
#include <ctime>

namespace sonoband {
namespace {

constexpr std::size_t most_cards = 64;  // pictures kept: some 20 MB
constexpr int rows_in_sight = 12;       // at most, on any screen

std::string local_time(std::int64_t utc_ns) {
  const auto at = static_cast<std::time_t>(utc_ns / 1'000'000'000);
  std::tm parts{};
  ::localtime_r(&at, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%d %b %Y, %H:%M:%S", &parts);
  return text.data();
}

// Frames, and what keeps them alive.
struct Loaded {
  std::shared_ptr<exam::SweepLoader> loader;
  std::vector<const TrackedFrame*> frames;
};

}  // namespace

HeldSweep held_of(const std::shared_ptr<exam::SweepLoader>& loader) {
  auto loaded = std::make_shared<Loaded>();
  loaded->loader = loader;
  for (std::int64_t i = 0; i < loader->total(); ++i)
    if (loader->ready(i) && !loader->stored(i).record.pre_roll &&
        loader->frame(i).pose_status == PoseStatus::ok)
      loaded->frames.push_back(&loader->frame(i));
  HeldSweep held;
  held.view = {loaded->frames, loader->mask()};
  held.keeper = std::move(loaded);
  return without_drawings(std::move(held));
}

ExamShelf::ExamShelf(exam::CartExams& exams, std::function<void()> news)
    : exams_(exams), news_(std::move(news)), thread_([this] { serve(); }) {}

ExamShelf::~ExamShelf() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

bool ExamShelf::listen() {
  bool news = false;
  {
    const std::lock_guard lock(mutex_);
    news = std::exchange(news_waits_, false);
  }
  const auto list = exams_.list();
  if (!list || list == list_) return news;
  list_ = list;
  std::map<std::string, Row> former;
  for (Row& row : rows_) former[row.exam.id] = std::move(row);
  rows_.clear();
  for (const exam::ExamSummary& exam : *list) {
    Row row;
    row.exam = exam;
    row.id = ids_.try_emplace(exam.id, ids_.size() + 1).first->second;
    row.when = exam.created_utc_ns != 0 ? local_time(exam.created_utc_ns) : exam.id;
    row.sweep = static_cast<int>(exam.sweeps);
    if (const auto f = former.find(exam.id); f != former.end()) {
      // A new sweep is the one meant; else the choice stays.
      if (f->second.exam.sweeps == exam.sweeps) row.sweep = f->second.sweep;
      if (f->second.exam.frames != exam.frames) forget_cards(exam.id);
    }
    row.recovered = exam::was_cut_off(exams_.recovered(), exam.id);
    rows_.push_back(std::move(row));
  }
  if (find(selected_) == nullptr) selected_ = 0;
  return true;
}

void ExamShelf::forget_cards(const std::string& exam) {
  const std::lock_guard lock(mutex_);
  std::erase_if(cards_, [&](const auto& known) { return known.first.first == exam; });
}

const ExamShelf::Row* ExamShelf::find(std::uint64_t id) const {
  const auto row = std::find_if(rows_.begin(), rows_.end(), [&](const Row& r) { return r.id == id; });
  return row == rows_.end() ? nullptr : &*row;
}

std::shared_ptr<const SweepCard> ExamShelf::card(const Row& row) {
  if (row.sweep < 1 || !row.exam.damage.empty()) return nullptr;
  const SweepKey key{row.exam.id, row.sweep};
  const std::lock_guard lock(mutex_);
  const auto known = cards_.find(key);
  if (known != cards_.end()) return known->second;
  if (cards_.size() >= most_cards) cards_.clear();
  cards_[key] = nullptr;
  jobs_.push_back({key, row.exam.path, false});
  wake_.notify_all();
  return nullptr;
}

void ExamShelf::fill(ui::ExamsView& view, const std::optional<SweepKey>& shown, bool recording) {
  views_.clear();
  cards_shown_.clear();
  const std::string present = exams_.exam_id();
  const int last = first_ + rows_in_sight;
  for (int i = 0; i < static_cast<int>(rows_.size()); ++i) {
    const Row& row = rows_[i];
    ui::ExamView e;
    e.id = row.id;
    e.label = row.exam.label;
    e.when = row.when;
    e.sweeps = static_cast<int>(row.exam.sweeps);
    e.sweep = row.sweep;
    e.frames = static_cast<int>(row.exam.frames);
    e.damage = row.exam.damage;
    e.open = shown && shown->first == row.exam.id;
    if (recording && row.exam.id == present) e.state = ui::ExamState::recording;
    if (row.recovered) e.state = ui::ExamState::recovered;
    if (!row.exam.damage.empty()) e.state = ui::ExamState::damaged;
    if (i >= first_ && i < last) {
      if (auto c = card(row)) {
        e.frames = static_cast<int>(c->frames);
        e.seconds = c->seconds;
        if (!c->picture.view().empty()) e.picture = {c->picture.view(), {}, c->kind, c->version};
        cards_shown_.push_back(std::move(c));
      }
    }
    views_.push_back(e);
  }
  view.exams = views_;
  view.selected = selected_;
  view.first = first_;
  view.can_undo_delete = !exams_.removal().exam.empty();
}

void ExamShelf::choose_sweep(int by) {
  for (Row& row : rows_)
    if (row.id == selected_)
      row.sweep = std::clamp(row.sweep + by, 1, std::max(1, static_cast<int>(row.exam.sweeps)));
}

bool ExamShelf::select(const SweepKey& key) {
  for (Row& row : rows_) {
    if (row.exam.id != key.first || key.second > row.exam.sweeps) continue;
    row.sweep = static_cast<int>(key.second);
    selected_ = row.id;
    return true;
  }
  return false;
}

void ExamShelf::scroll(int by) {
  first_ = std::clamp(first_ + by, 0, std::max(0, static_cast<int>(rows_.size()) - 1));
}

std::optional<SweepKey> ExamShelf::key_of(std::uint64_t id) const {
  const Row* row = find(id);
  return row == nullptr ? std::nullopt : std::optional(SweepKey{row->exam.id, row->sweep});
}

std::filesystem::path ExamShelf::file_of(std::uint64_t id) const {
  const Row* row = find(id);
  return row == nullptr ? std::filesystem::path{} : std::filesystem::path(row->exam.path);
}

void ExamShelf::open(const SweepKey& key) {
  const auto row =
      std::find_if(rows_.begin(), rows_.end(), [&](const Row& r) { return r.exam.id == key.first; });
  if (row == rows_.end()) return;
  const std::lock_guard lock(mutex_);
  // Before any picture that still waits.
  jobs_.push_front({key, row->exam.path, true});
  ++opening_;
  wake_.notify_all();
}

std::optional<OpenedSweep> ExamShelf::take_opened() {
  const std::lock_guard lock(mutex_);
  return std::exchange(opened_, std::nullopt);
}

bool ExamShelf::opening() const {
  const std::lock_guard lock(mutex_);
  return opening_ > 0;
}

void ExamShelf::serve() {
  for (;;) {
    Job job;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return ending_ || !jobs_.empty(); });
      if (ending_) return;
      job = std::move(jobs_.front());
      jobs_.pop_front();
    }
    if (job.open) {
      OpenedSweep opened = read_sweep(job);
      const std::lock_guard lock(mutex_);
      opened_ = std::move(opened);
      --opening_;
      news_waits_ = true;
    } else {
      auto card = std::make_shared<SweepCard>(read_card(job));
      const std::lock_guard lock(mutex_);
      card->version = ++pictures_;
      cards_[job.key] = std::move(card);
      news_waits_ = true;
    }
    if (news_) news_();
  }
}

SweepCard ExamShelf::read_card(const Job& job) const {
  SweepCard card;
  try {
    const exam::ExamReader reader(job.file);
    const exam::StoredFrames index = reader.frames(job.key.second);
    std::vector<const exam::StoredFrame*> swept;
    for (const exam::StoredFrame& f : index.frames)
      if (!f.record.pre_roll) swept.push_back(&f);
    card.frames = static_cast<std::int64_t>(swept.size());
    if (swept.empty()) return card;
    card.seconds = seconds(swept.back()->record.captured - swept.front()->record.captured);
    const exam::StoredFrame& middle = *swept[swept.size() / 2];
    Pixels picture(middle.record.pixels.width, middle.record.pixels.height);
    card.kind = middle.record.kind;
    if (reader.pixels(job.key.second, middle, picture.view()).empty()) card.picture = std::move(picture);
  } catch (const exam::StoreError&) {
    // A row without a picture; opening it says what is wrong.
  }
  return card;
}

OpenedSweep ExamShelf::read_sweep(const Job& job) {
  OpenedSweep opened;
  opened.key = job.key;
  try {
    const exam::ExamReader reader(job.file);
    const exam::ExamSummary summary = reader.summary();
    opened.label = summary.label;
    opened.when = local_time(summary.created_utc_ns);
    std::vector<std::string> damage;
    opened.review = reader.review(damage);
    if (!damage.empty()) opened.trouble = damage.front();
    std::int64_t frames = 0;
    for (const exam::SweepSummary& s : reader.sweeps())
      if (s.id == job.key.second) frames = s.frames;
    opened.loader = std::make_shared<exam::SweepLoader>(job.file, job.key.second, frames / 2);
  } catch (const exam::StoreError& e) {
    opened.loader.reset();
    opened.trouble = e.what();
  }
  return opened;
}

}  // namespace sonoband
