// Every page in every state draws, without a GL error, without the heap once warm, and says what fingers did.
#include <gtest/gtest.h>

#include <functional>

#include "tests/support/allocation_counter.h"
#include "tests/ui/showcase.h"

namespace sonoband::test {
namespace {

namespace command = ui::command;

struct Page {
  const char* name;
  ui::View (*view)();
};
const Page pages[] = {{"live", live_view},
                      {"recording", recording_view},
                      {"review", review_view},
                      {"exams", exams_view},
                      {"set-up", set_up_view}};

TEST(Pages, DrawAtEverySizeAndScaleWithoutGlErrors) {
  const struct {
    int width, height;
    float scale;
    const char* name;
  } screens[] = {{1280, 800, 1, ""},
                 {1280, 800, 1.5f, "-large"},
                 {1920, 1080, 1, "-hd"},
                 {1920, 1080, 1.5f, "-hd-large"}};
  for (const auto& s : screens) {
    Bench bench(s.width, s.height, s.scale);
    for (const Page& page : pages) {
      bench.frame(page.view());
      bench.frame(page.view());
      bench.shot(std::string(page.name) + s.name);
    }
  }
}

TEST(Pages, TargetsAreNineMillimetresHigh) {
  Bench bench;
  const float nine_mm = 9 * 5.9f - 0.5f;
  for (const Page& page : pages) {
    bench.frame(page.view());
    for (const char* name :
         {"rail/live", "rail/set-up", "status/tracker", "live/record", "tools/maximum", "tools/curve",
          "tools/thickness", "reslice/trackball", "exams/new", "exams/0", "set-up/toggle"}) {
      const auto widget = bench.screen->widgets().find(name);
      if (!widget) continue;
      EXPECT_GE(widget->rect.height, nine_mm) << name;
      EXPECT_GE(widget->rect.width, nine_mm) << name;
    }
  }
}

TEST(Pages, NoHeapOnceWarm) {
  Bench bench;
  for (const Page& page : pages) {
    const ui::View view = page.view();
    for (int i = 0; i < 3; ++i) bench.frame(view);
    const AllocationCounter counter;
    bench.frame(view);
    EXPECT_EQ(counter.count(), 0u) << page.name;
  }
}

TEST(Pages, PicturesAreSentOnlyWhenTheyChange) {
  Bench bench;
  ui::View view = review_view();
  for (int i = 0; i < 3; ++i) bench.frame(view);
  const auto before = bench.screen->counts();
  bench.frame(view);
  EXPECT_EQ(bench.screen->counts().uploads, before.uploads);
  EXPECT_EQ(bench.screen->counts().scenes, before.scenes);
  view.review.bscan.version += 1;
  bench.frame(view);
  EXPECT_EQ(bench.screen->counts().uploads, before.uploads + 1);
  view.review.orbit.turn_rad += 0.1;
  bench.frame(view);
  EXPECT_EQ(bench.screen->counts().scenes, before.scenes + 1);
}

}  // namespace
}  // namespace sonoband::test
