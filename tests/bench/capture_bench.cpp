// What one frame of the scanner's video costs: 1920 x 1080, cropped to 640 x 480. To be at most 1 ms.
#include <benchmark/benchmark.h>

#include <vector>

#include "hal/capture/luma.h"

namespace {

using namespace sonoband;

void crop_of_full_hd(benchmark::State& state, PixelFormat format, int pixel) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(1920 * 1080 * pixel), 0x5a);
  const Frame frame{.data = bytes.data(),
                    .bytes = bytes.size(),
                    .width = 1920,
                    .height = 1080,
                    .stride_bytes = 1920 * pixel,
                    .format = format};
  Pixels slot(640, 480);
  for (auto _ : state) {
    copy_luma(frame, {.x = 640, .y = 300}, slot.view());
    benchmark::DoNotOptimize(slot.view().data);
    benchmark::ClobberMemory();
  }
}

BENCHMARK_CAPTURE(crop_of_full_hd, yuyv, PixelFormat::yuyv, 2)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(crop_of_full_hd, nv12, PixelFormat::nv12, 1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(crop_of_full_hd, rgb24, PixelFormat::rgb24, 3)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
