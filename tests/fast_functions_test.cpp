// Powers and arctangents of search against MPFR at 127 bits: contained, and within the stated error.
#include "verify/fast_functions.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "tests/oracle/random_cases.hpp"
#include "verify/trigonometry.hpp"

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
  for (const double t : {0.0, 0.125, std::nextafter(0.125, 1.0), 1.0}) {
    const PreciseInterval exact = arctangent_quotient(PreciseInterval(Real(t)));
    EXPECT_LE(Real(fast_arctangent_quotient(t, Direction::down)), exact.lower()) << t;
    EXPECT_GE(Real(fast_arctangent_quotient(t, Direction::up)), exact.upper()) << t;
  }
}

}  // namespace
}  // namespace verisq::verify
