/// The paper's method as published: its parts against the mathematics, its enclosures against the oracle and against
/// the duality certificate, and how wide they are.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>
#include <verisq/distance.hpp>

#include "tests/oracle/containment.hpp"
#include "tests/oracle/pair_reference.hpp"
#include "tests/oracle/published_solids.hpp"
#include "tests/oracle/random_pairs.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/certified_distance.hpp"

namespace verisq::verify {
namespace {

using oracle::RandomCases;

Vector3<double> exact(const Point& x) {
  return {x[0], x[1], x[2]};
}

Vector3<double> around(const Point& x, double radius) {
  const auto side = [radius](double c) {
    return Interval(add(c, -radius, Direction::down), add(c, radius, Direction::up));
  };
  return {side(x[0]), side(x[1]), side(x[2])};
}

double largest_axis(const Superquadric& s) {
  return std::max({s.semi_axes[0], s.semi_axes[1], s.semi_axes[2]});
}

double width(const Vector3<double>& box) {
  return std::max({box[0].upper() - box[0].lower(), box[1].upper() - box[1].lower(), box[2].upper() - box[2].lower()});
}

TEST(BisectedEnclosureTest, TheSurfacePassesThroughTheBisectedSegment) {
  RandomCases random(1);
  for (int i = 0; i < 1000; ++i) {
    const Superquadric s = random.solid().superquadric;
    const BisectedEnclosure solid(s);
    const auto [x, normal] = random.boundary_point(s);
    const double error = largest_axis(s) * random.log_uniform(1e-17, 1e-3) * random.uniform(-1, 1);
    const Point p = along(x, normal, error);
    const auto box = solid.surface_point(p, normal);
    ASSERT_TRUE(box) << "case " << i;
    const Interval gauge = solid.bounds().gauge(*box);
    ASSERT_TRUE(gauge.lower() <= 1.0 && gauge.upper() >= 1.0) << "case " << i;
    ASSERT_LE(width(*box), 1.02 * std::fabs(error) + 1e-13 * largest_axis(s)) << "case " << i;
  }
}

TEST(BisectedEnclosureTest, ALineThatMissesTheSolidHasNoSurfacePoint) {
  const BisectedEnclosure ball({{1, 1, 1}, {1, 1}});
  EXPECT_FALSE(ball.surface_point({2, 0, 0}, {0, 1, 0}));
  EXPECT_FALSE(ball.surface_point({1, 0, 0}, {0, 0, 0}));
  EXPECT_TRUE(ball.surface_point({0.999, 0, 0}, {0, 1, 0}));
}

TEST(BisectedEnclosureTest, TheNormalPointsAlongTheGradient) {
  RandomCases random(2);
  for (int i = 0; i < 1000; ++i) {
    const Superquadric s{{random.log_uniform(0.1, 10), random.log_uniform(0.1, 10), random.log_uniform(0.1, 10)},
                         {random.uniform(0.2, 1.9), random.uniform(0.2, 1.9)}};
    const auto [x, expected] = random.boundary_point(s);
    const Vector3<double> normal = BisectedEnclosure(s).normal(exact(x));
    const Point middle{normal[0].lower(), normal[1].lower(), normal[2].lower()};
    const double length = std::hypot(middle[0], middle[1], middle[2]);
    for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(middle[k] / length, expected[k], 1e-10) << "case " << i;
  }
}

/// Members of a box have their gradients in the interval evaluation: what the lower bound rests on.
TEST(BisectedEnclosureTest, TheNormalOfABoxHoldsThoseOfItsPoints) {
  RandomCases random(3);
  for (int i = 0; i < 1000; ++i) {
    const Superquadric s = random.solid().superquadric;
    const BisectedEnclosure solid(s);
    const Point x = random.boundary_point(s).point;
    const double radius = largest_axis(s) * random.log_uniform(1e-9, 0.3);
    const Vector3<double> wide = solid.normal(around(x, radius));
    Point member = x;
    for (double& c : member) c += radius * random.uniform(-1, 1);
    const Vector3<double> thin = solid.normal(exact(member));
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_LE(wide[k].lower(), thin[k].lower()) << "case " << i;
      ASSERT_GE(wide[k].upper(), thin[k].upper()) << "case " << i;
    }
  }
}

TEST(BisectedEnclosureTest, WhereTheSolidHasAnEdgeTheNormalHoldsASubgradient) {
  const auto holds = [](const Vector3<double>& box, const Point& v) {
    const auto in = [](const Interval& side, double c) { return side.lower() <= c && c <= side.upper(); };
    return in(box[0], v[0]) && in(box[1], v[1]) && in(box[2], v[2]);
  };
  const BisectedEnclosure octahedron({{1, 1, 1}, {2, 2}});
  EXPECT_TRUE(holds(octahedron.normal(around({0, 0, 1}, 1e-9)), {0.5, -0.5, 1}));
  const BisectedEnclosure pillow({{1, 1, 1}, {1.5, 0.3}});  // F's formula divides by 0 on the axis
  EXPECT_TRUE(holds(pillow.normal(around({0, 0, 1}, 1e-9)), {0, 0, 1}));
  EXPECT_TRUE(holds(pillow.normal(exact({0, 0, 1})), {0, 0, 1}));
}

TEST(BisectedEnclosureTest, TheSupportPointOfABoxHoldsThoseOfItsDirections) {
  RandomCases random(4);
  for (int i = 0; i < 2000; ++i) {
    const Superquadric s = random.solid().superquadric;
    const Point v = random.direction();
    const double radius = random.choice(2) == 0 ? 0.0 : random.log_uniform(1e-12, 1.0);
    const Vector3<double> box = BisectedEnclosure(s).support_point(around(v, radius));
    Coordinates<long double> member{};
    for (std::size_t k = 0; k < 3; ++k) member[k] = v[k] + radius * random.uniform(-1, 1);
    const Coordinates<long double> x = SuperquadricSet<long double>(s)(member);
    for (std::size_t k = 0; k < 3; ++k) {
      const Interval& side = box[k];
      // The floating-point mapping's own error, large where a huge exponent 2/(2 - e) multiplies it.
      const long double slack = 1e-16L * s.semi_axes[k];
      ASSERT_GE(x[k], side.lower() - slack) << "case " << i << " coordinate " << k;
      ASSERT_LE(x[k], side.upper() + slack) << "case " << i << " coordinate " << k;
    }
  }
}

TEST(PublishedMethodTest, ContainsTheReferenceAndMeetsTheDualityCertificate) {
  RandomCases random(5);
  int outside = 0;
  for (int i = 0; i < 600; ++i) {
    const Primitive solid = random.solid();
    const Point q = random.point(solid).point;
    const oracle::ReferenceDistance reference = oracle::PosedSolid(solid.superquadric, solid.pose).signed_distance(q);
    const Enclosure published = published_distance(solid, q, i % 2 == 0 ? published_accuracy : 0.0);
    ASSERT_LE(published.lo, published.hi);
    ASSERT_GE(published.lo, 0.0);
    if (!(reference.lower > 0)) {
      EXPECT_EQ(published.lo, 0.0) << "case " << i;
      continue;
    }
    ++outside;
    const auto escaped = escape(published, solid, q, reference);
    EXPECT_FALSE(escaped) << *escaped;
    const Enclosure certified = SignedDistance({"", {solid}})(q, 0.0);
    EXPECT_TRUE(published.lo <= certified.hi && certified.lo <= published.hi) << "case " << i;
  }
  EXPECT_GT(outside, 200);
}

TEST(PublishedMethodTest, ContainsTheReferenceOfPairs) {
  RandomCases random(6);
  for (int i = 0; i < 200; ++i) {
    const oracle::RandomPair pair = oracle::random_pair(random);
    const oracle::PairReference reference = reference_distance(oracle::PosedSolid(pair.a.superquadric, pair.a.pose),
                                                               oracle::PosedSolid(pair.b.superquadric, pair.b.pose));
    const Enclosure published = published_distance(pair.a, pair.b, i % 2 == 0 ? published_accuracy : 0.0);
    EXPECT_LE(published.lo, reference.upper) << "case " << i;
    EXPECT_GE(published.hi, reference.lower) << "case " << i;
  }
}

TEST(PublishedMethodTest, IsZeroForAPointInsideAndForOverlappingSolids) {
  const Primitive soap{"soap", {{3.4, 4.3, 1.7}, {0.1, 0.1}}, {{1, 2, 3}, {0.1, 0.2, 0.3, 0.4}}};
  EXPECT_EQ(published_distance(soap, {1, 2, 3}), (Enclosure{0, 0}));
  EXPECT_EQ(published_distance(soap, soap), (Enclosure{0, 0}));
}

TEST(PublishedMethodTest, UnverifiedDistanceIsNearTheEnclosure) {
  const Primitive gem{"gem", {{0.43, 0.6, 1.9}, {1.5, 0.4}}, {{1, 2, 3}, {0.1, 0.2, 0.3, 0.4}}};
  const Primitive capsule{"capsule", {{0.75, 0.75, 1.0}, {1.0, 0.8}}, {}};
  const Point q{4, -3, 2};
  const Enclosure tight = published_distance(gem, q, 0.0);
  EXPECT_NEAR(unverified_distance(gem, q), tight.lo, 1e-5);
  EXPECT_NEAR(unverified_distance(gem, q, 0.0), tight.lo, 1e-12);
  const Enclosure pair = published_distance(gem, capsule, 0.0);
  EXPECT_NEAR(unverified_distance(gem, capsule), pair.hi, 1e-5);
  EXPECT_EQ(unverified_distance(gem, gem.pose.translation), 0.0);
}

struct Widths {
  double median;
  double mean;
};

Widths widths(std::vector<double> all) {
  double sum = 0.0;
  for (const double w : all) sum += w;
  std::ranges::nth_element(all, all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2));
  return {all[all.size() / 2], sum / static_cast<double>(all.size())};
}

/// Points within 10 units, as far as the paper says; its widths are 1e-5 to 3e-4 (Table 6).
TEST(PublishedMethodTest, WidthsOnTheSolidsOfTable5) {
  fmt::print("{:<10}{:>26}{:>26}{:>26}\n", "median, mean", "published, GJK at 1e-6", "published, GJK at 0",
             "certificate");
  for (const auto& [name, superquadric] : oracle::published_solids) {
    const Primitive solid{std::string(name), superquadric, {}};
    const SignedDistance distance({"", {solid}});
    RandomCases random(7);
    std::vector<double> published;
    std::vector<double> tightest;
    std::vector<double> certified;
    while (published.size() < 300) {
      const Point q{random.uniform(-10, 10), random.uniform(-10, 10), random.uniform(-10, 10)};
      if (BisectedEnclosure(superquadric).bounds().gauge(exact(q)).lower() <= 1.0) continue;
      published.push_back(published_distance(solid, q).width());
      tightest.push_back(published_distance(solid, q, 0.0).width());
      certified.push_back(distance(q, 0.0).width());
    }
    const Widths a = widths(published);
    const Widths b = widths(tightest);
    const Widths c = widths(certified);
    fmt::print("{:<10}{:>13.3g}{:>13.3g}{:>13.3g}{:>13.3g}{:>13.3g}{:>13.3g}\n", name, a.median, a.mean, b.median,
               b.mean, c.median, c.mean);
    EXPECT_LT(a.median, 1e-4) << name;
    EXPECT_LT(b.median, 1e-11) << name;
    EXPECT_LT(c.median, b.median) << name;
  }
}

}  // namespace
}  // namespace verisq::verify
