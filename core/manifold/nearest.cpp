#include "core/manifold/nearest.h"

#include <cmath>

namespace sonoband::flow {

namespace {

// Distances equal to this share tie; see FlowLayer::feet.
constexpr double tie_share = 1e-9;
constexpr double on_piece = 1e-9;

bool touch(const Side& side, const Piece& before, const Piece& after, double h) {
  const PlanePoint gap =
      point_at(side, after.element, after.from, h) - point_at(side, before.element, before.to, h);
  return gap.squaredNorm() <= join_distance * join_distance;
}

// A place on the front. On a closed curve pieces count on beyond the last: piece + size is the same again.
struct Place {
  int piece = 0;
  double at = 0;
};

class Search {
 public:
  Search(const Side& side, const Front& front, double h, const std::vector<Standing>& rulings, Walls walls)
      : side_(side), front_(front), h_(h), rulings_(rulings), walls_(walls), feet_(rulings.size()) {}

  std::vector<std::optional<PlanePoint>> run() {
    if (front_.empty()) return std::move(feet_);
    survivors_.reserve(rulings_.size());
    // The last ruling of a closed curve stands where its first does.
    const int first = side_.closed && rulings_.size() > 1 ? 1 : 0;
    const int count = static_cast<int>(rulings_.size());
    find_survivors(first);
    if (survivors_.empty()) {
      solve(first, count, {0, front_.front().from}, {size() - 1, front_.back().to}, walls_ != nullptr);
    } else {
      solve_runs(first, count);
    }
    if (first == 1) feet_.front() = feet_.back();
    return std::move(feet_);
  }

 private:
  struct Survivor {
    int ruling;
    Place place;
  };

  int size() const { return static_cast<int>(front_.size()); }
  const Piece& piece(int i) const { return front_[i % size()]; }
  int ruling_index(int i) const {
    const int count = static_cast<int>(rulings_.size());
    return i < count ? i : i - count + 1;  // beyond the end of a closed curve: skips its repeated first
  }

  // Rulings whose own point is on the front.
  void find_survivors(int first) {
    int i = 0;
    for (int r = first; r < static_cast<int>(rulings_.size()); ++r) {
      const Standing& s = rulings_[r];
      while (i < size() && front_[i].element < s.element) ++i;
      const bool on_corner = s.element % 2 == 1;
      if (!on_corner)
        while (i < size() && front_[i].element == s.element && front_[i].to + on_piece < s.along) ++i;
      if (i == size()) break;
      if (front_[i].element != s.element) continue;
      // All of a corner's arc is equally near to a ruling on it.
      Place place{i, on_corner ? std::clamp(0.0, front_[i].from, front_[i].to) : s.along};
      if (on_corner) {
        for (int j = i + 1; j < size() && front_[j].element == s.element; ++j) {
          const double at = std::clamp(0.0, front_[j].from, front_[j].to);
          if (std::abs(at) < std::abs(place.at)) place = {j, at};
        }
      } else if (s.along < front_[i].from - on_piece) {
        continue;
      }
      survivors_.push_back({r, place});
      feet_[r] = point_at(side_, s.element, place.at, h_);
    }
  }

  void solve_runs(int first, int count) {
    const Place begin{0, front_.front().from};
    const Place end{size() - 1, front_.back().to};
    for (std::size_t i = 1; i < survivors_.size(); ++i)
      solve_between(survivors_[i - 1], survivors_[i], survivors_[i].ruling);
    const Survivor& lowest = survivors_.front();
    const Survivor& highest = survivors_.back();
    if (side_.closed) {
      Survivor next = lowest;
      next.place.piece += size();
      solve_between(highest, next, lowest.ruling + count - 1);
    } else {
      solve(first, lowest.ruling, begin, lowest.place, walls_ != nullptr);
      solve(highest.ruling + 1, count, highest.place, end, walls_ != nullptr);
    }
  }

  void solve_between(const Survivor& before, const Survivor& after, int after_ruling) {
    if (before.ruling + 1 >= after_ruling) return;
    bool broken = false;
    if (walls_ != nullptr)
      for (int i = before.place.piece; i < after.place.piece && !broken; ++i)
        broken = !touch(side_, piece(i), piece(i + 1), h_);
    solve(before.ruling + 1, after_ruling, before.place, after.place, broken);
  }

  // Rulings [first, last) between two places: the middle one first, then each half on its own part of the
  // front. Nearest points keep the order of the rulings, so nothing is lost, and the cost is O((rulings +
  // pieces) log rulings).
  void solve(int first, int last, Place low, Place high, bool look_for_walls) {
    if (first >= last) return;
    const int middle = first + (last - first) / 2;
    const int r = ruling_index(middle);
    const Place place = nearest(rulings_[r].at, low, high);
    const PlanePoint q = point_at(side_, piece(place.piece).element, place.at, h_);
    if (look_for_walls && !in_sight(rulings_[r], q)) {
      solve(first, middle, low, high, true);
      solve(middle + 1, last, low, high, true);
      return;
    }
    feet_[r] = q;
    solve(first, middle, low, place, look_for_walls);
    solve(middle + 1, last, place, high, look_for_walls);
  }

  Place nearest(const PlanePoint& p, Place low, Place high) const {
    Place best = low;
    double best_square = (point_at(side_, piece(low.piece).element, low.at, h_) - p).squaredNorm();
    for (int i = low.piece; i <= high.piece; ++i) {
      const Piece& here = piece(i);
      const double from = i == low.piece ? low.at : here.from;
      const double to = std::max(from, i == high.piece ? high.at : here.to);
      const double at = nearest_at(side_, here.element, p, from, to);
      const double square = (point_at(side_, here.element, at, h_) - p).squaredNorm();
      if (square < best_square * (1 - 2 * tie_share)) {
        best_square = square;
        best = {i, at};
      }
    }
    return best;
  }

  // Whether the way from the ruling to q leaves on this side and meets no part of the curve.
  bool in_sight(const Standing& ruling, const PlanePoint& q) const {
    const PlanePoint way = q - ruling.at;
    const int edge = ruling.element / 2;
    double rise = way.dot(side_.edges[edge].out);
    if (ruling.element % 2 == 1) {
      const int after = edge + 1 < static_cast<int>(side_.edges.size()) ? edge + 1 : 0;
      rise = std::max(rise, way.dot(side_.edges[after].out));
    }
    if (rise < 0) return false;
    // No part of the curve is within h of q: only the first part of the way can meet it.
    const double length = std::max(0.0, way.norm() - h_);
    const PlanePoint along = way.normalized();
    const PlanePoint beside = quarter_turn(along);
    bool clear = true;
    walls_->visit(
        [&](const ChordTree::Run& run) {
          if (!clear) return true;
          const PlanePoint to_a = run.a - ruling.at, to_b = run.b - ruling.at;
          const double stray = run.stray;
          const double a_beside = beside.dot(to_a), b_beside = beside.dot(to_b);
          if (std::min(a_beside, b_beside) > stray || std::max(a_beside, b_beside) < -stray) return true;
          const double a_along = along.dot(to_a), b_along = along.dot(to_b);
          return std::min(a_along, b_along) > length + stray || std::max(a_along, b_along) < -stray;
        },
        [&](int j) {
          const PlanePoint& a = side_.vertices[j];
          const PlanePoint span = side_.vertices[j + 1] - a;
          const double across = cross(way, span);
          if (across == 0) return;
          const double on_way = cross(a - ruling.at, span) / across;
          const double on_wall = cross(a - ruling.at, way) / across;
          // The ruling itself stands on the curve; q keeps its distance.
          if (on_way > 1e-9 && on_way < 1 && on_wall >= 0 && on_wall <= 1) clear = false;
        });
    return clear;
  }

  const Side& side_;
  const Front& front_;
  double h_;
  const std::vector<Standing>& rulings_;
  Walls walls_;
  std::vector<std::optional<PlanePoint>> feet_;
  std::vector<Survivor> survivors_;
};

// Chords of this many radians stray less than 0.002 steps from their arc.
double arc_step(double h) {
  return 2 * std::acos(std::max(0.0, 1 - 0.002 / h));
}

}  // namespace

std::vector<std::optional<PlanePoint>> find_feet(const Side& side, const Front& front, double h,
                                                 const std::vector<Standing>& rulings, Walls walls) {
  return Search(side, front, h, rulings, walls).run();
}

std::vector<PlaneLine> draw_front(const Side& side, const Front& front, double h, bool unbroken) {
  std::vector<PlaneLine> lines;
  for (std::size_t i = 0; i < front.size(); ++i) {
    const Piece& piece = front[i];
    const bool joined = i > 0 && (unbroken || touch(side, front[i - 1], piece, h));
    if (!joined) lines.emplace_back();
    PlaneLine& line = lines.back();
    const PlanePoint start = point_at(side, piece.element, piece.from, h);
    // Ends of pieces that touch are one point, lest rounding at a shallow shock cross them over.
    if (!joined || (start - line.back()).norm() > join_distance) line.push_back(start);
    const int chords =
        piece.element % 2 == 0 ? 1 : 1 + static_cast<int>((piece.to - piece.from) / arc_step(h));
    for (int c = 1; c <= chords; ++c) {
      const double share = static_cast<double>(c) / chords;
      line.push_back(point_at(side, piece.element, piece.from + share * (piece.to - piece.from), h));
    }
  }
  // A closed curve's first and last line may be one: the front goes on over the seam.
  if (side.closed && !front.empty() && (unbroken || touch(side, front.back(), front.front(), h))) {
    if (lines.size() == 1) {
      lines.front().push_back(lines.front().front());
    } else {
      PlaneLine& last = lines.back();
      last.insert(last.end(), lines.front().begin() + 1, lines.front().end());
      lines.front() = std::move(last);
      lines.pop_back();
    }
  }
  return lines;
}

}  // namespace sonoband::flow
