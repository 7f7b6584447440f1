#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "app/bad_input.h"
#include "app/exchange/header_fields.h"
#include "app/exchange/nrrd.h"
#include "app/exchange/payload.h"
#include "app/exchange/text.h"

namespace sonoband::exchange {

namespace {

void check(const Field& field, const std::string& file, bool of_header) {
  std::string why = unwritable(field, ":=");
  if (why.empty() &&
      (field.name.find(": ") != std::string::npos || field.name.front() == '#' || field.name.back() == ':'))
    why = "has a name that an NRRD header would read as something else";
  if (why.empty() && of_header)
    for (const std::string_view name :
         {"ultrasound image orientation", "ultrasound image type", "AnatomicalOrientation"})
      if (same_name(name, field.name)) why = "has a name that means something else in an NRRD";
  if (why.empty() && of_header && starts_with_name(field.name, "Seq_Frame"))
    why = "has the name of a frame's field";
  if (why.empty() && !of_header && field.name == "Status") why = "has the name of NRRD's picture status";
  if (!why.empty())
    throw BadInput(fmt::format("{}: the field '{}' {}; rename it before writing an NRRD.", file,
                               field.name.substr(0, 80), why));
}

}  // namespace

void write_nrrd(const TrackedSequence& s, std::ostream& out, const std::string& file, std::ostream& data,
                const std::string& data_name) {
  const bool pictures = !s.pixels.bytes().empty();
  const bool volume = s.slices > 1;
  const bool list = s.frame_count() > 1;
  const bool colour = s.components > 1;
  const int spatial = volume ? 3 : 2;
  const int dims = (colour ? 1 : 0) + spatial + (list ? 1 : 0);

  std::string kinds = colour ? "vector " : "";
  std::string sizes = colour ? fmt::format("{} ", s.components) : "";
  std::string directions = colour ? "none " : "";
  std::string origin;
  const std::array<int, 3> sides{pictures ? s.width : 1, pictures ? s.height : 1, s.slices};
  for (int axis = 0; axis < spatial; ++axis) {
    const std::string blank = axis == 0 ? "" : " ";
    kinds += blank + "domain";
    sizes += blank + std::to_string(sides[axis]);
    std::string direction;
    for (int i = 0; i < spatial; ++i)
      direction +=
          (i == 0 ? "" : ",") + format_number(s.geometry.axes(i, axis) * s.geometry.spacing_mm[axis]);
    directions += blank + "(" + direction + ")";
    origin += (axis == 0 ? "" : ",") + format_number(s.geometry.origin_mm[axis]);
  }
  if (list) {
    kinds += " list";
    sizes += " " + std::to_string(s.frame_count());
    directions += " none";
  }
  const ElementType type = pictures ? s.element_type : ElementType::uint8;
  out << "NRRD0004\n# Complete NRRD file format specification at:\n# "
         "http://teem.sourceforge.net/nrrd/format.html\n"
      << "dimension: " << dims << "\nencoding: " << (s.compressed ? "gz" : "raw")
      << "\nendian: little\nkinds: " << kinds << "\nsizes: " << sizes << "\nspace dimension: " << spatial
      << "\nspace directions: " << directions << "\nspace origin: (" << origin << ")\ntype: " << name_of(type)
      << '\n';
  if (!data_name.empty()) out << "data file: " << data_name << '\n';
  out << "ultrasound image orientation:=" << s.orientation << '\n';
  if (!s.image_type.empty()) out << "ultrasound image type:=" << s.image_type << '\n';
  if (s.anatomical_orientation != "RAI") out << "AnatomicalOrientation:=" << s.anatomical_orientation << '\n';
  for (const Field& field : s.fields) {
    check(field, file, true);
    out << field.name << ":=" << field.value << '\n';
  }
  for (int frame = 0; frame < s.frame_count(); ++frame) {
    const std::string prefix = frame_prefix(frame);
    for (const Field& field : s.frames[frame].fields) {
      check(field, file, false);
      out << prefix << (same_name(field.name, "ImageStatus") ? "Status" : field.name) << ":=" << field.value
          << '\n';
    }
  }
  out << '\n';

  PayloadWriter payload(data, s.compressed ? Packing::gzip : Packing::raw);
  if (pictures) {
    payload.write(s.pixels.bytes());
  } else {
    const std::vector<std::uint8_t> dummies(s.frames.size() * s.components, 0);
    payload.write(dummies);
  }
  payload.finish();
}

}  // namespace sonoband::exchange
