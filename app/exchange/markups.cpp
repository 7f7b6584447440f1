#include "app/exchange/markups.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/bad_input.h"

namespace sonoband::exchange {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* schema =
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
    "markups-schema-v1.0.3.json#";

[[noreturn]] void refuse(const exam::ReviewObject& object, const std::string& what) {
  throw BadInput("review object " + object.object + ": " + what +
                 "; app/exchange/markups.h says what it should hold");
}

Json position(const exam::ReviewObject& object, const Json& json) {
  if (!json.is_array() || json.size() != 3) refuse(object, "a point is three numbers");
  for (const Json& value : json)
    if (!value.is_number() || !std::isfinite(value.get<double>())) refuse(object, "a point is three numbers");
  return json;
}

Json control_point(const std::string& id, const std::string& label, Json at) {
  return {{"id", id},        {"label", label},     {"position", std::move(at)},  {"selected", true},
          {"locked", false}, {"visibility", true}, {"positionStatus", "defined"}};
}

Json markup(const char* type) {
  return {{"type", type},
          {"coordinateSystem", "RAS"},
          {"coordinateUnits", "mm"},
          {"controlPoints", Json::array()}};
}

Json curve(const exam::ReviewObject& object, const char* type, const std::string& label, const Json& points) {
  Json made = markup(type);
  made["name"] = label;
  int number = 0;
  for (const Json& point : points) {
    ++number;
    made["controlPoints"].push_back(
        control_point(std::to_string(number), label + "-" + std::to_string(number), position(object, point)));
  }
  return made;
}

}  // namespace

std::string slicer_markups(const std::vector<exam::ReviewObject>& objects) {
  Json fiducials = markup("Fiducial");
  Json markups = Json::array();
  for (const exam::ReviewObject& object : objects) {
    const bool landmark = object.kind == exam::ReviewKind::landmark;
    const bool contour = object.kind == exam::ReviewKind::contour;
    if (!landmark && !contour && object.kind != exam::ReviewKind::measurement) continue;
    const Json json = Json::parse(object.json, nullptr, false);
    if (!json.is_object()) refuse(object, "it is no JSON object");
    const Json named = json.value("label", Json(object.object));
    if (!named.is_string()) refuse(object, "its label is no text");
    const auto label = named.get<std::string>();
    if (landmark) {
      if (!json.contains("position_mm")) refuse(object, "it has no position_mm");
      Json& points = fiducials["controlPoints"];
      points.push_back(
          control_point(std::to_string(points.size() + 1), label, position(object, json.at("position_mm"))));
      continue;
    }
    if (!json.contains("points_mm") || !json.at("points_mm").is_array())
      refuse(object, "it has no points_mm");
    const Json& points = json.at("points_mm");
    if (contour) {
      const bool closed = json.value("closed", Json(true)) == Json(true);
      markups.push_back(curve(object, closed ? "ClosedCurve" : "Curve", label, points));
    } else if (points.size() == 2) {
      markups.push_back(curve(object, "Line", label, points));
    }
  }
  if (!fiducials["controlPoints"].empty()) markups.insert(markups.begin(), std::move(fiducials));
  if (markups.empty()) return {};
  return Json{{"@schema", schema}, {"markups", std::move(markups)}}.dump(1, ' ', false,
                                                                         Json::error_handler_t::replace) +
         "\n";
}

}  // namespace sonoband::exchange
