// The usbredir peer on hostile bytes. Held: no crash, answers stay within what was asked for, nothing grows
// without bound.
#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "hal/sim/virtual_clock.h"
#include "tests/virtual_board/redir_server.h"
#include "tests/virtual_board/video_device.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sonoband;
  using namespace sonoband::virtual_board;
  if (size < 1) return 0;
  sim::VirtualClock clock;
  VideoUsbDevice device(16, 16, 5, clock, [](Stamp, std::uint8_t*, std::ptrdiff_t) {});
  RedirSession session(device);
  Bytes out;
  const std::size_t step = 1U + data[0];
  for (std::size_t from = 1; from < size; from += step) {
    out.clear();
    if (!session.hear({data + from, std::min(step, size - from)}, out)) return 0;
    if (session.waiting()) session.pump(out);
    if (out.size() > (std::size_t{1} << 22)) std::abort();
  }
  return 0;
}
