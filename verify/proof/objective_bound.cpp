/// This file implements objective_bound.hpp.
#include "verify/proof/objective_bound.hpp"

#include <algorithm>
#include <cmath>

#include "verify/numbers/vector.hpp"
#include "verify/proposals/multipliers.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

Vector3<double> exact(const Point& p) {
  return {Interval(p[0]), Interval(p[1]), Interval(p[2])};
}

/// About the centre of mass, in floating point: the proof is valid for any point.
Point middle_of(std::span<const PointOfWeight> points) {
  if (points.size() == 1) return points.front().place;
  double weight = 0.0;
  Point sum{};
  for (const PointOfWeight& point : points) {
    weight += point.weight;
    for (std::size_t i = 0; i < 3; ++i) sum[i] += point.weight * point.place[i];
  }
  if (!(weight > 0.0)) return points.front().place;
  return {sum[0] / weight, sum[1] / weight, sum[2] / weight};
}

WeightedBall ball_of(std::span<const PointOfWeight> points) {
  const Point centre = middle_of(points);
  Interval weight(0);
  Vector3<double> moment;
  double radius = 0.0;
  for (const PointOfWeight& point : points) {
    const Vector3<double> way = exact(point.place) - exact(centre);
    radius = std::max(radius, length<double>(way).upper());
    weight += Interval(point.weight);
    moment = moment + way * Interval(point.weight);
  }
  return {centre, radius, weight.upper(), length<double>(moment).upper(), 0};
}

}  // namespace

std::vector<WeightedBall> weighted_balls(std::span<const PointOfWeight> points) {
  return ball_tree<WeightedBall>(points, ball_of);
}

namespace {

/// The number of points whose limit serves as a constraint: the tightest ones.
constexpr std::ptrdiff_t most_constraints = 32;
/// A ball of points is taken whole if its radius is at most this share of the box's movement, or of the ball's
/// distance. The loss is of the order of the share's square.
constexpr double ball_by_reach = 0.5;
constexpr double ball_by_distance = 0.2;
/// If the fitness of a point varies by less than this, it is taken as constant, at a small loss: such points are far
/// away.
constexpr double hardly_changes = 1e-4;
/// If ranges of fitness already tell directions apart, this share of the points' movement, times the steepest slope of
/// fitness, is added: next to nothing.
constexpr double share_of_movement = 1e-6;

/// 0 <= constant + slope·δ for the poses that keep the limit.
struct KeptLimit {
  Interval constant;
  PoseSlope slope;
  double tightness;  ///< about: constant by the range of slope·δ; the smaller, the more of the box is excluded
};

double middle(const Interval& a) {
  return 0.5 * a.lower() + 0.5 * a.upper();
}

PoseParameters middles(const PoseSlope& slope) {
  PoseParameters result;
  for (std::size_t k = 0; k < pose_parameters; ++k) result[static_cast<Eigen::Index>(k)] = middle(slope[k]);
  return result;
}

IntervalVector vector(const Point& p) {
  return {Interval(p[0]), Interval(p[1]), Interval(p[2])};
}

Point difference(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

PoseSlope difference(const PoseSlope& a, const PoseSlope& b) {
  PoseSlope result;
  for (std::size_t k = 0; k < pose_parameters; ++k) result[k] = a[k] - b[k];
  return result;
}

}  // namespace

/// The sums over the points, for one box.
class ObjectiveBound::Sum {
 public:
  Sum(const ObjectiveBound& bound, const PoseCell& cell)
      : field_(bound.field_),
        objective_(bound.objective_),
        box_(bound.range_, cell),
        steepest_(steepest_fitness(bound.objective_.fitness)) {
    for (std::size_t i = 0; i < 3; ++i) {
      pivot_[i] = middle(box_.pivot()[i]);
      for (std::size_t j = 0; j < 3; ++j) columns_[j][i] = middle(box_.rotation()(i, j));
    }
    for (std::size_t k = 0; k < pose_parameters; ++k) half_[static_cast<Eigen::Index>(k)] = box_.half()[k];
  }

  /// False where no pose of the box keeps the limit.
  bool keeps_limit() {
    visit_balls(balls(), [this](const WeightedBall& ball) { return look_for_depth(ball); });
    if (too_deep_) return false;
    if (kept_.size() < 2) return true;
    if (std::ssize(kept_) > most_constraints) {
      std::ranges::nth_element(kept_, kept_.begin() + most_constraints, {}, &KeptLimit::tightness);
      kept_.resize(most_constraints);
    }
    // The objective does not matter to whether any pose keeps the constraints.
    const Multipliers found = proposed(shares_of_nearest_.cwiseQuotient(half_));
    return !found.ray || !excludes(found.values);
  }

  void add_all() {
    visit_balls(balls(), [this](const WeightedBall& ball) { return add(ball); });
  }

  [[nodiscard]] BoxBound result() const {
    const double weight = objective_.balls.front().weight;
    const Multipliers found = proposed(middles(slope_));
    if (found.ray && excludes(found.values)) return {-infinity, {}};
    const double by_lines = (constant_ + Interval(box_.range_up(slope_))).upper();
    const double by_limit = found.ray ? infinity : (constant_ + Interval(dual_up(slope_, found.values))).upper();
    BoxBound result{std::min({by_ranges_.upper(), by_lines, by_limit, weight}), {}};
    // If every point may have the best fitness, ranges of fitness cannot decide which direction matters.
    const double share = (by_ranges_.upper() < weight ? share_of_movement : 1.0) * middle(steepest_);
    for (std::size_t k = 0; k < pose_parameters; ++k) {
      const double arms = k < 3 ? weight : arms_;
      result.spread[k] = spread_[k] + share * arms * box_.half()[k];
    }
    return result;
  }

 private:
  [[nodiscard]] std::span<const WeightedBall> balls() const { return objective_.balls; }

  /// About where the implant sees the point, from its centre.
  [[nodiscard]] Point from_centre(const Point& v) const {
    const Point arm = difference(v, pivot_);
    return {dot(columns_[0], arm), dot(columns_[1], arm), dot(columns_[2], arm)};
  }

  /// About how far the nearest primitive is, and which that is.
  static std::pair<double, std::size_t> nearest(std::span<const ContainingHalfSpace> half_spaces, const Point& at) {
    std::pair<double, std::size_t> least{infinity, 0};
    for (std::size_t k = 0; k < half_spaces.size(); ++k) {
      const double distance = dot(half_spaces[k].normal, at) + half_spaces[k].at_centre;
      if (distance < least.first) least = {distance, k};
    }
    return least;
  }

  /// Points that are in the implant at the centre, or could get there.
  bool look_for_depth(const WeightedBall& ball) {
    if (too_deep_) return false;
    const Point at = from_centre(ball.centre);
    SolidField::Cube& cube = field_.near(at);
    const double reach = about_reach(ball.centre);
    if (nearest(SolidField::half_spaces(cube), at).first > ball.radius + 0.5 * reach) return false;
    if (ball.second != 0) return true;
    if (const auto& inside = field_.ball(cube)) too_deep_ = !constrain(ball.centre, *inside);
    return false;
  }

  [[nodiscard]] double about_reach(const Point& v) const {
    const Point arm = difference(v, pivot_);
    return half_.head<3>().norm() + half_.tail<3>().norm() * std::sqrt(dot(arm, arm));
  }

  // No point of a pose that keeps the limit P is nearer to the centre o of a contained ball than its radius less P: its
  // signed distance would be below -P. From √(1 + z) <= 1 + z/2, |x - o| <= |e| + e/|e|·(x - x(0)) + reach²/(2 |e|), e
  // = x(0) - o. False: in every pose of the box the point lies too deep.
  bool constrain(const Point& v, const ContainedBall& ball) {
    const BoxOfPoses::Arm arm = box_.arm(v);
    const Interval reach(arm.reach);
    const IntervalVector from_ball = arm.from_pivot + box_.rotation() * (vector(field_.centre()) - vector(ball.centre));
    const Interval distance = length<double>(from_ball);
    const Interval left = distance - Interval(ball.radius) + Interval(objective_.penetration_limit);
    if ((left + reach).upper() < 0.0) return false;
    if (left.lower() > arm.reach || !(distance.lower() > 0.0)) return true;
    KeptLimit kept;
    kept.slope = box_.slope(arm, from_ball / distance);
    kept.constant = left + Interval(arm.remainder) + square(reach) / (Interval(2) * distance);
    const double range = box_.range_up(kept.slope);
    if ((kept.constant + Interval(range)).upper() < 0.0) return false;
    kept.tightness = kept.constant.upper() / range;
    if (kept.tightness < 1.0) kept_.push_back(kept);
    if ((left + reach).upper() < nearest_to_exclude_) {
      nearest_to_exclude_ = (left + reach).upper();
      shares_of_nearest_ = middles(kept.slope).cwiseAbs().cwiseProduct(half_);
    }
    return true;
  }

  /// A lower bound of a point's distance from a half-space where it is positive; its slope follows.
  [[nodiscard]] static Interval distance(const BoxOfPoses::Arm& arm, const ContainingHalfSpace& half_space) {
    return vector(half_space.normal).dot(arm.from_centre) + Interval(half_space.at_centre);
  }

  [[nodiscard]] PoseSlope slope(const BoxOfPoses::Arm& arm, const ContainingHalfSpace& half_space) const {
    return box_.slope(arm, box_.rotation() * vector(half_space.normal));
  }

  /// Returns true if the ball of points is too coarse; else adds it.
  bool add(const WeightedBall& ball) {
    const Point at = from_centre(ball.centre);
    const std::span<const ContainingHalfSpace> half_spaces = SolidField::half_spaces(field_.near(at));
    const auto [least, first] = nearest(half_spaces, at);
    const double about = about_reach(ball.centre);
    if (ball.second != 0 && ball.radius > ball_by_reach * about && ball.radius > ball_by_distance * (least - about))
      return true;
    // If a primitive has no half-space, nothing is known about the distance.
    if (least > -infinity) {
      add_line(ball, half_spaces, first, falling_fitness_up(objective_.fitness, least));
    } else {
      add_constant(Interval(ball.weight));
    }
    return false;
  }

  void add_constant(const Interval& value) {
    by_ranges_ += value;
    constant_ += value;
  }

  // Let n be the normal of the first half-space. The distance of the ball's points from it is at least L(δ) = middle +
  // slope·δ, but for their offsets from the ball's centre: n·R^T (v - centre). Each offset is no more than the radius,
  // and their weighted sum no more than the moment. A line above the fitness is positive over the range, so that the
  // weights may be rounded up. `at_centre` is about the fitness at the centre of the box.
  void add_line(const WeightedBall& ball, std::span<const ContainingHalfSpace> half_spaces, std::size_t first,
                double at_centre) {
    const BoxOfPoses::Arm arm = box_.arm(ball.centre);
    const Interval radius(ball.radius);
    const auto in_any_pose = [&](const Interval& distance) {
      return (distance - Interval(arm.reach) - radius).lower();
    };
    distances_.clear();
    double lowest = infinity;
    for (const ContainingHalfSpace& half_space : half_spaces) {
      distances_.push_back(distance(arm, half_space));
      lowest = std::min(lowest, in_any_pose(distances_.back()));
    }
    const double by_reach = falling_fitness_up(objective_.fitness, lowest);
    if (by_reach - at_centre < hardly_changes) return add_constant(Interval(ball.weight) * Interval(by_reach));
    const Interval& distance = distances_[first];
    const PoseSlope slope = this->slope(arm, half_spaces[first]);
    const double middle = (distance - Interval(arm.remainder)).lower();
    const double range = box_.range_up(slope);
    const double half = (Interval(range) + radius).upper();
    const double highest = (Interval(middle) + Interval(half)).upper();
    lowest = std::max((Interval(middle) - Interval(half)).lower(), in_any_pose(distance));
    double nearer = 0.0;  // other primitives may be by no more
    for (std::size_t k = 0; k < half_spaces.size(); ++k) {
      if (k == first) continue;
      const double least = in_any_pose(distances_[k]);
      lowest = std::min(lowest, least);
      if (least >= highest) continue;  // nowhere nearer than L
      const Interval apart = length<double>(vector(half_spaces[first].normal) - vector(half_spaces[k].normal)) * radius;
      const PoseSlope change = difference(slope, this->slope(arm, half_spaces[k]));
      const Interval by_slopes =
          Interval(middle) - (distances_[k] - Interval(arm.remainder)) + apart + Interval(box_.range_up(change));
      nearer = std::max(nearer, std::min(by_slopes.upper(), (Interval(highest) - Interval(least)).upper()));
    }
    const double by_range = falling_fitness_up(objective_.fitness, lowest);
    LineAbove line = line_above(objective_.fitness, middle, half);
    // The fitness of a point that is nearer by e is larger by no more than e times its steepest slope.
    line.value += steepest_ * Interval(nearer);
    if (line.value.upper() >= by_range) line = {Interval(by_range), Interval(0)};
    const Interval weight(ball.weight);
    by_ranges_ += weight * Interval(by_range);
    constant_ += weight * line.value + abs(line.slope) * Interval(ball.moment);
    for (std::size_t k = 0; k < pose_parameters; ++k) {
      const double share = range > 0.0 ? std::fabs(verify::middle(slope[k])) * box_.half()[k] / range : 0.0;
      slope_[k] += weight * line.slope * slope[k];
      spread_[k] += ball.weight * (by_range - at_centre) * share;
    }
    arms_ += ball.weight * (about_length(ball.centre) + ball.radius);
  }

  [[nodiscard]] double about_length(const Point& v) const {
    const Point arm = difference(v, pivot_);
    return std::sqrt(dot(arm, arm));
  }

  [[nodiscard]] Multipliers proposed(const PoseParameters& objective) const {
    std::vector<LinearConstraint> constraints;
    for (const KeptLimit& kept : kept_) {
      constraints.push_back({.constant = middle(kept.constant), .slope = middles(kept.slope)});
    }
    return multipliers(objective, half_, constraints);
  }

  // For all λ >= 0 and all δ of the box that keep the limit, objective·δ <= objective·δ + Σ λ (constant + slope·δ).
  [[nodiscard]] double dual_up(PoseSlope objective, std::span<const double> multipliers) const {
    Interval constants(0);
    for (std::size_t j = 0; j < kept_.size(); ++j) {
      if (!(multipliers[j] > 0.0)) continue;
      const Interval multiplier(multipliers[j]);
      constants += multiplier * kept_[j].constant;
      for (std::size_t k = 0; k < pose_parameters; ++k) objective[k] += multiplier * kept_[j].slope[k];
    }
    return (constants + Interval(box_.range_up(objective))).upper();
  }

  /// True proves that no pose of the box keeps the limit: a sum that any such pose makes nonnegative is negative.
  [[nodiscard]] bool excludes(std::span<const double> multipliers) const { return dual_up({}, multipliers) < 0.0; }

  const SolidField& field_;
  const BoundedObjective& objective_;
  BoxOfPoses box_;
  Interval steepest_;
  Interval by_ranges_{0};
  Interval constant_{0};
  PoseSlope slope_{};
  std::vector<KeptLimit> kept_;
  std::vector<Interval> distances_;  ///< distances of the current points from every half-space
  bool too_deep_ = false;
  // The following members only propose.
  Point pivot_{};
  std::array<Point, 3> columns_{};  ///< columns of the rotation
  PoseParameters half_;
  std::array<double, pose_parameters> spread_{};
  double arms_ = 0.0;  ///< weighted lengths of the arms from the centre of the implant's rotation
  double nearest_to_exclude_ = infinity;
  PoseParameters shares_of_nearest_ = PoseParameters::Ones();
};

ObjectiveBound::ObjectiveBound(const Model& implant, const Point& centre, const PoseRange& range,
                               const BoundedObjective& objective)
    : range_(range, centre), field_(implant, centre), objective_(objective) {}

BoxBound ObjectiveBound::operator()(const PoseCell& cell) const {
  Sum sum(*this, cell);
  if (!sum.keeps_limit()) return {-infinity, {}};
  sum.add_all();
  return sum.result();
}

}  // namespace verisq::verify
