#include "app/exchange/payload.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <vector>

#include "app/bad_input.h"

namespace sonoband::exchange {

namespace {

constexpr std::size_t chunk_bytes = std::size_t{1} << 18;
constexpr int gzip_window = 15 + 16;  // zlib's code for the gzip wrapper with the largest window
constexpr int zlib_window = 15;

// zlib counts in 32 bits.
uInt clamp(std::size_t n) {
  return static_cast<uInt>(std::min<std::size_t>(n, std::numeric_limits<uInt>::max()));
}

class Inflater {
 public:
  explicit Inflater(Packing packing) {
    if (inflateInit2(&stream, packing == Packing::gzip ? gzip_window : zlib_window) != Z_OK)
      throw std::runtime_error("zlib has no memory to unpack");
  }
  ~Inflater() { inflateEnd(&stream); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  z_stream stream{};
};

}  // namespace

std::uint64_t bytes_left(std::istream& in) {
  const auto here = in.tellg();
  in.seekg(0, std::ios::end);
  const auto end = in.tellg();
  in.seekg(here);
  return here < 0 || end < here ? 0 : static_cast<std::uint64_t>(end - here);
}

void check_payload_size(Packing packing, std::uint64_t packed, std::uint64_t unpacked,
                        const std::string& file) {
  if (packing == Packing::raw && packed < unpacked)
    throw BadInput(fmt::format(
        "{}: the header declares {} bytes of pixels and the file has {}; it is cut short, copy it "
        "again from its source.",
        file, unpacked, packed));
  if (packing != Packing::raw && unpacked / 1032 > packed + 64)
    throw BadInput(
        fmt::format("{}: {} packed bytes cannot hold the {} bytes of pixels that the header declares; it is "
                    "cut short or its "
                    "sizes are wrong, copy it again from its source.",
                    file, packed, unpacked));
}

void read_payload(std::istream& in, Packing packing, std::uint64_t packed, std::span<std::uint8_t> out,
                  const std::string& file) {
  const auto cut_short = [&](std::uint64_t got) {
    throw BadInput(fmt::format(
        "{}: the pixels end after {} of {} bytes; it is cut short, copy it again from its source.", file, got,
        out.size()));
  };
  if (packing == Packing::raw) {
    in.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(out.size()));
    if (static_cast<std::size_t>(in.gcount()) != out.size())
      cut_short(static_cast<std::uint64_t>(in.gcount()));
    return;
  }
  Inflater inflater(packing);
  z_stream& z = inflater.stream;
  std::vector<std::uint8_t> chunk(chunk_bytes);
  std::size_t filled = 0;
  std::uint8_t spill = 0;
  for (int status = Z_OK; status != Z_STREAM_END;) {
    if (z.avail_in == 0) {
      in.read(reinterpret_cast<char*>(chunk.data()),
              static_cast<std::streamsize>(std::min<std::uint64_t>(packed, chunk.size())));
      z.next_in = chunk.data();
      z.avail_in = static_cast<uInt>(in.gcount());
      packed -= z.avail_in;
      if (z.avail_in == 0) cut_short(filled);
    }
    // Past the last byte one more is asked for, to see the stream's end or that it holds too much.
    const bool full = filled == out.size();
    z.next_out = full ? &spill : out.data() + filled;
    z.avail_out = full ? 1 : clamp(out.size() - filled);
    const uInt asked = z.avail_out;
    status = inflate(&z, Z_NO_FLUSH);
    const uInt got = asked - z.avail_out;
    if (full && got > 0)
      throw BadInput(fmt::format(
          "{}: the packed pixels hold more than the {} bytes that the header declares; its sizes or "
          "its pixels are damaged, copy it again from its source.",
          file, out.size()));
    filled += full ? 0 : got;
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
      throw BadInput(
          fmt::format("{}: the packed pixels are damaged ({}) after {} of {} bytes; copy it again from its "
                      "source.",
                      file, z.msg != nullptr ? z.msg : "zlib cannot read them", filled, out.size()));
  }
  if (filled != out.size())
    throw BadInput(fmt::format(
        "{}: the packed pixels unpack to {} bytes and the header declares {}; its sizes or its pixels "
        "are damaged, copy it again from its source.",
        file, filled, out.size()));
}

struct PayloadWriter::Deflater {
  explicit Deflater(Packing packing) : chunk(chunk_bytes) {
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED,
                     packing == Packing::gzip ? gzip_window : zlib_window, 8, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::runtime_error("zlib has no memory to pack");
  }
  ~Deflater() { deflateEnd(&stream); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  z_stream stream{};
  std::vector<std::uint8_t> chunk;
};

PayloadWriter::PayloadWriter(std::ostream& out, Packing packing)
    : out_(out), deflater_(packing == Packing::raw ? nullptr : std::make_unique<Deflater>(packing)) {}

PayloadWriter::~PayloadWriter() = default;

void PayloadWriter::write(std::span<const std::uint8_t> bytes) {
  if (!deflater_) {
    out_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    written_ += bytes.size();
    return;
  }
  z_stream& z = deflater_->stream;
  while (!bytes.empty()) {
    const uInt part = clamp(bytes.size());
    z.next_in = const_cast<Bytef*>(bytes.data());  // zlib only reads it
    z.avail_in = part;
    while (z.avail_in > 0) {
      z.next_out = deflater_->chunk.data();
      z.avail_out = static_cast<uInt>(chunk_bytes);
      deflate(&z, Z_NO_FLUSH);
      const std::size_t made = chunk_bytes - z.avail_out;
      out_.write(reinterpret_cast<const char*>(deflater_->chunk.data()), static_cast<std::streamsize>(made));
      written_ += made;
    }
    bytes = bytes.subspan(part);
  }
}

std::uint64_t PayloadWriter::finish() {
  if (!deflater_) return written_;
  z_stream& z = deflater_->stream;
  z.next_in = nullptr;
  z.avail_in = 0;
  for (int status = Z_OK; status != Z_STREAM_END;) {
    z.next_out = deflater_->chunk.data();
    z.avail_out = static_cast<uInt>(chunk_bytes);
    status = deflate(&z, Z_FINISH);
    const std::size_t made = chunk_bytes - z.avail_out;
    out_.write(reinterpret_cast<const char*>(deflater_->chunk.data()), static_cast<std::streamsize>(made));
    written_ += made;
  }
  return written_;
}

}  // namespace sonoband::exchange
