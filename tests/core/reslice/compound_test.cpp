// Means without dividing.
#include <gtest/gtest.h>

#include "core/reslice/compound.h"

namespace sonoband {
namespace {

// Where velocities cancel out but for less than half a level, the grey samples' mean stands.
TEST(MeanSums, OfFewSamplesAreTheSameWithoutDividing) {
  constexpr int most_level = 63;
  for (std::uint32_t count = 1; count < 256; ++count) {
    for (const std::uint32_t coloured : {count, count - count / 2, std::uint32_t{1}}) {
      const std::uint32_t greys = count - coloured;
      const int most = most_level * static_cast<int>(coloured);
      for (int velocity = -most; velocity <= most; ++velocity) {
        const MeanSums sums{greys * 127U - (greys > 0 ? 60U : 0U), greys, coloured, velocity};
        ASSERT_EQ(sums.value_of_few(), sums.value())
            << velocity << " of " << coloured << " among " << count << " samples";
      }
    }
  }
}

TEST(MeanSums, OfGreyAreTheSameWithoutDividing) {
  for (std::uint32_t count = 1; count < 256; ++count)
    for (std::uint32_t sum = 0; sum <= 255 * count; ++sum)
      ASSERT_EQ(mean_inverses.mean(sum, static_cast<std::uint8_t>(count)), rounded_mean(sum, count))
          << sum << " of " << count;
}

}  // namespace
}  // namespace sonoband
