// Any .sx or .sw with any .sxi: read, or refused with a sentence. The first byte splits the input.
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "app/bad_input.h"
#include "app/exchange/stradwin.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string all(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::size_t cut = all.size() * data[0] / 255;
  std::istringstream header(all.substr(0, cut));
  std::istringstream pixels(all.substr(cut));
  sonoband::exchange::SequenceLimits limits{};
  limits.max_pixel_bytes = 1 << 20;
  limits.max_frames = 1000;
  try {
    sonoband::exchange::read_strad(header, "fuzz.sw", pixels, "fuzz.sxi", limits);
  } catch (const sonoband::BadInput&) {
  }
  return 0;
}
