#include <fmt/format.h>

#include <array>

#include "app/bad_input.h"
#include "app/exchange/header_fields.h"
#include "app/exchange/metaimage.h"
#include "app/exchange/payload.h"
#include "app/exchange/text.h"

namespace sonoband::exchange {

namespace {

std::string_view met_name(ElementType type) {
  switch (type) {
    case ElementType::none:
      return "MET_OTHER";
    case ElementType::int8:
      return "MET_CHAR";
    case ElementType::uint8:
      return "MET_UCHAR";
    case ElementType::int16:
      return "MET_SHORT";
    case ElementType::uint16:
      return "MET_USHORT";
    case ElementType::int32:
      return "MET_INT";
    case ElementType::uint32:
      return "MET_UINT";
    case ElementType::int64:
      return "MET_LONG_LONG";
    case ElementType::uint64:
      return "MET_ULONG_LONG";
    case ElementType::float32:
      return "MET_FLOAT";
    case ElementType::float64:
      return "MET_DOUBLE";
  }
  return "MET_OTHER";
}

// A name that the reader would take for part of the layout or of another place.
constexpr std::array<std::string_view, 15> reserved{"ObjectType",
                                                    "NDims",
                                                    "Kinds",
                                                    "DimSize",
                                                    "ElementType",
                                                    "BinaryData",
                                                    "HeaderSize",
                                                    "BinaryDataByteOrderMSB",
                                                    "CompressedDataSize",
                                                    "ElementSpacing",
                                                    "Offset",
                                                    "CompressedData",
                                                    "TransformMatrix",
                                                    "ElementDataFile",
                                                    "ElementNumberOfChannels"};

void check(const Field& field, const std::string& file, bool of_header) {
  std::string why = unwritable(field, "=");
  if (why.empty() && of_header)
    for (const std::string_view name : reserved)
      if (same_name(name, field.name)) why = "has a name that means something else in a MetaImage";
  if (why.empty() && of_header && starts_with_name(field.name, "Seq_Frame"))
    why = "has the name of a frame's field";
  if (!why.empty())
    throw BadInput(fmt::format("{}: the field '{}' {}; rename it before writing a MetaImage.", file,
                               field.name.substr(0, 80), why));
}

}  // namespace

void write_metaimage(const TrackedSequence& s, std::ostream& out, const std::string& file, std::ostream& data,
                     const std::string& data_name) {
  const bool volume = s.slices > 1;
  const bool list = s.frame_count() > 1;
  const int spatial = volume ? 3 : 2;
  const int dims = spatial + (list ? 1 : 0);
  const bool compressed = s.compressed && !s.pixels.bytes().empty();

  std::string sizes = fmt::format("{} {}", s.width, s.height);
  std::string kinds = "domain domain";
  if (volume) {
    sizes += fmt::format(" {}", s.slices);
    kinds += " domain";
  }
  if (list) {
    sizes += fmt::format(" {}", s.frame_count());
    kinds += " list";
  }
  std::string spacing;
  std::string offset;
  std::string centre;
  std::string matrix;
  for (int axis = 0; axis < dims; ++axis) {
    const bool in_space = axis < spatial;
    const std::string blank = axis == 0 ? "" : " ";
    spacing += blank + format_number(in_space ? s.geometry.spacing_mm[axis] : 1);
    offset += blank + format_number(in_space ? s.geometry.origin_mm[axis] : 0);
    centre += blank + "0";
    for (int i = 0; i < dims; ++i) {
      const double value = in_space && i < spatial ? s.geometry.axes(i, axis) : (i == axis ? 1 : 0);
      matrix += (matrix.empty() ? "" : " ") + format_number(value);
    }
  }

  out << "ObjectType = Image\nNDims = " << dims << "\nAnatomicalOrientation = " << s.anatomical_orientation
      << "\nBinaryData = True\nBinaryDataByteOrderMSB = False\n";
  if (find_field(s.fields, "CenterOfRotation") == nullptr) out << "CenterOfRotation = " << centre << '\n';
  out << "CompressedData = " << (compressed ? "True" : "False") << '\n';
  std::streampos size_at{};
  if (compressed) {
    out << "CompressedDataSize = ";
    size_at = out.tellp();
    out << fmt::format("{:<20}", 0) << '\n';  // wide enough for any 64-bit count, filled in below
  }
  // PLUS, ITK and 3D Slicer all take colour from ElementNumberOfChannels; components inside DimSize are
  // understood by PLUS alone.
  out << "DimSize = " << sizes << "\nElementNumberOfChannels = " << s.components
      << "\nElementSpacing = " << spacing << "\nElementType = " << met_name(s.element_type)
      << "\nKinds = " << kinds << "\nOffset = " << offset << "\nTransformMatrix = " << matrix
      << "\nUltrasoundImageOrientation = " << s.orientation << '\n';
  if (!s.image_type.empty()) out << "UltrasoundImageType = " << s.image_type << '\n';
  for (const Field& field : s.fields) {
    check(field, file, true);
    out << field.name << " = " << field.value << '\n';
  }
  for (int frame = 0; frame < s.frame_count(); ++frame) {
    const std::string prefix = frame_prefix(frame);
    for (const Field& field : s.frames[frame].fields) {
      check(field, file, false);
      out << prefix << field.name << " = " << field.value << '\n';
    }
  }
  out << "ElementDataFile = " << (data_name.empty() ? "LOCAL" : data_name) << '\n';

  PayloadWriter payload(data, compressed ? Packing::zlib : Packing::raw);
  payload.write(s.pixels.bytes());
  const std::uint64_t packed = payload.finish();
  if (compressed) {
    out.seekp(size_at);
    out << packed;
    out.seekp(0, std::ios::end);
  }
}

}  // namespace sonoband::exchange
