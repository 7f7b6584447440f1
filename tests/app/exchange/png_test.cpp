#include "app/exchange/png.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "core/image/doppler.h"
#include "tests/app/exchange/sequence_samples.h"

namespace sonoband::test {
namespace {

using exchange::PngPicture;

class Png : public ::testing::Test {
 protected:
  ~Png() override { std::filesystem::remove(path_); }
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("sonoband_" + std::to_string(::getpid()) + ".png");
};

TEST_F(Png, GreyAndColourReadBackTheSame) {
  std::mt19937_64 random(4);
  for (const int channels : {1, 3}) {
    PngPicture picture{
        .width = 17, .height = 9, .channels = channels, .bytes = {}, .pixel_mm = 0.25, .texts = {}};
    for (int i = 0; i < 17 * 9 * channels; ++i) picture.bytes.push_back(static_cast<std::uint8_t>(random()));
    picture.texts = {{"Disclaimer", "research use only"}, {"Comment", "x = 1"}};
    exchange::write_png(picture, path_);
    const PngPicture read = exchange::read_png(path_);
    EXPECT_EQ(read.width, 17);
    EXPECT_EQ(read.height, 9);
    EXPECT_EQ(read.channels, channels);
    EXPECT_EQ(read.bytes, picture.bytes);
    EXPECT_EQ(read.texts, picture.texts);
    EXPECT_DOUBLE_EQ(read.pixel_mm, 0.25);
  }
}

TEST_F(Png, StridesArePackedAway) {
  const std::vector<std::uint8_t> rows{1, 2, 99, 3, 4, 99};
  EXPECT_EQ(exchange::grey_png({rows.data(), 2, 2, 3}).bytes, (std::vector<std::uint8_t>{1, 2, 3, 4}));
}

TEST_F(Png, CoverageIsNeverZeroWhereThereIsData) {
  BandImage image{.pixels = Pixels(4, 1), .coverage = ImageBuffer<std::uint16_t>(4, 1)};
  image.coverage.view()(1, 0) = 1;
  image.coverage.view()(2, 0) = 500;
  image.coverage.view()(3, 0) = 1001;
  EXPECT_EQ(exchange::coverage_png(image, 1001).bytes, (std::vector<std::uint8_t>{0, 1, 127, 255}));
}

TEST_F(Png, DopplerKeysBecomeColours) {
  BandImage image{
      .pixels = Pixels(4, 1), .coverage = ImageBuffer<std::uint16_t>(4, 1), .kind = PixelKind::doppler};
  image.pixels.view()(1, 0) = 100;
  image.pixels.view()(2, 0) = doppler::colour_key(63, true);
  image.pixels.view()(3, 0) = doppler::colour_key(0, false);
  const PngPicture picture = exchange::band_png(image);
  EXPECT_EQ(picture.channels, 3);
  EXPECT_EQ(picture.bytes, (std::vector<std::uint8_t>{0, 0, 0, 201, 201, 201, 255, 255, 0, 0, 0, 64}));
}

TEST_F(Png, DamageIsRefused) {
  std::ofstream(path_) << "no picture";
  EXPECT_NE(refusal([&] { exchange::read_png(path_); }), "");
  PngPicture picture{.width = 64, .height = 64, .bytes = std::vector<std::uint8_t>(64 * 64, 7), .texts = {}};
  exchange::write_png(picture, path_);
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) / 2);
  EXPECT_NE(refusal([&] { exchange::read_png(path_); }), "");
  EXPECT_NE(refusal([&] { exchange::write_png(picture, "/nowhere/x.png"); }).find("cannot be written"),
            std::string::npos);
}

}  // namespace
}  // namespace sonoband::test
