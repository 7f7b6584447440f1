// What review makes of one sweep, as values, and as the objects that an exam keeps of it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/exam/records.h"
#include "core/geometry/plane.h"
#include "core/reslice/band.h"
#include "ui/interact/curve_editor.h"
#include "ui/view.h"

namespace sonoband {

// Lengths in mm of World; numbers are as shown and never given twice within a sweep.
struct SweepReview {
  std::optional<ReslicePlane> plane;  // empty: the sweep's own
  std::array<int, 2> content_px{};    // of the plane that just holds the sweep
  RenderSettings settings;            // of it: thickness, compounding, interpolation
  double reach_mm = 20;               // the paper's r
  ui::EditedCurve curve;              // on a plane of its own
  ReslicePlane curve_plane;
  struct Measurement {
    int number = 0;
    ui::Measure kind = ui::Measure::distance;
    std::vector<Eigen::Vector3d> points;
  };
  struct Contour {
    int number = 0;
    Stamp captured{};                   // of its B-scan, if it was drawn on one
    std::optional<ReslicePlane> plane;  // else that it was drawn on
    std::vector<Eigen::Vector3d> points;
  };
  std::vector<ui::LandmarkView> landmarks;
  std::vector<Measurement> measurements;
  std::vector<Contour> contours;
};

// mm, degrees or mm²; 0 while there are too few points.
double measured(ui::Measure kind, std::span<const Eigen::Vector3d> points);

// "sweep2/landmark-1" and so on, each with its JSON; landmarks, contours and distances also as
// app/exchange/markups.h wants them.
std::vector<exam::ReviewObject> objects_of(const SweepReview& review, std::int64_t sweep);

// What of `objects` belongs to the sweep. One that holds something else than objects_of writes is left out
// and named in `refused`; other kinds are passed over.
SweepReview review_of(std::span<const exam::ReviewObject> objects, std::int64_t sweep,
                      std::vector<std::string>& refused);

// What an exam has been told of one sweep's review.
class ReviewLog {
 public:
  // As read from it.
  void know(std::span<const exam::ReviewObject> stored);
  // The objects to write so that the exam holds `now`: new ones, other versions, removals. Then it knows.
  std::vector<exam::ReviewObject> changes(const std::vector<exam::ReviewObject>& now);

 private:
  struct Told {
    exam::ReviewKind kind;
    std::string json;
  };
  std::map<std::string, Told> told_;  // by object
};

}  // namespace sonoband
