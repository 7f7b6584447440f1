// Every page in every state draws, without a GL error, without the heap once warm, and says what fingers did.
#include <gtest/gtest.h>

#include <functional>

#include "tests/support/allocation_counter.h"
#include "tests/ui/showcase.h"

namespace sonoband::test {
namespace {

struct Page {
  const char* name;
  ui::View (*view)();
};
ui::View export_view(ui::ExportPhase phase, ui::ExportAs format = ui::ExportAs::mha,
                     std::string_view sentence = {}) {
  ui::View view = exams_view();
  view.sheet = ui::Sheet::export_exam;
  ui::ExportView& e = view.exams.transfer;
  e.phase = phase;
  e.choice.format = format;
  e.choice.one_sweep = true;
  e.where = phase == ui::ExportPhase::done ? "/media/ULTRASOUND/sonoband-20261122-091200-3fa9" : "ULTRASOUND";
  e.done = 0.43;
  e.files = 3;
  e.sentence = sentence;
  return view;
}
ui::View export_choice() {
  return export_view(ui::ExportPhase::idle, ui::ExportAs::dicom);
}
ui::View export_running() {
  return export_view(ui::ExportPhase::exporting);
}
ui::View export_failed() {
  return export_view(ui::ExportPhase::failed, ui::ExportAs::mha,
                     "/media/ULTRASOUND/sonoband-20261122-091200-3fa9/20261122-091200-3fa9-sweep2.igs.mha: "
                     "cannot be written: "
                     "a disk formatted as FAT has no file of 4 GiB and more; use one formatted as exFAT, or "
                     "export one sweep "
                     "at a time, as pictures (png) or as a movie");
}
ui::View export_done() {
  return export_view(ui::ExportPhase::done, ui::ExportAs::mha,
                     "sweep 2, frame 7: the picture is damaged and left out (and 2 more)");
}
ui::View export_removed() {
  return export_view(ui::ExportPhase::removed);
}
ui::View export_without_place() {
  ui::View view = export_choice();
  view.exams.transfer.places = {};
  return view;
}

const Page pages[] = {{"live", live_view},
                      {"recording", recording_view},
                      {"review", review_view},
                      {"exams", exams_view},
                      {"set-up", set_up_view},
                      {"export", export_choice},
                      {"export-running", export_running},
                      {"export-failed", export_failed},
                      {"export-done", export_done},
                      {"export-removed", export_removed},
                      {"export-without-place", export_without_place}};

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

// What a finger is to hit, that is everything that has a name but the pictures' own places.
TEST(Pages, EveryTargetIsNineMillimetresWideAndHigh) {
  const float nine_mm = 9 * 5.9f - 0.5f;
  for (const float scale : {1.0f, 1.5f}) {
    Bench bench(1280, 800, scale);
    for (const Page& page : pages) {
      bench.frame(page.view());
      for (const ui::Widget& widget : bench.screen->widgets().all()) {
        const std::string_view name = widget.name.data();
        if (name == "live/speed" || name == "set-up/storage" || name == "set-up/devices") continue;
        EXPECT_GE(widget.rect.height, nine_mm) << page.name << ", scale " << scale << ": " << name;
        EXPECT_GE(widget.rect.width, nine_mm) << page.name << ", scale " << scale << ": " << name;
      }
    }
  }
}

// The last picture before the signal went stays to be seen, but not as a live one.
TEST(Pages, APictureWithoutASignalIsNotShownAsLive) {
  Bench bench(1280, 800, 1, true);
  const auto brightness = [&](ui::Health scanner) {
    ui::View view = live_view();
    view.live.first_time = false;
    view.status.scanner.health = scanner;
    bench.frame(view);
    const ui::Rect place = bench.find("live/picture").inset(80);
    const ui::Rgba seen = bench.surface.read();
    double sum = 0;
    for (auto y = static_cast<int>(place.y); y < static_cast<int>(place.bottom()); ++y)
      for (auto x = static_cast<int>(place.x); x < static_cast<int>(place.right()); ++x)
        sum += seen.bytes[static_cast<std::size_t>(y * seen.width + x) * 4];
    return sum;
  };
  const double live = brightness(ui::Health::good);
  EXPECT_GT(live, 0);
  EXPECT_NEAR(brightness(ui::Health::degraded), live, 0.01 * live);
  for (const ui::Health gone : {ui::Health::absent, ui::Health::silent, ui::Health::fault})
    EXPECT_LT(brightness(gone), 0.5 * live);
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
