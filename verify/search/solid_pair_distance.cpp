/// This file implements solid_pair_distance.hpp.
#include "verify/search/solid_pair_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <utility>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>

#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/search/solid_distance.hpp"
#include "verify/search/solid_pair_cells.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

namespace {

double largest_length(const Model& model) {
  double largest = 0.0;
  for (const Primitive& primitive : model.primitives) {
    largest = std::max(
        {largest, std::ranges::max(primitive.superquadric.semi_axes), largest_coordinate(primitive.pose.translation)});
  }
  return largest;
}

/// A curvature is one divided by a length.
bool is_exact_in_units(const Primitive& primitive, double unit) {
  const auto& axes = primitive.superquadric.semi_axes;
  const bool axes_are = std::ranges::all_of(axes, [&](double a) { return in_units(a, unit).has_value(); });
  const bool bend_is = !primitive.bend || in_units(primitive.bend->curvature, 1.0 / unit).has_value();
  return axes_are && bend_is && in_units(primitive.pose.translation, unit).has_value();
}

}  // namespace

std::optional<double> in_units(double length, double unit) {
  const double scaled = length / unit;
  if (!std::isfinite(scaled) || scaled * unit != length) return std::nullopt;
  return scaled;
}

std::optional<Point> in_units(const Point& x, double unit) {
  Point scaled{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<double> coordinate = in_units(x[i], unit);
    if (!coordinate) return std::nullopt;
    scaled[i] = *coordinate;
  }
  return scaled;
}

std::optional<Pose> in_units(const Pose& pose, double unit) {
  const std::optional<Point> translation = in_units(pose.translation, unit);
  return translation ? std::optional(Pose{*translation, pose.quaternion}) : std::nullopt;
}

double tolerance_in_units(double tolerance, double unit) {
  return std::min(tolerance / unit, std::numeric_limits<double>::max());
}

Enclosure in_lengths(const Enclosure& e, double unit) {
  return {multiply(e.lo, unit, Direction::down), multiply(e.hi, unit, Direction::up)};
}

double unit_of(const Model& a, const Model& b, double largest) {
  constexpr int ordinary = 300;  // cubes of these lengths are numbers
  constexpr int extreme = 1000;
  if (has_mesh(a) || has_mesh(b)) return 1.0;  // meshes take ordinary lengths alone
  largest = std::max({largest, largest_length(a), largest_length(b)});
  if (!(largest > 0.0) || !std::isfinite(largest)) return 1.0;
  const int exponent = std::ilogb(largest);
  if (std::abs(exponent) <= ordinary) return 1.0;
  const double unit = std::ldexp(1.0, std::clamp(exponent, -extreme, extreme));
  const auto exact = [unit](const Primitive& primitive) { return is_exact_in_units(primitive, unit); };
  return std::ranges::all_of(a.primitives, exact) && std::ranges::all_of(b.primitives, exact) ? unit : 1.0;
}

Model in_units(const Model& model, double unit) {
  Model scaled = model;
  for (Primitive& primitive : scaled.primitives) {
    for (double& a : primitive.superquadric.semi_axes) a /= unit;
    for (double& t : primitive.pose.translation) t /= unit;
    if (primitive.bend) primitive.bend->curvature *= unit;
  }
  return scaled;
}

namespace {

constexpr std::size_t kMostPairs = std::size_t{1} << 22U;      // 32 bytes each
constexpr std::uint64_t kMostCubes = std::uint64_t{1} << 20U;  // some 200 bytes each
constexpr std::uint64_t kReportInterval = 64;                  // refined pairs between two looks at the options
constexpr std::uint64_t kStepsForCommonPoint = 4096;           // refined pairs, once the distance is known to be small
constexpr std::uint64_t kFirstSeparations = 256;               // pairs of sections, before the first refined pair
constexpr std::uint64_t kFirstWhereHullsMeet = 16;             // the same: rather look for a common point
constexpr std::uint64_t kStepsBetweenPoints = 16;              // pairs of sections, between two proposals of points
/// After so many, only one in as many proposals of points is tried: each costs as much as a few refined pairs.
constexpr std::uint64_t kFailuresInARow = 16;
constexpr std::uint64_t kStepsASeparation = 2;  // refined pairs that cost about as much

/// No enclosure is required to be narrower than this share of the coordinates: rounding errors would keep every pair.
constexpr double kFinestRelativeTolerance = 0x1p-42;

struct CellPair {
  double lower;
  double polytopes;     ///< the bound of the two polytopes alone, or of the polytopes that contain them
  double eccentricity;  ///< if the bound is 0: the distance of the cubes' centres, in half-widths
  std::uint32_t a;
  std::uint32_t b;
};

/// The least lower bound first; among equal bounds, the least bound of the polytopes. If the models seem to meet, cubes
/// that coincide come before those that hardly touch: they lead to common points.
struct LaterThan {
  bool operator()(const CellPair& p, const CellPair& q) const {
    if (p.lower != q.lower) return p.lower > q.lower;
    return p.polytopes != q.polytopes ? p.polytopes > q.polytopes : p.eccentricity > q.eccentricity;
  }
};

class Search {
  struct Child {
    CellPair pair;
    Approach approach;
  };

 public:
  Search(const SearchSolid& a, const SearchSolid& b, const Pose& pose, const SearchOptions& options)
      : motion_(pose),
        points_(a, b, motion_),
        solid_a_(&a),
        solid_b_(&b),
        pose_(pose),
        a_(a),
        b_(b),
        options_(&options) {
    tolerance_ = std::max(options.tolerance, kFinestRelativeTolerance * magnitude());
  }

  /// A lower bound of the distance that is known otherwise.
  void know(double lower) { known_ = std::max(known_, lower); }
  [[nodiscard]] const BoundedMotion& motion() const { return motion_; }
  [[nodiscard]] double tolerance() const { return tolerance_; }

  [[nodiscard]] SearchedDistance run() {
    if (!consider_roots()) return result();
    while (!finished()) {
      if (known()) ++steps_when_known_;
      const double separated = separation(queue_.top());
      CellPair pair = queue_.top();
      queue_.pop();
      if (separated > pair.lower) {
        pair.lower = separated;
        keep(pair);
      } else {
        refine(pair);
      }
      if (++steps_ % kReportInterval == 0 && options_->progress) options_->progress(enclosure(), cubes());
    }
    if (queue_.empty() && left_out_ == infinity && upper_ == infinity) {
      throw Error(ErrorKind::input, "a model has no point at all: its set operations leave nothing");
    }
    return result();
  }

 private:
  /// False where that is interrupted, or more than there is room for: nothing is known then.
  bool consider_roots() {
    std::uint64_t considered = 0;
    for (std::uint32_t i = 0; i < a_.roots(); ++i) {
      for (std::uint32_t j = 0; j < b_.roots(); ++j) {
        const bool asked = ++considered % kReportInterval == 0 && options_->interrupted && options_->interrupted();
        if (asked || queue_.size() > kMostPairs) {
          left_out_ = 0.0;
          return false;
        }
        consider({known_, 0.0, 0.0, i, j});
      }
    }
    return true;
  }

  [[nodiscard]] double magnitude() const {
    double largest = 0.0;
    for (const double t : motion_.translation()) largest = std::max(largest, std::fabs(t));
    for (const Cells* cells : {&a_, &b_}) {
      for (std::uint32_t i = 0; i < cells->roots(); ++i) {
        const Cube& cube = (*cells)[i].polytope.cube();
        for (const double c : cube.centre) largest = std::max(largest, std::fabs(c) + cube.half_width);
      }
    }
    return largest;
  }

  /// Pairs at least this far are left out: their points are not nearer than the tolerance allows. A trifle less than
  /// upper - tolerance, so that rounding that difference costs nothing.
  [[nodiscard]] double enough() const { return upper_ - 0.999 * tolerance_; }

  [[nodiscard]] double lower() const {
    return std::min({left_out_, upper_, queue_.empty() ? infinity : queue_.top().lower});
  }

  [[nodiscard]] Enclosure enclosure() const { return common_ ? Enclosure{0.0, 0.0} : Enclosure{lower(), upper_}; }

  [[nodiscard]] std::uint64_t cubes() const { return a_.evaluated() + b_.evaluated(); }

  /// Returns whether all remaining pairs are as far as the best points, but for the tolerance. Precondition: a pair
  /// remains.
  [[nodiscard]] bool known() const { return queue_.top().lower >= enough(); }

  [[nodiscard]] bool finished() const {
    if (common_ || queue_.empty() || queue_.size() > kMostPairs || cubes() > kMostCubes) return true;
    // If the models seem to meet, a common point is more informative than a small distance.
    if (known() && (queue_.top().lower > 0.0 || steps_when_known_ >= kStepsForCommonPoint)) return true;
    return steps_ > 0 && steps_ % kReportInterval == 0 && options_->interrupted && options_->interrupted();
  }

  /// Bounds a pair, which inherits the bounds of the pair that contains it, and keeps it if it may have closest points.
  void consider(CellPair pair) {
    const Cell& x = a_[pair.a];
    const Cell& y = b_[pair.b];
    Approach found = approach_of(pair);
    pair.polytopes = std::max(pair.polytopes, found.lower);
    found.lower = std::max(found.lower, pair.lower);
    pair.lower = found.lower;
    // If models do not meet, closest points lie on both boundaries: from a point in the interior of one model, the way
    // to the other gets shorter within the model.
    if ((x.inside || y.inside) && found.lower > 0.0) return;
    pair.eccentricity = found.lower > 0.0 ? 0.0 : eccentricity(x.polytope.cube(), y.polytope.cube());
    if (!keep(pair)) return;
    if (!nearest_child_ || LaterThan{}(nearest_child_->pair, pair)) nearest_child_ = {pair, found};
  }

  /// A whole convex primitive counts as such, unless both are: then they are separated already, if they can be.
  [[nodiscard]] Approach approach_of(const CellPair& pair) const {
    const CutCube& x = a_[pair.a].polytope;
    const CutCube& y = b_[pair.b].polytope;
    const bool whole_a = is_whole(a_, pair.a, *solid_a_);
    const bool whole_b = is_whole(b_, pair.b, *solid_b_);
    if (whole_a == whole_b) return approach(x, y, motion_, direction_, enough());
    const SearchSolid& solid = whole_a ? *solid_a_ : *solid_b_;
    const SetNode& leaf = whole_a ? *a_[pair.a].set : *b_[pair.b].set;
    const WholePrimitive whole(solid.separable[leaf.primitive], whole_a ? x.cube() : y.cube(), tolerance_ / 16);
    return whole_a ? approach(whole, y, motion_, direction_, enough())
                   : approach(x, whole, motion_, direction_, enough());
  }

  /// Returns whether the cell contains all of a part that is one convex primitive.
  [[nodiscard]] static bool is_whole(const Cells& cells, std::uint32_t index, const SearchSolid& solid) {
    const SetNode& set = *cells[index].set;
    return index < cells.roots() && set.kind == SetNode::Kind::leaf && set.side == Side::inside &&
           !solid.separable[set.primitive].bent;
  }

  /// Returns whether the pair may have points nearer than the tolerance allows to leave out.
  bool keep(const CellPair& pair) {
    if (pair.lower > 0.0 && pair.lower >= enough()) {
      left_out_ = std::min(left_out_, pair.lower);
      return false;
    }
    queue_.push(pair);
    return true;
  }

  /// A lower bound by separating the primitives that contain the pair's sets. The primitives' near points are tried in
  /// the sets.
  double separation(const CellPair& pair) {
    double greatest = 0.0;
    for_each_containing(*a_[pair.a].set, [&](std::uint32_t i) {
      for_each_containing(*b_[pair.b].set, [&](std::uint32_t j) {
        if (greatest < enough()) greatest = std::max(greatest, separation_of(i, j, pair));
      });
    });
    return greatest;
  }

  double separation_of(std::uint32_t i, std::uint32_t j, const CellPair& pair) {
    const std::pair key(i, j);
    if (separation_steps_ >= separation_budget(0.0) && !separations_.contains(key)) return 0.0;
    PrimitivePairDistance& primitives =
        separations_.try_emplace(key, solid_a_->separable[i], solid_b_->separable[j], pose_, tolerance_ / 4)
            .first->second;
    const auto interrupted = [&] {
      ++separation_steps_;
      return options_->interrupted && options_->interrupted();
    };
    while (primitives.lower() < enough() && separation_steps_ < separation_budget(primitives.lower())) {
      const bool begun = primitives.near_points().has_value();
      if (!primitives.raise(enough(), begun ? kStepsBetweenPoints : 1, interrupted)) break;
      const auto near = primitives.near_points();
      if (near && primitives.lower() > 0.0) try_points(a_[pair.a], b_[pair.b], near->on_a, near->on_b);
      if (options_->progress) options_->progress(enclosure(), cubes());
    }
    return primitives.lower();
  }

  [[nodiscard]] std::uint64_t separation_budget(double lower) const {
    return (lower > 0.0 ? kFirstSeparations : kFirstWhereHullsMeet) + steps_ / kStepsASeparation;
  }

  void refine(const CellPair& pair) {
    nearest_child_.reset();
    bool a_first = a_[pair.a].slack >= b_[pair.b].slack;
    // For a whole primitive the bound is tight already; if models may meet, cubes of both lead to common points.
    if (pair.lower > 0.0 && is_whole(a_, pair.a, *solid_a_) != is_whole(b_, pair.b, *solid_b_)) {
      a_first = is_whole(b_, pair.b, *solid_b_);
    }
    const bool refined = a_first ? refine_a(pair) || refine_b(pair) : refine_b(pair) || refine_a(pair);
    if (!refined) left_out_ = std::min(left_out_, pair.lower);
    if (nearest_child_) propose(*nearest_child_);
  }

  bool refine_a(const CellPair& pair) {
    const std::optional<CellRange> children = a_.children(pair.a);
    if (!children) return false;
    for (std::uint32_t i = children->first; i < children->end; ++i) {
      consider({pair.lower, pair.polytopes, 0.0, i, pair.b});
    }
    return true;
  }

  bool refine_b(const CellPair& pair) {
    const std::optional<CellRange> children = b_.children(pair.b);
    if (!children) return false;
    for (std::uint32_t j = children->first; j < children->end; ++j) {
      consider({pair.lower, pair.polytopes, 0.0, pair.a, j});
    }
    return true;
  }

  /// Points of the child, where its relaxation promises better ones than are known.
  void propose(const Child& child) {
    const Cell& x = a_[child.pair.a];
    const Cell& y = b_[child.pair.b];
    const Approach& found = child.approach;
    if (found.lower <= 0.0 && find_common(x, y)) return;
    const bool promising = upper_ == infinity || found.between < upper_ - 0.1 * (upper_ - lower());
    if (promising && (failures_ < kFailuresInARow || steps_ % kFailuresInARow == 0)) {
      try_points(x, y, found.on_a, found.on_b);
    }
  }

  /// Tries the points, and the nearer ones that they lead to.
  void try_points(const Cell& x, const Cell& y, const Point& near_a, const Point& near_b) {
    const double scale = std::max(x.polytope.cube().half_width, y.polytope.cube().half_width);
    auto points = points_.settled(x, y, near_a, near_b, scale);
    if (!points && upper_ == infinity) points = points_.settled_towards_centres(x, y, near_a, near_b);
    ++failures_;
    if (!points || points->distance >= upper_) return;
    failures_ = 0;
    points = points_.improved(x, y, *points, scale, 0.1 * tolerance_);
    upper_ = points->distance;
    near_points_ = {points->on_a, points->on_b};
    if (upper_ == 0.0) common_ = points->on_a;
    const Point b = motion_.to_a(points->on_b);
    direction_ = unit({b[0] - points->on_a[0], b[1] - points->on_a[1], b[2] - points->on_a[2]});
  }

  [[nodiscard]] double eccentricity(const Cube& x, const Cube& y) const {
    const Point centre = motion_.to_a(y.centre);
    return std::hypot(centre[0] - x.centre[0], centre[1] - x.centre[1], centre[2] - x.centre[2]) /
           (x.half_width + y.half_width);
  }

  /// Tries the centres of cubes that lie in one model, and points of both polytopes, away from their faces if possible.
  bool find_common(const Cell& x, const Cell& y) {
    if (x.inside && try_common(x, y, x.polytope.cube().centre)) return true;
    if (y.inside && try_common(x, y, motion_.to_a(y.polytope.cube().centre))) return true;
    const double size = std::min(x.polytope.cube().half_width, y.polytope.cube().half_width);
    return std::ranges::any_of(std::array{0.25 * size, 0x1p-6 * size, 0.0}, [&](double margin) {
      const CutCube within_x = x.polytope.shrunk(margin);
      const CutCube within_y = y.polytope.shrunk(margin);
      return try_common(x, y, approach(within_x, within_y, motion_, {}, infinity).on_a);
    });
  }

  bool try_common(const Cell& x, const Cell& y, const Point& at) {
    if (points_.common(x, y, at)) common_ = at;
    return common_.has_value();
  }

  [[nodiscard]] SearchedDistance result() const {
    const Enclosure found = enclosure();
    const Proximity proximity = common_          ? Proximity::overlapping
                                : found.lo > 0.0 ? Proximity::separated
                                                 : Proximity::undecided;
    return {found, proximity, near_points_, common_, cubes(), verified(found, tolerance_)};
  }

  BoundedMotion motion_;
  PointSearch points_;
  const SearchSolid* solid_a_;
  const SearchSolid* solid_b_;
  Pose pose_;
  Cells a_;
  Cells b_;
  const SearchOptions* options_;
  double tolerance_ = 0.0;
  double known_ = 0.0;
  std::priority_queue<CellPair, std::vector<CellPair>, LaterThan> queue_;
  double upper_ = infinity;
  double left_out_ = infinity;  ///< the least lower bound of all pairs that are in the queue no more, not refined
  Point direction_{};           ///< from A to B, between the best points
  std::optional<std::array<Point, 2>> near_points_;
  std::optional<Point> common_;
  std::optional<Child> nearest_child_;  ///< of the pair that is refined at present
  std::map<std::pair<std::uint32_t, std::uint32_t>, PrimitivePairDistance> separations_;  ///< by pairs of primitives of
                                                                                          ///< A and B
  std::uint64_t separation_steps_ = 0;
  std::uint64_t steps_ = 0;
  std::uint64_t failures_ = 0;  ///< failures in a row to find better points than the known ones
  std::uint64_t steps_when_known_ = 0;
};

}  // namespace

std::optional<PairSearch::Enclosed> PairSearch::enclosed(const Model& model, const Model& other) {
  auto balls = EnclosingBalls::of(model);
  if (!balls) return std::nullopt;
  std::vector<Ball> hollows_of_other = hollows(other);
  if (hollows_of_other.empty() && !balls->all_are_balls()) return std::nullopt;
  return Enclosed{std::move(*balls), std::move(hollows_of_other), SolidDistance(other)};
}

PairSearch::PairSearch(const Model& a, const Model& b)
    : a_(a), b_(b), enclosed_a_(enclosed(a, b)), enclosed_b_(enclosed(b, a)) {}

SearchedDistance PairSearch::operator()(const Pose& pose, const SearchOptions& options) const {
  Search search(a_.solid, b_.solid, pose, options);
  const auto interrupted = [&] { return options.interrupted && options.interrupted(); };
  const BoundedMotion& motion = search.motion();
  const double share = search.tolerance() / 4;
  if (enclosed_a_) {
    const auto& [balls, hollows, distance] = *enclosed_a_;
    search.know(balls.lower_from_b(distance, hollows, motion, share, interrupted));
  }
  if (enclosed_b_) {
    const auto& [balls, hollows, distance] = *enclosed_b_;
    search.know(balls.lower_from_a(distance, hollows, motion, share, interrupted));
  }
  return search.run();
}

}  // namespace verisq::verify
