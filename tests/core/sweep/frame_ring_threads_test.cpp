// Readers on other threads while the writer runs: for the thread sanitizer, and for torn pictures.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <thread>

#include "core/concurrency/spsc_queue.h"
#include "core/parallel.h"
#include "core/reslice/band.h"
#include "core/sweep/frame_ring.h"
#include "tests/core/sweep/ring_support.h"
#include "tests/support/allocation_counter.h"

namespace sonoband {
namespace {

using std::chrono::milliseconds;
using test::at_ms;
using test::intact;

TEST(FrameRingThreads, GrowingSweepsAndTheLiveViewAreReadWhileTheWriterRuns) {
  constexpr std::uint64_t frames = 3000;
  FrameRing ring(test::small_ring(64, 8, 3));
  SpscQueue<Sweep> handed(4);
  std::atomic<bool> over{false};
  std::uint64_t broken = 0;
  std::uint64_t swept = 0;
  std::uint64_t sweeps = 0;

  // Takes each sweep while it grows, reads it again and again, and drops it some time after it has ended.
  std::thread reader([&] {
    for (;;) {
      const bool last = over.load();
      Sweep* front = handed.front();
      if (front == nullptr) {
        if (last) return;
        std::this_thread::yield();
        continue;
      }
      const Sweep sweep = std::move(*front);
      handed.pop();
      std::size_t seen = 0;
      for (bool ended = false; !ended;) {
        ended = sweep.ledger() != nullptr;
        const auto now = sweep.swept();
        broken += !ended && now.size() < seen ? 1 : 0;
        seen = now.size();
        // A frame may be in the span of a moment ago and be cut off by the release: still safe to read.
        for (const SweepFrame& f : now) broken += intact(f) ? 0 : 1;
        for (const TrackedFrame* f : sweep.view().frames) broken += f->pose_status == PoseStatus::ok ? 0 : 1;
        std::this_thread::yield();
      }
      swept += seen;
      broken += sweep.ledger()->stored == 77 ? 0 : 1;
      ++sweeps;
    }
  });
  std::atomic<std::uint64_t> live{0};
  std::thread live_view([&] {
    std::uint64_t last = 0;
    while (!over.load()) {
      if (const FrameLease lease = ring.latest()) {
        const std::uint64_t n = lease.frame().raw.device_sequence;
        if (!intact(lease.frame()) || n < last) over = true;
        last = n;
        ++live;
      }
      std::this_thread::yield();
    }
  });

  LossLedger ledger;
  ledger.stored = 77;
  std::uint64_t no_slot = 0;
  std::uint64_t allocated = 0;
  {
    const test::AllocationCounter allocations;
    for (std::uint64_t n = 1; n <= frames && !over; ++n) {
      RingSlot* slot = ring.claim();
      if (slot == nullptr) {
        ++no_slot;
        continue;
      }
      test::fill(*slot, n, at_ms(static_cast<double>(n)));
      if (n % 5 != 0) test::pose(*slot, 1);
      ring.publish(*slot);
      // On a busy machine the view may come late.
      while (live == 0 && !over) std::this_thread::yield();
      if (n % 40 == 10) {
        Sweep sweep = ring.begin_sweep(static_cast<std::int32_t>(n), at_ms(static_cast<double>(n) - 3),
                                       milliseconds(5));
        if (sweep && !handed.try_emplace(std::move(sweep))) ++no_slot;
      }
      if (n % 40 == 30 && ring.growing()) ring.end_sweep(at_ms(static_cast<double>(n) - 2), ledger);
      if (n % 16 == 0) std::this_thread::yield();
    }
    if (ring.growing()) ring.end_sweep(at_ms(frames), ledger);
    allocated = allocations.count();
  }
  EXPECT_FALSE(over) << "the live view saw a torn or an older frame";
  over = true;
  reader.join();
  live_view.join();
  EXPECT_EQ(allocated, 0U);
  EXPECT_EQ(no_slot, 0U);
  EXPECT_EQ(broken, 0U);
  EXPECT_GT(sweeps, 0U);
  EXPECT_GT(swept, 0U);
  EXPECT_GT(live.load(), 0U);
  EXPECT_EQ(ring.status().held, 0U);
}

TEST(FrameRingThreads, ASweepIsRenderedWhileItGrows) {
  // Planes z = 0, 1, 2 ... mm of one shade each. A plane along z shows as many rows of data as frames came.
  constexpr int frames = 60;
  FrameRing ring(test::small_ring(80, 8, 2));
  Sweep sweep = ring.begin_sweep(1, at_ms(0), {});
  std::thread writer([&] {
    for (int n = 0; n < frames; ++n) {
      RingSlot* slot = ring.claim();
      test::fill(*slot, static_cast<std::uint64_t>(n), at_ms(n));
      test::pose(*slot, n);
      ring.publish(*slot);
      std::this_thread::yield();
    }
    ring.end_sweep(at_ms(frames), {});
  });
  ReslicePlane plane;
  plane.origin.v = {2, 2, 0};
  plane.down.v = Eigen::Vector3d::UnitZ();
  plane.width = 10;
  plane.height = frames;
  plane.pixel_mm = 1;
  RenderSettings settings;
  settings.gap.mm = 0.4;
  Serial serial;
  int rendered = 0;
  for (bool ended = false; !ended;) {
    ended = sweep.ledger() != nullptr;
    const SweepView view = sweep.view();
    const auto came = static_cast<int>(view.frames.size());
    const BandImage image = render_planar(view, plane, settings, serial);
    for (int row = 0; row < frames; ++row) {
      ASSERT_EQ(image.coverage.view()(5, row), row < came ? 1 : 0) << "row " << row << " of " << came;
      if (row < came) {
        ASSERT_EQ(image.pixels.view()(5, row), test::shade_of(static_cast<std::uint64_t>(row)));
      }
    }
    ++rendered;
    std::this_thread::yield();
  }
  writer.join();
  EXPECT_GT(rendered, 0);
  EXPECT_EQ(sweep.view().frames.size(), static_cast<std::size_t>(frames));
}

}  // namespace
}  // namespace sonoband
