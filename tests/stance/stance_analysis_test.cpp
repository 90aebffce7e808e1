// Wrench, sensitivities, reference uncertainty and accelerations against the paper's tables, against formulas and a
// mass matrix of Jacobians that share no line with the multibody code, and against samples.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/stance.hpp>

#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/stance_example.hpp"
#include "verify/stance/equilibrium_location.hpp"
#include "verify/stance/linear_systems.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

/// The paper's coordinates in the wrench.
enum Coordinate : std::size_t { w1 = 0, w2 = 1, w4 = 3, w6 = 5 };

constexpr std::array<std::uint32_t, 13> table_1{omega, Fx, Fy, mp, px, py, pz, rff, rhf, eN, eT, mu_st, mu_d};
constexpr std::array<std::uint32_t, 3> mp_px_Fx{mp, px, Fx};
constexpr std::array<std::uint32_t, 2> mp_px{mp, px};
constexpr std::array<std::uint32_t, 4> table_4{mp, px, Fx, mf};
constexpr UncertainSet nominal{};

/// Directed rounding to the second digit, as the paper prints.
Enclosure printed(const Enclosure& e) {
  return {std::floor(e.lo * 100) / 100, std::ceil(e.hi * 100) / 100};
}

/// To 0.01, as far as binary64 knows 0.01.
MATCHER_P2(Prints, lo, hi, "prints as [" + testing::PrintToString(lo) + ", " + testing::PrintToString(hi) + "]") {
  constexpr double tolerance = 0.01 + 1e-9;
  const Enclosure p = printed(arg);
  *result_listener << "[" << p.lo << ", " << p.hi << "]";
  return std::fabs(p.lo - lo) <= tolerance && std::fabs(p.hi - hi) <= tolerance;
}

/// Rounding errors of plain floating point, in what is some thousands at most.
constexpr double sampling_error = 1e-10;

MATCHER_P(ContainsSample, sample, "contains " + testing::PrintToString(sample)) {
  *result_listener << "[" << arg.lo << ", " << arg.hi << "]";
  return arg.lo - sampling_error <= sample && sample <= arg.hi + sampling_error;
}

std::vector<double> nominal_values(const Model& model) {
  std::vector<double> values;
  for (const Parameter& parameter : model.parameters) values.push_back(parameter.nominal);
  return values;
}

/// Every fourth coordinate at an end of its range: extremes lie in corners.
std::vector<double> sample(const Model& model, UncertainSet uncertain, std::mt19937_64& random) {
  std::vector<double> values = nominal_values(model);
  std::uniform_real_distribution<double> uniform;
  for (const std::uint32_t i : uncertain) {
    const Enclosure& range = model.parameters[i].range;
    const double share = uniform(random);
    values[i] = share < 0.125   ? range.lo
                : share > 0.875 ? range.hi
                                : std::uniform_real_distribution<double>(range.lo, range.hi)(random);
  }
  return values;
}

/// docs/stance.md §1, and the other two coordinates of an upright stance: none.
std::array<double, wrench_size> closed_form_wrench(const std::vector<double>& p) {
  constexpr double g = 9.81;
  constexpr double femur = 10.34;
  constexpr double legs = 30.82;
  constexpr double moment_of_legs = g * 2 * (10.34 * 0.05 + 3.87 * 0.05 + 0.84 * (0.05 - 0.0342) + 0.36 * (-0.085));
  const double more = p[mf] - femur;
  return {p[Fx], p[Fy] - g * (p[mp] + legs + more),
          0,     g * p[mp] * p[pz] + g * more * 0.0795,
          0,     g * p[mp] * (0.05 - p[px]) + moment_of_legs + g * more * 0.05};
}

/// Partial derivatives of the above by mp, px, ... where they are not 0.
std::array<double, wrench_size> closed_form_derivative(const std::vector<double>& p, std::uint32_t parameter) {
  constexpr double g = 9.81;
  switch (parameter) {
    case Fx: return {1, 0, 0, 0, 0, 0};
    case Fy: return {0, 1, 0, 0, 0, 0};
    case mp: return {0, -g, 0, g * p[pz], 0, g * (0.05 - p[px])};
    case px: return {0, 0, 0, 0, 0, -g * p[mp]};
    case pz: return {0, 0, 0, g * p[mp], 0, 0};
    case mf: return {0, -g, 0, g * 0.0795, 0, g * 0.05};
    default: return {};
  }
}

/// Some positions of all joints, so that no axis is special.
Model bent(Model model) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> angle(-0.4, 0.4);
  for (Body& body : model.bodies) {
    for (Joint& joint : body.joints) joint.position += angle(random);
  }
  return model;
}

/// At rest: M = sum of m J_v' J_v + J_w' R I R' J_w, forces = sum of J_v' weight + J' applied, from positions and axes
/// in the world.
Eigen::VectorXd accelerations_by_jacobians(const Model& model, const std::vector<double>& p) {
  using Eigen::Matrix3d, Eigen::MatrixXd, Eigen::Vector3d, Eigen::VectorXd;
  const auto value = [&](const Quantity& q) { return q.parameter ? p[*q.parameter] : q.nominal; };
  const auto vector = [&](const QuantityVector& q) { return Vector3d(value(q[0]), value(q[1]), value(q[2])); };
  struct Axis {
    bool rotation;
    Vector3d origin, direction;
  };
  struct Placed {
    Matrix3d orientation;
    Vector3d position;
    std::vector<std::size_t> joints;
  };
  const auto size = static_cast<Eigen::Index>(model.degrees_of_freedom());
  std::vector<Axis> axes;
  std::vector<Placed> placed;
  MatrixXd mass = MatrixXd::Zero(size, size);
  VectorXd forces = VectorXd::Zero(size);
  const auto jacobian = [&](const Placed& body, const Vector3d& point) {
    MatrixXd j = MatrixXd::Zero(3, size);
    for (const std::size_t k : body.joints) {
      j.col(static_cast<Eigen::Index>(k)) =
          axes[k].rotation ? Vector3d(axes[k].direction.cross(point - axes[k].origin)) : axes[k].direction;
    }
    return j;
  };
  for (const Body& body : model.bodies) {
    Placed at = body.parent ? placed[*body.parent] : Placed{Matrix3d::Identity(), Vector3d::Zero(), {}};
    Vector3d reference = at.position;
    at.position += at.orientation * vector(body.offset);
    for (const Joint& joint : body.joints) {
      const Vector3d direction = at.orientation.col(joint.axis);
      at.joints.push_back(axes.size());
      axes.push_back({joint.kind == JointKind::rotation, at.position, direction});
      if (joint.kind == JointKind::rotation) {
        at.orientation = at.orientation * Eigen::AngleAxisd(joint.position, Vector3d::Unit(joint.axis));
      } else {
        at.position += joint.position * direction;
        reference += joint.position * direction;
      }
    }
    placed.push_back(at);
    const MatrixXd of_centre = jacobian(at, at.position + at.orientation * vector(body.centre_of_mass));
    MatrixXd rotation = MatrixXd::Zero(3, size);
    for (const std::size_t k : at.joints) {
      if (axes[k].rotation) rotation.col(static_cast<Eigen::Index>(k)) = axes[k].direction;
    }
    const MatrixXd turning = at.orientation.transpose() * rotation;
    mass += value(body.mass) * of_centre.transpose() * of_centre +
            turning.transpose() * vector(body.inertia).asDiagonal() * turning;
    forces += of_centre.transpose() * Vector3d(0, -model.gravity * value(body.mass), 0);
    if (!body.parent) forces += jacobian(at, reference).transpose() * vector(model.applied.force);
  }
  return mass.fullPivLu().solve(forces);
}

class StanceAnalysis : public testing::Test {
 protected:
  Model model = nine_segments();
  std::mt19937_64 random{1};
};

// ---- The paper's tables

TEST_F(StanceAnalysis, PaperModeReproducesTable2) {
  const WrenchEnclosure all = wrench(model, table_1, Mode::paper);
  EXPECT_THAT(all[w1], Prints(0, 200));
  EXPECT_THAT(all[w2], Prints(-940.00, -595.69));
  EXPECT_THAT(all[w4], Prints(-31.89, 31.89));
  EXPECT_THAT(all[w6], Prints(-50.17, 45.49));
  const WrenchEnclosure some = wrench(model, mp_px_Fx, Mode::paper);
  EXPECT_THAT(some[w1], Prints(0, 200));
  EXPECT_THAT(some[w2], Prints(-915.00, -620.69));
  EXPECT_THAT(some[w4], Prints(0, 0));
  EXPECT_THAT(some[w6], Prints(-50.17, 45.49));
  const WrenchEnclosure none = wrench(model, nominal, Mode::paper);
  // The paper's program has a factor [1 - epsilon, 1] in w1.
  EXPECT_THAT(none[w1], Prints(99.99, 100.00));
  EXPECT_THAT(none[w2], Prints(-767.85, -767.84));
  EXPECT_THAT(none[w4], Prints(0, 0));
  EXPECT_THAT(none[w6], Prints(1.33, 1.34));
}

TEST_F(StanceAnalysis, PaperModeReproducesTable3) {
  const auto by = [&](std::uint32_t parameter) { return sensitivity(model, mp_px_Fx, parameter, Mode::paper); };
  for (const Coordinate k : {w1, w2, w4, w6}) {
    SCOPED_TRACE(k);
    if (k != w2 && k != w6) {
      EXPECT_THAT(by(mp)[k], Prints(0, 0));
    }
    if (k != w6) {
      EXPECT_THAT(by(px)[k], Prints(0, 0));
    }
    if (k != w1) {
      EXPECT_THAT(by(Fx)[k], Prints(0, 0));
    }
  }
  EXPECT_THAT(by(Fx)[w1], Prints(0.99, 1));
  EXPECT_THAT(by(mp)[w2], Prints(-9.81, -9.80));
  EXPECT_THAT(by(px)[w6], Prints(-637.66, -343.34));
  // Printed [-9.82, 0.50]: the lower end is a misprint of -0.982.
  EXPECT_NEAR(by(mp)[w6].lo, -0.981, 0.001);
  EXPECT_THAT(by(mp)[w6], Prints(-0.99, 0.50));
  EXPECT_THAT(by(mp)[w6], testing::Not(Prints(-9.82, 0.50)));
}

TEST_F(StanceAnalysis, PaperModeReproducesTheDerivativesOfTable4) {
  const auto by = [&](std::uint32_t parameter) { return sensitivity(model, nominal, parameter, Mode::paper); };
  // The third column is by one femur mass, not by Fx.
  EXPECT_THAT(by(mp)[w1], Prints(0, 0));
  EXPECT_THAT(by(px)[w1], Prints(0, 0));
  EXPECT_THAT(by(mf)[w1], Prints(0, 0));
  EXPECT_THAT(by(mp)[w2], Prints(-9.81, -9.81));
  EXPECT_THAT(by(px)[w2], Prints(0, 0));
  EXPECT_THAT(by(mf)[w2], Prints(-9.81, -9.81));
  EXPECT_THAT(by(mp)[w4], Prints(0, 0));
  EXPECT_THAT(by(px)[w4], Prints(0, 0));
  EXPECT_THAT(by(mf)[w4], Prints(0.78, 0.78));
  EXPECT_THAT(by(mp)[w6], Prints(-0.25, -0.25));
  EXPECT_THAT(by(px)[w6], Prints(-490.5, -490.5));
  EXPECT_THAT(by(mf)[w6], Prints(0.5, 0.5));
}

TEST_F(StanceAnalysis, ReferenceUncertaintyIsTable4sFromItsRoundedDerivatives) {
  // w2's r was made with 9.80 for mp.
  std::array<WrenchEnclosure, table_4.size()> rounded{};
  rounded[0][w2] = {-9.80, -9.80};
  rounded[0][w6] = {-0.25, -0.25};
  rounded[1][w6] = {-490.5, -490.5};
  rounded[2][w1] = {1, 1};
  rounded[3][w2] = {-9.81, -9.81};
  rounded[3][w4] = {0.78, 0.78};
  rounded[3][w6] = {0.5, 0.5};
  const ReferenceUncertainty r = reference_uncertainty(model, table_4, rounded);
  EXPECT_THAT(r.by_value[w1], Prints(0, 200));
  EXPECT_THAT(r.by_value[w2], Prints(444.43, 738.44));
  EXPECT_THAT(r.by_value[w4], Prints(8.07, 8.07));
  EXPECT_THAT(r.by_value[w6], Prints(38.44, 70.47));
}

TEST_F(StanceAnalysis, ReferenceUncertaintyIsAnEnclosureWhereThePapersIsNot) {
  for (const Mode mode : {Mode::paper, Mode::tight}) {
    const ReferenceUncertainty r = reference_uncertainty(model, nominal, table_4, mode);
    EXPECT_THAT(r.by_value[w1], Prints(0, 200));
    EXPECT_THAT(r.by_value[w2], Prints(444.78, 739.09));
    EXPECT_THAT(r.by_value[w4], Prints(8.06, 8.07));
    EXPECT_THAT(r.by_value[w6], Prints(38.18, 70.07));
    // Half the width of the true range: the nominal derivatives are exact for it.
    EXPECT_GE(r.by_radius[w6], 15.94125);
    EXPECT_NEAR(r.by_radius[w6], 15.94125, 1e-12);
    EXPECT_NEAR(2 * r.by_radius[w6], wrench(model, mp_px_Fx, Mode::tight)[w6].width(), 1e-9);
    EXPECT_NEAR(r.by_radius[w1], 100, 1e-12);
    EXPECT_EQ(r.by_radius[2], 0);
  }
}

// ---- Tight mode

TEST_F(StanceAnalysis, TightW6IsTheExactRange) {
  for (const UncertainSet uncertain : {UncertainSet(table_1), UncertainSet(mp_px_Fx)}) {
    const Enclosure e = wrench(model, uncertain, Mode::tight)[w6];
    EXPECT_GE(e.lo, -18.2826);
    EXPECT_LE(e.hi, 13.6001);
    std::vector<double> p = nominal_values(model);
    p[mp] = 65, p[px] = 0.1;
    EXPECT_THAT(e, ContainsSample(closed_form_wrench(p)[w6]));
    EXPECT_NEAR(e.lo, closed_form_wrench(p)[w6], 1e-10);
    p[px] = 0.05;
    EXPECT_NEAR(e.hi, closed_form_wrench(p)[w6], 1e-10);
  }
}

TEST_F(StanceAnalysis, TightLiesInPaperMode) {
  const WrenchEnclosure tight = wrench(model, table_1, Mode::tight);
  const WrenchEnclosure paper = wrench(model, table_1, Mode::paper);
  for (std::size_t k = 0; k < wrench_size; ++k) {
    EXPECT_LE(paper[k].lo, tight[k].lo);
    EXPECT_GE(paper[k].hi, tight[k].hi);
  }
  EXPECT_NEAR(paper[w6].width() / tight[w6].width(), 3, 1e-6);
}

TEST_F(StanceAnalysis, NoSampleEscapesAndTheSamplesFillTheTightEnclosure) {
  const std::size_t samples = oracle::requested_count("VERISQ_STANCE_SAMPLES", 10'000);
  const WrenchEnclosure enclosure = wrench(model, table_1, Mode::tight);
  WrenchEnclosure hull;
  hull.fill({infinity, -infinity});
  for (std::size_t i = 0; i < samples; ++i) {
    const std::vector<double> p = sample(model, table_1, random);
    const auto w = sampled_wrench(model, p);
    const auto expected = closed_form_wrench(p);
    for (std::size_t k = 0; k < wrench_size; ++k) {
      ASSERT_NEAR(w[k], expected[k], sampling_error);
      ASSERT_THAT(enclosure[k], ContainsSample(w[k])) << "component " << k;
      hull[k] = {std::fmin(hull[k].lo, w[k]), std::fmax(hull[k].hi, w[k])};
    }
  }
  for (std::size_t k = 0; k < wrench_size; ++k) {
    if (hull[k].width() <= sampling_error) {
      EXPECT_LE(enclosure[k].width(), sampling_error);
      continue;
    }
    const double fill = hull[k].width() / enclosure[k].width();
    RecordProperty("fill_of_component_" + std::to_string(k), std::to_string(fill));
    EXPECT_GT(fill, 0.999) << "component " << k;
  }
}

TEST_F(StanceAnalysis, BentStancesDoNotEscapeEither) {
  for (int i = 0; i < 3; ++i) {
    model = bent(model);
    const WrenchEnclosure enclosure = wrench(model, table_1, Mode::tight);
    WrenchEnclosure hull;
    hull.fill({infinity, -infinity});
    for (int n = 0; n < 3000; ++n) {
      const auto w = sampled_wrench(model, sample(model, table_1, random));
      for (std::size_t k = 0; k < wrench_size; ++k) {
        ASSERT_THAT(enclosure[k], ContainsSample(w[k])) << "component " << k;
        hull[k] = {std::fmin(hull[k].lo, w[k]), std::fmax(hull[k].hi, w[k])};
      }
    }
    for (std::size_t k = 0; k < wrench_size; ++k) EXPECT_LE(enclosure[k].width(), 1.05 * hull[k].width() + 1e-9);
  }
}

// ---- Sensitivities

TEST_F(StanceAnalysis, SensitivitiesAgreeWithFiniteDifferences) {
  for (const Model& stance : {model, bent(model)}) {
    for (std::uint32_t i = 0; i < stance.parameters.size(); ++i) {
      const WrenchEnclosure exact = sensitivity(stance, nominal, i, Mode::tight);
      std::vector<double> p = nominal_values(stance);
      // The wrench is linear in each parameter: a long step has no truncation error.
      constexpr double step = 0.25;
      p[i] += step;
      const auto more = sampled_wrench(stance, p);
      p[i] -= 2 * step;
      const auto less = sampled_wrench(stance, p);
      for (std::size_t k = 0; k < wrench_size; ++k) {
        const double difference = (more[k] - less[k]) / (2 * step);
        EXPECT_NEAR(0.5 * (exact[k].lo + exact[k].hi), difference, 1e-6 * std::fabs(difference) + 1e-11)
            << stance.parameters[i].name << ", component " << k;
        EXPECT_LE(exact[k].width(), 1e-9);
      }
    }
  }
}

TEST_F(StanceAnalysis, SensitivitiesContainSampledOnes) {
  for (std::uint32_t i = 0; i < model.parameters.size(); ++i) {
    const WrenchEnclosure tight = sensitivity(model, table_1, i, Mode::tight);
    const WrenchEnclosure paper = sensitivity(model, table_1, i, Mode::paper);
    WrenchEnclosure hull;
    hull.fill({infinity, -infinity});
    for (int n = 0; n < 1000; ++n) {
      const auto expected = closed_form_derivative(sample(model, table_1, random), i);
      for (std::size_t k = 0; k < wrench_size; ++k) {
        ASSERT_THAT(tight[k], ContainsSample(expected[k])) << model.parameters[i].name << ", component " << k;
        ASSERT_THAT(paper[k], ContainsSample(expected[k])) << model.parameters[i].name << ", component " << k;
        hull[k] = {std::fmin(hull[k].lo, expected[k]), std::fmax(hull[k].hi, expected[k])};
      }
    }
    for (std::size_t k = 0; k < wrench_size; ++k) EXPECT_LE(tight[k].width(), hull[k].width() + 1e-9);
  }
}

// ---- Accelerations

TEST_F(StanceAnalysis, SampledAccelerationsAreThoseOfTheJacobians) {
  for (const Model& stance : {model, bent(model)}) {
    for (int i = 0; i < 20; ++i) {
      const std::vector<double> p = sample(stance, table_1, random);
      const Eigen::VectorXd expected = accelerations_by_jacobians(stance, p);
      const std::vector<double> a = sampled_accelerations(stance, p);
      ASSERT_EQ(a.size(), 26u);
      for (std::size_t k = 0; k < a.size(); ++k) {
        EXPECT_NEAR(a[k], expected[static_cast<Eigen::Index>(k)], 1e-9 * expected.cwiseAbs().maxCoeff()) << k;
      }
    }
  }
}

TEST_F(StanceAnalysis, WithoutAppliedForceTheStanceFallsFreely) {
  model.applied.force = example::numbers(0, 0, 0);
  const std::vector<Enclosure> a = accelerations(model, mp_px, {});
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_THAT(a[k], ContainsSample(k == 1 ? -9.81 : 0.0));
    EXPECT_LE(a[k].width(), 1e-9);
  }
}

void expect_within_5_percent(const Model& model, UncertainSet uncertain, std::mt19937_64& random) {
  const std::size_t samples = oracle::requested_count("VERISQ_STANCE_ACCELERATIONS", 2000);
  const std::vector<Enclosure> enclosure = accelerations(model, uncertain, {});
  std::vector<Enclosure> hull(enclosure.size(), {infinity, -infinity});
  for (std::size_t i = 0; i < samples; ++i) {
    const std::vector<double> p = sample(model, uncertain, random);
    // The reference is slow: a part of the samples.
    if (i % 20 == 0) {
      const Eigen::VectorXd a = accelerations_by_jacobians(model, p);
      for (std::size_t k = 0; k < enclosure.size(); ++k) {
        ASSERT_THAT(enclosure[k], ContainsSample(a[static_cast<Eigen::Index>(k)])) << "joint " << k;
      }
    }
    const std::vector<double> a = sampled_accelerations(model, p);
    for (std::size_t k = 0; k < enclosure.size(); ++k) {
      ASSERT_THAT(enclosure[k], ContainsSample(a[k])) << "joint " << k;
      hull[k] = {std::fmin(hull[k].lo, a[k]), std::fmax(hull[k].hi, a[k])};
    }
  }
  for (std::size_t k = 0; k < enclosure.size(); ++k) {
    EXPECT_LE(enclosure[k].width(), 1.05 * hull[k].width() + 1e-9) << "joint " << k;
  }
}

TEST_F(StanceAnalysis, AccelerationsAreAtMost5PercentWiderThanSampled) {
  expect_within_5_percent(model, mp_px, random);
}

TEST_F(StanceAnalysis, AccelerationsOfABentStanceToo) {
  expect_within_5_percent(bent(model), mp_px, random);
}

/// Expects the accelerations at samples and at all corners to lie in the enclosures, and returns their hull.
std::vector<Enclosure> expect_samples_within(const std::vector<Enclosure>& enclosure, const Model& model,
                                             UncertainSet uncertain, std::mt19937_64& random) {
  std::vector<Enclosure> hull(enclosure.size(), {infinity, -infinity});
  const unsigned corners = 1U << uncertain.size();
  for (unsigned i = 0; i < corners + 500; ++i) {
    std::vector<double> p = sample(model, uncertain, random);
    for (unsigned n = 0; i < corners && n < uncertain.size(); ++n) {
      const Enclosure& range = model.parameters[uncertain[n]].range;
      p[uncertain[n]] = ((i >> n) & 1U) != 0 ? range.hi : range.lo;
    }
    const std::vector<double> a = sampled_accelerations(model, p);
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_THAT(enclosure[k], ContainsSample(a[k])) << "joint " << k;
      hull[k] = {std::fmin(hull[k].lo, a[k]), std::fmax(hull[k].hi, a[k])};
    }
  }
  return hull;
}

TEST_F(StanceAnalysis, CoarseCellsOfFiveParametersContainSamples) {
  constexpr std::array<std::uint32_t, 5> five{Fx, Fy, mp, px, pz};
  const std::vector<Enclosure> enclosure = accelerations(model, five, {.cells = 2});
  EXPECT_TRUE(std::isfinite(enclosure.front().width()));
  expect_samples_within(enclosure, model, five, random);
}

/// Coordinate by coordinate, from a point on: the largest value of sign times a component that was met.
double climbed(const Model& model, std::vector<double> p, std::size_t component, double sign) {
  const auto height = [&] { return sign * sampled_accelerations(model, p)[component]; };
  double best = height();
  for (double step = 0.25; step > 0.01;) {
    bool higher = false;
    for (const std::uint32_t k : {Fx, Fy, mp, px, py, pz}) {
      const Enclosure& range = model.parameters[k].range;
      for (const double move : {-step, step}) {
        const double before = p[k];
        p[k] = std::clamp(before + move * range.width(), range.lo, range.hi);
        if (height() > best) {
          best = height();
          higher = true;
        } else {
          p[k] = before;
        }
      }
    }
    if (!higher) step *= 0.5;
  }
  return sign * best;
}

TEST_F(StanceAnalysis, AccelerationsOverTable1AreAtMost5PercentWiderThanSampled) {
  const std::vector<Enclosure> enclosure = accelerations(model, table_1, {});
  std::vector<std::vector<double>> points;
  for (int i = 0; i < 2000; ++i) points.push_back(sample(model, table_1, random));
  constexpr std::array<std::uint32_t, 6> acting{Fx, Fy, mp, px, py, pz};
  for (unsigned corner = 0; corner < 64; ++corner) {
    points.push_back(nominal_values(model));
    for (unsigned k = 0; k < acting.size(); ++k) {
      const Enclosure& range = model.parameters[acting[k]].range;
      points.back()[acting[k]] = ((corner >> k) & 1U) != 0 ? range.hi : range.lo;
    }
  }
  std::vector<std::vector<double>> values;
  for (const std::vector<double>& p : points) values.push_back(sampled_accelerations(model, p));
  for (std::size_t k = 0; k < enclosure.size(); ++k) {
    const auto less = [k](const std::vector<double>& a, const std::vector<double>& b) { return a[k] < b[k]; };
    const auto [least, greatest] = std::minmax_element(values.begin(), values.end(), less);
    const Enclosure sampled{climbed(model, points[static_cast<std::size_t>(least - values.begin())], k, -1),
                            climbed(model, points[static_cast<std::size_t>(greatest - values.begin())], k, 1)};
    EXPECT_THAT(enclosure[k], ContainsSample(sampled.lo)) << "joint " << k;
    EXPECT_THAT(enclosure[k], ContainsSample(sampled.hi)) << "joint " << k;
    EXPECT_LE(enclosure[k].width(), 1.05 * sampled.width() + 1e-9) << "joint " << k;
  }
}

/// With velocities, and with masses and centres that move in three bodies, two of them with the same mass.
Model with_moving_masses(Model stance) {
  Model model = bent(std::move(stance));
  double velocity = 0.5;
  for (Body& body : model.bodies) {
    for (Joint& joint : body.joints) joint.velocity = velocity = -0.9 * velocity;
  }
  model.parameters[mf] = example::parameter("mf", "kg", "mass of both femora", 9, 12);
  model.parameters[rff] = example::parameter("rff", "m", "z of the left tibia's centre of mass", 0, 0.02);
  for (Body& body : model.bodies) {
    if (body.name == "right femur" || body.name == "left femur") body.mass = example::quantity(model, mf);
    if (body.name == "left tibia") body.centre_of_mass[2] = example::quantity(model, rff);
  }
  return model;
}

TEST_F(StanceAnalysis, AccelerationsOfAMovingStanceWithThreeUncertainBodies) {
  const Model moving = with_moving_masses(model);
  constexpr std::array<std::uint32_t, 4> four{Fx, mp, rff, mf};
  const std::vector<Enclosure> enclosure = accelerations(moving, four, {});
  const std::vector<Enclosure> hull = expect_samples_within(enclosure, moving, four, random);
  for (std::size_t k = 0; k < hull.size(); ++k)
    EXPECT_LE(enclosure[k].width(), 1.05 * hull[k].width()) << "joint " << k;

  Model point = moving;
  for (const std::uint32_t i : four)
    point.parameters[i].range = {point.parameters[i].nominal, point.parameters[i].nominal};
  const std::vector<Enclosure> thin = accelerations(point, four, {});
  const std::vector<double> a = sampled_accelerations(point, nominal_values(point));
  const double largest = Eigen::Map<const Eigen::VectorXd>(a.data(), std::ssize(a)).lpNorm<Eigen::Infinity>();
  for (std::size_t k = 0; k < thin.size(); ++k) {
    EXPECT_THAT(thin[k], ContainsSample(a[k])) << "joint " << k;
    EXPECT_LE(thin[k].width(), 1e-9 * largest) << "joint " << k;
  }
}

TEST_F(StanceAnalysis, AccelerationsOfBodiesOfUncertainLength) {
  model.parameters[rff] = example::parameter("rff", "m", "y of the right knee below the hip", -0.44, -0.4);
  for (Body& body : model.bodies) {
    if (body.name == "right tibia") body.offset[1] = example::quantity(model, rff);
  }
  constexpr std::array<std::uint32_t, 2> two{mp, rff};
  const Model stance = bent(model);
  const std::vector<Enclosure> enclosure = accelerations(stance, two, {.cells = 8});
  for (const Enclosure& component : enclosure) EXPECT_TRUE(std::isfinite(component.width()));
  expect_samples_within(enclosure, stance, two, random);
}

TEST_F(StanceAnalysis, OneCellIsAnEnclosureToo) {
  constexpr std::array<std::uint32_t, 3> three{mp, py, pz};
  const std::vector<Enclosure> coarse = accelerations(model, three, {.cells = 1});
  const std::vector<Enclosure> fine = accelerations(model, three, {.cells = 16});
  for (std::size_t k = 0; k < coarse.size(); ++k) {
    EXPECT_TRUE(std::isfinite(coarse[k].width()));
    EXPECT_LE(fine[k].width(), coarse[k].width() + 1e-9);
    EXPECT_LE(coarse[k].lo, fine[k].hi);
    EXPECT_GE(coarse[k].hi, fine[k].lo);
  }
  EXPECT_GT(coarse[1].width(), 1.5 * fine[1].width());
}

TEST_F(StanceAnalysis, ParametersThatDoNotActCostNothing) {
  std::vector<std::uint32_t> many(table_1.begin(), table_1.end());
  std::erase_if(many, [](std::uint32_t i) { return i == Fx || i == Fy || i == py || i == pz; });
  EXPECT_EQ(accelerations(model, many, {.cells = 4}), accelerations(model, mp_px, {.cells = 4}));
}

TEST_F(StanceAnalysis, NominalAccelerationsAreThin) {
  const std::vector<Enclosure> thin = accelerations(model, nominal, {});
  const std::vector<double> a = sampled_accelerations(model, nominal_values(model));
  for (std::size_t k = 0; k < thin.size(); ++k) {
    EXPECT_THAT(thin[k], ContainsSample(a[k]));
    EXPECT_LE(thin[k].width(), 1e-9);
  }
}

TEST_F(StanceAnalysis, ProgressRisesToOne) {
  std::vector<double> fractions;
  const AccelerationOptions options{.cells = 8, .progress = [&](double fraction) { fractions.push_back(fraction); }};
  (void)accelerations(model, mp_px, options);
  ASSERT_FALSE(fractions.empty());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_DOUBLE_EQ(fractions.back(), 1);
}

TEST_F(StanceAnalysis, InterruptedAccelerationsAreStillEnclosures) {
  const std::vector<Enclosure> early = accelerations(model, mp_px, {.interrupted = [] { return true; }});
  const std::vector<Enclosure> whole = accelerations(model, mp_px, {});
  for (std::size_t k = 0; k < early.size(); ++k) {
    EXPECT_TRUE(std::isfinite(early[k].width())) << "joint " << k;
    EXPECT_LE(early[k].lo, whole[k].lo) << "joint " << k;
    EXPECT_GE(early[k].hi, whole[k].hi) << "joint " << k;
  }
  EXPECT_GT(early.front().width(), 1.1 * whole.front().width());
}

TEST_F(StanceAnalysis, WhatIsNotProvenIsInfinite) {
  // Masses from nearly 0 on, of a body that carries all inertia: the whole box as one cell proves nothing.
  model.parameters[mp].range = {1e-3, 1e6};
  for (Body& body : model.bodies) {
    if (body.mass.parameter == mp) body.mass.range = model.parameters[mp].range;
  }
  const std::vector<Enclosure> a = accelerations(model, mp_px, {.cells = 1});
  for (const Enclosure& component : a) EXPECT_EQ(component, (Enclosure{-infinity, infinity}));
}

// ---- Linear systems and ranges

/// Diagonally dominant, with small derivatives.
ParametricLinearSystem random_system(std::mt19937_64& random, double deviation) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto number = [&](const Interval&) { return Interval(uniform(random)); };
  const auto thick = [&](const Interval&) { return Interval(uniform(random)) + Interval(-0.1, 0.1); };
  const IntervalMatrix matrix = IntervalMatrix::Zero(5, 5);
  const IntervalVector vector = IntervalVector::Zero(5);
  ParametricLinearSystem system{Eigen::VectorXd::Random(5), matrix.unaryExpr(number), vector.unaryExpr(number), {}};
  for (int i = 0; i < 5; ++i) system.matrix(i, i) += Interval(4);
  for (int k = 0; k < 2; ++k) {
    system.variations.push_back({Interval(-deviation, deviation), matrix.unaryExpr(thick), vector.unaryExpr(thick)});
  }
  return system;
}

double point_of(const Interval& a, double share) {
  return a.lower() + share * (a.upper() - a.lower());
}

TEST(ParametricLinearSystem, ContainsTheSolutionsOfSampledSystems) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform;
  for (int i = 0; i < 100; ++i) {
    const ParametricLinearSystem system = random_system(random, 0.2);
    const auto solved = solve(system);
    ASSERT_TRUE(solved);
    for (int n = 0; n < 50; ++n) {
      const auto pick = [&](const Interval& a) { return point_of(a, std::round(uniform(random) * 2) / 2); };
      Eigen::MatrixXd a = system.matrix.unaryExpr(pick);
      Eigen::VectorXd residual = system.residual.unaryExpr(pick);
      std::vector<std::pair<Eigen::MatrixXd, Eigen::VectorXd>> slopes;
      for (const auto& variation : system.variations) {
        const double deviation = pick(variation.deviation);
        slopes.emplace_back(variation.matrix.unaryExpr(pick), variation.residual.unaryExpr(pick));
        a += deviation * slopes.back().first;
        residual += deviation * slopes.back().second;
      }
      const Eigen::VectorXd x = system.approximation + a.fullPivLu().solve(residual);
      for (Eigen::Index k = 0; k < x.size(); ++k) {
        ASSERT_LE(solved->solution[k].lower(), x[k] + 1e-12);
        ASSERT_GE(solved->solution[k].upper(), x[k] - 1e-12);
      }
      for (std::size_t v = 0; v < slopes.size(); ++v) {
        const Eigen::VectorXd derivative =
            a.fullPivLu().solve(slopes[v].second - slopes[v].first * (x - system.approximation));
        for (Eigen::Index k = 0; k < x.size(); ++k) {
          ASSERT_LE(solved->derivatives[v][k].lower(), derivative[k] + 1e-12);
          ASSERT_GE(solved->derivatives[v][k].upper(), derivative[k] - 1e-12);
        }
      }
    }
  }
}

TEST(ParametricLinearSystem, PointSystemsAreSolvedToRoundingErrors) {
  std::mt19937_64 random(5);
  ParametricLinearSystem system = random_system(random, 0);
  system.variations.clear();
  const auto solved = solve(system);
  ASSERT_TRUE(solved);
  for (const Interval& x : solved->solution) EXPECT_LE(x.upper() - x.lower(), 1e-15);
}

TEST(ParametricLinearSystem, SingularOnesHaveNoProof) {
  const IntervalVector zero = IntervalVector::Zero(2);
  const IntervalMatrix identity = IntervalMatrix::Identity(2, 2);
  ParametricLinearSystem system{Eigen::VectorXd::Zero(2), identity, zero, {{Interval(-1, 1), identity, zero}}};
  EXPECT_FALSE(solve(system));
  system.variations[0].deviation = Interval(-0.99, 0.99);
  EXPECT_TRUE(solve(system));
  system.matrix = IntervalMatrix::Zero(2, 2);
  EXPECT_FALSE(solve(system));
}

TEST(MeanValueRange, FindsExtremesWithinAndOnTheBorder) {
  // x^2 - x y on [-1, 2] x [0, 1]: least -1/4 at (1/2, 1), greatest 4 at (2, 0).
  const DifferentiableFunction f{
      [](std::span<const Interval> p) { return p[0] * p[0] - p[0] * p[1]; },
      [](std::span<const Interval> p, std::uint32_t i) { return i == 0 ? p[0] + p[0] - p[1] : -p[0]; }};
  const Box box{Interval(-1, 2), Interval(0, 1)};
  const Enclosure found = range(f, box, std::array<std::uint32_t, 2>{0, 1});
  EXPECT_LE(found.lo, -0.25);
  EXPECT_NEAR(found.lo, -0.25, 1e-5);
  EXPECT_GE(found.hi, 4);
  EXPECT_NEAR(found.hi, 4, 1e-9);
}

TEST(MeanValueRange, WithoutVariablesIsTheValue) {
  const DifferentiableFunction f{[](std::span<const Interval> p) { return p[0] + p[0]; },
                                 [](std::span<const Interval>, std::uint32_t) { return Interval(2); }};
  EXPECT_EQ(range(f, {Interval(3)}, {}), (Enclosure{6, 6}));
}

TEST(MeanValueRange, ValuesBeyondBinary64AreUnbounded) {
  const DifferentiableFunction f{[](std::span<const Interval>) -> Interval { throw std::domain_error("undefined"); },
                                 [](std::span<const Interval>, std::uint32_t) { return Interval(2); }};
  EXPECT_EQ(range(f, {Interval(3)}, {}), (Enclosure{-infinity, infinity}));
}

}  // namespace
}  // namespace verisq::stance
