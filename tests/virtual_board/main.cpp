// virtual-usb SCENE FOLDER: the USB devices of the virtual board, all showing one scene along one path of the
// hand. Each waits in FOLDER on a socket of its name: liberty, viper, stranger (of the trackers' vendor, but
// none we know) and video. Reads commands, one a line, and says each when it is done: plug NAME, unplug NAME,
// press (the hand begins its sweep), stall, resume (the scanner's video), quit.
#include <atomic>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include "hal/clock.h"
#include "hal/sim/scene.h"
#include "tests/virtual_board/redir_server.h"
#include "tests/virtual_board/tracker_device.h"
#include "tests/virtual_board/video_device.h"

namespace {

using namespace sonoband;

struct Socket {
  std::unique_ptr<virtual_board::UsbDevice> device;
  std::atomic<bool> unplugged{false};
  std::thread server;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: virtual-usb SCENE FOLDER\n");
    return 2;
  }
  SystemClock clock;
  sim::SceneSettings settings;
  settings.preset = argv[1];
  sim::SimulatedScene scene = sim::make_scene(settings);
  scene.scanner.format = PixelFormat::grey8;  // as the camera takes it, whatever the scanner would show
  const sim::ProbePose pose = [hand = scene.hand](Stamp t) { return hand->tracker_from_probe(t); };

  std::map<std::string, Socket> sockets;
  const std::map<std::string, std::uint16_t> trackers{
      {"liberty", 0xff20}, {"viper", 0xbf01}, {"stranger", 0xcf01}};
  for (const auto& [name, product] : trackers) {
    sockets[name].device = std::make_unique<virtual_board::TrackerDevice>(product, clock, pose);
    sockets[name].unplugged = name != "liberty";
  }
  constexpr int rate_hz = 5;  // what an emulated bus carries beside the tracker
  auto camera = std::make_unique<virtual_board::VideoUsbDevice>(
      scene.scanner.width_px, scene.scanner.height_px, rate_hz, clock, scene.painter());
  virtual_board::VideoUsbDevice& video = *camera;
  sockets["video"].device = std::move(camera);

  std::atomic<bool> stop = false;
  for (auto& [name, socket] : sockets) {
    const std::string path = std::string(argv[2]) + "/" + name + ".sock";
    socket.server =
        std::thread([&stop, &s = socket, path] { virtual_board::serve(*s.device, path, stop, s.unplugged); });
  }
  std::string line;
  while (std::getline(std::cin, line) && line != "quit") {
    const std::string name = line.substr(line.find(' ') + 1);
    const auto found = sockets.find(name);
    if (line == "press") {
      scene.hand->pressed(clock.now());
    } else if (line == "stall" || line == "resume") {
      video.stalled = line == "stall";
    } else if (found != sockets.end() && (line.starts_with("plug ") || line.starts_with("unplug "))) {
      found->second.unplugged = line.starts_with("unplug ");
    } else {
      line = "unknown: " + line;
    }
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  }
  stop = true;
  for (auto& [name, socket] : sockets) socket.server.join();
  return 0;
}
