// The speed of the screen over a scripted minute: acquisition at 60 pictures a second in real time, on the
// software rasteriser, as a table. screen_bench [SECONDS]
//
// "cpu" is processor time of the screen's thread, which other work on the machine does not change. The
// rasteriser is told to work on that thread, so that its share is in it.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "app/cart_on_board.h"
#include "app/screen/loop.h"
#include "app/thread_time.h"
#include "tests/support/allocation_counter.h"
#include "ui/host/headless.h"

namespace sonoband {
namespace {

using Steady = std::chrono::steady_clock;
using Ms = std::chrono::duration<double, std::milli>;

struct Series {
  const char* name;
  std::vector<double> values;
  void add(double v) { values.push_back(v); }
  void print() {
    if (values.empty()) return;
    std::sort(values.begin(), values.end());
    const auto at = [&](double part) {
      return values[std::min(values.size() - 1,
                             static_cast<std::size_t>(part * static_cast<double>(values.size())))];
    };
    std::printf("| %-58s | %7.2f | %7.2f | %7.2f | %6zu |\n", name, at(0.5), at(0.95), values.back(),
                values.size());
  }
};

// What a hand does, over and over: 5 s live with a sweep, then drags of the plane at 60 events a second.
class Hand {
 public:
  Hand(cart::Appliance& cart, const Foot& foot, ScreenLoop& loop) : cart_(cart), foot_(foot), loop_(loop) {}

  // Adds to `input` what happens at `t` seconds of the session.
  void act(double t, ui::Input& input, Stamp now) {
    const double in_round = t - 20 * std::floor(t / 20);
    const bool down = in_round > 2 && in_round < 7;
    if (down != pedal_) {
      pedal_ = down;
      static_cast<void>(foot_(down));
    }
    if (in_round < 7 && loop_.session().page() != ui::Page::live && in_round < 2 && t > 3)
      tap("rail/live", input, now);
    if (in_round < 8.5) return;
    const auto widget = loop_.screen().widgets().find("reslice/normal");
    if (!widget) return;
    const ui::Vec2 at{
        widget->rect.centre().x,
        widget->rect.centre().y + 0.3f * widget->rect.height * std::sin(static_cast<float>(t) * 2)};
    input.contacts.push_back({now, held_ ? ui::Contact::Kind::move : ui::Contact::Kind::down, 0, at, 8});
    held_ = in_round < 19.5;
    if (!held_) input.contacts.push_back({now, ui::Contact::Kind::up, 0, at, 8});
  }
  bool dragging() const { return held_; }

 private:
  void tap(const char* name, ui::Input& input, Stamp now) {
    const auto widget = loop_.screen().widgets().find(name);
    if (!widget) return;
    for (const auto kind : {ui::Contact::Kind::down, ui::Contact::Kind::up})
      input.contacts.push_back({now, kind, 0, widget->rect.centre(), 8});
  }
  cart::Appliance& cart_;
  const Foot& foot_;
  ScreenLoop& loop_;
  bool pedal_ = false;
  bool held_ = false;
};

double ms(Duration d) {
  return sonoband::seconds(d) * 1e3;
}

void measure(double length_s) {
  auto clock = std::make_shared<SystemClock>();
  Profile profile;
  profile.capture.rate_hz = 60;
  BoardDevices board = make_sim_board(profile, *clock);
  auto cart = make_appliance(board, profile, clock);
  cart->start();
  {
    ui::HeadlessSurface surface(1280, 800);
    ScreenLoop loop(*cart, board.foot, {}, surface);
    Hand hand(*cart, board.foot, loop);
    Series view{"the cart's news into the view, cpu ms", {}}, panels{"panels built, cpu ms", {}};
    Series outside{"a frame outside the rasteriser, cpu ms", {}};
    Series live_frames{"a frame of Live with the rasteriser, cpu ms", {}};
    Series review_frames{"a frame of Review with the rasteriser, cpu ms", {}};
    Series frames{"a whole frame by the clock, ms", {}};
    Series band{"finger event to the frame with the new band, ms", {}};
    Series band_cpu{"of that, outside the rasteriser: screen + render, cpu ms", {}};
    Series render{"of that, the 14 mm band on the render thread, cpu ms", {}};
    Series first{"the first frame: fonts and shaders are made, cpu ms", {}};
    Series still{"while dragging: frames drawn from an event to its band", {}};
    Series age{"live: age of the newest picture when drawn, ms", {}};
    Series heap{"live and review: allocations of a frame", {}};
    ui::Input input;
    const auto begun = Steady::now();
    Steady::time_point event{};
    bool waiting = false;  // for the band of the finger at `event`
    double worked = 0;     // cpu ms outside the rasteriser since then
    int without = 0;       // frames drawn since the last new band
    std::uint64_t shown = 0, awaited = 0;
    auto next = begun;
    for (double t = 0; t < length_s; t = std::chrono::duration<double>(Steady::now() - begun).count()) {
      const Stamp now = cart->clock().now();
      hand.act(t, input, now);
      const bool news = loop.listen(now);
      if (news || !input.empty()) {
        const bool finger = hand.dragging() && !input.empty();
        const auto start = Steady::now();
        const Duration cpu = thread_time();
        const std::uint64_t asked = loop.worker().counts().asked;
        double allocations = 0;
        {
          const test::AllocationCounter counter;
          loop.draw(input, now);
          allocations = static_cast<double>(counter.count());
        }
        // llvmpipe draws when it is asked for the result.
        surface.finish();
        const auto end = Steady::now();
        const double frame_cpu = ms(thread_time() - cpu);
        const auto& times = loop.times();
        if (first.values.empty()) {
          first.add(frame_cpu);
          input.clear();
          continue;
        }
        heap.add(allocations);
        view.add(ms(times.view));
        panels.add(ms(times.panels));
        outside.add(ms(times.view + times.panels + times.commands));
        worked += ms(times.view + times.panels + times.commands);
        const bool live = loop.session().page() == ui::Page::live;
        (live ? live_frames : review_frames).add(frame_cpu);
        ++without;
        frames.add(Ms(end - start).count());
        if (loop.session().page() == ui::Page::live) age.add(loop.view().status.scanner.age_ms);
        const auto result = loop.worker().newest();
        if (result && result->version != shown) {
          shown = result->version;
          if (hand.dragging() && waiting) still.add(without);
          without = 0;
          if (waiting && shown > awaited) {
            band.add(Ms(end - event).count());
            band_cpu.add(worked + result->planar->thread_ms);
            render.add(result->planar->thread_ms);
            waiting = false;
          }
        }
        if (finger && !waiting && loop.worker().counts().asked != asked) {
          event = start;
          worked = ms(times.view + times.panels + times.commands);
          waiting = true;
          without = 0;
          awaited = shown;
        }
        input.clear();
      }
      next = std::max(next + std::chrono::microseconds(16667), Steady::now());
      std::this_thread::sleep_until(next);
    }
    std::printf("| %-58s | %7s | %7s | %7s | %6s |\n|%s|--------:|--------:|--------:|-------:|\n",
                "1280 x 800, acquisition at 60 a second", "p50", "p95", "worst", "n",
                std::string(60, '-').c_str());
    for (Series* s : {&view, &panels, &outside, &live_frames, &review_frames, &first, &frames, &band,
                      &band_cpu, &render, &still, &age, &heap})
      s->print();
    const LossLedger& ledger = cart->status().cart.acquisition.ledger;
    const auto over =
        std::count_if(frames.values.begin(), frames.values.end(), [](double ms) { return ms > 50; });
    std::printf(
        "\nAcquired %llu pictures, lost %llu, skipped by the device %llu; frames of the screen over 50 ms: "
        "%lld; "
        "GL errors: %llu\n",
        static_cast<unsigned long long>(ledger.received),
        static_cast<unsigned long long>(ledger.all_lost() - ledger.lost_for(LossCause::duplicate)),
        static_cast<unsigned long long>(ledger.device_gap), static_cast<long long>(over),
        static_cast<unsigned long long>(loop.screen().counts().gl_errors));
  }
  cart->stop();
}

}  // namespace
}  // namespace sonoband

int main(int argc, char** argv) {
  ::setenv("LP_NUM_THREADS", "0", 1);
  const double seconds = argc > 1 ? std::strtod(argv[1], nullptr) : 60;
  try {
    sonoband::measure(seconds > 0 ? seconds : 60);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "screen_bench: %s\n", e.what());
    return 1;
  }
  return 0;
}
