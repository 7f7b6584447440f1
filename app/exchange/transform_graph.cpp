#include "app/exchange/transform_graph.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <deque>

#include "app/bad_input.h"
#include "core/geometry/transforms.h"

namespace sonoband::exchange {

bool counts_pixels(const std::string& frame) {
  return frame.starts_with("Image") || frame.ends_with("Image") || frame.ends_with("Pixel");
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text.empty() ? "none" : text;
}

namespace {

void check_link(const TransformName& name, const Eigen::Matrix4d& m, const std::string& place) {
  const auto refuse = [&](const std::string& why) {
    throw BadInput(fmt::format("{}: the transform from {} to {} {}.", place, name.from, name.to, why));
  };
  if (!m.allFinite()) refuse("has a number that is not finite; mark the frame INVALID or mend it");
  if ((m.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > 1e-6)
    refuse("has a last row other than 0 0 0 1; it is no pose, mend it");
  const Eigen::Matrix3d linear = m.topLeftCorner<3, 3>();
  if (!is_invertible(Affine<frame::World, frame::Image>{linear, m.topRightCorner<3, 1>()}))
    refuse("is singular; calibrate again");
  if (!counts_pixels(name.from) && !counts_pixels(name.to) && !is_rotation(linear))
    refuse(
        fmt::format("is no rotation (its axes are {:.4g}, {:.4g} and {:.4g} long, determinant {:.4g}); it is "
                    "no pose, mend "
                    "it or mark it INVALID",
                    linear.col(0).norm(), linear.col(1).norm(), linear.col(2).norm(), linear.determinant()));
}

}  // namespace

void TransformGraph::add(const TransformName& name, const Eigen::Matrix4d& to_from_from,
                         const std::string& place) {
  std::erase_if(shared_, [&](const Edge& e) {
    return e.name == name || (e.name.from == name.to && e.name.to == name.from);
  });
  shared_.push_back({name, to_from_from, "", place});
}

void TransformGraph::add(const std::vector<ConfigTransform>& transforms) {
  for (const ConfigTransform& t : transforms) add(t.name, t.to_from_from, t.place);
}

TransformGraph TransformGraph::with(const std::vector<FrameTransform>& own, const std::string& place) const {
  TransformGraph graph = *this;
  for (const FrameTransform& t : own) graph.own_.push_back({t.name, t.to_from_from, t.status, place});
  return graph;
}

std::vector<std::string> TransformGraph::frames() const {
  std::vector<std::string> names;
  for (const auto* edges : {&own_, &shared_})
    for (const Edge& e : *edges)
      for (const std::string* name : {&e.name.from, &e.name.to})
        if (std::find(names.begin(), names.end(), *name) == names.end()) names.push_back(*name);
  return names;
}

bool TransformGraph::has(const std::string& frame) const {
  const auto names = frames();
  return std::find(names.begin(), names.end(), frame) != names.end();
}

std::optional<FoundTransform> TransformGraph::find(const std::string& to, const std::string& from) const {
  // Breadth first from `from`; each frame remembers the edge that reached it first.
  struct Step {
    std::string frame;
    const Edge* edge = nullptr;
    bool inverted = false;
    std::size_t previous = 0;
  };
  std::vector<Step> steps{{from, nullptr, false, 0}};
  const auto reached = [&](const std::string& frame) {
    return std::any_of(steps.begin(), steps.end(), [&](const Step& s) { return s.frame == frame; });
  };
  std::size_t at = 0;
  while (at < steps.size() && steps[at].frame != to) {
    const std::string here = steps[at].frame;
    for (const auto* edges : {&own_, &shared_})
      for (const Edge& e : *edges) {
        const bool forward = e.name.from == here;
        if (!forward && e.name.to != here) continue;
        const std::string& there = forward ? e.name.to : e.name.from;
        if (!reached(there)) steps.push_back({there, &e, !forward, at});
      }
    ++at;
  }
  if (at == steps.size()) return std::nullopt;
  std::vector<const Step*> way;
  for (std::size_t i = at; i != 0; i = steps[i].previous) way.push_back(&steps[i]);
  std::reverse(way.begin(), way.end());

  FoundTransform found;
  for (const Step* step : way) {
    const Edge& e = *step->edge;
    found.links.push_back((step->inverted ? "inverse of " : "") + e.name.from + "To" + e.name.to);
    if (!e.status.empty() && e.status != "OK") {
      if (found.ok) found.bad_link = fmt::format("{}To{}Transform is {}", e.name.from, e.name.to, e.status);
      found.ok = false;
    }
  }
  if (!found.ok) return found;
  for (const Step* step : way) {
    const Edge& e = *step->edge;
    check_link(e.name, e.matrix, e.place);
    found.to_from_from =
        (step->inverted ? Eigen::Matrix4d(e.matrix.inverse()) : e.matrix) * found.to_from_from;
  }
  return found;
}

}  // namespace sonoband::exchange
