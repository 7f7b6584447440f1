#include "app/exam/setup_json.h"

#include <array>
#include <nlohmann/json.hpp>

#include "app/exam/whole_number.h"

namespace sonoband::exam {
namespace {

using Json = nlohmann::json;

constexpr std::array<const char*, 8> review_names = {"plane",   "band",        "curve",    "landmark",
                                                     "contour", "measurement", "snapshot", "note"};

}  // namespace

std::string to_json(const SweepSetup& s) {
  Json json = {{"width_px", s.width},
               {"height_px", s.height},
               {"kind", s.kind == PixelKind::doppler ? "doppler" : "grey"},
               {"frames_per_second", s.frames_per_second},
               {"calibration", {{"name", s.calibration_name}, {"error_mm", s.calibration_error_mm}}},
               {"latency_offset_ns", s.latency_offset.count()},
               {"crop_px", {s.crop.x, s.crop.y, s.crop.width, s.crop.height}},
               {"world", s.world},
               {"pressed_ns", s.pressed.time_since_epoch().count()},
               {"pressed_utc_ns", s.pressed_utc_ns}};
  if (s.probe_from_image) {
    Json rows = Json::array();
    for (int r = 0; r < 3; ++r)
      rows.push_back({s.probe_from_image->linear(r, 0), s.probe_from_image->linear(r, 1),
                      s.probe_from_image->linear(r, 2), s.probe_from_image->translation(r)});
    json["calibration"]["probe_from_image"] = rows;
  }
  Json versions = Json::object();
  for (const auto& [device, version] : s.versions) versions[device] = version;
  json["versions"] = versions;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

SweepSetup setup_from_json(const std::string& text) {
  const Json json = Json::parse(text);
  SweepSetup s;
  s.width = whole_int(json.at("width_px"));
  s.height = whole_int(json.at("height_px"));
  s.kind = json.at("kind") == "doppler" ? PixelKind::doppler : PixelKind::grey;
  s.frames_per_second = json.at("frames_per_second");
  const Json& calibration = json.at("calibration");
  s.calibration_name = calibration.at("name");
  s.calibration_error_mm = calibration.at("error_mm");
  if (calibration.contains("probe_from_image")) {
    Affine<frame::Probe, frame::Image> matrix;
    for (int r = 0; r < 3; ++r) {
      const Json& row = calibration.at("probe_from_image").at(r);
      for (int c = 0; c < 3; ++c) matrix.linear(r, c) = row.at(c);
      matrix.translation(r) = row.at(3);
    }
    s.probe_from_image = matrix;
  }
  s.latency_offset = Duration(whole_number(json.at("latency_offset_ns")));
  const Json& crop = json.at("crop_px");
  s.crop = {whole_int(crop.at(0)), whole_int(crop.at(1)), whole_int(crop.at(2)), whole_int(crop.at(3))};
  s.world = json.at("world");
  s.pressed = Stamp(Duration(whole_number(json.at("pressed_ns"))));
  s.pressed_utc_ns = whole_number(json.at("pressed_utc_ns"));
  for (const auto& [device, version] : json.at("versions").items())
    s.versions.emplace_back(device, version.get<std::string>());
  return s;
}

std::string to_json(const std::vector<Counter>& counters) {
  Json json = Json::array();
  for (const Counter& c : counters) json.push_back({c.name, c.value});
  return json.dump();
}

std::vector<Counter> counters_from_json(const std::string& text) {
  const Json json = Json::parse(text);
  std::vector<Counter> counters;
  for (const Json& c : json)
    counters.push_back({c.at(0), static_cast<std::uint64_t>(whole_number(c.at(1), 0))});
  return counters;
}

const char* name_of(ReviewKind kind) {
  return review_names[static_cast<std::size_t>(kind)];
}

std::optional<ReviewKind> review_kind(const std::string& name) {
  for (std::size_t i = 0; i < review_names.size(); ++i)
    if (name == review_names[i]) return static_cast<ReviewKind>(i);
  return std::nullopt;
}

}  // namespace sonoband::exam
