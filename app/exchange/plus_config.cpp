#include "app/exchange/plus_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <pugixml.hpp>

#include "app/bad_input.h"
#include "app/exchange/text.h"

namespace sonoband::exchange {

namespace {

constexpr std::uint64_t max_config_bytes = std::uint64_t{64} << 20;  // PLUS's own are kilobytes

class Walker final : public pugi::xml_tree_walker {
 public:
  Walker(std::string_view text, std::string file, PlusConfig& config)
      : text_(text), file_(std::move(file)), config_(config) {}

  bool for_each(pugi::xml_node& node) override {
    const std::string_view name = node.name();
    if (name == "Transform") read_transform(node);
    if (name == "VolumeReconstruction") read_sector(node);
    return true;
  }

 private:
  std::string place(const pugi::xml_node& node) const {
    const auto offset =
        std::clamp<std::ptrdiff_t>(node.offset_debug(), 0, static_cast<std::ptrdiff_t>(text_.size()));
    const auto line = 1 + std::count(text_.begin(), text_.begin() + offset, '\n');
    return fmt::format("{}, line {}", file_, line);
  }

  [[noreturn]] void refuse(const pugi::xml_node& node, const std::string& why) const {
    throw BadInput(fmt::format("{}: {}", place(node), why));
  }

  void read_transform(const pugi::xml_node& node);
  void read_sector(const pugi::xml_node& node);

  // Numbers of the first attribute of these that is there, the present name before the deprecated one.
  std::optional<std::vector<double>> numbers(const pugi::xml_node& node,
                                             std::initializer_list<const char*> names,
                                             std::size_t count) const;

  std::string_view text_;
  std::string file_;
  PlusConfig& config_;
};

void Walker::read_transform(const pugi::xml_node& node) {
  const bool defined = std::string_view(node.parent().name()) == "CoordinateDefinitions";
  const bool whole = node.attribute("From") && node.attribute("To") && node.attribute("Matrix");
  if (!whole && !defined) return;  // another element of that name
  if (!whole)
    refuse(node, "a Transform of CoordinateDefinitions needs From, To and Matrix; add what is missing.");
  ConfigTransform t;
  t.name = {std::string(trim(node.attribute("From").value())),
            std::string(trim(node.attribute("To").value()))};
  t.place = place(node);
  t.error = node.attribute("Error").value();
  t.date = node.attribute("Date").value();
  if (t.name.from.empty() || t.name.to.empty() || t.name.from == t.name.to)
    refuse(node, "From and To of a Transform must name two different frames.");
  t.to_from_from = parse_matrix(node.attribute("Matrix").value(),
                                fmt::format("{}, Matrix of {} to {}", t.place, t.name.from, t.name.to));
  config_.transforms.push_back(std::move(t));
}

std::optional<std::vector<double>> Walker::numbers(const pugi::xml_node& node,
                                                   std::initializer_list<const char*> names,
                                                   std::size_t count) const {
  for (const char* name : names) {
    const pugi::xml_attribute attribute = node.attribute(name);
    if (!attribute) continue;
    auto values = parse_numbers(attribute.value(), count);
    const bool good =
        values && std::all_of(values->begin(), values->end(), [](double v) { return std::abs(v) < 1e6; });
    if (!good)
      refuse(node,
             fmt::format("{} is '{}'; it must be {} number{}.", name,
                         std::string_view(attribute.value()).substr(0, 40), count, count == 1 ? "" : "s"));
    return values;
  }
  return std::nullopt;
}

void Walker::read_sector(const pugi::xml_node& node) {
  const auto origin = numbers(node, {"ClipRectangleOrigin"}, 2);
  const auto size = numbers(node, {"ClipRectangleSize"}, 2);
  if (origin.has_value() != size.has_value())
    refuse(node, "ClipRectangleOrigin and ClipRectangleSize belong together; add the missing one.");
  // PLUS writes a size of 0 where there is no clip.
  if (origin && !config_.clip && ((*size)[0] != 0 || (*size)[1] != 0)) {
    if ((*size)[0] < 1 || (*size)[1] < 1)
      refuse(node, "ClipRectangleSize must be at least 1 pixel each way.");
    config_.clip =
        ClipRectangle{static_cast<int>(std::floor((*origin)[0])), static_cast<int>(std::floor((*origin)[1])),
                      static_cast<int>(std::floor((*size)[0])), static_cast<int>(std::floor((*size)[1]))};
  }
  const auto angles = numbers(node, {"FanAnglesDeg", "FanAngles"}, 2);
  const auto apex = numbers(node, {"FanOriginPixel", "FanOrigin"}, 2);
  const auto start = numbers(node, {"FanRadiusStartPixel"}, 1);
  const auto stop = numbers(node, {"FanRadiusStopPixel", "FanDepth"}, 1);
  // Without angles there is no fan, whatever else is said (PLUS).
  if (!angles || config_.fan || ((*angles)[0] == 0 && (*angles)[1] == 0)) return;
  Fan fan;
  if (apex) fan.origin_px = {(*apex)[0], (*apex)[1]};
  fan.from_deg = std::min((*angles)[0], (*angles)[1]);
  fan.to_deg = std::max((*angles)[0], (*angles)[1]);
  if (start) fan.start_px = (*start)[0];
  if (stop) fan.stop_px = (*stop)[0];
  if (!stop)
    config_.warnings.push_back(fmt::format(
        "{}: the fan has no FanRadiusStopPixel; PLUS's {} pixels are taken.", place(node), fan.stop_px));
  if (fan.from_deg == fan.to_deg || fan.from_deg <= -90 || fan.to_deg >= 90)
    refuse(node, "FanAnglesDeg must be two different angles between -90 and 90.");
  if (fan.start_px < 0 || fan.stop_px <= fan.start_px)
    refuse(node, "FanRadiusStopPixel must be more than FanRadiusStartPixel, and neither below 0.");
  config_.fan = fan;
}

}  // namespace

PlusConfig parse_plus_config(std::string_view xml, const std::string& file) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(xml.data(), xml.size());
  if (!parsed) {
    const auto offset = std::clamp<std::ptrdiff_t>(parsed.offset, 0, static_cast<std::ptrdiff_t>(xml.size()));
    throw BadInput(fmt::format("{}, line {}: this is no XML ({}); name a PLUS configuration.", file,
                               1 + std::count(xml.begin(), xml.begin() + offset, '\n'),
                               parsed.description()));
  }
  PlusConfig config;
  Walker walker(xml, file, config);
  document.traverse(walker);
  return config;
}

PlusConfig read_plus_config(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  if (!in || error)
    throw BadInput(
        fmt::format("{}: cannot be opened; check the name of the PLUS configuration.", path.string()));
  if (size > max_config_bytes)
    throw BadInput(fmt::format("{}: {} bytes are too many for a PLUS configuration.", path.string(), size));
  std::string text(size, '\0');
  in.read(text.data(), static_cast<std::streamsize>(size));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return parse_plus_config(text, path.string());
}

PlusConfig read_plus_configs(const std::vector<std::filesystem::path>& paths) {
  PlusConfig all;
  for (const std::filesystem::path& path : paths) {
    PlusConfig one = read_plus_config(path);
    std::move(one.transforms.begin(), one.transforms.end(), std::back_inserter(all.transforms));
    std::move(one.warnings.begin(), one.warnings.end(), std::back_inserter(all.warnings));
    if (one.clip) all.clip = one.clip;
    if (one.fan) all.fan = one.fan;
  }
  return all;
}

Pixels sector_mask(int width, int height, const std::optional<ClipRectangle>& clip,
                   const std::optional<ClipRectangle>& second_clip, const std::optional<Fan>& fan,
                   const std::string& place) {
  if (!clip && !second_clip && !fan) return {};
  const auto inside = [](const std::optional<ClipRectangle>& r, int x, int y) {
    return !r || (x >= r->x && y >= r->y && std::int64_t{x} - r->x < r->width &&
                  std::int64_t{y} - r->y < r->height);
  };
  constexpr double degree = std::numbers::pi / 180;
  // Rays through pixel centres count as inside; 1e-9 px is far above rounding and far below a pixel.
  constexpr double edge_px = 1e-9;
  const double tan_from = fan ? std::tan(fan->from_deg * degree) : 0;
  const double tan_to = fan ? std::tan(fan->to_deg * degree) : 0;
  Pixels mask(width, height);
  std::int64_t left = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      bool in = inside(clip, x, y) && inside(second_clip, x, y);
      if (in && fan) {
        const double dx = x - fan->origin_px[0];
        const double dy = y - fan->origin_px[1];
        const double squared = dx * dx + dy * dy;
        in = dy > 0 && dx >= tan_from * dy - edge_px && dx <= tan_to * dy + edge_px &&
             squared >= fan->start_px * fan->start_px && squared <= fan->stop_px * fan->stop_px;
      }
      mask.view()(x, y) = in ? 255 : 0;
      left += in ? 1 : 0;
    }
  if (left == 0)
    throw BadInput(fmt::format(
        "{}: clip rectangle and fan leave no pixel of the {} x {} pictures; mend them or give --mask none.",
        place, width, height));
  return mask;
}

}  // namespace sonoband::exchange
