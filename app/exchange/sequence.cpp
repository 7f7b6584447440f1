#include "app/exchange/sequence.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "app/bad_input.h"
#include "app/exchange/text.h"

namespace sonoband::exchange {

std::size_t bytes_of(ElementType type) {
  switch (type) {
    case ElementType::none:
      return 0;
    case ElementType::int8:
    case ElementType::uint8:
      return 1;
    case ElementType::int16:
    case ElementType::uint16:
      return 2;
    case ElementType::int32:
    case ElementType::uint32:
    case ElementType::float32:
      return 4;
    case ElementType::int64:
    case ElementType::uint64:
    case ElementType::float64:
      return 8;
  }
  return 0;
}

std::string_view name_of(ElementType type) {
  switch (type) {
    case ElementType::none:
      return "none";
    case ElementType::int8:
      return "int8";
    case ElementType::uint8:
      return "uint8";
    case ElementType::int16:
      return "int16";
    case ElementType::uint16:
      return "uint16";
    case ElementType::int32:
      return "int32";
    case ElementType::uint32:
      return "uint32";
    case ElementType::int64:
      return "int64";
    case ElementType::uint64:
      return "uint64";
    case ElementType::float32:
      return "float";
    case ElementType::float64:
      return "double";
  }
  return "none";
}

const std::string* find_field(std::span<const Field> fields, std::string_view name) {
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return same_name(f.name, name); });
  return found == fields.end() ? nullptr : &found->value;
}

void set_field(std::vector<Field>& fields, std::string_view name, std::string value) {
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return same_name(f.name, name); });
  if (found == fields.end())
    fields.push_back({std::string(name), std::move(value)});
  else
    found->value = std::move(value);
}

SequenceLimits default_limits() {
  const auto memory = static_cast<std::uint64_t>(std::max(0L, ::sysconf(_SC_PHYS_PAGES))) *
                      static_cast<std::uint64_t>(std::max(0L, ::sysconf(_SC_PAGESIZE)));
  return {.max_pixel_bytes = memory / 4 * 3};
}

std::optional<TransformName> transform_name(std::string_view field) {
  constexpr std::string_view suffix = "Transform";
  if (field.size() <= suffix.size() || !field.ends_with(suffix)) return std::nullopt;
  const std::string_view pair = field.substr(0, field.size() - suffix.size());
  std::size_t split = std::string_view::npos;
  for (std::size_t at = pair.find("To", 1); at != std::string_view::npos; at = pair.find("To", at + 1)) {
    const std::size_t next = at + 2;
    if (next >= pair.size() || (pair[next] >= 'a' && pair[next] <= 'z')) continue;
    if (split != std::string_view::npos) return std::nullopt;
    split = at;
  }
  if (split == std::string_view::npos) return std::nullopt;
  TransformName name{std::string(pair.substr(0, split)), std::string(pair.substr(split + 2))};
  for (std::string* frame : {&name.from, &name.to})
    if (frame->front() >= 'a' && frame->front() <= 'z')
      frame->front() = static_cast<char>(frame->front() - 'a' + 'A');
  return name;
}

Eigen::Matrix4d parse_matrix(std::string_view text, const std::string& place) {
  const auto numbers = parse_numbers(text, 16);
  if (!numbers)
    throw BadInput(fmt::format("{}: '{}' is not the 16 numbers of a transform, row by row; mend that line.",
                               place, text.substr(0, 60)));
  return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers->data());
}

std::string format_matrix(const Eigen::Matrix4d& m) {
  std::string text;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) {
      if (!text.empty()) text += ' ';
      text += format_number(m(row, column));
    }
  return text;
}

std::vector<FrameTransform> transforms_of(std::span<const Field> fields, const std::string& place) {
  std::vector<FrameTransform> transforms;
  for (const Field& field : fields) {
    auto name = transform_name(field.name);
    if (!name) continue;
    FrameTransform t;
    t.name = *std::move(name);
    if (const std::string* status = find_field(fields, field.name + "Status")) t.status = *status;
    if (t.ok()) t.to_from_from = parse_matrix(field.value, place + ", " + field.name);
    transforms.push_back(std::move(t));
  }
  return transforms;
}

void set_transform(SequenceFrame& frame, const TransformName& name, const Eigen::Matrix4d& to_from_from,
                   std::string_view status) {
  const std::string field = name.from + "To" + name.to + "Transform";
  set_field(frame.fields, field, format_matrix(to_from_from));
  set_field(frame.fields, field + "Status", std::string(status));
}

std::optional<double> timestamp_s(const SequenceFrame& frame) {
  const std::string* text = find_field(frame.fields, "Timestamp");
  if (text == nullptr) return std::nullopt;
  const auto seconds = parse_number(*text);
  return seconds && std::isfinite(*seconds) ? seconds : std::nullopt;
}

bool image_ok(const SequenceFrame& frame) {
  const std::string* status = find_field(frame.fields, "ImageStatus");
  return status == nullptr || same_name(*status, "OK");
}

}  // namespace sonoband::exchange
