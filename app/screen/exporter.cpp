#include "app/screen/exporter.h"

#include <sys/resource.h>

#include <chrono>
#include <exception>
#include <utility>

namespace sonoband {
namespace {

using ui::ExportPhase;

constexpr int behind_others = 10;  // of "nice": an export never takes the processor from what is live
// What review made is on the disk within a batch; where it is not, the disk is in trouble, and that is said
// elsewhere.
constexpr auto patience = std::chrono::seconds(3);
constexpr auto ask_every = std::chrono::milliseconds(20);

bool is_running(ExportPhase phase) {
  return phase == ExportPhase::exporting || phase == ExportPhase::writing_out ||
         phase == ExportPhase::removing;
}

// The first of them, and how many more there are.
std::string first_of(const std::vector<std::string>& sentences) {
  if (sentences.size() < 2) return sentences.empty() ? std::string() : sentences.front();
  return sentences.front() + " (and " + std::to_string(sentences.size() - 1) + " more)";
}

}  // namespace

Exporter::Exporter(ExporterSettings settings, std::function<void()> news)
    : settings_(std::move(settings)), news_(std::move(news)), thread_([this] { serve(); }) {}

Exporter::~Exporter() {
  stop_ = true;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

bool Exporter::start(ExportJob job) {
  const std::lock_guard lock(mutex_);
  if (is_running(state_.phase)) return false;
  stop_ = false;
  permille_ = 0;
  state_.phase = ExportPhase::exporting;
  state_.where = job.what.to.string();
  state_.sentence.clear();
  ++version_;
  job_ = std::move(job);
  wake_.notify_all();
  return true;
}

bool Exporter::take_away(exchange::Place place) {
  const std::lock_guard lock(mutex_);
  if (is_running(state_.phase)) return false;
  state_.phase = ExportPhase::removing;
  state_.where = place.label;
  state_.sentence.clear();
  ++version_;
  leaving_ = std::move(place);
  wake_.notify_all();
  return true;
}

void Exporter::look() {
  const std::lock_guard lock(mutex_);
  look_ = true;
  wake_.notify_all();
}

void Exporter::forget() {
  const std::lock_guard lock(mutex_);
  if (is_running(state_.phase) || state_.phase == ExportPhase::idle) return;
  state_.phase = ExportPhase::idle;
  ++version_;
}

Exporter::State Exporter::state() const {
  const std::lock_guard lock(mutex_);
  State s = state_;
  s.permille = permille();
  s.version = version();
  return s;
}

template <class Change>
void Exporter::tell(const Change& change) {
  {
    const std::lock_guard lock(mutex_);
    change(state_);
    ++version_;
  }
  if (news_) news_();
}

void Exporter::look_now() {
  std::vector<exchange::Place> places = exchange::removable_places(settings_.media);
  if (!settings_.folder.empty()) places.push_back({settings_.folder.string(), settings_.folder, false});
  const auto same = [](const exchange::Place& a, const exchange::Place& b) {
    return a.path == b.path && a.label == b.label;
  };
  {
    const std::lock_guard lock(mutex_);
    if (std::equal(places.begin(), places.end(), state_.places.begin(), state_.places.end(), same)) return;
  }
  tell([&](State& s) { s.places = std::move(places); });
}

void Exporter::export_now(const ExportJob& job) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (job.saved && !job.saved() && !stop_ && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(ask_every);
  try {
    exchange::ExportedExam made = exchange::export_exam(job.exam, job.what, [this](int permille) {
      // A step of the bar is worth a frame.
      if (permille_.exchange(permille, std::memory_order_relaxed) != permille && news_) news_();
      return !stop_.load(std::memory_order_relaxed);
    });
    tell([](State& s) { s.phase = ExportPhase::writing_out; });
    const std::string trouble = exchange::write_out(job.what.to);
    made.damage.insert(made.damage.end(), made.warnings.begin(), made.warnings.end());
    tell([&](State& s) {
      s.phase = trouble.empty() ? ExportPhase::done : ExportPhase::failed;
      s.files = static_cast<int>(made.files.size());
      s.sentence = trouble.empty() ? first_of(made.damage) : trouble;
    });
  } catch (const std::exception& e) {
    const std::string what = e.what();
    tell([&](State& s) {
      s.phase = stop_ ? ExportPhase::cancelled : ExportPhase::failed;
      s.sentence = stop_ ? std::string() : what;
    });
  }
}

void Exporter::serve() {
  // Of this thread and the encoder's that it starts. Refused, it only competes more.
  static_cast<void>(::setpriority(PRIO_PROCESS, 0, behind_others));
  for (;;) {
    std::optional<ExportJob> job;
    std::optional<exchange::Place> leaving;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return ending_ || job_ || leaving_ || look_; });
      if (ending_) return;
      job = std::exchange(job_, std::nullopt);
      leaving = std::exchange(leaving_, std::nullopt);
      look_ = false;
    }
    if (job) export_now(*job);
    if (leaving) {
      const std::string trouble = exchange::release(leaving->path, settings_.media);
      tell([&](State& s) {
        s.phase = trouble.empty() ? ExportPhase::removed : ExportPhase::failed;
        s.sentence = trouble;
      });
    }
    look_now();
  }
}

}  // namespace sonoband
