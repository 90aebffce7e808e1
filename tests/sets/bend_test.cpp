// The bend and its inverse against the formula of model.hpp in 400 digits, and the trigonometry below them.
#include "verify/solids/bend.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/real.hpp"
#include "verify/numbers/functions.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

using oracle::RandomCases;

/// 1/k - (1/k - r) cos kz loses 324 of 400 digits at the smallest k.
using Wide =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<400, boost::multiprecision::allocate_stack>,
                                  boost::multiprecision::et_off>;
using WidePoint = std::array<Wide, 3>;

Wide wide(double x) {
  return {x};
}

Wide wide(const Real& x) {
  Wide result;
  mpfr_set(result.backend().data(), x.get(), MPFR_RNDN);
  return result;
}

/// But for the errors of the reference, which are below 1e-60 of any number here.
template <class T>
bool contains(const BasicInterval<T>& interval, const Wide& x) {
  const Wide error = (1 + abs(x)) * 1e-60;
  return wide(interval.lower()) <= x + error && x - error <= wide(interval.upper());
}

template <class T>
bool contains(const Vector3<T>& box, const WidePoint& x) {
  return contains(box[0], x[0]) && contains(box[1], x[1]) && contains(box[2], x[2]);
}

template <class T>
double width(const BasicInterval<T>& interval) {
  return (wide(interval.upper()) - wide(interval.lower())).template convert_to<double>();
}

template <class T>
double width(const Vector3<T>& box) {
  return std::max({width(box[0]), width(box[1]), width(box[2])});
}

template <class T>
Vector3<T> exact(const Point& x) {
  return {T(x[0]), T(x[1]), T(x[2])};
}

/// (r, s, z) -> (1/k - (1/k - r) cos kz, s, (1/k - r) sin kz), as model.hpp states it.
WidePoint bent(const Bend& bend, const WidePoint& x) {
  if (bend.curvature == 0.0) return x;
  const Wide angle = Wide(bend.angle_degrees) * boost::math::constants::pi<Wide>() / 180;
  const Wide c = cos(angle);
  const Wide s = sin(angle);
  const Wide k(bend.curvature);
  const Wide along = x[0] * c + x[1] * s;
  const Wide across = x[1] * c - x[0] * s;
  const Wide bent_along = 1 / k - (1 / k - along) * cos(k * x[2]);
  return {bent_along * c - across * s, bent_along * s + across * c, (1 / k - along) * sin(k * x[2])};
}

WidePoint bent(const Bend& b, const Point& x) {
  return bent(b, WidePoint{Wide(x[0]), Wide(x[1]), Wide(x[2])});
}

template <class T>
Vector3<T> rounded(const WidePoint& x) {
  Vector3<T> result;
  for (int i = 0; i < 3; ++i) {
    Real lower;
    Real upper;
    mpfr_set(lower.get(), x[i].backend().data(), MPFR_RNDD);
    mpfr_set(upper.get(), x[i].backend().data(), MPFR_RNDU);
    if constexpr (std::is_same_v<T, double>) {
      result[i] = {lower.to_double(Direction::down), upper.to_double(Direction::up)};
    } else {
      result[i] = {lower, upper};
    }
  }
  return result;
}

double sign(RandomCases& random) {
  return random.choice(2) == 0 ? 1.0 : -1.0;
}

/// Curvatures of every size, of either sign, within the precondition for points of |r| <= 1 and |z| <= 2.
Bend random_bend(RandomCases& random) {
  const std::array curvatures{0.0,  1e-300, 1e-9, 1e-5, random.uniform(0.0, 0.95), random.uniform(0.0, 0.95),
                              0.95, 5e-324};
  const std::array angles{0.0, 90.0, -180.0, 30.0, random.uniform(-400.0, 400.0), random.uniform(-400.0, 400.0)};
  return {sign(random) * curvatures[random.choice(curvatures.size())], angles[random.choice(angles.size())]};
}

Point random_point(RandomCases& random) {
  const double radius = random.uniform(0.0, 1.0);
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  return {radius * std::cos(angle), radius * std::sin(angle), random.choice(8) == 0 ? 0.0 : random.uniform(-2.0, 2.0)};
}

template <class T>
class BendTest : public testing::Test {
 protected:
  static constexpr double kTight = std::is_same_v<T, double> ? 1e-12 : 1e-33;
  RandomCases random_{20261121};
};
using Numbers = testing::Types<double, Real>;
TYPED_TEST_SUITE(BendTest, Numbers);

TYPED_TEST(BendTest, ContainsTheFormulaAndIsTight) {
  for (int i = 0; i < 3000; ++i) {
    const Bend bend = random_bend(this->random_);
    const Point x = random_point(this->random_);
    const auto found = BendMap<TypeParam>(bend).bent(exact<TypeParam>(x));
    ASSERT_TRUE(contains(found, bent(bend, x))) << bend.curvature << " " << bend.angle_degrees;
    ASSERT_LT(width(found), this->kTight);
  }
}

TYPED_TEST(BendTest, TheInverseContainsThePointThatWasBent) {
  for (int i = 0; i < 3000; ++i) {
    const Bend bend = random_bend(this->random_);
    const Point x = random_point(this->random_);
    const WidePoint exactly{Wide(x[0]), Wide(x[1]), Wide(x[2])};
    const BendMap<TypeParam> map(bend);
    const auto image = rounded<TypeParam>(bent(bend, x));
    ASSERT_TRUE(contains(map.unbent(image), exactly)) << bend.curvature << " " << bend.angle_degrees;
    // Points at |k r| near 1 lie near the centre of curvature.
    ASSERT_LT(width(map.unbent(image)), 100.0 * this->kTight) << bend.curvature << " " << x[2];
    ASSERT_TRUE(contains(map.unbent(map.bent(exact<TypeParam>(x))), exactly));
    auto magnitude = map.unbent_up_to_sign(image);
    magnitude[2] = hull(magnitude[2], -magnitude[2]);
    ASSERT_TRUE(contains(magnitude, exactly));
  }
}

TYPED_TEST(BendTest, BoxesContainTheirPoints) {
  for (int i = 0; i < 2000; ++i) {
    const Bend bend = random_bend(this->random_);
    const BendMap<TypeParam> map(bend);
    const double half = this->random_.log_uniform(1e-6, 3.0);
    Vector3<TypeParam> before;
    Vector3<TypeParam> after;
    const Point inner = random_point(this->random_);
    const auto image = rounded<TypeParam>(bent(bend, inner));
    for (int axis = 0; axis < 3; ++axis) {
      const BasicInterval<TypeParam> around(TypeParam(-this->random_.uniform(0.0, half)),
                                            TypeParam(this->random_.uniform(0.0, half)));
      before[axis] = BasicInterval<TypeParam>(TypeParam(inner[axis])) + around;
      after[axis] = image[axis] + around;
    }
    ASSERT_TRUE(contains(map.bent(before), bent(bend, inner)));
    ASSERT_TRUE(contains(map.unbent(after), WidePoint{Wide(inner[0]), Wide(inner[1]), Wide(inner[2])}));
  }
}

TYPED_TEST(BendTest, ExpansionContainsTheInverseWithinItsRadius) {
  int tried = 0;
  for (int i = 0; i < 3000; ++i) {
    const Bend bend = random_bend(this->random_);
    const BendMap<TypeParam> map(bend);
    const Point from = random_point(this->random_);
    const Point to = random_point(this->random_);
    // Along the segment of the images towards another one.
    const double part = this->random_.log_uniform(1e-6, 1.0);
    const WidePoint a = bent(bend, from);
    WidePoint b = bent(bend, Point{from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1]),
                                   from[2] + part * (to[2] - from[2])});
    const WidePoint inner{Wide(from[0] + part * (to[0] - from[0])), Wide(from[1] + part * (to[1] - from[1])),
                          Wide(from[2] + part * (to[2] - from[2]))};
    const Wide distance =
        sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
    const double radius = distance.convert_to<double>() * (1.0 + 1e-12);
    const auto expansion = map.expansion(rounded<TypeParam>(a), TypeParam(radius));
    if (!expansion) continue;
    ++tried;
    Vector3<TypeParam> step;
    for (int axis = 0; axis < 3; ++axis) {
      const auto difference = rounded<TypeParam>(WidePoint{b[axis] - a[axis], 0, 0});
      step[axis] = difference[0];
    }
    const BasicInterval<TypeParam> radial(-expansion->radial, expansion->radial);
    const BasicInterval<TypeParam> axial(-expansion->axial, expansion->axial);
    Vector3<TypeParam> found = expansion->centre + expansion->derivative * step;
    for (int axis = 0; axis < 2; ++axis) found[axis] += map.direction()[axis] * radial;
    found[2] += axial;
    ASSERT_TRUE(contains(found, inner)) << bend.curvature << " " << radius;
    // The remainder is of second order.
    const double bound = std::fabs(bend.curvature) * radius * radius;
    if (radius * std::fabs(bend.curvature) < 1e-3) {
      ASSERT_LE(wide(expansion->radial), 20.0 * bound + 1e-300);
    }
  }
  EXPECT_GT(tried, 1500);
}

TYPED_TEST(BendTest, SmallCurvaturesConvergeToThePlace) {
  const Point x{0.3, -0.4, 1.7};
  for (const double k : {1e-5, 1e-9, 1e-300, 0.0, -1e-300, -1e-9, -1e-5}) {
    for (const double angle : {0.0, 90.0, 137.0}) {
      const BendMap<TypeParam> map({k, angle});
      const auto forward = map.bent(exact<TypeParam>(x));
      const auto back = map.unbent(exact<TypeParam>(x));
      for (int axis = 0; axis < 3; ++axis) {
        const double bound = 3.0 * std::fabs(k) + this->kTight;  // |k| (r^2 + z^2) and more
        EXPECT_LT(abs(forward[axis] - TypeParam(x[axis])).upper(), TypeParam(bound));
        EXPECT_LT(abs(back[axis] - TypeParam(x[axis])).upper(), TypeParam(bound));
      }
    }
  }
}

TYPED_TEST(BendTest, WithoutCurvatureQuarterTurnsLeavePointsExactlyInPlace) {
  const Point x{0.3, -0.4, 1.7};
  for (const double angle : {0.0, 90.0, 180.0, -90.0, 720.0}) {
    const auto image = BendMap<TypeParam>({0.0, angle}).unbent(exact<TypeParam>(x));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(image[axis].lower(), TypeParam(x[axis]));
      EXPECT_EQ(image[axis].upper(), TypeParam(x[axis]));
    }
  }
}

TYPED_TEST(BendTest, AtTheCutBothHeightsAreIncludedAndTheMagnitudeIsTight) {
  for (const double k : {0.5, -0.5}) {
    const BendMap<TypeParam> map({k, 0.0});
    const Point beyond{3.0 / k, 0.25, 0.0};  // m = -2
    const double half_turn = std::numbers::pi / std::fabs(k);
    const auto z = map.unbent(exact<TypeParam>(beyond))[2];
    EXPECT_LT(z.lower(), TypeParam(-half_turn + 1e-12));
    EXPECT_GT(z.upper(), TypeParam(half_turn - 1e-12));
    EXPECT_GT(map.unbent_up_to_sign(exact<TypeParam>(beyond))[2].lower(), TypeParam(half_turn - 1e-12));
    EXPECT_FALSE(map.expansion(exact<TypeParam>(beyond), TypeParam(0.1)));
    EXPECT_FALSE(map.expansion(exact<TypeParam>({1.0 / k, 0.0, 0.0}), TypeParam(0.0)));
    EXPECT_TRUE(map.expansion(exact<TypeParam>({3.0 / k, 0.0, 1.0}), TypeParam(0.5)));
  }
}

TYPED_TEST(BendTest, EnormousAndUnboundedBoxesDoNotThrow) {
  using Number = BasicInterval<TypeParam>;
  const TypeParam beyond(infinity);
  for (const double k : {0.0, 1e-300, 0.5, -1e300}) {
    const BendMap<TypeParam> map({k, 33.0});
    for (const Number& a : {Number(TypeParam(1e300)), Number(-beyond, TypeParam(3)), Number(-beyond, beyond),
                            Number(TypeParam(1e308), beyond), Number(0), Number(TypeParam(5e-324))}) {
      for (const Number& b : {Number(TypeParam(-1e300)), Number(-beyond, beyond), Number(0)}) {
        EXPECT_NO_THROW({
          (void)map.unbent({a, b, a});
          (void)map.unbent({b, a, b});
          (void)map.bent({a, b, a});
          (void)map.bent({b, b, a});
          (void)map.unbent_up_to_sign({a, a, b});
          (void)map.expansion({a, b, a}, TypeParam(1e308));
          (void)map.expansion({a, a, b}, beyond);
        });
      }
    }
  }
}

template <class T>
class TrigonometryTest : public testing::Test {
 protected:
  static constexpr double kTight = std::is_same_v<T, double> ? 4e-16 : 1e-37;
  RandomCases random_{7};
};
TYPED_TEST_SUITE(TrigonometryTest, Numbers);

TYPED_TEST(TrigonometryTest, RangesContainInnerValues) {
  for (int i = 0; i < 4000; ++i) {
    const double lower = sign(this->random_) * this->random_.log_uniform(1e-9, 1e4);
    const double upper = lower + this->random_.log_uniform(1e-9, 10.0);
    const BasicInterval<TypeParam> a{TypeParam(lower), TypeParam(upper)};
    const Wide x = Wide(lower) + (Wide(upper) - Wide(lower)) * this->random_.uniform(0.0, 1.0);
    ASSERT_TRUE(contains(sin(a), Wide(sin(x)))) << lower << " " << upper;
    ASSERT_TRUE(contains(cos(a), Wide(cos(x)))) << lower << " " << upper;
    ASSERT_TRUE(contains(atan(a), Wide(atan(x)))) << lower << " " << upper;
    ASSERT_TRUE(contains(sine_quotient(a), Wide(sin(x) / x))) << lower << " " << upper;
    ASSERT_TRUE(contains(arctangent_quotient(a), Wide(atan(x) / x))) << lower << " " << upper;
  }
}

TYPED_TEST(TrigonometryTest, PointsAreTight) {
  for (int i = 0; i < 4000; ++i) {
    const double at = sign(this->random_) * this->random_.log_uniform(1e-30, 3.1);
    const BasicInterval<TypeParam> a{TypeParam(at)};
    const Wide x(at);
    ASSERT_TRUE(contains(sine_quotient(a), Wide(sin(x) / x))) << at;
    ASSERT_TRUE(contains(arctangent_quotient(a), Wide(atan(x) / x))) << at;
    ASSERT_LE(width(sin(a)), this->kTight);
    ASSERT_LE(width(cos(a)), this->kTight);
    ASSERT_LE(width(atan(a)), this->kTight);
    ASSERT_LE(width(sine_quotient(a)), this->kTight);
    ASSERT_LE(width(arctangent_quotient(a)), 4.0 * this->kTight) << at;
  }
}

TYPED_TEST(TrigonometryTest, ExtremaWithinAreFoundAndOthersAreNot) {
  const auto over = [](double lower, double upper) {
    return BasicInterval<TypeParam>(TypeParam(lower), TypeParam(upper));
  };
  EXPECT_EQ(cos(over(-0.1, 0.2)).upper(), TypeParam(1));
  EXPECT_EQ(cos(over(3.0, 3.2)).lower(), TypeParam(-1));
  EXPECT_LT(cos(over(3.0, 3.2)).upper(), TypeParam(-0.98));
  EXPECT_EQ(sin(over(1.5, 1.6)).upper(), TypeParam(1));
  EXPECT_EQ(sin(over(-1.6, -1.5)).lower(), TypeParam(-1));
  EXPECT_LT(sin(over(1.6, 3.0)).upper(), TypeParam(0.9996));
  EXPECT_EQ(cos(over(-1.0, 6.0)).lower(), TypeParam(-1));
  for (const double huge : {1e3, 1e20, 1e300}) {
    EXPECT_EQ(sin(over(-huge, huge)).lower(), TypeParam(-1));
    EXPECT_EQ(cos(over(-huge, huge)).upper(), TypeParam(1));
  }
  EXPECT_EQ(sine_quotient(over(-1.0, 0.5)).upper(), TypeParam(1));
  EXPECT_EQ(arctangent_quotient(over(-1.0, 0.5)).upper(), TypeParam(1));
}

TYPED_TEST(TrigonometryTest, PolarAngleOfABoxIsThatOfItsCorners) {
  for (int i = 0; i < 2000; ++i) {
    const double x = this->random_.uniform(-1.0, 1.0);
    const double y = this->random_.choice(4) == 0 ? 0.0 : this->random_.uniform(0.0, 1.0);
    const double w = this->random_.uniform(0.0, 1.0);
    const double h = this->random_.uniform(0.0, 1.0);
    const auto angle = polar_angle(BasicInterval<TypeParam>(TypeParam(x), TypeParam(x + w)),
                                   BasicInterval<TypeParam>(TypeParam(y), TypeParam(y + h)));
    const double inner_x = x + w * this->random_.uniform(0.0, 0.999999);
    const double inner_y = y + h * this->random_.uniform(0.0, 0.999999);
    ASSERT_TRUE(contains(angle, Wide(atan2(Wide(inner_y), Wide(inner_x)))));
  }
}

/// In every quadrant, across the axes and across the cut.
TYPED_TEST(TrigonometryTest, PolarAngleContainsThoseOfAllPoints) {
  const auto coordinate = [this] { return this->random_.choice(5) == 0 ? 0.0 : this->random_.uniform(-1.0, 1.0); };
  const auto over = [](double a, double b) {
    return BasicInterval<TypeParam>(TypeParam(std::min(a, b)), TypeParam(std::max(a, b)));
  };
  for (int i = 0; i < 20000; ++i) {
    const double x0 = coordinate();
    const double x1 = coordinate();
    const double y0 = coordinate();
    const double y1 = coordinate();
    const double t = this->random_.choice(3) == 0 ? 0.0 : this->random_.uniform(0.0, 0.999999);
    const double x = x0 + t * (x1 - x0);
    const double y = this->random_.choice(3) == 0 ? y0 : y0 + this->random_.uniform(0.0, 0.999999) * (y1 - y0);
    if (x == 0.0 && y == 0.0) continue;
    const auto angle = polar_angle(over(x0, x1), over(y0, y1));
    ASSERT_TRUE(contains(angle, Wide(atan2(Wide(y == 0.0 ? 0.0 : y), Wide(x)))))
        << x << " " << y << " in [" << x0 << ", " << x1 << "] x [" << y0 << ", " << y1 << "]";
  }
}

/// Neither the sign of a zero nor the origin, which has no angle, counts.
TYPED_TEST(TrigonometryTest, PolarAngleIsTightAtTheAxesAndTheCut) {
  const BasicInterval<TypeParam> half_turn = pi<TypeParam>();
  const BasicInterval<TypeParam> quarter = half_turn / BasicInterval<TypeParam>(2);
  const BasicInterval<TypeParam> all(-half_turn.upper(), half_turn.upper());
  const BasicInterval<TypeParam> both_quarters(-quarter.upper(), quarter.upper());
  const auto expect = [](double x0, double x1, double y0, double y1, const BasicInterval<TypeParam>& expected) {
    const auto signs = [](double a) { return a == 0.0 ? std::vector{0.0, -0.0} : std::vector{a}; };
    for (const double a : signs(x0)) {
      for (const double b : signs(x1)) {
        for (const double c : signs(y0)) {
          for (const double d : signs(y1)) {
            const auto angle = polar_angle(BasicInterval<TypeParam>(TypeParam(a), TypeParam(b)),
                                           BasicInterval<TypeParam>(TypeParam(c), TypeParam(d)));
            EXPECT_TRUE(angle.lower() == expected.lower() && angle.upper() == expected.upper())
                << "[" << a << ", " << b << "] x [" << c << ", " << d << "]";
          }
        }
      }
    }
  };
  expect(1, 3, -2, 2, {-atan(BasicInterval<TypeParam>(2)).upper(), atan(BasicInterval<TypeParam>(2)).upper()});
  expect(-2, -1, -1, 1, all);
  expect(-2, -1, -1, 0, all);  // pi on the cut, close to -pi below it
  expect(-2, 3, -1, 1, all);
  expect(-2, -1, 0, 0, half_turn);
  expect(-2, 0, 0, 0, half_turn);
  expect(-2, 1, 0, 0, {TypeParam(0), half_turn.upper()});
  expect(1, 2, 0, 0, BasicInterval<TypeParam>(0));
  expect(0, 2, 0, 0, BasicInterval<TypeParam>(0));
  expect(0, 0, 1, 2, quarter);
  expect(0, 0, 0, 2, quarter);
  expect(0, 0, -2, 0, -quarter);
  expect(0, 0, -2, 1, both_quarters);
  expect(0, 3, -2, 1, both_quarters);
  expect(0, 3, 0, 1, {TypeParam(0), quarter.upper()});
  expect(0, 0, 0, 0, {TypeParam(0), half_turn.upper()});
}

TYPED_TEST(TrigonometryTest, DegreesAreExactAtQuarterTurns) {
  const std::array<std::array<int, 2>, 4> expected{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  for (int quarter = -9; quarter < 9; ++quarter) {
    const auto& [c, s] = expected[static_cast<std::size_t>((quarter + 12) % 4)];
    const auto cosine = cos_of_degrees<TypeParam>(90.0 * quarter);
    const auto sine = sin_of_degrees<TypeParam>(90.0 * quarter);
    EXPECT_TRUE(cosine.lower() == TypeParam(c) && cosine.upper() == TypeParam(c)) << quarter;
    EXPECT_TRUE(sine.lower() == TypeParam(s) && sine.upper() == TypeParam(s)) << quarter;
  }
  const Wide degree = boost::math::constants::pi<Wide>() / 180;
  for (int i = 0; i < 500; ++i) {
    const double angle = this->random_.uniform(-1000.0, 1000.0);
    ASSERT_TRUE(contains(cos_of_degrees<TypeParam>(angle), Wide(cos(angle * degree))));
    ASSERT_TRUE(contains(sin_of_degrees<TypeParam>(angle), Wide(sin(angle * degree))));
  }
}

}  // namespace
}  // namespace verisq::verify
