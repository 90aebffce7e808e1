/// This file implements `CandidateSpace` of candidate_evaluation.hpp.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <span>
#include <string>

#include "host/errors/refusal.hpp"
#include "host/plan/candidate_evaluation.hpp"
#include "host/prepare/eigen_points.hpp"
#include "verify/search/distance_field.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/model.hpp"
#include "verisq/error.hpp"

namespace verisq::fit_search {

namespace {

void require_input(bool holds, const std::string& message) {
  if (!holds) throw Error(ErrorKind::input, message);
}

bool are_finite(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); });
}

}  // namespace

void check_fit_problem(const Cavity& cavity, const Fitness& fitness, double penetration_limit, const PoseRange& range) {
  require_input(!cavity.points.empty(), "fit: the cavity has no points");
  for (std::size_t i = 0; i < cavity.points.size(); ++i)
    require_input(are_finite(cavity.points[i]), fmt::format("fit: point {} of the cavity is not finite", i));
  const auto& [target, scale, serves] = fitness;
  require_input(std::isfinite(target) && target >= 0.0 && std::isfinite(scale) && scale > 0.0,
                fmt::format("fitness: target must be at least 0 and scale positive, not {} and {}", target, scale));
  require_input(std::isfinite(penetration_limit) && penetration_limit >= 0.0,
                fmt::format("penetration limit: must be finite and at least 0, not {}", penetration_limit));
  const auto& [start, translation, rotation] = range;
  require_input(are_finite(start.translation) && are_finite(start.quaternion) &&
                    std::ranges::any_of(start.quaternion, [](double x) { return x != 0.0; }),
                "start: its numbers must be finite and its quaternion not zero");
  require_input(std::isfinite(translation) && translation >= 0.0,
                fmt::format("translation: must be finite and at least 0, not {}", translation));
  require_input(rotation >= 0.0 && rotation <= 180.0,
                fmt::format("rotation: must be between 0 and 180 degrees, not {}", rotation));
}

namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr std::size_t kPoseParameters = 6;
/// In parts of a range: at this distance from its end a search takes the end as reached.
constexpr double kAtLimit = 1e-6;

std::array<double, 4> numbers(const Quaterniond& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

Vector3d rotation_vector(std::span<const double> parameters) {
  return {parameters[3], parameters[4], parameters[5]};
}

Quaterniond exponential(const Vector3d& rotation) {
  const double angle = rotation.norm();
  return angle > 0.0 ? Quaterniond(Eigen::AngleAxisd(angle, rotation / angle)) : Quaterniond::Identity();
}

/// J with exp(ω + δ) = exp(J δ) exp(ω) to first order in δ.
Matrix3d left_jacobian(const Vector3d& rotation) {
  Matrix3d cross;
  cross << 0.0, -rotation[2], rotation[1], rotation[2], 0.0, -rotation[0], -rotation[1], rotation[0], 0.0;
  const double angle = rotation.norm();
  if (angle < 1e-4) return Matrix3d::Identity() + cross / 2.0 + cross * cross / 6.0;
  const double square = angle * angle;
  return Matrix3d::Identity() + (1.0 - std::cos(angle)) / square * cross +
         (angle - std::sin(angle)) / (square * angle) * cross * cross;
}

std::string place(const UncertainPrimitive& primitive, std::size_t index, std::string_view key) {
  const std::string name = primitive.name.empty() ? "" : fmt::format(" {}", quotation(primitive.name));
  return fmt::format("primitives[{}]{}.{}", index, name, key);
}

template <std::size_t N>
void require_exact(const std::array<Enclosure, N>& numbers, const std::string& place) {
  const auto interval = std::ranges::find_if(numbers, [](const Enclosure& e) { return e.lo != e.hi; });
  if (interval == numbers.end()) return;
  throw Error(ErrorKind::input, fmt::format("{}[{}]: a fit chooses semi-axes only, not from [{}, {}]", place,
                                            interval - numbers.begin(), interval->lo, interval->hi));
}

template <std::size_t N>
std::array<double, N> middles(const std::array<Enclosure, N>& intervals) {
  std::array<double, N> result{};
  std::ranges::transform(intervals, result.begin(), [](const Enclosure& e) { return std::midpoint(e.lo, e.hi); });
  return result;
}

Model middle_of(const UncertainModel& implant) {
  Model model{implant.units, {}, implant.csg};
  for (std::size_t k = 0; k < implant.primitives.size(); ++k) {
    const UncertainPrimitive& primitive = implant.primitives[k];
    require_exact(primitive.exponents, place(primitive, k, "superquadric.exponents"));
    require_exact(primitive.translation, place(primitive, k, "pose.translation"));
    model.primitives.push_back(
        {.name = primitive.name,
         .superquadric = {middles(primitive.semi_axes), middles(primitive.exponents), primitive.taper},
         .pose = {middles(primitive.translation), primitive.quaternion},
         .bend = primitive.bend,
         .mesh = primitive.mesh});
  }
  if (!is_exact(implant)) verify::require_union_of_convex(model, "sizes to choose from");
  return model;
}

std::vector<std::shared_ptr<const SolidMesh>> meshes_of(const Model& model) {
  std::vector<std::shared_ptr<const SolidMesh>> meshes;
  for (const Primitive& primitive : model.primitives)
    meshes.push_back(primitive.mesh ? std::make_shared<const SolidMesh>(*primitive.mesh) : nullptr);
  return meshes;
}

}  // namespace

CandidateSpace::CandidateSpace(const UncertainModel& implant, const PoseRange& range)
    : middle_(middle_of(implant)), start_rotation_(verify::unit_quaternion(range.start.quaternion)) {
  set_ = std::make_shared<const verify::SetNode>(verify::normal_form(middle_, verify::Side::inside));
  if (has_mesh(middle_)) meshes_ = meshes_of(middle_);
  const verify::Box box = verify::bounding_box(middle_);
  centre_ = (vector_of(box.lower) + vector_of(box.upper)) / 2.0;
  radius_ = (vector_of(box.upper) - vector_of(box.lower)).norm() / 2.0;
  start_centre_ = start_rotation_ * centre_ + vector_of(range.start.translation);
  bound_pose(range);
  bound_sizes(implant);
}

void CandidateSpace::bound_pose(const PoseRange& range) {
  const double angle = range.rotation_degrees * std::numbers::pi / 180.0;
  upper_.assign(3, range.translation);
  upper_.insert(upper_.end(), 3, angle);
  for (const double end : upper_) lower_.push_back(-end);
  units_.assign(3, 1.0);
  // Most of the surface lies closer to the centre than the corners of the box.
  units_.insert(units_.end(), 3, 2.0 / radius_);
}

void CandidateSpace::bound_sizes(const UncertainModel& implant) {
  for (std::size_t k = 0; k < implant.primitives.size(); ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto& [lo, hi] = implant.primitives[k].semi_axes[axis];
      if (lo == hi) continue;
      sizes_.push_back({k, axis});
      lower_.push_back(lo);
      upper_.push_back(hi);
      units_.push_back(1.0);
    }
  }
}

Parameters CandidateSpace::start() const {
  Parameters parameters(kPoseParameters, 0.0);
  for (const auto& [primitive, axis] : sizes_)
    parameters.push_back(middle_.primitives[primitive].superquadric.semi_axes[axis]);
  return parameters;
}

Quaterniond CandidateSpace::rotation(std::span<const double> parameters) const {
  return (exponential(rotation_vector(parameters)) * start_rotation_).normalized();
}

Model CandidateSpace::sized(std::span<const double> parameters) const {
  Model model = middle_;
  for (std::size_t i = 0; i < sizes_.size(); ++i)
    model.primitives[sizes_[i].primitive].superquadric.semi_axes[sizes_[i].axis] = parameters[kPoseParameters + i];
  return model;
}

Parameters CandidateSpace::nearest(const Pose& pose) const {
  const Quaterniond turned = verify::unit_quaternion(pose.quaternion);
  const Vector3d moved = turned * centre_ + vector_of(pose.translation) - start_centre_;
  const Eigen::AngleAxisd turn(turned * start_rotation_.conjugate());  // by at most half a turn
  const Vector3d rotation = turn.angle() * turn.axis();
  Parameters result = start();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    result[i] = std::clamp(moved[k], lower_[i], upper_[i]);
    result[3 + i] = std::clamp(rotation[k], lower_[3 + i], upper_[3 + i]);
  }
  return result;
}

verify::PoseSpace CandidateSpace::pose_space() const {
  return {start_rotation_.toRotationMatrix(), centre_, start_centre_};
}

Pose CandidateSpace::pose(std::span<const double> parameters) const {
  const Quaterniond turned = rotation(parameters);
  const Vector3d moved(parameters[0], parameters[1], parameters[2]);
  return {point_of(start_centre_ + moved - turned * centre_), numbers(turned)};
}

Point CandidateSpace::pivot(std::span<const double> parameters) const {
  return point_of(start_centre_ + Vector3d(parameters[0], parameters[1], parameters[2]));
}

FitMovement CandidateSpace::movement(std::span<const double> parameters) const {
  FitMovement movement{{}, {}, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    movement.centre[i] = parameters[i];
    movement.rotation_degrees[i] = parameters[3 + i] * 180.0 / std::numbers::pi;
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double reach = kAtLimit * (upper_[i] - lower_[i]);
    if (parameters[i] - lower_[i] < reach || upper_[i] - parameters[i] < reach) movement.at_limits.push_back(name(i));
  }
  return movement;
}

std::string CandidateSpace::name(std::size_t parameter) const {
  if (parameter < kPoseParameters) {
    return fmt::format("{} {}", parameter < 3 ? "translation along" : "rotation about", "xyz"[parameter % 3]);
  }
  const auto& [primitive, axis] = sizes_[parameter - kPoseParameters];
  return fmt::format("semi-axis {} of {}", axis + 1, middle_.primitives[primitive].name);
}

Candidate CandidateSpace::candidate(std::span<const double> parameters) const {
  const Quaterniond turned = rotation(parameters);
  Candidate result{sized(parameters).primitives, pivot(parameters), set_, meshes_};
  for (Primitive& primitive : result.primitives) {
    primitive.pose.translation =
        point_of(turned * (vector_of(primitive.pose.translation) - centre_) + vector_of(result.pivot));
    primitive.pose.quaternion = numbers((turned * verify::unit_quaternion(primitive.pose.quaternion)).normalized());
  }
  return result;
}

void CandidateSpace::write_pose_gradient(std::span<const double> parameters, const std::array<double, 6>& by_pose,
                                         std::span<double> row) const {
  const Vector3d by_rotation =
      left_jacobian(rotation_vector(parameters)).transpose() * Vector3d(by_pose[3], by_pose[4], by_pose[5]);
  std::copy_n(by_pose.begin(), 3, row.begin());
  std::copy_n(by_rotation.data(), 3, row.begin() + 3);
}

Parameters CandidateSpace::gradient(std::span<const double> parameters, const std::array<double, 6>& by_pose,
                                    std::span<const std::array<double, 3>> by_size) const {
  Parameters result(parameters.size());
  write_pose_gradient(parameters, by_pose, result);
  for (std::size_t i = 0; i < sizes_.size(); ++i)
    result[kPoseParameters + i] = by_size[sizes_[i].primitive][sizes_[i].axis];
  return result;
}

void CandidateSpace::gradient(std::span<const double> parameters, const std::array<double, 6>& by_pose,
                              const PointDistance& at, std::span<double> row) const {
  write_pose_gradient(parameters, by_pose, row);
  for (std::size_t i = 0; i < sizes_.size(); ++i)
    row[kPoseParameters + i] = sizes_[i].primitive == at.primitive ? at.size_gradient[sizes_[i].axis] : 0.0;
}

}  // namespace verisq::fit_search
