/// What the host tells the kernels about a primitive: numbers that their proofs rely on as bounds are bounds, by MPFR
/// at 200 bits, and nearly as tight as binary64 allows.
#include "host/batches/primitive_parameters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

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

}  // namespace
}  // namespace verisq::device
