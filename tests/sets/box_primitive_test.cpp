// Colours and half-spaces of posed, tapered and bent superquadrics over cubes against points evaluated at 200 bits and
// more.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "tests/oracle/mixed_norm.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/real.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/search/set_tree.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

using oracle::RandomCases;
using oracle::Real;
using oracle::Vector;

/// Pose, bend and taper as model.hpp states them, at 200 bits.
class Reference {
 public:
  explicit Reference(const Primitive& primitive)
      : norm_(primitive.superquadric),
        height_(primitive.superquadric.semi_axes[2]),
        k_((Real(primitive.superquadric.taper) - 1) / (Real(primitive.superquadric.taper) + 1)),
        bend_(primitive.bend),
        quaternion_(primitive.pose.quaternion),
        translation_(oracle::widened(primitive.pose.translation)) {
    if (!bend_) return;
    const Real angle = Real(bend_->angle_degrees) * boost::math::constants::pi<Real>() / 180;
    cosine_ = cos(angle);
    sine_ = sin(angle);
  }

  /// From untapered, unbent own coordinates to the model frame.
  [[nodiscard]] Vector place(const Vector& own) const {
    const Vector changed = tapered(own);
    return turned(bend_ ? bent(changed) : changed, 1);
  }

  /// g of the untapered, unbent point, for a point of the model frame: more than 1 beyond the heights that a taper
  /// knows. Nothing within 1e-30 of the centre of curvature.
  [[nodiscard]] Real gauge(const Vector& x) const {
    Vector own = turned(oracle::difference(x, translation_), -1);
    if (bend_ && bend_->curvature != 0.0) own = unbent(own);
    const Real scale = 1 + k_ * own[2] / height_;
    if (scale <= 0 || abs(own[2]) > height_) return norm_.gauge(own) + 1;
    return norm_.gauge({own[0] / scale, own[1] / scale, (own[2] + k_ * height_) / scale});
  }

 private:
  /// q v q* / |q|^2 (+ translation), or its inverse by the conjugate.
  [[nodiscard]] Vector turned(const Vector& v, int direction) const {
    const Real w(quaternion_[0]);
    const Vector u{Real(direction * quaternion_[1]), Real(direction * quaternion_[2]),
                   Real(direction * quaternion_[3])};
    const Real uu = oracle::dot(u, u);
    const Vector cross{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    Vector result;
    for (std::size_t i = 0; i < 3; ++i) {
      result[i] = ((w * w - uu) * v[i] + 2 * oracle::dot(u, v) * u[i] + 2 * w * cross[i]) / (w * w + uu);
      if (direction == 1) result[i] += translation_[i];
    }
    return result;
  }

  [[nodiscard]] Vector tapered(const Vector& x) const {
    const Real z = (x[2] - k_ * height_) / (1 - k_ * x[2] / height_);
    const Real scale = 1 + k_ * z / height_;
    return {scale * x[0], scale * x[1], z};
  }

  [[nodiscard]] Vector bent(const Vector& x) const {
    if (bend_->curvature == 0.0) return x;
    const Real k(bend_->curvature);
    const Real along = x[0] * cosine_ + x[1] * sine_;
    const Real across = x[1] * cosine_ - x[0] * sine_;
    const Real bent_along = 1 / k - (1 / k - along) * cos(k * x[2]);
    return {bent_along * cosine_ - across * sine_, bent_along * sine_ + across * cosine_,
            (1 / k - along) * sin(k * x[2])};
  }

  /// By the polar angle about the centre of curvature: inverts the line above as it stands.
  [[nodiscard]] Vector unbent(const Vector& x) const {
    const Real k(bend_->curvature);
    const Real along = x[0] * cosine_ + x[1] * sine_;
    const Real across = x[1] * cosine_ - x[0] * sine_;
    const Real m = 1 - k * along;
    const Real rise = k * x[2];
    const Real unbent_along = (1 - sqrt(m * m + rise * rise)) / k;
    return {unbent_along * cosine_ - across * sine_, unbent_along * sine_ + across * cosine_, atan2(rise, m) / k};
  }

  oracle::MixedNorm<Real> norm_;
  Real height_, k_;
  std::optional<Bend> bend_;
  std::array<double, 4> quaternion_;
  Vector translation_;
  Real cosine_, sine_;
};

double random_exponent(RandomCases& random) {
  const std::array exponents{0.05, 1.0, 2.0, 1.99, random.uniform(0.05, 2.0), random.uniform(0.05, 2.0)};
  return exponents[random.choice(exponents.size())];
}

enum class Family : std::uint8_t { plain, rotated, bent, tapered, tapered_and_bent };

Primitive random_primitive(RandomCases& random, Family family) {
  Primitive result{"solid", {{1.0, 1.0, 1.0}, {random_exponent(random), random_exponent(random)}}, {}, {}};
  for (double& a : result.superquadric.semi_axes) a = random.log_uniform(0.1, 4.0);
  for (double& t : result.pose.translation) t = random.uniform(-1.0, 1.0);
  if (family == Family::plain) return result;
  for (double& q : result.pose.quaternion) q = random.uniform(-1.0, 1.0);
  if (family == Family::rotated) return result;
  double widening = 1.0;
  if (family != Family::bent) {
    const double ratio = random.log_uniform(1.0, 19.0);
    result.superquadric.taper = random.choice(2) == 0 ? ratio : 1.0 / ratio;
    widening = 2.0 * ratio / (ratio + 1.0);  // of the larger end
  }
  if (family == Family::tapered) return result;
  const auto& a = result.superquadric.semi_axes;
  const double largest = std::min(0.95 / (widening * std::hypot(a[0], a[1])), 3.1 / a[2]);
  const std::array curvatures{
      0.0, 1e-20, 1e-9, 1e-5, largest, random.uniform(0.0, largest), random.uniform(0.0, largest)};
  const double k = curvatures[random.choice(curvatures.size())];
  result.bend = Bend{random.choice(2) == 0 ? k : -k, random.choice(3) == 0 ? 90.0 : random.uniform(-180.0, 180.0)};
  return result;
}

/// Near the surface, so that all colours come up.
Point random_centre(RandomCases& random, const Primitive& primitive, const Reference& reference) {
  const Point boundary = random.boundary_point(primitive.superquadric).point;
  const double farthest = is_tapered(primitive.superquadric) ? 1.1 : 3.0;  // a taper sends 1 / 0.9 to infinity
  const Real scale(random.choice(4) == 0 ? random.uniform(0.0, farthest)
                                         : random.uniform(0.8, std::min(1.2, farthest)));
  return oracle::rounded(reference.place(oracle::scaled<Real>(oracle::widened(boundary), scale)));
}

Vector random_point_in(RandomCases& random, const Cube& cube) {
  Vector result;
  for (std::size_t i = 0; i < 3; ++i) {
    const double e = random.choice(4) == 0 ? (random.choice(2) == 0 ? 1.0 : -1.0) : random.uniform(-1.0, 1.0);
    result[i] = Real(cube.centre[i]) + Real(e) * Real(cube.half_width);
  }
  return result;
}

std::string description(const Primitive& p, const Cube& cube) {
  const auto list = [](const auto& values) {
    std::string text;
    for (const double v : values) text += fmt::format("{:.17g} ", v);
    return text;
  };
  return fmt::format("axes {} exponents {} taper {:.17g} t {} q {} bend {:.17g} {:.17g} cube {} {:.17g}",
                     list(p.superquadric.semi_axes), list(p.superquadric.exponents), p.superquadric.taper,
                     list(p.pose.translation), list(p.pose.quaternion), p.bend ? p.bend->curvature : 0.0,
                     p.bend ? p.bend->angle_degrees : 0.0, list(cube.centre), cube.half_width);
}

/// n . (x - c)
Real height(const HalfSpace& half_space, const Cube& cube, const Vector& x) {
  return oracle::dot(oracle::widened(half_space.normal), oracle::difference(x, oracle::widened(cube.centre)));
}

class BoxPrimitiveTest : public testing::TestWithParam<Family> {
 protected:
  RandomCases random_{20261121};
};

TEST_P(BoxPrimitiveTest, ColoursAndHalfSpacesHoldForEveryPointOfTheCube) {
  std::array<int, 3> colours{};
  int cutting = 0;
  for (int i = 0; i < 400; ++i) {
    const Primitive primitive = random_primitive(random_, GetParam());
    const BoxPrimitive box(primitive);
    const Reference reference(primitive);
    for (int j = 0; j < 10; ++j) {
      const Cube cube{random_centre(random_, primitive, reference),
                      random_.choice(8) == 0 ? 0.0 : random_.log_uniform(1e-6, 1.0)};
      const Colour colour = box.colour(cube);
      ++colours[static_cast<std::size_t>(colour)];
      const HalfSpace inside = box.half_space(cube, Side::inside);
      const HalfSpace outside = box.half_space(cube, Side::outside);
      for (const HalfSpace& s : {inside, outside}) {
        const double reach = std::fabs(s.normal[0]) + std::fabs(s.normal[1]) + std::fabs(s.normal[2]);
        if (s.offset < reach * cube.half_width) ++cutting;
      }
      for (int k = 0; k < 8; ++k) {
        const Vector x = random_point_in(random_, cube);
        const Real gauge = reference.gauge(x);
        ASSERT_FALSE(colour == Colour::white && gauge <= 1) << description(primitive, cube);
        ASSERT_FALSE(colour == Colour::black && gauge >= 1) << description(primitive, cube);
        const HalfSpace& half_space = gauge <= 1 ? inside : outside;
        if (half_space.offset < infinity) {
          ASSERT_LE(height(half_space, cube, x), Real(half_space.offset)) << description(primitive, cube);
        }
      }
    }
  }
  for (const int count : colours) EXPECT_GT(count, 300);
  EXPECT_GT(cutting, 2000);
}

TEST_P(BoxPrimitiveTest, PointsBesideTheSurfaceAreDecided) {
  for (int i = 0; i < 300; ++i) {
    const Primitive primitive = random_primitive(random_, GetParam());
    const BoxPrimitive box(primitive);
    const Reference reference(primitive);
    const Vector boundary = oracle::widened(random_.boundary_point(primitive.superquadric).point);
    for (const double side : {-1.0, 1.0}) {
      const Vector own = oracle::scaled<Real>(boundary, 1 + Real(side) * Real(1e-14));
      const Cube point{oracle::rounded(reference.place(own)), 0.0};
      const Real gauge = reference.gauge(oracle::widened(point.centre));
      if (abs(gauge - 1) < 1e-25) continue;
      ASSERT_EQ(box.colour(point), gauge > 1 ? Colour::white : Colour::black) << description(primitive, point);
    }
  }
}

/// How far the offset lies beyond the best one, in units of length: the best is found among points of the cube.
double looseness(const HalfSpace& half_space, const Cube& cube, const Reference& reference, Side side) {
  constexpr int steps = 4;
  Real best(-infinity);
  for (int i = -steps; i <= steps; ++i) {
    for (int j = -steps; j <= steps; ++j) {
      for (int k = -steps; k <= steps; ++k) {
        Vector x = oracle::widened(cube.centre);
        x[0] += Real(i * cube.half_width / steps);
        x[1] += Real(j * cube.half_width / steps);
        x[2] += Real(k * cube.half_width / steps);
        if ((reference.gauge(x) <= 1) == (side == Side::inside)) best = std::max(best, height(half_space, cube, x));
      }
    }
  }
  return ((half_space.offset - best) / oracle::length(oracle::widened(half_space.normal))).convert_to<double>();
}

TEST_P(BoxPrimitiveTest, HalfSpacesAreLooseByTheSecondOrderOnly) {
  for (const Side side : {Side::inside, Side::outside}) {
    double wide = 0.0;
    double narrow = 0.0;
    for (int i = 0; i < 12; ++i) {
      Primitive primitive = random_primitive(random_, GetParam());
      primitive.superquadric.exponents = {random_.uniform(0.6, 1.2), random_.uniform(0.6, 1.2)};
      primitive.superquadric.semi_axes = {random_.uniform(1.0, 1.5), random_.uniform(1.0, 1.5),
                                          random_.uniform(1.0, 2.0)};
      if (primitive.bend) primitive.bend->curvature = random_.uniform(-0.4, 0.4);
      if (is_tapered(primitive.superquadric)) primitive.superquadric.taper = random_.log_uniform(0.7, 1.4);
      const BoxPrimitive box(primitive);
      const Reference reference(primitive);
      // Through the centre of the cube goes the surface: what the half-space adds to its tangent is a remainder.
      const Point boundary = random_.boundary_point(primitive.superquadric).point;
      Cube cube{oracle::rounded(reference.place(oracle::widened(boundary))), 0.08};
      const auto excess = [&] {
        const HalfSpace s = box.half_space(cube, side);
        return s.offset / oracle::length(oracle::widened(s.normal)).convert_to<double>();
      };
      wide += excess();
      cube.half_width *= 0.5;
      narrow += excess();
      ASSERT_LT(looseness(box.half_space(cube, side), cube, reference, side), 0.5 * cube.half_width);
    }
    const bool bent = GetParam() == Family::bent || GetParam() == Family::tapered_and_bent;
    if (side == Side::inside && !bent) {
      EXPECT_LT(wide, 1e-12);  // the tangent itself
    } else {
      EXPECT_GT(wide, 3.0 * narrow);
    }
    EXPECT_LT(narrow, 12 * 0.04 * 0.2);  // of the half-width, on average
  }
}

TEST_P(BoxPrimitiveTest, AlmostNoBendIsNoBend) {
  for (int i = 0; i < 100; ++i) {
    Primitive primitive = random_primitive(random_, GetParam());
    primitive.bend.reset();
    const Cube cube{random_centre(random_, primitive, Reference(primitive)), random_.log_uniform(1e-3, 0.3)};
    const BoxPrimitive unbent(primitive);
    for (const double k : {1e-300, -1e-300, 0.0, 1e-12}) {
      primitive.bend = Bend{k, 90.0};
      const BoxPrimitive box(primitive);
      for (const Side side : {Side::inside, Side::outside}) {
        const double expected = unbent.half_space(cube, side).offset;
        ASSERT_NEAR(box.half_space(cube, side).offset, expected, 1e-9 * (1.0 + std::fabs(expected)))
            << description(primitive, cube);
      }
      Cube shrunk = cube;
      shrunk.half_width *= 1.0 - 1e-9;
      const Colour expected = unbent.colour(cube);
      ASSERT_TRUE(expected == Colour::gray || box.colour(shrunk) == expected) << description(primitive, cube);
    }
  }
}

std::string name_of(const testing::TestParamInfo<Family>& family) {
  constexpr std::array names{"Plain", "Rotated", "Bent", "Tapered", "TaperedAndBent"};
  return names[static_cast<std::size_t>(family.param)];
}

INSTANTIATE_TEST_SUITE_P(Families, BoxPrimitiveTest,
                         testing::Values(Family::plain, Family::rotated, Family::bent, Family::tapered,
                                         Family::tapered_and_bent),
                         name_of);

TEST(AlignedBoxPrimitiveTest, ColoursAreExact) {
  RandomCases random(3);
  int decided = 0;
  for (int i = 0; i < 1000; ++i) {
    const Primitive primitive = random_primitive(random, Family::plain);
    const BoxPrimitive box(primitive);
    const Reference reference(primitive);
    const Cube cube{random_centre(random, primitive, reference), random.log_uniform(1e-3, 0.3)};
    Vector nearest;
    Vector farthest;
    for (std::size_t j = 0; j < 3; ++j) {
      const Real t(primitive.pose.translation[j]);
      const Real a = Real(cube.centre[j]) - t;
      const Real magnitude = abs(a);
      nearest[j] = t + std::max<Real>(magnitude - cube.half_width, Real(0));
      farthest[j] = t + magnitude + cube.half_width;
    }
    const Real lower = reference.gauge(nearest);
    const Real upper = reference.gauge(farthest);
    if (abs(lower - 1) < 1e-11 || abs(upper - 1) < 1e-11) continue;
    const Colour expected = lower > 1 ? Colour::white : upper < 1 ? Colour::black : Colour::gray;
    if (expected != Colour::gray) ++decided;
    ASSERT_EQ(box.colour(cube), expected) << description(primitive, cube);
  }
  EXPECT_GT(decided, 300);
}

/// Bent as far as allowed and a little less; half of them upright, so that ranges are attained at corners.
Primitive random_bent_primitive(RandomCases& random) {
  Primitive result = random_primitive(random, Family::rotated);
  const auto& a = result.superquadric.semi_axes;
  if (random.choice(2) == 0) result.pose.quaternion = {1.0, 0.0, 0.0, 0.0};
  const double largest = std::min(0.9 / std::hypot(a[0], a[1]), 3.0 / a[2]);
  result.bend = Bend{random.uniform(-largest, largest), 90.0 * static_cast<double>(random.choice(4))};
  return result;
}

Vector corner(const Cube& cube, int index) {
  Vector result = oracle::widened(cube.centre);
  for (std::size_t i = 0; i < 3; ++i) result[i] += Real((index >> i) % 2 == 0 ? -cube.half_width : cube.half_width);
  return result;
}

TEST(BentBoxPrimitiveTest, TheLargestCubesOfAColourStillHaveIt) {
  RandomCases random(11);
  std::array<int, 3> colours{};
  for (int i = 0; i < 1500; ++i) {
    const Primitive primitive = random_bent_primitive(random);
    const BoxPrimitive box(primitive);
    const Reference reference(primitive);
    const Vector boundary = oracle::widened(random.boundary_point(primitive.superquadric).point);
    const Vector own = oracle::scaled<Real>(boundary, Real(random.uniform(0.0, 2.0)));
    Cube cube{oracle::rounded(reference.place(own)), 0.0};
    const Colour colour = box.colour(cube);
    ++colours[static_cast<std::size_t>(colour)];
    if (colour == Colour::gray) continue;
    double kept = 0.0;
    double lost = 4.0;
    for (int step = 0; step < 25; ++step) {
      cube.half_width = 0.5 * (kept + lost);
      (box.colour(cube) == colour ? kept : lost) = cube.half_width;
    }
    cube.half_width = kept;
    for (int k = 0; k < 16; ++k) {
      const Real gauge = reference.gauge(k < 8 ? corner(cube, k) : random_point_in(random, cube));
      ASSERT_TRUE(colour == Colour::white ? gauge > 1 : gauge < 1) << description(primitive, cube);
    }
  }
  EXPECT_GT(colours[static_cast<std::size_t>(Colour::white)], 300);
  EXPECT_GT(colours[static_cast<std::size_t>(Colour::black)], 300);
}

Vector random_point_of(RandomCases& random, const Cube& cube, bool at_corner) {
  return at_corner ? corner(cube, static_cast<int>(random.choice(8))) : random_point_in(random, cube);
}

TEST(BentBoxPrimitiveTest, HalfSpacesContainTheSurfaceInTheCube) {
  RandomCases random(12);
  int checked = 0;
  for (int i = 0; i < 2000; ++i) {
    const Primitive primitive = random_bent_primitive(random);
    const BoxPrimitive box(primitive);
    const Reference reference(primitive);
    const Cube cube{random_centre(random, primitive, reference), random.log_uniform(1e-3, 0.5)};
    const HalfSpace inside = box.half_space(cube, Side::inside);
    const HalfSpace outside = box.half_space(cube, Side::outside);
    for (int k = 0; k < 6; ++k) {
      Vector in = random_point_of(random, cube, k % 2 == 0);
      Vector out = random_point_of(random, cube, k % 3 == 0);
      if (reference.gauge(in) > 1) std::swap(in, out);
      if (reference.gauge(in) > 1 || reference.gauge(out) <= 1) continue;
      for (int step = 0; step < 30; ++step) {
        Vector middle;
        for (std::size_t j = 0; j < 3; ++j) middle[j] = (in[j] + out[j]) / 2;
        (reference.gauge(middle) <= 1 ? in : out) = middle;
      }
      ++checked;
      ASSERT_LE(height(inside, cube, in), inside.offset) << description(primitive, cube);
      ASSERT_LE(height(outside, cube, out), outside.offset) << description(primitive, cube);
    }
  }
  EXPECT_GT(checked, 1000);
}

TEST(FarBoxPrimitiveTest, EnormousNumbersNeitherThrowNorDeceive) {
  std::vector<Primitive> primitives;
  for (const double scale : {1e-300, 1e-150, 1.0, 1e150, 1e300}) {
    for (const double k : {0.0, 0.2 / scale, -0.2 / scale}) {
      primitives.push_back(
          {"a", {{scale, 2.0 * scale, 3.0 * scale}, {0.05, 2.0}}, {{0.1, -1e300, 3.0}, {1, 2, 3, 4}}, Bend{k, 20.0}});
      primitives.push_back({"b",
                            {{scale, 2.0 * scale, 3.0 * scale}, {1.3, 0.7}},
                            {{0.0, 0.0, 0.0}, {1e-200, 1e-200, 0, 0}},
                            Bend{k, 20.0}});
      primitives.push_back({"c", {{scale, 2.0 * scale, 3.0 * scale}, {1e-300, 1e-9}}, {}, {}});
    }
  }
  for (const Primitive& primitive : primitives) {
    const BoxPrimitive box(primitive);
    for (const double c : {0.0, 1e-310, 1e-150, 1.0, 1e150, -1e300, 1.7e308}) {
      for (const double h : {0.0, 1e-310, 1.0, 1e150, 1.7e308}) {
        for (const Point& centre : {Point{c, 0.0, 0.0}, Point{c, c, -c}, Point{0.0, c, 1e300}}) {
          const Cube cube{centre, h};
          ASSERT_NO_THROW({
            const Colour colour = box.colour(cube);
            // The centre of a primitive at the origin lies in every cube that reaches it.
            if (primitive.name != "a" && std::max({std::fabs(c), std::fabs(centre[2])}) <= h) {
              EXPECT_NE(colour, Colour::white) << description(primitive, cube);
            }
            for (const Side side : {Side::inside, Side::outside}) {
              const HalfSpace s = box.half_space(cube, side);
              EXPECT_FALSE(std::isnan(s.offset));
              EXPECT_TRUE(std::isfinite(s.normal[0]) && std::isfinite(s.normal[1]) && std::isfinite(s.normal[2]));
            }
          }) << description(primitive, cube);
        }
      }
    }
    EXPECT_EQ(box.colour({{1e307, 1e307, 1e307}, 1.0}), Colour::white) << description(primitive, {});
  }
}

TEST(CutBoxPrimitiveTest, CubesAcrossTheCutAreWhiteWhereSmall) {
  // Bent to within 0.14 of a full turn: the ends nearly meet beyond the centre of curvature at x = 1 / k.
  const Primitive primitive{"ring", {{0.3, 0.3, 3.0}, {0.5, 1.0}}, {}, Bend{1.0, 0.0}};
  const BoxPrimitive box(primitive);
  EXPECT_EQ(box.colour({{2.0, 0.0, 0.0}, 0.05}), Colour::white);
  EXPECT_EQ(box.colour({{2.0, 0.0, 0.0}, 0.0}), Colour::white);
  EXPECT_EQ(box.colour({{1.0, 0.0, 0.0}, 0.1}), Colour::white);
  EXPECT_EQ(box.colour({{0.0, 0.0, 0.0}, 0.1}), Colour::black);
  EXPECT_EQ(box.colour({{2.0, 0.0, 0.0}, 0.5}), Colour::gray);
}

}  // namespace
}  // namespace verisq::verify
