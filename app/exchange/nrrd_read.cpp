// Reading: "field: value" lines say the layout, "key:=value" lines are carried along.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "app/bad_input.h"
#include "app/exchange/header_fields.h"
#include "app/exchange/nrrd.h"
#include "app/exchange/payload.h"
#include "app/exchange/text.h"

namespace sonoband::exchange {

namespace {

struct TypeName {
  std::string_view name;
  ElementType type;
};
// Source: the NRRD format's list of synonyms.
constexpr std::array<TypeName, 41> type_names{{{"signed char", ElementType::int8},
                                               {"int8", ElementType::int8},
                                               {"int8_t", ElementType::int8},
                                               {"uchar", ElementType::uint8},
                                               {"unsigned char", ElementType::uint8},
                                               {"uint8", ElementType::uint8},
                                               {"uint8_t", ElementType::uint8},
                                               {"short", ElementType::int16},
                                               {"short int", ElementType::int16},
                                               {"signed short", ElementType::int16},
                                               {"signed short int", ElementType::int16},
                                               {"int16", ElementType::int16},
                                               {"int16_t", ElementType::int16},
                                               {"ushort", ElementType::uint16},
                                               {"unsigned short", ElementType::uint16},
                                               {"unsigned short int", ElementType::uint16},
                                               {"uint16", ElementType::uint16},
                                               {"uint16_t", ElementType::uint16},
                                               {"int", ElementType::int32},
                                               {"signed int", ElementType::int32},
                                               {"int32", ElementType::int32},
                                               {"int32_t", ElementType::int32},
                                               {"uint", ElementType::uint32},
                                               {"unsigned int", ElementType::uint32},
                                               {"uint32", ElementType::uint32},
                                               {"uint32_t", ElementType::uint32},
                                               {"longlong", ElementType::int64},
                                               {"long long", ElementType::int64},
                                               {"long long int", ElementType::int64},
                                               {"signed long long", ElementType::int64},
                                               {"signed long long int", ElementType::int64},
                                               {"int64", ElementType::int64},
                                               {"int64_t", ElementType::int64},
                                               {"ulonglong", ElementType::uint64},
                                               {"unsigned long long", ElementType::uint64},
                                               {"unsigned long long int", ElementType::uint64},
                                               {"uint64", ElementType::uint64},
                                               {"uint64_t", ElementType::uint64},
                                               {"float", ElementType::float32},
                                               {"double", ElementType::float64},
                                               {"block", ElementType::none}}};

class Header {
 public:
  Header(std::string file, const SequenceLimits& limits, std::vector<std::string>& warnings)
      : file_(std::move(file)), limits_(limits), warnings_(warnings), collector_(file_, limits) {}

  void read(std::istream& in);
  void interpret(TrackedSequence& sequence);

  Layout layout;
  bool big_endian = false;
  Packing packing = Packing::raw;
  std::string data_name;  // empty: in the same file
  std::string orientation;

 private:
  // Layout fields by their name in small letters without blanks ("space directions" is also spelled
  // "spacedirections").
  const std::string* optional(const std::string& name) const {
    const auto found = basic_.find(name);
    return found == basic_.end() ? nullptr : &found->second;
  }
  const std::string& required(const std::string& name) const;
  [[noreturn]] void refuse(const std::string& why) const {
    throw BadInput(fmt::format("{}: {}", file_, why));
  }
  void read_layout();
  void read_geometry(TrackedSequence& sequence) const;

  std::string file_;
  const SequenceLimits& limits_;
  std::vector<std::string>& warnings_;
  std::map<std::string, std::string> basic_;
  FieldCollector collector_;
};

std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name)
    if (c != ' ') plain += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return plain;
}

void Header::read(std::istream& in) {
  std::string line;
  std::int64_t skipped = 0;
  std::int64_t first_skipped = 0;
  for (std::int64_t number = 1;; ++number) {
    const LineStatus status = read_line(in, line);
    if (status == LineStatus::too_long)
      refuse(fmt::format("line {} of the header has no end; this is no NRRD header.", number));
    if (status == LineStatus::end) {
      if (basic_.contains("datafile")) break;  // a detached header may end without its blank line
      refuse("the header ends without its blank line; it is cut short, copy it again from its source.");
    }
    if (number == 1) {
      if (!is_nrrd(line)) refuse("the first line must be NRRD0001 to NRRD0005; this is no NRRD.");
      continue;
    }
    if (line.empty()) break;
    if (line.front() == '#') continue;
    const std::size_t key = line.find(":=");
    const std::size_t basic = line.find(": ");
    if (key != std::string::npos && (basic == std::string::npos || key < basic)) {
      std::string name(trim(std::string_view(line).substr(0, key)));
      if (!name.empty()) {
        // NRRD calls a picture's status Status where MetaImage calls it ImageStatus.
        constexpr std::string_view prefix = "Seq_Frame";
        if (starts_with_name(name, prefix) && name.ends_with("_Status") &&
            name.find('_', prefix.size()) == name.size() - 7)
          name.insert(name.size() - 6, "Image");
        collector_.add(name, trim(std::string_view(line).substr(key + 2)), number);
        continue;
      }
    } else if (basic != std::string::npos) {
      basic_[plain_name(trim(std::string_view(line).substr(0, basic)))] =
          trim(std::string_view(line).substr(basic + 2));
      continue;
    }
    if (skipped++ == 0) first_skipped = number;
  }
  if (skipped > 0)
    warnings_.push_back(
        fmt::format("{}, line {}: neither 'field: value' nor 'key:=value'; {} such lines were left out.",
                    file_, first_skipped, skipped));
}

const std::string& Header::required(const std::string& name) const {
  const std::string* value = optional(name);
  if (value == nullptr || value->empty())
    refuse(
        fmt::format("the field '{}' is missing; add it to the header or export the recording again.", name));
  return *value;
}

void Header::read_layout() {
  const auto dims = parse_integer(required("dimension"));
  if (!dims || *dims < 2 || *dims > 5)
    refuse(fmt::format("dimension is '{}'; it must be 2 to 5.", required("dimension").substr(0, 40)));
  std::vector<std::int64_t> sizes;
  for (const std::string_view token : split_blanks(required("sizes"))) {
    const auto size = parse_integer(token);
    if (!size || *size < 1)
      refuse(fmt::format("sizes has '{}', which is no size above 0.", token.substr(0, 40)));
    sizes.push_back(*size);
  }
  if (static_cast<std::int64_t>(sizes.size()) != *dims)
    refuse(fmt::format("dimension is {} but there are {} sizes; mend the header.", *dims, sizes.size()));
  std::vector<std::string> kinds;
  for (const std::string_view token : split_blanks(required("kinds"))) kinds.emplace_back(token);
  layout = layout_of(sizes, kinds, file_, limits_);
}

void Header::read_geometry(TrackedSequence& s) const {
  const auto vector_of = [](std::string_view token) -> std::optional<std::vector<double>> {
    if (token.size() < 2 || token.front() != '(' || token.back() != ')') return std::nullopt;
    std::string inner(token.substr(1, token.size() - 2));
    std::replace(inner.begin(), inner.end(), ',', ' ');
    return parse_numbers(inner, split_blanks(inner).size());
  };
  const auto spatial = static_cast<std::size_t>(layout.spatial);
  if (const std::string* directions = optional("spacedirections")) {
    std::size_t axis = 0;
    for (const std::string_view token : split_blanks(*directions)) {
      const auto direction = vector_of(token);
      if (!direction) continue;  // "none": the axis of the frames or of the components
      if (axis < spatial && direction->size() == spatial) {
        double length = 0;
        for (const double v : *direction) length += v * v;
        length = std::sqrt(length);
        if (length > 0) {
          s.geometry.spacing_mm[axis] = length;
          for (std::size_t i = 0; i < spatial; ++i)
            s.geometry.axes(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(axis)) =
                (*direction)[i] / length;
        }
      }
      ++axis;
    }
  }
  if (const std::string* origin = optional("spaceorigin"))
    if (const auto at = vector_of(*origin); at && at->size() == spatial)
      std::copy(at->begin(), at->end(), s.geometry.origin_mm.begin());
}

void Header::interpret(TrackedSequence& s) {
  read_layout();
  const std::string& type = required("type");
  const auto known = std::find_if(type_names.begin(), type_names.end(),
                                  [&](const TypeName& t) { return same_name(t.name, type); });
  if (known == type_names.end() || known->type == ElementType::none)
    refuse(fmt::format("the type '{}' is not known; uint8 is the usual one.", type.substr(0, 40)));
  s.element_type = known->type;
  const std::string& encoding = required("encoding");
  if (same_name(encoding, "gz") || same_name(encoding, "gzip"))
    packing = Packing::gzip;
  else if (!same_name(encoding, "raw"))
    refuse(fmt::format("the encoding '{}' is not read; export the recording as raw or gzip.",
                       encoding.substr(0, 40)));
  s.compressed = packing == Packing::gzip;
  if (const std::string* endian = optional("endian")) {
    big_endian = same_name(*endian, "big");
    if (!big_endian && !same_name(*endian, "little"))
      refuse(fmt::format("endian is '{}'; it must be little or big.", endian->substr(0, 40)));
  } else if (bytes_of(s.element_type) > 1) {
    refuse("the field 'endian' is missing and its samples are wider than a byte; add it to the header.");
  }
  for (const char* skip : {"lineskip", "byteskip"})
    if (const std::string* n = optional(skip); n != nullptr && *n != "0")
      refuse("line skip or byte skip is not 0; data files with a header of their own are not read.");
  if (const std::string* data = optional("datafile")) data_name = *data;

  s.components = layout.components;
  s.width = layout.width;
  s.height = layout.height;
  s.slices = layout.slices;
  read_geometry(s);
  for (Field& field : collector_.fields()) {
    if (same_name(field.name, "ultrasound image orientation"))
      orientation = field.value;
    else if (same_name(field.name, "ultrasound image type"))
      s.image_type = field.value;
    else if (same_name(field.name, "AnatomicalOrientation"))
      s.anatomical_orientation = field.value;
    else
      s.fields.push_back(std::move(field));
  }
  s.frames = collector_.take_frames(layout.frames, warnings_);
}

}  // namespace

bool is_nrrd(std::string_view first_line) {
  return first_line.size() == 8 && first_line.starts_with("NRRD000") && first_line[7] >= '1' &&
         first_line[7] <= '5';
}

ReadSequence read_nrrd(std::istream& in, const std::string& file, const SequenceLimits& limits,
                       const OpenBeside& open_beside) {
  ReadSequence result;
  TrackedSequence& s = result.sequence;
  Header header(file, limits, result.warnings);
  header.read(in);
  header.interpret(s);
  const std::uint64_t bytes = checked_pixel_bytes(header.layout, s.element_type, file, limits);

  std::istream* data = &in;
  std::string data_file = file;
  std::unique_ptr<std::istream> beside;
  if (!header.data_name.empty()) {
    if (header.data_name.find_first_of("/\\%") != std::string::npos || header.data_name == "LIST")
      throw BadInput(fmt::format(
          "{}: the data file '{}' is not one file in the same folder; put the pixels beside the header.",
          file, header.data_name.substr(0, 80)));
    beside = open_beside(header.data_name);
    if (!beside)
      throw BadInput(fmt::format("{}: its data file '{}' is not beside it; copy both files together.", file,
                                 header.data_name.substr(0, 80)));
    data = beside.get();
    data_file = fmt::format("{} (data of {})", header.data_name, file);
  }
  const std::uint64_t left = bytes_left(*data);
  check_payload_size(header.packing, left, bytes, data_file);
  if (header.packing == Packing::raw && left > bytes)
    result.warnings.push_back(
        fmt::format("{}: {} bytes behind the last pixel are left out.", data_file, left - bytes));
  s.pixels = take_pixels(bytes, file);
  read_payload(*data, header.packing, left, s.pixels.bytes(), data_file);
  if (header.big_endian) swap_bytes(s);
  turn_to_mf(s, header.orientation, file, result.warnings);
  return result;
}

}  // namespace sonoband::exchange
