/// This file implements fit_bound.hpp.
#include "host/plan/fit_bound.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "host/plan/candidate_evaluation.hpp"
#include "host/plan/primitive_projection.hpp"
#include "host/prepare/eigen_points.hpp"
#include "host/threads/parallel.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/search/fit_box_bound.hpp"
#include "verify/solids/model.hpp"
#include "verisq/device.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"
#include "verisq/fit.hpp"
#include "verisq/map.hpp"

namespace verisq::fit_search {

namespace {

/// Share of a primitive's smallest semi-axis: the tolerance of depths in the implant.
constexpr double kDepthTolerance = 1e-2;
constexpr std::size_t kSlabsBetweenPolls = 8;

/// Beyond, numbers of the bound would overflow or underflow.
double within_bounds(double size) {
  using verify::PoseBoxMotion;
  if (size >= PoseBoxMotion::smallest_size && size <= PoseBoxMotion::largest_size) return size;
  throw Error(ErrorKind::input,
              fmt::format("bound: points, implant and range reach as far as {:.4g}, must reach from {:.2g} to {:.2g}: "
                          "give all lengths in another unit",
                          size, PoseBoxMotion::smallest_size, PoseBoxMotion::largest_size));
}

}  // namespace

BoundedImplant::BoundedImplant(const UncertainModel& implant, std::span<const verify::WeightedPoint> points,
                               const FitBoundOptions& options)
    : candidates_(implant, options.range),
      model_(candidates_.sized(candidates_.start())),
      space_(candidates_.pose_space()),
      size_(within_bounds(size_of(points))),
      field_(model_, size_ / 4.0, size_),
      bound_(space_, field_, points, options.fitness, options.penetration_limit, size_) {
  std::vector<PrimitiveProjection> projections;
  for (const Primitive& primitive : model_.primitives) projections.emplace_back(primitive);
  for (std::size_t first = 0; first < field_.slabs(); first += kSlabsBetweenPolls) {
    if (options.interrupted() || options.out_of_time()) return;
    in_parallel(std::min(kSlabsBetweenPolls, field_.slabs() - first), [&](std::size_t slab) {
      field_.find_slab(first + slab, [&](std::size_t k, const Eigen::Vector3d& q) { return projections[k](q).normal; });
    });
  }
  field_.find_balls([&](std::span<const Point> queries) { return depths(queries, options); });
  ready_ = true;
}

verify::PoseBox BoundedImplant::box(const RangeCell& cell) const {
  verify::PoseBox result;
  for (std::size_t i = 0; i < 6; ++i) {
    const double reach = candidates_.upper()[i];
    const double half = std::ldexp(reach, -cell.poses.level[i]);
    const auto k = static_cast<Eigen::Index>(i);
    result.centre[k] = (2.0 * cell.poses.index[i] + 1.0) * half - reach;
    result.half[k] = half + 0x1p-50 * reach;  // the centre is rounded
  }
  return result;
}

double BoundedImplant::model_radius() const {
  double radius = space_.centre.norm();
  for (const Primitive& primitive : model_.primitives) {
    const auto& [a, b, c] = primitive.superquadric.semi_axes;
    radius = std::max(radius, vector_of(primitive.pose.translation).norm() + 2.0 * (a + b) + c);
  }
  return radius;
}

/// Four times the sum of the largest coordinates of points, poses and implant. No sum of them on the way from the
/// cavity to the implant exceeds it. No point is farther from the implant than a quarter of it.
double BoundedImplant::size_of(std::span<const verify::WeightedPoint> points) const {
  double farthest = 0.0;
  for (const verify::WeightedPoint& point : points) farthest = std::max(farthest, point.place.norm());
  return 4.0 * (farthest + space_.start_centre.norm() + 2.0 * candidates_.upper()[0] + 2.0 * model_radius());
}

/// Depths in one primitive at a time: the union's overlaps are deeper, but cost a search.
std::vector<double> BoundedImplant::depths(std::span<const Point> queries, const FitBoundOptions& options) {
  std::vector<double> upper(queries.size(), infinity);
  std::vector<MapResult> rows(queries.size());
  for (const Primitive& primitive : model_.primitives) {
    const double smallest = std::ranges::min(primitive.superquadric.semi_axes);
    const Model alone{model_.units, {primitive}, {}};
    const MapSummary map = PointMapper(alone, {.tolerance = kDepthTolerance * smallest,
                                               .device = options.device,
                                               .interrupted = options.interrupted,
                                               .out_of_time = options.out_of_time})
                               .map(queries, rows);
    for (std::size_t i = 0; i < map.points; ++i) upper[i] = std::min(upper[i], rows[i].distance.hi);
    device_ = map.device;
  }
  return upper;
}

}  // namespace verisq::fit_search

namespace verisq {

namespace {

using fit_search::BoundedImplant;
using fit_search::RangeCell;
using verify::FitBoxResult;
using verify::WeightedPoint;

/// Boxes that are divided between two polls.
constexpr std::size_t kBatch = 512;
/// Share of the known objective: a pose that seems better by less is not better.
constexpr double kNotBetter = 1e-4;

/// An implant's index takes a byte of each box.
constexpr std::size_t kMostImplants = 256;

void require_of_bound(bool holds, const std::string& message) {
  if (!holds) throw Error(ErrorKind::input, message);
}

void check_bound(std::span<const UncertainModel> series, const Cavity& cavity, const FitBoundOptions& options) {
  require_of_bound(!series.empty() && series.size() <= kMostImplants,
                   fmt::format("bound: of 1 to {} implants, not {}", kMostImplants, series.size()));
  for (const UncertainModel& implant : series) verify::require_valid(implant);
  fit_search::check_fit_problem(cavity, options.fitness, options.penetration_limit, options.range);
  require_of_bound(options.gap > 0.0 && options.gap < 1.0,
                   fmt::format("gap to be proven: must lie between 0 and 1, not {}", options.gap));
  require_of_bound(std::isfinite(options.known), fmt::format("known objective: must be finite, not {}", options.known));
  for (std::size_t i = 0; i < series.size(); ++i) {
    require_of_bound(is_exact(series[i]),
                     fmt::format("implants[{}]: has sizes to choose from, and the bound is of poses alone", i));
    verify::require_union_of_convex(bracket(series[i]).largest, fmt::format("bound: implants[{}]", i));
  }
}

/// The approximate objective F of one pose, in floating point.
class PoseTrial {
 public:
  PoseTrial(std::span<const WeightedPoint> points, const FitBoundOptions& options)
      : points_(points), options_(options) {
    std::vector<Point> places;
    std::vector<double> weights;
    for (const WeightedPoint& point : points) {
      places.push_back(point_of(point.place));
      weights.push_back(point.weight);
    }
    evaluator_ = fit_search::host_candidate_evaluator(places, weights);
  }

  /// Minus infinity beyond the limit.
  [[nodiscard]] double objective(const fit_search::Candidate& candidate) const {
    std::vector<fit_search::PointDistance> distances;
    evaluator_->distances(candidate, distances);
    double sum = 0.0;
    for (std::size_t i = 0; i < distances.size(); ++i) {
      if (distances[i].distance < -options_.penetration_limit) return -infinity;
      sum += points_[i].weight * value(options_.fitness, distances[i].distance);
    }
    return sum;
  }

 private:
  std::span<const WeightedPoint> points_;
  const FitBoundOptions& options_;
  std::unique_ptr<fit_search::CandidateEvaluator> evaluator_;
};

/// Rounded up: sum of nonnegative terms.
double sum_of_weights(std::span<const WeightedPoint> points) {
  double sum = 0.0;
  for (const WeightedPoint& point : points) sum = verify::add(sum, point.weight, verify::Direction::up);
  return sum;
}

/// The halvings of one implant's range: the two halves follow each other.
class HalvingTree {
 public:
  /// The whole range is node 0. Returns the node of the lower half; the node of the upper half is the next.
  std::uint32_t halve(std::uint32_t node, std::uint8_t direction) {
    const auto first = static_cast<std::uint32_t>(nodes_.size());
    nodes_[node] = {first, static_cast<PoseDivision>(direction)};
    nodes_.resize(nodes_.size() + 2);
    return first;
  }

  [[nodiscard]] std::vector<PoseDivision> in_preorder() const {
    std::vector<PoseDivision> divisions;
    divisions.reserve(nodes_.size());
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
      const auto [first, division] = nodes_[open.back()];
      open.pop_back();
      divisions.push_back(division);
      if (division == PoseDivision::none) continue;
      open.push_back(first + 1);
      open.push_back(first);
    }
    return divisions;
  }

 private:
  struct Node {
    std::uint32_t first_half = 0;
    PoseDivision division = PoseDivision::none;
  };
  std::vector<Node> nodes_ = std::vector<Node>(1);
};

class BranchAndBound {
 public:
  /// `weight` is not less than the sum of the points' weights.
  BranchAndBound(std::span<const UncertainModel> series, std::span<const WeightedPoint> points, double weight,
                 const FitBoundOptions& options)
      : series_(series),
        points_(points),
        options_(options),
        trial_(points, options),
        weight_(weight),
        best_(options.known),
        enough_(enough(options)),
        trees_(series.size()) {}

  FitBound run() {
    FitBound result{};
    for (std::size_t i = 0; i < series_.size() && !result.interrupted && !result.out_of_time; ++i) {
      const bool begun = begin(i);
      options_.progress({upper(), boxes_, open_.size()});
      result.interrupted = options_.interrupted();
      result.out_of_time = options_.out_of_time() || (!begun && !result.interrupted);
    }
    while (!open_.empty() && !result.interrupted && !result.out_of_time) {
      divide_best();
      options_.progress({upper(), boxes_, open_.size()});
      result.interrupted = options_.interrupted();
      result.out_of_time = options_.out_of_time();
    }
    result.upper = upper();
    result.reached = result.upper <= enough_;
    result.boxes = boxes_;
    result.promising = promising_;
    if (!implants_.empty()) result.device = implants_.front()->device();
    for (const HalvingTree& tree : trees_) result.divisions.push_back(tree.in_preorder());
    return result;
  }

 private:
  /// Boxes whose bound is no larger need no division: known >= (1 - gap) bound, rounded down. For a known objective
  /// that is not positive no share applies.
  static double enough(const FitBoundOptions& options) {
    return options.known > 0.0 ? options.known / (1.0 - options.gap) * (1.0 - 0x1p-50) : options.known;
  }

  /// Begins with the whole range of one implant; false if the work was ended before.
  bool begin(std::size_t i) {
    auto implant = std::make_unique<BoundedImplant>(series_[i], points_, options_);
    if (!implant->is_ready()) return false;
    implants_.push_back(std::move(implant));
    RangeCell whole{.poses = {}, .implant = static_cast<std::uint8_t>(i)};
    take(whole, bounded(whole));
    return true;
  }

  static bool worse(const RangeCell& a, const RangeCell& b) { return a.bound < b.bound; }

  /// An implant that was not begun is bounded only by the weights.
  [[nodiscard]] double upper() const {
    if (implants_.size() < series_.size()) return weight_;
    return open_.empty() ? closed_ : std::max(closed_, open_.front().bound);
  }

  [[nodiscard]] FitBoxResult bounded(const RangeCell& cell) const {
    const BoundedImplant& implant = *implants_[cell.implant];
    return implant(implant.box(cell));
  }

  void divide_best() {
    std::vector<RangeCell> children;
    while (!open_.empty() && children.size() < 2 * kBatch) {
      std::ranges::pop_heap(open_, worse);
      const RangeCell& cell = open_.back();
      const std::uint32_t first = trees_[cell.implant].halve(cell.node, cell.widest);
      for (const RangeCell& half : cell.halves(first)) children.push_back(half);
      open_.pop_back();
    }
    std::vector<FitBoxResult> results(children.size());
    // A box of a large mesh takes some milliseconds, all of them take seconds: each polls.
    const SeenInterruption ended(either(options_.interrupted, options_.out_of_time));
    const std::size_t done =
        in_parallel_until(ended, children.size(), [&](std::size_t i) { results[i] = bounded(children[i]); });
    for (std::size_t i = 0; i < done; ++i) take(children[i], results[i]);
    for (std::size_t i = done; i < children.size(); ++i) put_back(children[i]);
    try_best(std::span(children).first(done), std::span(results).first(done));
  }

  /// Puts back a half that was not processed: the bound of its whole is valid for it.
  void put_back(const RangeCell& half) {
    open_.push_back(half);
    std::ranges::push_heap(open_, worse);
  }

  void take(RangeCell& cell, const FitBoxResult& result) {
    ++boxes_;
    // The bound of the whole is valid for its parts, and the sum of the weights for all. A NaN bounds nothing.
    cell.bound = std::min({cell.bound, weight_, std::isnan(result.upper) ? infinity : result.upper});
    if (cell.bound == -infinity) return;
    Eigen::Index widest = 0;
    result.spread.maxCoeff(&widest);
    cell.widest = static_cast<std::uint8_t>(widest);
    const bool is_pose = !(result.spread[widest] > 0.0);  // nothing is left to divide
    if (cell.bound <= enough_ || is_pose || !cell.poses.can_be_halved(cell.widest)) {
      closed_ = std::max(closed_, cell.bound);
      return;
    }
    open_.push_back(cell);
    std::ranges::push_heap(open_, worse);
  }

  /// Tests whether the centre of the box that looks best is better than the known pose.
  void try_best(std::span<const RangeCell> cells, std::span<const FitBoxResult> results) {
    std::size_t best = cells.size();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (results[i].deepest > options_.penetration_limit || results[i].upper == -infinity) continue;
      if (best == cells.size() || results[i].estimate > results[best].estimate) best = i;
    }
    const double wanted = best_ + kNotBetter * std::abs(best_);
    if (best == cells.size() || results[best].estimate <= wanted) return;
    const BoundedImplant& implant = *implants_[cells[best].implant];
    const verify::PoseParameters centre = implant.box(cells[best]).centre;
    const std::span<const double> parameters(centre.data(), 6);
    const double objective = trial_.objective(implant.space().candidate(parameters));
    if (objective <= wanted) return;
    best_ = objective;
    promising_ = PromisingPose{cells[best].implant, implant.space().pose(parameters), objective};
  }

  std::span<const UncertainModel> series_;
  std::span<const WeightedPoint> points_;
  const FitBoundOptions& options_;
  PoseTrial trial_;
  double weight_;  ///< sum of all points' weights: no objective is larger
  double best_;    ///< objective of a pose known or found
  double enough_;
  double closed_ = -infinity;  ///< the largest bound of a box that is not divided any more
  std::uint64_t boxes_ = 0;
  std::vector<std::unique_ptr<BoundedImplant>> implants_;
  std::vector<RangeCell> open_;     ///< a heap
  std::vector<HalvingTree> trees_;  ///< one an implant
  std::optional<PromisingPose> promising_;
};

}  // namespace

FitBound bound_fit(std::span<const UncertainModel> series, const Cavity& cavity, const FitBoundOptions& options) {
  check_bound(series, cavity, options);
  std::vector<WeightedPoint> points;
  for (std::size_t i = 0; i < cavity.points.size(); ++i)
    points.push_back({vector_of(cavity.points[i]), cavity.areas[cavity.area_of[i]].weight});
  const double weight = sum_of_weights(points);
  require_of_bound(std::isfinite(weight), "weights: their sum over all points overflows");
  return BranchAndBound(series, points, weight, options).run();
}

namespace {

/// The number of levels that a box is halved beyond the search's: intervals are hardly wider, contained balls a little
/// smaller.
constexpr std::size_t further_levels = 12;
/// Factor beyond the bound, and beyond the proven bound, so that checkers with other roundings prove it, too.
constexpr double slightly_more = 1.0 + 1e-9;

}  // namespace

std::optional<CertifiedBestFit> certified_best_fit(std::span<const UncertainModel> series, const Cavity& cavity,
                                                   const BestFitTerms& terms, const FitBound& bound,
                                                   const CheckOptions& check) {
  CertifiedBestFit result{.claim = {.terms = {terms.fitness, terms.penetration_limit, cavity.areas, cavity.area_of},
                                    .range = terms.range,
                                    .centres = {},
                                    .upper = bound.upper},
                          .certificate = {}};
  std::vector<Model> models;
  for (const UncertainModel& implant : series) {
    models.push_back(bracket(implant).largest);
    result.claim.centres.push_back(point_of(fit_search::CandidateSpace(implant, terms.range).pose_space().centre));
  }
  const BestFitChecker checker(models, cavity.points, result.claim);
  const double enough = bound.upper * slightly_more;  // or minus infinity: F above the limit is positive
  RefinedBestFit refined = checker.refined({bound.divisions}, enough, further_levels, check);
  if (check.interrupted()) return std::nullopt;
  result.certificate = std::move(refined.certificate);
  result.claim.upper = refined.upper * slightly_more;  // what is proven, whatever the search found
  return result;
}

}  // namespace verisq
