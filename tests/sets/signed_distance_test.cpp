/// The host's last word against closed forms: spheres, ellipsoids, octahedra, axes, poses, unions, extreme numbers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>

#include "tests/fixtures/random.hpp"
#include "tests/oracle/real.hpp"

namespace verisq {
namespace {

using oracle::Real;  // 200 bits
using testing::Random;

Primitive primitive(const std::array<double, 3>& semi_axes, const std::array<double, 2>& exponents,
                    const Pose& pose = {}) {
  return {"", {semi_axes, exponents}, pose};
}

Enclosure distance(const Model& model, const Point& point, double tolerance = 0.0) {
  return SignedDistance(model)(point, tolerance);
}

Enclosure distance(const Primitive& solid, const Point& point, double tolerance = 0.0) {
  return distance(Model{"", {solid}}, point, tolerance);
}

Real norm(const Point& x) {
  return oracle::length(oracle::widened(x));
}

/// Contains the exact value and is at most `width` wide.
void expect_encloses(const Enclosure& enclosure, const Real& exact, double width) {
  EXPECT_LE(Real(enclosure.lo), exact);
  EXPECT_GE(Real(enclosure.hi), exact);
  EXPECT_LE(enclosure.width(), width);
}

/// The distance of the binary64 neighbours about x > 0.
double ulp(double x) {
  return std::nextafter(x, infinity) - x;
}

TEST(SignedDistanceTest, Sphere) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const double radius = std::exp(random.uniform(-3.0, 3.0));
    const Primitive sphere = primitive({radius, radius, radius}, {1.0, 1.0});
    const Point inside = random.point(0.5 * radius);
    expect_encloses(distance(sphere, inside), norm(inside) - radius, 4e-16 * radius);
    const Point outside = random.point(100.0 * radius);
    expect_encloses(distance(sphere, outside), norm(outside) - radius, 4e-14 * radius);
  }
}

TEST(SignedDistanceTest, SphereWithAnyPose) {
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    const Point centre = random.point(1000.0);
    const Pose pose{centre, {random.uniform(-9, 9), random.uniform(-1, 1), random.uniform(-1, 1), 0.5}};
    const Primitive sphere = primitive({3.0, 3.0, 3.0}, {1.0, 1.0}, pose);
    const Point x = random.point(1000.0);
    const Real exact = oracle::length(oracle::difference(oracle::widened(x), oracle::widened(centre))) - 3;
    expect_encloses(distance(sphere, x), exact, 1e-12);
  }
}

/// On an axis outside, the axis point of the surface is nearest for every exponent: the distance is |q| - a.
TEST(SignedDistanceTest, AxesOutside) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    const std::array<double, 3> a{random.uniform(0.1, 9.0), random.uniform(0.1, 9.0), random.uniform(0.1, 9.0)};
    const Primitive solid = primitive(a, {i % 5 == 0 ? 2.0 : random.uniform(0.05, 2.0), i % 7 == 0 ? 2.0 : 0.7});
    for (std::size_t k = 0; k < 3; ++k) {
      Point q{};
      q[k] = -a[k] - std::exp(random.uniform(-20.0, 10.0));
      const Real exact = -Real(q[k]) - Real(a[k]);
      expect_encloses(distance(solid, q), exact, 4e-16 * exact.convert_to<double>());
    }
  }
}

/// The centre of a solid with e <= 1 is as deep as the shortest semi-axis.
TEST(SignedDistanceTest, CentreOfRoundedBoxes) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const std::array<double, 3> a{random.uniform(0.1, 9.0), random.uniform(0.1, 9.0), random.uniform(0.1, 9.0)};
    const Primitive solid = primitive(a, {random.uniform(0.05, 1.0), random.uniform(0.05, 1.0)});
    const double shortest = *std::min_element(a.begin(), a.end());
    expect_encloses(distance(solid, {0.0, 0.0, 0.0}), -Real(shortest), 4e-16 * shortest);
  }
}

/// At e = 2 the solid is an octahedron: inside, the nearest face is that of q's own octant.
TEST(SignedDistanceTest, OctahedronInside) {
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    std::array<double, 3> a{random.uniform(0.5, 5.0), random.uniform(0.5, 5.0), random.uniform(0.5, 5.0)};
    if (i % 3 == 0) a[1] = a[0];  // a square section is not a circle
    const Primitive solid = primitive(a, {2.0, 2.0});
    Point q{a[0] * random.uniform(-0.33, 0.33), a[1] * random.uniform(-0.33, 0.33), a[2] * random.uniform(-0.33, 0.33)};
    if (i % 4 == 0) q[static_cast<std::size_t>(i / 4 % 3)] = 0.0;
    Real gauge = 0;
    Real normal = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      gauge += abs(Real(q[k])) / a[k];
      normal += 1 / (Real(a[k]) * a[k]);
    }
    expect_encloses(distance(solid, q), (gauge - 1) / sqrt(normal), 2e-14 * 5.0);
  }
}

/// From face centres outward the octahedron's face is nearest; beyond an edge or a vertex, that.
TEST(SignedDistanceTest, OctahedronOutside) {
  const Primitive solid = primitive({1.0, 1.0, 1.0}, {2.0, 2.0});
  expect_encloses(distance(solid, {1.0, 1.0, 1.0}), 2 / sqrt(Real(3)), ulp(1.0));
  expect_encloses(distance(solid, {-1.0, 1.0, 1.25}), Real(2.25) / sqrt(Real(3)), ulp(1.0));
  expect_encloses(distance(solid, {1.0, -1.0, 0.0}), 1 / sqrt(Real(2)), ulp(0.5));
  expect_encloses(distance(solid, {0.0, 2.0, 2.0}), 3 / sqrt(Real(2)), ulp(2.0));
  expect_encloses(distance(solid, {0.5, 0.5, 9.0}), sqrt(Real(64.5)), ulp(8.0));
  expect_encloses(distance(solid, {0.0, -7.0, 0.0}), Real(6), ulp(6.0));
}

/// An ellipsoid's point at distance s along its normal.
TEST(SignedDistanceTest, EllipsoidAlongNormals) {
  Random random(6);
  const std::array<double, 3> a{1.0, 2.0, 4.0};
  const Primitive solid = primitive(a, {1.0, 1.0});
  for (int i = 0; i < 300; ++i) {
    const Point u = random.point(1.0);
    const double s = std::exp(random.uniform(-20.0, 5.0)) * (i % 2 == 0 ? 1.0 : -0.05);
    oracle::Vector x;
    oracle::Vector n;
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = Real(u[k]) / norm(u) * a[k];
      n[k] = Real(u[k]) / a[k];
    }
    const Real length = oracle::length(n);
    oracle::Vector q;
    for (std::size_t k = 0; k < 3; ++k) q[k] = x[k] + s * n[k] / length;
    const Point rounded = oracle::rounded(q);
    const Real slack = oracle::length(oracle::difference(q, oracle::widened(rounded)));
    if (s < -0.2) continue;  // deeper than the least radius of curvature, 1/4, another point may be nearer
    const Enclosure found = distance(solid, rounded);
    EXPECT_LE(Real(found.lo), Real(s) + slack);
    EXPECT_GE(Real(found.hi), Real(s) - slack);
    EXPECT_LE(found.width(), 1e-13);
  }
}

/// A solid in a box, seen from a corner: between the distances of the box and of the box less the rounding of corners.
TEST(SignedDistanceTest, NearlyABox) {
  const Primitive solid = primitive({1.0, 2.0, 3.0}, {0.05, 0.05});
  const Enclosure corner = distance(solid, {2.0, 3.0, 4.0});
  EXPECT_GT(corner.lo, std::sqrt(3.0));
  EXPECT_LT(corner.hi, std::sqrt(3.0) + 6.0 * 0.05);
  expect_encloses(distance(solid, {0.0, 0.0, 0.5}), Real(-1), 5e-14);
  expect_encloses(distance(solid, {4.0, 0.0, 0.0}), Real(3), ulp(3.0));
}

TEST(SignedDistanceTest, SurfacePointsHaveDistanceZero) {
  for (const double e : {0.05, 0.5, 1.0, 1.5, 2.0}) {
    const Primitive solid = primitive({1.0, 2.0, 3.0}, {e, e});
    for (const Point& q : {Point{1.0, 0.0, 0.0}, Point{0.0, -2.0, 0.0}, Point{0.0, 0.0, 3.0}}) {
      expect_encloses(distance(solid, q), Real(0), 1e-300);
    }
  }
}

/// Reflections, quarter turns and the turn that exchanges the axes cyclically are exact in binary64. The latter tells a
/// rotation from its inverse, which the symmetry of the solid hides for quarter turns.
TEST(SignedDistanceTest, ExactRotationsAndReflections) {
  const Superquadric shape{{1.0, 2.0, 3.0}, {0.7, 1.4}};
  const Point centre{10.0, 20.0, 30.0};
  const Primitive plain{"", shape, {}};
  const Primitive quarter{"", shape, {centre, {0.25, 0.0, 0.0, 0.25}}};  // x -> y -> -x
  const Primitive cyclic{"", shape, {centre, {0.5, 0.5, 0.5, 0.5}}};     // x -> y -> z -> x
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    Point q = random.point(4.0);
    for (double& c : q) c = std::round(c * 1024.0) / 1024.0;  // so that translation rounds nothing
    const Enclosure expected = distance(plain, q, 1e-9);
    EXPECT_EQ(distance(plain, {-q[0], q[1], -q[2]}, 1e-9), expected);
    EXPECT_EQ(distance(quarter, {10.0 - q[1], 20.0 + q[0], 30.0 + q[2]}, 1e-9), expected);
    EXPECT_EQ(distance(cyclic, {10.0 + q[2], 20.0 + q[0], 30.0 + q[1]}, 1e-9), expected);
  }
}

TEST(SignedDistanceTest, ToleranceIsReached) {
  const Primitive solid = primitive({1.0, 2.0, 3.0}, {0.4, 0.9});
  for (const double tolerance : {1e-2, 1e-6, 1e-9, 1e-12}) {
    EXPECT_LE(distance(solid, {0.1, 0.4, -0.3}, tolerance).width(), tolerance);
  }
}

TEST(UnionDistanceTest, OutsideIsTheMinimum) {
  const Primitive left = primitive({1.0, 1.0, 1.0}, {1.0, 1.0}, {{-5.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}});
  const Primitive right = primitive({2.0, 2.0, 2.0}, {1.0, 1.0}, {{5.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}});
  const Model model{"", {left, right}};
  expect_encloses(distance(model, {0.0, 0.0, 0.0}), Real(3), ulp(3.0));
  expect_encloses(distance(model, {-2.0, 0.0, 0.0}), Real(2), ulp(2.0));
  expect_encloses(distance(model, {-5.5, 0.0, 0.0}), Real(-0.5), 1e-15);
}

TEST(UnionDistanceTest, NestedSolidsKeepTheOuterDepth) {
  const Model model{"", {primitive({1.0, 1.0, 1.0}, {0.5, 1.5}), primitive({9.0, 9.0, 9.0}, {1.0, 1.0})}};
  expect_encloses(distance(model, {0.0, 0.5, 0.0}), Real(-8.5), 1e-14);
}

/// Equal spheres whose centres are 1 apart: at the origin each is 0.5 deep, the union sqrt(3)/2.
TEST(UnionDistanceTest, OverlapIsHonest) {
  const auto sphere = [](double x) {
    return primitive({1.0, 1.0, 1.0}, {1.0, 1.0}, {{x, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}});
  };
  const Enclosure found = distance(Model{"", {sphere(-0.5), sphere(0.5)}}, {0.0, 0.0, 0.0});
  expect_encloses(found, -sqrt(Real(0.75)), 2.0);
  EXPECT_LE(found.hi, -0.5);
  EXPECT_GE(found.lo, -1.5 - ulp(1.5));  // the way through the other sphere
}

/// Octahedra that share a face: a point of the face is on both surfaces and inside the union.
TEST(UnionDistanceTest, SharedFaceIsInside) {
  const Primitive octahedron = primitive({3.0, 3.0, 3.0}, {2.0, 2.0});
  Primitive neighbour = octahedron;
  neighbour.pose.translation = {2.0, 2.0, 2.0};
  const Model model{"", {octahedron, neighbour}};
  const Point on_both{1.0, 1.0, 1.0};
  ASSERT_TRUE(distance(octahedron, on_both).contains(0.0));
  ASSERT_TRUE(distance(neighbour, on_both).contains(0.0));
  // Every other face is 2/sqrt(3) away, so that half the ball of this radius lies in one solid, half in the other.
  EXPECT_LE(Real(distance(model, on_both).lo), -2 / sqrt(Real(3)));
}

TEST(UnionDistanceTest, FarPrimitivesChangeNothing) {
  const Primitive near = primitive({1.0, 2.0, 3.0}, {0.4, 0.9});
  Model model{"", {near}};
  for (int i = 1; i <= 50; ++i) {
    model.primitives.push_back(primitive({1.0, 1.0, 1.0}, {0.3, 0.3}, {{100.0 * i, 0.0, 0.0}, {1.0, 0.5, 0.2, 0.1}}));
  }
  for (const Point& q : {Point{0.1, 0.2, 0.3}, Point{-3.0, 1.0, 2.0}}) {
    const Enclosure alone = distance(near, q, 1e-9);
    const Enclosure together = distance(model, q, 1e-9);
    EXPECT_EQ(together.hi, alone.hi);
    EXPECT_NEAR(together.lo, alone.lo, 1e-14);
  }
}

/// Whatever the finite numbers: an interval, no NaN, no exception.
TEST(ExtremeInputTest, AlwaysAnInterval) {
  const double smallest = std::numeric_limits<double>::denorm_min();
  const double largest = std::numeric_limits<double>::max();
  const std::vector<double> lengths{smallest, 1e-300, 1e-200, 1.0, 1e200, 1e300, largest};
  const std::vector<double> exponents{smallest, 1e-300, 1e-12, 0.05, 1.0, std::nextafter(2.0, 0.0), 2.0};
  Random random(8);
  const auto pick = [&](const std::vector<double>& from) {
    return from[static_cast<std::size_t>(random.uniform(0.0, 0.999) * static_cast<double>(from.size()))];
  };
  for (int i = 0; i < 3000; ++i) {
    Model model;
    for (int k = 0; k < 1 + i % 2; ++k) {
      Primitive solid = primitive({pick(lengths), pick(lengths), pick(lengths)}, {pick(exponents), pick(exponents)});
      if (i % 3 == 0) solid.pose = {{pick(lengths), 0.0, -pick(lengths)}, {pick(lengths), 0.0, -pick(lengths), 1.0}};
      model.primitives.push_back(solid);
    }
    const Point q{pick(lengths), i % 5 == 0 ? 0.0 : -pick(lengths), i % 7 == 0 ? 0.0 : pick(lengths)};
    const Enclosure found = distance(model, q, 1e-6);
    ASSERT_LE(found.lo, found.hi) << "case " << i;
    ASSERT_GE(bounding_radius(model), 0.0);
  }
}

TEST(ExtremeInputTest, ScalingByPowersOfTwoScalesTheResult) {
  const double scale = 0x1p-700;
  const Enclosure plain = distance(primitive({1.0, 2.0, 3.0}, {0.7, 1.4}), {0.3, -0.4, 0.5}, 1e-9);
  const Enclosure tiny = distance(primitive({scale, 2.0 * scale, 3.0 * scale}, {0.7, 1.4}),
                                  {0.3 * scale, -0.4 * scale, 0.5 * scale}, 1e-9 * scale);
  EXPECT_EQ(tiny.lo, plain.lo * scale);
  EXPECT_EQ(tiny.hi, plain.hi * scale);
}

TEST(SignedDistanceTest, ManyThreadsGetTheSameAnswer) {
  const SignedDistance solid(Model{"", {primitive({1.0, 2.0, 3.0}, {0.7, 1.4})}});
  const std::vector<Point> points{{0.1, 0.2, 0.3}, {4.0, -1.0, 2.0}, {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  const auto all = [&] {
    std::vector<Enclosure> found;
    for (int i = 0; i < 50; ++i) {
      for (const Point& q : points) found.push_back(solid(q, 1e-9));
    }
    return found;
  };
  std::vector<std::future<std::vector<Enclosure>>> threads;
  threads.reserve(4);
  for (int i = 0; i < 4; ++i) threads.push_back(std::async(std::launch::async, all));
  const std::vector<Enclosure> expected = all();
  for (auto& thread : threads) EXPECT_EQ(thread.get(), expected);
}

TEST(BoundingRadiusTest, IsHalfTheDiagonalOfTheBox) {
  EXPECT_NEAR(bounding_radius({"", {primitive({1.0, 2.0, 2.0}, {1.0, 1.0})}}), 3.0, 1e-15);
  const Primitive turned = primitive({1.0, 2.0, 2.0}, {1.0, 1.0}, {{7.0, 8.0, 9.0}, {1.0, 1.0, 0.0, 0.0}});
  EXPECT_NEAR(bounding_radius({"", {turned}}), 3.0, 1e-14);
  const Primitive left = primitive({1.0, 1.0, 1.0}, {1.0, 1.0}, {{-2.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}});
  const Primitive right = primitive({1.0, 1.0, 1.0}, {1.0, 1.0}, {{2.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}});
  EXPECT_NEAR(bounding_radius({"", {left, right}}), std::sqrt(11.0), 1e-15);
}

}  // namespace
}  // namespace verisq
