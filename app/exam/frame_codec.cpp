#include "app/exam/frame_codec.h"

#include <lz4.h>
#include <xxhash.h>

#include <bit>
#include <cstring>

namespace sonoband::exam {
namespace {

static_assert(std::endian::native == std::endian::little, "rows are stored little-endian as they lie");

constexpr int lz4_acceleration = 8;

// A row's numbers one after the other, for its checksum.
class Digest {
 public:
  explicit Digest(std::int64_t id) { add(id); }
  template <class T>
  Digest& add(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    const auto* p = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), p, p + sizeof value);
    return *this;
  }
  Digest& add_bytes(std::span<const std::uint8_t> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  std::int64_t value() const { return checksum(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

std::int64_t ns(Stamp t) {
  return t.time_since_epoch().count();
}

}  // namespace

std::int64_t checksum(std::span<const std::uint8_t> bytes, std::uint64_t seed) {
  return static_cast<std::int64_t>(XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed));
}

void pack(ConstPixels pixels, PackedPixels& out, std::vector<std::uint8_t>& scratch) {
  const std::size_t size = static_cast<std::size_t>(pixels.width) * pixels.height;
  const std::uint8_t* packed = pixels.data;
  if (pixels.stride != pixels.width) {
    scratch.resize(size);
    for (int y = 0; y < pixels.height; ++y)
      std::memcpy(scratch.data() + static_cast<std::size_t>(y) * pixels.width, pixels.row(y), pixels.width);
    packed = scratch.data();
  }
  // Room for a little less than the picture: LZ4 gives up by itself when the gain is not worth it.
  const std::size_t most = size - size / 8;
  out.bytes.resize(size);
  const int length =
      LZ4_compress_fast(reinterpret_cast<const char*>(packed), reinterpret_cast<char*>(out.bytes.data()),
                        static_cast<int>(size), static_cast<int>(most), lz4_acceleration);
  if (length > 0) {
    out.codec = Codec::lz4;
    out.bytes.resize(static_cast<std::size_t>(length));
    return;
  }
  out.codec = Codec::raw;
  if (size > 0) std::memcpy(out.bytes.data(), packed, size);
}

bool unpack(Codec codec, std::span<const std::uint8_t> bytes, ImageView<std::uint8_t> out) {
  const std::size_t size = static_cast<std::size_t>(out.width) * out.height;
  std::vector<std::uint8_t> unpacked;
  const std::uint8_t* from = bytes.data();
  if (codec == Codec::lz4) {
    const bool in_place = out.stride == out.width;
    if (!in_place) unpacked.resize(size);
    std::uint8_t* to = in_place ? out.data : unpacked.data();
    if (bytes.size() > static_cast<std::size_t>(LZ4_MAX_INPUT_SIZE)) return false;
    const int length =
        LZ4_decompress_safe(reinterpret_cast<const char*>(bytes.data()), reinterpret_cast<char*>(to),
                            static_cast<int>(bytes.size()), static_cast<int>(size));
    if (length < 0 || static_cast<std::size_t>(length) != size) return false;
    if (in_place) return true;
    from = unpacked.data();
  } else if (codec != Codec::raw || bytes.size() != size) {
    return false;
  }
  for (int y = 0; y < out.height; ++y)
    std::memcpy(out.row(y), from + static_cast<std::size_t>(y) * out.width, out.width);
  return true;
}

std::vector<std::uint8_t> matrix_bytes(const Eigen::Matrix3d& linear, const Eigen::Vector3d& translation) {
  std::vector<std::uint8_t> bytes(12 * sizeof(double));
  std::memcpy(bytes.data(), linear.data(), 9 * sizeof(double));
  std::memcpy(bytes.data() + 9 * sizeof(double), translation.data(), 3 * sizeof(double));
  return bytes;
}

bool matrix_from(std::span<const std::uint8_t> bytes, Eigen::Matrix3d& linear, Eigen::Vector3d& translation) {
  if (bytes.size() != 12 * sizeof(double)) return false;
  std::memcpy(linear.data(), bytes.data(), 9 * sizeof(double));
  std::memcpy(translation.data(), bytes.data() + 9 * sizeof(double), 3 * sizeof(double));
  return true;
}

std::int64_t row_checksum(std::int64_t id, const FrameRecord& f, Codec codec, std::int64_t pixels_checksum) {
  Digest digest(id);
  digest.add(f.pre_roll).add(f.pose_status).add(f.kind).add(f.pixels.width).add(f.pixels.height);
  digest.add(ns(f.captured)).add(ns(f.stamped)).add(ns(f.arrived)).add(f.device_ns).add(f.device_count);
  if (f.pose_status == PoseStatus::ok)
    digest.add_bytes(matrix_bytes(f.world_from_image.linear, f.world_from_image.translation));
  if (f.tracker_from_probe)
    digest.add_bytes(matrix_bytes(f.tracker_from_probe->rotation, f.tracker_from_probe->translation));
  return digest.add(codec).add(pixels_checksum).value();
}

std::int64_t row_checksum(std::int64_t id, const PoseSample& p) {
  Digest digest(id);
  digest.add(ns(p.time)).add(ns(p.arrived)).add(p.quality).add(p.epoch).add(p.device_frame).add(p.device_ms);
  return digest.add_bytes(matrix_bytes(p.tracker_from_probe.rotation, p.tracker_from_probe.translation))
      .value();
}

std::int64_t row_checksum(std::int64_t id, const ReviewObject& o) {
  Digest digest(id);
  digest.add(o.kind).add(o.version).add(o.removed).add(o.written_utc_ns).add(text_checksum(0, o.object));
  return digest.add(text_checksum(0, o.json)).add(checksum(o.png)).value();
}

std::int64_t end_checksum(std::int64_t sweep, std::int64_t frames, std::int64_t poses, bool interrupted,
                          const std::string& ledger) {
  return Digest(sweep).add(frames).add(poses).add(interrupted).add(text_checksum(0, ledger)).value();
}

std::int64_t text_checksum(std::int64_t id, const std::string& text) {
  return checksum({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()},
                  static_cast<std::uint64_t>(id));
}

}  // namespace sonoband::exam
