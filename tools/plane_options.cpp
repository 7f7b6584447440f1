#include "tools/plane_options.h"

#include <cmath>

#include "app/exchange/text.h"
#include "core/reslice/band.h"
#include "core/reslice/default_plane.h"
#include "tools/argument_checks.h"

namespace sonoband::tools {

namespace {

constexpr int max_side_px = 32'768;

[[noreturn]] void wrong(const std::string& option, const std::string& why) {
  throw CLI::ValidationError(option, why);
}

std::pair<int, int> size_of(const std::string& text) {
  const std::size_t cross = text.find_first_of("xX");
  const auto width = exchange::parse_integer(text.substr(0, cross));
  const auto height =
      cross == std::string::npos ? std::nullopt : exchange::parse_integer(text.substr(cross + 1));
  if (!width || !height || *width < 1 || *height < 1 || *width > max_side_px || *height > max_side_px)
    wrong("--size",
          "'" + text + "' is not WxH with sides of 1 to " + std::to_string(max_side_px) + " pixels");
  return {static_cast<int>(*width), static_cast<int>(*height)};
}

bool any(const PlaneOptions& o) {
  return !o.origin.empty() || !o.right.empty() || !o.down.empty() || !o.size.empty();
}

ReslicePlane given_plane(const PlaneOptions& o, double pixel_mm) {
  if (o.origin.empty() || o.right.empty() || o.down.empty() || o.size.empty())
    wrong("--origin", "a plane needs --origin, --right, --down and --size together");
  const auto [width, height] = size_of(o.size);
  const auto plane = make_plane(comma_vector(o.origin, "--origin"), comma_vector(o.right, "--right"),
                                comma_vector(o.down, "--down"), width, height, pixel_mm);
  if (!plane) wrong("--down", "--right and --down must not be zero or parallel");
  return *plane;
}

}  // namespace

std::vector<double> comma_numbers(const std::string& text, std::size_t count, const std::string& option) {
  std::vector<double> numbers;
  std::size_t at = 0;
  while (at <= text.size()) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const auto number = exchange::parse_number(exchange::trim(text.substr(at, comma - at)));
    if (!number || !std::isfinite(*number)) break;
    numbers.push_back(*number);
    at = comma + 1;
  }
  if (at <= text.size() || numbers.size() != count)
    wrong(option, "'" + text + "' is not " + std::to_string(count) + " numbers with commas between");
  return numbers;
}

Eigen::Vector3d comma_vector(const std::string& text, const std::string& option) {
  const auto numbers = comma_numbers(text, 3, option);
  return {numbers[0], numbers[1], numbers[2]};
}

std::shared_ptr<PlaneOptions> add_plane_options(CLI::App& verb) {
  auto o = std::make_shared<PlaneOptions>();
  verb.add_option("--origin", o->origin, "X,Y,Z: centre of pixel (0,0) in mm of the world")->group("Plane");
  verb.add_option("--right", o->right, "X,Y,Z: direction of a row; made unit")->group("Plane");
  verb.add_option("--down", o->down, "X,Y,Z: direction of a column; made unit and orthogonal to right")
      ->group("Plane");
  verb.add_option("--size", o->size, "WxH in pixels")->group("Plane");
  verb.add_option("--pixel-mm", o->pixel_mm, "Side of a pixel in mm (default: width of a B-scan's pixel)")
      ->check(number_between(1e-4, 1e3))
      ->group("Plane");
  return o;
}

void check_plane_options(const PlaneOptions& options) {
  if (any(options)) given_plane(options, 1);
}

ChosenPlane choose_plane(const PlaneOptions& options, const SweepView& sweep) {
  const double natural_mm = pixel_width_mm(sweep);
  const double pixel_mm = options.pixel_mm > 0 ? options.pixel_mm : natural_mm;
  if (any(options)) return {given_plane(options, pixel_mm), true};
  auto plane = default_plane(sweep);
  if (!plane) wrong("--origin", "there is no plane to begin with; give --origin, --right, --down and --size");
  const double scale = plane->pixel_mm / pixel_mm;
  const auto side = [&](int pixels) {
    return static_cast<int>(std::min(std::ceil((pixels - 1) * scale) + 1, static_cast<double>(max_side_px)));
  };
  plane->width = side(plane->width);
  plane->height = side(plane->height);
  plane->pixel_mm = pixel_mm;
  return {*plane, false};
}

// A line is kept for every row of every layer: 2^26 of them are 1.6 GB.
void check_picture_size(const ReslicePlane& plane, const Band& band) {
  if (std::int64_t{plane.height} * band.layers() > std::int64_t{1} << 26 ||
      std::int64_t{plane.width} * plane.height > std::int64_t{1} << 28)
    throw CLI::ValidationError(
        "--size", "picture and band are too large together; take fewer pixels or a thinner band");
}

}  // namespace sonoband::tools
