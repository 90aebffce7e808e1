/// Eigenvalues against those of another formulation: the equations of motion by Newton-Euler and composite bodies, in
/// the file's coordinates, differentiated by differences.
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <complex>
#include <random>
#include <verisq/error.hpp>
#include <verisq/stance.hpp>

#include "tests/fixtures/places.hpp"
#include "verify/stance/linear_systems.hpp"
#include "verify/stance/rnea.hpp"
#include "verify/stance/standing.hpp"
#include "verisq/stance_equilibrium.hpp"

namespace verisq::stance {
namespace {

Model standing() {
  return read_model(places::example("standing.xml"));
}

void set_gains(Model& model, double proportional, double integral, double derivative) {
  for (Controller& controller : model.controllers) {
    controller.proportional = proportional;
    controller.integral = integral;
    controller.derivative = derivative;
  }
}

/// All bodies and cylinders, bristles that are anchored at a posture, and controllers whose integral parts hold the
/// body there.
class Motion {
 public:
  Motion(const Model& model, std::vector<double> parameters, std::vector<double> rest)
      : model_(model), parameters_(std::move(parameters)), rest_(std::move(rest)) {
    for (const ContactCylinder& cylinder : model.cylinders) {
      damping_.push_back(damping_factor(value_of<double>(cylinder.normal_restitution, parameters_)) /
                         value_of<double>(cylinder.impact_velocity, parameters_));
    }
    const std::vector<double> still(rest_.size(), 0.0);
    const std::vector<double> missing = forces(rest_, still);
    for (std::size_t i = model.bodies.front().joints.size(); i < missing.size(); ++i) held_[i] = -missing[i];
  }

  /// At a posture and its rate: of all joints.
  [[nodiscard]] Eigen::VectorXd acceleration(const std::vector<double>& position,
                                             const std::vector<double>& velocity) const {
    const std::vector<double> force = forces(position, velocity);
    const Eigen::MatrixXd mass =
        mass_matrix<double>(model_, std::span<const double>(parameters_), State<double>{position, velocity});
    return mass.ldlt().solve(Eigen::Map<const Eigen::VectorXd>(force.data(), std::ssize(force)));
  }

 private:
  /// On all joints: what acts less what their velocities need.
  [[nodiscard]] std::vector<double> forces(const std::vector<double>& position,
                                           const std::vector<double>& velocity) const {
    const State<double> state{position, velocity};
    const Tree<double> tree = tree_of<double>(model_, parameters_, position);
    std::vector<double> force = held_;
    const std::vector<double> bias = bias_forces<double>(model_, parameters_, state);
    for (std::size_t i = 0; i < force.size(); ++i) force[i] -= bias[i];
    for (std::size_t c = 0; c < model_.cylinders.size(); ++c) add_contact(force, c, tree, position, velocity);
    std::vector<std::size_t> first{0};
    for (const Body& body : model_.bodies) first.push_back(first.back() + body.joints.size());
    for (const Controller& controller : model_.controllers) {
      const std::size_t j = first[controller.body] + controller.joint;
      force[j] -= controller.proportional * (position[j] - file_[j]) + controller.derivative * velocity[j];
    }
    return force;
  }

  void add_contact(std::vector<double>& force, std::size_t index, const Tree<double>& tree,
                   const std::vector<double>& position, const std::vector<double>& velocity) const {
    const ContactCylinder& cylinder = model_.cylinders[index];
    const BodyPose<double> pose = forward_kinematics(tree)[cylinder.body];
    const auto value = [&](const Quantity& quantity) { return value_of<double>(quantity, parameters_); };
    for (const double side : {-1.0, 1.0}) {
      Vector3<double> centre = values_of<double>(cylinder.centre, parameters_);
      for (int k = 0; k < 3; ++k)
        centre[k] += side * cylinder.half_length / std::sqrt(3.0) * cylinder.axis[static_cast<std::size_t>(k)];
      const Vector3<double> axis =
          pose.orientation * Vector3<double>(cylinder.axis[0], cylinder.axis[1], cylinder.axis[2]);
      Vector3<double> downward(0.0, -1.0, 0.0);
      downward -= axis * axis.dot(downward);
      const Vector3<double> lowest = pose.point(centre) + value(cylinder.radius) * downward.normalized();
      const Vector3<double> in_body = pose.orientation.transpose() * (lowest - pose.position);
      const Vector3<double> speed = velocity_of(cylinder.body, tree, pose, in_body, velocity);
      std::vector<double> displacement = position;
      for (std::size_t i = 0; i < position.size(); ++i) displacement[i] -= rest_[i];
      const Vector3<double> slid = velocity_of(cylinder.body, tree, pose, in_body, displacement);
      Vector3<double> acting = -0.5 * (cylinder.bristle_stiffness * slid + cylinder.bristle_damping * speed);
      acting[1] = 0.5 * value(cylinder.stiffness) * -lowest[1] * (1.0 - damping_[index] * speed[1]);
      const std::vector<double> added = generalised_force<double>(tree, cylinder.body, in_body, acting);
      for (std::size_t i = 0; i < force.size(); ++i) force[i] += added[i];
    }
  }

  static Vector3<double> velocity_of(std::size_t body, const Tree<double>& tree, const BodyPose<double>& pose,
                                     const Vector3<double>& in_body, const std::vector<double>& rates) {
    return point_velocity(pose, body_velocities(tree, rates)[body], in_body);
  }

  const Model& model_;
  std::vector<double> parameters_, rest_;
  std::vector<double> damping_;  ///< D/v_N of the cylinders
  std::vector<double> file_ = stance_state<double>(model_).position;
  std::vector<double> held_ = std::vector<double>(file_.size(), 0.0);
};

/// Of positions, rates and, where they act, integrals.
Eigen::MatrixXd linearised(const Model& model, const std::vector<double>& parameters, const std::vector<double>& rest,
                           bool integrals) {
  const Motion motion(model, parameters, rest);
  const auto n = std::ssize(rest);
  const auto controlled = integrals ? std::ssize(model.controllers) : 0;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n + controlled, 2 * n + controlled);
  a.block(0, n, n, n).setIdentity();
  const std::vector<double> still(rest.size(), 0.0);
  for (Eigen::Index j = 0; j < n; ++j) {
    constexpr double step = 1e-6;
    const auto moved = [&](std::vector<double> values, double by) {
      values[static_cast<std::size_t>(j)] += by;
      return values;
    };
    a.block(n, j, n, 1) =
        (motion.acceleration(moved(rest, step), still) - motion.acceleration(moved(rest, -step), still)) / (2 * step);
    a.block(n, n + j, n, 1) =
        (motion.acceleration(rest, moved(still, step)) - motion.acceleration(rest, moved(still, -step))) / (2 * step);
  }
  const Eigen::MatrixXd mass =
      mass_matrix<double>(model, std::span<const double>(parameters), State<double>{rest, still});
  std::vector<Eigen::Index> first{0};
  for (const Body& body : model.bodies) first.push_back(first.back() + std::ssize(body.joints));
  for (Eigen::Index c = 0; c < controlled; ++c) {
    const Controller& controller = model.controllers[static_cast<std::size_t>(c)];
    const Eigen::Index joint = first[controller.body] + static_cast<Eigen::Index>(controller.joint);
    a.block(n, 2 * n + c, n, 1) = -mass.ldlt().solve(controller.integral * Eigen::VectorXd::Unit(n, joint));
    a(2 * n + c, joint) = 1.0;
  }
  return a;
}

std::vector<double> nominal(const Model& model) {
  return nominal_parameters<double>(model);
}

/// The posture of an equilibrium, by its enclosure.
std::vector<double> equilibrium_posture(const Model& model, JointControl control) {
  const Equilibrium found = equilibrium(model, {}, {.control = control});
  std::vector<double> posture;
  for (const Enclosure& position : found.standing.value().positions)
    posture.push_back(0.5 * position.lo + 0.5 * position.hi);
  return posture;
}

std::vector<std::complex<double>> eigenvalues_of(const Eigen::MatrixXd& a) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(a, false);
  return {solver.eigenvalues().begin(), solver.eigenvalues().end()};
}

bool contains(const EigenvalueEnclosure& enclosure, const std::complex<double>& z, double slack) {
  return z.real() >= enclosure.real.lo - slack && z.real() <= enclosure.real.hi + slack &&
         z.imag() >= enclosure.imaginary.lo - slack && z.imag() <= enclosure.imaginary.hi + slack;
}

/// Differences leave relative errors of about 1e-7 in fast eigenvalues, and absolute ones in slow ones.
void expect_same_eigenvalues(const Model& model, JointControl control) {
  const Stability found = stability(model, {}, {.control = control});
  const std::vector<std::complex<double>> expected = eigenvalues_of(
      linearised(model, nominal(model), equilibrium_posture(model, control), control == JointControl::held));
  std::size_t count = 0;
  for (const EigenvalueEnclosure& enclosure : found.eigenvalues) {
    count += enclosure.count;
    const double slack = 2e-5 * std::max(1.0, std::abs(enclosure.real.lo));
    EXPECT_GE(std::ranges::count_if(expected, [&](const auto& z) { return contains(enclosure, z, slack); }),
              std::ptrdiff_t(enclosure.count))
        << enclosure.real.lo << " + i " << enclosure.imaginary.lo;
  }
  EXPECT_EQ(count, expected.size());
}

TEST(StandingStability, AllEigenvaluesAreThoseOfAnotherFormulation) {
  expect_same_eigenvalues(standing(), JointControl::held);
  expect_same_eigenvalues(standing(), JointControl::proportional);
}

TEST(StandingStability, ThePersonWhoStandsIsStable) {
  const Stability found = stability(standing(), {}, {});
  EXPECT_EQ(found.stable, 1.0);
  EXPECT_LT(found.growth.hi, 0.0);
  // Found independently, for motions in the sagittal plane: sway, and the slowest that is not 0.
  for (const std::complex<double> z : {std::complex<double>(-0.171, 1.886), std::complex<double>(-0.015, 0.0)}) {
    EXPECT_TRUE(std::ranges::any_of(found.eigenvalues, [&](const auto& of) { return contains(of, z, 5e-4); })) << z;
  }
}

TEST(StandingStability, WeakGainsAreUnstable) {
  Model model = standing();
  set_gains(model, 400, 40, 20);
  const Stability found = stability(model, {}, {});
  EXPECT_EQ(found.unstable, 1.0);
  EXPECT_NEAR(found.growth.lo, 1.719, 5e-4);
  EXPECT_NEAR(found.growth.hi, 1.719, 5e-4);
  expect_same_eigenvalues(model, JointControl::held);
}

TEST(StandingStability, ASaddleIsUnstable) {
  Model model = standing();
  for (ContactCylinder& cylinder : model.cylinders) cylinder.stiffness = {15000, {15000, 15000}, std::nullopt};
  EXPECT_EQ(equilibrium(model, {}, {}).stands, 1.0);
  EXPECT_EQ(stability(model, {}, {}).unstable, 1.0);
}

TEST(StandingStability, ABoxContainsItsSamples) {
  const std::vector<std::string> names{"mp", "k"};
  const Model whole = standing();
  const std::vector<std::uint32_t> uncertain = uncertain_parameters(whole, names);
  const Model model = narrowed_within(whole, uncertain, 0.5);
  const Stability found = stability(model, uncertain, {});
  EXPECT_EQ(found.stable, 1.0);
  std::mt19937 random(7);
  for (int sample = 0; sample < 5; ++sample) {
    Model at = model;
    for (const std::uint32_t k : uncertain) {
      const Enclosure range = at.parameters[k].range;
      const double value = std::uniform_real_distribution(range.lo, range.hi)(random);
      at = narrowed(std::move(at), k, {value, value});
    }
    const Stability exact = stability(at, {}, {});
    EXPECT_GE(exact.growth.lo, found.growth.lo);
    EXPECT_LE(exact.growth.hi, found.growth.hi);
  }
}

TEST(StandingStability, LeavesOpenWhatHasNoEquilibrium) {
  const Model model = narrowed(narrowed(standing(), 0, {64, 65}), 1, {0.05, 0.051});
  const Stability found = stability(narrowed(model, 2, {0.49, 0.5}), std::vector<std::uint32_t>{0, 1, 2}, {.cells = 1});
  EXPECT_EQ(found.open, 1.0);
  EXPECT_GT(found.growth.lo, found.growth.hi);
}

TEST(StandingStability, RefusesWhatNothingHolds) {
  const auto message = [](const Model& model) {
    try {
      (void)stability(model, {}, {});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  Model slides = standing();
  slides.cylinders[1].bristle_stiffness = 0.0;
  EXPECT_EQ(
      message(slides),
      "stability: cylinder right forefoot has no bristle_stiffness and bristle_damping, and nothing keeps it from "
      "sliding");
  Model smooth = standing();
  smooth.cylinders[0].static_friction = {0.0, {0.0, 0.0}, std::nullopt};
  EXPECT_EQ(message(smooth), "stability: cylinder right hindfoot may have no static friction, and slides then");
  Model guided = standing();  // on a rail: another mechanism than one that may go anywhere
  std::erase_if(guided.bodies.front().joints, [](const Joint& joint) { return joint.name == "tx"; });
  EXPECT_EQ(message(guided), "stability: the root needs one translation along each of x, y and z");
  Model shaken = standing();
  shaken.applied.frequency = {3.0, {3.0, 3.0}, std::nullopt};
  shaken.applied.force[1] = {-300.0, {-300.0, -300.0}, std::nullopt};
  EXPECT_THAT(message(shaken), testing::HasSubstr("the applied force has a frequency"));
  Model loose = standing();
  loose.controllers[3].integral = 0.0;
  EXPECT_THAT(message(loose), testing::HasSubstr("no controller with an integral part holds joint rz of right tibia"));
}

TEST(MidpointRadius, ContainsProductsOfMembers) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  IntervalMatrix a(9, 11);
  IntervalMatrix b(11, 7);
  for (IntervalMatrix* m : {&a, &b}) {
    for (auto& entry : m->reshaped()) {
      const double x = std::ldexp(unit(random), int(20 * unit(random)));
      entry = verify::Interval(x) + verify::Interval(-1e-3, 1e-3) * verify::Interval(x);
    }
  }
  const IntervalMatrix product_of_all = (MidpointRadius(a) * MidpointRadius(b)).intervals();
  for (Eigen::Index i = 0; i < 9; ++i) {
    // Every end of the exact range is attained by members: the product must contain it.
    const verify::Interval tight = product(a, IntervalVector(b.col(0)))[i];
    EXPECT_LE(product_of_all(i, 0).lower(), tight.lower() + 1e-12 * std::abs(tight.lower()));
    EXPECT_GE(product_of_all(i, 0).upper(), tight.upper() - 1e-12 * std::abs(tight.upper()));
  }
}

}  // namespace
}  // namespace verisq::stance
