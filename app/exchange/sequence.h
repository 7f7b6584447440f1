// A tracked sequence as files hold it: pictures, and what was written beside each. Neutral between formats.
//
// Fields keep the text they were read with, so that a file can be written again without loss; the functions
// below give them meaning. Pixels are always in MF orientation where the file says how they lie.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sonoband::exchange {

enum class ElementType : std::uint8_t {
  none,  // no pixels: a tracker-only file
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64,
};

std::size_t bytes_of(ElementType type);
std::string_view name_of(ElementType type);  // "uint8", as NRRD spells it

struct Field {
  std::string name;
  std::string value;  // trimmed
  bool operator==(const Field&) const = default;
};

// Names compare without case; the first match counts. Null: there is none.
const std::string* find_field(std::span<const Field> fields, std::string_view name);
void set_field(std::vector<Field>& fields, std::string_view name, std::string value);

// What stands beside one picture, in the file's order: XToYTransform, XToYTransformStatus, Timestamp,
// UnfilteredTimestamp, FrameNumber, ImageStatus, and whatever else.
struct SequenceFrame {
  std::vector<Field> fields;
};

// Bytes without an owner's second thoughts: not cleared at first, not copied by accident.
class PixelBuffer {
 public:
  PixelBuffer() = default;
  explicit PixelBuffer(std::size_t size)
      : bytes_(std::make_unique_for_overwrite<std::uint8_t[]>(size)), size_(size) {}
  std::span<std::uint8_t> bytes() { return {bytes_.get(), size_}; }
  std::span<const std::uint8_t> bytes() const { return {bytes_.get(), size_}; }

 private:
  std::unique_ptr<std::uint8_t[]> bytes_;
  std::size_t size_ = 0;
};

// Where a volume lies. For sequences it is carried along and means nothing: their scale is in ImageToProbe.
struct ImageGeometry {
  std::vector<double> spacing_mm{1, 1, 1};
  std::vector<double> origin_mm{0, 0, 0};
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // column i: unit direction of axis i
  bool operator==(const ImageGeometry&) const = default;
};

struct TrackedSequence {
  int width = 0;  // 0 x 0 or 1 x 1: tracker-only
  int height = 0;
  int slices = 1;      // above 1: every frame is a volume
  int components = 1;  // 1 grey, 3 red green blue interleaved
  ElementType element_type = ElementType::uint8;
  PixelBuffer pixels;  // frames, slices, rows, columns, components; packed, little-endian
  std::vector<SequenceFrame> frames;
  std::vector<Field> fields;        // of the header, without those that say the layout
  std::string orientation = "MFA";  // of the pixels as they are here; "XX" unknown, "FM" ... rows are lines
  std::string orientation_in_file;  // the code before the pixels were turned; empty: not said
  std::string image_type;           // BRIGHTNESS, RGB_COLOR, RF_REAL ...; empty: not said (BRIGHTNESS)
  std::string anatomical_orientation = "RAI";
  ImageGeometry geometry;
  bool compressed = false;  // in the file; writers keep it so unless told

  int frame_count() const { return static_cast<int>(frames.size()); }
  std::size_t frame_bytes() const {
    return static_cast<std::size_t>(width) * height * slices * components * bytes_of(element_type);
  }
  bool has_pictures() const {
    return element_type != ElementType::none && static_cast<std::int64_t>(width) * height > 1;
  }
  std::span<const std::uint8_t> frame_pixels(int frame) const {
    return pixels.bytes().subspan(frame * frame_bytes(), frame_bytes());
  }
};

// What a reader hands back: the sequence, and one sentence for each thing it had to assume.
struct ReadSequence {
  TrackedSequence sequence;
  std::vector<std::string> warnings;
};

// Limits that hold before memory is taken.
struct SequenceLimits {
  std::uint64_t max_pixel_bytes;  // of all frames together, unpacked
  std::int64_t max_frames = 1'000'000;
  int max_side_px = 65'535;
};

// Three quarters of this machine's memory for pixels.
SequenceLimits default_limits();

// "ProbeToTrackerTransform" is {Probe, Tracker}. Exactly one "To" that is followed by no small letter; the
// first letters are made capitals. Empty: not the name of a transform.
struct TransformName {
  std::string from;
  std::string to;
  bool operator==(const TransformName&) const = default;
};
std::optional<TransformName> transform_name(std::string_view field);

struct FrameTransform {
  TransformName name;
  Eigen::Matrix4d to_from_from = Eigen::Matrix4d::Identity();  // meaningless unless status is OK
  std::string status;                                          // as the file has it; empty: not said
  bool ok() const { return status.empty() || status == "OK"; }
};

// Sixteen numbers, row by row. Throws BadInput naming `place` when they are not.
Eigen::Matrix4d parse_matrix(std::string_view text, const std::string& place);
std::string format_matrix(const Eigen::Matrix4d& m);

// Every transform of these fields, in order. A matrix is only looked at where its status is OK or not said;
// `place` names the file and frame in what is thrown.
std::vector<FrameTransform> transforms_of(std::span<const Field> fields, const std::string& place);
void set_transform(SequenceFrame& frame, const TransformName& name, const Eigen::Matrix4d& to_from_from,
                   std::string_view status = "OK");

std::optional<double> timestamp_s(const SequenceFrame& frame);  // filtered; empty: missing or no number
bool image_ok(const SequenceFrame& frame);                      // missing counts as OK

}  // namespace sonoband::exchange
