/// The tree without the uncertain masses: its responses to wrenches on their bodies, enclosed once.
#include "verify/stance/reduced_motion.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "verify/stance/acceleration.hpp"
#include "verify/stance/linear_systems.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

constexpr Quantity exactly_zero{};
constexpr QuantityVector exactly_zero_vector{};

bool is_one_of(const Quantity& quantity, std::span<const std::uint32_t> variables) {
  return quantity.parameter && std::ranges::find(variables, *quantity.parameter) != variables.end();
}

bool has_one_of(const QuantityVector& vector, std::span<const std::uint32_t> variables) {
  return std::ranges::any_of(vector, [&](const Quantity& quantity) { return is_one_of(quantity, variables); });
}

bool moves_mass(const Body& body, std::span<const std::uint32_t> variables) {
  return is_one_of(body.mass, variables) || has_one_of(body.centre_of_mass, variables);
}

bool is_reducible(const Body& body, std::span<const std::uint32_t> variables) {
  const bool positive = !is_one_of(body.mass, variables) || body.mass.range.lo > 0.0;
  return positive && !has_one_of(body.offset, variables) && !has_one_of(body.inertia, variables);
}

/// Where a cylinder is must not change: it is no more than pressed differently.
bool is_in_place(const ContactCylinder& cylinder, std::span<const std::uint32_t> variables) {
  return !has_one_of(cylinder.centre, variables);
}

bool is_nothing(const Force<Interval>& force) {
  const auto zero = [](const Interval& a) { return is_zero(a); };
  return std::ranges::all_of(force.moment, zero) && std::ranges::all_of(force.force, zero);
}

Model without_masses(Model model, std::span<const std::uint32_t> variables) {
  for (Body& body : model.bodies) {
    if (!moves_mass(body, variables)) continue;
    body.mass = exactly_zero;
    body.centre_of_mass = exactly_zero_vector;
  }
  return model;
}

IntervalVector vector_of(const std::vector<Interval>& numbers) {
  IntervalVector result(static_cast<Eigen::Index>(numbers.size()));
  std::ranges::copy(numbers, result.begin());
  return result;
}

/// What a force of 1 N along the axis on the root does to the joints.
IntervalVector applied_along(Model model, std::size_t axis, const std::vector<Interval>& parameters,
                             const State<Interval>& state) {
  model.applied.force = exactly_zero_vector;
  model.applied.force[axis] = {1.0, {1.0, 1.0}, {}};
  return vector_of(applied_generalised_force(model, parameters, state));
}

/// The transpose of the Jacobian of the body's frame: column k is what part k of a wrench there does to the joints.
IntervalMatrix transposed_jacobian(const Tree<Interval>& tree, std::size_t body) {
  IntervalMatrix result(static_cast<Eigen::Index>(tree.degrees_of_freedom), 6);
  for (int k = 0; k < 3; ++k) {
    Force<Interval> moment;
    moment.moment[k] = Interval(1);
    result.col(k) = vector_of(generalised_force(tree, body, moment));
    Force<Interval> force;
    force.force[k] = Interval(1);
    result.col(3 + k) = vector_of(generalised_force(tree, body, force));
  }
  return result;
}

/// Systems with one matrix.
class FixedSystem {
 public:
  explicit FixedSystem(IntervalMatrix matrix)
      : matrix_(std::move(matrix)),
        factors_(matrix_.unaryExpr([](const Interval& a) { return 0.5 * a.lower() + 0.5 * a.upper(); })) {}

  /// The solution, by column; nothing where the matrix is not proven to be regular.
  [[nodiscard]] std::optional<IntervalMatrix> solution(const IntervalMatrix& right) const {
    IntervalMatrix result(right.rows(), right.cols());
    for (Eigen::Index j = 0; j < right.cols(); ++j) {
      const IntervalVector column = right.col(j);
      const Eigen::VectorXd near =
          factors_.solve(column.unaryExpr([](const Interval& a) { return 0.5 * a.lower() + 0.5 * a.upper(); }));
      if (!near.allFinite()) return std::nullopt;
      const auto solved = solve({near, matrix_, column - product(matrix_, near.cast<Interval>()), {}});
      if (!solved) return std::nullopt;
      result.col(j) = solved->solution;
    }
    return result;
  }

 private:
  IntervalMatrix matrix_;
  Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
};

}  // namespace

bool ReducedMotion::press(const Tree<Interval>& tree, const std::vector<Interval>& parameters,
                          std::span<const IntervalMatrix> jacobians, const Solver& solution) {
  const auto response_to = [&](std::size_t body, const Force<Interval>& force) -> std::optional<Response> {
    const std::optional<IntervalMatrix> moved = solution(vector_of(generalised_force(tree, body, force)));
    if (!moved) return std::nullopt;
    Response response{moved->col(0)};
    for (const IntervalMatrix& jacobian : jacobians) response.masses.emplace_back(jacobian.lazyProduct(*moved));
    return response;
  };
  const std::vector<BodyPose<Interval>> poses = forward_kinematics(tree);
  for (const ContactCylinder& cylinder : model_->cylinders) {
    const BodyPose<Interval>& pose = poses[cylinder.body];
    PressedCylinder pressed{&cylinder, pose};
    for (const GroundForce<Interval>& force : ground_forces<Interval>(cylinder, pose, parameters)) {
      std::optional<Response> at_centre = response_to(cylinder.body, force.at_centre);
      if (!at_centre) return false;
      pressed.points.push_back({std::move(*at_centre)});
      if (is_nothing(force.by_radius)) continue;
      pressed.points.back().by_radius = response_to(cylinder.body, force.by_radius);
      if (!pressed.points.back().by_radius) return false;
    }
    pressed_.push_back(std::move(pressed));
  }
  return true;
}

std::optional<ReducedMotion> ReducedMotion::of(const Model& model, const Instant& instant,
                                               std::span<const std::uint32_t> variables,
                                               const std::vector<double>& parameters) {
  const auto reducible = [&](const Body& body) { return is_reducible(body, variables); };
  if (!std::ranges::all_of(model.bodies, reducible)) return std::nullopt;
  const std::vector<Interval> at(parameters.begin(), parameters.end());
  const auto in_place = [&](const ContactCylinder& cylinder) { return is_in_place(cylinder, variables); };
  if (instant.on_ground && !std::ranges::all_of(model.cylinders, in_place)) return std::nullopt;
  const State<Interval> state = state_at<Interval>(instant);
  const Model rest = without_masses(model, variables);
  const FixedSystem system(mass_matrix_at(rest, at, instant));

  IntervalMatrix right(static_cast<Eigen::Index>(model.degrees_of_freedom()), 4);
  right.col(0) = -vector_of(bias_forces<Interval>(rest, at, state));
  for (std::size_t i = 0; i < instant.torques.size(); ++i)
    right(static_cast<Eigen::Index>(i), 0) += constant_of<Interval>(instant.torques[i]);
  for (std::size_t k = 0; k < 3; ++k) right.col(static_cast<Eigen::Index>(k) + 1) = applied_along(model, k, at, state);
  const std::optional<IntervalMatrix> free = system.solution(right);
  if (!free) return std::nullopt;
  ReducedMotion result(model);
  result.free_ = free->col(0);
  result.by_applied_ = free->rightCols(3);

  const Tree<Interval> tree = tree_of<Interval>(rest, at, state.position);
  const std::vector<Interval> still(model.degrees_of_freedom(), Interval(0));
  const std::vector<LinkMotion<Interval>> motions = link_motions<Interval>(tree, model.gravity, state.velocity, still);
  std::vector<IntervalMatrix> jacobians;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (!moves_mass(model.bodies[i], variables)) continue;
    const IntervalMatrix transposed = transposed_jacobian(tree, i);
    const std::optional<IntervalMatrix> response = system.solution(transposed);
    if (!response) return std::nullopt;
    jacobians.emplace_back(transposed.transpose());
    const IntervalMatrix moved = jacobians.back().lazyProduct(*free);
    const auto& [velocity, acceleration] = motions[tree.body_link[i]];
    Mass mass{.body = &model.bodies[i], .response = *response};
    mass.by_applied = moved.rightCols(3);
    // Of the point at the frame's origin itself: the spatial acceleration is that of points that pass there.
    const Vector3<Interval> linear = acceleration.linear + velocity.angular.cross(velocity.linear);
    mass.free << acceleration.angular, linear;
    mass.free += moved.col(0);
    mass.angular_velocity = velocity.angular;
    result.masses_.push_back(std::move(mass));
  }
  for (std::size_t i = 0; i < jacobians.size(); ++i) {
    for (const Mass& other : result.masses_)
      result.masses_[i].compliance.emplace_back(jacobians[i].lazyProduct(other.response));
  }
  if (instant.on_ground &&
      !result.press(tree, at, jacobians, [&](const IntervalMatrix& force) { return system.solution(force); }))
    return std::nullopt;
  return result;
}

}  // namespace verisq::stance
