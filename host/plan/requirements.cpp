/// This file implements requirements.hpp.
#include "host/plan/requirements.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>

#include "host/plan/candidate_evaluation.hpp"
#include "host/plan/primitive_projection.hpp"
#include "host/prepare/eigen_points.hpp"
#include "host/prepare/mesh_geometry.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/search/distance_field.hpp"
#include "verify/solids/model.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/fit.hpp"
#include "verisq/mesh_topology.hpp"

namespace verisq {

namespace fit_search {
namespace {

constexpr int slices_of_tapered = 2000;

double beta(double a, double b) {
  return std::exp(std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b));
}

/// The area of the section at height h in parts of the semi-axis, as a part of the middle section's area.
double section(double h, double e1) {
  return std::pow(1.0 - std::pow(std::fabs(h), 2.0 / e1), e1);
}

/// The integral of the section over heights from -1 to 1. A taper takes (x, y, z) to (L x, L y, z') with L = (1 -
/// k^2)/(1 - k h) and dz'/dz = (1 - k^2)/(1 - k h)^2, so that a slice grows by the product of L^2 and dz'/dz.
double integrated_sections(const Superquadric& solid) {
  const double e1 = solid.exponents[0];
  if (!is_tapered(solid)) return e1 * beta(0.5 * e1, e1 + 1.0);
  const double k = (solid.taper - 1.0) / (solid.taper + 1.0);
  double sum = 0.0;
  for (int i = 0; i < slices_of_tapered; ++i) {
    const double h = (2.0 * i + 1.0) / slices_of_tapered - 1.0;
    sum += section(h, e1) * std::pow(1.0 - k * h, -4.0);
  }
  return std::pow(1.0 - k * k, 3.0) * sum * 2.0 / slices_of_tapered;
}

}  // namespace

double volume(const Superquadric& solid) {
  const auto& [a1, a2, a3] = solid.semi_axes;
  const double e2 = solid.exponents[1];
  const double middle = a1 * a2 * e2 * beta(0.5 * e2, 0.5 * e2);
  return middle * a3 * integrated_sections(solid);
}

}  // namespace fit_search

double implant_size(const Model& implant) {
  verify::require_valid_with_meshes(implant);
  double size = 0.0;
  for (const Primitive& primitive : implant.primitives)
    size += primitive.mesh ? std::fabs(signed_volume(*primitive.mesh)) : fit_search::volume(primitive.superquadric);
  return size;
}

}  // namespace verisq

namespace verisq::fit_search {
namespace {

constexpr double reach_in_scales = 0.1;
/// The cost of a missing share, in weights of all points: F gains at most one of them by giving up all contact.
constexpr double cost_in_weights = 20.0;
/// The share by which an end is kept within its range, and the share over which the hinge bends.
constexpr double margin = 0.002;
constexpr double smoothed_width = 0.002;

struct ValueAndSlope {
  double value;
  double slope;
};

/// 1 below -1, 0 above 1.
ValueAndSlope step(double t) {
  if (t <= -1.0) return {1.0, 0.0};
  if (t >= 1.0) return {0.0, 0.0};
  return {0.5 - 0.75 * t + 0.25 * t * t * t, 0.75 * (t * t - 1.0)};
}

/// 0 up to 0, then a parabola, then a line of slope 1.
ValueAndSlope hinge(double missing) {
  if (missing <= 0.0) return {0.0, 0.0};
  if (missing >= smoothed_width) return {missing - 0.5 * smoothed_width, 1.0};
  return {missing * missing / (2.0 * smoothed_width), missing / smoothed_width};
}

}  // namespace

ContactAim::ContactAim(std::span<const FitContact> contacts, double scale, double weight,
                       const MakeEvaluator& make_evaluator)
    : reach_(reach_in_scales * scale), cost_(cost_in_weights * weight) {
  for (const FitContact& contact : contacts) {
    const Cavity sampled{contact.points, {{"contact", 1.0}}, std::vector<std::uint32_t>(contact.points.size(), 0)};
    contacts_.push_back({&contact, std::accumulate(contact.weights.begin(), contact.weights.end(), 0.0),
                         std::shared_ptr(make_evaluator(sampled))});
  }
}

ContactAim ContactAim::widened(double factor) const {
  ContactAim wide = *this;
  wide.reach_ *= factor;
  return wide;
}

double ContactAim::share(const Contact& contact, std::span<const PointDistance> distances) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < distances.size(); ++i)
    sum += contact.asked->weights[i] * step((distances[i].distance - contact.asked->distance) / reach_).value;
  return sum / contact.weight;
}

double ContactAim::add_to(Evaluation& evaluation, const Candidate& candidate) const {
  double apart = 0.0;
  std::vector<PointDistance> distances;
  for (const Contact& contact : contacts_) {
    contact.evaluator->distances(candidate, distances);
    const double reached = share(contact, distances);
    const auto& [lo, hi] = contact.asked->share;
    apart += std::max({lo - reached, reached - hi, 0.0});
    const ValueAndSlope below = lo > 0.0 ? hinge(lo + margin - reached) : ValueAndSlope{0.0, 0.0};
    const ValueAndSlope above = hi < 1.0 ? hinge(reached - (hi - margin)) : ValueAndSlope{0.0, 0.0};
    evaluation.objective -= cost_ * (below.value + above.value);
    const double by_share = cost_ * (below.slope - above.slope);
    if (by_share != 0.0) add_derivatives(evaluation, contact, by_share, candidate, distances);
  }
  return apart;
}

void ContactAim::add_derivatives(Evaluation& evaluation, const Contact& contact, double by_share,
                                 const Candidate& candidate, std::span<const PointDistance> distances) const {
  const FitContact& asked = *contact.asked;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const PointDistance& at = distances[i];
    const double slope = step((at.distance - asked.distance) / reach_).slope / reach_;
    if (slope == 0.0) continue;
    const double by_distance = by_share * asked.weights[i] * slope / contact.weight;
    const auto by_pose = pose_gradient(asked.points[i], candidate.pivot, at.normal);
    for (std::size_t k = 0; k < by_pose.size(); ++k) evaluation.pose_gradient[k] += by_distance * by_pose[k];
    for (std::size_t axis = 0; axis < 3; ++axis)
      evaluation.size_gradient[at.primitive][axis] += by_distance * at.size_gradient[axis];
  }
}

namespace {

constexpr std::size_t pose_parameters = 6;
/// In parts of a change that moves the implant by one model unit: the values are smooth on that scale, and rounding is
/// far below it.
constexpr double step_share = 1e-4;

}  // namespace

PoseConstraints::PoseConstraints(const CandidateSpace& space, std::span<const FitConstraint> constraints,
                                 std::size_t implant)
    : space_(space), implant_(implant) {
  for (const FitConstraint& constraint : constraints) {
    if (std::isfinite(constraint.range.lo)) rows_.push_back({&constraint, false});
    if (std::isfinite(constraint.range.hi)) rows_.push_back({&constraint, true});
  }
}

std::vector<double> PoseConstraints::slack(std::span<const double> parameters) const {
  if (rows_.empty()) return {};
  const Pose pose = space_.pose(parameters);
  std::vector<double> slack;
  slack.reserve(rows_.size());
  const FitConstraint* known = nullptr;
  Enclosure value{};
  for (const auto& [constraint, upper] : rows_) {
    if (constraint != known) value = constraint->value(implant_, pose);
    known = constraint;
    slack.push_back((upper ? constraint->range.hi - value.hi : value.lo - constraint->range.lo) / constraint->unit);
  }
  return slack;
}

std::vector<double> PoseConstraints::jacobian(std::span<const double> parameters) const {
  std::vector<double> derivatives(rows_.size() * parameters.size());
  if (rows_.empty()) return derivatives;
  Parameters moved(parameters.begin(), parameters.end());
  for (std::size_t i = 0; i < pose_parameters; ++i) {
    const double step = step_share * space_.units()[i];
    moved[i] = parameters[i] + step;
    const std::vector<double> above = slack(moved);
    moved[i] = parameters[i] - step;
    const std::vector<double> below = slack(moved);
    moved[i] = parameters[i];
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      derivatives[k * parameters.size() + i] = (above[k] - below[k]) / (2.0 * step);
    }
  }
  return derivatives;
}

double PoseConstraints::violation(std::span<const double> parameters) const {
  double sum = 0.0;
  for (const double left : slack(parameters)) sum += std::max(-left, 0.0);
  return sum;
}

namespace {

constexpr double weights_of_all_points = 100.0;

}  // namespace

SizeAim::SizeAim(const CandidateSpace& space, double weight) : least_size_(implant_size(space.sized(space.lower()))) {
  const double range = implant_size(space.sized(space.upper())) - least_size_;
  if (!(range > 0.0)) return;  // nothing to choose
  most_ = weights_of_all_points * weight;
  per_size_ = most_ / range;
}

double SizeAim::value(std::span<const Primitive> primitives) const {
  if (most_ == 0.0) return 0.0;
  double size = 0.0;
  for (const Primitive& primitive : primitives) size += volume(primitive.superquadric);
  return per_size_ * (size - least_size_);
}

void SizeAim::add_to(Evaluation& evaluation, const Candidate& candidate) const {
  if (most_ == 0.0) return;
  evaluation.objective += value(candidate.primitives);
  for (std::size_t k = 0; k < candidate.primitives.size(); ++k) {
    const Superquadric& solid = candidate.primitives[k].superquadric;
    const double of_primitive = per_size_ * volume(solid);
    for (std::size_t axis = 0; axis < 3; ++axis)
      evaluation.size_gradient[k][axis] += of_primitive / solid.semi_axes[axis];
  }
}

namespace {

constexpr std::size_t columns_a_side = 64;

/// Twice the area of p, a, b seen along z, positive where they turn to the left.
double turn(const Point& p, const Point& a, const Point& b) {
  return (a[0] - p[0]) * (b[1] - p[1]) - (a[1] - p[1]) * (b[0] - p[0]);
}

/// If the ray upward from the point passes through the triangle: the direction in which it faces, else 0.
int passage(const Point& p, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const std::array<double, 3> weights{turn(p, b, c), turn(p, c, a), turn(p, a, b)};
  const bool left = weights[0] >= 0.0 && weights[1] >= 0.0 && weights[2] >= 0.0;
  const bool right = weights[0] < 0.0 && weights[1] < 0.0 && weights[2] < 0.0;
  const double area = weights[0] + weights[1] + weights[2];
  if ((!left && !right) || area == 0.0) return 0;
  const double height = (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) / area;
  if (height <= p[2]) return 0;
  return left ? 1 : -1;
}

}  // namespace

InsideTest::InsideTest(const Mesh& mesh)
    : triangles_(verify::closed_triangles(mesh, verify::closing_over_rims(mesh))),
      columns_(columns_a_side * columns_a_side) {
  const Extent extent = extent_of(mesh.vertices);  // which the means of rims do not leave
  lower_ = extent.lower;
  upper_ = extent.upper;
  for (std::uint32_t n = 0; n < triangles_.size(); ++n) add(n);
}

std::size_t InsideTest::column(double along, std::size_t axis) const {
  const double share = (along - lower_[axis]) / (upper_[axis] - lower_[axis]);
  if (!(share > 0.0)) return 0;
  return std::min(static_cast<std::size_t>(std::min(share, 1.0) * columns_a_side), columns_a_side - 1);
}

void InsideTest::add(std::uint32_t triangle) {
  const Triangle& corners = triangles_[triangle];
  const auto range = [&](std::size_t axis) {
    const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
    return std::pair(column(low, axis), column(high, axis));
  };
  const auto [first_x, last_x] = range(0);
  const auto [first_y, last_y] = range(1);
  for (std::size_t x = first_x; x <= last_x; ++x) {
    for (std::size_t y = first_y; y <= last_y; ++y) columns_[x * columns_a_side + y].push_back(triangle);
  }
}

bool InsideTest::operator()(const Point& point) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(point[axis] >= lower_[axis] && point[axis] <= upper_[axis])) return false;
  }
  int winding = 0;
  for (const std::uint32_t n : columns_[column(point[0], 0) * columns_a_side + column(point[1], 1)]) {
    winding += passage(point, triangles_[n]);
  }
  return winding != 0;
}

namespace {

constexpr double drawn_in = 0.97;

/// The samples in the primitive's own frame, before its bend.
std::array<Eigen::Vector3d, 7> unbent_samples_of(const Superquadric& solid) {
  // A taper moves the widest section along z and scales it (docs/mathematics.md §18, P of z = 0).
  const auto taper = verify::taper_coefficient<double>(solid.taper);
  const Eigen::Vector3d section(0.0, 0.0, -taper * solid.semi_axes[2]);
  std::array<Eigen::Vector3d, 7> samples{Eigen::Vector3d::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const Eigen::Vector3d from = axis == 2 ? Eigen::Vector3d::Zero() : section;
    const double scale = axis == 2 ? 1.0 : 1.0 - taper * taper;
    const Eigen::Vector3d way = drawn_in * scale * solid.semi_axes[k] * Eigen::Vector3d::Unit(axis);
    samples[2 * k + 1] = from + way;
    samples[2 * k + 2] = from - way;
  }
  return samples;
}

std::vector<Point> samples_of(const SolidMesh& mesh, const Pose& pose) {
  const Eigen::Matrix3d rotation = verify::unit_quaternion(pose.quaternion).toRotationMatrix();
  std::vector<Point> samples;
  for (const Point& own : mesh.samples)
    samples.push_back(point_of(rotation * vector_of(own) + vector_of(pose.translation)));
  return samples;
}

std::vector<Point> samples_of(const Primitive& primitive) {
  const Eigen::Quaterniond rotation = verify::unit_quaternion(primitive.pose.quaternion);
  const Eigen::Vector3d centre = vector_of(primitive.pose.translation);
  std::optional<BentProjection> bend;
  if (is_bent(primitive)) bend.emplace(primitive.superquadric, *primitive.bend);
  std::vector<Point> samples(7);
  std::ranges::transform(unbent_samples_of(primitive.superquadric), samples.begin(), [&](const Eigen::Vector3d& own) {
    return point_of(centre + rotation * (bend ? bend->image(own) : own));
  });
  return samples;
}

std::vector<Point> samples_of(const Candidate& candidate, std::size_t primitive) {
  const Primitive& placed = candidate.primitives[primitive];
  return placed.mesh ? samples_of(*candidate.meshes[primitive], placed.pose) : samples_of(placed);
}

}  // namespace

SideRequirements::SideRequirements(const InsideTest& inside, std::span<const SurfaceSide> required)
    : inside_(&inside), required_(required.begin(), required.end()) {}

std::size_t SideRequirements::misplaced(const Candidate& candidate) const {
  std::size_t count = 0;
  for (std::size_t k = 0; k < required_.size(); ++k) {
    if (required_[k] == SurfaceSide::any) continue;
    for (const Point& sample : samples_of(candidate, k)) {
      if ((*inside_)(sample) != (required_[k] == SurfaceSide::inside)) ++count;
    }
  }
  return count;
}

}  // namespace verisq::fit_search
