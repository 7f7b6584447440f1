#include "app/exam/recorder.h"

#include <algorithm>
#include <utility>

namespace sonoband::exam {
namespace {

// Of one transaction: bounds what a failed one costs to repeat, and how long `finished` goes unseen.
constexpr std::int64_t frames_at_once = 128;
constexpr std::size_t poses_at_once = 4096;
// Raw readings wait here when the disk is in trouble: an hour at 240 a second.
constexpr std::size_t most_poses_waiting = 900'000;
constexpr Duration between_room_measures = std::chrono::seconds(1);

// The recorder's own waiting is on this clock, whatever the frames are stamped by.
Stamp steady_now() {
  return Stamp(std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch()));
}

}  // namespace

Recorder::Recorder(const std::filesystem::path& exam, const RecorderSettings& settings)
    : exam_(exam),
      settings_(settings),
      made_(settings.new_id.empty()),
      bytes_per_second_(settings.bytes_per_second) {
  measure_room();  // before anybody may ask to begin
  thread_ = std::thread([this] { run(); });
}

Recorder::~Recorder() {
  finish();
}

void Recorder::finish() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
  jobs_.clear();
}

Stamp Recorder::now() const {
  return settings_.now ? settings_.now() : steady_now();
}

void Recorder::begin(std::shared_ptr<SweepSource> source, SweepSetup setup) {
  auto job = std::make_shared<Job>();
  job->source = std::move(source);
  job->setup = std::move(setup);
  {
    const std::lock_guard lock(mutex_);
    new_jobs_.push_back(std::move(job));
    now_ = true;
    if (status_.state != RecorderStatus::State::full && status_.state != RecorderStatus::State::failing)
      status_.state = RecorderStatus::State::recording;
  }
  wake_.notify_all();
}

void Recorder::save_now() {
  {
    const std::lock_guard lock(mutex_);
    now_ = true;
  }
  wake_.notify_all();
}

std::uint64_t Recorder::add_review(ReviewObject object) {
  std::uint64_t ticket = 0;
  {
    const std::lock_guard lock(mutex_);
    new_reviews_.push_back(std::move(object));
    ticket = ++tickets_;
    now_ = true;
  }
  wake_.notify_all();
  return ticket;
}

void Recorder::set_label(std::string label) {
  const std::lock_guard lock(mutex_);
  new_label_ = std::move(label);
}

RecorderStatus Recorder::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void Recorder::run() {
  Stamp give_up{};
  for (;;) {
    bool in_trouble = false;
    bool ending = false;
    {
      std::unique_lock lock(mutex_);
      in_trouble =
          status_.state == RecorderStatus::State::full || status_.state == RecorderStatus::State::failing;
      const Duration wait = in_trouble                           ? settings_.retry
                            : jobs_.empty() && new_jobs_.empty() ? between_room_measures
                                                                 : settings_.batch;
      const auto called = [&] { return ending_ || (now_ && !in_trouble); };
      if (!called()) wake_.wait_for(lock, wait, called);
      now_ = false;
      ending = ending_;
      std::move(new_jobs_.begin(), new_jobs_.end(), std::back_inserter(jobs_));
      new_jobs_.clear();
      std::move(new_reviews_.begin(), new_reviews_.end(), std::back_inserter(reviews_));
      new_reviews_.clear();
      if (new_label_) label_ = std::exchange(new_label_, std::nullopt);
    }
    if (ending && give_up == Stamp{}) give_up = steady_now() + settings_.goodbye;
    bool well = true;
    try {
      work();
    } catch (const StoreError& e) {
      well = false;
      trouble(e);
    }
    if (steady_now() - room_measured_ > between_room_measures) measure_room();
    tell();
    if (!ending) continue;
    // Whoever ends has released the pedal: a sweep that still grows is closed by the next start.
    const bool waits = std::any_of(jobs_.begin(), jobs_.end(), [](const auto& j) {
      return j->source->finished() || j->stored < j->source->published();
    });
    if ((well && !waits && reviews_.empty()) || steady_now() > give_up) break;
    if (!well)
      std::this_thread::sleep_for(std::min<Duration>(settings_.retry, std::chrono::milliseconds(200)));
  }
  try {
    if (writer_ && jobs_.empty()) writer_->close();
  } catch (const StoreError&) {
    // The journal keeps what was saved; the next start completes it.
  }
}

void Recorder::connect() {
  if (writer_) return;
  if (!made_ && !std::filesystem::exists(exam_)) {
    ExamWriter::create(exam_, settings_.new_id, settings_.vfs).close();
  }
  made_ = true;
  writer_.emplace(ExamWriter::open(exam_, settings_.vfs));
  next_sweep_ = writer_->next_sweep();
  // A commit whose answer was lost may have happened.
  for (const auto& job : jobs_) {
    if (!job->begun) continue;
    job->stored = writer_->stored_frames(job->sweep);
    const std::int64_t poses = writer_->stored_poses(job->sweep);
    job->poses.erase(job->poses.begin(), job->poses.begin() + (poses - job->poses_stored));
    job->poses_stored = poses;
  }
}

void Recorder::work() {
  if (jobs_.empty() && reviews_.empty()) return;
  connect();
  if (label_) {
    writer_->set_label(*label_);
    label_.reset();
  }
  while (!reviews_.empty()) {
    writer_->add_review(reviews_.front());
    reviews_.pop_front();
    const std::lock_guard lock(mutex_);
    ++status_.reviews_saved;
  }
  while (!jobs_.empty() && work_on(*jobs_.front())) {
    published_before_ += jobs_.front()->stored;
    jobs_.pop_front();
  }
  {
    const std::lock_guard lock(mutex_);
    status_.sentence.clear();
    status_.state = !jobs_.empty()           ? RecorderStatus::State::recording
                    : published_before_ == 0 ? RecorderStatus::State::idle
                                             : RecorderStatus::State::saved;
  }
}

bool Recorder::work_on(Job& job) {
  if (!job.begun) {
    if (job.sweep == 0) job.sweep = next_sweep_++;
    writer_->begin_sweep(job.sweep, job.setup);
    job.begun = true;
    next_sweep_ = std::max(next_sweep_, job.sweep + 1);
    if (job.setup.frames_per_second > 0)
      bytes_per_second_ = job.setup.frames_per_second * job.setup.width * job.setup.height;
    const std::lock_guard lock(mutex_);
    status_.sweep = job.sweep;
  }
  const bool finished = job.source->finished();
  const std::int64_t published = job.source->published();
  do {
    std::vector<PoseSample>& poses = job.poses;
    for (std::size_t taken = poses_at_once; taken == poses_at_once;) {
      const std::size_t before = poses.size();
      poses.resize(before + poses_at_once);
      taken = job.source->take_poses(std::span(poses).subspan(before));
      poses.resize(before + taken);
      if (poses.size() > most_poses_waiting) {
        job.poses_dropped += poses.size() - most_poses_waiting;
        poses.resize(most_poses_waiting);
      }
    }
    batch_.clear();
    const std::int64_t end = std::min(published, job.stored + frames_at_once);
    for (std::int64_t i = job.stored; i < end; ++i) {
      batch_.push_back(job.source->frame(i));
      in_journal_ += static_cast<std::int64_t>(batch_.back().pixels.width) * batch_.back().pixels.height;
    }
    writer_->append(job.sweep, batch_, poses);
    job.stored = end;
    job.poses_stored += static_cast<std::int64_t>(poses.size());
    poses.clear();
    if (in_journal_ > settings_.journal_bytes) {
      writer_->checkpoint(false);
      in_journal_ = 0;
    }
    tell();
  } while (job.stored < published);
  if (!finished) return false;
  std::vector<Counter> ledger = job.source->ledger();
  if (job.poses_dropped > 0) ledger.push_back({"poses_not_saved", job.poses_dropped});
  job.stored = std::min(job.stored, published);
  writer_->end_sweep(job.sweep, published, ledger);
  writer_->checkpoint(true);
  in_journal_ = 0;
  const std::lock_guard lock(mutex_);
  status_.poses_dropped += job.poses_dropped;
  return true;
}

void Recorder::trouble(const StoreError& error) {
  // Whatever state the connection is in, a new one finds out what is there.
  writer_.reset();
  const bool full = error.kind() == StoreError::Kind::full;
  const std::lock_guard lock(mutex_);
  status_.state = full ? RecorderStatus::State::full : RecorderStatus::State::failing;
  status_.sentence =
      std::string("Not saved yet: ") + error.what() + ". The sweep stays in memory: do not switch off.";
}

void Recorder::measure_room() {
  const Room room = room_left(exam_.parent_path(), settings_.reserve_bytes, bytes_per_second_);
  room_measured_ = steady_now();
  has_room_.store(room.may_start, std::memory_order_relaxed);
  const std::lock_guard lock(mutex_);
  status_.room = room;
}

void Recorder::tell() {
  std::int64_t published = published_before_;
  std::int64_t stored = published_before_;
  Duration oldest{};
  bool growing = false;
  for (const auto& job : jobs_) {
    growing = growing || !job->source->finished();
    const std::int64_t there = job->source->published();
    published += there;
    stored += std::min(job->stored, there);
    if (job->stored < there) oldest = std::max(oldest, now() - job->source->frame(job->stored).arrived);
  }
  const std::lock_guard lock(mutex_);
  status_.published = published;
  status_.stored = stored;
  status_.oldest_unsaved = oldest;
  if (status_.state == RecorderStatus::State::recording && !growing)
    status_.state = RecorderStatus::State::saving;
}

}  // namespace sonoband::exam
