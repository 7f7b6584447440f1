// The exam store on this disk: what a second of recording costs in CPU, and how soon a stored sweep shows.
// Set TMPDIR to the disk that matters.
#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <random>

#include "app/exam/exam_writer.h"
#include "app/exam/recorder.h"
#include "app/exam/sweep_loader.h"

namespace sonoband::exam {
namespace {

constexpr int width = 640;
constexpr int height = 480;

// Sixteen pictures: a sector of speckle on black, as scanners send it. About half of it is noise.
const std::vector<Pixels>& pictures() {
  static const std::vector<Pixels> all = [] {
    std::mt19937 random(1);
    std::vector<Pixels> made;
    for (int i = 0; i < 16; ++i) {
      made.emplace_back(width, height);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          if (std::abs(x - width / 2) < 80 + y / 2)
            made.back().view()(x, y) = static_cast<std::uint8_t>(random() % 200);
    }
    return made;
  }();
  return all;
}

FrameRecord frame(std::int64_t number) {
  FrameRecord f;
  f.pixels = pictures()[static_cast<std::size_t>(number % 16)].view();
  f.number = number;
  f.pose_status = PoseStatus::ok;
  f.captured = f.stamped = f.arrived = Stamp(std::chrono::milliseconds(16 * number));
  f.world_from_image.translation = {0, 0, 0.1 * static_cast<double>(number)};
  return f;
}

std::filesystem::path folder() {
  return std::filesystem::temp_directory_path() / ("sonoband-bench-" + std::to_string(::getpid()));
}

SweepSetup setup() {
  SweepSetup s;
  s.width = width;
  s.height = height;
  s.frames_per_second = 60;
  return s;
}

double cpu_s() {
  rusage u{};
  ::getrusage(RUSAGE_SELF, &u);
  return static_cast<double>(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
         static_cast<double>(u.ru_utime.tv_usec + u.ru_stime.tv_usec) * 1e-6;
}

// Publishes 60 frames a second for five seconds, as the ring does, four readings of the tracker with each.
class Live final : public SweepSource {
 public:
  std::atomic<std::int64_t> count{0};
  std::atomic<bool> over{false};
  bool finished() const override { return over; }
  std::int64_t published() const override { return count; }
  FrameRecord frame(std::int64_t number) const override {
    FrameRecord f = exam::frame(number);
    f.arrived = Stamp(std::chrono::steady_clock::now().time_since_epoch());
    return f;
  }
  std::size_t take_poses(std::span<PoseSample> out) override {
    std::size_t n = 0;
    for (; n < out.size() && taken_ < 4 * count; ++n, ++taken_) out[n] = {};
    return n;
  }
  std::vector<Counter> ledger() const override { return {}; }

 private:
  std::int64_t taken_ = 0;
};

void sustained_60_a_second(benchmark::State& state) {
  std::filesystem::create_directories(folder());
  const std::filesystem::path file = folder() / "live.exam";
  for (auto _ : state) {
    ExamWriter::create(file, "live").close();
    static_cast<void>(pictures());
    std::int64_t behind = 0;
    double seconds = 0;
    const double cpu = cpu_s();
    {
      Recorder recorder(file, {});
      const auto live = std::make_shared<Live>();
      recorder.begin(live, setup());
      const auto start = std::chrono::steady_clock::now();
      for (int i = 1; i <= 300; ++i) {
        std::this_thread::sleep_until(start + i * std::chrono::microseconds(16'667));
        live->count = i;
        const RecorderStatus status = recorder.status();
        behind = std::max(behind, i - status.stored);
      }
      seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      live->over = true;
      recorder.save_now();
    }
    state.counters["cpu_percent_of_a_core"] = 100 * (cpu_s() - cpu) / seconds;
    state.counters["most_frames_behind"] = static_cast<double>(behind);
    state.counters["file_MB"] = static_cast<double>(std::filesystem::file_size(file)) / 1e6;
    std::filesystem::remove_all(folder());
    std::filesystem::create_directories(folder());
  }
  std::filesystem::remove_all(folder());
}
BENCHMARK(sustained_60_a_second)->Iterations(1)->Unit(benchmark::kMillisecond)->UseRealTime();

void open_4000_frames_to_first_picture(benchmark::State& state) {
  std::filesystem::create_directories(folder());
  const std::filesystem::path file = folder() / "long.exam";
  {
    ExamWriter writer = ExamWriter::create(file, "long");
    writer.begin_sweep(1, setup());
    std::vector<FrameRecord> batch;
    for (std::int64_t i = 0; i < 4000; ++i) {
      batch.push_back(frame(i));
      if (batch.size() == 100) {
        writer.append(1, batch, {});
        writer.checkpoint(false);
        batch.clear();
      }
    }
    writer.end_sweep(1, 4000, {});
    writer.close();
  }
  double all_s = 0;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    SweepLoader loader(file, 1, 2000);
    state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    loader.wait();
    all_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  state.counters["all_pictures_s"] = all_s;
  std::filesystem::remove_all(folder());
}
BENCHMARK(open_4000_frames_to_first_picture)->Iterations(3)->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
}  // namespace sonoband::exam

BENCHMARK_MAIN();
