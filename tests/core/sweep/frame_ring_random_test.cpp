// The ring against a simple model of it, under random presses, releases, holds, drops and late news.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "core/sweep/frame_ring.h"
#include "tests/core/sweep/ring_support.h"

namespace sonoband {
namespace {

using std::chrono::milliseconds;
using test::at_ms;
using test::intact;

Stamp captured_of(std::uint64_t n) {
  return at_ms(10.0 * static_cast<double>(n));
}

// What the ring should hold, by frame number. Says nothing of slots.
struct Model {
  struct Held {
    Stamp pressed{};
    Stamp released = Stamp::max();
    bool growing = true;
    bool full = false;
    std::vector<std::uint64_t> frames;
    std::vector<Sweep> holds;
  };

  std::uint32_t slots;
  std::uint32_t reserve;
  std::set<std::uint64_t> kept;  // every frame in memory
  std::vector<Held> sweeps;

  std::set<std::uint64_t> held() const {
    std::set<std::uint64_t> all;
    for (const Held& s : sweeps) all.insert(s.frames.begin(), s.frames.end());
    return all;
  }
  std::uint32_t room() const {
    const auto most = slots - reserve;
    const auto count = static_cast<std::uint32_t>(held().size());
    return count < most ? most - count : 0;
  }
  // Makes place for one more: the oldest frame that no sweep holds goes.
  void make_place() {
    if (kept.size() < slots) return;
    const auto all_held = held();
    for (const std::uint64_t n : kept) {
      if (all_held.count(n) != 0) continue;
      kept.erase(n);
      return;
    }
    FAIL() << "the model has no place";
  }
  bool append(Held& s, std::uint64_t n) {
    if (s.full) return false;
    s.full = held().count(n) == 0 && room() == 0;
    if (!s.full) s.frames.push_back(n);
    return !s.full;
  }
  Held* growing() {
    for (Held& s : sweeps)
      if (s.growing) return &s;
    return nullptr;
  }
};

void check(const FrameRing& ring, const Model& model) {
  const RingStatus status = ring.status();
  ASSERT_EQ(status.held, model.held().size());
  ASSERT_EQ(status.room, model.room());
  for (const Model::Held& s : model.sweeps) {
    for (const Sweep& hold : s.holds) {
      std::vector<std::uint64_t> pre_roll;
      std::vector<std::uint64_t> swept;
      std::size_t posed = 0;
      for (const std::uint64_t n : s.frames) {
        if (captured_of(n) < s.pressed) {
          pre_roll.push_back(n);
        } else if (captured_of(n) <= s.released) {
          swept.push_back(n);
          posed += n % 3 != 0 ? 1 : 0;
        }
      }
      const auto same = [](std::span<const SweepFrame> got, const std::vector<std::uint64_t>& want) {
        return std::equal(
            got.begin(), got.end(), want.begin(), want.end(),
            [](const SweepFrame& f, std::uint64_t n) { return f.raw.device_sequence == n && intact(f); });
      };
      ASSERT_TRUE(same(hold.pre_roll(), pre_roll));
      ASSERT_TRUE(same(hold.swept(), swept));
      ASSERT_EQ(hold.view().frames.size(), posed);
    }
  }
}

void run(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto below = [&](std::uint64_t n) { return random() % n; };
  const auto slots = static_cast<std::uint32_t>(8 + below(40));
  const auto reserve = static_cast<std::uint32_t>(2 + below(5));
  FrameRing ring(test::small_ring(slots, reserve, 3));
  Model model{slots, reserve, {}, {}};
  std::uint64_t n = 0;
  std::int32_t id = 0;
  for (int step = 0; step < 400; ++step) {
    const std::uint64_t what = below(20);
    Model::Held* growing = model.growing();
    if (what < 13) {  // a frame
      ++n;
      model.make_place();
      model.kept.insert(n);
      RingSlot* slot = ring.claim();
      ASSERT_NE(slot, nullptr);
      test::fill(*slot, n, captured_of(n));
      if (n % 3 != 0) test::pose(*slot, 1);
      const Published got = ring.publish(*slot);
      const Published want = growing == nullptr          ? Published::live
                             : model.append(*growing, n) ? Published::in_sweep
                                                         : Published::ring_full;
      ASSERT_EQ(got, want);
    } else if (what < 15 && growing == nullptr) {  // a press, known up to 8 frames late
      const Stamp pressed = captured_of(n) - milliseconds(below(80));
      const Duration pre_roll = milliseconds(below(150));
      const bool possible = model.sweeps.size() < 3 && model.room() > 0;
      Sweep sweep = ring.begin_sweep(++id, pressed, pre_roll);
      ASSERT_EQ(static_cast<bool>(sweep), possible);
      if (!possible) continue;
      Model::Held s;
      s.pressed = pressed;
      std::uint64_t first = n + 1;
      while (model.kept.count(first - 1) != 0 && captured_of(first - 1) >= pressed) --first;
      const auto taken = static_cast<std::uint32_t>(n + 1 - first);
      std::uint32_t most = model.room() > taken ? (model.room() - taken) / 2 : 0;
      for (; most > 0 && model.kept.count(first - 1) != 0 && captured_of(first - 1) >= pressed - pre_roll;
           --most)
        --first;
      model.sweeps.push_back(std::move(s));
      for (std::uint64_t k = first; k <= n; ++k) model.append(model.sweeps.back(), k);
      model.sweeps.back().holds.push_back(std::move(sweep));
    } else if (what < 16 && growing != nullptr) {  // a release, known up to 5 frames late
      growing->released = std::max(growing->pressed, captured_of(n) - milliseconds(below(50)));
      growing->growing = false;
      ring.end_sweep(growing->released, {});
      if (growing->holds.empty()) model.sweeps.erase(model.sweeps.begin() + (growing - model.sweeps.data()));
    } else if (what < 18 && !model.sweeps.empty()) {  // one more hold, or one less
      const std::size_t i = below(model.sweeps.size());
      Model::Held& s = model.sweeps[i];
      if (!s.holds.empty() && below(3) == 0)
        s.holds.push_back(s.holds.front());
      else if (!s.holds.empty())
        s.holds.pop_back();
      if (s.holds.empty() && !s.growing)
        model.sweeps.erase(model.sweeps.begin() + static_cast<std::ptrdiff_t>(i));
    } else if (what == 18) {  // a frame claimed and thought better of: its old content is gone
      model.make_place();
      RingSlot* slot = ring.claim();
      ASSERT_NE(slot, nullptr);
      ring.discard(*slot);
    }
    ASSERT_NO_FATAL_FAILURE(check(ring, model)) << "step " << step;
  }
  if (ring.growing()) ring.end_sweep(captured_of(n), {});
}

TEST(FrameRingRandom, AgreesWithASimpleModel) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) ASSERT_NO_FATAL_FAILURE(run(seed)) << "seed " << seed;
}

}  // namespace
}  // namespace sonoband
