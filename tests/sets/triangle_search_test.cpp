/// The host's distances of triangles to solids that are bent, cut or hollow, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <verisq/enclosure.hpp>

#include "tests/fixtures/bitten_ball.hpp"
#include "tests/fixtures/random.hpp"
#include "verisq/distance.hpp"

namespace verisq {
namespace {

using testing::Random;

Primitive ball(const Point& centre, double radius) {
  return {"ball", {{radius, radius, radius}, {1.0, 1.0}}, {centre, {1.0, 0.0, 0.0, 0.0}}};
}

SetExpression leaf(std::uint32_t primitive) {
  return {.operands = {}, .operation = SetOperation::unite, .primitive = primitive};
}

/// The unit ball without that of radius 1/2.
Model shell() {
  return {"", {ball({}, 1.0), ball({}, 0.5)}, SetExpression{{leaf(0), leaf(1)}, SetOperation::subtract}};
}

Triangle small_triangle(Random& random, const Point& at, double size) {
  Triangle triangle{at, at, at};
  for (Point& corner : triangle) {
    const Point off = random.point(size);
    for (std::size_t i = 0; i < 3; ++i) corner[i] += off[i];
  }
  return triangle;
}

/// Within the hollow the nearest point of a triangle is its corner farthest from the centre.
TEST(TriangleSearchTest, WithinAHollow) {
  const TriangleSearch search(shell());
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Triangle triangle = small_triangle(random, random.point(0.2), 0.05);
    double far = 0.0;
    for (const Point& p : triangle) far = std::max(far, std::hypot(p[0], p[1], p[2]));
    const Enclosure found = search(triangle, 1e-6);
    EXPECT_LE(found.lo, 0.5 - far + 1e-14);
    EXPECT_GE(found.hi, 0.5 - far - 1e-14);
    EXPECT_LE(found.width(), 1e-6);
  }
}

/// Closed form at every point: the least of many samples bounds the distance from above, and the exact one is not
/// farther below than half the way between two samples.
TEST(TriangleSearchTest, AboveTheRimOfABite) {
  Random random(2);
  constexpr int steps = 60;
  for (unsigned seed = 0; seed < 6; ++seed) {
    const oracle::BittenBallCase scene = oracle::random_bitten_ball(seed);
    const TriangleSearch search(scene.solid.model());
    const double size = seed % 2 == 0 ? 0.05 : 0.005;
    const Triangle triangle = small_triangle(random, scene.above, size);
    const Enclosure found = search(triangle, 1e-5);
    EXPECT_LE(found.width(), 1e-5);
    double least = infinity;
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        Point x{};
        for (std::size_t k = 0; k < 3; ++k)
          x[k] = triangle[0][k] + i * (triangle[1][k] - triangle[0][k]) / steps +
                 j * (triangle[2][k] - triangle[0][k]) / steps;
        least = std::min(least, scene.solid.distance(x));
      }
    }
    EXPECT_LE(found.lo, least + 1e-13) << seed;
    EXPECT_GE(found.hi, least - 4.0 * size / steps) << seed;
  }
}

/// A bent capsule's axis is an arc in the plane y = 0 about (1/k, 0, 0); beyond its ends and beside it distances are
/// those of round sections only for what the axis is the set of centres of: here the pole, whose normal is known.
TEST(TriangleSearchTest, BeyondThePoleOfABentSolid) {
  constexpr double curvature = 0.2;
  const Model model{"", {{"bow", {{0.5, 0.5, 3.0}, {1.0, 1.0}}, {}, Bend{curvature, 0.0}}}};
  const double angle = 3.0 * curvature;
  const Point pole{(1.0 - std::cos(angle)) / curvature, 0.0, std::sin(angle) / curvature};
  const Point normal{std::sin(angle), 0.0, std::cos(angle)};
  const Point across{std::cos(angle), 0.0, -std::sin(angle)};
  // A triangle in the plane normal to the pole's, 0.25 beyond it, about its normal.
  Triangle triangle{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(i) / 3.0;
    for (std::size_t k = 0; k < 3; ++k)
      triangle[i][k] =
          pole[k] + 0.25 * normal[k] + 0.1 * std::cos(turn) * across[k] + (k == 1 ? 0.1 * std::sin(turn) : 0.0);
  }
  const Enclosure found = TriangleSearch(model)(triangle, 1e-6);
  EXPECT_LE(found.lo, 0.25 + 1e-12);
  EXPECT_GE(found.hi, 0.25 - 1e-12);
  EXPECT_LE(found.width(), 1e-6);
}

TEST(TriangleSearchTest, MeetsTheCertificatesOfConvexSolids) {
  const Model model{"", {{"gem", {{1.0, 0.7, 1.5}, {0.6, 1.4}}, {{0.1, 0.2, 0.3}, {0.9, 0.1, 0.3, 0.2}}}}};
  const TriangleDistance certificates(model);
  const TriangleSearch search(model);
  Random random(5);
  for (int i = 0; i < 12; ++i) {
    const Triangle triangle = small_triangle(random, random.point(3.0), i % 2 == 0 ? 0.1 : 1.0);
    const Enclosure found = search(triangle, 1e-6);
    const Enclosure exact = certificates(triangle);
    EXPECT_LE(found.lo, exact.hi);
    EXPECT_GE(found.hi, exact.lo);
    EXPECT_LE(found.width(), 1e-6);
  }
}

TEST(TriangleSearchTest, ThroughTheWallAndInIt) {
  const TriangleSearch search(shell());
  const Triangle through{Point{0.0, 0.0, 0.0}, Point{0.0, 2.0, 0.0}, Point{2.0, 0.0, 0.0}};
  EXPECT_EQ(search(through, 1e-6), (Enclosure{0.0, 0.0}));
  const Triangle within{Point{0.7, 0.0, 0.0}, Point{0.71, 0.0, 0.0}, Point{0.7, 0.01, 0.0}};
  EXPECT_EQ(search(within, 1e-6), (Enclosure{0.0, 0.0}));
  // Around the solid, which has no point in its plane.
  const Triangle around{Point{-9.0, -9.0, 1.5}, Point{9.0, -9.0, 1.5}, Point{0.0, 9.0, 1.5}};
  const Enclosure found = search(around, 1e-6);
  EXPECT_TRUE(found.contains(0.5)) << found.lo << ' ' << found.hi;
  EXPECT_LE(found.width(), 1e-6);
}

TEST(TriangleSearchTest, OfAPointIsItsDistance) {
  const Model model = shell();
  const Point x{0.1, 0.2, -0.05};
  const Enclosure found = TriangleSearch(model)({x, x, x}, 1e-6);
  const Enclosure exact = SignedDistance(model)(x, 1e-9);
  EXPECT_LE(found.lo, exact.hi);
  EXPECT_GE(found.hi, exact.lo);
  EXPECT_LE(found.width(), 1e-6);
}

TEST(TriangleSearchTest, InterruptedItIsValid) {
  const Triangle triangle{Point{2.0, 0.0, 0.0}, Point{3.0, 0.0, 0.0}, Point{2.0, 1.0, 0.0}};
  const Enclosure found = TriangleSearch(shell())(triangle, 1e-9, [] { return true; });
  EXPECT_EQ(found, (Enclosure{0.0, infinity}));
}

TEST(TriangleSearchTest, OfAnEmptySolidNothingIsNear) {
  const Model apart{
      "", {ball({}, 1.0), ball({5.0, 0.0, 0.0}, 1.0)}, SetExpression{{leaf(0), leaf(1)}, SetOperation::intersect}};
  const Triangle triangle{Point{2.0, 0.0, 0.0}, Point{3.0, 0.0, 0.0}, Point{2.0, 1.0, 0.0}};
  EXPECT_EQ(TriangleSearch(apart)(triangle, 1e-6).hi, infinity);
}

/// All lengths times a power of two.
double scaled(double x, int exponent) {
  return std::ldexp(x, exponent);
}

Point scaled(const Point& x, int exponent) {
  return {scaled(x[0], exponent), scaled(x[1], exponent), scaled(x[2], exponent)};
}

Model scaled(Model model, int exponent) {
  for (Primitive& primitive : model.primitives) {
    for (double& a : primitive.superquadric.semi_axes) a = scaled(a, exponent);
    primitive.pose.translation = scaled(primitive.pose.translation, exponent);
  }
  return model;
}

/// Squares of such lengths are no binary64 numbers: distances are as tight as others, and no step is endless.
TEST(TriangleSearchTest, OfHugeAndTinyLengths) {
  const Model model = shell();
  Random random(3);
  const Triangle outside = small_triangle(random, {2.0, 1.0, 1.0}, 0.5);
  const Triangle within = small_triangle(random, {0.1, 0.1, 0.0}, 0.05);
  const Triangle through{{{3.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 3.0, 0.0}}};
  for (const int exponent : {-1000, -900, -520, 520, 900, 1000}) {
    const TriangleSearch search(scaled(model, exponent));
    for (const Triangle& triangle : {outside, within, through}) {
      const Enclosure usual = TriangleSearch(model)(triangle, 1e-6);
      const Triangle far{scaled(triangle[0], exponent), scaled(triangle[1], exponent), scaled(triangle[2], exponent)};
      const Enclosure found = search(far, scaled(1e-6, exponent));
      EXPECT_LE(found.lo, scaled(usual.hi, exponent)) << exponent;
      EXPECT_GE(found.hi, scaled(usual.lo, exponent)) << exponent;
      EXPECT_LE(found.width(), scaled(1e-6, exponent)) << exponent;
    }
  }
}

/// Far beyond: nothing is lost but the tightness, which the whole budget, some 90 seconds, does not bring back.
TEST(TriangleSearchTest, WhereLengthsOverflow) {
  const Model model = scaled(shell(), 1021);
  const Triangle beside{{{1.7e308, -1.7e308, 1.0}, {1.7e308, 1.7e308, 0.0}, {1.7e308, 0.0, 1.7e308}}};
  int polls = 0;
  const Enclosure found = TriangleSearch(model)(beside, 1e300, [&] { return ++polls > 200; });
  const double exact = 1.7e308 - std::ldexp(1.0, 1021);
  EXPECT_LE(found.lo, exact);
  EXPECT_GE(found.hi, exact);
}

}  // namespace
}  // namespace verisq
