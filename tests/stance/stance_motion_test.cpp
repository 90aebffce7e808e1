/// Proven motions against an ordinary integration of another formulation: nine free bodies, each with its own
/// coordinates, held together by forces at the joints (Lagrange's equations of the first kind), Runge and Kutta.
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <random>
#include <utility>
#include <verisq/error.hpp>
#include <verisq/stance_equilibrium.hpp>

#include "host/stance/stance_results.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "verify/stance/taylor_model.hpp"
#include "verisq/stance.hpp"

namespace verisq::stance {
namespace {

using Plane = Eigen::Vector2d;
using verify::Interval;

Model standing_model() {
  return read_model(places::example("standing.xml"));
}

std::vector<std::uint32_t> four_of(const Model& model) {
  const std::vector<std::string> names{"mp", "px", "py", "k"};
  return uncertain_parameters(model, names);
}

/// What one of the runs adds to the middle of the proven start, and how it is integrated.
struct RunChoice {
  /// Where in the enclosures of the nominal equilibrium it starts: 0 lower ends, 1 upper ends.
  double height = 0.5;
  double tilt = 0.5;
  double torques = 0.5;
  enum class Method { classical, three_eighths } method = Method::classical;
  double longest_step = 5e-5;  ///< s; below 2.78/19,400, where both methods are stable
};

/// The nine bodies of examples/standing.xml in the sagittal plane: x, y of the centres of mass and angles. Its joints'
/// errors are measured from 0, where that file has them.
class FreeBodies {
 public:
  static constexpr int most_bodies = 9;
  static constexpr int most_joints = 2 * (most_bodies - 1);  ///< equations of joints: two each
  template <int most>
  using Numbers = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;

  FreeBodies(const Model& model, std::vector<double> parameters, std::optional<Push> push)
      : model_(model), parameters_(std::move(parameters)), push_(push) {
    for (const Body& body : model_.bodies) {
      const double mass = value(body.mass);
      reciprocal_.emplace_back(1.0 / mass, 1.0 / mass, 1.0 / value(body.inertia[2]));
    }
    for (const ContactCylinder& c : model_.cylinders)
      damping_.push_back(damping_of(value(c.normal_restitution)) / value(c.impact_velocity));
  }

  /// x, y, pitch, then the angle of each leg joint by body; then their rates; integrals; bristles of all cylinders.
  struct State {
    Numbers<2 + most_bodies> angles, rates;  ///< bodies' joints: the root has x, y, pitch first
    Numbers<most_bodies> integrals;
    Numbers<4> bristles;
  };

  [[nodiscard]] std::size_t bodies() const { return model_.bodies.size(); }

  [[nodiscard]] State derivative(const State& s, double time) {
    place(s);
    State result = s;
    result.angles = s.rates;
    result.integrals.setZero();
    std::array<Eigen::Vector3d, most_bodies> load;  // forces and the moment on each
    for (std::size_t b = 0; b < bodies(); ++b) load[b] = {0.0, -model_.gravity / reciprocal_[b][0], 0.0};
    for (std::size_t c = 0; c < model_.cylinders.size(); ++c) add_contact(c, s, load, result);
    if (push_ && time >= push_->start && time <= push_->start + push_->duration) {
      const double wave = std::sin(M_PI * (time - push_->start) / push_->duration);
      const double force = push_->force * wave * wave;
      const Plane at = origin_[0] + Plane(-value(model_.bodies[0].offset[0]), -value(model_.bodies[0].offset[1]));
      load[0][0] += force;
      load[0][2] -= (at - centre_[0]).y() * force;
    }
    for (const Controller& c : model_.controllers) {
      const Joint& joint = model_.bodies[c.body].joints[c.joint];
      if (joint.kind != JointKind::rotation || joint.axis != 2) continue;
      const auto b = static_cast<Eigen::Index>(c.body);
      const double torque =
          -c.proportional * s.angles[2 + b] - c.integral * s.integrals[b] - c.derivative * s.rates[2 + b];
      result.integrals[b] = s.angles[2 + b];
      load[c.body][2] += torque;
      load[*model_.bodies[c.body].parent][2] -= torque;
    }
    const auto rates = accelerations(load);
    // Back to the joints: of the root's origin, and differences of angles.
    const Plane lever = origin_[0] - centre_[0];
    result.rates[0] = rates[0][0] - rates[0][2] * lever.y() - omega_[0] * omega_[0] * lever.x();
    result.rates[1] = rates[0][1] + rates[0][2] * lever.x() - omega_[0] * omega_[0] * lever.y();
    result.rates[2] = rates[0][2];
    for (std::size_t b = 1; b < bodies(); ++b)
      result.rates[2 + static_cast<Eigen::Index>(b)] = rates[b][2] - rates[*model_.bodies[b].parent][2];
    return result;
  }

  /// Of one of Kutta's two methods of fourth order.
  void step(State& s, double time, double h, RunChoice::Method method) {
    const auto add = [](State& a, const State& b, double factor) {
      a.angles += factor * b.angles;
      a.rates += factor * b.rates;
      a.integrals += factor * b.integrals;
      a.bristles += factor * b.bristles;
    };
    const auto moved = [&](std::initializer_list<std::pair<const State*, double>> slopes) {
      State result = s;
      for (const auto& [slope, factor] : slopes) add(result, *slope, factor * h);
      return result;
    };
    const State k1 = derivative(s, time);
    if (method == RunChoice::Method::classical) {
      const State k2 = derivative(moved({{&k1, 0.5}}), time + 0.5 * h);
      const State k3 = derivative(moved({{&k2, 0.5}}), time + 0.5 * h);
      const State k4 = derivative(moved({{&k3, 1.0}}), time + h);
      s = moved({{&k1, 1.0 / 6.0}, {&k2, 1.0 / 3.0}, {&k3, 1.0 / 3.0}, {&k4, 1.0 / 6.0}});
    } else {
      const State k2 = derivative(moved({{&k1, 1.0 / 3.0}}), time + h / 3.0);
      const State k3 = derivative(moved({{&k1, -1.0 / 3.0}, {&k2, 1.0}}), time + 2.0 * h / 3.0);
      const State k4 = derivative(moved({{&k1, 1.0}, {&k2, -1.0}, {&k3, 1.0}}), time + h);
      s = moved({{&k1, 0.125}, {&k2, 0.375}, {&k3, 0.375}, {&k4, 0.125}});
    }
  }

  /// At the nominal equilibrium, lifted; or dropped upright, with its integrals.
  [[nodiscard]] static State start(const Model& model, const Standing& nominal, const MotionOptions& options,
                                   const RunChoice& choice) {
    const auto at = [](const Enclosure& e, double share) { return (1.0 - share) * e.lo + share * e.hi; };
    const auto bodies = static_cast<Eigen::Index>(model.bodies.size());
    State s;
    s.angles.setZero(2 + bodies);
    s.rates.setZero(2 + bodies);
    s.integrals.setZero(bodies);
    s.bristles.setZero(static_cast<Eigen::Index>(model.cylinders.size()));
    constexpr std::size_t ty = 1;
    constexpr std::size_t rz = 3;
    s.angles[1] =
        options.drop ? *options.drop - lowest_sole(model) : at(nominal.positions[ty], choice.height) + options.lift;
    s.angles[2] = options.drop ? 0.0 : at(nominal.positions[rz], choice.tilt);
    std::size_t first = model.bodies.front().joints.size();
    for (std::size_t b = 1; b < model.bodies.size(); ++b) {
      for (const Controller& c : model.controllers) {
        const Joint& joint = model.bodies[c.body].joints[c.joint];
        if (c.body == b && joint.axis == 2)
          s.integrals[static_cast<Eigen::Index>(b)] =
              -at(nominal.torques[first + c.joint], choice.torques) / c.integral;
      }
      first += model.bodies[b].joints.size();
    }
    return s;
  }

 private:
  /// Of the model whose joints are straight, over its root.
  [[nodiscard]] static double lowest_sole(const Model& model) {
    double lowest = infinity;
    for (const ContactCylinder& cylinder : model.cylinders) {
      double height = cylinder.centre[1].nominal - cylinder.radius.nominal;
      for (std::uint32_t b = cylinder.body; b != 0; b = *model.bodies[b].parent)
        height += model.bodies[b].offset[1].nominal;
      lowest = std::min(lowest, height);
    }
    return lowest;
  }

  using System = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_joints, most_joints>;
  using Jacobian = Eigen::Matrix<double, 2, 3>;

  [[nodiscard]] double value(const Quantity& q) const { return q.parameter ? parameters_[*q.parameter] : q.nominal; }
  [[nodiscard]] Plane value(const QuantityVector& v) const { return {value(v[0]), value(v[1])}; }

  /// A joint: the two bodies' points have the same acceleration; the force that sees to it acts on both. With M a + J'f
  /// = load and J a = g, the forces solve J M^-1 J' f = J M^-1 load - g, where only joints that share a body meet.
  [[nodiscard]] std::array<Eigen::Vector3d, most_bodies> accelerations(
      const std::array<Eigen::Vector3d, most_bodies>& load) const {
    struct Side {
      std::size_t body;
      Jacobian jacobian;
    };
    std::array<std::array<Side, 2>, most_bodies> sides;
    const auto equations = static_cast<Eigen::Index>(2 * (bodies() - 1));
    System system = System::Zero(equations, equations);
    Numbers<most_joints> right = Numbers<most_joints>::Zero(equations);
    for (std::size_t b = 1; b < bodies(); ++b) {
      const std::size_t p = *model_.bodies[b].parent;
      const auto row = static_cast<Eigen::Index>(2 * (b - 1));
      const auto side = [&](std::size_t body, const Plane& lever, double sign) {
        const Jacobian jacobian{{sign, 0.0, -sign * lever.y()}, {0.0, sign, sign * lever.x()}};
        right.segment<2>(row) += jacobian * reciprocal_[body].cwiseProduct(load[body]);
        right.segment<2>(row) -= sign * omega_[body] * omega_[body] * lever;
        return Side{body, jacobian};
      };
      sides[b] = {side(b, origin_[b] - centre_[b], 1.0), side(p, origin_[b] - centre_[p], -1.0)};
      for (std::size_t other = 1; other <= b; ++other) {
        for (const Side& mine : sides[b]) {
          for (const Side& theirs : sides[other]) {
            if (mine.body != theirs.body) continue;
            system.block<2, 2>(row, static_cast<Eigen::Index>(2 * (other - 1))) +=
                mine.jacobian * reciprocal_[mine.body].asDiagonal() * theirs.jacobian.transpose();
          }
        }
      }
    }
    const Numbers<most_joints> forces = system.llt().solve(right);  // reads the lower triangle alone
    std::array<Eigen::Vector3d, most_bodies> left = load;
    for (std::size_t b = 1; b < bodies(); ++b) {
      for (const Side& each : sides[b])
        left[each.body] -= each.jacobian.transpose() * forces.segment<2>(static_cast<Eigen::Index>(2 * (b - 1)));
    }
    for (std::size_t b = 0; b < bodies(); ++b) left[b] = left[b].cwiseProduct(reciprocal_[b]).eval();
    return left;
  }

  void place(const State& s) {
    for (std::size_t b = 0; b < bodies(); ++b) {
      const Body& body = model_.bodies[b];
      const auto i = static_cast<Eigen::Index>(b);
      angle_[b] = s.angles[2 + i];
      omega_[b] = s.rates[2 + i];
      if (body.parent) {
        const std::size_t p = *body.parent;
        const Plane arm = turn_[p] * value(body.offset);
        origin_[b] = origin_[p] + arm;
        velocity_[b] = velocity_[p] + omega_[p] * Plane(-arm.y(), arm.x());
        angle_[b] += angle_[p];
        omega_[b] += omega_[p];
      } else {
        origin_[b] = value(body.offset) + s.angles.head<2>();
        velocity_[b] = s.rates.head<2>();
      }
      turn_[b] = Eigen::Rotation2Dd(angle_[b]).toRotationMatrix();
      centre_[b] = origin_[b] + turn_[b] * value(body.centre_of_mass);
    }
  }

  void add_contact(std::size_t index, const State& s, std::array<Eigen::Vector3d, most_bodies>& load,
                   State& result) const {
    const ContactCylinder& c = model_.cylinders[index];
    const auto i = static_cast<Eigen::Index>(index);
    const Plane axis = origin_[c.body] + turn_[c.body] * value(c.centre);
    const double depth = value(c.radius) - axis.y();
    const Plane lowest(axis.x(), axis.y() - value(c.radius));
    const Plane arm = lowest - origin_[c.body];
    const Plane slip = velocity_[c.body] + omega_[c.body] * Plane(-arm.y(), arm.x());
    double normal = 0.0;
    if (depth > 0.0) {
      normal = value(c.stiffness) * std::pow(depth, c.exponent) * std::max(0.0, 1.0 - damping_[index] * slip.y());
    }
    const double ratio = slip.x() / c.stribeck_velocity;
    const double limit = normal * (value(c.dynamic_friction) +
                                   (value(c.static_friction) - value(c.dynamic_friction)) * std::exp(-ratio * ratio));
    const double trial = c.bristle_stiffness * s.bristles[i] + c.bristle_damping * slip.x();
    const double limited = std::clamp(trial, -limit, limit);
    result.bristles[i] = (limited - c.bristle_stiffness * s.bristles[i]) / c.bristle_damping;
    const Plane lever = lowest - centre_[c.body];
    load[c.body] += Eigen::Vector3d(-limited, normal, lever.x() * normal + lever.y() * limited);
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
  std::vector<Eigen::Vector3d> reciprocal_;  ///< of mass, mass, moment of inertia
  std::vector<double> damping_;              ///< D/v_N of the cylinders
  std::array<double, most_bodies> angle_{}, omega_{};
  std::array<Eigen::Matrix2d, most_bodies> turn_;
  std::array<Plane, most_bodies> origin_, centre_, velocity_;
};

Standing nominal_standing(const Model& model) {
  return *equilibrium(model, {}, {}).standing;
}

/// The right leg's bodies come first.
void expect_contained(const Model& model, const Standing& nominal, const std::vector<double>& parameters,
                      const MotionOptions& options, const Motion& motion, double accuracy, const RunChoice& choice) {
  FreeBodies free(model, parameters, options.push);
  FreeBodies::State s = FreeBodies::start(model, nominal, options, choice);
  const auto steps = static_cast<int>(std::ceil(motion.reached / choice.longest_step));
  const double h = motion.reached / steps;
  std::size_t slab = 0;
  for (int i = 0; i < steps; ++i) {
    free.step(s, i * h, h, choice.method);
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

/// The motions are as long as the documents say where VERISQ_MOTION_RUNS asks for many runs, shorter by default.
std::size_t runs_asked_for(std::size_t otherwise) {
  return oracle::requested_count("VERISQ_MOTION_RUNS", otherwise);
}

/// Nothing is uncertain: runs differ in where they start within the proven equilibrium, in method and step. Half of
/// them start at a corner.
TEST(StanceMotion, PushedBodyIsFollowed) {
  const Model model = standing_model();
  constexpr std::size_t few = 2;
  const std::size_t runs = runs_asked_for(few);
  const MotionOptions options{.duration = runs > few ? 1.0 : 0.3, .push = Push{50.0, 0.05, 0.2}};
  const Motion motion = simulate(model, {}, options);
  ASSERT_TRUE(motion.proven) << motion.open;
  EXPECT_EQ(motion.reached, options.duration);
  EXPECT_EQ(motion.joints[3], "femur rz");
  EXPECT_LE(widest(motion.positions), 1e-6);
  const auto is_off_by_a_millimetre = [](const MotionSlab& slab) { return slab.positions[0].lo > 0.001; };
  EXPECT_TRUE(std::ranges::any_of(motion.slabs, is_off_by_a_millimetre));  // it does move
  const Standing standing = nominal_standing(model);
  std::mt19937 random(21);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (std::size_t run = 0; run < runs; ++run) {
    RunChoice choice{.height = share(random), .tilt = share(random), .torques = share(random)};
    if (run % 2 == 1)
      choice = {
          .height = std::round(choice.height), .tilt = std::round(choice.tilt), .torques = std::round(choice.torques)};
    choice.method = run % 4 < 2 ? RunChoice::Method::classical : RunChoice::Method::three_eighths;
    choice.longest_step = (0.5 + 0.5 * share(random)) * choice.longest_step;
    expect_contained(model, standing, nominal(model), options, motion, accuracy_of_runs, choice);
  }
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
  // It errs at kinks, with the square of its steps.
  expect_contained(model, nominal_standing(model), nominal(model), options, motion, 1e-8, {.longest_step = 5e-6});
}

/// Four switches: hindfeet and forefeet touch down slipping, and stick.
TEST(StanceMotion, DropIsFollowedThroughAllItsEvents) {
  const Model model = standing_model();
  const MotionOptions dropped{.duration = 0.045, .lift = 0.0039383};
  const Motion motion = simulate(model, {}, dropped);
  ASSERT_TRUE(motion.proven) << motion.open;
  EXPECT_LE(widest(motion.positions), 1e-6);
  double greatest[2] = {0.0, 0.0};  // proven to be reached
  double bound[2] = {0.0, 0.0};
  for (const MotionSlab& slab : motion.slabs) {
    for (const std::size_t c : {0, 1}) {
      greatest[c] = std::max(greatest[c], slab.contacts[c].normal.lo);
      bound[c] = std::max(bound[c], slab.contacts[c].normal.hi);
    }
  }
  // Of an ordinary integration with another method: 545.066 N and 250.637 N.
  EXPECT_LE(greatest[0], 545.067);
  EXPECT_GE(greatest[0], 544.9);
  EXPECT_GE(bound[0], 545.066);
  EXPECT_LE(bound[0], 545.2);
  EXPECT_LE(greatest[1], 250.638);
  EXPECT_GE(bound[1], 250.637);
  EXPECT_LE(bound[1], 250.8);
  EXPECT_EQ(motion.slabs.front().contacts[0].normal.hi, 0.0);  // in flight
  // Runs differ in where they start within the proven equilibrium, and in their steps.
  const Standing standing = nominal_standing(model);
  std::mt19937 random(21);
  std::uniform_real_distribution share(0.0, 1.0);
  for (std::size_t run = 0; run < runs_asked_for(1) && !HasFailure(); ++run) {
    const RunChoice choice{.height = share(random),
                           .tilt = share(random),
                           .torques = share(random),
                           .longest_step = 5e-6 * (1.0 - 0.2 * share(random))};
    expect_contained(model, standing, nominal(model), dropped, motion, 1e-8, choice);
  }
}

/// Its soles are level: the forefeet meet the ground at the same time and carry more than in the equilibrium.
TEST(StanceMotion, UprightBodyIsDropped) {
  const Model model = standing_model();
  const MotionOptions dropped{.duration = 0.03, .drop = 0.001};
  const Motion motion = simulate(model, {}, dropped);
  ASSERT_TRUE(motion.proven) << motion.open;
  EXPECT_LE(widest(motion.positions), 1e-6);
  double bound = 0.0;
  for (const MotionSlab& slab : motion.slabs) bound = std::max(bound, slab.contacts[1].normal.hi);
  EXPECT_GE(bound, 309.0);  // of an ordinary integration
  EXPECT_LE(bound, 310.0);
  expect_contained(model, nominal_standing(model), nominal(model), dropped, motion, 1e-8, {.longest_step = 5e-6});
}

TEST(StanceMotion, UncertainParametersGiveTubesThatContainRuns) {
  Model model = standing_model();
  const std::vector<std::uint32_t> uncertain = four_of(model);
  model = narrowed_within(std::move(model), uncertain, 1.0);
  constexpr std::size_t few = 4;
  const std::size_t runs = runs_asked_for(few);
  const MotionOptions options{.duration = runs > few ? 0.5 : 0.05};
  const Motion motion = simulate(model, uncertain, options);
  ASSERT_TRUE(motion.proven) << motion.open;
  const Standing standing = nominal_standing(model);
  std::mt19937 random(20);
  for (std::size_t run = 0; run < runs; ++run) {
    std::vector<double> parameters = nominal(model);
    for (const std::uint32_t k : uncertain) {
      const Enclosure& range = model.parameters[k].range;
      parameters[k] = run % 2 == 0 ? std::uniform_real_distribution(range.lo, range.hi)(random)
                                   : (random() % 2 == 0 ? range.lo : range.hi);
    }
    expect_contained(model, standing, parameters, options, motion, accuracy_of_runs, {});
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

/// All cylinders rebound by a parameter of this range.
Model with_restitution(const Enclosure& range) {
  Model model = standing_model();
  const auto index = static_cast<std::uint32_t>(model.parameters.size());
  Parameter restitution = model.parameters.front();
  restitution.name = "e";
  restitution.nominal = 0.5 * (range.lo + range.hi);
  restitution.range = range;
  model.parameters.push_back(restitution);
  for (ContactCylinder& cylinder : model.cylinders) cylinder.normal_restitution = {restitution.nominal, range, index};
  return model;
}

TEST(StanceMotion, UncertainRestitutionIsFollowedOrLeftOpen) {
  const std::vector<std::string> names{"e"};
  const Model narrow = with_restitution({0.09, 0.12});
  const Motion followed = simulate(narrow, uncertain_parameters(narrow, names), {.duration = 0.002});
  EXPECT_TRUE(followed.proven) << followed.open;
  const Model wide = with_restitution({0.5, 1.0});  // at 1 the damping has no derivative
  const Motion open = simulate(wide, uncertain_parameters(wide, names), {.duration = 0.002});
  EXPECT_FALSE(open.proven);
  EXPECT_EQ(open.open, "at its beginning the derivatives have no bound over these ranges");
}

/// Nine tenths of the time the force is about 300 N; then its enclosure grows without end.
TEST(StanceMotion, PictureKeepsItsScaleWhereTheTubeGrows) {
  Motion motion;
  motion.joints = {"tx", "ty", "rz"};
  motion.contacts = {"heel"};
  motion.reached = 1.0;
  for (int i = 0; i < 20; ++i) {
    const double force = i < 19 ? 318.0 : 1e42;
    const std::vector<Enclosure> still(3, {0.0, 1e-6});
    motion.slabs.push_back({0.05 * i, 0.05 * (i + 1), still, still, {{{299.0, force}, {-1.0, 1.0}}}});
  }
  const std::string picture = motion_picture(motion);
  EXPECT_THAT(picture, testing::HasSubstr("heel, N (cut off: the enclosures reach about [299, 1e+42])"));
  EXPECT_THAT(picture, testing::HasSubstr(">337</text>"));  // a span of 19 above the highest end of nine tenths
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
