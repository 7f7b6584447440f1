#include "app/exchange/sequence_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/bad_input.h"
#include "app/exchange/sweep_from_sequence.h"
#include "app/exchange/transform_graph.h"
#include "core/geometry/transforms.h"

namespace sonoband::exchange {

namespace {

using Json = nlohmann::ordered_json;

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Json time_of(const TrackedSequence& s) {
  std::vector<double> stamps;
  std::vector<double> intervals;
  std::vector<int> interval_after;
  std::optional<double> previous;
  int not_increasing = 0;
  for (int i = 0; i < s.frame_count(); ++i) {
    const auto t = timestamp_s(s.frames[i]);
    if (t) {
      stamps.push_back(*t);
      if (previous && *t > *previous) {
        intervals.push_back(*t - *previous);
        interval_after.push_back(i - 1);
      } else if (previous) {
        ++not_increasing;
      }
    }
    previous = t;
  }
  Json time;
  time["stamped"] = stamps.size();
  if (stamps.empty()) return time;
  const double usual = median(intervals);
  time["first_s"] = stamps.front();
  time["last_s"] = stamps.back();
  time["duration_s"] = stamps.back() - stamps.front();
  const double duration = stamps.back() - stamps.front();
  time["rate_hz"] = duration > 0 ? static_cast<double>(stamps.size() - 1) / duration : 0;
  time["median_interval_s"] = usual;
  time["not_increasing"] = not_increasing;
  time["gaps"] = Json::array();
  for (std::size_t i = 0; i < intervals.size(); ++i)
    if (intervals[i] > 1.75 * usual)
      time["gaps"].push_back({{"after_frame", interval_after[i]}, {"s", intervals[i]}});
  return time;
}

bool is_pose(const FrameTransform& t) {
  const Eigen::Matrix3d linear = t.to_from_from.topLeftCorner<3, 3>();
  return t.to_from_from.allFinite() &&
         (counts_pixels(t.name.from) || counts_pixels(t.name.to) || is_rotation(linear));
}

Json transforms_table(const std::vector<std::vector<FrameTransform>>& frames) {
  struct Row {
    TransformName name;
    int frames = 0;
    std::map<std::string, int> status;
    int status_missing = 0;
    int not_a_pose = 0;
  };
  std::vector<Row> rows;
  for (const auto& transforms : frames)
    for (const FrameTransform& t : transforms) {
      auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.name == t.name; });
      if (row == rows.end()) row = rows.insert(rows.end(), Row{.name = t.name, .status = {}});
      ++row->frames;
      if (t.status.empty())
        ++row->status_missing;
      else
        ++row->status[t.status];
      if (t.ok() && !is_pose(t)) ++row->not_a_pose;
    }
  Json table = Json::array();
  for (const Row& row : rows) {
    Json status = Json::object();
    for (const auto& [name, count] : row.status) status[name] = count;
    table.push_back({{"name", row.name.from + "To" + row.name.to},
                     {"frames", row.frames},
                     {"status", status},
                     {"status_missing", row.status_missing},
                     {"not_a_pose", row.not_a_pose}});
  }
  return table;
}

struct Motion {
  std::string of;
  std::string in;
  Eigen::Vector4d point = Eigen::Vector4d::UnitW();  // of `of`
};

// The middle of the picture where a calibration leads to it, else whatever is tracked first.
std::optional<Motion> what_moves(const TrackedSequence& s, const TransformGraph& graph) {
  const std::string world = default_world(s);
  if (world.empty()) return std::nullopt;
  if (graph.has("Image") && s.has_pictures())
    return Motion{"Image", world, {(s.width - 1) / 2.0, (s.height - 1) / 2.0, 0, 1}};
  if (graph.has("Probe") && world != "Probe") return Motion{.of = "Probe", .in = world};
  for (const std::string& frame : graph.frames())
    if (frame != world && frame != "Tracker") return Motion{.of = frame, .in = world};
  return std::nullopt;
}

Json motion_of(const TrackedSequence& s, const std::vector<std::vector<FrameTransform>>& own,
               const TransformGraph& shared, const std::string& file, Json& warnings) {
  TransformGraph first = shared;
  for (const auto& transforms : own)
    if (!transforms.empty()) {
      first = shared.with(transforms, file);
      break;
    }
  const auto motion = what_moves(s, first);
  if (!motion) return nullptr;
  std::vector<Eigen::Vector3d> places(s.frames.size(), Eigen::Vector3d::Zero());
  std::vector<char> placed(s.frames.size(), 0);
  Eigen::Matrix4d any = Eigen::Matrix4d::Identity();
  std::string first_refusal;
  for (int i = 0; i < s.frame_count(); ++i) {
    try {
      const auto found =
          shared.with(own[i], fmt::format("{}, frame {}", file, i)).find(motion->in, motion->of);
      if (!found || !found->ok) continue;
      any = found->to_from_from;
      places[i] = (any * motion->point).head<3>();
      placed[i] = 1;
    } catch (const BadInput& e) {
      if (first_refusal.empty()) first_refusal = e.what();
    }
  }
  const auto usable = std::count(placed.begin(), placed.end(), 1);
  std::vector<double> steps;
  std::vector<int> after;
  std::vector<double> speeds;
  double path = 0;
  for (int i = 1; i < s.frame_count(); ++i) {
    if (placed[i] == 0 || placed[i - 1] == 0) continue;
    steps.push_back((places[i] - places[i - 1]).norm());
    after.push_back(i - 1);
    path += steps.back();
    const auto t0 = timestamp_s(s.frames[i - 1]);
    const auto t1 = timestamp_s(s.frames[i]);
    if (t0 && t1 && *t1 > *t0) speeds.push_back(steps.back() / (*t1 - *t0));
  }
  if (!first_refusal.empty()) warnings.push_back(first_refusal);
  const auto largest = [](const std::vector<double>& v) {
    return v.empty() ? 0 : *std::max_element(v.begin(), v.end());
  };
  const double usual = median(steps);
  Json json{{"of", motion->of},
            {"in", motion->in},
            {"frames", usable},
            {"path_mm", path},
            {"spacing_mm", {{"median", usual}, {"max", largest(steps)}}},
            {"speed_mm_s", {{"median", median(speeds)}, {"max", largest(speeds)}}},
            {"jumps", Json::array()},
            {"without_pose", Json::array()}};
  for (int i = 0; i < s.frame_count(); ++i) {
    if (placed[i] != 0) continue;
    const int run = i;
    while (i + 1 < s.frame_count() && placed[i + 1] == 0) ++i;
    json["without_pose"].push_back({run, i});
  }
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (steps[i] > std::max(1.0, 5 * usual))
      json["jumps"].push_back({{"after_frame", after[i]}, {"mm", steps[i]}});
  if (usable > 0 && motion->of == "Image") {
    const Eigen::Vector3d x = any.block<3, 1>(0, 0);
    const Eigen::Vector3d y = any.block<3, 1>(0, 1);
    json["pixel_mm"] = {x.norm(), y.norm()};
    json["axes_deg"] =
        std::acos(std::clamp(x.normalized().dot(y.normalized()), -1.0, 1.0)) * 180 / std::numbers::pi;
  }
  return json;
}

}  // namespace

Json summarise(const ReadSequence& read, const std::optional<PlusConfig>& config, const std::string& file) {
  const TrackedSequence& s = read.sequence;
  Json json{{"file", file},
            {"frames", s.frame_count()},
            {"width", s.width},
            {"height", s.height},
            {"slices", s.slices},
            {"components", s.components},
            {"element_type", name_of(s.element_type)},
            {"orientation", s.orientation},
            {"orientation_in_file", s.orientation_in_file},
            {"image_type", s.image_type.empty() ? "BRIGHTNESS" : s.image_type},
            {"compressed", s.compressed}};
  Json warnings = read.warnings;
  if (config)
    for (const std::string& warning : config->warnings) warnings.push_back(warning);
  json["time"] = time_of(s);
  const auto good = std::count_if(s.frames.begin(), s.frames.end(), image_ok);
  json["pictures"] = {{"ok", good}, {"invalid", s.frame_count() - good}};
  std::vector<std::vector<FrameTransform>> own;
  own.reserve(s.frames.size());
  for (int i = 0; i < s.frame_count(); ++i)
    own.push_back(transforms_of(s.frames[i].fields, fmt::format("{}, frame {}", file, i)));
  json["transforms"] = transforms_table(own);
  json["motion"] = motion_of(s, own, shared_transforms(s, config ? &*config : nullptr, file), file, warnings);
  json["warnings"] = warnings;
  return json;
}

}  // namespace sonoband::exchange
