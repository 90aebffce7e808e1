/// The distance of two models: closed forms, touching and overlapping solids, unions, random pairs, certificates.
#include "verify/search/model_distance.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>

#include "tests/fixtures/requested_count.hpp"

namespace verisq {
namespace {

Enclosure prove(const Model& a, const Model& b, const Pose& pose, const PairCertificate& certificate) {
  return PairChecker(a, b).prove(pose, certificate);
}

Primitive primitive(const Superquadric& solid, const Pose& pose = {}) {
  return {"solid", solid, pose};
}

Model model(const Superquadric& solid, const Pose& pose = {}) {
  return {"", {primitive(solid, pose)}};
}

Superquadric ball(double radius) {
  return {{radius, radius, radius}, {1.0, 1.0}};
}

Pose at(double x, double y, double z) {
  return {{x, y, z}, {1.0, 0.0, 0.0, 0.0}};
}

/// An enclosure of `exact` that is at most `width` wide, and a certificate that proves it again.
void expect_distance(const Model& a, const Model& b, double exact, double width, const Pose& pose = {}) {
  const ModelDistance found = PairDistance(a, b)(pose);
  const double rounding = 1e-15 * exact;  // `exact` may be a rounded number itself
  EXPECT_LE(found.distance.lo, exact + rounding);
  EXPECT_GE(found.distance.hi, exact - rounding);
  EXPECT_LE(found.distance.width(), width);
  EXPECT_EQ(found.proximity, Proximity::separated);
  EXPECT_EQ(prove(a, b, pose, found.certificate), found.distance);
}

bool contains(const std::array<Enclosure, 3>& box, const Point& x) {
  return box[0].contains(x[0]) && box[1].contains(x[1]) && box[2].contains(x[2]);
}

double largest_side(const ClosestPoints& points) {
  double side = 0.0;
  for (std::size_t k = 0; k < 3; ++k) side = std::max({side, points.on_a[k].width(), points.on_b[k].width()});
  return side;
}

// ---------------------------------------------------------------- closed forms

TEST(ModelDistanceTest, BallsInAnyDirection) {
  for (const Point& c : {Point{3, 4, 0}, Point{2, 3, 6}, Point{0, 0, 7}, Point{-1, 4, -8}, Point{5, 0, 0}}) {
    const double between = std::hypot(c[0], c[1], c[2]);
    expect_distance(model(ball(1.0)), model(ball(0.5), at(c[0], c[1], c[2])), between - 1.5, 1e-14);
  }
}

TEST(ModelDistanceTest, NearAndFarBalls) {
  expect_distance(model(ball(1.0)), model(ball(1.0), at(2.0 + 0x1p-20, 0, 0)), 0x1p-20, 1e-15);
  expect_distance(model(ball(1.0)), model(ball(1.0), at(0, 0x1p40, 0)), 0x1p40 - 2.0, 1e-3);
  expect_distance(model(ball(0x1p-300)), model(ball(0x1p-300), at(0, 0, 0x1p-298)), 0x1p-299, 1e-14 * 0x1p-299);
  expect_distance(model(ball(0x1p300)), model(ball(0x1p300), at(0, 0, 0x1p302)), 0x1p301, 1e-14 * 0x1p301);
}

TEST(ModelDistanceTest, ContactsOnTheAxesHaveZeroComponents) {
  for (const double e1 : {0.05, 0.1, 0.7, 1.0, 1.5, 1.95, 2.0}) {
    for (const double e2 : {0.05, 0.4, 1.0, 1.3, 1.95, 2.0}) {
      const Superquadric a{{1.0, 2.0, 3.0}, {e1, e2}};
      const Superquadric b{{0.5, 0.25, 0.125}, {e2, e1}};
      SCOPED_TRACE(fmt::format("exponents {} {}", e1, e2));
      expect_distance(model(a), model(b, at(4, 0, 0)), 2.5, 1e-13);
      expect_distance(model(a), model(b, at(0, -4, 0)), 1.75, 1e-13);
      expect_distance(model(a), model(b, at(0, 0, 4)), 0.875, 1e-13);
    }
  }
}

TEST(ModelDistanceTest, OctahedronsVertexToVertexAndFaceToFace) {
  const Superquadric octahedron{{1.0, 1.0, 1.0}, {2.0, 2.0}};
  expect_distance(model(octahedron), model(octahedron, at(3, 0, 0)), 1.0, 1e-14);
  const double face = 1.0 / std::sqrt(3.0);  // of x + y + z = 1 from the origin
  expect_distance(model(octahedron), model(octahedron, at(2, 2, 2)), 2.0 * std::sqrt(3.0) - 2.0 * face, 1e-12);
  expect_distance(model(octahedron), model(ball(1.0), at(2, 2, 2)), 2.0 * std::sqrt(3.0) - face - 1.0, 1e-12);
}

TEST(ModelDistanceTest, PosesTurnTheSolids) {
  const Superquadric cigar{{0.25, 0.5, 3.0}, {0.6, 1.2}};
  const double half = std::sqrt(0.5);
  // A quarter turn about y lays the long axis along x; no quaternion of binary64 numbers is exactly a quarter turn.
  const Pose turned{{5.0, 0.0, 0.0}, {half, 0.0, half, 0.0}};
  const ModelDistance by_pose = PairDistance(model(ball(1.0)), model(cigar))(turned);
  const ModelDistance by_model = PairDistance(model(ball(1.0)), model(cigar, turned))();
  EXPECT_NEAR(by_pose.distance.lo, 1.0, 1e-14);
  EXPECT_EQ(by_pose.distance, by_model.distance);
  // The length of the quaternion does not matter: powers of two change nothing at all.
  const Pose longer{{5.0, 0.0, 0.0}, {4.0 * half, 0.0, 4.0 * half, 0.0}};
  EXPECT_EQ(PairDistance(model(ball(1.0)), model(cigar))(longer).distance, by_pose.distance);
}

// ---------------------------------------------------------------- many primitives

/// Balls about random centres, some of them far away.
Model cloud(std::mt19937_64& random, std::size_t count, double offset) {
  const auto between = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  Model result;
  for (std::size_t i = 0; i < count; ++i) {
    const double far = i % 7 == 0 ? 1e6 : 1.0;
    result.primitives.push_back(primitive(
        ball(between(0.01, 0.3)), at(offset + far * between(0.0, 4.0), between(-4.0, 4.0), between(-4.0, 4.0))));
  }
  return result;
}

double least_distance_of_balls(const Model& a, const Model& b) {
  double least = infinity;
  for (const Primitive& p : a.primitives) {
    for (const Primitive& q : b.primitives) {
      const Point& c = p.pose.translation;
      const Point& d = q.pose.translation;
      least = std::min(least, std::hypot(c[0] - d[0], c[1] - d[1], c[2] - d[2]) - p.superquadric.semi_axes[0] -
                                  q.superquadric.semi_axes[0]);
    }
  }
  return least;
}

TEST(ModelDistanceTest, LeavesNoNearPairOut) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 20; ++round) {
    const Model a = cloud(random, 60, -4.5);
    const Model b = cloud(random, 80, 0.5);
    const double exact = least_distance_of_balls(a, b);
    ASSERT_GT(exact, 0.0);
    expect_distance(a, b, exact, 1e-9);
  }
}

TEST(ModelDistanceTest, ProvesFewOfManyPairs) {
  std::mt19937_64 random(6);
  const Model a = cloud(random, 1500, -4.5);
  const Model b = cloud(random, 1500, 0.5);
  const ModelDistance found = PairDistance(a, b)();
  const double exact = least_distance_of_balls(a, b);
  EXPECT_NEAR(found.distance.lo, exact, 1e-9);
  EXPECT_NEAR(found.distance.hi, exact, 1e-9);
  EXPECT_LT(found.certificate.separations.size(), 1000U) << "of 2.25 million";
}

/// Far from the origin, where centres are enclosed by wide boxes because large numbers cancel in them.
TEST(ModelDistanceTest, LeavesNoNearPairOutWhereCentresCancel) {
  const double far = 0x1p80;
  const Model a{"", {primitive(ball(1.0), at(far, 0.0, 0.0)), primitive(ball(1.0), at(far, 10.0, 0.0))}};
  const Model b{"", {primitive(ball(1.0), at(0.0, 3.0, 0.0)), primitive(ball(1.0), at(0.0, 40.0, 0.0))}};
  const Pose pose = at(far, 0.0, 0.0);
  const ModelDistance found = PairDistance(a, b)(pose);
  EXPECT_TRUE(found.distance.contains(1.0));
  EXPECT_EQ(prove(a, b, pose, found.certificate), found.distance);
}

TEST(ModelDistanceTest, InterruptedIsValidAndWide) {
  // Long bars side by side: their bounding spheres tell nothing.
  const Superquadric bar{{1.0, 0.9, 100.0}, {0.5, 1.1}};
  Model a;
  Model b;
  for (int i = 0; i < 12; ++i) {
    a.primitives.push_back(primitive(bar, at(2.5 * i, 0.0, 0.0)));
    b.primitives.push_back(primitive(bar, at(2.5 * i, 5.0 - 0.01 * i, 0.0)));
  }
  const PairDistance pair(a, b);
  const ModelDistance whole = pair();
  EXPECT_TRUE(whole.complete);
  for (const int polls : {0, 1, 5, 40}) {
    int polled = 0;
    const ModelDistance part = pair({}, [&] { return ++polled > polls; });
    EXPECT_FALSE(part.complete);
    EXPECT_EQ(part.certificate.separations.size(), static_cast<std::size_t>(polls) + 1);
    EXPECT_LE(part.distance.lo, whole.distance.lo);
    EXPECT_GE(part.distance.hi, whole.distance.hi);
    EXPECT_EQ(prove(a, b, {}, part.certificate), part.distance);
    EXPECT_FALSE(pair.closest_points(part)) << "pairs that nobody looked at may have them";
  }
  EXPECT_TRUE(pair.closest_points(whole));
  EXPECT_FALSE(pair.closest_points(whole, {}, [] { return true; }));
}

// ---------------------------------------------------------------- overlapping, touching

TEST(ModelDistanceTest, OverlappingSolidsHaveAProvenCommonPoint) {
  const std::vector<std::pair<Model, Model>> cases{
      {model(ball(1.0)), model(ball(1.0))},
      {model(ball(1.0)), model(ball(0.1), at(0.3, 0.2, 0.1))},
      {model(ball(1.0)), model(ball(1.0), at(2.0 - 1e-4, 0.0, 0.0))},
      {model({{1, 1, 10}, {0.1, 0.1}}), model({{10, 1, 1}, {0.1, 0.1}}, at(3, 1.5, 7))},
      {model({{1, 2, 3}, {2.0, 2.0}}), model({{3, 2, 1}, {2.0, 0.3}}, at(1, 1, 1))},
      {model({{0.01, 5, 5}, {0.3, 1.7}}), model({{5, 0.01, 5}, {1.3, 0.2}}, at(1, 1, 1))}};
  for (const auto& [a, b] : cases) {
    const ModelDistance found = PairDistance(a, b)();
    EXPECT_EQ(found.proximity, Proximity::overlapping);
    EXPECT_EQ(found.distance, (Enclosure{0.0, 0.0}));
    ASSERT_TRUE(found.certificate.common);
    EXPECT_EQ(prove(a, b, {}, found.certificate), (Enclosure{0.0, 0.0}));
    EXPECT_FALSE(PairDistance(a, b).closest_points(found));
  }
}

/// A face touches a face but for rounding: the common point that is proposed is proven to lie in neither solid.
TEST(ModelDistanceTest, TouchingFacesHaveASmallUpperEnd) {
  const Primitive capsule{"capsule",
                          {{0.75, 0.75, 1.0}, {1.0, 0.8}},
                          {{6.757450984529313, -11.94495299105348, 2.4982095973985725}, {1, 0, 0, 0}}};
  const Primitive soap{"soap",
                       {{3.4, 4.3, 1.7}, {0.1, 0.1}},
                       {{10.907450984529312, -11.721427064048612, 2.4982095973985725}, {0, 0, 0, 1}}};
  const ModelDistance found = PairDistance(Model{"", {capsule}}, Model{"", {soap}})();
  EXPECT_EQ(found.distance.lo, 0.0);
  EXPECT_LT(found.distance.hi, 1e-14);
}

TEST(ModelDistanceTest, TouchingIsNeverCalledSeparated) {
  for (const double e : {0.1, 0.5, 1.0, 1.5, 2.0}) {
    const Superquadric solid{{1.0, 1.0, 1.0}, {e, e}};
    for (const Pose& pose : {at(2, 0, 0), at(0, -2, 0), at(0, 0, 2)}) {
      const ModelDistance found = PairDistance(model(solid), model(solid))(pose);
      EXPECT_NE(found.proximity, Proximity::separated) << e;
      EXPECT_EQ(found.distance.lo, 0.0) << e;
      EXPECT_LE(found.distance.hi, 1e-14) << e;
    }
  }
}

/// A common point of binary64 numbers is proven where there is one, and a distance of 0 proves one wherever it is.
TEST(ModelDistanceTest, TouchingAtANumberIsProven) {
  for (const double e : {0.1, 0.5, 1.0, 1.5, 2.0}) {
    const Superquadric solid{{1.0, 0.5, 2.0}, {e, e}};
    for (const Pose& pose : {at(2, 0, 0), at(0, -1, 0), at(0, 0, 4)}) {
      const ModelDistance found = PairDistance(model(solid), model(solid))(pose);
      EXPECT_EQ(found.distance, (Enclosure{0.0, 0.0})) << e;
      EXPECT_EQ(found.proximity, Proximity::overlapping) << e;
      ASSERT_TRUE(found.certificate.common) << e;
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ((*found.certificate.common)[i], 0.5 * pose.translation[i]) << e;
      EXPECT_EQ(prove(model(solid), model(solid), pose, found.certificate), (Enclosure{0.0, 0.0})) << e;
    }
  }
}

/// Balls that all but touch: the gap is known exactly, whatever is said of them agrees with it.
TEST(ModelDistanceTest, WhatIsSaidOfNearlyTouchingSolidsAgreesWithTheirDistance) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 300; ++i) {
    const double step = std::round(2.0 * normal(random)) * 0x1p-52;
    const double x = 2.0 + step;
    const Pose pose = i % 3 == 0 ? at(x, 0, 0) : i % 3 == 1 ? at(0, 0, -x) : at(x * 0.6, 0, x * 0.8);
    const Point& t = pose.translation;
    const long double squared = static_cast<long double>(t[0]) * t[0] + static_cast<long double>(t[2]) * t[2];
    const long double gap = std::max(0.0L, std::sqrt(squared) - 2.0L);
    const ModelDistance found = PairDistance(model(ball(1.0)), model(ball(1.0)))(pose);
    constexpr long double rounding = 1e-18L;
    EXPECT_LE(found.distance.lo, gap + rounding);
    EXPECT_GE(found.distance.hi, gap - rounding);
    EXPECT_EQ(found.proximity == Proximity::separated, found.distance.lo > 0.0);
    EXPECT_EQ(found.proximity == Proximity::overlapping, found.distance.hi == 0.0);
    EXPECT_FALSE(gap > 1e-17L && found.proximity == Proximity::overlapping);
  }
}

// ---------------------------------------------------------------- closest points

TEST(ClosestPointsTest, OfBallsLieOnTheLineOfCentres) {
  const PairDistance pair(model(ball(1.0)), model(ball(2.0)));
  const Pose pose = at(0, 6, 8);
  const auto points = pair.closest_points(pair(pose), pose);
  ASSERT_TRUE(points);
  EXPECT_TRUE(points->unique);
  EXPECT_TRUE(contains(points->on_a, {0.0, 0.6, 0.8}));  // to within the rounding of these numbers, or the box fails
  EXPECT_TRUE(contains(points->on_b, {0.0, 4.8, 6.4}));
  EXPECT_LE(largest_side(*points), 1e-14);
}

TEST(ClosestPointsTest, OnAxesAreEnclosedByCaps) {
  for (const double e : {0.3, 0.8, 1.0, 1.6}) {
    const PairDistance pair(model({{1, 2, 3}, {e, e}}), model({{3, 2, 1}, {e, e}}));
    const Pose pose = at(6, 0, 0);
    const auto points = pair.closest_points(pair(pose), pose);
    ASSERT_TRUE(points);
    EXPECT_TRUE(points->unique);
    EXPECT_TRUE(contains(points->on_a, {1, 0, 0})) << e;
    EXPECT_TRUE(contains(points->on_b, {3, 0, 0})) << e;
    // By symmetry the other coordinates are 0: flat tips are no wider than sharp ones.
    EXPECT_LE(largest_side(*points), 1e-14) << e;
  }
}

TEST(ClosestPointsTest, OfParallelFacesAreNotUnique) {
  const Superquadric octahedron{{1.0, 1.0, 1.0}, {2.0, 2.0}};
  const PairDistance pair(model(octahedron), model(octahedron));
  const Pose pose = at(2, 2, 2);
  const auto points = pair.closest_points(pair(pose), pose);
  ASSERT_TRUE(points);
  EXPECT_FALSE(points->unique);
  // Point pairs (x, x + 4/3) for all x on the face x + y + z = 1: its corners are among them.
  for (const Point& corner : {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}}) {
    EXPECT_TRUE(contains(points->on_a, corner));
  }
}

TEST(ClosestPointsTest, OfASharpAndAStrictlyConvexSolidAreUnique) {
  const Superquadric octahedron{{1.0, 1.0, 1.0}, {2.0, 2.0}};
  const PairDistance pair(model(octahedron), model(ball(1.0)));
  const Pose pose = at(3, 0.25, 0.125);
  const auto points = pair.closest_points(pair(pose), pose);
  ASSERT_TRUE(points);
  EXPECT_TRUE(points->unique);
  EXPECT_TRUE(contains(points->on_a, {1, 0, 0}));
  EXPECT_LE(largest_side(*points), 1e-6);
}

// ---------------------------------------------------------------- unions

TEST(ModelDistanceTest, TheNearestPairOfTwoUnionsDecides) {
  const Model a{"", {primitive(ball(1.0)), primitive(ball(0.5), at(0, 5, 0)), primitive(ball(0.25), at(-9, 0, 0))}};
  const Model b{"", {primitive(ball(1.0), at(9, 0, 0)), primitive(ball(1.0), at(4, 5, 0))}};
  expect_distance(a, b, 2.5, 1e-14);
  const PairDistance pair(a, b);
  const ModelDistance found = pair();
  EXPECT_EQ(found.certificate.separations.front().primitive_a, 1U);
  EXPECT_EQ(found.certificate.separations.front().primitive_b, 1U);
  EXPECT_LT(found.certificate.separations.size(), 6U) << "spheres prune nothing";
  const auto points = pair.closest_points(found);
  ASSERT_TRUE(points);
  EXPECT_TRUE(points->unique);
  EXPECT_TRUE(contains(points->on_a, {0.5, 5, 0}));
}

TEST(ModelDistanceTest, TwoEquallyNearPairsAreNotUnique) {
  const Model a{"", {primitive(ball(1.0)), primitive(ball(1.0), at(0, 8, 0))}};
  const Model b{"", {primitive(ball(1.0), at(4, 0, 0)), primitive(ball(1.0), at(4, 8, 0))}};
  const PairDistance pair(a, b);
  const ModelDistance found = pair();
  EXPECT_TRUE(found.distance.contains(2.0));
  const auto points = pair.closest_points(found);
  ASSERT_TRUE(points);
  EXPECT_FALSE(points->unique);
  EXPECT_TRUE(contains(points->on_a, {1, 0, 0}));
  EXPECT_TRUE(contains(points->on_a, {1, 8, 0}));
}

TEST(ModelDistanceTest, OneOverlappingPairOfUnionsIsEnough) {
  const Model a{"", {primitive(ball(1.0)), primitive(ball(1.0), at(0, 8, 0))}};
  const Model b{"", {primitive(ball(1.0), at(4, 0, 0)), primitive(ball(1.0), at(1, 8, 0))}};
  const ModelDistance found = PairDistance(a, b)();
  EXPECT_EQ(found.proximity, Proximity::overlapping);
  EXPECT_EQ(prove(a, b, {}, found.certificate), (Enclosure{0.0, 0.0}));
}

// ---------------------------------------------------------------- certificates

TEST(PairCertificateTest, ProvesNothingFalseHoweverItIsChanged) {
  const Model a = model(ball(1.0));
  const Model b = model(ball(1.0), at(5, 0, 0));  // at distance 3
  const PairCertificate honest = PairDistance(a, b)().certificate;
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 500; ++k) {
    PairCertificate changed = honest;
    const double amount = std::pow(10.0, -static_cast<double>(k % 16));
    for (Point* x : {&changed.separations[0].vector, &changed.separations[0].on_a, &changed.separations[0].on_b}) {
      for (double& c : *x) c += amount * normal(engine);
    }
    EXPECT_TRUE(prove(a, b, {}, changed).contains(3.0)) << amount;
  }
}

TEST(PairCertificateTest, EmptyOrBrokenOnesProveNothing) {
  const Model a = model(ball(1.0));
  const Model b = model(ball(1.0), at(3, 0, 0));  // the spheres about the boxes of the solids meet
  const Enclosure nothing{0.0, infinity};
  EXPECT_EQ(prove(a, b, {}, {}), nothing);
  EXPECT_EQ(prove(a, b, {}, {{{7, 0, {1, 0, 0}, {1, 0, 0}, {-1, 0, 0}}}, {}}), nothing);
  EXPECT_EQ(prove(a, b, {}, {.common = Point{1.5, 0, 0}}), nothing) << "in neither";
  EXPECT_EQ(prove(a, b, {}, {.common = Point{1.0, 0, 0}}), nothing) << "in A alone";
  EXPECT_EQ(prove(a, b, {}, {.common = Point{std::nan(""), 0, 0}}), nothing);
  const Enclosure without_direction = prove(a, b, {}, {{{0, 0, {0, 0, 0}, {1, 0, 0}, {-1, 0, 0}}}, {}});
  EXPECT_EQ(without_direction.lo, 0.0);
  EXPECT_TRUE(without_direction.hi >= 1.0 && without_direction.hi < 1.0 + 1e-14);
  const Enclosure without_points = prove(a, b, {}, {{{0, 0, {1, 0, 0}, {infinity, 0, 0}, {-1, 0, 0}}}, {}});
  EXPECT_EQ(without_points.hi, infinity);
  EXPECT_TRUE(without_points.lo <= 1.0 && without_points.lo > 1.0 - 1e-14);
}

TEST(PairCertificateTest, BelongsToItsPose) {
  const Model a = model(ball(1.0));
  const Model b = model(ball(1.0));
  const PairCertificate certificate = PairDistance(a, b)(at(5, 0, 0)).certificate;
  const Enclosure nearer = prove(a, b, at(4, 0, 0), certificate);
  EXPECT_TRUE(nearer.contains(2.0));
  EXPECT_LT(nearer.hi, 3.0);
}

// ---------------------------------------------------------------- random pairs

class RandomPairs {
 public:
  explicit RandomPairs(std::uint64_t seed) : engine_(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }

  Superquadric solid() {
    const auto axis = [&] { return std::exp(uniform(-3.0, 3.0)); };
    return {{axis(), axis(), axis()}, {uniform(0.05, 1.95), uniform(0.05, 1.95)}};
  }

  Pose pose(double closest, double farthest) {
    Pose p;
    for (double& q : p.quaternion) q = normal_(engine_);
    const Point d{normal_(engine_), normal_(engine_), normal_(engine_)};
    const double radius = uniform(closest, farthest) / std::hypot(d[0], d[1], d[2]);
    for (std::size_t i = 0; i < 3; ++i) p.translation[i] = radius * d[i];
    return p;
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

struct Combination {
  const char* name;
  std::optional<Superquadric> a;  ///< a random one where there is none
  std::optional<Superquadric> b;
};

const Superquadric capsule{{0.75, 0.75, 1.0}, {1.0, 0.8}};
const Superquadric gem{{0.43, 0.6, 1.9}, {1.5, 0.4}};
const Superquadric soap{{3.4, 4.3, 1.7}, {0.1, 0.1}};

std::size_t requested_pairs() {
  return oracle::requested_count("VERISQ_PAIRS", 1000);
}

double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  const auto index = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  return values[std::min(values.size() - 1, index)];
}

TEST(ModelDistanceTest, RandomPairsAreEnclosedTightly) {
  fmt::print("{:<16}{:>8}{:>10}{:>11}{:>16}{:>14}{:>18}\n", "pair", "apart", "overlap", "undecided", "median width",
             "<= 1e-10", "fastest, median us");
  std::uint64_t seed = 0;
  for (const auto& [name, fixed_a, fixed_b] :
       {Combination{"capsule - gem", capsule, gem}, Combination{"gem - soap", gem, soap},
        Combination{"capsule - soap", capsule, soap}, Combination{"soap - soap", soap, soap},
        Combination{"random", std::nullopt, std::nullopt}}) {
    RandomPairs random(++seed);
    std::vector<double> widths;
    std::vector<double> microseconds;
    std::size_t overlapping = 0;
    std::size_t undecided = 0;
    std::size_t tight = 0;
    for (std::size_t k = 0; k < requested_pairs(); ++k) {
      const Superquadric solid_a = fixed_a ? *fixed_a : random.solid();
      const Superquadric solid_b = fixed_b ? *fixed_b : random.solid();
      const double size = std::max(std::ranges::max(solid_a.semi_axes), std::ranges::max(solid_b.semi_axes));
      const Model a = model(solid_a, random.pose(0.0, size));
      const Model b = model(solid_b, random.pose(0.0, size));
      const Pose pose = random.pose(0.5 * size, 6.0 * size);
      const PairDistance pair(a, b);
      const auto start = std::chrono::steady_clock::now();
      const ModelDistance found = pair(pose);
      microseconds.push_back(
          std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
      EXPECT_EQ(prove(a, b, pose, found.certificate), found.distance) << name << " " << k;
      overlapping += found.proximity == Proximity::overlapping ? 1 : 0;
      undecided += found.proximity == Proximity::undecided ? 1 : 0;
      if (found.proximity != Proximity::separated) continue;
      widths.push_back(found.distance.width() / found.distance.hi);
      tight += widths.back() <= 1e-10 ? 1 : 0;
    }
    fmt::print("{:<16}{:>8}{:>10}{:>11}{:>16.2g}{:>13.3f}%{:>18.1f}\n", name, widths.size(), overlapping, undecided,
               quantile(widths, 0.5), 100.0 * static_cast<double>(tight) / static_cast<double>(widths.size()),
               quantile(microseconds, 0.5));
    EXPECT_GT(widths.size(), requested_pairs() / 2) << name;
    EXPECT_LE(quantile(widths, 0.5), 1e-13) << name;
    EXPECT_GE(static_cast<double>(tight), 0.999 * static_cast<double>(widths.size())) << name;
    EXPECT_LE(undecided, requested_pairs() / 1000) << name;
  }
}

TEST(ModelDistanceTest, IsSymmetric) {
  RandomPairs random(99);
  for (int k = 0; k < 300; ++k) {
    const Model a = model(random.solid(), random.pose(0.0, 5.0));
    const Model b = model(random.solid(), random.pose(10.0, 100.0));
    const Enclosure forward = PairDistance(a, b)().distance;
    const Enclosure backward = PairDistance(b, a)().distance;
    EXPECT_LE(std::max(forward.lo, backward.lo), std::min(forward.hi, backward.hi)) << k;
  }
}

// ---------------------------------------------------------------- memory of earlier poses

Model many_balls(std::mt19937_64& generator, std::size_t count) {
  std::uniform_real_distribution<double> within(-1.0, 1.0);
  Model result{"", {}};
  for (std::size_t i = 0; i < count; ++i) {
    const Superquadric solid{{0.3 + 0.1 * within(generator), 0.3, 0.2}, {1.0 + 0.5 * within(generator), 1.0}};
    result.primitives.push_back(
        primitive(solid, {{3.0 * within(generator), 3.0 * within(generator), 3.0 * within(generator)},
                          {1.0, within(generator), within(generator), within(generator)}}));
  }
  return result;
}

/// Along a path, back and forth, and anywhere: which pairs are passed over must not be seen.
TEST(ModelDistanceTest, IsTheSameBitByBitWithAMemory) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> within(-1.0, 1.0);
  const Model a = many_balls(generator, 5);
  const Model b = many_balls(generator, 4);
  const PairDistance distance(a, b);
  PairDistance::Memory memory;
  Pose pose{{6.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
  int met = 0;
  for (int n = 0; n < 600; ++n) {
    const double step = n % 100 == 99 ? 3.0 : 0.03;
    for (double& coordinate : pose.translation) coordinate = 0.98 * coordinate + step * within(generator);
    for (double& element : pose.quaternion) element += step * within(generator);
    const ModelDistance alone = distance(pose);
    const ModelDistance with_memory = distance(pose, memory);
    EXPECT_EQ(with_memory.distance, alone.distance) << n;
    EXPECT_EQ(with_memory.proximity, alone.proximity) << n;
    EXPECT_EQ(prove(a, b, pose, alone.certificate), alone.distance) << n;
    met += alone.proximity == Proximity::overlapping ? 1 : 0;
  }
  EXPECT_GT(met, 0);
  EXPECT_LT(met, 600);
}

/// What is kept of a pair is a lower bound wherever B goes: beside the exact distance of two balls.
TEST(PairMemoryTest, KnowsNoMoreThanIsLeft) {
  std::mt19937_64 generator(8);
  std::uniform_real_distribution<double> within(-1.0, 1.0);
  for (const double size : {1e-3, 1.0, 1e3}) {
    const verify::PosedPrimitives a(model(ball(size)));
    const verify::PosedPrimitives b(model({{size, 0.5 * size, 0.2 * size}, {1.0, 1.0}}, at(0.3 * size, 0.0, 0.0)));
    verify::PairMemory memory;
    Pose pose{{5.0 * size, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
    const PairDistance exact(model(ball(size)),
                             model({{size, 0.5 * size, 0.2 * size}, {1.0, 1.0}}, at(0.3 * size, 0, 0)));
    int known = 0;
    for (int n = 0; n < 200; ++n) {
      for (double& coordinate : pose.translation) coordinate += 0.05 * size * within(generator);
      for (double& element : pose.quaternion) element += 0.05 * within(generator);
      memory.look_at(verify::PosedPairs(a, b, pose));
      const Enclosure now = exact(pose).distance;
      EXPECT_LE(memory.lower({0, 0}), now.hi) << n;
      known += memory.lower({0, 0}) > 0.0 ? 1 : 0;
      if (n % 20 == 0) memory.keep({0, 0}, now.lo);
    }
    EXPECT_GT(known, 100);
  }
}

/// As far as the farthest of many points of the solid's sphere goes, and not much farther.
TEST(PairMemoryTest, ADisplacementIsNoShorterThanAnyPoints) {
  std::mt19937_64 generator(9);
  std::uniform_real_distribution<double> within(-1.0, 1.0);
  const verify::PosedPrimitives a(model(ball(1.0)));
  const verify::PosedPrimitives b(model({{2.0, 0.5, 1.0}, {1.0, 1.0}}, {{3.0, 1.0, -2.0}, {0.5, 0.1, 0.2, 0.3}}));
  for (int n = 0; n < 200; ++n) {
    const double step = n % 2 == 0 ? 1.0 : 1e-6;
    const Pose from{{within(generator), within(generator), 1e3 * within(generator)},
                    {within(generator), within(generator), within(generator), within(generator)}};
    Pose to = from;
    for (double& coordinate : to.translation) coordinate += step * within(generator);
    for (double& element : to.quaternion) element += step * within(generator);
    const verify::PosedPairs before(a, b, from);
    const verify::PosedPairs after(a, b, to);
    const double bound = verify::displacement_up(verify::placement_of(before, 0), verify::placement_of(after, 0));
    double farthest = 0.0;
    for (int k = 0; k < 200; ++k) {
      verify::PreciseVector x = verify::precise(Point{within(generator), within(generator), within(generator)});
      const auto length = verify::length<verify::Real>(x);
      for (std::size_t i = 0; i < 3; ++i) x[i] = x[i] / length * before.radius_b(0);
      const auto way = verify::length<verify::Real>(after.motion_b(0)(x) - before.motion_b(0)(x));
      farthest = std::max(farthest, way.lower().to_double(verify::Direction::down));
    }
    EXPECT_GE(bound, farthest);
    EXPECT_LE(bound, 3.0 * farthest + 1e-9);
  }
}

}  // namespace
}  // namespace verisq
