// A window that tells what fingers and mouse do on it: listener SECONDS. Prints each change of a contact and,
// at the end, what the gesture layer made of all.
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <string>
#include <vector>

#include "hal/clock.h"
#include "ui/host/window.h"

int main(int argc, char** argv) {
  using namespace sonoband;
  try {
    SystemClock clock;
    ui::WindowSurface window({"Listener", 1280, 800, false});
    ui::GestureRecogniser recogniser(ui::limits_for(5.9F));
    std::vector<ui::Gesture> gestures;
    const Stamp end = clock.now() + std::chrono::seconds(argc > 1 ? std::atoi(argv[1]) : 10);
    window.begin_frame();
    window.end_frame();
    std::printf("ready\n");
    std::fflush(stdout);
    int down = 0;
    int most = 0;
    for (Stamp now = clock.now(); now < end; now = clock.now()) {
      ui::Input input;
      window.poll(input, now, std::chrono::milliseconds(50));
      for (const ui::Contact& c : input.contacts) {
        const bool lands = c.kind == ui::Contact::Kind::down;
        down += lands ? 1 : c.kind == ui::Contact::Kind::up ? -1 : 0;
        most = std::max(most, down);
        const char* word = lands ? "down" : c.kind == ui::Contact::Kind::up ? "up" : "move";
        std::printf("%s %s %.0f %.0f\n", c.id == -1 ? "mouse" : "finger", word, c.at.x, c.at.y);
        recogniser.feed(c, gestures);
      }
      recogniser.tick(clock.now(), gestures);
      std::fflush(stdout);
    }
    float zoom = 1;
    int taps = 0;
    for (const ui::Gesture& g : gestures) {
      if (g.kind == ui::Gesture::Kind::pinch && g.phase != ui::Gesture::Phase::end) zoom *= g.scale;
      taps += g.kind == ui::Gesture::Kind::tap ? 1 : 0;
    }
    std::printf("zoom %.2f, taps %d, most fingers %d, left down %d\n", zoom, taps, most, down);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "listener: %s\n", e.what());
    return 1;
  }
  return 0;
}
