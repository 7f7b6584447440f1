#include <gtest/gtest.h>

#include <cmath>

#include "app/exchange/text.h"
#include "tests/app/exchange/sequence_samples.h"

namespace sonoband::test {
namespace {

using exchange::transform_name;
using exchange::TransformName;

TEST(SequenceText, NumbersComeInEverySpelling) {
  EXPECT_EQ(exchange::parse_number("-6.68987e-005"), -6.68987e-5);
  EXPECT_EQ(exchange::parse_number("+2.5"), 2.5);
  EXPECT_EQ(exchange::parse_number("-0"), 0.0);
  EXPECT_EQ(exchange::parse_number("1e-999"), 0.0);
  EXPECT_TRUE(std::isinf(exchange::parse_number("1e999").value()));
  EXPECT_TRUE(std::isnan(exchange::parse_number("nan").value()));
  EXPECT_TRUE(std::isnan(exchange::parse_number("-1.#IND").value()));
  EXPECT_TRUE(std::isnan(exchange::parse_number("1.#QNAN").value()));
  for (const char* text : {"", "x", "1.5x", "1,5", "--1", "+"})
    EXPECT_FALSE(exchange::parse_number(text)) << text;
}

TEST(SequenceText, NumbersReadBackAsTheSameDouble) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(-1e4, 1e4);
  for (int i = 0; i < 10'000; ++i) {
    const double value = any(random);
    EXPECT_EQ(exchange::parse_number(exchange::format_number(value)), value);
  }
}

TEST(TransformNames, HaveOneToBeforeACapital) {
  EXPECT_EQ(transform_name("ProbeToTrackerTransform"), (TransformName{"Probe", "Tracker"}));
  EXPECT_EQ(transform_name("probeTo2Transform"), (TransformName{"Probe", "2"}));
  EXPECT_EQ(transform_name("ToolToTrackerTransform"), (TransformName{"Tool", "Tracker"}));
  EXPECT_EQ(transform_name("TorsoToTomatoTransform"), (TransformName{"Torso", "Tomato"}));
  EXPECT_EQ(transform_name("ImageToCroppedImageTransform"), (TransformName{"Image", "CroppedImage"}));
  for (const char* name :
       {"ProbeToTracker", "Transform", "ProbeTransform", "AToBToCTransform", "ToBTransform", "AToTransform",
        "ProbeToTrackerTransformStatus", "ProbetoTrackerTransform", "Stylus"})
    EXPECT_FALSE(transform_name(name)) << name;
}

TEST(FrameTransforms, StatusDecidesWhetherAMatrixIsLookedAt) {
  const std::string identity = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
  const std::vector<exchange::Field> fields{{"AToBTransform", identity},  {"AToBTransformStatus", "OK"},
                                            {"CToDTransform", "rubbish"}, {"CToDTransformStatus", "INVALID"},
                                            {"EToFTransform", identity},  {"Timestamp", "1"},
                                            {"GToHTransform", identity},  {"GToHTransformStatus", "MISSING"}};
  const auto transforms = exchange::transforms_of(fields, "x.mha, frame 3");
  ASSERT_EQ(transforms.size(), 4u);
  EXPECT_TRUE(transforms[0].ok());
  EXPECT_FALSE(transforms[1].ok());
  EXPECT_TRUE(transforms[2].ok());
  EXPECT_TRUE(transforms[2].status.empty());
  EXPECT_FALSE(transforms[3].ok());
}

TEST(FrameTransforms, AMatrixIsSixteenNumbers) {
  for (const char* text :
       {"", "1 0 0 0", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1", "1 0 0 0 0 1 0 0 0 0 x 0 0 0 0 1"}) {
    const std::vector<exchange::Field> fields{{"AToBTransform", text}, {"AToBTransformStatus", "OK"}};
    const std::string said = refusal([&] { exchange::transforms_of(fields, "x.mha, frame 3"); });
    EXPECT_TRUE(said.starts_with("x.mha, frame 3, AToBTransform: ")) << said;
    EXPECT_NE(said.find("16 numbers"), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace sonoband::test
