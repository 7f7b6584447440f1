// The NRRD reader: no crash, no hang, bounded memory; what it takes it can write and read again.
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "app/bad_input.h"
#include "app/exchange/nrrd.h"
#include "tests/fuzz/same_sequence.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sonoband;
  const exchange::OpenBeside beside = [](const std::string&) {
    return std::make_unique<std::istringstream>("the pixels of another file");
  };
  std::istringstream in(std::string(reinterpret_cast<const char*>(data), size));
  exchange::ReadSequence read;
  try {
    read = exchange::read_nrrd(in, "fuzz.nrrd", fuzz::limits, beside);
  } catch (const BadInput&) {
    return 0;
  }
  fuzz::touch(read.sequence);
  std::stringstream written;
  try {
    exchange::write_nrrd(read.sequence, written, "out.nrrd", written, "");
  } catch (const BadInput&) {
    return 0;
  }
  const auto again = exchange::read_nrrd(written, "out.nrrd", fuzz::limits, beside);
  if (!fuzz::same(read.sequence, again.sequence)) std::abort();
  return 0;
}
