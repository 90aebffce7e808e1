/// This file implements fit_box_bound.hpp.
#include "verify/search/fit_box_bound.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/objective_bound.hpp"
#include "verify/proposals/multipliers.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

using Eigen::Vector3d;

/// Room for the roundings of a distance, and for normals in binary32, which are a little longer than 1.
constexpr double kRoundedUp = 1.0 + 0x1p-20;

PointCluster cluster_of(std::span<const WeightedPoint> points) {
  double weight = 0.0;
  Vector3d sum = Vector3d::Zero();
  for (const WeightedPoint& point : points) {
    weight += point.weight;
    sum += point.weight * point.place;
  }
  const Vector3d centre = points.size() > 1 && weight > 0.0 ? Vector3d(sum / weight) : points.front().place;
  double radius = 0.0;
  for (const WeightedPoint& point : points) radius = std::max(radius, (point.place - centre).norm() * kRoundedUp);
  return {centre, radius, weight, 0};
}

}  // namespace

std::vector<PointCluster> point_clusters(std::span<const WeightedPoint> points) {
  return ball_tree<PointCluster>(points, cluster_of);
}

namespace {

/// Room for the roundings of one point's terms.
constexpr double kTermRounding = 0x1p-46;
/// The number of points whose limit serves as a constraint: the tightest ones.
constexpr std::ptrdiff_t kMostConstraints = 32;
/// A cluster is taken whole if its radius is at most this share of the box's movement, or of the cluster's distance.
/// The loss is of the order of the share's square.
constexpr double kClusterByReach = 0.5;
constexpr double kClusterByDistance = 0.2;

/// If ranges of fitness already tell directions apart, this share of the points' movement, times the steepest slope of
/// fitness, is added: next to nothing.
constexpr double kShareOfMovement = 1e-6;

/// More than the underflow in thousands of operations.
constexpr double kUnderflow = 0x1p-1000;

/// Σ λ c + Σ half |objective + Σ λ a|, rounded up: no δ of the box that keeps the constraints has a larger objective.
double dual_value(const PoseParameters& objective, const PoseParameters& half,
                  std::span<const LinearConstraint> constraints, std::span<const double> multipliers) {
  double constant = 0.0;
  double magnitude = objective.cwiseAbs().dot(half);
  PoseParameters slope = objective;
  for (std::size_t j = 0; j < constraints.size(); ++j) {
    if (multipliers[j] == 0.0) continue;
    constant += multipliers[j] * constraints[j].constant;
    slope += multipliers[j] * constraints[j].slope;
    magnitude += multipliers[j] * (std::abs(constraints[j].constant) + constraints[j].slope.cwiseAbs().dot(half));
  }
  return constant + slope.cwiseAbs().dot(half) + magnitude * 0x1p-40 + kUnderflow;
}

}  // namespace

/// The sums over the points, for one box.
class FitBoxBound::Sum {
 public:
  Sum(const FitBoxBound& bound, const PoseBoxMotion& motion)
      : bound_(bound), motion_(motion), steepest_(steepest_fitness_in_binary64(bound.fitness_)) {}

  /// False where no pose of the box keeps the limit.
  bool keeps_limit() {
    visit_balls(clusters(), [this](const PointCluster& cluster) { return look_for_depth(cluster); });
    if (too_deep_) return false;
    if (constraints_.size() < 2) return true;
    if (std::ssize(constraints_) > kMostConstraints) {
      std::ranges::nth_element(constraints_, constraints_.begin() + kMostConstraints, {}, &LinearConstraint::tightness);
      constraints_.resize(kMostConstraints);
    }
    // The objective does not matter to whether any pose keeps the constraints.
    return !excluded(shares_of_nearest_.cwiseQuotient(motion_.half()));
  }

  void add_all() {
    visit_balls(clusters(), [this](const PointCluster& cluster) { return add(cluster); });
  }

  FitBoxResult result() {
    const PoseParameters& half = motion_.half();
    const double by_lines = constant_ + slope_.cwiseAbs().dot(half);
    const Multipliers found = multipliers(slope_, half, constraints_);
    if (found.ray && excludes(found)) return FitBoxResult::nothing();
    const double by_constraints =
        found.ray ? infinity : constant_ + dual_value(slope_, half, constraints_, found.values);
    const double least = std::min({by_ranges_, by_lines, by_constraints});
    // Sums of no more terms than points, each of a few roundings of numbers that add up to the magnitude.
    const auto points = static_cast<double>(bound_.points_);
    const double lost = (points * 0x1p-51 + kTermRounding) * magnitude_ + kUnderflow;
    // If every point may have the best fitness, ranges of fitness cannot decide which direction matters.
    const bool says_nothing = !(least + lost < bound_.weight_);
    const double share = says_nothing ? 1.0 : kShareOfMovement;
    return {.upper = std::min(least + lost, bound_.weight_),
            .estimate = estimate_,
            .deepest = deepest_,
            .spread = spread_ + share * steepest_ * movement()};
  }

 private:
  /// About the largest weighted movement of the points by each direction.
  [[nodiscard]] PoseParameters movement() const {
    PoseParameters movement = motion_.half();
    movement.head<3>() *= bound_.weight_;
    movement.tail<3>() *= arms_;
    return movement;
  }

  [[nodiscard]] std::span<const PointCluster> clusters() const { return bound_.clusters_; }

  /// Points that are in the implant at the centre, or could get there.
  bool look_for_depth(const PointCluster& cluster) {
    if (too_deep_) return false;
    const PoseBoxMotion::Place place = motion_.place(cluster.centre);
    const DistanceField::Found found = bound_.field_.near(place.point);
    const double least =
        std::min({found.node.nearest[0].distance(place.point), found.node.nearest[1].distance(place.point),
                  found.node.others - (place.point - found.place).norm()});
    if (least > cluster.radius + 0.5 * place.reach) return false;
    if (cluster.second != 0) return true;
    if (found.node.ball >= 0) too_deep_ = !constrain(place, bound_.field_.ball(found.node));
    return false;
  }

  /// Returns true if the cluster is too coarse; else adds it.
  bool add(const PointCluster& cluster) {
    const PoseBoxMotion::Place place = motion_.place(cluster.centre);
    const DistanceField::Found found = bound_.field_.near(place.point);
    const RoundedHalfSpace& first = found.node.nearest[0];
    const RoundedHalfSpace& second = found.node.nearest[1];
    const double distance = first.distance(place.point) - bound_.rounding_;
    const double of_second = second.distance(place.point) - bound_.rounding_;
    const double of_others = found.node.others - (place.point - found.place).norm() - bound_.rounding_;
    const double least = std::min({distance, of_second, of_others});
    if (cluster.second != 0 && cluster.radius > kClusterByReach * place.reach &&
        cluster.radius > kClusterByDistance * (least - place.reach))
      return true;
    deepest_ = std::max(deepest_, -least);
    const double at_centre = falling_fitness(bound_.fitness_, least);
    estimate_ += cluster.weight * at_centre;

    const PoseParameters by_pose = motion_.slope(place, first.direction());
    const PoseParameters shares = by_pose.cwiseAbs().cwiseProduct(motion_.half());
    const double half = shares.sum();
    const double middle = distance - place.remainder;
    const double others = std::min(of_second, of_others) - place.reach;
    const double lowest = std::min(std::max(middle - half, distance - place.reach), others) - cluster.radius;
    const double by_range = falling_fitness(bound_.fitness_, lowest);
    by_ranges_ += cluster.weight * by_range;

    FitnessLine line = fitness_line_above(bound_.fitness_, middle, half + cluster.radius);
    if (middle + half > others - 2.0 * cluster.radius) {
      // Another primitive may be nearer: the fitness rises by no more than its steepest slope times the difference in
      // distance.
      const PoseParameters by_second = motion_.slope(place, second.direction()) - by_pose;
      const double nearer_second = distance - of_second + by_second.cwiseAbs().dot(motion_.half()) +
                                   (first.direction() - second.direction()).norm() * cluster.radius;
      const double nearer_other = middle + half - (of_others - place.reach) + 2.0 * cluster.radius;
      line.value += steepest_ * std::max({nearer_second, nearer_other, 0.0});
      if (line.value >= by_range) line = {by_range, 0.0};
    }
    constant_ += cluster.weight * line.value;
    slope_ += cluster.weight * line.slope * by_pose;
    arms_ += cluster.weight * (place.arm.norm() + cluster.radius);
    magnitude_ += cluster.weight * (1.0 + std::abs(line.slope) * (half + cluster.radius));
    // The loss by the range of distances, shared by the directions that cause it.
    if (half > 0.0) spread_ += cluster.weight * (by_range - at_centre) / half * shares;
    return false;
  }

  /// A pose that keeps the limit has no point in a ball that is smaller by the limit. False: in every pose of the box
  /// this point lies in it.
  bool constrain(const PoseBoxMotion::Place& place, const InnerBall& ball) {
    const Eigen::Vector3d from_ball = place.point - ball.centre;
    const double length = from_ball.norm();
    const double depth_left = length - ball.radius + bound_.penetration_limit_ + bound_.rounding_;
    if (depth_left > place.reach) return true;
    if (depth_left < -place.reach) return false;
    if (!(length > 0.0)) return true;
    const PoseParameters outward = motion_.slope(place, from_ball / length);
    const PoseParameters shares = outward.cwiseAbs().cwiseProduct(motion_.half());
    const double range = shares.sum();
    const double constant = depth_left + place.remainder + place.reach * place.reach / (2.0 * length) * (1.0 + 0x1p-48);
    if (constant + range < 0.0) return false;
    if (constant < range) constraints_.push_back({constant, outward, constant / range});
    if (depth_left + place.reach < nearest_to_exclude_) {
      nearest_to_exclude_ = depth_left + place.reach;
      shares_of_nearest_ = shares;
    }
    return true;
  }

  /// Returns whether the constraints are proven to exclude every pose of the box.
  [[nodiscard]] bool excluded(const PoseParameters& objective) const {
    const Multipliers found = multipliers(objective, motion_.half(), constraints_);
    return found.ray && excludes(found);
  }

  [[nodiscard]] bool excludes(const Multipliers& ray) const {
    return dual_value(PoseParameters::Zero(), motion_.half(), constraints_, ray.values) < 0.0;
  }

  const FitBoxBound& bound_;
  const PoseBoxMotion& motion_;
  double steepest_;
  double by_ranges_ = 0.0;
  double constant_ = 0.0;
  PoseParameters slope_ = PoseParameters::Zero();
  double magnitude_ = 0.0;
  double estimate_ = 0.0;
  double arms_ = 0.0;  ///< weighted lengths from where the implant turns
  double deepest_ = 0.0;
  PoseParameters spread_ = PoseParameters::Zero();
  std::vector<LinearConstraint> constraints_;
  bool too_deep_ = false;
  double nearest_to_exclude_ = infinity;
  PoseParameters shares_of_nearest_ = PoseParameters::Ones();
};

FitBoxBound::FitBoxBound(const PoseSpace& space, const DistanceField& field, std::span<const WeightedPoint> points,
                         const Fitness& fitness, double penetration_limit, double size)
    : space_(space),
      field_(field),
      clusters_(point_clusters(points)),
      points_(points.size()),
      fitness_(fitness),
      penetration_limit_(penetration_limit),
      rounding_(PoseBoxMotion::rounding(size)),
      weight_(clusters_.front().weight * (1.0 + static_cast<double>(points.size()) * 0x1p-51)) {}

FitBoxResult FitBoxBound::operator()(const PoseBox& box) const {
  const PoseBoxMotion motion(space_, box, rounding_);
  Sum sum(*this, motion);
  if (!sum.keeps_limit()) return FitBoxResult::nothing();
  sum.add_all();
  return sum.result();
}

}  // namespace verisq::verify
