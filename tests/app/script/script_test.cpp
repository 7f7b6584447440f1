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
watch
render thick.png thickness-mm=14 compounding=mean interpolation=linear view=level at=0.4
manifold spine.png curve=1,2;3,4.5 reach-mm=12 thickness-mm=7.2
)",
                           "exam.script");
  ASSERT_EQ(steps.size(), 7u);
  EXPECT_EQ(std::get<Wait>(steps[0].action).time, from_seconds(1.5));
  EXPECT_EQ(steps[1].line, 3);
  EXPECT_TRUE(std::holds_alternative<Press>(steps[1].action));
  EXPECT_TRUE(std::holds_alternative<Release>(steps[2].action));
  EXPECT_EQ(std::get<Await>(steps[3].action).state, "review");
  EXPECT_TRUE(std::holds_alternative<WatchCart>(steps[4].action));
  const auto& render = std::get<Render>(steps[5].action);
  EXPECT_EQ(render.settings.band.thickness_mm, 14);
  EXPECT_EQ(render.settings.compounding, Compounding::mean);
  EXPECT_EQ(render.settings.interpolation, Interpolation::linear);
  EXPECT_EQ(render.view, "level");
  EXPECT_EQ(render.at, 0.4);
  const auto& manifold = std::get<Manifold>(steps[6].action);
  ASSERT_EQ(manifold.curve_mm.size(), 2u);
  EXPECT_EQ(manifold.curve_mm[1].y(), 4.5);
  EXPECT_EQ(manifold.reach_mm, 12);
  EXPECT_EQ(manifold.plane.settings.band.thickness_mm, 7.2);
}

TEST(Script, UnderstandsFingers) {
  const auto steps = parse(R"(tap tools/curve
double-tap reslice/picture
hold review/picture 0.8
drag reslice/picture 0.2,0.5 0.8,0.4 1.5
pinch reslice/picture 1.5
twist reslice/picture 90
key page-up
key v
shot review.png
where rail/exams
await-page set-up 60
)",
                           "exam.script");
  ASSERT_EQ(steps.size(), 11u);
  EXPECT_TRUE(needs_screen(steps));
  const auto action = [&](std::size_t i) { return std::get<ScreenAction>(steps[i].action); };
  EXPECT_EQ(std::get<Tap>(action(0)).widget, "tools/curve");
  EXPECT_EQ(std::get<Tap>(action(1)).times, 2);
  EXPECT_EQ(std::get<Hold>(action(2)).time, from_seconds(0.8));
  const auto drag = std::get<Drag>(action(3));
  ASSERT_EQ(drag.way.size(), 2u);
  EXPECT_EQ(drag.way[1], (ui::Vec2{0.8f, 0.4f}));
  EXPECT_EQ(drag.time, from_seconds(1.5));
  EXPECT_EQ(std::get<TwoFingers>(action(4)).scale, 1.5f);
  EXPECT_FLOAT_EQ(std::get<TwoFingers>(action(5)).turn_rad, 1.5707964f);
  EXPECT_EQ(std::get<KeyPress>(action(6)).key.key, ui::Key::page_up);
  EXPECT_EQ(std::get<KeyPress>(action(7)).key.character, U'v');
  EXPECT_EQ(std::get<Shot>(action(8)).file, "review.png");
  EXPECT_EQ(std::get<Where>(action(9)).widget, "rail/exams");
  EXPECT_EQ(std::get<AwaitPage>(action(10)).page, ui::Page::set_up);
  EXPECT_EQ(std::get<AwaitPage>(action(10)).at_most, from_seconds(60));
  EXPECT_FALSE(needs_screen(parse("press\nwait 1\nrelease\n", "exam.script")));
}

TEST(Script, RefusalsOfFingersNameFileLineAndCure) {
  EXPECT_EQ(refusal("tap"), "exam.script:1: tap is written as in: tap tools/curve");
  EXPECT_EQ(
      refusal("drag reslice/picture 0.5,0.5"),
      "exam.script:1: drag needs a widget and at least two places: drag reslice/picture 0.2,0.5 0.8,0.5");
  EXPECT_EQ(refusal("drag reslice/picture 0.5 0.5,0.6 0.7,0.7"),
            "exam.script:1: '0.5' is no place; write x,y in parts of the widget, as in 0.5,0.5");
  EXPECT_EQ(refusal("pinch reslice/picture 9"),
            "exam.script:1: the scale must be a number from 0.2 to 5, not '9'");
  EXPECT_EQ(refusal("key any"), "exam.script:1: there is no key 'any'");
  EXPECT_EQ(refusal("await-page help 5"),
            "exam.script:1: the pages are live, review, exams and set-up, not 'help'");
  EXPECT_EQ(refusal("await-page exams"), "exam.script:1: await-page is written as in: await-page exams 60");
  EXPECT_EQ(refusal("tap rail/live\nrender thin.png"),
            "exam.script:2: render and manifold work without the screen; take a shot instead");
  EXPECT_EQ(refusal("watch\ntap rail/live"),
            "exam.script:1: watch works without the screen; take a shot instead");
}

TEST(Script, RefusalsNameFileLineAndCure) {
  EXPECT_EQ(refusal("\nstep on it\n"),
            "exam.script:2: there is no action 'step'; there are wait, press, release, await, watch, render "
            "and manifold, and with the screen tap, double-tap, hold, drag, pinch, twist, key, shot, where "
            "and await-page");
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
