#include "app/exchange/header_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <new>
#include <utility>

#include "app/bad_input.h"
#include "app/exchange/text.h"

namespace sonoband::exchange {

namespace {

constexpr std::string_view frame_field = "Seq_Frame";
constexpr std::size_t max_fields_at_one_place = 1000;  // files in the wild have about 20

void add_field(std::vector<Field>& fields, std::string_view name, std::string_view value,
               const std::string& file, std::int64_t line) {
  set_field(fields, name, std::string(value));
  if (fields.size() > max_fields_at_one_place)
    throw BadInput(fmt::format("{}, line {}: more than {} fields at one place; this is no sequence header.",
                               file, line, max_fields_at_one_place));
}

}  // namespace

FieldCollector::FieldCollector(std::string file, const SequenceLimits& limits)
    : file_(std::move(file)), max_frames_(limits.max_frames) {}

void FieldCollector::add(std::string_view name, std::string_view value, std::int64_t line) {
  if (!starts_with_name(name, frame_field)) {
    add_field(fields_, name, value, file_, line);
    return;
  }
  const std::string_view rest = name.substr(frame_field.size());
  const std::size_t underscore = rest.find('_');
  const auto number =
      underscore == std::string_view::npos ? std::nullopt : parse_integer(rest.substr(0, underscore));
  if (!number || *number < 0 || underscore + 1 == rest.size()) {
    ++unreadable_;
    return;
  }
  if (*number >= max_frames_) {
    ++beyond_;
    return;
  }
  if (static_cast<std::size_t>(*number) >= frames_.size()) frames_.resize(*number + 1);
  add_field(frames_[*number].fields, rest.substr(underscore + 1), value, file_, line);
}

std::vector<SequenceFrame> FieldCollector::take_frames(std::int64_t count,
                                                       std::vector<std::string>& warnings) {
  for (std::size_t i = static_cast<std::size_t>(count); i < frames_.size(); ++i)
    beyond_ += static_cast<std::int64_t>(frames_[i].fields.size());
  if (beyond_ > 0)
    warnings.push_back(fmt::format("{}: {} fields belong to frames past the last one ({} frames); left out.",
                                   file_, beyond_, count));
  if (unreadable_ > 0)
    warnings.push_back(
        fmt::format("{}: {} Seq_Frame fields have no frame number or name; left out.", file_, unreadable_));
  frames_.resize(static_cast<std::size_t>(count));
  return std::move(frames_);
}

std::string frame_prefix(int frame) {
  return fmt::format("{}{:04}_", frame_field, frame);
}

Layout layout_of(const std::vector<std::int64_t>& sizes, const std::vector<std::string>& kinds,
                 const std::string& file, const SequenceLimits& limits) {
  const auto refuse = [&](const std::string& why) { throw BadInput(fmt::format("{}: {}", file, why)); };
  if (sizes.size() != kinds.size())
    refuse(fmt::format("{} sizes but {} kinds; every size needs its kind.", sizes.size(), kinds.size()));
  Layout layout;
  std::vector<std::int64_t> spatial;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (sizes[i] < 0) refuse(fmt::format("a size is {}; sizes cannot be negative.", sizes[i]));
    if (same_name(kinds[i], "domain") || same_name(kinds[i], "space")) {
      spatial.push_back(sizes[i]);
    } else if (same_name(kinds[i], "list") || same_name(kinds[i], "time")) {
      if (i + 1 != sizes.size())
        refuse("the frames (kind list) are not the last size; store each frame as one block of pixels.");
      layout.frames = sizes[i];
    } else if (same_name(kinds[i], "vector") || same_name(kinds[i], "RGB-color") ||
               same_name(kinds[i], "3-color")) {
      if (i != 0) refuse("the colour components (kind vector) are not the first size; interleave them.");
      layout.components = static_cast<int>(std::min<std::int64_t>(sizes[i], 1 << 20));
    } else {
      refuse(fmt::format("the kind '{}' is not known; use domain, list or vector.", kinds[i].substr(0, 40)));
    }
  }
  if (spatial.size() != 2 && spatial.size() != 3)
    refuse(fmt::format("{} spatial sizes; a picture has 2 and a volume 3.", spatial.size()));
  if (layout.components != 1 && layout.components != 3)
    refuse(fmt::format("{} components per pixel; only grey (1) and RGB (3) are read.", layout.components));
  if (layout.frames < 1) refuse("it holds no frames; record again.");
  if (layout.frames > limits.max_frames)
    refuse(fmt::format("{} frames are more than the limit of {}.", layout.frames, limits.max_frames));
  for (const std::int64_t side : spatial)
    if (side > limits.max_side_px)
      refuse(fmt::format("a side of {} pixels is more than the limit of {}.", side, limits.max_side_px));
  layout.spatial = static_cast<int>(spatial.size());
  layout.width = static_cast<int>(spatial[0]);
  layout.height = static_cast<int>(spatial[1]);
  layout.slices = spatial.size() == 3 ? static_cast<int>(spatial[2]) : 1;
  if ((layout.width == 0) != (layout.height == 0) || (layout.slices == 0 && layout.width != 0))
    refuse("one side of the pictures is 0 but not the other; a tracker-only file has both 0.");
  if (layout.width == 0) layout.slices = 1;
  return layout;
}

std::uint64_t checked_pixel_bytes(const Layout& layout, ElementType type, const std::string& file,
                                  const SequenceLimits& limits) {
  std::uint64_t bytes = bytes_of(type);
  for (const std::int64_t factor : {std::int64_t{layout.components}, std::int64_t{layout.width},
                                    std::int64_t{layout.height}, std::int64_t{layout.slices}, layout.frames})
    if (__builtin_mul_overflow(bytes, static_cast<std::uint64_t>(factor), &bytes)) bytes = UINT64_MAX;
  if (bytes > limits.max_pixel_bytes)
    throw BadInput(fmt::format("{}: the pixels need {} bytes and the limit here is {}; split the recording.",
                               file, bytes, limits.max_pixel_bytes));
  return bytes;
}

PixelBuffer take_pixels(std::uint64_t bytes, const std::string& file) {
  try {
    return PixelBuffer(bytes);
  } catch (const std::bad_alloc&) {
    throw BadInput(fmt::format("{}: no memory for {} bytes of pixels; split the recording.", file, bytes));
  }
}

namespace {

void mirror_columns(std::uint8_t* row, int width, std::size_t pixel) {
  for (int left = 0, right = width - 1; left < right; ++left, --right)
    std::swap_ranges(row + left * pixel, row + (left + 1) * pixel, row + right * pixel);
}

// Swaps block i with block count-1-i.
void mirror_blocks(std::uint8_t* first, int count, std::size_t block) {
  for (int a = 0, b = count - 1; a < b; ++a, --b)
    std::swap_ranges(first + a * block, first + (a + 1) * block, first + b * block);
}

}  // namespace

void turn_to_mf(TrackedSequence& s, std::string_view code, const std::string& file,
                std::vector<std::string>& warnings) {
  struct Known {
    std::string_view code;
    bool columns, rows, slices;
  };
  // The third letter says how slices are stacked; a single picture has none, so MF, MFA and MFD are one.
  constexpr std::array<Known, 12> known{{{"MF", false, false, false},
                                         {"MFA", false, false, false},
                                         {"MFD", false, false, true},
                                         {"MN", false, true, false},
                                         {"MNA", false, true, false},
                                         {"MND", false, true, true},
                                         {"UF", true, false, false},
                                         {"UFA", true, false, false},
                                         {"UFD", true, false, true},
                                         {"UN", true, true, false},
                                         {"UNA", true, true, false},
                                         {"UND", true, true, true}}};
  s.orientation_in_file = code;
  const auto turn =
      std::find_if(known.begin(), known.end(), [&](const Known& k) { return same_name(k.code, code); });
  if (turn == known.end()) {
    const bool unknown = code.empty() || same_name(code, "XX");
    const bool lines = s.image_type.starts_with("RF_");
    if (s.has_pictures() && unknown && !lines) {
      warnings.push_back(fmt::format(
          "{}: {}; taken as MF (x to the marked side, y away from the probe).", file,
          code.empty() ? "it does not say how its pictures lie" : "the orientation of its pictures is XX"));
      s.orientation = "MFA";
    } else {
      s.orientation = code.empty() ? "XX" : std::string(code);
    }
    return;
  }
  s.orientation = "MFA";
  const std::size_t pixel = s.components * bytes_of(s.element_type);
  const std::size_t row = pixel * s.width;
  const std::size_t slice = row * s.height;
  if (s.pixels.bytes().empty()) return;
  std::uint8_t* at = s.pixels.bytes().data();
  const bool slices = turn->slices && s.slices > 1;
  for (int frame = 0; frame < s.frame_count(); ++frame, at += s.frame_bytes()) {
    if (slices) mirror_blocks(at, s.slices, slice);
    for (int z = 0; z < s.slices; ++z) {
      if (turn->rows) mirror_blocks(at + z * slice, s.height, row);
      if (turn->columns)
        for (int y = 0; y < s.height; ++y) mirror_columns(at + z * slice + y * row, s.width, pixel);
    }
  }
}

void swap_bytes(TrackedSequence& s) {
  const std::size_t size = bytes_of(s.element_type);
  if (size < 2) return;
  const std::span<std::uint8_t> bytes = s.pixels.bytes();
  for (std::size_t at = 0; at + size <= bytes.size(); at += size)
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                 bytes.begin() + static_cast<std::ptrdiff_t>(at + size));
}

std::string unwritable(const Field& field, std::string_view forbidden_in_name) {
  const auto control = [](char c) { return c == '\n' || c == '\r' || c == '\0'; };
  if (field.name.empty() || trim(field.name) != field.name) return "has a name with blanks around it";
  if (field.name.find(forbidden_in_name) != std::string::npos)
    return fmt::format("has '{}' in its name", forbidden_in_name);
  if (std::any_of(field.name.begin(), field.name.end(), control) ||
      std::any_of(field.value.begin(), field.value.end(), control))
    return "holds a line break";
  return {};
}

}  // namespace sonoband::exchange
