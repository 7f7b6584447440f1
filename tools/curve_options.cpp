#include "tools/curve_options.h"

#include <cmath>
#include <fstream>
#include <map>

#include "app/bad_input.h"
#include "app/exchange/text.h"
#include "tools/argument_checks.h"
#include "tools/plane_options.h"

namespace sonoband::tools {

namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // spreadsheets begin UTF-8 with it

const std::map<std::string, FlowMethod>& methods() {
  static const std::map<std::string, FlowMethod> names{
      {"exact", FlowMethod::exact}, {"route-map", FlowMethod::route_map}, {"naive", FlowMethod::naive}};
  return names;
}

}  // namespace

std::shared_ptr<CurveOptions> add_curve_options(CLI::App& verb, const std::string& method_option) {
  auto o = std::make_shared<CurveOptions>();
  verb.add_option(method_option, o->method,
                  "exact (default), route-map (the paper's fast one) or naive (normals, for teaching)")
      ->transform(one_of(methods()))
      ->group("Curve");
  verb.add_option("--smooth-px", o->smooth_px,
                  "Sigma of the smoothing along the curve, in rows (default 4; 0 leaves the curve as given)")
      ->check(number_between(0, max_smooth_px))
      ->group("Curve");
  return o;
}

const char* name_of(FlowMethod method) {
  for (const auto& [name, value] : methods())
    if (value == method) return name.c_str();
  return "";
}

std::vector<PlanePoint> curve_text(const std::string& text, const std::string& option) {
  std::vector<PlanePoint> points;
  for (const std::string_view word : exchange::split_blanks(text)) {
    const std::vector<double> xy = comma_numbers(std::string(word), 2, option);
    points.emplace_back(xy[0], xy[1]);
  }
  return points;
}

std::vector<PlanePoint> read_curve_csv(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path))
    throw BadInput(path.string() + ": this is a folder; give a file of lines x,y in mm");
  std::ifstream file(path);
  if (!file) throw BadInput("cannot read " + path.string() + "; give a file of lines x,y in mm");
  std::vector<PlanePoint> points;
  std::string line;
  for (int number = 1;; ++number) {
    const exchange::LineStatus status = exchange::read_line(file, line, 4096);
    if (status == exchange::LineStatus::end) break;
    const std::string place = path.string() + ":" + std::to_string(number) + ": ";
    if (status == exchange::LineStatus::too_long)
      throw BadInput(place + "the line has more than 4096 bytes; write one point x,y per line");
    std::string_view text = line;
    if (number == 1 && text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
    text = exchange::trim(text);
    if (text.empty() || text.front() == '#' || (points.empty() && exchange::same_name(text, "x,y"))) continue;
    const std::size_t comma = std::min(text.find(','), text.size());
    const auto x = exchange::parse_number(exchange::trim(text.substr(0, comma)));
    const auto y =
        comma == text.size() ? std::nullopt : exchange::parse_number(exchange::trim(text.substr(comma + 1)));
    if (!x || !y || !std::isfinite(*x) || !std::isfinite(*y))
      throw BadInput(place + "'" + std::string(text.substr(0, 60)) +
                     "' is not x,y; write two finite numbers of mm");
    if (points.size() == max_curve_px)
      throw BadInput(place + "there are more than " + std::to_string(max_curve_px) +
                     " points; leave some out");
    points.emplace_back(*x, *y);
  }
  return points;
}

CurveResult curve_of(const std::vector<PlanePoint>& points, const CurveOptions& options, double pixel_mm) {
  const bool closed = points.size() >= 4 && points.front() == points.back();
  return make_curve(points, {.pixel_mm = pixel_mm, .smooth_px = options.smooth_px, .closed = closed});
}

}  // namespace sonoband::tools
