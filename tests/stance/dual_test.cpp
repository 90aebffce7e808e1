/// Derivatives over intervals: against differences, samples and the kinks of |x|, sgn, max, min and clamp.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include "verify/stance/scalar.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::stance {
namespace {

using IntervalDual = Dual<Interval>;

MATCHER_P2(IsInterval, lower, upper, "") {
  return arg.lower() == lower && arg.upper() == upper;
}

bool contains(const Interval& outer, const Interval& inner) {
  return outer.lower() <= inner.lower() && inner.upper() <= outer.upper();
}

bool intersect(const Interval& a, const Interval& b) {
  return a.lower() <= b.upper() && b.lower() <= a.upper();
}

/// Over an interval of the variable.
IntervalDual over(double lower, double upper) {
  return IntervalDual::variable(Interval(lower, upper));
}

Interval derivative(const IntervalDual& f) {
  return f.partial[0];
}

TEST(Kink, AbsoluteValueHasTheHullOfBothSlopes) {
  EXPECT_THAT(derivative(abs(over(-0.1, 0.2))), IsInterval(-1, 1));
  EXPECT_THAT(abs(over(-0.1, 0.2)).value, IsInterval(0, 0.2));
  EXPECT_THAT(derivative(abs(over(0, 0.2))), IsInterval(-1, 1));
  EXPECT_THAT(derivative(abs(over(-0.2, 0))), IsInterval(-1, 1));
  EXPECT_THAT(derivative(abs(over(0, 0))), IsInterval(-1, 1));
  EXPECT_THAT(derivative(abs(over(0.1, 0.2))), IsInterval(1, 1));
  EXPECT_THAT(derivative(abs(over(-0.2, -0.1))), IsInterval(-1, -1));
}

TEST(Kink, SignJumpsWithAllSlopesUpToInfinity) {
  EXPECT_THAT(sgn(over(-0.1, 0.2)).value, IsInterval(-1, 1));
  EXPECT_THAT(sgn(over(0, 0)).value, IsInterval(-1, 1));
  EXPECT_THAT(derivative(sgn(over(-0.1, 0.2))), IsInterval(0, infinity));
  EXPECT_THAT(derivative(sgn(-over(-0.1, 0.2))), IsInterval(-infinity, 0));
  EXPECT_THAT(derivative(sgn(over(0.1, 0.2))), IsInterval(0, 0));
  EXPECT_THAT(derivative(sgn(IntervalDual(Interval(-1, 1)))), IsInterval(0, 0));
}

TEST(Kink, MaximumAndMinimumHaveTheHullOfTheirOperands) {
  const IntervalDual x = over(-1, 2);
  EXPECT_THAT(max(x, IntervalDual(0)).value, IsInterval(0, 2));
  EXPECT_THAT(derivative(max(x, IntervalDual(0))), IsInterval(0, 1));
  EXPECT_THAT(derivative(max(x, IntervalDual(2))), IsInterval(0, 1)) << "a tie at an end";
  EXPECT_THAT(derivative(max(x, IntervalDual(3))), IsInterval(0, 0));
  EXPECT_THAT(derivative(max(x, IntervalDual(-2))), IsInterval(1, 1));
  EXPECT_THAT(derivative(max(x, -x)), IsInterval(-1, 1));
  EXPECT_THAT(min(x, IntervalDual(0)).value, IsInterval(-1, 0));
  EXPECT_THAT(derivative(min(x, IntervalDual(0))), IsInterval(0, 1));
  EXPECT_THAT(derivative(min(x, IntervalDual(3))), IsInterval(1, 1));
  EXPECT_THAT(derivative(min(x, IntervalDual(-2))), IsInterval(0, 0));
}

TEST(Kink, ClampHasSlopeOneBetweenItsEnds) {
  const auto clamped = [](double lower, double upper) {
    return clamp(over(lower, upper), IntervalDual(0), IntervalDual(1));
  };
  EXPECT_THAT(derivative(clamped(0.2, 0.4)), IsInterval(1, 1));
  EXPECT_THAT(derivative(clamped(0.2, 1.4)), IsInterval(0, 1));
  EXPECT_THAT(derivative(clamped(-1, 0)), IsInterval(0, 1));
  EXPECT_THAT(derivative(clamped(1.1, 1.4)), IsInterval(0, 0));
  EXPECT_THAT(clamped(-3, 0.5).value, IsInterval(0, 0.5));
}

TEST(Kink, PiecewiseAsksEachBranchForItsOwnPart) {
  const auto f = [](const auto& x) {
    using T = std::remove_cvref_t<decltype(x)>;
    return piecewise(
        x, 0.0, [](const T&) { return T(0); }, [](const T& above) { return sqrt(above) * above; });
  };
  EXPECT_THAT(f(Interval(-4, 4)), IsInterval(0, 8));
  EXPECT_THAT(f(over(-4, 4)).value, IsInterval(0, 8));
  EXPECT_THAT(f(Interval(-4, -1)), IsInterval(0, 0));
  EXPECT_EQ(f(4.0), 8);
  EXPECT_EQ(f(-4.0), 0);
}

TEST(Kink, DoublesGetTheMeanOfTheOneSidedDerivatives) {
  const auto zero = Dual<double>::variable(0);
  EXPECT_EQ(abs(zero).partial[0], 0);
  EXPECT_EQ(max(zero, Dual<double>(0)).partial[0], 0.5);
  EXPECT_EQ(min(zero, Dual<double>(0)).partial[0], 0.5);
  EXPECT_EQ(sgn(zero).value, 0);
  EXPECT_EQ(sgn(zero).partial[0], 0);
}

template <class T>
concept HasAbsoluteValue = requires(const T& x) {
  abs(x);
};
static_assert(HasAbsoluteValue<Dual<Interval>>);
static_assert(!HasAbsoluteValue<Dual<Dual<Interval>>>, "a kink has no second derivative");

TEST(Dual, PowerOfAConstantExponentIsDifferentiableAtZero) {
  EXPECT_THAT(derivative(pow(over(0, 4), 1.0)), IsInterval(1, 1));
  const Interval slope = derivative(pow(over(0, 4), 1.5));
  EXPECT_EQ(slope.lower(), 0);
  EXPECT_NEAR(slope.upper(), 3, 1e-14);
  EXPECT_GE(slope.upper(), 3);
  EXPECT_EQ(derivative(pow(over(0, 4), 0.5)).upper(), infinity);
}

TEST(Dual, IntegerPowersOfNegativeNumbersAreDifferentiable) {
  const IntervalDual cube = pow(over(-3, 5), 3.0);
  EXPECT_THAT(cube.value, IsInterval(-27, 125));
  EXPECT_THAT(derivative(cube), IsInterval(0, 75));
  EXPECT_THAT(derivative(pow(over(-3, 5), 2.0)), IsInterval(-6, 10));
  EXPECT_THROW((void)pow(over(-3, 5), 1.5), std::domain_error);
  EXPECT_THROW((void)pow(over(-3, 5), over(2, 2)), std::domain_error);
}

TEST(Dual, WhatHasNoDerivativeIsUnboundedOrRefused) {
  EXPECT_EQ(derivative(sqrt(over(0, 4))).upper(), infinity);
  EXPECT_NEAR(derivative(sqrt(over(0, 4))).lower(), 0.25, 1e-15);
  EXPECT_THROW((void)sqrt(over(0, 0)), std::domain_error);
  EXPECT_THROW((void)log(over(-2, -1)), std::domain_error);
  EXPECT_THROW((void)(IntervalDual(1) / over(0, 0)), std::domain_error);
}

/// Functions of two variables in (0, 2)^2 that use every operation; `kinked` says whether derivatives may jump.
struct Function {
  const char* name;
  bool kinked;
};

constexpr std::array<Function, 14> functions{{{"products", false},
                                              {"quotient", false},
                                              {"square", false},
                                              {"square root", false},
                                              {"trigonometry", false},
                                              {"exponential", false},
                                              {"logarithm", false},
                                              {"constant power", false},
                                              {"power", false},
                                              {"absolute value", true},
                                              {"maximum", true},
                                              {"minimum", true},
                                              {"clamp", true},
                                              {"piecewise", true}}};

template <class T>
T evaluate(std::size_t function, const T& x, const T& y) {
  switch (function) {
    case 0: return x * y * y - 3.0 * x + y;
    case 1: return (x - y) / (x + square(y));
    case 2: return square(x - 2.0 * y) + square(x * y);
    case 3: return sqrt(x * y + 0.5);
    case 4: return sin(2.0 * x) * cos(x - y);
    case 5: return exp(x - y * y);
    case 6: return log(x + 2.0 * y);
    case 7: return pow(x + y, 1.5) - pow(y, -0.7);
    case 8: return pow(x, y);
    case 9: return abs(x - y) * x;
    case 10: return max(sin(x), y * x) + y;
    case 11: return min(x, max(y, T(1.0)) - x);
    case 12: return clamp(x * y, T(0.5), x + T(0.2)) * y;
    case 13:
      return y * piecewise(
                     x, 1.0, [](const T& low) { return 2.0 * low; }, [](const T& high) { return high + 1.0; });
    default: throw std::logic_error("no such function");
  }
}

class EveryFunction : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Dual, EveryFunction, testing::Range(std::size_t{0}, functions.size()));

using PlanarDual = Dual<Interval, 2>;

/// With derivatives by x and y.
PlanarDual expansion(std::size_t function, const Interval& x, const Interval& y) {
  return evaluate(function, PlanarDual::variable(x, 0), PlanarDual::variable(y, 1));
}

TEST_P(EveryFunction, DerivativesAgreeWithCentralDifferences) {
  const std::size_t f = GetParam();
  std::mt19937_64 random(1 + f);
  std::uniform_real_distribution<double> coordinate(0.1, 2.0);
  constexpr double step = 1e-5;
  for (int sample = 0; sample < 200; ++sample) {
    const double x = coordinate(random);
    const double y = coordinate(random);
    const auto dual = evaluate(f, Dual<double, 2>::variable(x, 0), Dual<double, 2>::variable(y, 1));
    EXPECT_DOUBLE_EQ(dual.value, evaluate(f, x, y)) << functions[f].name;
    const PlanarDual near_by = expansion(f, {x - step, x + step}, {y - step, y + step});
    const std::array<double, 2> differences{(evaluate(f, x + step, y) - evaluate(f, x - step, y)) / (2 * step),
                                            (evaluate(f, x, y + step) - evaluate(f, x, y - step)) / (2 * step)};
    for (std::size_t k = 0; k < 2; ++k) {
      // At a kink a difference is any mean of the slopes: within their hull, and so no further off than its width.
      const double jump = functions[f].kinked ? near_by.partial[k].upper() - near_by.partial[k].lower() : 0.0;
      EXPECT_NEAR(dual.partial[k], differences[k], 1e-7 * (1 + std::abs(differences[k])) + jump)
          << functions[f].name << " at " << x << ", " << y;
    }
  }
}

TEST_P(EveryFunction, EnclosuresContainValuesAndDerivativesOfSamples) {
  const std::size_t f = GetParam();
  std::mt19937_64 random(2 + f);
  std::uniform_real_distribution<double> coordinate(0.1, 2.0);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int box = 0; box < 300; ++box) {
    const double width = 0.5 * std::pow(unit(random), 3);
    const Interval x(coordinate(random) - 0.05);
    const Interval y(coordinate(random) - 0.05);
    const Interval x_range(x.lower(), x.upper() + width);
    const Interval y_range(y.lower(), y.upper() + width);
    const PlanarDual enclosure = expansion(f, x_range, y_range);
    for (int sample = 0; sample < 10; ++sample) {
      const double px = x_range.lower() + unit(random) * (x_range.upper() - x_range.lower());
      const double py = y_range.lower() + unit(random) * (y_range.upper() - y_range.lower());
      const PlanarDual at_point = expansion(f, px, py);
      EXPECT_TRUE(contains(enclosure.value, at_point.value)) << functions[f].name;
      for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_TRUE(contains(enclosure.partial[k], at_point.partial[k])) << functions[f].name;
      }
    }
  }
}

/// What Krawczyk's operator and mean-value enclosures rely on, kinks or not.
TEST_P(EveryFunction, MeanValueFormHoldsBetweenAllPoints) {
  const std::size_t f = GetParam();
  std::mt19937_64 random(3 + f);
  std::uniform_real_distribution<double> coordinate(0.1, 1.5);
  std::uniform_real_distribution<double> unit(0.0, 0.5);
  for (int box = 0; box < 300; ++box) {
    const double x = coordinate(random);
    const double y = coordinate(random);
    const double u = x + unit(random);
    const double v = y + unit(random);
    const PlanarDual enclosure = expansion(f, {x, u}, {y, v});
    const Interval difference = evaluate(f, Interval(u), Interval(v)) - evaluate(f, Interval(x), Interval(y));
    const Interval bound =
        enclosure.partial[0] * (Interval(u) - Interval(x)) + enclosure.partial[1] * (Interval(v) - Interval(y));
    EXPECT_TRUE(intersect(bound, difference)) << functions[f].name << " from " << x << ", " << y;
  }
}

TEST(Dual, NestsForSecondDerivatives) {
  using Second = Dual<Dual<double>>;
  const double at = 0.7;
  const Second x(Dual<double>::variable(at), {Dual<double>(1)});
  const Second f = exp(sin(x)) * square(x) + sqrt(x) / (2.0 + cos(x)) + pow(x, 2.5) + log(x);
  const auto first = [](double t) {
    const auto y = Dual<double>::variable(t);
    return (exp(sin(y)) * square(y) + sqrt(y) / (2.0 + cos(y)) + pow(y, 2.5) + log(y)).partial[0];
  };
  const double step = 1e-5;
  EXPECT_DOUBLE_EQ(f.partial[0].value, first(at));
  EXPECT_DOUBLE_EQ(f.value.partial[0], first(at));
  EXPECT_NEAR(f.partial[0].partial[0], (first(at + step) - first(at - step)) / (2 * step), 1e-8);
}

}  // namespace
}  // namespace verisq::stance
