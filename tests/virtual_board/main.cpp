// virtual-usb SCENE TRACKER-PRODUCT TRACKER-SOCKET VIDEO-SOCKET: the USB devices of the virtual board, all
// showing one scene along one path of the hand. Reads commands, one a line: press, unplug-tracker,
// plug-tracker, stall-video, resume-video, quit.
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <thread>

#include "hal/clock.h"
#include "hal/sim/scene.h"
#include "tests/virtual_board/redir_server.h"
#include "tests/virtual_board/tracker_device.h"
#include "tests/virtual_board/video_device.h"

int main(int argc, char** argv) {
  using namespace sonoband;
  if (argc != 5) {
    std::fprintf(stderr, "usage: virtual-usb SCENE TRACKER-PRODUCT TRACKER-SOCKET VIDEO-SOCKET\n");
    return 2;
  }
  SystemClock clock;
  sim::SceneSettings settings;
  settings.preset = argv[1];
  const sim::SimulatedScene scene = sim::make_scene(settings);
  virtual_board::TrackerDevice tracker(static_cast<std::uint16_t>(std::strtoul(argv[2], nullptr, 16)), clock,
                                       [hand = scene.hand](Stamp t) { return hand->tracker_from_probe(t); });
  constexpr int rate_hz = 5;  // what an emulated bus carries beside the tracker
  virtual_board::VideoUsbDevice video(scene.scanner.width_px, scene.scanner.height_px, rate_hz, clock,
                                      scene.painter());
  std::atomic<bool> stop = false;
  std::atomic<bool> tracker_away = false;
  const std::atomic<bool> video_away = false;
  std::thread serve_tracker([&] { virtual_board::serve(tracker, argv[3], stop, tracker_away); });
  std::thread serve_video([&] { virtual_board::serve(video, argv[4], stop, video_away); });
  std::string word;
  while (std::getline(std::cin, word) && word != "quit") {
    if (word == "press") scene.hand->pressed(clock.now());
    if (word == "unplug-tracker") tracker_away = true;
    if (word == "plug-tracker") tracker_away = false;
    if (word == "stall-video") video.stalled = true;
    if (word == "resume-video") video.stalled = false;
    std::printf("%s\n", word.c_str());
    std::fflush(stdout);
  }
  stop = true;
  serve_tracker.join();
  serve_video.join();
  return 0;
}
