#include "app/exchange/stradwin.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "app/bad_input.h"
#include "app/exchange/file_beside.h"
#include "app/exchange/text.h"
#include "core/image/doppler.h"

namespace sonoband::exchange {

namespace {

constexpr double mm_per_cm = 10;
constexpr double half_px = 0.5;
constexpr std::size_t longest_line = 4096;
// Scales of one recording agree to the rounding of their products; axes are at right angles likewise.
constexpr double tolerance = 1e-6;
// Time of a frame in an .sx; the unit in an .sw is not documented, ours says ns as well.
constexpr double ns_per_s = 1e9;

struct Position {
  std::array<double, 3> cm{};
  double azimuth_deg = 0;
  double elevation_deg = 0;
  double roll_deg = 0;
};

Eigen::Matrix4d matrix(const Position& p) {
  const double k = std::numbers::pi / 180;
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = (Eigen::AngleAxisd(p.azimuth_deg * k, Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(p.elevation_deg * k, Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(p.roll_deg * k, Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();
  for (int i = 0; i < 3; ++i) m(i, 3) = p.cm[static_cast<std::size_t>(i)] * mm_per_cm;
  return m;
}

Position position(const Eigen::Matrix3d& r, const Eigen::Vector3d& t_mm) {
  const double k = 180 / std::numbers::pi;
  Position p;
  for (int i = 0; i < 3; ++i) p.cm[static_cast<std::size_t>(i)] = t_mm(i) / mm_per_cm;
  p.elevation_deg = std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0))) * k;
  // Looking straight up or down, azimuth and roll turn about the same axis: azimuth is 0 then.
  if (std::hypot(r(0, 0), r(1, 0)) < 1e-12) {
    p.roll_deg = std::atan2(-r(1, 2), r(1, 1)) * k;
  } else {
    p.azimuth_deg = std::atan2(r(1, 0), r(0, 0)) * k;
    p.roll_deg = std::atan2(r(2, 1), r(2, 2)) * k;
  }
  return p;
}

// Stradx: 128 + level is blue, 192 + level red. A bijection on the bytes.
std::uint8_t key_of_byte(std::uint8_t b) {
  if (b < 128) return b;
  return doppler::colour_key(b < 192 ? b - 128 : b - 192, b >= 192);
}
std::uint8_t byte_of_key(std::uint8_t key) {
  if (!doppler::is_colour(key)) return key;
  const int level = (key - 128) / 2;
  return static_cast<std::uint8_t>((key & 1) != 0 ? 192 + level : 128 + level);
}

struct Resources {
  std::map<std::string, std::string, std::less<>> values;
  std::string file;

  bool has(std::string_view name) const { return values.contains(name); }
  double number(std::string_view name, double otherwise) const {
    const auto at = values.find(name);
    if (at == values.end()) return otherwise;
    const auto value = parse_number(at->second);
    if (!value || !std::isfinite(*value))
      throw BadInput(fmt::format("{}: {} is '{}', which is no number; correct it.", file, name, at->second));
    return *value;
  }
  bool yes(std::string_view name) const {
    const auto at = values.find(name);
    return at != values.end() && (same_name(at->second, "true") || at->second == "1");
  }
  Position position(const std::string& prefix) const {
    return {{number(prefix + "XTRANS", 0), number(prefix + "YTRANS", 0), number(prefix + "ZTRANS", 0)},
            number(prefix + "AZIMUTH", 0),
            number(prefix + "ELEVATION", 0),
            number(prefix + "ROLL", 0)};
  }
};

int side(const Resources& resources, std::string_view name, const SequenceLimits& limits) {
  const double value = resources.number(name, 0);
  if (value < 1 || value > limits.max_side_px || value != std::floor(value))
    throw BadInput(
        fmt::format("{}: {} must be a whole number from 1 to {}.", resources.file, name, limits.max_side_px));
  return static_cast<int>(value);
}

}  // namespace

bool is_strad(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  return same_name(extension, ".sx") || same_name(extension, ".sw");
}

ReadSequence read_strad(std::istream& header, const std::string& file, std::istream& pixels,
                        const std::string& pixel_file, const SequenceLimits& limits) {
  ReadSequence read;
  TrackedSequence& s = read.sequence;
  Resources resources;
  resources.file = file;
  struct Image {
    std::vector<double> numbers;
    int line;
  };
  std::vector<Image> images;
  std::string line;
  for (int number = 1;; ++number) {
    const LineStatus status = read_line(header, line, longest_line);
    if (status == LineStatus::end) break;
    if (status == LineStatus::too_long)
      throw BadInput(fmt::format("{}, line {}: longer than {} bytes; this is no Stradx or Stradwin file.",
                                 file, number, longest_line));
    const std::vector<std::string_view> words = split_blanks(line);
    if (words.empty() || words[0].starts_with('#')) continue;
    if (words[0] != "IM") {
      if (words[0].starts_with("RES_") && words.size() > 1) {
        const std::size_t at = static_cast<std::size_t>(words[1].data() - line.data());
        resources.values[std::string(words[0])] = std::string(trim(std::string_view(line).substr(at)));
      }
      continue;
    }
    Image image{{}, number};
    for (std::size_t i = 1; i < words.size(); ++i) {
      const auto value = parse_number(words[i]);
      if (!value || !std::isfinite(*value))
        throw BadInput(fmt::format("{}, line {}: '{}' is no number; correct it.", file, number, words[i]));
      image.numbers.push_back(*value);
    }
    if (static_cast<std::int64_t>(images.size()) >= limits.max_frames)
      throw BadInput(fmt::format("{}, line {}: more than {} frames; split the recording.", file, number,
                                 limits.max_frames));
    images.push_back(std::move(image));
  }
  if (images.empty()) throw BadInput(fmt::format("{}: there is no IM line, so no picture in it.", file));
  s.width = side(resources, "RES_BUF_WIDTH", limits);
  s.height = side(resources, "RES_BUF_HEIGHT", limits);
  s.frames.resize(images.size());
  if (s.frame_bytes() > limits.max_pixel_bytes / images.size())
    throw BadInput(fmt::format("{}: {} pictures of {} x {} are more than fits here.", file, images.size(),
                               s.width, s.height));
  if (resources.yes("RES_BUF_RF"))
    throw BadInput(fmt::format("{}: this is raw radio-frequency data; only B-scans are read.", file));

  const bool with_size = images.front().numbers.size() == 8 || images.front().numbers.size() == 2;
  const Eigen::Matrix4d iso = [&] {
    Position p;
    p.cm = {resources.number("RES_ISOCENTRE_X", 0), resources.number("RES_ISOCENTRE_Y", 0),
            resources.number("RES_ISOCENTRE_Z", 0)};
    p.azimuth_deg = resources.number("RES_ISOCENTRE_AZIMUTH", 0);
    p.elevation_deg = resources.number("RES_ISOCENTRE_ELEVATION", 0);
    p.roll_deg = resources.number("RES_ISOCENTRE_ROLL", 0);
    return matrix(p);
  }();
  for (std::size_t i = 0; i < images.size(); ++i) {
    const Image& image = images[i];
    const std::size_t head = with_size ? 2 : 1;
    const bool placed = image.numbers.size() == head + 6;
    if (!placed && image.numbers.size() != head)
      throw BadInput(fmt::format("{}, line {}: IM has {} numbers; {} were expected.", file, image.line,
                                 image.numbers.size(), head + 6));
    if (with_size && image.numbers[1] != static_cast<double>(s.frame_bytes()))
      throw BadInput(fmt::format("{}, line {}: the picture has {} bytes, {} x {} need {}.", file, image.line,
                                 image.numbers[1], s.width, s.height, s.frame_bytes()));
    SequenceFrame& frame = s.frames[i];
    if (placed) {
      const double* n = image.numbers.data() + head;
      set_transform(frame, {"Probe", "Tracker"}, iso * matrix({{n[0], n[1], n[2]}, n[3], n[4], n[5]}));
    } else {
      set_transform(frame, {"Probe", "Tracker"}, Eigen::Matrix4d::Identity(), "MISSING");
    }
    set_field(frame.fields, "Timestamp", format_number(image.numbers[0] / ns_per_s));
    set_field(frame.fields, "ImageStatus", "OK");
  }
  if (!with_size)
    read.warnings.push_back(file +
                            ": the unit of its times is not documented; they are taken as nanoseconds.");

  const double x_mm = resources.number("RES_XSCALE", 0) * mm_per_cm;
  const double y_mm = resources.number("RES_YSCALE", 0) * mm_per_cm;
  if (!(x_mm > 0) || !(y_mm > 0))
    throw BadInput(fmt::format("{}: RES_XSCALE and RES_YSCALE (cm per pixel) must be above 0.", file));
  Eigen::Matrix4d pixel = Eigen::Vector4d(x_mm, y_mm, x_mm, 1).asDiagonal();
  pixel(0, 3) = half_px * x_mm;
  pixel(1, 3) = half_px * y_mm;
  set_field(s.fields, "ImageToProbeTransform", format_matrix(matrix(resources.position("RES_")) * pixel));
  set_field(s.fields, "ImageToProbeTransformStatus", "OK");

  const std::size_t size = s.frame_bytes() * images.size();
  s.pixels = PixelBuffer(size);
  pixels.read(reinterpret_cast<char*>(s.pixels.bytes().data()), static_cast<std::streamsize>(size));
  if (static_cast<std::size_t>(pixels.gcount()) != size)
    throw BadInput(
        fmt::format("{}: it ends after {} of {} bytes; copy it again.", pixel_file, pixels.gcount(), size));
  if (pixels.peek() != std::istream::traits_type::eof())
    throw BadInput(fmt::format("{}: longer than the {} bytes that {} asks for; they do not belong together.",
                               pixel_file, size, file));
  if (resources.yes("RES_BUF_DOPPLER")) {
    for (std::uint8_t& b : s.pixels.bytes()) b = key_of_byte(b);
    set_field(s.fields, "SonobandPixels", "doppler");
  }
  s.image_type = "BRIGHTNESS";
  return read;
}

ReadSequence read_strad(const std::filesystem::path& path) {
  std::ifstream header(path, std::ios::binary);
  if (!header) throw BadInput(path.string() + ": cannot be opened; check the name.");
  // The .sw may name its pixels; only a file of the same folder is taken.
  std::filesystem::path beside = path;
  beside.replace_extension(".sxi");
  std::string line;
  while (read_line(header, line, longest_line) == LineStatus::ok) {
    const std::vector<std::string_view> words = split_blanks(line);
    if (words.size() == 2 && words[0] == "RES_BIN_IM_FILENAME")
      beside = path.parent_path() / std::filesystem::path(words[1]).filename();
  }
  header.clear();
  header.seekg(0);
  std::ifstream pixels(beside, std::ios::binary);
  if (!pixels)
    throw BadInput(beside.string() + ": cannot be opened; the pictures of " + path.string() +
                   " belong there.");
  return read_strad(header, path.string(), pixels, beside.string(), default_limits());
}

int write_strad(const TrackedSequence& s, const std::string& world, bool doppler,
                const std::filesystem::path& path, const Progress& progress) {
  const bool stradx = same_name(path.extension().string(), ".sx");
  std::filesystem::path beside = path;
  beside.replace_extension(".sxi");
  FileBeside header(path);
  FileBeside pixels(beside, progress, s.pixels.bytes().size());
  std::string lines;
  double x_mm = 0;
  double y_mm = 0;
  int written = 0;
  for (int i = 0; i < s.frame_count(); ++i) {
    const std::string place = fmt::format("{}, frame {}", path.string(), i);
    const std::vector<FrameTransform> transforms = transforms_of(s.frames[i].fields, place);
    const auto found = std::find_if(transforms.begin(), transforms.end(), [&](const FrameTransform& t) {
      return t.name == TransformName{"Image", world} && t.ok();
    });
    if (found == transforms.end()) continue;
    const Eigen::Vector3d x = found->to_from_from.block<3, 1>(0, 0);
    const Eigen::Vector3d y = found->to_from_from.block<3, 1>(0, 1);
    if (written == 0) {
      x_mm = x.norm();
      y_mm = y.norm();
    }
    if (std::abs(x.dot(y)) > tolerance * x.norm() * y.norm())
      throw BadInput(
          fmt::format("{}: the picture's axes are at {:.2f} degrees; Stradx and Stradwin know right angles "
                      "only; export it as mha.",
                      place, std::acos(x.dot(y) / (x.norm() * y.norm())) * 180 / std::numbers::pi));
    if (std::abs(x.norm() - x_mm) > tolerance * x_mm || std::abs(y.norm() - y_mm) > tolerance * y_mm)
      throw BadInput(fmt::format("{}: pixels of another size than before; export it as mha.", place));
    Eigen::Matrix3d r;
    r << x.normalized(), y.normalized(), x.cross(y).normalized();
    // Their pixel (0, 0) begins at the corner, ours is a centre.
    const Eigen::Vector3d corner = found->to_from_from.block<3, 1>(0, 3) - half_px * (x + y);
    const Position p = position(r, corner);
    const double time_ns = timestamp_s(s.frames[i]).value_or(0) * ns_per_s;
    lines += fmt::format("IM {:.0f}{} {} {} {} {} {} {}\n", time_ns,
                         stradx ? fmt::format(" {}", s.frame_bytes()) : std::string(), format_number(p.cm[0]),
                         format_number(p.cm[1]), format_number(p.cm[2]), format_number(p.azimuth_deg),
                         format_number(p.elevation_deg), format_number(p.roll_deg));
    std::vector<std::uint8_t> bytes(s.frame_pixels(i).begin(), s.frame_pixels(i).end());
    if (doppler) {
      for (std::uint8_t& b : bytes) b = byte_of_key(b);
    }
    pixels.stream().write(reinterpret_cast<const char*>(bytes.data()),
                          static_cast<std::streamsize>(bytes.size()));
    ++written;
  }
  if (written == 0)
    throw BadInput(path.string() + ": no frame has a place in space; there is nothing to write.");
  header.stream() << fmt::format(
      "# Written by Sonoband. Research use only.\nRES_BUF_FRAMES {}\nRES_BUF_WIDTH {}\nRES_BUF_HEIGHT "
      "{}\nRES_POS_REC "
      "true\nRES_BUF_RF false\nRES_BUF_DOPPLER {}\nRES_XTRANS 0\nRES_YTRANS 0\nRES_ZTRANS 0\nRES_AZIMUTH 0\n"
      "RES_ELEVATION 0\nRES_ROLL 0\nRES_END_HEADER\nRES_XSCALE {}\nRES_YSCALE {}\nRES_BIN_IM_FILENAME {}\n",
      written, s.width, s.height, doppler ? "true" : "false", format_number(x_mm / mm_per_cm),
      format_number(y_mm / mm_per_cm), beside.filename().string());
  header.stream() << lines;
  pixels.commit();
  header.commit();
  return s.frame_count() - written;
}

}  // namespace sonoband::exchange
