// Small sequences and headers that several tests build on.
#pragma once

#include <algorithm>
#include <cstring>
#include <random>
#include <sstream>
#include <string>

#include "app/bad_input.h"
#include "app/exchange/metaimage.h"
#include "app/exchange/nrrd.h"
#include "app/exchange/sequence.h"
#include "tests/support/support.h"

namespace sonoband::test {

constexpr exchange::SequenceLimits small_limits{
    .max_pixel_bytes = 1 << 24, .max_frames = 10'000, .max_side_px = 4096};

inline std::unique_ptr<std::istream> nothing_beside(const std::string&) {
  return nullptr;
}

inline exchange::ReadSequence read_meta(const std::string& text) {
  std::istringstream in(text);
  return exchange::read_metaimage(in, "sweep.mha", small_limits, nothing_beside);
}

inline exchange::ReadSequence read_nrrd_text(const std::string& text) {
  std::istringstream in(text);
  return exchange::read_nrrd(in, "sweep.nrrd", small_limits, nothing_beside);
}

inline std::string meta_text(const exchange::TrackedSequence& s) {
  std::ostringstream out;
  exchange::write_metaimage(s, out, "out.mha", out, "");
  return out.str();
}

inline std::string nrrd_text(const exchange::TrackedSequence& s) {
  std::ostringstream out;
  exchange::write_nrrd(s, out, "out.nrrd", out, "");
  return out.str();
}

// What the reader says when it refuses; empty when it does not.
template <class Body>
std::string refusal(Body&& body) {
  try {
    body();
  } catch (const BadInput& e) {
    return e.what();
  }
  return {};
}

// Random pixels and poses, with statuses that are not OK, unknown fields and fractions of every length.
inline exchange::TrackedSequence random_sequence(int width, int height, int frames,
                                                 exchange::ElementType type, int components,
                                                 std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> mm(-300, 300);
  exchange::TrackedSequence s;
  s.width = width;
  s.height = height;
  s.element_type = type;
  s.components = components;
  s.frames.resize(static_cast<std::size_t>(frames));
  s.fields = {{"Operator", "nobody"}, {"Empty", ""}, {"Note", "a = b := c"}};
  s.pixels = exchange::PixelBuffer(s.frame_bytes() * static_cast<std::size_t>(frames));
  for (std::uint8_t& byte : s.pixels.bytes()) byte = static_cast<std::uint8_t>(random());
  for (int i = 0; i < frames; ++i) {
    Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
    pose.topLeftCorner<3, 3>() = random_rotation(random);
    pose.topRightCorner<3, 1>() << mm(random), mm(random), mm(random);
    auto& frame = s.frames[static_cast<std::size_t>(i)];
    exchange::set_transform(frame, {"Probe", "Tracker"}, pose, i % 5 == 3 ? "OUT_OF_VIEW" : "OK");
    exchange::set_field(frame.fields, "Timestamp", std::to_string(100 + 0.04 * i));
    exchange::set_field(frame.fields, "Footswitch", i % 2 == 0 ? "down" : "up");
    exchange::set_field(frame.fields, "ImageStatus", i % 7 == 6 ? "INVALID" : "OK");
  }
  return s;
}

inline ::testing::AssertionResult same_sequence(const exchange::TrackedSequence& a,
                                                const exchange::TrackedSequence& b) {
  const auto differ = [](const std::string& what) {
    return ::testing::AssertionFailure() << what << " differ";
  };
  if (a.width != b.width || a.height != b.height || a.slices != b.slices || a.components != b.components)
    return differ("sizes");
  if (a.element_type != b.element_type) return differ("element types");
  if (a.orientation != b.orientation || a.image_type != b.image_type)
    return differ("orientations or image types");
  if (!(a.geometry == b.geometry) || a.anatomical_orientation != b.anatomical_orientation)
    return differ("geometries");
  if (a.compressed != b.compressed) return differ("compressions");
  if (!(a.fields == b.fields)) return differ("header fields");
  if (a.frame_count() != b.frame_count()) return differ("frame counts");
  for (int i = 0; i < a.frame_count(); ++i)
    if (!(a.frames[static_cast<std::size_t>(i)].fields == b.frames[static_cast<std::size_t>(i)].fields))
      return differ("fields of frame " + std::to_string(i));
  const auto pa = a.pixels.bytes();
  const auto pb = b.pixels.bytes();
  if (pa.size() != pb.size() || !std::equal(pa.begin(), pa.end(), pb.begin())) return differ("pixels");
  return ::testing::AssertionSuccess();
}

}  // namespace sonoband::test
