// Every action is understood, and whatever is not is refused with file, line and cure.
#include "app/script/script.h"

#include <gtest/gtest.h>

#include "app/bad_input.h"

namespace sonoband::script {
namespace {

std::string refusal(const std::string& text) {
  try {
    parse(text, "exam.script");
  } catch (const BadInput& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Script, UnderstandsEveryAction) {
  const auto steps = parse(R"(# an examination
wait 1.5
press
release   # the pedal
await review 10
render thick.png thickness-mm=14 compounding=mean interpolation=linear view=level at=0.4
manifold spine.png curve=1,2;3,4.5 reach-mm=12 thickness-mm=7.2
)",
                           "exam.script");
  ASSERT_EQ(steps.size(), 6u);
  EXPECT_EQ(std::get<Wait>(steps[0].action).time, from_seconds(1.5));
  EXPECT_EQ(steps[1].line, 3);
  EXPECT_TRUE(std::holds_alternative<Press>(steps[1].action));
  EXPECT_TRUE(std::holds_alternative<Release>(steps[2].action));
  EXPECT_EQ(std::get<Await>(steps[3].action).state, "review");
  const auto& render = std::get<Render>(steps[4].action);
  EXPECT_EQ(render.settings.band.thickness_mm, 14);
  EXPECT_EQ(render.settings.compounding, Compounding::mean);
  EXPECT_EQ(render.settings.interpolation, Interpolation::linear);
  EXPECT_EQ(render.view, "level");
  EXPECT_EQ(render.at, 0.4);
  const auto& manifold = std::get<Manifold>(steps[5].action);
  ASSERT_EQ(manifold.curve_mm.size(), 2u);
  EXPECT_EQ(manifold.curve_mm[1].y(), 4.5);
  EXPECT_EQ(manifold.reach_mm, 12);
  EXPECT_EQ(manifold.plane.settings.band.thickness_mm, 7.2);
}

TEST(Script, RefusalsNameFileLineAndCure) {
  EXPECT_EQ(
      refusal("\nstep on it\n"),
      "exam.script:2: there is no action 'step'; there are wait, press, release, await, render and manifold");
  EXPECT_EQ(refusal("wait soon"), "exam.script:1: seconds must be a number from 0 to 3600, not 'soon'");
  EXPECT_EQ(refusal("await done 3"),
            "exam.script:1: the states are idle, live, recording and review, not 'done'");
  EXPECT_EQ(refusal("render band.jpg"), "exam.script:1: render needs the name of a .png file first");
  EXPECT_EQ(refusal("render ../band.png"),
            "exam.script:1: pictures go into a folder of their own: give a name without '/'");
  EXPECT_EQ(refusal("render a.png compounding=sum"),
            "exam.script:1: compounding must be max, min or mean, not 'sum'");
  EXPECT_EQ(refusal("render a.png thick"),
            "exam.script:1: 'thick' is no option; options are written name=value");
  EXPECT_EQ(refusal("manifold a.png curve=1,2"), "exam.script:1: curve needs at least two points");
  EXPECT_EQ(refusal("press now"), "exam.script:1: press stands alone on its line");
}

TEST(Script, TheDefaultExaminationIsOne) {
  EXPECT_GT(parse(default_text(), "default").size(), 5u);
}

}  // namespace
}  // namespace sonoband::script
