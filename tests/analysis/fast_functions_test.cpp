// Powers and arctangents of search against MPFR at 127 bits: contained, and within the stated error.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "tests/oracle/random_cases.hpp"
#include "verify/numbers/functions.hpp"

namespace verisq::verify {
namespace {

using oracle::RandomCases;

constexpr double kPrecision = 0x1p-52;

double random_base(RandomCases& random) {
  switch (random.choice(5)) {
    case 0: return random.uniform(0.0, 1.0);
    case 1: return random.uniform(1.0, 2.0);
    case 2: return random.log_uniform(1e-320, 1.0);
    case 3: return 1.0 + random.log_uniform(1e-16, 1.0);
    default: return 1.0 - random.log_uniform(1e-16, 1.0);
  }
}

double random_exponent(RandomCases& random) {
  switch (random.choice(4)) {
    case 0: return random.uniform(0.0, 2.0);
    case 1: return random.uniform(1.0, 40.0);
    case 2: return random.log_uniform(1e-320, 1e308);
    default: return random.log_uniform(1e-3, 1e3);
  }
}

TEST(FastFunctionsTest, PowersAreBoundedAsClosely) {
  RandomCases random(1);
  for (int i = 0; i < 200000; ++i) {
    const double base = random_base(random);
    const double exponent = random_exponent(random);
    const Real exact = power(Real(base), Real(exponent), Direction::down);
    const double lower = fast_power(base, exponent, Direction::down);
    const double upper = fast_power(base, exponent, Direction::up);
    ASSERT_LE(Real(lower), exact) << base << " " << exponent;
    ASSERT_GE(Real(upper), exact) << base << " " << exponent;
    const double value = exact.to_double(Direction::up);
    if (value < 1e-300 || std::isinf(value)) continue;
    const double error = kPrecision * (12.0 * std::fabs(std::log(value)) + 8.0) * value;
    ASSERT_LE(value - lower, error) << base << " " << exponent;
    ASSERT_LE(upper - value, error) << base << " " << exponent;
    ASSERT_TRUE(base > 1.0 ? lower >= 1.0 : upper <= 1.0) << base << " " << exponent;
  }
}

/// Ulps about x.
template <class Check>
void for_neighbours(double x, const Check& check) {
  constexpr int reach = 40;
  double y = x;
  for (int i = 0; i < reach; ++i) y = std::nextafter(y, 0.0);
  for (int i = 0; i <= 2 * reach; ++i, y = std::nextafter(y, 4.0)) check(y);
}

void expect_bounds_power(double base, double exponent) {
  const Real lower = power(Real(base), Real(exponent), Direction::down);
  const Real upper = power(Real(base), Real(exponent), Direction::up);
  ASSERT_LE(Real(fast_power(base, exponent, Direction::down)), lower) << base << " " << exponent;
  ASSERT_GE(Real(fast_power(base, exponent, Direction::up)), upper) << base << " " << exponent;
}

/// Where the terms of the error analysis are largest: the reduced argument of the logarithm at the ends of its range
/// (base = 2^(n - 1/2)), its two terms of opposite signs (just above those), the reduced argument of the exponential at
/// the ends of its range (power = 2^(n + 1/2)), and long exponents, which magnify the error of the logarithm.
TEST(FastFunctionsTest, PowersWhereTheErrorsAreLargest) {
  for (const int n : {1, 0, -1, -2, -3, -50, -999}) {
    for (const double exponent : {0.5, 1.0, 1.5, 1.0 / 3.0, 0.7, 3.0}) {
      for_neighbours(std::ldexp(std::sqrt(0.5), n), [&](double base) { expect_bounds_power(base, exponent); });
      for_neighbours(std::ldexp(1.0, n), [&](double base) { expect_bounds_power(base, exponent); });
    }
  }
  for (const double base : {0.3, 0.7, 0.75, 0.99, 1.01, 1.3, 1.5, 1.99, 2.0}) {
    for (const double n : {0.0, 1.0, 5.0, 300.0, 1009.0}) {
      const double exponent = std::fabs((n + 0.5) / std::log2(base));
      for_neighbours(exponent, [&](double e) { expect_bounds_power(base, e); });
      // The ends of the range of the own exponential.
      for_neighbours(std::fabs(700.0 / std::log(base)), [&](double e) { expect_bounds_power(base, e); });
    }
  }
}

TEST(FastFunctionsTest, PowersAtTheEndsOfTheirDomain) {
  for (const double exponent : {0.0, 5e-324, 1.0, 40.0, 1e308}) {
    EXPECT_EQ(fast_power(1.0, exponent, Direction::down), 1.0);
    EXPECT_EQ(fast_power(1.0, exponent, Direction::up), 1.0);
    for (const double base : {0.0, 5e-324, 0.5, 2.0}) {
      const Real exact = power(Real(base), Real(exponent), Direction::up);
      EXPECT_LE(Real(fast_power(base, exponent, Direction::down)), exact) << base << " " << exponent;
      EXPECT_GE(Real(fast_power(base, exponent, Direction::up)), power(Real(base), Real(exponent), Direction::down));
    }
  }
}

TEST(FastFunctionsTest, ArctangentQuotientsAreBoundedAsClosely) {
  RandomCases random(2);
  for (int i = 0; i < 100000; ++i) {
    const double t = random.choice(2) == 0 ? random.uniform(0.0, 1.0) : random.log_uniform(1e-320, 1.0);
    const PreciseInterval exact = arctangent_quotient(PreciseInterval(Real(t)));
    const double lower = fast_arctangent_quotient(t, Direction::down);
    const double upper = fast_arctangent_quotient(t, Direction::up);
    ASSERT_LE(Real(lower), exact.lower()) << t;
    ASSERT_GE(Real(upper), exact.upper()) << t;
    ASSERT_LE(upper - lower, 2.0 * 0x1p-48) << t;
  }
  // Where a halving of the angle more or less is taken, and the last term of the series is largest: tan(2^n atan(1/8)).
  for (const double start : {0.0, 0.125, 0.125 * 16.0 / 7.875, 0.5534412, 1.0}) {
    for_neighbours(start, [](double t) {
      if (t > 1.0) return;
      const PreciseInterval exact = arctangent_quotient(PreciseInterval(Real(t)));
      EXPECT_LE(Real(fast_arctangent_quotient(t, Direction::down)), exact.lower()) << t;
      EXPECT_GE(Real(fast_arctangent_quotient(t, Direction::up)), exact.upper()) << t;
    });
  }
}

}  // namespace
}  // namespace verisq::verify
