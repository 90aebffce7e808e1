/// Contact, friction and control over doubles, intervals and duals: against sampling and known values.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <random>
#include <stdexcept>

#include "verify/stance/standing.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::stance {
namespace {

using Vector = Eigen::Vector3d;

bool contains(const Interval& a, double value) {
  return a.lower() <= value && value <= a.upper();
}

/// Within a few rounding errors of the plain evaluation that it is compared with.
testing::AssertionResult encloses(const Interval& a, double value) {
  const double slack = 1e-12 * (1.0 + std::fabs(value));
  if (a.lower() <= value + slack && value - slack <= a.upper()) return testing::AssertionSuccess();
  return testing::AssertionFailure() << fmt::format("{:.17g} is not in [{:.17g}, {:.17g}]", value, a.lower(),
                                                    a.upper());
}

class Random {
 public:
  double operator()(double lowest, double highest) { return std::uniform_real_distribution(lowest, highest)(engine_); }
  double within(const Interval& a) { return (*this)(a.lower(), std::nextafter(a.upper(), infinity)); }
  Interval interval(double lowest, double highest) {
    const double a = (*this)(lowest, highest);
    const double b = (*this)(lowest, highest);
    return {std::min(a, b), std::max(a, b)};
  }

 private:
  std::mt19937 engine_{6};
};

// Damping.

/// ln((1 + D)/(1 - D e)) - D (1 + e) at fifty digits, whose sign tells the side of D on which the root is.
double relation(double damping, double restitution) {
  using Fifty = boost::multiprecision::cpp_bin_float_50;
  const Fifty d = damping;
  const Fifty e = restitution;
  return static_cast<double>(Fifty(log((1 + d) / (1 - d * e)) - d * (1 + e)));
}

TEST(ContactDamping, SolvesTheRelationToTheLastPlace) {
  EXPECT_NEAR(damping_factor(0.1), 9.99815939749567, 1e-13);  // docs/stance.md §4: 9.998
  for (const double e : {0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 0.99}) {
    const Interval d = damping_factor(Interval(e));
    EXPECT_LE(d.upper(), std::nextafter(d.lower(), infinity));
    EXPECT_LT(relation(std::nextafter(d.lower(), 0.0), e), 0.0) << e;
    EXPECT_GT(relation(std::nextafter(d.upper(), infinity), e), 0.0) << e;
    EXPECT_GT(d.lower(), 1.0 / e - 1.0) << "the trivial root is 0";
    EXPECT_TRUE(contains(d, damping_factor(e)));
  }
}

TEST(ContactDamping, SmallRestitutionsDampAlmostAsTheirReciprocal) {
  // 1 - D e is about exp(-1/e)/e: far below the last place of D.
  for (const double e : {1e-2, 1e-3, 1e-8, 1e-300}) {
    const Interval d = damping_factor(Interval(e));
    EXPECT_LE(d.upper() - d.lower(), 4e-16 / e) << e;
    EXPECT_TRUE(contains(d, 1.0 / e)) << e;
  }
}

TEST(ContactDamping, VanishesWithElasticContact) {
  EXPECT_EQ(damping_factor(Interval(1)).upper(), 0.0);
  const double almost = std::nextafter(1.0, 0.0);
  // D = 3 (1 - e)/2 + ...
  const Interval d = damping_factor(Interval(almost));
  EXPECT_LE(d.upper(), std::nextafter(d.lower(), infinity));
  EXPECT_NEAR(d.lower() / (1.0 - almost), 1.5, 1e-6);
  EXPECT_NEAR(d.upper() / (1.0 - almost), 1.5, 1e-6);
}

TEST(ContactDamping, FallsWithTheRestitution) {
  const Interval d = damping_factor(Interval(0.1, 0.2));
  EXPECT_EQ(d.lower(), damping_factor(Interval(0.2)).lower());
  EXPECT_EQ(d.upper(), damping_factor(Interval(0.1)).upper());
  double before = infinity;
  for (double e = 0.01; e < 1.0; e += 0.01) {
    EXPECT_LT(damping_factor(Interval(e)).upper(), before) << e;
    before = damping_factor(Interval(e)).lower();
  }
}

TEST(ContactDamping, RefusesWhatIsNoRestitution) {
  for (const Interval& e : {Interval(0, 1), Interval(-0.1, 0.1), Interval(0.5, 1.1), Interval(0)}) {
    EXPECT_THROW((void)damping_factor(e), std::domain_error);
  }
}

TEST(ContactDamping, SlopeIsThatOfDifferenceQuotients) {
  for (const double e : {0.02, 0.1, 0.2, 0.5, 0.9}) {
    const double h = 1e-5 * e;
    const double quotient = (damping_factor(e + h) - damping_factor(e - h)) / (2.0 * h);
    const double slope = damping_factor(Dual<double>::variable(e)).partial[0];
    EXPECT_NEAR(slope / quotient, 1.0, 1e-6) << e;
    const Interval range(e - h, e + h);
    const Dual<Interval> enclosed = damping_factor(Dual<Interval>::variable(range));
    EXPECT_TRUE(encloses(enclosed.partial[0], slope)) << e;
    EXPECT_TRUE(encloses(enclosed.value, damping_factor(e))) << e;
  }
}

// In one piece e (1 + D) - 1 has no sign over this range: the slope had no bound.
TEST(ContactDamping, SlopeHasABoundOverAWideRange) {
  const Interval range(0.09, 0.12);
  const Interval slopes = damping_slopes(range);
  for (const double e : {0.09, 0.1, 0.11, 0.12})
    EXPECT_TRUE(encloses(slopes, damping_slope(e, damping_factor(e)))) << e;
  const double steepest = damping_slope(0.09, damping_factor(0.09));
  const double flattest = damping_slope(0.12, damping_factor(0.12));
  EXPECT_GT(slopes.lower(), 1.5 * steepest);  // both are below 0
  EXPECT_LT(slopes.upper(), 0.7 * flattest);
}

// Normal force.

TEST(NormalForce, FollowsTheLaw) {
  const HuntCrossley<double> law{.stiffness = 1e5, .exponent = 1.5, .damping = 5.0, .impact_velocity = 0.5};
  EXPECT_EQ(normal_force(law, -0.001, 1.0), 0.0);
  EXPECT_EQ(normal_force(law, 0.0, 1.0), 0.0);
  EXPECT_NEAR(normal_force(law, 0.01, 0.0), 1e5 * 1e-3, 1e-9);
  EXPECT_NEAR(normal_force(law, 0.01, 0.5), 6.0 * 1e5 * 1e-3, 1e-9);
  EXPECT_EQ(normal_force(law, 0.01, -0.2), 0.0) << "the ground does not pull";
}

TEST(NormalForce, BoxesAndDerivativesContainSamples) {
  using D = Dual<Interval, 3>;
  Random random;
  for (int i = 0; i < 300; ++i) {
    const double exponent = i % 2 == 0 ? 1.0 : 1.5;
    const Interval penetration = random.interval(-0.005, 0.01);
    const Interval rate = random.interval(-0.5, 0.5);
    const Interval damping = random.interval(1.0, 10.0);
    const HuntCrossley<D> law{D(1e5), exponent, D::variable(damping, 2), 0.5};
    const D force = normal_force(law, D::variable(penetration, 0), D::variable(rate, 1));
    EXPECT_GE(force.value.lower(), 0.0);
    const Interval plain =
        normal_force(HuntCrossley<Interval>{Interval(1e5), exponent, damping, 0.5}, penetration, rate);
    const auto sample = [&](const Vector& at) {
      return normal_force(HuntCrossley<double>{1e5, exponent, at[2], 0.5}, at[0], at[1]);
    };
    for (int j = 0; j < 50; ++j) {
      const Vector a(random.within(penetration), random.within(rate), random.within(damping));
      const Vector b(random.within(penetration), random.within(rate), random.within(damping));
      EXPECT_TRUE(encloses(force.value, sample(a)));
      EXPECT_TRUE(encloses(plain, sample(a)));
      // The mean value theorem, across every kink.
      Interval change(0);
      for (int k = 0; k < 3; ++k) change += force.partial[static_cast<std::size_t>(k)] * Interval(b[k] - a[k]);
      const double slack = 1e-9 * (sample(a) + sample(b));
      EXPECT_LE(change.lower(), sample(b) - sample(a) + slack);
      EXPECT_GE(change.upper(), sample(b) - sample(a) - slack);
    }
  }
}

// Friction and control.

TEST(Friction, CoefficientGoesFromStaticToDynamic) {
  const FrictionLaw<double> law{.static_coefficient = 0.9, .dynamic_coefficient = 0.5, .stribeck_velocity = 0.1};
  EXPECT_EQ(friction_coefficient(law, 0.0), 0.9);
  EXPECT_NEAR(friction_coefficient(law, 0.1), 0.5 + 0.4 * std::exp(-1.0), 1e-15);
  EXPECT_NEAR(friction_coefficient(law, -0.1), friction_coefficient(law, 0.1), 0.0);
  EXPECT_NEAR(friction_coefficient(law, 10.0), 0.5, 1e-15);
}

TEST(Friction, BoxesContainSamplesAndAreTight) {
  // Table 1 of the paper: the coefficients' ranges overlap.
  const FrictionLaw<Interval> law{Interval(0.5, 2.0), Interval(0.08, 2.3), 0.1};
  const Interval velocity(-0.05, 0.2);
  const Interval coefficient = friction_coefficient(law, velocity);
  Interval sampled(1);
  Random random;
  for (int i = 0; i < 5000; ++i) {
    const FrictionLaw<double> some{random.within(law.static_coefficient), random.within(law.dynamic_coefficient), 0.1};
    const double value = friction_coefficient(some, random.within(velocity));
    EXPECT_TRUE(encloses(coefficient, value));
    sampled = hull(sampled, Interval(value));
  }
  EXPECT_GE(coefficient.lower(), 0.08);
  EXPECT_LE(coefficient.upper(), 2.3);
  EXPECT_LT(coefficient.upper() - sampled.upper(), 0.1);
  EXPECT_LT(sampled.lower() - coefficient.lower(), 0.1);
}

}  // namespace
}  // namespace verisq::stance
