// The speed of the screen over a scripted minute: acquisition at 60 pictures a second in real time, on the
// software rasteriser, as a table; then drags on the render thread alone. screen_bench [SECONDS] (0: only
// these)
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
#include "tests/support/speed_sweep.h"
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
  Hand(const Foot& foot, ScreenLoop& loop) : foot_(foot), loop_(loop) {}

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
  const Foot& foot_;
  ScreenLoop& loop_;
  bool pedal_ = false;
  bool held_ = false;
};

// A frame, to see what the dearest ones are.
struct Dear {
  double cpu_ms = 0, at_s = 0;
  bool live = false;
  double view_ms = 0, panels_ms = 0, gl_ms = 0;
  std::uint64_t uploads = 0, scenes = 0;
  double allocations = 0;
};

void print_dearest(std::vector<Dear>& frames) {
  const auto some = std::min<std::size_t>(frames.size(), 8);
  std::partial_sort(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(some), frames.end(),
                    [](const Dear& a, const Dear& b) { return a.cpu_ms > b.cpu_ms; });
  std::printf("The dearest frames:\n");
  for (std::size_t i = 0; i < some; ++i) {
    const Dear& d = frames[i];
    std::printf(
        "  %5.1f cpu ms at %6.2f s, %s: view %.2f, panels %.2f, driver's call %.1f; pictures sent %llu, "
        "outline "
        "drawn %llu, allocations %.0f\n",
        d.cpu_ms, d.at_s, d.live ? "Live" : "Review", d.view_ms, d.panels_ms, d.gl_ms,
        static_cast<unsigned long long>(d.uploads), static_cast<unsigned long long>(d.scenes), d.allocations);
  }
}

double ms(Duration d) {
  return sonoband::seconds(d) * 1e3;
}

// A finger on the strip over the agreed work, so many layers a step, each step asked for once the one before
// and what is got ready after it are done: what the render thread takes for the band of each step.
void measure_drags() {
  const test::TestSweep sweep = test::speed_sweep({});
  std::printf("\n| drag over 640 x 480, 14 mm, 200 B-scans: cpu ms of a step | %7s | %7s | %7s | %6s |\n",
              "p50", "p95", "worst", "n");
  for (const auto& plane : test::speed_planes()) {
    for (const int layers : {1, 8, 17}) {
      RenderWorker worker(1);
      RenderRequest request;
      request.sweep = {sweep.view(), nullptr};
      request.sweep_version = 1;
      request.plane = plane.plane;
      request.settings.band = {14, 0.2};
      request.drag_ahead = true;
      worker.ask(request);
      worker.wait();
      request.drag_ahead = false;
      request.moving = true;
      const std::string name = "drag, " + plane.name + ", layers a step: " + std::to_string(layers);
      Series steps{name.c_str(), {}};
      for (int i = 0; i < 60; ++i) {
        const int there = i % 20 < 10 ? layers : -layers;  // and back
        request.plane.origin.v += there * 0.2 * request.plane.normal().v;
        worker.ask(request);
        worker.wait();
        steps.add(worker.newest()->planar->thread_ms);
      }
      steps.print();
    }
  }
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
    const Duration made_from = thread_time();
    ScreenLoop loop(*cart, board.foot, {}, surface);
    const double start_ms = ms(thread_time() - made_from);
    Hand hand(board.foot, loop);
    Series view{"the cart's news into the view, cpu ms", {}}, panels{"panels built, cpu ms", {}};
    Series outside{"a frame outside the rasteriser, cpu ms", {}};
    Series live_frames{"a frame of Live with the rasteriser, cpu ms", {}};
    Series review_frames{"a frame of Review with the rasteriser, cpu ms", {}};
    Series frames{"a whole frame by the clock, ms", {}};
    Series band{"finger event to the frame with the new band, ms", {}};
    Series band_cpu{"of that, outside the rasteriser: screen + render, cpu ms", {}};
    Series render{"of that, the render thread until there is a band, cpu ms", {}};
    Series render_layers{"  out of layers", {}}, render_coarse{"  coarse", {}}, render_whole{"  whole", {}};
    Series sending{"of that, pictures sent, cpu ms a frame", {}};
    Series queue{"of the wait, until the render thread took it up, ms", {}};
    Series first{"the first frame, cpu ms", {}};
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
    std::uint64_t most_layer_bytes = 0;
    ReslicePlane last_plane, event_plane;
    std::vector<Dear> dear;  // frames of the screen
    int last_layers = 0;
    std::uint64_t uploads = 0, scenes = 0;
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
        if (const auto before = loop.worker().newest(); before && !waiting)
          event_plane = before->planar->plane;
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
        const double own = ms(times.view + times.panels + times.sending + times.commands);
        outside.add(own);
        sending.add(ms(times.sending));
        worked += own;
        const bool live = loop.session().page() == ui::Page::live;
        (live ? live_frames : review_frames).add(frame_cpu);
        ++without;
        frames.add(Ms(end - start).count());
        dear.push_back({frame_cpu, t, live, ms(times.view), ms(times.panels), ms(times.gl),
                        loop.screen().counts().uploads - uploads, loop.screen().counts().scenes - scenes,
                        allocations});
        uploads = loop.screen().counts().uploads;
        scenes = loop.screen().counts().scenes;
        if (loop.session().page() == ui::Page::live) age.add(loop.view().status.scanner.age_ms);
        const auto result = loop.worker().newest();
        if (result && result->version != shown) {
          shown = result->version;
          most_layer_bytes = std::max(most_layer_bytes, loop.worker().counts().layer_bytes);
          last_plane = result->planar->plane;
          last_layers = result->planar->layers;
          if (hand.dragging() && waiting) still.add(without);
          without = 0;
          // Not the same band once more, in full, as the finger rests.
          const bool moved = result->planar->plane.origin.v != event_plane.origin.v;
          if (waiting && shown > awaited && moved) {
            band.add(Ms(end - event).count());
            band_cpu.add(worked + result->planar->first_ms);
            render.add(result->planar->first_ms);
            const PlanarPicture& p = *result->planar;
            (p.coarse ? render_coarse : (p.from_layers ? render_layers : render_whole)).add(p.thread_ms);
            queue.add(result->waited_ms);
            waiting = false;
          }
        }
        if (finger && !waiting && loop.worker().counts().asked != asked) {
          event = start;
          worked = own;
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
    for (Series* s :
         {&view, &panels, &outside, &live_frames, &review_frames, &first, &frames, &band, &band_cpu, &render,
          &render_layers, &render_coarse, &render_whole, &sending, &queue, &still, &age, &heap})
      s->print();
    const LossLedger& ledger = cart->status().cart.acquisition.ledger;
    const auto over =
        std::count_if(frames.values.begin(), frames.values.end(), [](double ms) { return ms > 50; });
    std::printf(
        "\nAcquired %llu pictures, lost %llu, skipped by the device %llu; frames of the screen over 50 ms: "
        "%lld; "
        "GL errors: %llu; kinds of draw call %llu, first met in a frame %llu\n",
        static_cast<unsigned long long>(ledger.received),
        static_cast<unsigned long long>(ledger.all_lost() - ledger.lost_for(LossCause::duplicate)),
        static_cast<unsigned long long>(ledger.device_gap), static_cast<long long>(over),
        static_cast<unsigned long long>(loop.screen().counts().gl_errors),
        static_cast<unsigned long long>(loop.screen().counts().kinds),
        static_cast<unsigned long long>(loop.screen().counts().late_kinds));
    std::printf(
        "At the start, before there is a window: fonts, and every kind of draw call once: %.0f cpu ms\n",
        start_ms);
    print_dearest(dear);
    const RenderWorker::Counts jobs = loop.worker().counts();
    std::printf(
        "Bands asked for %llu, painted %llu, of them out of layers %llu; coarse ones shown first %llu, "
        "planar ones before their manifolds %llu; "
        "layers "
        "got ready between in %.0f cpu ms of the render thread, %.0f MB kept at most; the band has %d x %d "
        "pixels and %d layers\n",
        static_cast<unsigned long long>(jobs.asked), static_cast<unsigned long long>(jobs.done),
        static_cast<unsigned long long>(jobs.from_layers), static_cast<unsigned long long>(jobs.coarse),
        static_cast<unsigned long long>(jobs.early), jobs.layers_ms,
        static_cast<double>(most_layer_bytes) / 1e6, last_plane.width, last_plane.height, last_layers);
  }
  cart->stop();
}

}  // namespace
}  // namespace sonoband

int main(int argc, char** argv) {
  ::setenv("LP_NUM_THREADS", "0", 1);
  // As on a cart whose driver has kept nothing of an earlier run.
  ::setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
  const double seconds = argc > 1 ? std::strtod(argv[1], nullptr) : 60;
  try {
    if (seconds > 0) sonoband::measure(seconds);
    sonoband::measure_drags();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "screen_bench: %s\n", e.what());
    return 1;
  }
  return 0;
}
