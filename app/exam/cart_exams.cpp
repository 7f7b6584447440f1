#include "app/exam/cart_exams.h"

#include <cassert>
#include <ctime>
#include <utility>

#include "app/exam/ring_sweep.h"

namespace sonoband::exam {
namespace {

constexpr std::int64_t look_around_ns = 250'000'000;  // for room on the disk and sweeps that are saved by now

bool in_trouble(const RecorderStatus& s) {
  return s.state == RecorderStatus::State::full || s.state == RecorderStatus::State::failing;
}

bool at_rest(const RecorderStatus& s) {
  return s.state == RecorderStatus::State::idle || s.state == RecorderStatus::State::saved;
}

SweepSetup copy_of(const SweepSetup& s) {
  SweepSetup copy;
  copy.width = s.width;
  copy.height = s.height;
  copy.kind = s.kind;
  copy.frames_per_second = s.frames_per_second;
  copy.probe_from_image = s.probe_from_image;
  copy.calibration_error_mm = s.calibration_error_mm;
  copy.calibration_name = s.calibration_name;
  copy.latency_offset = s.latency_offset;
  copy.crop = s.crop;
  copy.world = s.world;
  copy.mask = s.mask.copy();
  copy.versions = s.versions;
  return copy;
}

}  // namespace

CartExams::CartExams(CartExamsSettings settings)
    : settings_(std::move(settings)), folder_(settings_.place, ExamFolder::Use::cart, settings_.lock_wait) {
  assert(settings_.recorder.now);
  ::sem_init(&wake_, 0, 0);
  recorder_ = make_recorder();
  has_room_ = recorder_->has_room();
  thread_ = std::thread([this] { keep(); });
}

CartExams::~CartExams() {
  finish();
  ::sem_destroy(&wake_);
}

std::unique_ptr<Recorder> CartExams::make_recorder() {
  const ExamFolder::NewExam made = folder_.new_exam();
  RecorderSettings settings = settings_.recorder;
  settings.new_id = made.id;
  {
    const std::lock_guard lock(mutex_);
    id_ = made.id;
  }
  return std::make_unique<Recorder>(made.file, settings);
}

void CartExams::begin(const Sweep& sweep) {
  [[maybe_unused]] const bool taken = begun_.try_emplace(sweep);
  assert(taken);
  ::sem_post(&wake_);
}

void CartExams::ended() {
  save_now_.store(true, std::memory_order_release);
  ::sem_post(&wake_);
}

void CartExams::keep() {
  bool rested = true;
  while (!ending_.load(std::memory_order_acquire)) {
    timespec until{};
    ::clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += look_around_ns;
    if (until.tv_nsec >= 1'000'000'000) {
      until.tv_nsec -= 1'000'000'000;
      ++until.tv_sec;
    }
    ::sem_timedwait(&wake_, &until);
    take_wishes();
    take_sweeps();
    take_reviews();
    take_removals();
    let_go_of_saved();
    const RecorderStatus status = recorder_->status();
    has_room_.store(recorder_->has_room(), std::memory_order_relaxed);
    const bool rests = at_rest(status);
    if (rests && !rested) ask_for_list();
    rested = rests;
    read_list();
  }
  take_wishes();
  take_sweeps();
  take_reviews();
  take_removals();
}

void CartExams::take_sweeps() {
  while (const Sweep* sweep = begun_.front()) {
    SweepSetup setup = copy_of(settings_.sweep);
    setup.pressed = sweep->pressed();
    setup.pressed_utc_ns = utc_now_ns() - (settings_.recorder.now() - setup.pressed).count();
    recorder_->begin(std::make_shared<RingSweep>(*sweep, &readings_), std::move(setup));
    const std::lock_guard lock(mutex_);
    where_[sweep->id()] = {id_, ++begun_in_exam_};
    begun_.pop();
    used_ = true;
  }
  if (save_now_.exchange(false, std::memory_order_acq_rel)) recorder_->save_now();
}

void CartExams::take_wishes() {
  std::optional<std::string> label;
  bool used = false;
  {
    const std::lock_guard lock(mutex_);
    label = std::exchange(new_exam_, std::nullopt);
    used = used_;
  }
  if (label && used) {
    // A sweep begun before the wish belongs to the former exam.
    take_sweeps();
    begin_exam();
  }
  if (label) recorder_->set_label(*label);
}

// The present one becomes a former one.
void CartExams::begin_exam() {
  const std::string id = exam_id();
  std::unique_ptr<Recorder> next = make_recorder();
  const std::lock_guard lock(mutex_);
  former_.emplace(id, std::exchange(recorder_, std::move(next)));
  used_ = false;
  begun_in_exam_ = 0;
}

void CartExams::take_reviews() {
  std::deque<std::pair<std::string, ReviewObject>> reviews;
  {
    const std::lock_guard lock(mutex_);
    reviews.swap(reviews_);
  }
  for (auto& [exam, object] : reviews) {
    if (deleted_.contains(exam)) {
      const std::lock_guard lock(mutex_);
      --reviews_under_way_;
      continue;
    }
    std::unique_ptr<Recorder> opened;
    if (!former_.contains(exam)) {
      RecorderSettings settings = settings_.recorder;
      settings.new_id.clear();
      opened = std::make_unique<Recorder>(folder_.file_of(exam), settings);
    }
    const std::lock_guard lock(mutex_);
    if (opened) former_.emplace(exam, std::move(opened));
    tickets_[exam] = former_[exam]->add_review(std::move(object));
    --reviews_under_way_;
    reviewed_ = exam;
  }
}

void CartExams::take_removals() {
  std::deque<std::string> wishes;
  {
    const std::lock_guard lock(mutex_);
    wishes.swap(removals_);
  }
  for (const std::string& exam : wishes) {
    Removal answer = removal();
    ++answer.done;
    try {
      if (!exam.empty()) {
        answer.sentence = remove_now(exam);
        if (answer.sentence.empty()) answer.exam = exam;
      } else if (!answer.exam.empty()) {
        folder_.put_back(answer.exam);
        deleted_.erase(answer.exam);
        answer.exam.clear();
        answer.sentence.clear();
      }
    } catch (const StoreError& e) {
      answer.sentence = e.what();
    }
    const std::lock_guard lock(mutex_);
    removal_ = std::move(answer);
    list_wanted_ = true;
  }
  // The room of what was deleted is needed now.
  if (!recorder_->has_room() && !removal_.exam.empty()) {
    try {
      folder_.forget_deleted();
    } catch (const StoreError&) {
      return;  // the recorder says that there is no room
    }
    const std::lock_guard lock(mutex_);
    removal_.exam.clear();
  }
}

std::string CartExams::remove_now(const std::string& exam) {
  take_sweeps();
  const bool present = exam == exam_id();
  const auto former = former_.find(exam);
  Recorder* const writes = present                   ? recorder_.get()
                           : former == former_.end() ? nullptr
                                                     : former->second.get();
  if (writes != nullptr && !at_rest(writes->status()))
    return "This exam is still being saved: delete it when that is done.";
  if (present && used_) begin_exam();
  std::unique_ptr<Recorder> closing;
  {
    const std::lock_guard lock(mutex_);
    if (const auto f = former_.find(exam); f != former_.end()) {
      closing = std::move(f->second);
      former_.erase(f);
    }
  }
  if (closing) closing->finish();
  folder_.forget_deleted();
  folder_.set_aside(exam);
  deleted_.insert(exam);
  return {};
}

void CartExams::let_go_of_saved() {
  std::vector<std::unique_ptr<Recorder>> done;  // outside the lock: a recorder's end closes its exam
  const std::lock_guard lock(mutex_);
  for (auto f = former_.begin(); f != former_.end();) {
    // Of the one under review more changes are to come.
    const bool stays = f->first == reviewed_ || !at_rest(f->second->status());
    if (!stays) done.push_back(std::move(f->second));
    f = stays ? std::next(f) : former_.erase(f);
  }
}

void CartExams::read_list() {
  {
    const std::lock_guard lock(mutex_);
    if (!std::exchange(list_wanted_, false)) return;
  }
  std::shared_ptr<const std::vector<ExamSummary>> list;
  try {
    list = std::make_shared<const std::vector<ExamSummary>>(folder_.list());
  } catch (const StoreError&) {
    return;  // the recorder's status says what is wrong with the disk; the old list stays
  }
  const std::lock_guard lock(mutex_);
  list_ = std::move(list);
}

RecorderStatus CartExams::status() const {
  const std::lock_guard lock(mutex_);
  for (const auto& [id, former] : former_)
    if (RecorderStatus s = former->status(); in_trouble(s)) return s;
  return recorder_->status();
}

std::string CartExams::exam_id() const {
  const std::lock_guard lock(mutex_);
  return id_;
}

std::shared_ptr<const std::vector<ExamSummary>> CartExams::list() const {
  const std::lock_guard lock(mutex_);
  return list_;
}

void CartExams::ask_for_list() {
  {
    const std::lock_guard lock(mutex_);
    list_wanted_ = true;
  }
  ::sem_post(&wake_);
}

void CartExams::new_exam(std::string label) {
  {
    const std::lock_guard lock(mutex_);
    new_exam_ = std::move(label);
  }
  ::sem_post(&wake_);
}

std::optional<StoredSweep> CartExams::where(std::int32_t sweep) const {
  const std::lock_guard lock(mutex_);
  const auto found = where_.find(sweep);
  return found == where_.end() ? std::nullopt : std::optional(found->second);
}

void CartExams::add_review(const std::string& exam, ReviewObject object) {
  {
    const std::lock_guard lock(mutex_);
    if (exam == id_) {
      used_ = true;
      tickets_[exam] = recorder_->add_review(std::move(object));
      return;
    }
    reviews_.emplace_back(exam, std::move(object));
    ++reviews_under_way_;
  }
  ::sem_post(&wake_);
}

bool CartExams::review_saved(const std::string& exam) const {
  const std::lock_guard lock(mutex_);
  if (reviews_under_way_ > 0) return false;
  const auto ticket = tickets_.find(exam);
  if (ticket == tickets_.end()) return true;
  const auto former = former_.find(exam);
  const Recorder* const writes = exam == id_               ? recorder_.get()
                                 : former == former_.end() ? nullptr  // let go of once it had saved
                                                           : former->second.get();
  return writes == nullptr || writes->status().reviews_saved >= ticket->second;
}

void CartExams::remove(std::string exam) {
  {
    const std::lock_guard lock(mutex_);
    removals_.push_back(std::move(exam));
  }
  ::sem_post(&wake_);
}

void CartExams::put_back() {
  remove({});
}

CartExams::Removal CartExams::removal() const {
  const std::lock_guard lock(mutex_);
  return removal_;
}

void CartExams::finish() {
  if (!thread_.joinable()) return;
  ending_.store(true, std::memory_order_release);
  ::sem_post(&wake_);
  thread_.join();
  for (const auto& [id, former] : former_) former->finish();
  recorder_->finish();
  try {
    folder_.forget_deleted();
  } catch (const StoreError&) {
    // The next start does it.
  }
  list_wanted_ = true;
  read_list();
}

}  // namespace sonoband::exam
