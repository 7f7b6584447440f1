// Reading: fields first, then what they mean, then the pixels.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "app/bad_input.h"
#include "app/exchange/header_fields.h"
#include "app/exchange/metaimage.h"
#include "app/exchange/payload.h"
#include "app/exchange/text.h"

namespace sonoband::exchange {

namespace {

struct TypeName {
  std::string_view name;
  ElementType type;
};
// MET_LONG is 4 bytes on every machine that MetaIO runs on.
constexpr std::array<TypeName, 15> type_names{{{"MET_OTHER", ElementType::none},
                                               {"MET_NONE", ElementType::none},
                                               {"MET_CHAR", ElementType::int8},
                                               {"MET_ASCII_CHAR", ElementType::int8},
                                               {"MET_UCHAR", ElementType::uint8},
                                               {"MET_SHORT", ElementType::int16},
                                               {"MET_USHORT", ElementType::uint16},
                                               {"MET_INT", ElementType::int32},
                                               {"MET_LONG", ElementType::int32},
                                               {"MET_UINT", ElementType::uint32},
                                               {"MET_ULONG", ElementType::uint32},
                                               {"MET_LONG_LONG", ElementType::int64},
                                               {"MET_ULONG_LONG", ElementType::uint64},
                                               {"MET_FLOAT", ElementType::float32},
                                               {"MET_DOUBLE", ElementType::float64}}};

// Fields that say the layout: they are understood here and not carried along.
constexpr std::array<std::string_view, 17> layout_fields{
    "ObjectType",           "NDims",           "Kinds",          "DimSize",
    "ElementType",          "BinaryData",      "CompressedData", "BinaryDataByteOrderMSB",
    "ElementByteOrderMSB",  "ElementSpacing",  "Offset",         "CompressedDataSize",
    "TransformMatrix",      "ElementDataFile", "HeaderSize",     "ElementNumberOfChannels",
    "AnatomicalOrientation"};

class Header {
 public:
  Header(std::string file, const SequenceLimits& limits, std::vector<std::string>& warnings)
      : file_(std::move(file)), limits_(limits), warnings_(warnings), collector_(file_, limits) {}

  void read(std::istream& in);
  void interpret(TrackedSequence& sequence);

  Layout layout;
  bool big_endian = false;
  Packing packing = Packing::raw;
  std::int64_t packed_bytes = -1;  // as declared; -1: not said
  std::string data_name;           // LOCAL: in the same file
  std::string orientation;

 private:
  const std::string* optional(std::string_view name) { return find_field(collector_.fields(), name); }
  const std::string& required(std::string_view name);
  bool flag(std::string_view name, bool missing);
  [[noreturn]] void refuse(const std::string& why) const {
    throw BadInput(fmt::format("{}: {}", file_, why));
  }
  void read_layout();
  void read_geometry(TrackedSequence& sequence);

  std::string file_;
  const SequenceLimits& limits_;
  std::vector<std::string>& warnings_;
  FieldCollector collector_;
};

void Header::read(std::istream& in) {
  std::string line;
  std::int64_t number = 0;
  std::int64_t skipped = 0;
  std::int64_t first_skipped = 0;
  while (true) {
    const LineStatus status = read_line(in, line);
    ++number;
    if (status == LineStatus::end)
      refuse("the header ends without ElementDataFile; it is cut short, copy it again from its source.");
    if (status == LineStatus::too_long)
      refuse(fmt::format("line {} of the header has no end; this is no MetaImage header.", number));
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos) {
      if (trim(line).empty()) continue;
      if (skipped++ == 0) first_skipped = number;
      continue;
    }
    const std::string_view name = trim(std::string_view(line).substr(0, equals));
    const std::string_view value = trim(std::string_view(line).substr(equals + 1));
    if (number == 1 && !(same_name(name, "ObjectType") && same_name(value, "Image")))
      refuse("the first line must be 'ObjectType = Image'; this is no MetaImage.");
    if (name.empty()) {
      if (skipped++ == 0) first_skipped = number;
      continue;
    }
    collector_.add(name, value, number);
    if (same_name(name, "ElementDataFile")) break;
  }
  if (skipped > 0)
    warnings_.push_back(fmt::format("{}, line {}: not 'Name = Value'; {} such lines were left out.", file_,
                                    first_skipped, skipped));
}

const std::string& Header::required(std::string_view name) {
  const std::string* value = optional(name);
  if (value == nullptr || value->empty())
    refuse(fmt::format("the field {} is missing; add it to the header or export the recording again.", name));
  return *value;
}

bool Header::flag(std::string_view name, bool missing) {
  const std::string* value = optional(name);
  if (value == nullptr) return missing;
  if (same_name(*value, "True") || *value == "1") return true;
  if (same_name(*value, "False") || *value == "0") return false;
  refuse(fmt::format("{} is '{}'; it must be True or False.", name, value->substr(0, 40)));
}

void Header::read_layout() {
  const auto dims = parse_integer(required("NDims"));
  if (!dims || *dims < 2 || *dims > 4)
    refuse(fmt::format("NDims is '{}'; it must be 2, 3 or 4.", required("NDims").substr(0, 40)));
  std::vector<std::int64_t> sizes;
  for (const std::string_view token : split_blanks(required("DimSize"))) {
    const auto size = parse_integer(token);
    if (!size) refuse(fmt::format("DimSize has '{}', which is no whole number.", token.substr(0, 40)));
    sizes.push_back(*size);
  }
  std::vector<std::string> kinds;
  if (const std::string* listed = optional("Kinds")) {
    for (const std::string_view token : split_blanks(*listed)) kinds.emplace_back(token);
  } else {
    // PLUS takes the last dimension for frames; a 2-D file is one picture.
    kinds.assign(sizes.size(), "domain");
    if (sizes.size() > 2) kinds.back() = "list";
    warnings_.push_back(fmt::format("{}: no field Kinds; the last of the {} sizes is taken for {}.", file_,
                                    sizes.size(), sizes.size() > 2 ? "the frames" : "the rows"));
  }
  // PLUS does not count the colour components in NDims.
  const bool colour_first = !kinds.empty() && same_name(kinds.front(), "vector");
  const auto count = static_cast<std::int64_t>(sizes.size());
  if (count != *dims && !(colour_first && count == *dims + 1))
    refuse(fmt::format("NDims is {} but DimSize has {} sizes; mend the header.", *dims, count));
  layout = layout_of(sizes, kinds, file_, limits_);
  if (const std::string* channels = optional("ElementNumberOfChannels")) {
    const auto n = parse_integer(*channels);
    if (!n || (*n != 1 && *n != 3))
      refuse(fmt::format("ElementNumberOfChannels is '{}'; only 1 (grey) and 3 (RGB) are read.",
                         channels->substr(0, 40)));
    if (layout.components == 1) layout.components = static_cast<int>(*n);
  }
}

void Header::read_geometry(TrackedSequence& s) {
  const auto numbers = [&](std::string_view name, std::size_t least) -> std::vector<double> {
    const std::string* text = optional(name);
    if (text == nullptr) return {};
    auto values = parse_numbers(*text, split_blanks(*text).size());
    if (!values || values->size() < least) return {};
    return *std::move(values);
  };
  const std::size_t spatial = layout.spatial;
  const auto spacing = numbers("ElementSpacing", spatial);
  const auto offset = numbers("Offset", spatial);
  for (std::size_t i = 0; i < spatial; ++i) {
    if (!spacing.empty()) s.geometry.spacing_mm[i] = spacing[i];
    if (!offset.empty()) s.geometry.origin_mm[i] = offset[i];
  }
  const auto axes = numbers("TransformMatrix", spatial * spatial);
  for (std::size_t n = spatial; n <= 4; ++n)
    if (axes.size() == n * n)
      for (std::size_t axis = 0; axis < spatial; ++axis)
        for (std::size_t i = 0; i < spatial; ++i)
          s.geometry.axes(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(axis)) = axes[axis * n + i];
}

void Header::interpret(TrackedSequence& s) {
  read_layout();
  const std::string& type = required("ElementType");
  const auto known = std::find_if(type_names.begin(), type_names.end(),
                                  [&](const TypeName& t) { return same_name(t.name, type); });
  if (known == type_names.end())
    refuse(fmt::format("ElementType '{}' is not known; MET_UCHAR is the usual one.", type.substr(0, 40)));
  s.element_type = known->type;
  if (!flag("BinaryData", true))
    refuse("the pixels are text (BinaryData = False); export the recording with binary pixels.");
  if (optional("BinaryData") == nullptr)
    warnings_.push_back(fmt::format("{}: no field BinaryData; the pixels are taken as binary.", file_));
  big_endian = flag("BinaryDataByteOrderMSB", flag("ElementByteOrderMSB", false));
  s.compressed = flag("CompressedData", false);
  packing = s.compressed ? Packing::zlib : Packing::raw;
  if (const std::string* size = optional("CompressedDataSize"); size != nullptr && s.compressed) {
    const auto bytes = parse_integer(*size);
    if (!bytes || *bytes < 0)
      refuse(fmt::format("CompressedDataSize is '{}'; it must be a count of bytes.", size->substr(0, 40)));
    packed_bytes = *bytes;
  }
  if (const std::string* skip = optional("HeaderSize"); skip != nullptr && *skip != "0")
    refuse("HeaderSize is not 0; data files that begin with a header of their own are not read.");
  data_name = required("ElementDataFile");

  s.components = layout.components;
  s.width = layout.width;
  s.height = layout.height;
  s.slices = layout.slices;
  if (s.width == 0) s.element_type = ElementType::none;
  if (s.element_type == ElementType::none && static_cast<std::int64_t>(s.width) * s.height > 1)
    refuse(fmt::format("ElementType {} says there are no pixels, but DimSize gives pictures of {} x {}.",
                       type, s.width, s.height));
  read_geometry(s);
  if (const std::string* code = optional("UltrasoundImageOrientation")) orientation = *code;
  if (const std::string* image_type = optional("UltrasoundImageType")) s.image_type = *image_type;
  if (const std::string* anatomy = optional("AnatomicalOrientation")) s.anatomical_orientation = *anatomy;

  for (Field& field : collector_.fields()) {
    const auto same = [&](std::string_view name) { return same_name(name, field.name); };
    if (std::any_of(layout_fields.begin(), layout_fields.end(), same)) continue;
    if (same("UltrasoundImageOrientation") || same("UltrasoundImageType")) continue;
    // Always zeros, in as many dimensions as the file has.
    if (same("CenterOfRotation") && field.value.find_first_not_of("0 .") == std::string::npos) continue;
    s.fields.push_back(std::move(field));
  }
  s.frames = collector_.take_frames(layout.frames, warnings_);
}

}  // namespace

bool is_metaimage(std::string_view first_line) {
  const std::size_t equals = first_line.find('=');
  return equals != std::string_view::npos && same_name(trim(first_line.substr(0, equals)), "ObjectType");
}

ReadSequence read_metaimage(std::istream& in, const std::string& file, const SequenceLimits& limits,
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
  if (!same_name(header.data_name, "LOCAL")) {
    if (header.data_name.find_first_of("/\\%") != std::string::npos ||
        starts_with_name(header.data_name, "LIST"))
      throw BadInput(fmt::format(
          "{}: ElementDataFile '{}' is not one file in the same folder; put the pixels beside the header.",
          file, header.data_name.substr(0, 80)));
    beside = open_beside(header.data_name);
    if (!beside)
      throw BadInput(fmt::format("{}: its data file '{}' is not beside it; copy both files together.", file,
                                 header.data_name.substr(0, 80)));
    data = beside.get();
    data_file = fmt::format("{} (data of {})", header.data_name, file);
  }
  if (bytes > 0) {
    const std::uint64_t left = bytes_left(*data);
    std::uint64_t packed = left;
    if (s.compressed && header.packed_bytes >= 0) {
      packed = static_cast<std::uint64_t>(header.packed_bytes);
      if (packed > left)
        throw BadInput(
            fmt::format("{}: CompressedDataSize is {} and {} bytes are there; it is cut short, copy it again "
                        "from its source.",
                        data_file, packed, left));
    } else if (s.compressed) {
      result.warnings.push_back(fmt::format(
          "{}: no field CompressedDataSize; everything behind the header is taken for pixels.", file));
    } else if (left > bytes) {
      result.warnings.push_back(
          fmt::format("{}: {} bytes behind the last pixel are left out.", data_file, left - bytes));
    }
    check_payload_size(header.packing, packed, bytes, data_file);
    s.pixels = take_pixels(bytes, file);
    read_payload(*data, header.packing, packed, s.pixels.bytes(), data_file);
    if (header.big_endian) swap_bytes(s);
  }
  turn_to_mf(s, header.orientation, file, result.warnings);
  return result;
}

}  // namespace sonoband::exchange
