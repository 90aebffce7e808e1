/// Multibody dynamics against independent formulations, samples and differences.
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "tests/fixtures/stance_example.hpp"
#include "verify/stance/rnea.hpp"

namespace verisq::stance {
namespace {

bool contains(const Interval& outer, const Interval& inner) {
  return outer.lower() <= inner.lower() && inner.upper() <= outer.upper();
}

/// The same physics without a line of the algorithms: bodies from homogeneous transforms, their motion by
/// differentiating them, and Lagrange's equations of the second kind.
namespace lagrangian {

template <class T>
struct Placed {
  Matrix3<T> rotation;
  Vector3<T> centre;  ///< of mass
};

/// Rodrigues' formula for a rotation about a coordinate axis.
template <class T>
Matrix3<T> axis_rotation(std::uint8_t axis, const T& angle) {
  Matrix3<T> cross = Matrix3<T>::Constant(T(0));
  cross((axis + 2) % 3, (axis + 1) % 3) = T(1);
  cross((axis + 1) % 3, (axis + 2) % 3) = T(-1);
  return Matrix3<T>::Identity() + cross * sin(angle) + cross * cross * (T(1) - cos(angle));
}

Vector3<double> nominal(const QuantityVector& q, std::span<const double> parameters) {
  return values_of(q, parameters);
}

template <class T>
std::vector<Placed<T>> placed_bodies(const Model& model, std::span<const double> parameters, const std::vector<T>& q) {
  std::vector<Matrix3<T>> rotation;
  std::vector<Vector3<T>> origin;
  std::vector<Placed<T>> result;
  std::size_t next = 0;
  for (const Body& body : model.bodies) {
    Matrix3<T> r = body.parent ? rotation[*body.parent] : Matrix3<T>(Matrix3<T>::Identity());
    Vector3<T> p = body.parent ? origin[*body.parent] : Vector3<T>(T(0), T(0), T(0));
    p += r * nominal(body.offset, parameters).template cast<T>();
    for (const Joint& joint : body.joints) {
      if (joint.kind == JointKind::translation) p += r.col(joint.axis) * q[next];
      if (joint.kind == JointKind::rotation) r = Matrix3<T>(r * axis_rotation(joint.axis, q[next]));
      ++next;
    }
    rotation.push_back(r);
    origin.push_back(p);
    result.push_back({r, p + r * nominal(body.centre_of_mass, parameters).template cast<T>()});
  }
  return result;
}

template <class T>
T kinetic_energy(const Model& model, std::span<const double> parameters, const std::vector<T>& q,
                 const std::vector<T>& velocity) {
  std::vector<Dual<T>> path;
  for (std::size_t i = 0; i < q.size(); ++i) path.push_back({q[i], {velocity[i]}});
  const auto bodies = placed_bodies(model, parameters, path);
  T energy(0);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto mass = value_of<double>(model.bodies[i].mass, parameters);
    const Vector3<double> moments = nominal(model.bodies[i].inertia, parameters);
    for (int k = 0; k < 3; ++k) {
      energy += 0.5 * mass * square(bodies[i].centre[k].partial[0]);
      // The k-th component of the angular velocity in the body's frame, from the product of R^T and R's derivative.
      T rate(0);
      for (int row = 0; row < 3; ++row) {
        rate += bodies[i].rotation(row, (k + 2) % 3).value * bodies[i].rotation(row, (k + 1) % 3).partial[0];
      }
      energy += 0.5 * moments[k] * square(rate);
    }
  }
  return energy;
}

template <class T>
T potential_energy(const Model& model, std::span<const double> parameters, const std::vector<T>& q) {
  const auto bodies = placed_bodies(model, parameters, q);
  T energy(0);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    energy += value_of<double>(model.bodies[i].mass, parameters) * model.gravity * bodies[i].centre[1];
  }
  return energy;
}

/// d/dt (dT/d velocity) - dT/dq + dV/dq.
std::vector<double> generalised_forces(const Model& model, std::span<const double> parameters,
                                       const State<double>& state, const std::vector<double>& acceleration) {
  using InTime = Dual<double>;
  using First = Dual<double>;
  using Second = Dual<InTime>;
  const std::size_t size = state.position.size();
  std::vector<double> result;
  for (std::size_t k = 0; k < size; ++k) {
    std::vector<Second> q;
    std::vector<Second> velocity;
    for (std::size_t i = 0; i < size; ++i) {
      q.emplace_back(InTime(state.position[i], {state.velocity[i]}));
      velocity.emplace_back(InTime(state.velocity[i], {acceleration[i]}));
    }
    velocity[k].partial[0] = InTime(1);
    const double momentum_rate = kinetic_energy(model, parameters, q, velocity).partial[0].partial[0];
    std::vector<First> moved(state.position.begin(), state.position.end());
    moved[k].partial[0] = 1;
    const std::vector<First> fixed(state.velocity.begin(), state.velocity.end());
    result.push_back(momentum_rate - kinetic_energy(model, parameters, moved, fixed).partial[0] +
                     potential_energy(model, parameters, moved).partial[0]);
  }
  return result;
}

}  // namespace lagrangian

/// A tree with everything that the stance does not have: a fixed base, a body without joints, sliding joints below
/// rotating ones, offsets in all directions.
Model crooked_tree() {
  using namespace example;
  Model model{3.7, {}, {}, {}, {}, {}};
  model.applied = {numbers(1, 2, 3), number(0)};
  model.bodies.push_back(
      {"base", {}, numbers(0.1, 0.2, 0.3), {}, number(5), numbers(0.1, 0, -0.2), numbers(1, 2, 2.5)});
  model.bodies.push_back({"arm",
                          0,
                          numbers(0.3, -0.2, 0.1),
                          {rotation(1), translation(0), rotation(2)},
                          number(2),
                          numbers(-0.1, 0.3, 0.2),
                          numbers(0.3, 0.2, 0.4)});
  model.bodies.push_back(
      {"load", 1, numbers(0.2, 0.5, -0.4), {}, number(0.7), numbers(0.05, 0.02, 0.1), numbers(0.02, 0.03, 0.04)});
  model.bodies.push_back({"hand",
                          2,
                          numbers(-0.1, 0.4, 0.2),
                          {translation(2), rotation(0), translation(1)},
                          number(0.4),
                          numbers(0.2, 0.1, -0.1),
                          numbers(0.01, 0.015, 0.02)});
  model.bodies.push_back(
      {"branch", 1, numbers(0.5, 0, 0), {rotation(0)}, number(1), numbers(0, 0, 0.3), numbers(0.1, 0.1, 0.05)});
  return model;
}

struct Sample {
  std::vector<double> parameters;
  State<double> state;
  std::vector<double> acceleration;
};

double uniform(std::mt19937_64& random, double lower, double upper) {
  return std::uniform_real_distribution<double>(lower, upper)(random);
}

Sample random_sample(const Model& model, std::mt19937_64& random) {
  Sample sample;
  for (const Parameter& p : model.parameters) sample.parameters.push_back(uniform(random, p.range.lo, p.range.hi));
  for (std::size_t i = 0; i < model.degrees_of_freedom(); ++i) {
    sample.state.position.push_back(uniform(random, -2, 2));
    sample.state.velocity.push_back(uniform(random, -2, 2));
    sample.acceleration.push_back(uniform(random, -5, 5));
  }
  return sample;
}

template <class T>
State<T> converted(const State<double>& state) {
  return {{state.position.begin(), state.position.end()}, {state.velocity.begin(), state.velocity.end()}};
}

std::vector<std::uint32_t> all_parameters(const Model& model) {
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < model.parameters.size(); ++i) all.push_back(i);
  return all;
}

Eigen::VectorXd vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

double largest(const std::vector<double>& values) {
  return vector(values).lpNorm<Eigen::Infinity>();
}

class Dynamics : public testing::TestWithParam<bool> {
 protected:
  const Model model = GetParam() ? nine_segments() : crooked_tree();
  std::mt19937_64 random{7};
};
INSTANTIATE_TEST_SUITE_P(Tree, Dynamics, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "stance" : "crooked"; });

TEST(StanceModel, HasTheSegmentsOfThePaper) {
  const Model model = nine_segments();
  EXPECT_EQ(model.bodies.size(), 9U);
  EXPECT_EQ(model.degrees_of_freedom(), 26U);
  EXPECT_EQ(model.cylinders.size(), 4U);
  EXPECT_EQ(model.controllers.size(), 20U);
  EXPECT_EQ(model.parameters[mu_d].name, "mu_d");
  EXPECT_EQ(model.parameters[mf].name, "mf");
}

TEST_P(Dynamics, KinematicsAgreeWithHomogeneousTransforms) {
  for (int k = 0; k < 20; ++k) {
    const Sample s = random_sample(model, random);
    const auto poses = forward_kinematics(tree_of<double>(model, s.parameters, s.state.position));
    const auto expected = lagrangian::placed_bodies(model, s.parameters, s.state.position);
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
      const auto centre = values_of<double>(model.bodies[i].centre_of_mass, s.parameters);
      EXPECT_LE((poses[i].orientation - expected[i].rotation).norm(), 1e-13);
      EXPECT_LE((poses[i].point(centre) - expected[i].centre).norm(), 1e-13);
    }
  }
}

TEST_P(Dynamics, PointVelocitiesAreTheDerivativesOfPositions) {
  for (int k = 0; k < 20; ++k) {
    const Sample s = random_sample(model, random);
    const Tree<double> tree = tree_of<double>(model, s.parameters, s.state.position);
    const auto poses = forward_kinematics(tree);
    const auto velocities = body_velocities(tree, s.state.velocity);
    std::vector<Dual<double>> path;
    for (std::size_t i = 0; i < s.state.position.size(); ++i) {
      path.push_back({s.state.position[i], {s.state.velocity[i]}});
    }
    const auto moving = lagrangian::placed_bodies(model, s.parameters, path);
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
      const auto centre = values_of<double>(model.bodies[i].centre_of_mass, s.parameters);
      const Vector3<double> velocity = point_velocity<double>(poses[i], velocities[i], centre);
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(velocity[axis], moving[i].centre[axis].partial[0], 1e-12);
    }
  }
}

TEST_P(Dynamics, ForcesOnPointsDoTheWorkOfTheirGeneralisedForces) {
  for (int k = 0; k < 20; ++k) {
    const Sample s = random_sample(model, random);
    const Tree<double> tree = tree_of<double>(model, s.parameters, s.state.position);
    const auto poses = forward_kinematics(tree);
    const auto velocities = body_velocities(tree, s.state.velocity);
    for (std::size_t body = 0; body < model.bodies.size(); ++body) {
      const Vector3<double> point = Vector3<double>::NullaryExpr([&] { return uniform(random, -1, 1); });
      const Vector3<double> force = Vector3<double>::NullaryExpr([&] { return uniform(random, -9, 9); });
      const double power = force.dot(point_velocity(poses[body], velocities[body], point));
      const auto generalised = generalised_force(tree, body, point, force);
      EXPECT_NEAR(vector(generalised).dot(vector(s.state.velocity)), power, 1e-11 * (1 + std::abs(power)));
    }
  }
}

TEST_P(Dynamics, InverseDynamicsIsMassMatrixTimesAccelerationPlusBias) {
  for (int k = 0; k < 100; ++k) {
    const Sample s = random_sample(model, random);
    const auto forces = inverse_dynamics<double>(model, s.parameters, s.state, s.acceleration);
    const auto bias = bias_forces<double>(model, s.parameters, s.state);
    const Eigen::MatrixXd mass = mass_matrix<double>(model, s.parameters, s.state);
    const double difference = (mass * vector(s.acceleration) + vector(bias) - vector(forces)).lpNorm<Eigen::Infinity>();
    EXPECT_LE(difference, 1e-12 * largest(forces));
  }
}

TEST_P(Dynamics, InverseDynamicsAgreesWithLagrange) {
  for (int k = 0; k < 5; ++k) {
    const Sample s = random_sample(model, random);
    const auto forces = inverse_dynamics<double>(model, s.parameters, s.state, s.acceleration);
    const auto expected = lagrangian::generalised_forces(model, s.parameters, s.state, s.acceleration);
    EXPECT_LE((vector(forces) - vector(expected)).lpNorm<Eigen::Infinity>(), 1e-12 * largest(expected));
  }
}

TEST_P(Dynamics, MassMatrixGivesTheBodiesKineticEnergy) {
  for (int k = 0; k < 50; ++k) {
    const Sample s = random_sample(model, random);
    const Eigen::MatrixXd mass = mass_matrix<double>(model, s.parameters, s.state);
    const Eigen::VectorXd velocity = vector(s.state.velocity);
    const auto energy = lagrangian::kinetic_energy<double>(model, s.parameters, s.state.position, s.state.velocity);
    EXPECT_NEAR(0.5 * velocity.dot(mass * velocity), energy, 1e-12 * energy);
    EXPECT_EQ(mass, mass.transpose());
    EXPECT_EQ(mass.llt().info(), Eigen::Success) << "positive definite";
  }
}

TEST(MassMatrix, GivesTheMomentumOfTheWholeTree) {
  const Model model = nine_segments();
  std::mt19937_64 random(11);
  for (int k = 0; k < 50; ++k) {
    const Sample s = random_sample(model, random);
    std::vector<Dual<double>> path;
    for (std::size_t i = 0; i < s.state.position.size(); ++i) {
      path.push_back({s.state.position[i], {s.state.velocity[i]}});
    }
    const auto bodies = lagrangian::placed_bodies(model, s.parameters, path);
    Vector3<double> momentum(0, 0, 0);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const auto mass = value_of<double>(model.bodies[i].mass, s.parameters);
      for (int axis = 0; axis < 3; ++axis) momentum[axis] += mass * bodies[i].centre[axis].partial[0];
    }
    const Eigen::MatrixXd mass = mass_matrix<double>(model, s.parameters, s.state);
    EXPECT_LE(((mass * vector(s.state.velocity)).head<3>() - momentum).norm(), 1e-11 * momentum.norm());
  }
}

TEST(MassMatrix, OfADoublePendulumIsTheTextbooks) {
  using namespace example;
  Model model{9.81, {}, {}, {}, {}, {}};
  const double m1 = 2;
  const double m2 = 3;
  const double l1 = 0.7;
  const double c1 = 0.3;
  const double c2 = 0.4;
  const double i1 = 0.05;
  const double i2 = 0.06;
  const double q1 = 0.4;
  const double q2 = -1.1;
  model.bodies.push_back(
      {"upper", {}, numbers(0, 0, 0), {rotation(2)}, number(m1), numbers(0, -c1, 0), numbers(1, 1, i1)});
  model.bodies.push_back(
      {"lower", 0, numbers(0, -l1, 0), {rotation(2)}, number(m2), numbers(0, -c2, 0), numbers(1, 1, i2)});
  const std::vector<double> none;
  const State<double> state{{q1, q2}, {0.9, 1.3}};
  const Eigen::MatrixXd mass = mass_matrix<double>(model, none, state);
  const double coupling = m2 * (c2 * c2 + l1 * c2 * std::cos(q2)) + i2;
  EXPECT_NEAR(mass(0, 0), m1 * c1 * c1 + i1 + m2 * (l1 * l1 + c2 * c2 + 2 * l1 * c2 * std::cos(q2)) + i2, 1e-14);
  EXPECT_NEAR(mass(0, 1), coupling, 1e-14);
  EXPECT_NEAR(mass(1, 1), m2 * c2 * c2 + i2, 1e-14);
  const auto bias = bias_forces<double>(model, none, state);
  const double centrifugal = m2 * l1 * c2 * std::sin(q2);
  const double lower_gravity = m2 * 9.81 * c2 * std::sin(q1 + q2);
  EXPECT_NEAR(bias[0],
              -centrifugal * (2 * 0.9 * 1.3 + 1.3 * 1.3) + (m1 * c1 + m2 * l1) * 9.81 * std::sin(q1) + lower_gravity,
              1e-13);
  EXPECT_NEAR(bias[1], centrifugal * 0.9 * 0.9 + lower_gravity, 1e-13);
}

TEST(IntervalDynamics, ContainsAllSampledParameters) {
  const Model model = nine_segments();
  const auto box = parameter_box(model, all_parameters(model));
  std::mt19937_64 random(13);
  for (int k = 0; k < 3; ++k) {
    const auto state = converted<Interval>(random_sample(model, random).state);
    const auto mass_enclosure = mass_matrix<Interval>(model, box, state);
    const auto bias_enclosure = bias_forces<Interval>(model, box, state);
    for (int l = 0; l < 20; ++l) {
      const Sample s = random_sample(model, random);
      const std::vector<Interval> point(s.parameters.begin(), s.parameters.end());
      const State<double> plain_state = [&] {
        State<double> plain;
        for (const Interval& q : state.position) plain.position.push_back(q.lower());
        for (const Interval& v : state.velocity) plain.velocity.push_back(v.lower());
        return plain;
      }();
      const auto mass = mass_matrix<Interval>(model, point, state);
      const auto bias = bias_forces<Interval>(model, point, state);
      const Eigen::MatrixXd plain_mass = mass_matrix<double>(model, s.parameters, plain_state);
      const auto plain_bias = bias_forces<double>(model, s.parameters, plain_state);
      for (int i = 0; i < 26; ++i) {
        for (int j = 0; j < 26; ++j) {
          EXPECT_TRUE(contains(mass_enclosure(i, j), mass(i, j))) << i << ", " << j;
          EXPECT_NEAR(mass(i, j).lower(), plain_mass(i, j), 1e-11);
          EXPECT_LE(mass(i, j).upper() - mass(i, j).lower(), 1e-11);
        }
        const auto row = static_cast<std::size_t>(i);
        EXPECT_TRUE(contains(bias_enclosure[row], bias[row])) << i;
        EXPECT_NEAR(bias[row].lower(), plain_bias[row], 1e-10);
        EXPECT_LE(bias[row].upper() - bias[row].lower(), 1e-10);
      }
    }
  }
}

TEST(IntervalDynamics, ContainsAllSampledStates) {
  const Model model = nine_segments();
  const auto parameters = nominal_parameters<Interval>(model);
  std::mt19937_64 random(15);
  for (const double radius : {1e-6, 1e-2, 0.5}) {
    const Sample centre = random_sample(model, random);
    const std::vector<Interval> acceleration(centre.acceleration.begin(), centre.acceleration.end());
    const auto around = [&](const std::vector<double>& values) {
      std::vector<Interval> ranges;
      ranges.reserve(values.size());
      for (const double v : values) ranges.emplace_back(v - radius, v + radius);
      return ranges;
    };
    const State<Interval> box{around(centre.state.position), around(centre.state.velocity)};
    const auto enclosure = inverse_dynamics<Interval>(model, parameters, box, acceleration);
    const auto poses = forward_kinematics(tree_of<Interval>(model, parameters, box.position));
    for (int sample = 0; sample < 50; ++sample) {
      State<double> inside;
      for (const Interval& q : box.position) inside.position.push_back(uniform(random, q.lower(), q.upper()));
      for (const Interval& v : box.velocity) inside.velocity.push_back(uniform(random, v.lower(), v.upper()));
      const auto point = converted<Interval>(inside);
      const auto forces = inverse_dynamics<Interval>(model, parameters, point, acceleration);
      for (std::size_t i = 0; i < forces.size(); ++i) EXPECT_TRUE(contains(enclosure[i], forces[i])) << i;
      const auto placed = forward_kinematics(tree_of<Interval>(model, parameters, point.position));
      for (std::size_t body = 0; body < poses.size(); ++body) {
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_TRUE(contains(poses[body].position[axis], placed[body].position[axis])) << body;
        }
      }
    }
  }
}

TEST(IntervalDynamics, UncertainParametersOccurOncePerEntryInUprightStance) {
  const Model model = nine_segments();
  const std::vector<std::uint32_t> uncertain{mp, px};
  const auto box = parameter_box(model, uncertain);
  const auto state = stance_state<Interval>(model);
  const auto mass = mass_matrix<Interval>(model, box, state);
  EXPECT_NEAR(mass(0, 0).lower(), 35 + 30.82, 1e-12);
  EXPECT_NEAR(mass(0, 0).upper(), 65 + 30.82, 1e-12);
  // The root's vertical translation and its rotation about z share the first moment about the hips.
  const double legs = 2 * (0.84 * 0.0342 + 0.36 * 0.135);
  EXPECT_NEAR(mass(1, 3).lower(), 35 * 0.05 + legs, 1e-12);
  EXPECT_NEAR(mass(1, 3).upper(), 65 * 0.10 + legs, 1e-12);
  const auto bias = bias_forces<Interval>(model, box, state);
  EXPECT_NEAR(bias[3].lower(), 9.81 * (35 * 0.05 + legs), 1e-11);
  EXPECT_NEAR(bias[3].upper(), 9.81 * (65 * 0.10 + legs), 1e-11);
}

/// The formulas of docs/stance.md §1 for the components, with the legs' moment from the table of segments.
std::array<double, wrench_size> reference_wrench(std::span<const double> p) {
  const double leg = 5.07 + p[mf];
  const double legs = 10.34 + p[mf] + 2 * 5.07;
  const double legs_moment = -(0.05 * legs - 2 * (0.84 * 0.0342 + 0.36 * 0.135));
  return {p[Fx], p[Fy] - 9.81 * (p[mp] + legs),
          0,     9.81 * (p[mp] * p[pz] + 0.0795 * (leg - 15.41)),
          0,     9.81 * (p[mp] * (0.05 - p[px]) - legs_moment)};
}

TEST(RootWrench, FollowsTheFormulasOfThePapersTables) {
  const Model model = nine_segments();
  std::mt19937_64 random(17);
  for (int k = 0; k < 1000; ++k) {
    Sample s = random_sample(model, random);
    s.parameters[mf] = uniform(random, 8, 12);
    const auto wrench = root_wrench<double>(model, s.parameters, stance_state<double>(model));
    const auto expected = reference_wrench(s.parameters);
    for (std::size_t c = 0; c < wrench_size; ++c) EXPECT_NEAR(wrench[c], expected[c], 1e-11) << c;
  }
}

TEST(RootWrench, IsAsTightAsEachParameterOnceAllows) {
  const Model model = nine_segments();
  const auto state = stance_state<Interval>(model);
  const auto wrench = root_wrench<Interval>(model, parameter_box(model, all_parameters(model)), state);
  const auto expect_range = [&](std::size_t component, double lower, double upper) {
    EXPECT_NEAR(wrench[component].lower(), lower, 1e-10) << component;
    EXPECT_NEAR(wrench[component].upper(), upper, 1e-10) << component;
  };
  const double c6 = 9.81 * (0.05 * 30.82 - 2 * (0.84 * 0.0342 + 0.36 * 0.135));
  expect_range(0, 0, 200);
  expect_range(1, -9.81 * (65 + 30.82), 50 - 9.81 * (35 + 30.82));
  expect_range(2, 0, 0);
  expect_range(3, -9.81 * 65 * 0.05, 9.81 * 65 * 0.05);
  expect_range(4, 0, 0);
  expect_range(5, c6 - 9.81 * 65 * 0.05, c6);
  EXPECT_TRUE(contains(Interval(-18.2826, 13.6001), wrench[5]));
}

TEST(RootWrench, DoesNotDependOnTheRootsTranslation) {
  const Model model = nine_segments();
  const auto parameters = nominal_parameters<double>(model);
  auto state = stance_state<double>(model);
  const auto before = root_wrench<double>(model, parameters, state);
  state.position[0] = 3;
  state.position[2] = -7;
  EXPECT_EQ(root_wrench<double>(model, parameters, state), before);
}

TEST(RootWrench, BalancesTheRootsGeneralisedForcesAtRest) {
  Model model = nine_segments();
  std::mt19937_64 random(19);
  Sample s = random_sample(model, random);
  for (std::size_t i = 0; i < 6; ++i) s.state.position[i] = 0;
  s.parameters[Fx] = s.parameters[Fy] = 0;
  model.bodies.front().offset = example::numbers(0, 0, 0);
  const auto wrench = root_wrench<double>(model, s.parameters, s.state);
  const auto gravity = bias_forces<double>(model, s.parameters, at_rest(s.state));
  // The root's joints: translations x, y, z, then rotations z, x, y.
  const std::array<double, 6> root{gravity[0], gravity[1], gravity[2], gravity[4], gravity[5], gravity[3]};
  for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(wrench[c], -root[c], 1e-11) << c;
}

TEST(DualDynamics, DerivativesByParametersAgreeWithCentralDifferences) {
  const Model model = nine_segments();
  std::mt19937_64 random(23);
  for (const std::uint32_t parameter : {Fx, Fy, mp, px, py, pz, mf}) {
    const Sample s = random_sample(model, random);
    const auto variables = as_variables<1, double>(s.parameters, {parameter});
    const auto state = converted<Dual<double>>(s.state);
    const auto mass = mass_matrix<Dual<double>>(model, variables, state);
    const auto bias = bias_forces<Dual<double>>(model, variables, state);
    const auto wrench = root_wrench<Dual<double>>(model, variables, state);
    const double step = 1e-4;
    auto above = s.parameters;
    auto below = s.parameters;
    above[parameter] += step;
    below[parameter] -= step;
    const auto difference = [&](double up, double down) { return (up - down) / (2 * step); };
    const Eigen::MatrixXd mass_above = mass_matrix<double>(model, above, s.state);
    const Eigen::MatrixXd mass_below = mass_matrix<double>(model, below, s.state);
    const auto bias_above = bias_forces<double>(model, above, s.state);
    const auto bias_below = bias_forces<double>(model, below, s.state);
    const auto wrench_above = root_wrench<double>(model, above, s.state);
    const auto wrench_below = root_wrench<double>(model, below, s.state);
    for (int i = 0; i < 26; ++i) {
      for (int j = 0; j < 26; ++j) {
        EXPECT_NEAR(mass(i, j).partial[0], difference(mass_above(i, j), mass_below(i, j)), 1e-6);
      }
      const auto row = static_cast<std::size_t>(i);
      EXPECT_NEAR(bias[row].partial[0], difference(bias_above[row], bias_below[row]), 1e-6);
    }
    for (std::size_t c = 0; c < wrench_size; ++c) {
      EXPECT_NEAR(wrench[c].partial[0], difference(wrench_above[c], wrench_below[c]), 1e-6);
    }
  }
}

TEST(DualDynamics, EnclosesSampledDerivatives) {
  const Model model = nine_segments();
  const auto box = parameter_box(model, all_parameters(model));
  constexpr std::array<std::uint32_t, 5> by{mp, px, py, pz, mf};
  using D = Dual<Interval, by.size()>;
  std::mt19937_64 random(29);
  const auto state = converted<D>(random_sample(model, random).state);
  const auto mass_enclosure = mass_matrix<D>(model, as_variables<by.size(), Interval>(box, by), state);
  const auto bias_enclosure = bias_forces<D>(model, as_variables<by.size(), Interval>(box, by), state);
  const auto upright = stance_state<D>(model);
  const auto wrench_enclosure = root_wrench<D>(model, as_variables<by.size(), Interval>(box, by), upright);
  for (int sample = 0; sample < 20; ++sample) {
    const Sample s = random_sample(model, random);
    const std::vector<Interval> point(s.parameters.begin(), s.parameters.end());
    const auto variables = as_variables<by.size(), Interval>(point, by);
    const auto mass = mass_matrix<D>(model, variables, state);
    const auto bias = bias_forces<D>(model, variables, state);
    const auto wrench = root_wrench<D>(model, variables, upright);
    for (std::size_t k = 0; k < by.size(); ++k) {
      for (int i = 0; i < 26; ++i) {
        for (int j = 0; j < 26; ++j) {
          EXPECT_TRUE(contains(mass_enclosure(i, j).partial[k], mass(i, j).partial[k]));
        }
        const auto row = static_cast<std::size_t>(i);
        EXPECT_TRUE(contains(bias_enclosure[row].partial[k], bias[row].partial[k]));
      }
      for (std::size_t c = 0; c < wrench_size; ++c) {
        EXPECT_TRUE(contains(wrench_enclosure[c].partial[k], wrench[c].partial[k]));
      }
    }
  }
}

TEST(DualDynamics, GivesTheSensitivitiesOfThePapersTable3) {
  const Model model = nine_segments();
  const std::vector<std::uint32_t> uncertain{mp, px, Fx};
  const auto box = parameter_box(model, uncertain);
  const auto variables = as_variables<4, Interval>(box, {mp, px, Fx, mf});
  using D = Dual<Interval, 4>;
  const auto wrench = root_wrench<D>(model, variables, stance_state<D>(model));
  const auto expect_range = [&](std::size_t component, std::size_t parameter, double lower, double upper) {
    EXPECT_NEAR(wrench[component].partial[parameter].lower(), lower, 1e-12);
    EXPECT_NEAR(wrench[component].partial[parameter].upper(), upper, 1e-12);
  };
  expect_range(0, 2, 1, 1);
  expect_range(1, 0, -9.81, -9.81);
  expect_range(5, 0, -9.81 * 0.05, 0);
  expect_range(5, 1, -9.81 * 65, -9.81 * 35);
  // Table 4's third column is by the femur's mass.
  expect_range(1, 3, -9.81, -9.81);
  expect_range(3, 3, 9.81 * 0.0795, 9.81 * 0.0795);
  expect_range(5, 3, 9.81 * 0.05, 9.81 * 0.05);
}

}  // namespace
}  // namespace verisq::stance
