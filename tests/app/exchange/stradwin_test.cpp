// Synthetic .sx and .sw files: no real one is at hand.
#include "app/exchange/stradwin.h"

#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "app/bad_input.h"
#include "core/image/doppler.h"
#include "tests/support/support.h"

namespace sonoband::exchange {
namespace {

constexpr const char* head =
    "# a comment\nRES_BUF_FRAMES 2\nRES_BUF_WIDTH 3\nRES_BUF_HEIGHT 2\nRES_POS_REC true\nRES_BUF_RF false\n"
    "RES_END_HEADER\nRES_XSCALE 0.02\nRES_YSCALE 0.01\nRES_XTRANS 1\nRES_YTRANS 2\nRES_ZTRANS 3\nRES_AZIMUTH "
    "90\n";

ReadSequence read(const std::string& text, const std::string& bytes, const std::string& file = "a.sw") {
  std::istringstream header(text);
  std::istringstream pixels(bytes);
  return read_strad(header, file, pixels, "a.sxi", default_limits());
}

std::string refusal(const std::string& text, const std::string& bytes) {
  try {
    read(text, bytes);
  } catch (const BadInput& e) {
    return e.what();
  }
  return "taken";
}

Eigen::Matrix4d field(const std::vector<Field>& fields, std::string_view name) {
  const std::string* value = find_field(fields, name);
  return value == nullptr ? Eigen::Matrix4d::Zero() : parse_matrix(*value, "test");
}

TEST(Strad, PlacesPixelsAsTheSheetSays) {
  const ReadSequence got =
      read(std::string(head) + "IM 1000000000 1 2 3 0 0 0\nIM 2000000000 0 0 0 90 0 0\n", "abcdefghijkl");
  const TrackedSequence& s = got.sequence;
  ASSERT_EQ(s.frame_count(), 2);
  EXPECT_EQ(s.frame_pixels(1)[0], 'g');
  EXPECT_EQ(timestamp_s(s.frames[1]), 2.0);
  // Calibration turns x to y: pixel (0, 0), whose centre is at (0.1, 0.05) mm, goes to (10 - 0.05, 20 + 0.1,
  // 30).
  const Eigen::Matrix4d calibration = field(s.fields, "ImageToProbeTransform");
  EXPECT_TRUE(
      (calibration * Eigen::Vector4d(0, 0, 0, 1)).isApprox(Eigen::Vector4d(9.95, 20.1, 30, 1), 1e-12));
  EXPECT_TRUE((calibration * Eigen::Vector4d(1, 0, 0, 0)).isApprox(Eigen::Vector4d(0, 0.2, 0, 0), 1e-12));
  const Eigen::Matrix4d first = field(s.frames[0].fields, "ProbeToTrackerTransform");
  EXPECT_TRUE((first * Eigen::Vector4d(0, 0, 0, 1)).isApprox(Eigen::Vector4d(10, 20, 30, 1), 1e-12));
  const Eigen::Matrix4d second = field(s.frames[1].fields, "ProbeToTrackerTransform");
  EXPECT_TRUE((second * Eigen::Vector4d(1, 0, 0, 0)).isApprox(Eigen::Vector4d(0, 1, 0, 0), 1e-12));
}

// The sheet's own columns of R, from sines and cosines.
TEST(Strad, AnglesAreAzimuthElevationRoll) {
  const double a = 0.3;
  const double b = -0.7;
  const double g = 1.9;
  const double k = 180 / 3.14159265358979323846;
  std::ostringstream line;
  line.precision(17);
  line << "IM 0 6 0 0 0 " << a * k << " " << b * k << " " << g * k << "\n";
  const ReadSequence got = read(std::string(head) + line.str(), "abcdef", "a.sx");
  const Eigen::Matrix4d m = field(got.sequence.frames[0].fields, "ProbeToTrackerTransform");
  const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b), cg = std::cos(g),
               sg = std::sin(g);
  Eigen::Matrix3d expected;
  expected << ca * cb, ca * sb * sg - sa * cg, ca * sb * cg + sa * sg, sa * cb, sa * sb * sg + ca * cg,
      sa * sb * cg - ca * sg, -sb, cb * sg, cb * cg;
  EXPECT_TRUE((m.topLeftCorner<3, 3>().isApprox(expected, 1e-12)));
}

TEST(Strad, ComesBackFromBothFormats) {
  std::mt19937_64 random(5);
  TrackedSequence s;
  s.width = 7;
  s.height = 5;
  s.frames.resize(6);
  s.pixels = PixelBuffer(35 * 6);
  for (std::uint8_t& b : s.pixels.bytes()) b = static_cast<std::uint8_t>(random());
  for (int i = 0; i < 6; ++i) {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    Eigen::Matrix3d r = test::random_rotation(random);
    if (i == 5)
      r = Eigen::AngleAxisd(3.14159265358979323846 / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
    m.topLeftCorner<3, 3>() = r * Eigen::Vector3d(0.11, 0.13, 0.11).asDiagonal();
    m.topRightCorner<3, 1>() = Eigen::Vector3d(i, 2 * i, -3);
    set_transform(s.frames[static_cast<std::size_t>(i)], {"Image", "Tracker"}, m, i == 2 ? "INVALID" : "OK");
    set_field(s.frames[static_cast<std::size_t>(i)].fields, "Timestamp", std::to_string(i + 1));
  }
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("strad" + std::to_string(random()));
  std::filesystem::create_directory(folder);
  for (const char* name : {"a.sx", "b.sw"}) {
    EXPECT_EQ(write_strad(s, "Tracker", true, folder / name), 1);
    const TrackedSequence back = read_strad(folder / name).sequence;
    ASSERT_EQ(back.frame_count(), 5);
    const Eigen::Matrix4d calibration = field(back.fields, "ImageToProbeTransform");
    for (int i = 0, k = 0; i < 6; ++i) {
      if (i == 2) continue;
      const auto& fields = back.frames[static_cast<std::size_t>(k)].fields;
      const Eigen::Matrix4d m = field(fields, "ProbeToTrackerTransform") * calibration;
      const Eigen::Matrix4d was =
          field(s.frames[static_cast<std::size_t>(i)].fields, "ImageToTrackerTransform");
      EXPECT_TRUE(m.isApprox(was, 1e-9)) << m << "\n" << was;
      EXPECT_TRUE(
          std::equal(s.frame_pixels(i).begin(), s.frame_pixels(i).end(), back.frame_pixels(k).begin()));
      ++k;
    }
    EXPECT_EQ(*find_field(back.fields, "SonobandPixels"), "doppler");
  }
  Eigen::Matrix4d sheared = Eigen::Matrix4d::Identity();
  sheared(0, 1) = 0.05;
  set_transform(s.frames[0], {"Image", "Tracker"}, sheared);
  EXPECT_THROW(write_strad(s, "Tracker", false, folder / "c.sw"), BadInput);
  EXPECT_FALSE(std::filesystem::exists(folder / "c.sw"));
  std::filesystem::remove_all(folder);
}

TEST(Strad, ColoursAreReencoded) {
  const ReadSequence got = read(std::string(head) + "RES_BUF_DOPPLER true\nIM 0 0 0 0 0 0 0\n",
                                std::string("\x00\x7f\x80\xbf\xc0\xff", 6));
  const auto p = got.sequence.frame_pixels(0);
  EXPECT_EQ(p[0], 0);
  EXPECT_EQ(p[1], 127);
  EXPECT_EQ(p[2], doppler::colour_key(0, false));
  EXPECT_EQ(p[3], doppler::colour_key(63, false));
  EXPECT_EQ(p[4], doppler::colour_key(0, true));
  EXPECT_EQ(p[5], doppler::colour_key(63, true));
}

TEST(Strad, SaysWhatIsWrongAndWhere) {
  const std::string h = head;
  EXPECT_NE(refusal(h + "IM 0 0 0 0 0 0 0\n", "abcde").find("ends after 5 of 6"), std::string::npos);
  EXPECT_NE(refusal(h + "IM 0 0 0 0 0 0 0\n", "abcdefg").find("do not belong together"), std::string::npos);
  EXPECT_NE(refusal(h + "IM 0 0 0 x 0 0 0\n", "abcdef").find("line 14: 'x'"), std::string::npos);
  EXPECT_NE(refusal(h + "IM 0 0 0\n", "abcdef").find("line 14"), std::string::npos);
  EXPECT_NE(refusal(h, "").find("no IM line"), std::string::npos);
  EXPECT_NE(refusal("RES_BUF_WIDTH 1e9\nRES_BUF_HEIGHT 2\nIM 0\n", "").find("RES_BUF_WIDTH"),
            std::string::npos);
  EXPECT_NE(refusal(h + "IM 0 7 0 0 0 0 0 0\n", "abcdef").find("7 bytes"), std::string::npos);
  EXPECT_NE(refusal(h + "RES_XSCALE 0\nIM 0\n", "abcdef").find("RES_XSCALE"), std::string::npos);
}

}  // namespace
}  // namespace sonoband::exchange
