// Pictures from a device that lies: sizes, strides, formats and bytes are the input's.
// Held: what check_frame accepts can be copied without touching a byte outside; a JPEG never crashes.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "hal/capture/flow_keys.h"
#include "hal/capture/jpeg_luma.h"
#include "hal/capture/luma.h"
#include "hal/tracker/little_endian.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sonoband;
  if (size < 16) return 0;
  const std::vector<std::uint8_t> bytes(data + 16, data + size);  // of its own: the sanitizer knows its ends
  Frame f;
  f.data = bytes.data();
  f.bytes = bytes.size();
  f.format = static_cast<PixelFormat>(data[0] % 6);
  f.width = static_cast<std::int16_t>(wire::load_u16(data + 2));
  f.height = static_cast<std::int16_t>(wire::load_u16(data + 4));
  f.stride_bytes = wire::load_i32(data + 6);
  if ((data[1] & 1) != 0) f.stride_bytes *= std::ptrdiff_t{1} << 31;
  if (check_frame(f, f.width, f.height) == FrameFault::none) {
    Crop crop{.x = data[10] % f.width,
              .y = data[11] % f.height,
              .flip_x = (data[1] & 2) != 0,
              .flip_y = (data[1] & 4) != 0};
    const int width = 1 + data[12] % (f.width - crop.x);
    const int height = 1 + data[13] % (f.height - crop.y);
    Pixels out(width, height);
    copy_luma(f, crop, out.view());
    static const FlowKeys keys(doppler::ColourClassifier(doppler::red_blue_bar(), {}));
    keys.copy(f, crop, out.view());
  }
  JpegLuma jpeg;
  Pixels out(1 + data[14] % 64, 1 + data[15] % 64);
  static_cast<void>(jpeg.decode(bytes, out.view()));
  std::vector<std::uint8_t> rgb(std::size_t{3} * out.width() * out.height());
  static_cast<void>(jpeg.decode_rgb(bytes, out.width(), out.height(), rgb.data()));
  return 0;
}
