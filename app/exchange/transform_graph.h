// Frames as nodes, transforms as edges: from any frame to any other along the fewest links.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/exchange/plus_config.h"
#include "app/exchange/sequence.h"

namespace sonoband::exchange {

// One answer of the graph.
struct FoundTransform {
  Eigen::Matrix4d to_from_from = Eigen::Matrix4d::Identity();
  bool ok = true;                  // every link was OK
  std::string bad_link;            // the first that was not: "ProbeToTrackerTransform is MISSING"
  std::vector<std::string> links;  // "ImageToProbe", "inverse of ReferenceToTracker"
};

// The transforms that hold for one picture: its own, those of the file's header, those of configurations.
// Lookups prefer fewer links, then a picture's own over the header's over a configuration's, then the order
// in the file. Of two configurations' transforms between the same two frames the later counts.
class TransformGraph {
 public:
  TransformGraph() = default;

  // `place` ("config.xml, line 12", "sweep.mha, frame 3") stands in every sentence about this edge.
  void add(const TransformName& name, const Eigen::Matrix4d& to_from_from, const std::string& place);
  void add(const std::vector<ConfigTransform>& transforms);

  // A view of this graph with one picture's own transforms on top.
  TransformGraph with(const std::vector<FrameTransform>& own, const std::string& place) const;

  std::vector<std::string> frames() const;  // in order of first mention
  bool has(const std::string& frame) const;

  // Empty: no chain of edges leads there. Throws BadInput naming the place when a link on the way is not
  // finite, singular, has another last row than 0 0 0 1, or is no rotation though neither of its frames
  // counts in pixels (see counts_pixels). Links that are not OK are not looked into.
  std::optional<FoundTransform> find(const std::string& to, const std::string& from) const;

 private:
  struct Edge {
    TransformName name;
    Eigen::Matrix4d matrix;
    std::string status;  // empty or OK: usable
    std::string place;
  };
  std::vector<Edge> own_;     // first choice
  std::vector<Edge> shared_;  // second
};

// Frames whose unit is the pixel, so that a transform to or from them may scale and shear: names that begin
// with Image or end with Image or Pixel.
bool counts_pixels(const std::string& frame);

// "a, b and c" for sentences.
std::string listed(const std::vector<std::string>& names);

}  // namespace sonoband::exchange
