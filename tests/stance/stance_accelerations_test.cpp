/// Accelerations of a body on the ground against dynamics of another formulation: free bodies, each with its own six
/// accelerations, held together by wrenches; no mass matrix of joints and no recursion.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/stance.hpp>
#include <verisq/stance_equilibrium.hpp>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/stance_example.hpp"

namespace verisq::stance {
namespace {

using Eigen::Matrix3d, Eigen::MatrixXd, Eigen::Vector3d, Eigen::VectorXd;

namespace free_bodies {

/// A joint's axis in the world, and a point on it.
struct Axis {
  bool turns;
  Vector3d direction, through;
};

struct Placed {
  Matrix3d orientation;
  Vector3d origin, centre;
  std::vector<Axis> axes;  ///< of its own joints
};

struct Numbers {
  const Model& model;
  const std::vector<double>& parameters;

  [[nodiscard]] double operator()(const Quantity& q) const {
    return q.parameter ? parameters[*q.parameter] : q.nominal;
  }
  [[nodiscard]] Vector3d operator()(const QuantityVector& q) const {
    return {(*this)(q[0]), (*this)(q[1]), (*this)(q[2])};
  }
};

std::vector<Placed> placed(const Numbers& number, const std::vector<double>& positions) {
  std::vector<Placed> result;
  std::size_t next = 0;
  for (const Body& body : number.model.bodies) {
    Placed at = body.parent ? result[*body.parent] : Placed{Matrix3d::Identity(), Vector3d::Zero(), {}, {}};
    at.axes.clear();
    at.origin += at.orientation * number(body.offset);
    for (const Joint& joint : body.joints) {
      const Vector3d direction = at.orientation.col(joint.axis);
      at.axes.push_back({joint.kind == JointKind::rotation, direction, at.origin});
      const double position = positions[next++];
      if (joint.kind == JointKind::rotation)
        at.orientation = at.orientation * Eigen::AngleAxisd(position, Vector3d::Unit(joint.axis)).toRotationMatrix();
      else
        at.origin += position * direction;
    }
    at.centre = at.origin + at.orientation * number(body.centre_of_mass);
    result.push_back(at);
  }
  return result;
}

/// A force on a body, and its moment about the body's centre of mass.
struct Load {
  Vector3d moment = Vector3d::Zero(), force = Vector3d::Zero();

  void add(const Vector3d& acting, const Vector3d& lever) {
    force += acting;
    moment += lever.cross(acting);
  }
};

/// The pressure of the ground: half of the stiffness at each of Gauss's two points, at the lowest point of the disc
/// there, by plain trigonometry of its tilt.
void press(const Numbers& number, const std::vector<Placed>& bodies, std::vector<Load>& loads) {
  for (const ContactCylinder& cylinder : number.model.cylinders) {
    const Placed& body = bodies[cylinder.body];
    const Vector3d axis =
        body.orientation * Vector3d(cylinder.axis[0], cylinder.axis[1], cylinder.axis[2]).normalized();
    const Vector3d middle = body.origin + body.orientation * number(cylinder.centre);
    const Vector3d level = axis.cross(Vector3d::UnitY()).normalized();
    const Vector3d down = axis.cross(level).normalized() * number(cylinder.radius);  // a radius of the disc
    for (const double side : {-1.0, 1.0}) {
      Vector3d lowest = middle + side * cylinder.half_length / std::numbers::sqrt3 * axis;
      lowest += down[1] < 0 ? down : Vector3d(-down);
      if (lowest[1] >= 0) continue;
      const double force = 0.5 * number(cylinder.stiffness) * std::pow(-lowest[1], cylinder.exponent);
      loads[cylinder.body].add(force * Vector3d::UnitY(), lowest - body.centre);
    }
  }
}

struct Given {
  std::vector<double> positions, torques;
  bool on_ground;
};

/// At rest. Unknowns: of each body its angular acceleration and that of its centre, and the wrench on it, about its
/// origin, by its parent; of each joint its acceleration.
std::vector<double> accelerations(const Model& model, const std::vector<double>& parameters, const Given& given) {
  const Numbers number{model, parameters};
  const std::vector<Placed> bodies = placed(number, given.positions);
  std::vector<Load> loads(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i)
    loads[i].add(Vector3d(0, -model.gravity * number(model.bodies[i].mass), 0), Vector3d::Zero());
  Vector3d reference = Vector3d::Zero();
  for (const Axis& axis : bodies[0].axes) {
    const auto j = static_cast<std::size_t>(&axis - bodies[0].axes.data());
    if (!axis.turns) reference += given.positions[j] * axis.direction;
  }
  loads[0].add(number(model.applied.force), reference - bodies[0].centre);
  if (given.on_ground) press(number, bodies, loads);

  const auto count = static_cast<Eigen::Index>(bodies.size());
  const auto joints = static_cast<Eigen::Index>(model.degrees_of_freedom());
  const auto motion = [](std::size_t body) { return 6 * static_cast<Eigen::Index>(body); };
  const auto wrench = [&](std::size_t body) { return 6 * count + 6 * static_cast<Eigen::Index>(body); };
  MatrixXd a = MatrixXd::Zero(12 * count + joints, 12 * count + joints);
  VectorXd b = VectorXd::Zero(a.rows());
  const auto cross = [](const Vector3d& v) {
    Matrix3d m;
    m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
    return m;
  };
  Eigen::Index joint = 12 * count;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    const Placed& at = bodies[i];
    // Newton and Euler: what the parent's wrench and the loads give, less what the children take.
    const Eigen::Index given_by = wrench(i);
    a.block<3, 3>(given_by, motion(i)) =
        at.orientation * number(body.inertia).asDiagonal() * at.orientation.transpose();
    a.block<3, 3>(given_by + 3, motion(i) + 3) = number(body.mass) * Matrix3d::Identity();
    b.segment<3>(given_by) = loads[i].moment;
    b.segment<3>(given_by + 3) = loads[i].force;
    const auto take = [&](std::size_t from, const Placed& of, double sign) {
      const Eigen::Index r = wrench(from);
      a.block<3, 3>(r, given_by) = -sign * Matrix3d::Identity();
      a.block<3, 3>(r, given_by + 3) = -sign * cross(at.origin - of.centre);
      a.block<3, 3>(r + 3, given_by + 3) = -sign * Matrix3d::Identity();
    };
    take(i, at, 1);
    if (body.parent) take(*body.parent, bodies[*body.parent], -1);
    // The body moves as its parent and its joints say.
    const Eigen::Index moving = motion(i);
    a.block<6, 6>(moving, moving).setIdentity();
    if (body.parent) {
      const Eigen::Index carrier = motion(*body.parent);
      a.block<3, 3>(moving, carrier) = -Matrix3d::Identity();
      a.block<3, 3>(moving + 3, carrier + 3) = -Matrix3d::Identity();
      a.block<3, 3>(moving + 3, carrier) = cross(at.centre - bodies[*body.parent].centre);
    }
    for (const Axis& axis : at.axes) {
      const Vector3d turned = axis.turns ? axis.direction : Vector3d(Vector3d::Zero());
      const Vector3d shifted = axis.turns ? axis.direction.cross(at.centre - axis.through) : axis.direction;
      a.block<3, 1>(moving, joint) = -turned;
      a.block<3, 1>(moving + 3, joint) = -shifted;
      // Along the joint the parent's wrench is its torque.
      a.block<1, 3>(joint, given_by) = turned.transpose();
      a.block<1, 3>(joint, given_by + 3) =
          axis.turns ? Eigen::RowVector3d(axis.direction.cross(at.origin - axis.through).transpose())
                     : Eigen::RowVector3d(axis.direction.transpose());
      b[joint] = given.torques[static_cast<std::size_t>(joint - 12 * count)];
      ++joint;
    }
  }
  const VectorXd solution = a.fullPivLu().solve(b);
  return {solution.end() - joints, solution.end()};
}

}  // namespace free_bodies

Model standing_model() {
  return read_model(places::example("standing.xml"));
}

std::size_t joint_named(const Model& model, const std::string& name) {
  const std::vector<std::string> names = joint_names(model);
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

std::vector<double> file_positions(const Model& model) {
  std::vector<double> result;
  for (const Body& body : model.bodies) {
    for (const Joint& joint : body.joints) result.push_back(joint.position);
  }
  return result;
}

std::vector<double> nominal_of(const Model& model) {
  std::vector<double> values;
  for (const Parameter& parameter : model.parameters) values.push_back(parameter.nominal);
  return values;
}

/// All corners, then points with every third coordinate at an end: extremes lie there.
std::vector<std::vector<double>> points_of(const Model& model, UncertainSet uncertain, int count) {
  std::mt19937_64 random(5);
  std::vector<std::vector<double>> points;
  const unsigned corners = 1U << uncertain.size();
  for (unsigned corner = 0; corner < corners; ++corner) {
    points.push_back(nominal_of(model));
    for (unsigned k = 0; k < uncertain.size(); ++k) {
      const Enclosure& range = model.parameters[uncertain[k]].range;
      points.back()[uncertain[k]] = ((corner >> k) & 1U) != 0 ? range.hi : range.lo;
    }
  }
  for (int i = 0; i < count; ++i) {
    points.push_back(nominal_of(model));
    for (const std::uint32_t k : uncertain) {
      const Enclosure& range = model.parameters[k].range;
      const bool at_end = std::uniform_int_distribution<int>(0, 2)(random) == 0;
      const bool upper = std::bernoulli_distribution()(random);
      points.back()[k] =
          at_end ? (upper ? range.hi : range.lo) : std::uniform_real_distribution<double>(range.lo, range.hi)(random);
    }
  }
  return points;
}

/// Expects the free bodies' accelerations at samples within the enclosures, which are to be at most a tenth wider than
/// the samples' hull.
void expect_enclosed(const Model& model, const Instant& at, const free_bodies::Given& given, UncertainSet uncertain) {
  constexpr double most = 1.1;
  const std::vector<Enclosure> enclosed = accelerations(model, uncertain, at, {});
  const std::vector<std::string> names = joint_names(model);
  const double rounding = 1e-9 * std::ranges::max(enclosed, {}, &Enclosure::hi).hi;
  std::vector<Enclosure> hull(enclosed.size(), {infinity, -infinity});
  for (const std::vector<double>& p : points_of(model, uncertain, 300)) {
    const std::vector<double> a = free_bodies::accelerations(model, p, given);
    for (std::size_t k = 0; k < a.size(); ++k) {
      ASSERT_GE(a[k], enclosed[k].lo - rounding) << names[k];
      ASSERT_LE(a[k], enclosed[k].hi + rounding) << names[k];
      hull[k] = {std::fmin(hull[k].lo, a[k]), std::fmax(hull[k].hi, a[k])};
    }
  }
  for (std::size_t k = 0; k < hull.size(); ++k)
    EXPECT_LE(enclosed[k].width(), most * hull[k].width() + rounding) << names[k];
}

/// In contact, with exact positions.
free_bodies::Given in_contact(std::vector<double> positions) {
  const std::size_t size = positions.size();
  return {std::move(positions), std::vector<double>(size, 0.0), true};
}

TEST(AccelerationsOnTheGround, AreThoseOfFreeBodiesInFreeFallToo) {
  const Model model = nine_segments();
  free_bodies::Given given = in_contact(file_positions(model));
  given.on_ground = false;
  const std::vector<std::uint32_t> four{Fx, mp, py, pz};
  for (const std::vector<double>& p : points_of(model, four, 20)) {
    const std::vector<double> expected = free_bodies::accelerations(model, p, given);
    const std::vector<double> a = sampled_accelerations(model, p);
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], expected[k], 1e-8) << k;
  }
}

/// The forefeet are deep in the ground, the hindfeet touch it at large radii alone: a kink within the box.
TEST(AccelerationsOnTheGround, OfFeetThatMayTouch) {
  const Model model = nine_segments();
  const std::vector<std::uint32_t> six{Fx, mp, py, pz, rff, rhf};
  expect_enclosed(model, instant(model, AccelerationCase::contact), in_contact(file_positions(model)), six);
}

TEST(AccelerationsOnTheGround, OfTheBodyThatStandsInContact) {
  const Model model = standing_model();
  expect_enclosed(model, instant(model, AccelerationCase::contact), in_contact(file_positions(model)),
                  uncertain_parameters(model));
}

TEST(AccelerationsOnTheGround, OfALeaningBodyWithControllersAndAnExponent) {
  Model model = standing_model();
  for (ContactCylinder& cylinder : model.cylinders) {
    cylinder.exponent = 1.5;
    cylinder.stiffness.nominal = 1e6;
  }
  // An uncertain radius acts by the lean, too.
  model.parameters.push_back({"r", "m", "radius of the right hindfoot", 0.085, {0.08, 0.09}});
  const auto radius = static_cast<std::uint32_t>(model.parameters.size() - 1);
  model.cylinders[0].radius = {0.085, {0.08, 0.09}, radius};
  const std::vector<std::pair<std::string, double>> moves{{"pelvis ty", 0.95},
                                                          {"pelvis rz", 0.03},
                                                          {"pelvis rx", 0.05},
                                                          {"right hindfoot rx", -0.1},
                                                          {"left tibia rz", -0.2}};
  std::vector<JointPosition> elsewhere;
  free_bodies::Given given = in_contact(file_positions(model));
  for (const auto& [name, position] : moves) {
    elsewhere.push_back(joint_position(model, name, position));
    given.positions[elsewhere.back().joint] = position;
  }
  given.torques[joint_named(model, "right hindfoot rx")] = 2000 * 0.1;
  given.torques[joint_named(model, "left tibia rz")] = 2000 * 0.2;
  const Instant at = instant(model, AccelerationCase::contact, elsewhere);
  expect_enclosed(model, at, given, uncertain_parameters(model));
}

TEST(AccelerationsOnTheGround, OfFeetThatAreSomewhere) {
  Model model = standing_model();
  model.parameters.push_back({"c", "m", "x of the right hindfoot's cylinder", 0, {-0.01, 0.01}});
  model.cylinders[0].centre[0] = {0, {-0.01, 0.01}, static_cast<std::uint32_t>(model.parameters.size() - 1)};
  for (const char* name : {"px", "py", "pz"}) {
    const std::uint32_t i = parameter_named(model, name, "{}{}");
    model = narrowed(model, i, {model.parameters[i].nominal, model.parameters[i].nominal});
  }
  expect_enclosed(model, instant(model, AccelerationCase::contact), in_contact(file_positions(model)),
                  uncertain_parameters(model));
}

free_bodies::Given in_the_middle_of(const Instant& at) {
  free_bodies::Given given{{}, {}, true};
  for (const Enclosure& position : at.positions) given.positions.push_back(std::midpoint(position.lo, position.hi));
  for (const Enclosure& torque : at.torques) given.torques.push_back(std::midpoint(torque.lo, torque.hi));
  return given;
}

TEST(AccelerationsOnTheGround, TheNominalBodyStandsStill) {
  const Model model = standing_model();
  const Instant at = instant(model, AccelerationCase::standing);
  for (const Enclosure& a : accelerations(model, {}, at, {})) {
    EXPECT_TRUE(a.contains(0.0));
    EXPECT_LE(a.width(), 1e-6);
  }
  for (const double a : free_bodies::accelerations(model, nominal_of(model), in_the_middle_of(at)))
    EXPECT_NEAR(a, 0.0, 1e-6);
}

TEST(AccelerationsOnTheGround, OtherBodiesInThePlaceOfTheOneThatStands) {
  const Model model = standing_model();
  const Instant at = instant(model, AccelerationCase::standing);
  expect_enclosed(model, at, in_the_middle_of(at), uncertain_parameters(model));
}

TEST(AccelerationsOnTheGround, AreThoseOfAFallAboveIt) {
  const Model model = nine_segments();
  const std::vector<JointPosition> high{joint_position(model, "pelvis ty", 3.0)};
  const std::vector<std::uint32_t> two{mp, rff};
  EXPECT_EQ(accelerations(model, two, instant(model, AccelerationCase::contact, high), {.cells = 4}),
            accelerations(model, two, instant(model, AccelerationCase::fall, high), {.cells = 4}));
}

std::string refusal_of(const Model& model, AccelerationCase at, const std::vector<JointPosition>& elsewhere) {
  try {
    (void)instant(model, at, elsewhere);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "";
}

TEST(AccelerationsOnTheGround, RefuseWhatHasNoMeaning) {
  Model model = standing_model();
  EXPECT_EQ(refusal_of(model, AccelerationCase::fall, {{99, 0.0}}), "accelerations: the model has no joint 99");
  EXPECT_EQ(refusal_of(model, AccelerationCase::contact, {{1, 0.9}, {1, 0.9}}),
            "accelerations: pelvis ty is given twice");
  EXPECT_EQ(refusal_of(model, AccelerationCase::contact, {{1, infinity}}), "accelerations: pelvis ty is to be at inf");
  EXPECT_EQ(refusal_of(model, AccelerationCase::standing, {{1, 0.9}}),
            "accelerations: pelvis ty is what the equilibrium says, and not to be given");
  EXPECT_EQ(refusal_of(model, AccelerationCase::standing, {{0, 0.1}, {5, 0.2}}), "");
  EXPECT_EQ(refusal_of(model, AccelerationCase::standing, {{joint_named(model, "right tibia rz"), -1.0}}),
            "accelerations: the nominal body is not proven to stand on all of its cylinders");
  EXPECT_THAT(refusal_of(model, AccelerationCase::contact, {{4, std::numbers::pi / 2}}),
              testing::HasSubstr("the axis of the cylinder right hindfoot is vertical"));
  EXPECT_EQ(refusal_of(model, AccelerationCase::fall, {{4, std::numbers::pi / 2}}), "");
  for (Controller& controller : model.controllers) controller.integral = 0.0;
  EXPECT_EQ(refusal_of(model, AccelerationCase::standing, {}),
            "accelerations: right femur rz has no integral control, which is to hold it");
  EXPECT_THAT(refusal_of(nine_segments(), AccelerationCase::standing, {}), testing::HasSubstr("friction alone"));
}

}  // namespace
}  // namespace verisq::stance
