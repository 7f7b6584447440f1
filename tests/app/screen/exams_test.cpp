// Exams on the screen: what review made comes back in a later run, also after a kill; delete, undo, damage.
#include <gtest/gtest.h>

#include <fstream>

#include "app/exam/exam_reader.h"
#include "tests/app/screen/screen_support.h"

namespace sonoband::test {
namespace {

namespace fs = std::filesystem;

ScreenCartSettings saving_into(const fs::path& folder) {
  ScreenCartSettings settings;
  settings.exams = folder / "exams";
  settings.screen.shots = folder / "shots";
  return settings;
}

bool all_saved(ScreenCart& cart) {
  const exam::RecorderStatus s = cart.cart().exams()->status();
  return s.state == exam::RecorderStatus::State::saved && s.stored == s.published;
}

std::vector<std::string> review_shown(const ScreenCart& cart) {
  const Session& session = cart.loop().session();
  std::vector<std::string> all;
  for (const exam::ReviewObject& o : objects_of(session.review_of(session.shown_id()), 1))
    all.push_back(o.object + " " + o.json);
  return all;
}

// What the exam's file holds, as `review_shown` tells it.
std::vector<std::string> review_stored(const fs::path& file) {
  std::vector<std::string> damage;
  std::vector<std::string> refused;
  const exam::ExamReader reader(file);
  std::vector<std::string> all;
  for (const exam::ReviewObject& o : objects_of(review_of(reader.review(damage), 1, refused), 1))
    all.push_back(o.object + " " + o.json);
  EXPECT_TRUE(damage.empty());
  EXPECT_TRUE(refused.empty());
  return all;
}

// To the last bit but for the plane: fitting it to a window and back rounds.
void expect_same(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!a[i].starts_with("sweep1/plane ")) {
      EXPECT_EQ(a[i], b[i]);
      continue;
    }
    const auto read = [](const std::string& text) {
      exam::ReviewObject o;
      o.object = "sweep1/plane";
      o.kind = exam::ReviewKind::plane;
      o.json = text.substr(text.find(' ') + 1);
      std::vector<std::string> refused;
      return review_of(std::span(&o, 1), 1, refused).plane.value();
    };
    const ReslicePlane p = read(a[i]);
    const ReslicePlane q = read(b[i]);
    EXPECT_LT((p.origin.v - q.origin.v).norm(), 1e-9);
    EXPECT_EQ(p.right.v, q.right.v);
    EXPECT_EQ(p.down.v, q.down.v);
    EXPECT_EQ(p.pixel_mm, q.pixel_mm);
    EXPECT_EQ(p.width, q.width);
    EXPECT_EQ(p.height, q.height);
  }
}

fs::path exam_in(const fs::path& folder) {
  for (const fs::directory_entry& e : fs::directory_iterator(folder))
    if (e.path().extension() == ".exam") return e.path();
  return {};
}

void record_and_review(ScreenCart& cart) {
  cart.play(R"(await live 5
wait 1.5
press
wait 1.5
release
await review 5
wait 0.2
drag tools/thickness 0.7,0.5 0.2,0.5 0.1
tap tools/mean
drag reslice/picture 0.5,0.5 0.55,0.56 0.1
tap tools/curve
drag reslice/picture 0.42,0.6 0.46,0.45 0.54,0.45 0.58,0.6 0.3
tap tools/mark
tap review/picture
tap tools/measure
tap review/picture
tap reslice/picture
tap tools/move
tap rail/snapshot
wait 0.5
)");
}

void open_first(ScreenCart& cart) {
  cart.play("tap rail/exams\n");
  ASSERT_TRUE(until(cart, [&] { return cart.has("exams/0"); }));
  cart.play("double-tap exams/0\n");
  ASSERT_TRUE(until(cart, [&] { return cart.loop().session().page() == ui::Page::review; }));
}

TEST(ExamsOnTheScreen, WhatReviewMadeComesBackInALaterRunAfterAKill) {
  const fs::path folder = scratch_folder();
  const fs::path killed = folder / "killed";
  std::vector<std::string> made;
  Pixels band;
  std::size_t frames = 0;
  {
    ScreenCartSettings settings = saving_into(folder);
    settings.pixels = true;  // of the snapshot
    ScreenCart cart(settings);
    record_and_review(cart);
    made = review_shown(cart);
    EXPECT_EQ(made.size(), 5u);  // plane, band, curve, landmark, measurement
    const fs::path file = exam_in(folder / "exams");
    ASSERT_TRUE(until(cart, [&] { return all_saved(cart) && review_stored(file).size() == made.size(); }));
    cart.play("wait 0.5\n");
    ASSERT_TRUE(until(cart, [&] { return all_saved(cart); }));
    expect_same(review_stored(file), made);
    // What a kill would leave.
    fs::create_directories(killed / "exams");
    for (const auto& entry : fs::directory_iterator(folder / "exams")) {
      std::error_code vanished;  // the index's journal comes and goes
      fs::copy_file(entry.path(), killed / "exams" / entry.path().filename(),
                    fs::copy_options::overwrite_existing, vanished);
    }
    cart.loop().wait_for_renderings();
    band = cart.loop().worker().newest()->planar->band.pixels.copy();
    frames = cart.loop().session().sweeps().back().held.view.frames.size();
  }
  for (const fs::path& place : {folder, killed}) {
    ScreenCart cart(saving_into(place));
    EXPECT_EQ(cart.cart().exams()->recovered().empty(), place == folder);
    open_first(cart);
    ASSERT_TRUE(until(cart, [&] { return cart.loop().view().review.frames.size() == frames; }));
    cart.play("wait 0.5\n");
    expect_same(review_shown(cart), made);
    // A sentence above the windows, gone after some seconds, makes them lower and the band another shape.
    std::shared_ptr<const RenderResult> shown;
    ASSERT_TRUE(until(cart, [&] {
      cart.loop().wait_for_renderings();
      shown = cart.loop().worker().newest();
      return shown->planar->band.pixels.width() == band.width();
    }));
    const Pixels& again = shown->planar->band.pixels;
    ASSERT_EQ(again.height(), band.height());
    int off = 0;
    for (int y = 0; y < band.height(); ++y)
      for (int x = 0; x < band.width(); ++x) off += again.view()(x, y) != band.view()(x, y);
    EXPECT_EQ(off, 0) << "of the band's pixels";
    ASSERT_TRUE(shown->manifold);
  }
}

TEST(ExamsOnTheScreen, AChangeToAnEarlierExamIsSavedIntoIt) {
  const fs::path folder = scratch_folder();
  {
    ScreenCart cart(saving_into(folder));
    record_and_review(cart);
  }
  const fs::path file = exam_in(folder / "exams");
  const std::vector<std::string> before = review_stored(file);
  {
    ScreenCart cart(saving_into(folder));
    open_first(cart);
    EXPECT_TRUE(until(cart, [&] { return !cart.loop().view().review.frames.empty(); }));
    cart.play("wait 0.5\n");
    EXPECT_EQ(review_stored(file), before) << "opening changes nothing";
    cart.play("tap tools/mark\ntap reslice/picture\nwait 0.5\n");
    EXPECT_TRUE(until(cart, [&] { return review_stored(file).size() == before.size() + 1; }));
  }
  EXPECT_EQ(review_stored(file).size(), before.size() + 1);
  const exam::ExamReader reader(file);
  EXPECT_TRUE(reader.verify().damage.empty());
  std::vector<std::string> damage;
  int snapshots = 0;
  for (const exam::ReviewObject& o : reader.review(damage))
    if (o.kind == exam::ReviewKind::snapshot && o.png.size() > 1000) ++snapshots;
  EXPECT_EQ(snapshots, 1);
}

TEST(ExamsOnTheScreen, DeletedExamsComeBackByUndoAndGoWithTheNextStart) {
  const fs::path folder = scratch_folder();
  fs::path file;
  {
    ScreenCart cart(saving_into(folder));
    cart.play("await live 5\nwait 1.5\npress\nwait 1\nrelease\nawait review 5\nwait 0.3\n");
    ASSERT_TRUE(until(cart, [&] { return all_saved(cart); }));
    file = exam_in(folder / "exams");
    cart.play("tap rail/exams\n");
    ASSERT_TRUE(until(cart, [&] { return cart.has("exams/0"); }));
    cart.play("tap exams/0\ntap exams/delete\n");
    ASSERT_TRUE(until(cart, [&] { return !cart.has("exams/0") && cart.has("exams/undo"); }));
    EXPECT_FALSE(fs::exists(file));
    EXPECT_EQ(cart.loop().session().sweep_count(), 0u);
    cart.play("tap exams/undo\n");
    ASSERT_TRUE(until(cart, [&] { return cart.has("exams/0"); }));
    EXPECT_TRUE(exam::ExamReader(file).verify().damage.empty());
    cart.play("double-tap exams/0\n");
    ASSERT_TRUE(until(cart, [&] { return !cart.loop().view().review.frames.empty(); }));
    cart.play("tap rail/exams\ntap exams/0\ntap exams/delete\n");
    ASSERT_TRUE(until(cart, [&] { return !cart.has("exams/0"); }));
  }
  EXPECT_TRUE(exam_in(folder / "exams").empty());
  for (const fs::directory_entry& e : fs::directory_iterator(folder / "exams"))
    EXPECT_EQ(e.path().filename().string().find(".deleted"), std::string::npos) << e.path();
}

TEST(ExamsOnTheScreen, ADamagedExamIsNamedAndTheOthersOpen) {
  const fs::path folder = scratch_folder();
  fs::create_directories(folder / "exams");
  std::ofstream(folder / "exams" / "20990101-000000-beef.exam") << "this is no exam at all";
  {
    ScreenCart cart(saving_into(folder));
    cart.play("await live 5\nwait 1.5\npress\nwait 1\nrelease\nawait review 5\nwait 0.3\ntap rail/exams\n");
    ASSERT_TRUE(until(cart, [&] { return cart.has("exams/1"); }));
    cart.play("double-tap exams/0\n");
    ASSERT_TRUE(until(cart, [&] { return cart.loop().view().notice.starts_with("It does not open"); }));
    EXPECT_NE(cart.loop().view().notice.find("20990101-000000-beef"), std::string_view::npos)
        << cart.loop().view().notice;
    EXPECT_EQ(cart.loop().session().page(), ui::Page::exams);
    cart.play("double-tap exams/1\n");
    EXPECT_TRUE(until(cart, [&] { return cart.loop().session().page() == ui::Page::review; }));
  }
}

}  // namespace
}  // namespace sonoband::test
