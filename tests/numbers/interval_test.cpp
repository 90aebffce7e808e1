/// The arithmetic below every proof: directed rounding against MPFR, and the interval types on top of it.
#include "verify/numbers/interval.hpp"

#include <gtest/gtest.h>
#include <mpfr.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include "verify/numbers/functions.hpp"
#include "verify/search/krawczyk.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

constexpr double kMax = std::numeric_limits<double>::max();
constexpr double kTiny = std::numeric_limits<double>::denorm_min();
constexpr double kNormal = std::numeric_limits<double>::min();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kSamples = 1'000'000;

using Binary = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_srcptr, mpfr_rnd_t);
using Unary = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t);

/// The directed binary64 result by MPFR. With enough bits for sums and products to be exact, or rounding twice in the
/// same direction, it is the tightest one.
class Reference {
 public:
  explicit Reference(mpfr_prec_t bits) { mpfr_inits2(bits, a_, b_, result_, nullptr); }
  Reference(const Reference&) = delete;
  Reference& operator=(const Reference&) = delete;
  ~Reference() { mpfr_clears(a_, b_, result_, nullptr); }

  double operator()(Binary operation, double a, double b, Direction direction) {
    mpfr_set_d(a_, a, MPFR_RNDN);
    mpfr_set_d(b_, b, MPFR_RNDN);
    operation(result_, a_, b_, mpfr_rounding(direction));
    return mpfr_get_d(result_, mpfr_rounding(direction));
  }
  double operator()(Unary operation, double a, Direction direction) {
    mpfr_set_d(a_, a, MPFR_RNDN);
    operation(result_, a_, mpfr_rounding(direction));
    return mpfr_get_d(result_, mpfr_rounding(direction));
  }

 private:
  mpfr_t a_, b_, result_;
};

/// Operands that hurt: any bit pattern, equal exponents, results near overflow and underflow, few-bit numbers, powers
/// of two, and the special values.
class Operands {
 public:
  double finite() {
    switch (random_() % 6) {
      case 0: return special();
      case 1: return few_bits();
      case 2: return scaled(-1.0, 1.0);
      case 3: return scaled(-1074.0, -960.0);
      case 4: return scaled(1000.0, 1023.0);
      default: return any();
    }
  }
  /// Often close to a in exponent, at times a itself, its negative or a neighbour.
  double beside(double a) {
    switch (random_() % 8) {
      case 0: return a;
      case 1: return -a;
      case 2: return clamped(std::nextafter(-a, infinity));
      case 3: return clamped(std::ldexp(scaled(-1.0, 1.0), std::ilogb(a == 0.0 ? 1.0 : a)));
      case 4: return clamped(scaled(-1.0, 1.0) * 0x1p-1060 / (a == 0.0 ? 1.0 : a));
      case 5: return clamped(scaled(-1.0, 1.0) * 0x1p1023 / (a == 0.0 ? 1.0 : a));
      default: return finite();
    }
  }

 private:
  static double clamped(double a) { return std::isfinite(a) ? a : kMax; }
  double special() {
    constexpr std::array values{0.0, -0.0, kTiny, -kTiny, kNormal, -kNormal, kMax, -kMax, 1.0, -1.0, 2.0, 0.5, 3.0};
    return values[random_() % values.size()];
  }
  double few_bits() {
    const int digits = static_cast<int>(random_() % 63) - 31;
    return clamped(std::ldexp(digits, static_cast<int>(random_() % 2100) - 1074));
  }
  double scaled(double low, double high) {
    const double exponent = std::uniform_real_distribution(low, high)(random_);
    const double mantissa = 1.0 + std::uniform_real_distribution(0.0, 1.0)(random_);
    return std::ldexp(random_() % 2 == 0 ? mantissa : -mantissa, static_cast<int>(std::floor(exponent)));
  }
  double any() {
    for (;;) {
      const auto value = std::bit_cast<double>(random_());
      if (std::isfinite(value)) return value;
    }
  }

  std::mt19937_64 random_{42};
};

std::string shown(double a) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%a", a);
  return text.data();
}

using Directed = double (*)(double, double, Direction);

void expect_directed(Directed operation, Binary oracle, mpfr_prec_t bits, bool divisor = false) {
  Reference reference(bits);
  Operands operands;
  for (int i = 0; i < kSamples; ++i) {
    const double a = operands.finite();
    const double b = operands.beside(a);
    if (divisor && b == 0.0) continue;
    for (const Direction direction : {Direction::down, Direction::up}) {
      ASSERT_EQ(operation(a, b, direction), reference(oracle, a, b, direction)) << shown(a) << " and " << shown(b);
    }
  }
}

constexpr mpfr_prec_t kExactSum = 2200;  // from 2^-1074 to 2^1024 and a carry
constexpr mpfr_prec_t kExactProduct = 106;

TEST(RoundingTest, SumIsTheDirectedResult) {
  expect_directed(add, mpfr_add, kExactSum);
}

TEST(RoundingTest, DifferenceIsTheDirectedResult) {
  expect_directed(subtract, mpfr_sub, kExactSum);
}

TEST(RoundingTest, ProductIsTheDirectedResult) {
  expect_directed(multiply, mpfr_mul, kExactProduct);
}

TEST(RoundingTest, QuotientIsTheDirectedResult) {
  expect_directed(divide, mpfr_div, kExactProduct, true);
}

TEST(RoundingTest, RootIsTheDirectedResult) {
  Reference reference(kExactProduct);
  Operands operands;
  for (int i = 0; i < kSamples; ++i) {
    const double root = std::fabs(operands.finite());
    for (const double a : {root, root * root}) {
      if (std::isinf(a)) continue;
      for (const Direction direction : {Direction::down, Direction::up}) {
        ASSERT_EQ(square_root(a, direction), reference(mpfr_sqrt, a, direction)) << shown(a);
      }
    }
  }
}

TEST(RoundingTest, OverflowStopsAtTheLargestNumberOnTheInnerSide) {
  EXPECT_EQ(add(kMax, kMax, Direction::down), kMax);
  EXPECT_EQ(add(kMax, kMax, Direction::up), infinity);
  EXPECT_EQ(add(-kMax, -kMax, Direction::up), -kMax);
  EXPECT_EQ(multiply(kMax, -2.0, Direction::up), -kMax);
  EXPECT_EQ(multiply(kMax, -2.0, Direction::down), -infinity);
  EXPECT_EQ(divide(kMax, 0.5, Direction::down), kMax);
}

TEST(RoundingTest, InfiniteBoundsStay) {
  for (const Direction direction : {Direction::down, Direction::up}) {
    EXPECT_EQ(add(infinity, -kMax, direction), infinity);
    EXPECT_EQ(multiply(0.0, infinity, direction), 0.0);
    EXPECT_EQ(multiply(-infinity, kTiny, direction), -infinity);
    EXPECT_EQ(divide(1.0, infinity, direction), 0.0);
    EXPECT_EQ(square_root(infinity, direction), infinity);
    EXPECT_TRUE(std::isnan(subtract(infinity, infinity, direction)));
  }
}

TEST(RoundingTest, UnderflowKeepsTheSideOfZero) {
  EXPECT_EQ(multiply(kTiny, 0.5, Direction::down), 0.0);
  EXPECT_EQ(multiply(kTiny, 0.5, Direction::up), kTiny);
  EXPECT_EQ(multiply(-kTiny, 0.5, Direction::down), -kTiny);
  EXPECT_EQ(divide(kTiny, kMax, Direction::up), kTiny);
  EXPECT_EQ(divide(-kTiny, kMax, Direction::down), -kTiny);
}

TEST(RoundingTest, ElementaryFunctionsAreTheDirectedResult) {
  Reference reference(200);
  Operands operands;
  std::mt19937_64 random(43);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int i = 0; i < kSamples / 20; ++i) {
    const double x = i % 2 == 0 ? 1500.0 * (uniform(random) - 0.5) : operands.finite();
    const double positive = std::fabs(operands.finite());
    const double base = i % 2 == 0 ? uniform(random) : positive;
    const double exponent = std::exp(12.0 * (uniform(random) - 0.5));
    for (const Direction direction : {Direction::down, Direction::up}) {
      ASSERT_EQ(exponential(x, direction), reference(mpfr_exp, x, direction)) << shown(x);
      ASSERT_EQ(logarithm(positive, direction), reference(mpfr_log, positive, direction)) << shown(positive);
      ASSERT_EQ(logarithm_1p(positive, direction), reference(mpfr_log1p, positive, direction)) << shown(positive);
      ASSERT_EQ(power(base, exponent, direction), reference(mpfr_pow, base, exponent, direction))
          << shown(base) << " to the " << shown(exponent);
    }
  }
}

TEST(IntervalTest, OperationsContainTheResultsOfMembers) {
  std::mt19937_64 random(44);
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  const auto interval = [&] {
    const double a = uniform(random);
    const double b = uniform(random);
    return a < b ? Interval(a, b) : Interval(b, a);
  };
  const auto contains = [](const Interval& x, long double value) { return x.lower() <= value && value <= x.upper(); };
  for (int i = 0; i < kSamples / 10; ++i) {
    const Interval x = interval();
    const Interval y = interval();
    const double t = std::uniform_real_distribution(0.0, 1.0)(random);
    const double a = std::clamp(x.lower() + t * (x.upper() - x.lower()), x.lower(), x.upper());
    const double b = std::clamp(y.upper() - t * (y.upper() - y.lower()), y.lower(), y.upper());
    const long double exact_a = a;
    ASSERT_TRUE(contains(x + y, exact_a + b));
    ASSERT_TRUE(contains(x - y, exact_a - b));
    ASSERT_TRUE(contains(-x, -exact_a));
    // Rounding is monotone, so the binary64 result of members lies between the rounded ends.
    ASSERT_TRUE(contains(x * y, a * b));
    ASSERT_TRUE(contains(square(x), a * a));
    ASSERT_TRUE(contains(abs(x), std::fabs(a)));
    ASSERT_TRUE(contains(hull(x, y), b));
    ASSERT_TRUE((y.lower() <= 0.0 && y.upper() >= 0.0) || contains(x / y, a / b));
    ASSERT_TRUE(y.lower() < 0.0 || contains(pow(y, x), std::pow(b, exact_a)));
  }
}

TEST(IntervalTest, SquareKnowsItsDependency) {
  EXPECT_EQ(square(Interval(-1.0, 2.0)).lower(), 0.0);
  EXPECT_EQ(square(Interval(-3.0, 2.0)).upper(), 9.0);
}

TEST(IntervalTest, DivisorsThatTouchZeroGiveHalfLines) {
  const Interval x = Interval(1.0) / Interval(0.0, 2.0);
  EXPECT_EQ(x.lower(), 0.5);
  EXPECT_EQ(x.upper(), infinity);
  const Interval whole = Interval(1.0) / Interval(-1.0, 1.0);
  EXPECT_EQ(whole.lower(), -infinity);
  EXPECT_EQ(whole.upper(), infinity);
}

template <class T>
class PowerTest : public testing::Test {
 protected:
  static BasicInterval<T> over(double lower, double upper) { return {T(lower), T(upper)}; }
  static void expect(const BasicInterval<T>& result, double lower, double upper) {
    EXPECT_TRUE(result.lower() == T(lower) && result.upper() == T(upper)) << lower << ", " << upper;
  }
};
using NumberTypes = testing::Types<double, Real>;
TYPED_TEST_SUITE(PowerTest, NumberTypes);

TYPED_TEST(PowerTest, IntegerPowersOfNegativeNumbersAreTight) {
  const auto power = [](double lower, double upper, int n) {
    return pow(TestFixture::over(lower, upper), BasicInterval<TypeParam>(n));
  };
  this->expect(power(-3, 5, 2), 0, 25);
  this->expect(power(-5, -3, 2), 9, 25);
  this->expect(power(-5, -0.0, 2), 0, 25);
  this->expect(power(-3, 5, 3), -27, 125);
  this->expect(power(-5, -3, 3), -125, -27);
  this->expect(power(-3, 5, 1), -3, 5);
  this->expect(power(-3, 5, 0), 1, 1);
  this->expect(power(-infinity, 2, 3), -infinity, 8);
  this->expect(power(-infinity, 2, 4), 0, infinity);
  // with a pole at 0
  this->expect(power(-4, -2, -1), -0.5, -0.25);
  this->expect(power(-4, 2, -1), -infinity, infinity);
  this->expect(power(-4, 0, -1), -infinity, -0.25);
  this->expect(power(-0.0, 4, -1), 0.25, infinity);
  this->expect(power(-4, -2, -2), 0.0625, 0.25);
  this->expect(power(-4, 2, -2), 0.0625, infinity);
  this->expect(power(-infinity, infinity, -2), 0, infinity);
}

TYPED_TEST(PowerTest, OtherPowersOfNegativeNumbersAreRefused) {
  const BasicInterval<TypeParam> base = this->over(-3, 5);
  EXPECT_THROW((void)pow(base, this->over(0.5, 0.5)), std::domain_error);
  EXPECT_THROW((void)pow(base, this->over(2, 3)), std::domain_error);
  EXPECT_THROW((void)pow(base, this->over(2, std::nextafter(2, 3))), std::domain_error);
  EXPECT_THROW((void)pow(this->over(-3, -kTiny), this->over(-0.5, 0.5)), std::domain_error);
  EXPECT_THROW((void)pow(base, this->over(infinity, infinity)), std::domain_error);
}

/// [infinity, infinity] holds no number.
TYPED_TEST(PowerTest, WhatLiesAtInfinityAloneIsRefused) {
  for (const double zero : {0.0, -0.0}) {
    const BasicInterval<TypeParam> base = this->over(zero, zero);
    for (const double n : {-1.0, -2.0, -0.5}) EXPECT_THROW((void)pow(base, this->over(n, n)), std::domain_error) << n;
    EXPECT_THROW((void)pow(base, this->over(-2, -1)), std::domain_error);
    EXPECT_THROW((void)log(base), std::domain_error);
  }
  EXPECT_THROW((void)log1p(this->over(-1, -1)), std::domain_error);
  EXPECT_EQ(log(this->over(0, 1)).lower(), TypeParam(-infinity));
  EXPECT_EQ(log1p(this->over(-1, 0)).upper(), TypeParam(0));
}

/// Every power of two members lies in the power of the intervals.
TYPED_TEST(PowerTest, ContainsThePowersOfMembers) {
  std::mt19937_64 random(46);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  for (int i = 0; i < 20'000; ++i) {
    const double a = uniform(random);
    const double b = i % 7 == 0 ? 0.0 : uniform(random);
    const int n = static_cast<int>(random() % 13) - 6;
    const double x =
        std::clamp(a + (b - a) * std::uniform_real_distribution(0.0, 1.0)(random), std::min(a, b), std::max(a, b));
    if (x == 0.0) continue;
    const BasicInterval<TypeParam> result =
        pow(this->over(std::min(a, b), std::max(a, b)), BasicInterval<TypeParam>(n));
    const BasicInterval<TypeParam> member =
        pow(BasicInterval<TypeParam>(TypeParam(std::fabs(x))), BasicInterval<TypeParam>(n));
    const BasicInterval<TypeParam> exact = x < 0.0 && n % 2 != 0 ? -member : member;
    // Rounding is monotone: neither end of a member's enclosure leaves that of all.
    ASSERT_TRUE(result.lower() <= exact.lower() && exact.upper() <= result.upper()) << a << " " << b << " ^ " << n;
  }
}

TEST(IntervalTest, RefusesWhatIsNoInterval) {
  EXPECT_THROW(Interval{kNaN}, std::domain_error);
  EXPECT_THROW(Interval(1.0, kNaN), std::domain_error);
  EXPECT_THROW(Interval(2.0, 1.0), std::domain_error);
  EXPECT_THROW(Interval(1.0) / Interval(0.0), std::domain_error);
  EXPECT_THROW(sqrt(Interval(-2.0, -1.0)), std::domain_error);
  EXPECT_THROW(log(Interval(-2.0, -1.0)), std::domain_error);
  EXPECT_THROW(Interval(-infinity, kMax) + Interval(infinity, infinity), std::domain_error);
  EXPECT_THROW(PreciseInterval{Real(kNaN)}, std::domain_error);
  EXPECT_THROW(PreciseInterval(Real(2), Real(1)), std::domain_error);
}

/// Results at 127 bits must contain the same results at 400 bits.
TEST(PreciseIntervalTest, ContainsAndIsTight) {
  std::mt19937_64 random(45);
  std::uniform_real_distribution<double> uniform(0.001, 4.0);
  mpfr_t a;
  mpfr_t b;
  mpfr_t exact;
  mpfr_inits2(400, a, b, exact, nullptr);
  const auto expect_contains = [&](const PreciseInterval& x) {
    ASSERT_LE(mpfr_cmp(x.lower().get(), exact), 0);
    ASSERT_GE(mpfr_cmp(x.upper().get(), exact), 0);
    const PreciseInterval width = PreciseInterval(x.upper()) - PreciseInterval(x.lower());
    ASSERT_LE(width.upper().to_double(Direction::up), 0x1p-125 * (std::fabs(mpfr_get_d(exact, MPFR_RNDN)) + 0x1p-20));
  };
  for (int i = 0; i < kSamples / 50; ++i) {
    const double x = uniform(random);
    const double y = uniform(random);
    mpfr_set_d(a, x, MPFR_RNDN);
    mpfr_set_d(b, y, MPFR_RNDN);
    const PreciseInterval p = Real(x);
    const PreciseInterval q = Real(y);
    mpfr_mul(exact, a, b, MPFR_RNDN);
    expect_contains(p * q);
    mpfr_div(exact, a, b, MPFR_RNDN);
    expect_contains(p / q);
    mpfr_sqrt(exact, a, MPFR_RNDN);
    expect_contains(sqrt(p));
    mpfr_exp(exact, a, MPFR_RNDN);
    expect_contains(exp(p));
    mpfr_log(exact, a, MPFR_RNDN);
    expect_contains(log(p));
    mpfr_pow(exact, a, b, MPFR_RNDN);
    expect_contains(pow(p, q));
  }
  mpfr_clears(a, b, exact, nullptr);
}

TEST(PreciseIntervalTest, HasExponentsToSpare) {
  const PreciseInterval huge = Real(kMax);
  const PreciseInterval tiny = Real(kTiny);
  EXPECT_TRUE((square(square(huge)) * square(square(tiny))).lower() > Real(0));
  EXPECT_TRUE((huge / tiny).upper() < Real(infinity));
}

TEST(PreciseIntervalTest, NumbersAreCopiedWithTheirDigits) {
  Real a = 1.0 / 3.0;
  const Real b = a;
  a = 2.0;
  EXPECT_EQ(b.to_double(Direction::down), 1.0 / 3.0);
  EXPECT_EQ(a.to_double(Direction::up), 2.0);
  EXPECT_EQ((-b).to_double(Direction::up), -1.0 / 3.0);
}

TEST(IntervalTest, WorksAsEigenScalar) {
  using Matrix = Eigen::Matrix<Interval, 3, 3>;
  Matrix a;
  a << Interval(2.0), Interval(1.0), Interval(0.0),  //
      Interval(0.0), Interval(3.0), Interval(1.0),   //
      Interval(1.0), Interval(0.0), Interval(4.0);
  const Matrix product = a.inverse() * a;
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      EXPECT_LE(product(i, j).lower(), i == j ? 1.0 : 0.0);
      EXPECT_GE(product(i, j).upper(), i == j ? 1.0 : 0.0);
      EXPECT_NEAR(product(i, j).lower(), i == j ? 1.0 : 0.0, 1e-14);
    }
  }
}

/// Whether all components are these numbers.
bool is_exactly(const Vector3<double>& v, const std::array<double, 3>& wanted) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (v[i].lower() != wanted[i] || v[i].upper() != wanted[i]) return false;
  }
  return true;
}

bool is_exactly(const Matrix3<double>& m, const std::array<std::array<double, 3>, 3>& wanted) {
  return is_exactly(m.row(0), wanted[0]) && is_exactly(m.row(1), wanted[1]) && is_exactly(m.row(2), wanted[2]);
}

TEST(VectorTest, OperationsOnIntegersAreExact) {
  const Vector3<double> v(3, -4, 12);
  const Vector3<double> w(1, 2, -5);
  EXPECT_TRUE(is_exactly(Vector3<double>(), {0, 0, 0}));
  EXPECT_TRUE(is_exactly(-v, {-3, 4, -12}));
  EXPECT_TRUE(is_exactly(v + w, {4, -2, 7}));
  EXPECT_TRUE(is_exactly(v - w, {2, -6, 17}));
  EXPECT_TRUE(is_exactly(v * Interval(2), {6, -8, 24}));
  EXPECT_TRUE(is_exactly(v / Interval(2), {1.5, -2, 6}));
  EXPECT_EQ(v.dot(w).lower(), -65);
  EXPECT_EQ(v.dot(w).upper(), -65);
  EXPECT_EQ(length<double>(v).lower(), 13);
  EXPECT_EQ(length<double>(v).upper(), 13);
}

TEST(MatrixTest, OperationsOnIntegersAreExact) {
  const Matrix3<double> a({1, 2, 3}, {0, -1, 4}, {5, 6, -2});
  const Matrix3<double> b({2, 0, 1}, {-3, 1, 0}, {1, 4, -1});
  EXPECT_TRUE(is_exactly(a + b, {{{3, 2, 4}, {-3, 0, 4}, {6, 10, -3}}}));
  EXPECT_TRUE(is_exactly(-a, {{{-1, -2, -3}, {0, 1, -4}, {-5, -6, 2}}}));
  EXPECT_TRUE(is_exactly(a * Interval(3), {{{3, 6, 9}, {0, -3, 12}, {15, 18, -6}}}));
  EXPECT_TRUE(is_exactly(a * Vector3<double>(1, 2, -1), {2, -6, 19}));
  EXPECT_TRUE(is_exactly(a * b, {{{-1, 14, -2}, {7, 15, -4}, {-10, -2, 7}}}));
  EXPECT_TRUE(is_exactly(a.transpose(), {{{1, 0, 5}, {2, -1, 6}, {3, 4, -2}}}));
  EXPECT_TRUE(is_exactly(a.column(2), {3, 4, -2}));
  EXPECT_TRUE(is_exactly(Matrix3<double>::identity() * a, {{{1, 2, 3}, {0, -1, 4}, {5, 6, -2}}}));
  EXPECT_TRUE(a(1, 2).lower() == 4 && a(2, 1).lower() == 6);
}

TEST(VectorTest, ComponentsContainWhatTheirBoxesCanGive) {
  const Vector3<double> v(Interval(1, 2), Interval(-1, 1), Interval(3, 3));
  const Interval product = v.dot({Interval(2, 3), Interval(4, 5), Interval(-1, 1)});
  EXPECT_EQ(product.lower(), 2 - 5 - 3);
  EXPECT_EQ(product.upper(), 6 + 5 + 3);
}

}  // namespace
}  // namespace verisq::verify
