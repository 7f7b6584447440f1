#include "tests/virtual_board/usb_device.h"

#include <cstring>

namespace sonoband::virtual_board {

Bytes string_descriptor(const char* ascii) {
  Fields f;
  f.u8(static_cast<unsigned>(2 + 2 * std::strlen(ascii))).u8(3);
  for (; *ascii != 0; ++ascii) f.u16(static_cast<unsigned char>(*ascii));
  return f.out;
}

Bytes language_descriptor() {
  return Fields().u8(4).u8(3).u16(0x0409).out;
}

}  // namespace sonoband::virtual_board
