#include "app/screen/review_objects.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "app/exam/whole_number.h"
#include "core/review/measure.h"

namespace sonoband {
namespace {

using Json = nlohmann::ordered_json;
using exam::ReviewKind;

constexpr std::array<const char*, 3> measure_names = {"distance", "angle", "area"};
constexpr std::array<const char*, 3> measure_labels = {"Distance", "Angle", "Area"};
constexpr std::array<const char*, 3> measure_units = {"mm", "deg", "mm2"};
constexpr std::array<const char*, 3> compounding_names = {"maximum", "minimum", "mean"};
constexpr std::array<const char*, 2> interpolation_names = {"nearest", "linear"};
constexpr std::size_t most_points = 100'000;  // of one object; a finger draws some hundreds

template <int N>
Json json_of(const Eigen::Matrix<double, N, 1>& v) {
  Json out = Json::array();
  for (int i = 0; i < N; ++i) out.push_back(v[i]);
  return out;
}

template <int N>
Json json_of(const std::vector<Eigen::Matrix<double, N, 1>>& points) {
  Json out = Json::array();
  for (const auto& p : points) out.push_back(json_of(p));
  return out;
}

Json json_of(const ReslicePlane& p) {
  return {{"origin_mm", json_of(p.origin.v)},
          {"right", json_of(p.right.v)},
          {"down", json_of(p.down.v)},
          {"size_px", {p.width, p.height}},
          {"pixel_mm", p.pixel_mm}};
}

// These throw std::runtime_error, or nlohmann's exceptions, for what is not there or not sound.
void require(bool sound, const char* what) {
  if (!sound) throw std::runtime_error(what);
}

double number(const Json& json) {
  const auto value = json.get<double>();
  require(std::isfinite(value), "a number is not finite");
  return value;
}

template <int N>
Eigen::Matrix<double, N, 1> vector_of(const Json& json) {
  require(json.is_array() && json.size() == N, "a point has the wrong number of coordinates");
  Eigen::Matrix<double, N, 1> v;
  for (int i = 0; i < N; ++i) v[i] = number(json.at(i));
  return v;
}

template <int N>
std::vector<Eigen::Matrix<double, N, 1>> points_of(const Json& json) {
  require(json.is_array() && json.size() <= most_points, "it has no list of points");
  std::vector<Eigen::Matrix<double, N, 1>> points;
  for (const Json& p : json) points.push_back(vector_of<N>(p));
  return points;
}

std::array<int, 2> size_of(const Json& json) {
  require(json.is_array() && json.size() == 2, "a size is two numbers");
  return {exam::whole_int(json.at(0), 1, 16384), exam::whole_int(json.at(1), 1, 16384)};
}

ReslicePlane plane_of(const Json& json) {
  const auto [width, height] = size_of(json.at("size_px"));
  const double pixel_mm = number(json.at("pixel_mm"));
  require(pixel_mm > 0 && pixel_mm < 1000, "its pixels have no size");
  ReslicePlane p;
  p.origin.v = vector_of<3>(json.at("origin_mm"));
  p.right.v = vector_of<3>(json.at("right"));
  p.down.v = vector_of<3>(json.at("down"));
  p.width = width;
  p.height = height;
  p.pixel_mm = pixel_mm;
  // As they are, not made unit again: the same plane gives the same bits.
  require(std::abs(p.right.v.norm() - 1) < 1e-6 && std::abs(p.down.v.norm() - 1) < 1e-6 &&
              std::abs(p.right.v.dot(p.down.v)) < 1e-6,
          "its axes are not unit and orthogonal");
  return p;
}

template <std::size_t N>
int index_of(const Json& json, const std::array<const char*, N>& names) {
  const auto name = json.get<std::string>();
  const auto found = std::find(names.begin(), names.end(), name);
  require(found != names.end(), "it names a choice that there is not");
  return static_cast<int>(found - names.begin());
}

int number_of(const Json& json) {
  return exam::whole_int(json.at("number"), 1, 999'999);
}

void read_curve(const Json& json, SweepReview& out) {
  ui::EditedCurve curve;
  curve.line = points_of<2>(json.at("line_mm"));
  for (const Json& h : json.at("handles")) curve.handles.push_back(exam::whole_int(h));
  require(std::is_sorted(curve.handles.begin(), curve.handles.end()) &&
              (curve.handles.empty() ||
               (curve.handles.front() >= 0 && curve.handles.back() < static_cast<int>(curve.line.size()))),
          "its handles are not on its line");
  out.curve_plane = plane_of(json.at("plane"));
  out.curve = std::move(curve);
}

void read(const exam::ReviewObject& object, const Json& json, SweepReview& out) {
  switch (object.kind) {
    case ReviewKind::plane: {
      const ReslicePlane plane = plane_of(json);
      out.content_px = size_of(json.at("content_px"));
      out.plane = plane;
      break;
    }
    case ReviewKind::band: {
      const double thickness_mm = number(json.at("thickness_mm"));
      const double reach_mm = number(json.at("reach_mm"));
      require(thickness_mm >= 0 && thickness_mm <= 1000 && reach_mm > 0 && reach_mm <= 1000,
              "a length is out of range");
      out.settings.compounding =
          static_cast<Compounding>(index_of(json.at("compounding"), compounding_names));
      out.settings.interpolation =
          static_cast<Interpolation>(index_of(json.at("interpolation"), interpolation_names));
      out.settings.band.thickness_mm = thickness_mm;
      out.reach_mm = reach_mm;
      break;
    }
    case ReviewKind::curve:
      read_curve(json, out);
      break;
    case ReviewKind::landmark:
      out.landmarks.push_back({vector_of<3>(json.at("position_mm")), number_of(json)});
      break;
    case ReviewKind::measurement:
      out.measurements.push_back({number_of(json),
                                  static_cast<ui::Measure>(index_of(json.at("kind"), measure_names)),
                                  points_of<3>(json.at("points_mm"))});
      break;
    case ReviewKind::contour: {
      SweepReview::Contour c;
      c.number = number_of(json);
      if (json.contains("plane"))
        c.plane = plane_of(json.at("plane"));
      else
        c.captured = Stamp(Duration(exam::whole_number(json.at("captured_ns"))));
      c.points = points_of<3>(json.at("points_mm"));
      require(c.points.size() >= 3, "it encloses nothing");
      out.contours.push_back(std::move(c));
      break;
    }
    case ReviewKind::snapshot:
    case ReviewKind::note:
      break;
  }
}

bool is_ours(ReviewKind kind) {
  return kind != ReviewKind::snapshot && kind != ReviewKind::note;
}

}  // namespace

double measured(ui::Measure kind, std::span<const Eigen::Vector3d> points) {
  switch (kind) {
    case ui::Measure::distance:
      return path_mm(points);
    case ui::Measure::angle:
      return points.size() == 3 ? angle_deg(points[0], points[1], points[2]) : 0;
    case ui::Measure::area:
      break;
  }
  return area_mm2(points);
}

std::vector<exam::ReviewObject> objects_of(const SweepReview& review, std::int64_t sweep) {
  std::vector<exam::ReviewObject> all;
  const std::string prefix = "sweep" + std::to_string(sweep) + "/";
  const auto add = [&](const std::string& name, ReviewKind kind, Json json) {
    json["sweep"] = sweep;
    exam::ReviewObject o;
    o.object = prefix + name;
    o.kind = kind;
    o.json = json.dump();
    all.push_back(std::move(o));
  };
  const auto numbered = [](const char* what, int n) { return what + std::string("-") + std::to_string(n); };
  if (review.plane) {
    Json json = json_of(*review.plane);
    json["content_px"] = review.content_px;
    add("plane", ReviewKind::plane, std::move(json));
  }
  add("band", ReviewKind::band,
      {{"thickness_mm", review.settings.band.thickness_mm},
       {"compounding", compounding_names[static_cast<std::size_t>(review.settings.compounding)]},
       {"interpolation", interpolation_names[static_cast<std::size_t>(review.settings.interpolation)]},
       {"reach_mm", review.reach_mm}});
  if (!review.curve.line.empty()) {
    add("curve", ReviewKind::curve,
        {{"plane", json_of(review.curve_plane)},
         {"line_mm", json_of(review.curve.line)},
         {"handles", review.curve.handles}});
  }
  for (const ui::LandmarkView& l : review.landmarks) {
    add(numbered("landmark", l.number), ReviewKind::landmark,
        {{"label", std::to_string(l.number)}, {"number", l.number}, {"position_mm", json_of(l.at_world)}});
  }
  for (const SweepReview::Measurement& m : review.measurements) {
    const auto kind = static_cast<std::size_t>(m.kind);
    add(numbered("measurement", m.number), ReviewKind::measurement,
        {{"label", measure_labels[kind] + std::string(" ") + std::to_string(m.number)},
         {"number", m.number},
         {"kind", measure_names[kind]},
         {"points_mm", json_of(m.points)},
         {"value", measured(m.kind, m.points)},
         {"unit", measure_units[kind]}});
  }
  for (const SweepReview::Contour& c : review.contours) {
    Json json = {{"label", "Contour " + std::to_string(c.number)},
                 {"number", c.number},
                 {"closed", true},
                 {"points_mm", json_of(c.points)},
                 {"area_mm2", area_mm2(c.points)}};
    if (c.plane)
      json["plane"] = json_of(*c.plane);
    else
      json["captured_ns"] = c.captured.time_since_epoch().count();
    add(numbered("contour", c.number), ReviewKind::contour, std::move(json));
  }
  return all;
}

SweepReview review_of(std::span<const exam::ReviewObject> objects, std::int64_t sweep,
                      std::vector<std::string>& refused) {
  SweepReview out;
  for (const exam::ReviewObject& o : objects) {
    if (o.removed || !is_ours(o.kind) || !o.object.starts_with("sweep" + std::to_string(sweep) + "/"))
      continue;
    try {
      read(o, Json::parse(o.json), out);
    } catch (const std::exception& e) {
      refused.push_back(o.object + " of this exam cannot be shown: " + e.what());
    }
  }
  return out;
}

void ReviewLog::know(std::span<const exam::ReviewObject> stored) {
  for (const exam::ReviewObject& o : stored)
    if (!o.removed && is_ours(o.kind)) told_[o.object] = {o.kind, o.json};
}

std::vector<exam::ReviewObject> ReviewLog::changes(const std::vector<exam::ReviewObject>& now) {
  std::vector<exam::ReviewObject> changed;
  std::map<std::string, Told> next;
  for (const exam::ReviewObject& o : now) {
    const auto before = told_.find(o.object);
    if (before == told_.end() || before->second.json != o.json) changed.push_back(o);
    next[o.object] = {o.kind, o.json};
  }
  for (const auto& [name, before] : told_) {
    if (next.contains(name)) continue;
    exam::ReviewObject gone;
    gone.object = name;
    gone.kind = before.kind;
    gone.removed = true;
    gone.json = before.json;
    changed.push_back(std::move(gone));
  }
  told_ = std::move(next);
  return changed;
}

}  // namespace sonoband
