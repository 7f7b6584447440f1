#include "app/exchange/grey_pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "app/bad_input.h"

namespace sonoband::exchange {

namespace {

// Each result goes to a place at or before that of its source, so the buffer serves for both.
template <class Sample>
void samples_to_bytes(TrackedSequence& s, const std::string& file, std::vector<std::string>& warnings) {
  std::uint8_t* bytes = s.pixels.bytes().data();
  const std::size_t count = s.pixels.bytes().size() / sizeof(Sample);
  const auto sample = [&](std::size_t i) {
    Sample value;
    std::memcpy(&value, bytes + i * sizeof(Sample), sizeof(Sample));
    return static_cast<double>(value);
  };
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = sample(i);
    if (!std::isfinite(value))
      throw BadInput(fmt::format("{}: pixel sample {} is not finite; export the recording again.", file, i));
    low = std::min(low, value);
    high = std::max(high, value);
  }
  const bool as_is = low >= 0 && high <= 255;
  const double offset = as_is ? 0 : low;
  const double scale = as_is || high == low ? 1 : 255 / (high - low);
  for (std::size_t i = 0; i < count; ++i)
    bytes[i] = static_cast<std::uint8_t>(std::floor((sample(i) - offset) * scale + 0.5));
  warnings.push_back(as_is
                         ? fmt::format("{}: {} samples, all in 0..255, are taken as grey bytes.", file,
                                       name_of(s.element_type))
                         : fmt::format("{}: {} samples from {} to {} are stretched linearly to grey 0..255.",
                                       file, name_of(s.element_type), low, high));
  s.element_type = ElementType::uint8;
}

}  // namespace

void make_grey(TrackedSequence& s, const std::string& file, std::vector<std::string>& warnings) {
  switch (s.element_type) {
    case ElementType::none:
    case ElementType::uint8:
      break;
    case ElementType::int8:
      samples_to_bytes<std::int8_t>(s, file, warnings);
      break;
    case ElementType::int16:
      samples_to_bytes<std::int16_t>(s, file, warnings);
      break;
    case ElementType::uint16:
      samples_to_bytes<std::uint16_t>(s, file, warnings);
      break;
    case ElementType::int32:
      samples_to_bytes<std::int32_t>(s, file, warnings);
      break;
    case ElementType::uint32:
      samples_to_bytes<std::uint32_t>(s, file, warnings);
      break;
    case ElementType::int64:
      samples_to_bytes<std::int64_t>(s, file, warnings);
      break;
    case ElementType::uint64:
      samples_to_bytes<std::uint64_t>(s, file, warnings);
      break;
    case ElementType::float32:
      samples_to_bytes<float>(s, file, warnings);
      break;
    case ElementType::float64:
      samples_to_bytes<double>(s, file, warnings);
      break;
  }
  if (s.components == 1) return;
  std::uint8_t* bytes = s.pixels.bytes().data();
  const std::size_t pixels = s.frame_bytes() / 3 * s.frames.size();
  // ITU-R BT.601 luma in thousandths, halves up.
  for (std::size_t i = 0; i < pixels; ++i)
    bytes[i] = static_cast<std::uint8_t>(
        (299 * bytes[3 * i] + 587 * bytes[3 * i + 1] + 114 * bytes[3 * i + 2] + 500) / 1000);
  warnings.push_back(fmt::format("{}: colour is rendered as its grey luma (BT.601).", file));
  s.components = 1;
}

}  // namespace sonoband::exchange
