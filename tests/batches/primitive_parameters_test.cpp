/// What the host tells the kernels about a primitive: numbers that their proofs rely on as bounds are bounds, by MPFR
/// at 200 bits, and nearly as tight as binary64 allows.
#include "host/device/primitive_parameters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "tests/oracle/mixed_norm.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/real.hpp"

namespace verisq::device {
namespace {

using oracle::Real;
using oracle::text;

constexpr int solids = 2000;
constexpr double two_steps = 0x1p-51;  // of a binary64 number, relative to it

void expect_below(double bound, const Real& exact) {
  EXPECT_TRUE(Real(bound) <= exact) << bound << " bounds " << text(exact) << " from below";
  EXPECT_TRUE(Real(bound) >= exact * (1 - Real(two_steps))) << bound << " bounds " << text(exact) << " loosely";
}

void expect_above(double bound, const Real& exact) {
  EXPECT_TRUE(Real(bound) >= exact) << bound << " bounds " << text(exact) << " from above";
  EXPECT_TRUE(Real(bound) <= exact * (1 + Real(two_steps))) << bound << " bounds " << text(exact) << " loosely";
}

class PrimitiveParametersTest : public testing::Test {
 protected:
  /// Calls `expect(primitive, parameters)` for many solids.
  template <class Expect>
  static void for_many_solids(const Expect& expect) {
    oracle::RandomCases random(20);
    for (int i = 0; i < solids && !HasFailure(); ++i) {
      const Primitive primitive = random.solid();
      expect(primitive, primitive_parameters(primitive, scale_exponent({"", {primitive}})));
    }
  }
};

TEST_F(PrimitiveParametersTest, SolidLiesInTheScaledOneOfTheExponentsRoundedDown) {
  for_many_solids([](const Primitive& primitive, const PrimitiveParameters& parameters) {
    Real d = 0;
    for (std::size_t i = 0; i < 2; ++i)
      d += 1 / Real(parameters.p_down[i]) - Real(primitive.superquadric.exponents[i]) / 2;
    EXPECT_GE(d, 0);
    expect_above(parameters.containment_up, pow(Real(2), d));
  });
  EXPECT_EQ(primitive_parameters({"", {{1.0, 1.0, 1.0}, {1.0, 0.5}}, {}}, 0).containment_up, 1.0);
}

/// Nothing rounds where the rotation only permutes axes; next to nothing is not nothing.
TEST_F(PrimitiveParametersTest, RotationsThatPermuteAxesAreExact) {
  const auto pose_error = [](const std::array<double, 4>& quaternion) {
    return primitive_parameters({"", {{1.0, 1.0, 2.0}, {1.0, 0.5}}, {{}, quaternion}, {}}, 0).pose_error;
  };
  for (const double length : {0x1p-1074, 0x1p-1022, 0x1p-500, 1.0, 0x1p500, 0x1p1023}) {
    EXPECT_EQ(pose_error({length, 0.0, 0.0, 0.0}), 0.0);
    EXPECT_EQ(pose_error({length, 0.0, -length, 0.0}), 0.0);
    EXPECT_EQ(pose_error({length, length, length, length}), 0.0);
  }
  EXPECT_GT(pose_error({1e300, 1e-300, 0.0, 0.0}), 0.0);
  EXPECT_GT(pose_error({0.0, 0x1p-1074, 1e-3, 0.0}), 0.0);
}

/// The greatest length of boundary points in directions (a1, s a2, t a3), s and t of all orders of magnitude.
long double farthest_point(const Superquadric& solid) {
  const oracle::MixedNorm<long double> norm(solid);
  long double farthest = 0.0L;
  for (int i = -40; i <= 40; ++i) {
    for (int k = -40; k <= 40; ++k) {
      const std::array<long double, 3> x{solid.semi_axes[0], std::pow(1.3L, i) * solid.semi_axes[1],
                                         std::pow(1.3L, k) * solid.semi_axes[2]};
      farthest = std::max(farthest, std::hypot(x[0], x[1], x[2]) / norm.gauge(x));
    }
  }
  return farthest;
}

TEST_F(PrimitiveParametersTest, ReachIsThatOfTheFarthestPoint) {
  oracle::RandomCases random(21);
  for (int i = 0; i < 20; ++i) {
    const Superquadric solid = random.solid().superquadric;
    const PrimitiveParameters parameters = primitive_parameters({"", solid, {}}, 0);
    const auto farthest = static_cast<double>(farthest_point(solid));
    EXPECT_GE(parameters.reach_up, farthest * (1.0 - 1e-15));
    EXPECT_LE(parameters.reach_up, farthest * 1.02);
    EXPECT_LE(parameters.reach_up, parameters.circumradius_up);
  }
}

TEST_F(PrimitiveParametersTest, ExponentsAreBounded) {
  for_many_solids([](const Primitive& primitive, const PrimitiveParameters& parameters) {
    for (std::size_t i = 0; i < 2; ++i) {
      const Real e(primitive.superquadric.exponents[i]);
      expect_below(parameters.p_down[i], 2 / e);
      expect_above(parameters.inverse_p_up[i], e / 2);
      // Of conjugate exponents near infinity smaller ones are told: norms fall as exponents rise.
      if (e < 2 - Real(0x1p-50)) expect_below(parameters.conjugate_down[i], 2 / (2 - e));
      if (e < 2 - Real(0x1p-50)) expect_above(parameters.inverse_conjugate_up[i], (2 - e) / 2);
      EXPECT_TRUE(Real(parameters.conjugate_down[i]) * (2 - e) <= 2) << primitive.superquadric.exponents[i];
      EXPECT_TRUE(Real(parameters.inverse_conjugate_up[i]) * 2 >= 2 - e) << primitive.superquadric.exponents[i];
      EXPECT_GE(parameters.inverse_conjugate_up[i] * parameters.conjugate_down[i], 1.0 - 2.0 * two_steps);
    }
  });
}

TEST_F(PrimitiveParametersTest, AxesAreExactAndTheirInversesBounded) {
  for_many_solids([](const Primitive& primitive, const PrimitiveParameters& parameters) {
    const int scale = scale_exponent({"", {primitive}});
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(std::ldexp(parameters.semi_axes[i], -scale), primitive.superquadric.semi_axes[i]);
      expect_above(parameters.inverse_axes_up[i], 1 / Real(parameters.semi_axes[i]));
    }
    const double largest = *std::max_element(std::begin(parameters.semi_axes), std::end(parameters.semi_axes));
    EXPECT_TRUE(largest >= 1.0 && largest < 2.0);
  });
}

TEST_F(PrimitiveParametersTest, TheBallsAboutTheCentreAreInsideAndOutside) {
  for_many_solids([](const Primitive& primitive, const PrimitiveParameters& parameters) {
    const auto& a = parameters.semi_axes;
    expect_above(parameters.circumradius_up, sqrt(Real(a[0]) * a[0] + Real(a[1]) * a[1] + Real(a[2]) * a[2]));
    // The ball of the shortest semi-axis lies in the ellipsoid, which lies in the solid for exponents up to 1; the
    // insphere of the octahedron lies in any convex superquadric.
    const Real octahedron = 1 / sqrt(1 / (Real(a[0]) * a[0]) + 1 / (Real(a[1]) * a[1]) + 1 / (Real(a[2]) * a[2]));
    const bool blunt = primitive.superquadric.exponents[0] <= 1.0 && primitive.superquadric.exponents[1] <= 1.0;
    expect_below(parameters.inradius_down, blunt ? Real(std::min({a[0], a[1], a[2]})) : octahedron);
  });
}

/// The local point as the kernels compute it, against the exact one.
TEST_F(PrimitiveParametersTest, TheLocalPointIsAsNearAsPromised) {
  oracle::RandomCases random(21);
  double worst = 0.0;  // of what is promised
  for (int i = 0; i < solids; ++i) {
    Primitive primitive = random.solid();
    if (i % 4 == 0)
      primitive.pose = {{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}, {0, 0, 1, 0}};
    const PrimitiveParameters parameters = primitive_parameters(primitive, 0);
    const Point x = random.point(primitive).point;
    std::array<double, 3> d{};
    std::array<Real, 3> exact_d{};
    for (std::size_t k = 0; k < 3; ++k) {
      d[k] = x[k] - parameters.translation[k];
      exact_d[k] = Real(x[k]) - primitive.pose.translation[k];
    }
    const auto [w, qx, qy, qz] = primitive.pose.quaternion;
    const Real n = Real(w) * w + Real(qx) * qx + Real(qy) * qy + Real(qz) * qz;
    // The inverse rotation: d + 2 (u x (u x d) - w (u x d)) / n.
    const std::array<Real, 3> u{Real(qx), Real(qy), Real(qz)};
    const auto cross = [](const std::array<Real, 3>& a, const std::array<Real, 3>& b) {
      return std::array<Real, 3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const std::array<Real, 3> t = cross(u, exact_d);
    const std::array<Real, 3> tt = cross(u, t);
    Real squared = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double* const row = parameters.rotation + 3 * k;
      const double computed = std::fma(row[0], d[0], std::fma(row[1], d[1], row[2] * d[2]));
      const Real error = computed - (exact_d[k] + 2 * (tt[k] - Real(w) * t[k]) / n);
      squared += error * error;
    }
    const double promised = parameters.pose_error * (std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]));
    ASSERT_TRUE(sqrt(squared) <= Real(promised)) << text(sqrt(squared)) << ", promised " << promised;
    if (promised > 0.0) worst = std::max(worst, (sqrt(squared) / promised).convert_to<double>());
  }
  EXPECT_GT(worst, 0.1) << "the bound is never nearly reached: are the cases hard enough?";
}

/// What a tapered solid is, by the map of include/verisq/model.hpp, against what the kernels take it for.
class TaperParametersTest : public PrimitiveParametersTest {
 protected:
  static constexpr int points_of_solid = 30;

  /// k, as the solid has it.
  static Real exact_taper(const Primitive& primitive) {
    const Real ratio(primitive.superquadric.taper);
    return (ratio - 1) / (ratio + 1);
  }

  /// A point of the untapered surface: near an end, where a taper is felt most, one time in two.
  static oracle::Vector surface_point(oracle::RandomCases& random, const oracle::MixedNorm<Real>& norm) {
    const Point direction = random.direction();
    const double flattening = random.choice(2) == 0 ? 1.0 : random.log_uniform(1e-3, 1.0);
    const auto& a = norm.semi_axes();
    const oracle::Vector x{a[0] * direction[0] * flattening, a[1] * direction[1] * flattening, a[2] * direction[2]};
    return oracle::scaled<Real>(x, 1 / norm.gauge(x));
  }

  /// Where the map takes a point of Eq. (1).
  static oracle::Vector tapered(const oracle::Vector& x, const Real& k, const Real& a3) {
    const Real z = (x[2] - k * a3) / (1 - k * x[2] / a3);
    const Real section = 1 + k * z / a3;
    return {section * x[0], section * x[1], z};
  }

  /// Calls `expect(primitive, parameters, norm, random)` for solids of many ratios.
  template <class Expect>
  static void for_many_ratios(int count, const Expect& expect) {
    oracle::RandomCases random(22);
    for (int i = 0; i < count && !HasFailure(); ++i) {
      Primitive primitive = random.solid();
      double& ratio = primitive.superquadric.taper;
      ratio = random.log_uniform(smallest_taper, largest_taper);
      if (i % 8 == 0) ratio = 1.0 + (random.choice(2) == 0 ? 1.0 : -1.0) * random.log_uniform(0x1p-52, 0.1);
      const PrimitiveParameters parameters = primitive_parameters(primitive, scale_exponent({"", {primitive}}));
      Superquadric scaled = primitive.superquadric;
      std::copy_n(parameters.semi_axes, 3, scaled.semi_axes.begin());
      expect(primitive, parameters, oracle::MixedNorm<Real>(scaled), random);
    }
  }

  static PrimitiveParameters of_ratio(double ratio) {
    return primitive_parameters({"", {{1.0, 0.75, 1.25}, {0.5, 1.5}, ratio}, {}}, 0);
  }
};

TEST_F(TaperParametersTest, ConstantsBoundThoseOfTheRoundedTaper) {
  for_many_ratios(solids, [](const Primitive& primitive, const PrimitiveParameters& parameters, const auto&, auto&) {
    const Real k = exact_taper(primitive);
    const Real rounded(parameters.taper);
    EXPECT_TRUE(abs(rounded - k) <= abs(k) * Real(0x1p-53)) << primitive.superquadric.taper;
    expect_below(parameters.fall_down, 1 - rounded * rounded);
    expect_above(parameters.fall_up, 1 - rounded * rounded);
    EXPECT_TRUE(Real(parameters.fall_down) <= 1 - rounded * rounded &&
                Real(parameters.fall_up) >= 1 - rounded * rounded);
    EXPECT_TRUE(abs(rounded * parameters.semi_axes[2] - parameters.focus) <= Real(0x1p-53) * abs(parameters.focus));
  });
}

/// About the focus, every point of the solid of the rounded taper: what the kernels prove lower ends from afar by.
TEST_F(TaperParametersTest, ReachIsBeyondEveryPointSeenFromTheFocus) {
  double worst = 0.0;
  for_many_ratios(solids / 8, [&](const Primitive& primitive, const PrimitiveParameters& parameters, const auto& norm,
                                  oracle::RandomCases& random) {
    const Real k(parameters.taper);
    const Real a3(parameters.semi_axes[2]);
    for (int n = 0; n < points_of_solid; ++n) {
      oracle::Vector w = tapered(surface_point(random, norm), k, a3);
      w[2] += k * a3;
      const Real ratio = oracle::length<Real>(w) / parameters.reach_up;
      EXPECT_TRUE(ratio <= 1) << text(ratio) << " of what is promised, taper " << primitive.superquadric.taper;
      worst = std::max(worst, ratio.convert_to<double>());
    }
    const PrimitiveParameters without =
        primitive_parameters({"", {primitive.superquadric.semi_axes, primitive.superquadric.exponents}, {}},
                             scale_exponent({"", {primitive}}));
    expect_above(parameters.reach_up, Real(without.reach_up) * (1 + abs(k)));
  });
  EXPECT_GT(worst, 0.9) << "the bound is never nearly reached: are the cases hard enough?";
}

/// Each point of the solid, with the exact k, is near that of the solid that the kernels know, about the rounded focus.
TEST_F(TaperParametersTest, PointsOfTheSolidAreAsNearAsPromised) {
  double worst = 0.0;  // of what is promised
  for_many_ratios(solids / 4, [&](const Primitive& primitive, const PrimitiveParameters& parameters, const auto& norm,
                                  oracle::RandomCases& random) {
    const Real k(parameters.taper);
    const Real a3(parameters.semi_axes[2]);
    const Real promised(parameters.taper_error);
    for (int n = 0; n < points_of_solid; ++n) {
      const oracle::Vector x = surface_point(random, norm);
      oracle::Vector seen = tapered(x, k, a3);
      seen[2] += k * a3 - Real(parameters.focus);  // the origin, where the kernels think it is
      const Real apart = oracle::length<Real>(oracle::difference(tapered(x, exact_taper(primitive), a3), seen));
      EXPECT_TRUE(apart <= promised) << text(apart) << ", promised " << text(promised) << ", taper "
                                     << primitive.superquadric.taper;
      if (promised > 0) worst = std::max(worst, (apart / promised).convert_to<double>());
    }
    EXPECT_LE(parameters.taper_error, 0x1p-45 * parameters.circumradius_up);
  });
  EXPECT_GT(worst, 0.1) << "the bound is never nearly reached: are the cases hard enough?";
}

TEST_F(TaperParametersTest, WithoutATaperNothingChanges) {
  const PrimitiveParameters parameters = of_ratio(1.0);
  EXPECT_EQ(parameters.taper, 0.0);
  EXPECT_EQ(parameters.fall_down, 1.0);
  EXPECT_EQ(parameters.fall_up, 1.0);
  EXPECT_EQ(parameters.log_fall, 0.0);
  EXPECT_EQ(parameters.focus, 0.0);
  EXPECT_EQ(parameters.taper_error, 0.0);
}

TEST_F(TaperParametersTest, TapersThatAreBinary64NumbersAreExact) {
  for (const auto& [ratio, taper] : {std::pair{3.0, 0.5}, std::pair{7.0, 0.75}}) {
    const PrimitiveParameters parameters = of_ratio(ratio);
    EXPECT_EQ(parameters.taper, taper);
    EXPECT_EQ(parameters.fall_down, 1.0 - taper * taper);
    EXPECT_EQ(parameters.fall_up, 1.0 - taper * taper);
    EXPECT_EQ(parameters.focus, taper * 1.25);
    EXPECT_EQ(parameters.taper_error, 0.0);
    expect_above(parameters.reach_up, Real(of_ratio(1.0).reach_up) * (1 + Real(taper)));
  }
}

}  // namespace
}  // namespace verisq::device
