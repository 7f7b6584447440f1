// The usbredir peer on hostile bytes. Held: no crash, answers stay within what was asked for, nothing grows
// without bound. The first byte chooses the device and how many bytes are heard at once.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "hal/sim/virtual_clock.h"
#include "tests/virtual_board/redir_server.h"
#include "tests/virtual_board/tracker_device.h"
#include "tests/virtual_board/video_device.h"

namespace {

using namespace sonoband;
using namespace sonoband::virtual_board;

std::unique_ptr<UsbDevice> device_of(unsigned choice, Clock& clock) {
  if (choice >= 2)
    return std::make_unique<VideoUsbDevice>(16, 16, 5, clock, [](Stamp, std::uint8_t*, std::ptrdiff_t) {});
  const sim::ProbePose still = [](Stamp) { return Rigid<frame::Tracker, frame::Probe>(); };
  return std::make_unique<TrackerDevice>(choice == 0 ? 0xff20 : 0xbf01, clock, still);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  sim::VirtualClock clock;
  const std::unique_ptr<UsbDevice> device = device_of(data[0] & 3U, clock);
  device->plugged();
  RedirSession session(*device);
  Bytes out;
  const std::size_t step = 1U + data[0];
  for (std::size_t from = 1; from < size; from += step) {
    out.clear();
    if (!session.hear({data + from, std::min(step, size - from)}, out)) break;
    clock.sleep_until(clock.now() + std::chrono::milliseconds(5));  // some readings at 240 Hz
    if (session.waiting()) session.pump(out);
    if (out.size() > (std::size_t{1} << 22)) std::abort();
  }
  device->unplugged();
  return 0;
}
