/// Proven motions against an ordinary integration of another formulation: nine free bodies, each with its own
/// coordinates, held together by forces at the joints (Lagrange's equations of the first kind), Runge and Kutta.
#include "verisq/stance_motion.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <verisq/error.hpp>
#include <verisq/stance_choice.hpp>
#include <verisq/stance_equilibrium.hpp>
#include <verisq/stance_file.hpp>

#include "tests/fixtures/requested_count.hpp"
#include "verify/stance/taylor_model.hpp"

namespace verisq::stance {
namespace {

using Plane = Eigen::Vector2d;
using verify::Interval;

Model standing_model() {
  return read_model(VERISQ_EXAMPLES "/standing.xml");
}

std::vector<std::uint32_t> four_of(const Model& model) {
  const std::vector<std::string> names{"mp", "px", "py", "k"};
  return uncertain_parameters(model, names);
}

/// The nine bodies of examples/standing.xml in the sagittal plane: x, y of the centres of mass and angles. Its joints'
/// errors are measured from 0, where that file has them.
class FreeBodies {
 public:
  FreeBodies(const Model& model, std::vector<double> parameters, std::optional<Push> push)
      : model_(model), parameters_(std::move(parameters)), push_(push) {}

  /// x, y, pitch, then the angle of each leg joint by body; then their rates; integrals; bristles of all cylinders.
  struct State {
    Eigen::VectorXd angles, rates, integrals, bristles;  ///< bodies' joints: the root has x, y, pitch first
  };

  [[nodiscard]] std::size_t bodies() const { return model_.bodies.size(); }

  [[nodiscard]] State derivative(const State& s, double time) {
    place(s);
    const auto n = static_cast<Eigen::Index>(3 * bodies());
    const auto joints = static_cast<Eigen::Index>(2 * (bodies() - 1));
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + joints, n + joints);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n + joints);
    State result{s.rates, Eigen::VectorXd::Zero(s.rates.size()), Eigen::VectorXd::Zero(s.integrals.size()),
                 Eigen::VectorXd::Zero(s.bristles.size())};
    for (std::size_t b = 0; b < bodies(); ++b) {
      const auto i = static_cast<Eigen::Index>(3 * b);
      const double mass = value(model_.bodies[b].mass);
      system(i, i) = system(i + 1, i + 1) = mass;
      system(i + 2, i + 2) = value(model_.bodies[b].inertia[2]);
      right[i + 1] -= mass * model_.gravity;
    }
    // A joint: the two bodies' points have the same acceleration; the force that sees to it acts on both.
    for (std::size_t b = 1; b < bodies(); ++b) {
      const std::size_t p = *model_.bodies[b].parent;
      const auto row = n + static_cast<Eigen::Index>(2 * (b - 1));
      const auto add = [&](std::size_t body, const Plane& lever, double sign) {
        const auto i = static_cast<Eigen::Index>(3 * body);
        const Eigen::Matrix<double, 2, 3> jacobian{{sign, 0.0, -sign * lever.y()}, {0.0, sign, sign * lever.x()}};
        system.block<2, 3>(row, i) = jacobian;
        system.block<3, 2>(i, row) = jacobian.transpose();
        right.segment<2>(row) += sign * omega_[body] * omega_[body] * lever;
      };
      add(b, origin_[b] - centre_[b], 1.0);
      add(p, origin_[b] - centre_[p], -1.0);
    }
    for (std::size_t c = 0; c < model_.cylinders.size(); ++c) add_contact(c, s, right, result);
    if (push_ && time >= push_->start && time <= push_->start + push_->duration) {
      const double wave = std::sin(M_PI * (time - push_->start) / push_->duration);
      const double force = push_->force * wave * wave;
      const Plane at = origin_[0] + Plane(-value(model_.bodies[0].offset[0]), -value(model_.bodies[0].offset[1]));
      right[0] += force;
      right[2] -= (at - centre_[0]).y() * force;
    }
    for (std::size_t i = 0; i < model_.controllers.size(); ++i) {
      const Controller& c = model_.controllers[i];
      const Joint& joint = model_.bodies[c.body].joints[c.joint];
      if (joint.kind != JointKind::rotation || joint.axis != 2) continue;
      const auto b = static_cast<Eigen::Index>(c.body);
      const double torque =
          -c.proportional * s.angles[2 + b] - c.integral * s.integrals[b] - c.derivative * s.rates[2 + b];
      result.integrals[b] = s.angles[2 + b];
      right[3 * b + 2] += torque;
      right[3 * static_cast<Eigen::Index>(*model_.bodies[c.body].parent) + 2] -= torque;
    }
    const Eigen::VectorXd solution = system.partialPivLu().solve(right);
    // Back to the joints: of the root's origin, and differences of angles.
    const Plane lever = origin_[0] - centre_[0];
    result.rates[0] = solution[0] - solution[2] * lever.y() - omega_[0] * omega_[0] * lever.x();
    result.rates[1] = solution[1] + solution[2] * lever.x() - omega_[0] * omega_[0] * lever.y();
    result.rates[2] = solution[2];
    for (std::size_t b = 1; b < bodies(); ++b) {
      const auto i = static_cast<Eigen::Index>(b);
      result.rates[2 + i] = solution[3 * i + 2] - solution[3 * static_cast<Eigen::Index>(*model_.bodies[b].parent) + 2];
    }
    return result;
  }

  /// Of the classical method of fourth order.
  void step(State& s, double time, double h) {
    const auto moved = [](const State& a, const State& b, double factor) {
      return State{a.angles + factor * b.angles, a.rates + factor * b.rates, a.integrals + factor * b.integrals,
                   a.bristles + factor * b.bristles};
    };
    const State k1 = derivative(s, time);
    const State k2 = derivative(moved(s, k1, 0.5 * h), time + 0.5 * h);
    const State k3 = derivative(moved(s, k2, 0.5 * h), time + 0.5 * h);
    const State k4 = derivative(moved(s, k3, h), time + h);
    s = moved(moved(moved(moved(s, k1, h / 6.0), k2, h / 3.0), k3, h / 3.0), k4, h / 6.0);
  }

  /// At the nominal equilibrium, lifted.
  [[nodiscard]] static State start(const Model& model, double lift) {
    const Equilibrium nominal = equilibrium(model, {}, {});
    const auto middle = [](const Enclosure& e) { return 0.5 * (e.lo + e.hi); };
    const auto bodies = static_cast<Eigen::Index>(model.bodies.size());
    State s{Eigen::VectorXd::Zero(2 + bodies), Eigen::VectorXd::Zero(2 + bodies), Eigen::VectorXd::Zero(bodies),
            Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.cylinders.size()))};
    constexpr std::size_t ty = 1;
    constexpr std::size_t rz = 3;
    s.angles[1] = middle(nominal.standing->positions[ty]) + lift;
    s.angles[2] = middle(nominal.standing->positions[rz]);
    std::size_t first = model.bodies.front().joints.size();
    for (std::size_t b = 1; b < model.bodies.size(); ++b) {
      for (const Controller& c : model.controllers) {
        const Joint& joint = model.bodies[c.body].joints[c.joint];
        if (c.body == b && joint.axis == 2)
          s.integrals[static_cast<Eigen::Index>(b)] = -middle(nominal.standing->torques[first + c.joint]) / c.integral;
      }
      first += model.bodies[b].joints.size();
    }
    return s;
  }

 private:
  [[nodiscard]] double value(const Quantity& q) const { return q.parameter ? parameters_[*q.parameter] : q.nominal; }
  [[nodiscard]] Plane value(const QuantityVector& v) const { return {value(v[0]), value(v[1])}; }

  void place(const State& s) {
    const std::size_t n = bodies();
    angle_.assign(n, 0.0);
    omega_.assign(n, 0.0);
    origin_.assign(n, Plane::Zero());
    centre_ = velocity_ = origin_;
    for (std::size_t b = 0; b < n; ++b) {
      const Body& body = model_.bodies[b];
      const auto i = static_cast<Eigen::Index>(b);
      angle_[b] = s.angles[2 + i];
      omega_[b] = s.rates[2 + i];
      if (body.parent) {
        const std::size_t p = *body.parent;
        const Plane arm = Eigen::Rotation2Dd(angle_[p]) * value(body.offset);
        origin_[b] = origin_[p] + arm;
        velocity_[b] = velocity_[p] + omega_[p] * Plane(-arm.y(), arm.x());
        angle_[b] += angle_[p];
        omega_[b] += omega_[p];
      } else {
        origin_[b] = value(body.offset) + s.angles.head<2>();
        velocity_[b] = s.rates.head<2>();
      }
      centre_[b] = origin_[b] + Eigen::Rotation2Dd(angle_[b]) * value(body.centre_of_mass);
    }
  }

  void add_contact(std::size_t index, const State& s, Eigen::VectorXd& right, State& result) const {
    const ContactCylinder& c = model_.cylinders[index];
    const auto i = static_cast<Eigen::Index>(index);
    const Plane axis = origin_[c.body] + Eigen::Rotation2Dd(angle_[c.body]) * value(c.centre);
    const double depth = value(c.radius) - axis.y();
    const Plane lowest(axis.x(), axis.y() - value(c.radius));
    const Plane arm = lowest - origin_[c.body];
    const Plane slip = velocity_[c.body] + omega_[c.body] * Plane(-arm.y(), arm.x());
    double normal = 0.0;
    if (depth > 0.0) {
      const double e = value(c.normal_restitution);
      normal = value(c.stiffness) * std::pow(depth, c.exponent) *
               std::max(0.0, 1.0 - damping_of(e) * slip.y() / value(c.impact_velocity));
    }
    const double ratio = slip.x() / c.stribeck_velocity;
    const double limit = normal * (value(c.dynamic_friction) +
                                   (value(c.static_friction) - value(c.dynamic_friction)) * std::exp(-ratio * ratio));
    const double trial = c.bristle_stiffness * s.bristles[i] + c.bristle_damping * slip.x();
    const double limited = std::clamp(trial, -limit, limit);
    result.bristles[i] = (limited - c.bristle_stiffness * s.bristles[i]) / c.bristle_damping;
    const Plane lever = lowest - centre_[c.body];
    const auto row = static_cast<Eigen::Index>(3 * c.body);
    right[row] -= limited;
    right[row + 1] += normal;
    right[row + 2] += lever.x() * normal + lever.y() * limited;
  }

  /// ln((1 + D)/(1 - D e)) = D (1 + e), by bisection between 1/e - 1 and 1/e.
  static double damping_of(double e) {
    double low = 1.0 / e - 1.0;
    double high = 1.0 / e;
    for (int i = 0; i < 60; ++i) {
      const double d = 0.5 * (low + high);
      (std::log1p(d) - std::log1p(-d * e) < d * (1.0 + e) ? low : high) = d;
    }
    return low;
  }

  const Model& model_;
  std::vector<double> parameters_;
  std::optional<Push> push_;
  std::vector<double> angle_, omega_;
  std::vector<Plane> origin_, centre_, velocity_;
};

/// Steps of `longest` s are below 2.78/19,400, where the method is stable. The right leg's bodies come first.
void expect_contained(const Model& model, const std::vector<double>& parameters, const MotionOptions& options,
                      const Motion& motion, double accuracy, double longest = 5e-5) {
  FreeBodies free(model, parameters, options.push);
  FreeBodies::State s = FreeBodies::start(model, options.lift);
  const auto steps = static_cast<int>(std::ceil(motion.reached / longest));
  const double h = motion.reached / steps;
  std::size_t slab = 0;
  for (int i = 0; i < steps; ++i) {
    free.step(s, i * h, h);
    while (slab + 1 < motion.slabs.size() && motion.slabs[slab].to < (i + 1) * h) ++slab;
    for (Eigen::Index j = 0; j < 7; ++j) {
      const Enclosure& position = motion.slabs[slab].positions[static_cast<std::size_t>(j)];
      ASSERT_GE(s.angles[j], position.lo - accuracy) << "joint " << j << " at " << (i + 1) * h;
      ASSERT_LE(s.angles[j], position.hi + accuracy) << "joint " << j << " at " << (i + 1) * h;
    }
  }
  for (Eigen::Index j = 0; j < 7; ++j) {
    const auto joint = static_cast<std::size_t>(j);
    EXPECT_GE(s.angles[j], motion.positions[joint].lo - accuracy) << "joint " << j;
    EXPECT_LE(s.angles[j], motion.positions[joint].hi + accuracy) << "joint " << j;
    EXPECT_GE(s.rates[j], motion.velocities[joint].lo - 1e3 * accuracy) << "joint " << j;
    EXPECT_LE(s.rates[j], motion.velocities[joint].hi + 1e3 * accuracy) << "joint " << j;
  }
}

std::vector<double> nominal(const Model& model) {
  std::vector<double> values;
  for (const Parameter& parameter : model.parameters) values.push_back(parameter.nominal);
  return values;
}

double widest(const std::vector<Enclosure>& enclosures) {
  double width = 0.0;
  for (const Enclosure& e : enclosures) width = std::max(width, e.width());
  return width;
}

/// What a model keeps of one kind of terms, at a time; all of its coefficients are narrow.
double kept(const TaylorModel<1>& model, std::size_t order, std::size_t k, double t) {
  if (k >= model.rows(order).size()) return 0.0;
  const TaylorModel<1>::Row& row = model.rows(order)[k];
  return row[0].lower() + t * row[1].lower();
}

/// And what it leaves out.
double remainder_of(const TaylorModel<1>& model) {
  double kept = 0.0;
  for (std::size_t order = 0; order < TaylorModel<1>::orders; ++order) {
    for (const TaylorModel<1>::Row& row : model.rows(order))
      kept += std::fabs(row[0].lower()) + std::fabs(row[1].lower());
  }
  return 0.5 * (model.range().upper() - model.range().lower()) + std::fabs(model.constant().lower()) - kept;
}

/// Of the ordinary integration.
constexpr double accuracy_of_runs = 1e-10;

TEST(StanceMotion, PushedBodyIsFollowed) {
  const Model model = standing_model();
  const MotionOptions options{.duration = 0.3, .push = Push{50.0, 0.05, 0.2}};
  const Motion motion = simulate(model, {}, options);
  ASSERT_TRUE(motion.proven) << motion.open;
  EXPECT_EQ(motion.reached, 0.3);
  EXPECT_EQ(motion.joints[3], "femur rz");
  EXPECT_LE(widest(motion.positions), 1e-6);
  EXPECT_GT(motion.positions[0].lo, 0.001);  // it does move
  expect_contained(model, nominal(model), options, motion, accuracy_of_runs);
}

TEST(StanceMotion, BodyThatStandsStays) {
  const Motion motion = simulate(standing_model(), {}, {.duration = 0.1});
  ASSERT_TRUE(motion.proven);
  EXPECT_LE(widest(motion.positions), 1e-9);
  EXPECT_TRUE(motion.positions[0].contains(0.0));
  EXPECT_NEAR(motion.slabs.back().contacts[0].normal.lo, 293.831, 1e-3);
  EXPECT_NEAR(motion.slabs.back().contacts[1].normal.lo, 102.591, 1e-3);
}

TEST(StanceMotion, BodyLetGoAboveItsEquilibriumIsFollowed) {
  const Model model = standing_model();
  const MotionOptions options{.duration = 0.06, .lift = 0.001};
  const Motion motion = simulate(model, {}, options);
  ASSERT_TRUE(motion.proven) << motion.open;
  EXPECT_LE(widest(motion.positions), 1e-6);
  expect_contained(model, nominal(model), options, motion, 1e-8,
                   5e-6);  // it errs at kinks, with the square of its steps
}

TEST(StanceMotion, UncertainParametersGiveTubesThatContainRuns) {
  Model model = standing_model();
  const std::vector<std::uint32_t> uncertain = four_of(model);
  model = narrowed_within(std::move(model), uncertain, 1.0);
  const MotionOptions options{.duration = 0.05};
  const Motion motion = simulate(model, uncertain, options);
  ASSERT_TRUE(motion.proven) << motion.open;
  std::mt19937 random(20);
  std::vector<double> lowest(7, infinity);
  std::vector<double> highest(7, -infinity);
  const std::size_t runs = oracle::requested_count("VERISQ_MOTION_RUNS", 4);
  for (std::size_t run = 0; run < runs; ++run) {
    std::vector<double> parameters = nominal(model);
    for (const std::uint32_t k : uncertain) {
      const Enclosure& range = model.parameters[k].range;
      parameters[k] = run % 2 == 0 ? std::uniform_real_distribution(range.lo, range.hi)(random)
                                   : (random() % 2 == 0 ? range.lo : range.hi);
    }
    expect_contained(model, parameters, options, motion, accuracy_of_runs);
  }
}

/// Every kind of term that the model keeps or leaves out, at corners and between.
TEST(StanceMotion, TaylorModelsContainProductsOfErrors) {
  using Model = TaylorModel<1>;
  Model x = Model::of_time({Interval(2.0), Interval(0.25)});
  x.add_row(1, 0, {Interval(0.5), Interval(-0.125)});
  x.add_row(Model::of_errors, 0, {Interval(0.25)});
  Model y = Model::of_time({Interval(-1.0), Interval(0.5)});
  y.add_row(2, 0, {Interval(0.125)});
  y.add_row(Model::of_errors, 1, {Interval(-0.5), Interval(0.25)});
  const Model z = x * y - sin(x) + reciprocal(x);
  for (const double t : {-1.0, 0.3, 1.0}) {
    for (const double d : {-1.0, 0.6, 1.0}) {
      for (const double a : {-1.0, 0.2, 1.0}) {
        for (const double b : {-1.0, -0.7, 1.0}) {
          const double u = 2.0 + 0.25 * t + (0.5 - 0.125 * t) * d + 0.25 * a;
          const double v = -1.0 + 0.5 * t + 0.125 * d * d + (-0.5 + 0.25 * t) * b;
          const double left_out = u * v - std::sin(u) + 1.0 / u -
                                  (kept(z, 0, 0, t) + kept(z, 1, 0, t) * d + kept(z, 2, 0, t) * d * d +
                                   kept(z, Model::of_errors, 0, t) * a + kept(z, Model::of_errors, 1, t) * b);
          EXPECT_LE(std::fabs(left_out), remainder_of(z) + 1e-12) << t << ' ' << d << ' ' << a << ' ' << b;
        }
      }
    }
  }
  // What both depend on in the same way cancels.
  EXPECT_LE(Model(x - x).size(), 1e-12);
}

TEST(StanceMotion, WhereTheTubeGrowsTheAnswerEndsOpen) {
  Model model = standing_model();
  const std::vector<std::string> names{"k"};
  const std::vector<std::uint32_t> uncertain = uncertain_parameters(model, names);
  model = narrowed_within(std::move(model), uncertain, 10.0);
  const Motion motion = simulate(model, uncertain, {.duration = 0.1});
  EXPECT_FALSE(motion.proven);
  EXPECT_LT(motion.reached, 0.1);
  EXPECT_THAT(motion.open, testing::HasSubstr("grows"));
}

TEST(StanceMotion, RefusesWhatIsNotMirrorSymmetric) {
  const auto refusal = [](const Model& model, std::span<const std::uint32_t> uncertain) -> std::string {
    try {
      static_cast<void>(simulate(model, uncertain, {.duration = 0.1}));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  Model model = standing_model();
  const std::vector<std::string> lateral{"pz"};
  EXPECT_THAT(refusal(model, uncertain_parameters(model, lateral)), testing::HasSubstr("centre of mass of pelvis"));
  model.bodies[1].mass = Quantity{11.0, {11.0, 11.0}};
  EXPECT_THAT(refusal(model, {}), testing::HasSubstr("right femur has no mirror image"));
  model = standing_model();
  model.cylinders[0].bristle_damping = 0.0;
  EXPECT_THAT(refusal(model, {}), testing::HasSubstr("right hindfoot needs bristle_stiffness"));
  model = standing_model();
  model.cylinders[1].radius = Quantity{0.1, {0.1, 0.1}};
  EXPECT_THAT(refusal(model, {}), testing::HasSubstr("right forefoot has no mirror image"));
}

}  // namespace
}  // namespace verisq::stance
