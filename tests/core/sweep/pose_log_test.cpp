#include "core/sweep/pose_log.h"

#include <gtest/gtest.h>

#include <thread>

namespace sonoband {
namespace {

PoseSample reading(std::uint64_t n) {
  PoseSample s;
  s.time = Stamp(Duration(static_cast<std::int64_t>(n)));
  s.arrived = Stamp(Duration(static_cast<std::int64_t>(3 * n)));
  s.epoch = static_cast<std::uint32_t>(n >> 3);
  s.device_frame = static_cast<std::uint32_t>(n);
  s.device_ms = static_cast<std::uint32_t>(~n);
  s.quality = n % 3 == 0 ? PoseQuality::good : PoseQuality::missing;
  s.tracker_from_probe.rotation.setConstant(0.1 * static_cast<double>(n));
  s.tracker_from_probe.translation = {static_cast<double>(n), -1, 1e-300};
  return s;
}

bool same(const PoseSample& a, const PoseSample& b) {
  return a.time == b.time && a.arrived == b.arrived && a.epoch == b.epoch &&
         a.device_frame == b.device_frame && a.device_ms == b.device_ms && a.quality == b.quality &&
         a.tracker_from_probe.rotation == b.tracker_from_probe.rotation &&
         a.tracker_from_probe.translation == b.tracker_from_probe.translation;
}

TEST(PoseLog, KeepsTheNewestAndTellsWhatIsGone) {
  PoseLog log(8);
  EXPECT_FALSE(log.read(0));
  for (std::uint64_t n = 0; n < 20; ++n) log.add(reading(n));
  EXPECT_EQ(log.written(), 20u);
  for (std::uint64_t n = 0; n < 12; ++n) EXPECT_FALSE(log.read(n));
  for (std::uint64_t n = 12; n < 20; ++n) {
    const auto got = log.read(n);
    ASSERT_TRUE(got);
    EXPECT_TRUE(same(*got, reading(n)));
  }
  EXPECT_FALSE(log.read(20));
}

TEST(PoseLog, AReaderBesideTheWriterNeverGetsHalfAReading) {
  PoseLog log(4);
  std::thread writer([&] {
    for (std::uint64_t n = 0; n < 20000; ++n) log.add(reading(n));
  });
  std::uint64_t got = 0;
  for (std::uint64_t end = 0; end < 20000;) {
    end = log.written();
    for (std::uint64_t n = end < 4 ? 0 : end - 4; n < end; ++n) {
      const auto s = log.read(n);
      if (!s) continue;
      ++got;
      ASSERT_TRUE(same(*s, reading(n))) << n;
    }
  }
  writer.join();
  EXPECT_GT(got, 0u);
}

}  // namespace
}  // namespace sonoband
