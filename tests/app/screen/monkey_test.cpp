// Random fingers, keys, presses, device faults and sizes: nothing crashes, no sweep is lost, memory stays.
// SONOBAND_MONKEY=N plays N actions (tools/monkey: 100,000 under the sanitizers); SONOBAND_MONKEY_SEED picks
// others.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <initializer_list>
#include <random>
#include <thread>
#include <utility>

#include "tests/app/screen/screen_support.h"

namespace sonoband::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

long number_from(const char* name, long otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtol(text, nullptr, 10);
}

// Of the process, KiB.
long resident_kib() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != "VmRSS:") continue;
    long kib = 0;
    status >> kib;
    return kib;
  }
  return 0;
}

class Monkey {
 public:
  Monkey(ScreenCart& cart, std::uint64_t seed) : cart_(cart), random_(seed) {}

  void act() {
    note_what_is_seen();
    switch (pick(21)) {
      case 0:
        return press();
      case 1:
        return key();
      case 2:
        return pinch();
      case 3:
        return wheel();
      case 4:
        return resize();
      case 5:
        return anywhere();
      case 6:
      case 7:
      case 8:
      case 9:
        return drag();
      case 10:
        return visit();
      default:
        return tap();
    }
  }
  void let_go() {
    if (down_) press();
  }
  int presses() const { return presses_; }
  struct Seen {
    long exams_pages = 0;
    long contours = 0;      // pictures with one
    long exports_done = 0;  // and how they ended
    long exports_failed = 0;
    long exports_cancelled = 0;
  };
  const Seen& seen() const { return seen_; }

 private:
  int pick(int below) { return static_cast<int>(random_() % static_cast<std::uint64_t>(below)); }
  float part() { return static_cast<float>(random_() % 10001) / 10000.0f; }
  void frames(int count) {
    for (int i = 0; i < count; ++i) cart_.player().frame();
  }
  ui::Vec2 place() {
    const auto& all = cart_.loop().screen().widgets().all();
    if (all.empty()) return {};
    const ui::Rect r = all[random_() % all.size()].rect;
    return {r.x + part() * r.width, r.y + part() * r.height};
  }
  void contact(ui::Contact::Kind kind, int id, ui::Vec2 at, float major_mm = 0) {
    cart_.player().input().contacts.push_back({cart_.clock().now(), kind, id, at, major_mm});
  }
  void tap() {
    const ui::Vec2 at = place();
    contact(ui::Contact::Kind::down, 0, at, pick(12) == 0 ? 30.0f : 8.0f);
    frames(1 + pick(2));
    contact(ui::Contact::Kind::up, 0, at);
    frames(1);
  }
  void drag() {
    ui::Vec2 at = place();
    const ui::Vec2 to = place();
    const int steps = 1 + pick(5);
    contact(ui::Contact::Kind::down, 0, at);
    frames(1);
    for (int i = 1; i <= steps; ++i) {
      at = at + (1.0f / static_cast<float>(steps - i + 1)) * (to - at);
      contact(ui::Contact::Kind::move, 0, at);
      frames(1);
    }
    contact(ui::Contact::Kind::up, 0, at);
    frames(1);
  }
  void pinch() {
    const ui::Vec2 centre = place();
    const float from = 10 + 200 * part();
    const float to = 10 + 200 * part();
    const float turn = part() - 0.5f;
    for (const int id : {0, 1})
      contact(ui::Contact::Kind::down, id, {centre.x + (id == 0 ? -from : from), centre.y});
    frames(1);
    for (int i = 1; i <= 3; ++i) {
      const float t = static_cast<float>(i) / 3;
      const float r = from + t * (to - from);
      const ui::Vec2 arm{r * std::cos(t * turn), r * std::sin(t * turn)};
      contact(ui::Contact::Kind::move, 0, centre - arm);
      contact(ui::Contact::Kind::move, 1, centre + arm);
      frames(1);
    }
    // One finger sometimes stays, or lifts twice.
    contact(ui::Contact::Kind::up, 0, centre);
    if (pick(4) != 0) contact(ui::Contact::Kind::up, 1, centre);
    frames(1);
    contact(ui::Contact::Kind::up, 1, centre);
  }
  void anywhere() {
    const ui::Vec2 size = cart_.surface().size_px();
    const auto kind = static_cast<ui::Contact::Kind>(pick(3));
    contact(kind, pick(12), {size.x * (2 * part() - 0.5f), size.y * (2 * part() - 0.5f)});
    frames(1);
    for (int id = 0; id < 12; ++id) contact(ui::Contact::Kind::up, id, {});
  }
  // Ways that random taps find seldom: a contour, an export.
  void visit() {
    switch (pick(4)) {
      case 0:
        press_on("rail/review");
        press_on("tools/contour");
        return draw_round(pick(2) == 0 ? "review/picture" : "reslice/picture");
      case 1:
        press_on("rail/exams");
        press_on("exams/0");
        press_on("exams/export");
        return export_something();
      case 2:
        press_on("rail/review");
        press_on("tools/move");
        press_on("tools/export");
        return export_something();
      default:
        return press_on(one_of({"exams/1", "exams/open", "exams/delete", "exams/undo", "export/start",
                                "export/cancel", "export/label", "sheet/close", "contour/clear"}));
    }
  }
  const char* one_of(std::initializer_list<const char*> names) {
    return names.begin()[pick(static_cast<int>(names.size()))];
  }
  // If it is there.
  void press_on(const char* name) {
    const auto widget = cart_.loop().screen().widgets().find(name);
    if (!widget || !widget->enabled) return;
    contact(ui::Contact::Kind::down, 0, widget->rect.centre());
    frames(1);
    contact(ui::Contact::Kind::up, 0, widget->rect.centre());
    frames(2);  // what it changed is drawn with the second
  }
  void draw_round(const char* name) {
    const auto widget = cart_.loop().screen().widgets().find(name);
    if (!widget) return;
    const ui::Vec2 at = widget->rect.centre();
    contact(ui::Contact::Kind::down, 0, at);
    frames(1);
    for (const ui::Vec2 step : {ui::Vec2{40, 0}, ui::Vec2{40, 30}, ui::Vec2{0, 30}}) {
      contact(ui::Contact::Kind::move, 0, at + step);
      frames(1);
    }
    contact(ui::Contact::Kind::up, 0, at + ui::Vec2{0, 30});
    frames(1);
  }
  void export_something() {
    // Which places there are is said by another thread.
    for (int i = 0; i < 20; ++i) {
      const auto start = cart_.loop().screen().widgets().find("export/start");
      if (!start || start->enabled) break;
      std::this_thread::sleep_for(milliseconds(1));
      frames(1);
    }
    press_on(one_of({"export/mha", "export/nrrd", "export/sw", "export/dicom", "export/png", "export/webm",
                     "export/marks"}));
    press_on("export/start");
    if (pick(3) == 0) press_on("export/cancel");
  }
  void note_what_is_seen() {
    const ui::View& view = cart_.loop().view();
    seen_.exams_pages += view.page == ui::Page::exams;
    seen_.contours +=
        cart_.loop().session().review_of(cart_.loop().session().shown_id()).contours.empty() ? 0 : 1;
    const ui::ExportPhase phase = view.exams.transfer.phase;
    if (phase == std::exchange(phase_, phase)) return;
    seen_.exports_done += phase == ui::ExportPhase::done;
    seen_.exports_failed += phase == ui::ExportPhase::failed;
    seen_.exports_cancelled += phase == ui::ExportPhase::cancelled;
  }
  void wheel() {
    cart_.player().input().wheels.push_back(
        {place(), {2 * part() - 1, 4 * part() - 2}, pick(3) == 0, pick(3) == 0});
    frames(1);
  }
  void key() {
    ui::KeyEvent event;
    event.key = static_cast<ui::Key>(pick(14));
    event.character = static_cast<char32_t>(33 + pick(94));
    if (event.character == U'q') event.character = U'w';
    event.control = pick(4) == 0;
    cart_.player().input().keys.push_back(event);
    frames(1);
  }
  void press() {
    down_ = !down_;
    presses_ += down_ ? 1 : 0;
    static_cast<void>(cart_.foot()(down_));  // false: a pedal with too many presses waiting
    frames(1 + pick(6));
  }
  void resize() {
    if (pick(10) != 0) return;
    cart_.surface().resize(640 + pick(1000), 480 + pick(500));
    frames(1);
  }

  ScreenCart& cart_;
  std::mt19937_64 random_;
  bool down_ = false;
  int presses_ = 0;
  Seen seen_;
  ui::ExportPhase phase_ = ui::ExportPhase::idle;
};

// Only the newest exam stays on the disk, and what was exported goes.
void tidy_up(ScreenCart& cart) {
  exam::CartExams& exams = *cart.cart().exams();
  std::error_code none;
  std::filesystem::remove_all(cart.options().shots, none);
  std::filesystem::remove_all(cart.options().exports.folder, none);
  exams.new_exam({});
  if (const auto list = exams.list()) {
    for (const exam::ExamSummary& e : *list)
      if (e.id != exams.exam_id()) exams.remove(e.id);
  }
}

// Every quarter of a minute something else goes wrong.
CartFaults faults_for(Duration length) {
  CartFaults faults;
  using Frame = sim::FrameFault::Kind;
  const Stamp start{seconds(1000)};
  const Frame frame_kinds[] = {Frame::stall, Frame::freeze, Frame::unplug, Frame::drop, Frame::cable_out};
  const sim::FaultKind tracker_kinds[] = {sim::FaultKind::unplugged, sim::FaultKind::station_silent,
                                          sim::FaultKind::distortion, sim::FaultKind::stream_stops,
                                          sim::FaultKind::power_cycle};
  int n = 0;
  for (Duration at = seconds(10); at < length; at += seconds(15), ++n) {
    sim::FrameFault frame;
    frame.kind = frame_kinds[n % 5];
    frame.from = at;
    frame.until = at + seconds(2);
    faults.frames.push_back(frame);
    sim::Fault tracker;
    tracker.at = start + at + seconds(5);
    tracker.kind = tracker_kinds[n % 5];
    tracker.value = 3;
    tracker.lasts = seconds(2);
    faults.tracker.push_back(tracker);
    if (n % 3 == 0)
      faults.pedal.push_back({sim::PedalFault::Kind::unplug, at + seconds(8), at + seconds(10)});
  }
  return faults;
}

// The thread sanitizer keeps up to four bytes for each byte that was touched.
#ifdef __SANITIZE_THREAD__
constexpr long resident_per_byte = 5;
#else
constexpr long resident_per_byte = 1;
#endif

TEST(Monkey, NeitherCrashesNorLosesASweepNorGrows) {
  const long actions = number_from("SONOBAND_MONKEY", 150);
  ScreenCartSettings settings;
  settings.screen.width = 800;
  settings.screen.height = 600;
  const std::filesystem::path folder = scratch_folder();
  settings.coarser = 4;
  settings.screen.shots = folder / "shots";
  settings.screen.exports.folder = folder / "exports";
  // No stick of the machine that runs the test.
  settings.screen.exports.media = {folder / "mountinfo", folder / "sys", folder / "labels"};
  settings.exams = folder / "exams";
  settings.ring_frames = 200;
  // An action takes some four frames.
  settings.faults = faults_for(actions * milliseconds(100) + seconds(10));
  ScreenCart cart(settings);
  cart.play("await live 5\nwait 1.2\n");
  Monkey monkey(cart, static_cast<std::uint64_t>(number_from("SONOBAND_MONKEY_SEED", 1)));
  long early_kib = 0;
  for (long i = 0; i < actions; ++i) {
    monkey.act();
    if (i == std::min(actions / 2, 2000L)) early_kib = resident_kib();
    ASSERT_EQ(cart.loop().screen().counts().gl_errors, 0u) << "after action " << i;
    if (i % 500 == 499) tidy_up(cart);
  }
  monkey.let_go();
  cart.play("wait 3\n");
  const cart::ApplianceStatus& status = cart.cart().status();
  // Each sweep that began was handed over and listed, or was told of as refused.
  EXPECT_EQ(status.sweeps_refused, 0u);
  EXPECT_EQ(cart.loop().sweeps_taken(), status.sweeps_handed);
  EXPECT_TRUE(status.cart.acquisition.ledger.balanced());
  EXPECT_GT(status.sweeps_handed, 0u);
  const Monkey::Seen& seen = monkey.seen();
  if (actions >= 5000) {
    EXPECT_GT(seen.exams_pages, 0);
    EXPECT_GT(seen.contours, 0);
    EXPECT_GT(seen.exports_done, 0);
  }
  std::printf("%ld actions; exams page %ld, contours %ld, exports %ld done, %ld failed, %ld cancelled\n",
              actions, seen.exams_pages, seen.contours, seen.exports_done, seen.exports_failed,
              seen.exports_cancelled);
  // Fonts, pictures of larger windows and a drag's layers come and go; a leak of a frame's picture would be
  // 300 KiB each.
  const auto layers_kib = static_cast<long>(RenderLimits{}.layer_bytes >> 10);
  EXPECT_LT(resident_kib() - early_kib, resident_per_byte * (100 * 1024 + layers_kib));
}

}  // namespace
}  // namespace sonoband::test
