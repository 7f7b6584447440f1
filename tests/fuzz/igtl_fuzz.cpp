// Whatever a client sends over OpenIGTLink, in pieces: understood, skipped, or refused; never more memory
// than a request may have. The first byte says how long the pieces are.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "app/exchange/igtl_messages.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t piece = std::size_t{data[0]} + 1;
  sonoband::exchange::IgtlRequests requests;
  std::size_t found = 0;
  for (std::size_t at = 1; at < size; at += piece) {
    bool good = true;
    found += requests.feed({data + at, std::min(piece, size - at)}, good).size();
    if (!good) break;
  }
  // Every message has a head of 58 bytes.
  if (found > size / 58) std::abort();
  return 0;
}
