// What one frame of the scanner's video costs: 1920 x 1080, cropped to 640 x 480. To be at most 1 ms.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "app/cart/acquisition.h"
#include "hal/capture/flow_keys.h"
#include "hal/capture/luma.h"
#include "hal/capture/video_source.h"

namespace {

using namespace sonoband;

constexpr int width = 1920;
constexpr int height = 1080;
constexpr Crop crop{.x = 640, .y = 300};

Frame full_hd(const std::vector<std::uint8_t>& bytes, PixelFormat format, int pixel) {
  return {.data = bytes.data(),
          .bytes = bytes.size(),
          .width = width,
          .height = height,
          .stride_bytes = static_cast<std::ptrdiff_t>(width) * pixel,
          .format = format};
}

// Luma, crop and nothing else.
void crop_of_full_hd(benchmark::State& state, PixelFormat format, int pixel) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(width * height * pixel), 0x5a);
  const Frame frame = full_hd(bytes, format, pixel);
  Pixels slot(640, 480);
  for (auto _ : state) {
    copy_luma(frame, crop, slot.view());
    benchmark::DoNotOptimize(slot.view().data);
    benchmark::ClobberMemory();
  }
}

BENCHMARK_CAPTURE(crop_of_full_hd, yuyv, PixelFormat::yuyv, 2)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(crop_of_full_hd, nv12, PixelFormat::nv12, 1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(crop_of_full_hd, rgb24, PixelFormat::rgb24, 3)->Unit(benchmark::kMicrosecond);

// Doppler keys and crop, of noise: each pixel another colour.
void keys_of_full_hd(benchmark::State& state, PixelFormat format, int pixel) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(width * height * pixel));
  std::mt19937 random(1);
  std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<std::uint8_t>(random()); });
  const Frame frame = full_hd(bytes, format, pixel);
  const FlowKeys keys(doppler::ColourClassifier(doppler::red_blue_bar(), {}));
  Pixels slot(640, 480);
  for (auto _ : state) {
    keys.copy(frame, crop, slot.view());
    benchmark::DoNotOptimize(slot.view().data);
    benchmark::ClobberMemory();
  }
}
BENCHMARK_CAPTURE(keys_of_full_hd, yuyv, PixelFormat::yuyv, 2)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(keys_of_full_hd, rgb24, PixelFormat::rgb24, 3)->Unit(benchmark::kMicrosecond);

// Time as fast as it is read.
class BenchClock final : public Clock {
 public:
  Stamp now() override { return now_; }
  void sleep_until(Stamp t) override { now_ = std::max(now_, t); }

 private:
  Stamp now_{std::chrono::seconds(1000)};
};

// A grabber of 60 frames a second whose driver costs nothing: its buffers of noise, 33 MB, in turn, so that
// none is still in a cache.
class Grabber final : public VideoDevice {
 public:
  explicit Grabber(Clock& clock) : clock_(clock) {
    std::mt19937 random(1);
    for (auto& buffer : buffers_) {
      buffer.resize(std::size_t{2} * width * height);
      std::generate(buffer.begin(), buffer.end(), [&] { return static_cast<std::uint8_t>(random()); });
    }
  }
  VideoStatus open() override { return VideoStatus::ok; }
  std::string name() const override { return "a grabber of noise"; }
  std::vector<PixelFormat> formats() override { return {PixelFormat::yuyv}; }
  VideoStatus negotiate(VideoMode& mode, double /*rate_hz*/) override {
    mode.stride_bytes = std::ptrdiff_t{2} * width;
    mode.bytes = buffers_[0].size();
    return VideoStatus::ok;
  }
  VideoStatus start() override { return VideoStatus::ok; }
  VideoStatus take(VideoBuffer& out, Duration /*timeout*/) override {
    clock_.sleep_until(clock_.now() + std::chrono::microseconds(16667));
    const std::size_t slot = sequence_ % buffers_.size();
    out.index = static_cast<int>(slot);
    out.bytes = buffers_[slot];
    out.sequence = sequence_++;
    out.stamp_ns = (clock_.now() - std::chrono::milliseconds(3)).time_since_epoch().count();
    out.monotonic = true;
    return VideoStatus::ok;
  }
  VideoStatus give_back(int /*index*/) override { return VideoStatus::ok; }
  void stop() override {}
  void close() override {}

 private:
  Clock& clock_;
  std::array<std::vector<std::uint8_t>, 8> buffers_;
  std::uint32_t sequence_ = 0;
};

// All that is done for a picture between the driver and the ring, with the four readings that come meanwhile:
// taken over, checked, cropped, compared with the last, paired with its pose, published.
void full_hd_yuyv_into_the_ring(benchmark::State& state) {
  BenchClock clock;
  Grabber grabber(clock);
  VideoSource source(grabber, clock, {.width = width, .height = height, .rate_hz = 60});
  FrameRing ring({.width = 640, .height = 480, .slots = 300});
  cart::AcquisitionSettings settings;
  settings.source_width = width;
  settings.source_height = height;
  settings.crop = crop;
  cart::Acquisition acquisition(ring, settings);
  source.start();
  Frame frame;
  for (auto _ : state) {
    if (source.read(frame, std::chrono::milliseconds(20)) != ReadStatus::ok) state.SkipWithError("no frame");
    for (int i = 4; i > 0; --i) {
      PoseSample reading;
      reading.time = frame.captured - std::chrono::microseconds(4167) * (i - 1);
      reading.quality = PoseQuality::good;
      acquisition.on_pose(reading, clock.now());
    }
    acquisition.on_frame(frame, clock.now());
    acquisition.tick(clock.now());
  }
  state.counters["lost"] = static_cast<double>(acquisition.ledger().all_lost());
  state.counters["without pose"] =
      static_cast<double>(acquisition.ledger().stored - acquisition.ledger().with(PoseStatus::ok));
}

BENCHMARK(full_hd_yuyv_into_the_ring)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
