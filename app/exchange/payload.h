// The block of pixels behind a header: raw, or one zlib (RFC 1950) or gzip (RFC 1952) stream of all frames.
#pragma once

#include <cstdint>
#include <istream>
#include <memory>
#include <ostream>
#include <span>
#include <string>

namespace sonoband::exchange {

enum class Packing : std::uint8_t { raw, zlib, gzip };

// Bytes from the read position to the end.
std::uint64_t bytes_left(std::istream& in);

// A deflate stream grows at most 1032-fold: more is not believed, before memory is taken. Throws BadInput
// where `packed` bytes cannot become `unpacked`.
void check_payload_size(Packing packing, std::uint64_t packed, std::uint64_t unpacked,
                        const std::string& file);

// Fills `out` from the next `packed` bytes. Throws BadInput naming `file` when they are damaged, too few, or
// unpack to another size.
void read_payload(std::istream& in, Packing packing, std::uint64_t packed, std::span<std::uint8_t> out,
                  const std::string& file);

// Packs what it is given; finish() returns the packed size.
class PayloadWriter {
 public:
  PayloadWriter(std::ostream& out, Packing packing);
  ~PayloadWriter();
  PayloadWriter(const PayloadWriter&) = delete;
  PayloadWriter& operator=(const PayloadWriter&) = delete;

  void write(std::span<const std::uint8_t> bytes);
  std::uint64_t finish();

 private:
  struct Deflater;
  std::ostream& out_;
  std::unique_ptr<Deflater> deflater_;  // null: raw
  std::uint64_t written_ = 0;
};

}  // namespace sonoband::exchange
