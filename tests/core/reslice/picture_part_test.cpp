// Parts of pictures turned, for every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "core/reslice/patch_kernels.h"
#include "core/reslice/picture_part.h"
#include "tests/core/reslice/only_target.h"

namespace sonoband {
namespace {

class TurnedPictures : public testing::TestWithParam<std::int64_t> {
 private:
  test::OnlyTarget only_{GetParam()};
};

// Part of a picture of noise that lies in it, reaches beyond any of its edges, or holds all of it.
TEST_P(TurnedPictures, HaveColumnsAsRows) {
  ASSERT_EQ(patch_kernels().target, GetParam());
  std::mt19937_64 random(9);
  for (const int width : {16, 17, 31, 90}) {
    for (const int height : {1, 20, 75}) {
      const std::ptrdiff_t stride = width + 3;
      std::vector<std::uint8_t> pixels(static_cast<std::size_t>(stride) * height);
      for (auto& p : pixels) p = static_cast<std::uint8_t>(random());
      FrameEntry frame;
      frame.pixels = pixels.data();
      frame.stride = stride;
      frame.width = width;
      frame.height = height;
      TurnedParts turned;
      std::vector<PicturePart> parts;
      std::vector<ChainFrame> at;
      for (int i = 0; i < 20; ++i) {
        const auto side = [&](int size) {
          const int inside = static_cast<int>(random() % size);
          return std::pair(inside - static_cast<int>(random() % (inside + 4)),
                           inside + static_cast<int>(random() % (size - inside + 3)));
        };
        const auto [left, right] = side(width);
        const auto [top, bottom] = side(height);
        parts.push_back({left, right, top, bottom});
        ChainFrame& f = at.emplace_back();
        f.x = FixedPx{5} << 32;
        f.y = FixedPx{7} << 32;
        f.x_per_row = 3;
        turned.add(frame, parts.back(), f);
      }
      turned.lay_out();
      turned.turn();
      for (std::size_t i = 0; i < parts.size(); ++i) {
        const PicturePart& part = parts[i];
        const FrameEntry picture = turned.picture(i);
        EXPECT_EQ(at[i].x >> 32, 7 - part.top);
        EXPECT_EQ(at[i].y >> 32, 5 - part.left);
        EXPECT_EQ(at[i].y_per_row, 3);
        ASSERT_EQ(picture.height, part.columns());
        ASSERT_GE(picture.width, part.rows() + 128) << "kernels would take the slow way at its edges";
        for (int x = part.left; x <= part.right; ++x) {
          for (int y = part.top; y <= part.bottom; ++y) {
            ASSERT_EQ(picture.pixels[(x - part.left) * picture.stride + (y - part.top)],
                      pixels[std::clamp(y, 0, height - 1) * stride + std::clamp(x, 0, width - 1)])
                << x << ' ' << y << " of " << width << 'x' << height;
          }
        }
      }
    }
  }
}

// Where pictures end, the part of a tile that is within a frame's reach may lie beside its picture.
TEST_P(TurnedPictures, HaveNothingBesideThePicture) {
  constexpr int width = 40, height = 30;
  const std::vector<std::uint8_t> pixels(width * height, 77);
  FrameEntry frame;
  frame.pixels = pixels.data();
  frame.stride = frame.width = width;
  frame.height = height;
  TurnedParts turned;
  ChainFrame at;
  turned.add(frame, {0, width - 1, 0, height - 1}, at);
  turned.add(frame, {width + 9, width + 18, 0, height - 1}, at);
  turned.add(frame, {-30, -19, 0, height - 1}, at);
  turned.add(frame, {0, width - 1, 0, height - 1}, at);
  turned.lay_out();
  turned.turn();
  for (const std::size_t i : {1U, 2U}) {
    const FrameEntry beside = turned.picture(i);
    for (int column = 0; column < beside.height; ++column)
      for (int y = 0; y < height; ++y) ASSERT_EQ(beside.pixels[column * beside.stride + y], 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, TurnedPictures, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()));

}  // namespace
}  // namespace sonoband
