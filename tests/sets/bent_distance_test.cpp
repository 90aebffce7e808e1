/// The certificate of one bent superquadric: against closed forms, its limit without a bend, and a reference by MPFR.
#include "verify/search/bent_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/solid_reference.hpp"
#include "verify/search/convex_primitive.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

using oracle::RandomCases;

Primitive bent_primitive(const Superquadric& superquadric, const Bend& bend, const Pose& pose = {}) {
  return {"", superquadric, pose, bend};
}

void expect_tight(const Enclosure& found, long double exact, double size = 1.0) {
  EXPECT_LE(found.lo, exact * (1 + 1e-18L) + 1e-18L * size);
  EXPECT_GE(found.hi, exact * (1 - 1e-18L) - 1e-18L * size);
  EXPECT_LE(found.width(), 1e-14 * size) << found.lo << ' ' << found.hi;
}

/// By model.hpp's formula with the direction x of the bend.
Point bent(double k, long double r, long double s, long double z) {
  return {static_cast<double>(1 / k - (1 / k - r) * std::cos(k * z)), static_cast<double>(s),
          static_cast<double>((1 / k - r) * std::sin(k * z))};
}

TEST(BentDistanceTest, AroundTheMiddleOfABentCylinder) {
  // The circle about the middle of the axis keeps its place in the plane Z = 0; e1 makes it the widest there.
  constexpr double radius = 0.25;
  for (const double k : {0.4, -0.9, 1.5, -2.05}) {
    const BentDistance cylinder(bent_primitive({{radius, radius, 1.5}, {0.1, 1.0}}, {k, 0.0}));
    const double outward = k > 0.0 ? -1.0 : 1.0;  // there the middle is nearest; towards the centre, the ends would be
    for (const double apart : {0.2500000001, 0.2500001, 0.26, 0.3, 0.4}) {
      for (const double degrees : {0.0, 40.0, 80.0}) {
        const double angle = degrees * std::numbers::pi / 180;
        const Point x{outward * apart * std::cos(angle), apart * std::sin(angle), 0.0};
        const long double exact = std::hypot(static_cast<long double>(x[0]), static_cast<long double>(x[1])) - radius;
        expect_tight(cylinder(x).distance, exact);
      }
    }
  }
}

/// However bad the candidate: the box is as wide as it is wrong, and holds the closest point.
TEST(BentDistanceTest, CandidatesOffTheClosestPointHaveItInTheirBox) {
  constexpr double radius = 0.25;
  constexpr double apart = 0.375;
  std::size_t proven = 0;
  for (const double k : {0.4, -0.9, 1.5}) {
    const BentDistance tube(bent_primitive({{radius, radius, 1.5}, {1.0, 1.0}}, {k, 0.0}));  // nowhere flat
    const double out = k > 0.0 ? -1.0 : 1.0;
    const Point x{0.6 * out * apart, 0.8 * apart, 0.0};
    for (const double off : {1e-3, 1e-6, 1e-9}) {
      for (const double degrees : {0.0, 30.0, 90.0, 200.0, 270.0}) {
        const double turn = off * std::cos(degrees * std::numbers::pi / 180);
        const long double angle = std::atan2(0.8L, 0.6L * out) + turn;
        const long double z = off * std::sin(degrees * std::numbers::pi / 180);
        const Proposal place{radius * std::cos(angle), radius * std::sin(angle), z};
        const auto found = tube.closest_point(x, {place, {place[0] - x[0], place[1] - x[1], place[2]}});
        if (!found) continue;
        ++proven;
        const Point p{0.6 * out * radius, 0.8 * radius, 0.0};
        for (std::size_t c = 0; c < 3; ++c) {
          EXPECT_LE(found->point[c].lower().to_double(Direction::down), p[c] + 1e-16)
              << k << ' ' << off << ' ' << degrees;
          EXPECT_GE(found->point[c].upper().to_double(Direction::up), p[c] - 1e-16)
              << k << ' ' << off << ' ' << degrees;
          EXPECT_LE(subtract(found->point[c].upper(), found->point[c].lower(), Direction::up).to_double(Direction::up),
                    100 * off);
        }
      }
    }
  }
  EXPECT_GE(proven, 40U);
}

TEST(BentDistanceTest, OnAnEndCap) {
  // The cap is plane: it lies in the half plane of the angle k a3, and all of the solid behind it. The point of its
  // centre is the nearest one to the points before it.
  constexpr double height = 1.0;
  for (const double k : {0.3, -0.3, 0.9, -1.2}) {
    for (const double e1 : {0.01, 1.0, 1.9, 2.0}) {
      const BentDistance solid(bent_primitive({{0.2, 0.3, height}, {e1, 0.5}}, {k, 0.0}));
      const Point cap = bent(k, 0.0L, 0.0L, height);
      for (const double beyond : {1e-12, 1e-9, 1e-6, 0.01, 0.1, 0.3}) {
        const Point x{static_cast<double>(cap[0] + beyond * std::sin(static_cast<long double>(k) * height)), 0.0,
                      static_cast<double>(cap[2] + beyond * std::cos(static_cast<long double>(k) * height))};
        const auto [found, point] = solid(x);
        // But for the rounding of x.
        EXPECT_LE(found.lo, beyond + 2e-16) << k << ' ' << e1;
        EXPECT_GE(found.hi, beyond - 2e-16);
        EXPECT_LE(found.width(), 1e-15) << k << ' ' << e1 << ' ' << beyond;
      }
    }
  }
}

class TaperedBentDistanceTest : public testing::TestWithParam<double> {};

TEST_P(TaperedBentDistanceTest, BendsThatVanish) {
  RandomCases random(1);
  const Superquadric superquadric{{0.4, 0.5, 1.0}, {0.6, 1.2}, GetParam()};
  const Pose pose{{0.1, 0.2, 0.3}, {0.9, 0.1, -0.2, 0.3}};
  const ConvexPrimitive unbent({"", superquadric, pose});
  for (const double k : {0.0, 1e-300, -1e-300, 5e-324, 1e-9, -1e-9, 1e-5, -1e-5}) {
    const BentDistance solid(bent_primitive(superquadric, {k, 25.0}, pose));
    for (int i = 0; i < 20; ++i) {
      const Point x{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
      const Enclosure plain = unbent.signed_distance(x, 0.0).distance;
      if (plain.lo <= 0.0) continue;
      const Enclosure found = solid(x).distance;
      // No point of the solid moves farther than |k| (1 + 0.5)^2; a taper widens 0.5 at most twice.
      const double reach = GetParam() == 1.0 ? 1.5 : 2.0;
      const double moved = reach * reach * std::fabs(k) + 1e-15;
      EXPECT_NEAR(found.lo, plain.lo, moved) << k;
      EXPECT_NEAR(found.hi, plain.hi, moved) << k;
      EXPECT_LE(found.width(), 1e-14) << k;
    }
  }
}

/// By the formulas of model.hpp.
Point surface_point(const Primitive& primitive, RandomCases& random) {
  const Superquadric& solid = primitive.superquadric;
  const Point x = random.boundary_point({solid.semi_axes, solid.exponents}).point;
  const double k = (solid.taper - 1.0) / (solid.taper + 1.0);
  const double z = (x[2] - k * solid.semi_axes[2]) / (1.0 - k * x[2] / solid.semi_axes[2]);
  const double scale = 1.0 + k * z / solid.semi_axes[2];
  return bent(primitive.bend->curvature, scale * x[0], scale * x[1], z);
}

TEST_P(TaperedBentDistanceTest, NoPointOfTheSolidIsNearerThanTheLowerEnd) {
  RandomCases random(5);
  std::size_t tight = 0;
  for (int i = 0; i < 24; ++i) {
    const Superquadric superquadric{{random.uniform(0.1, 0.4), random.uniform(0.1, 0.4), random.uniform(0.5, 1.5)},
                                    {random.uniform(0.2, 1.8), random.uniform(0.2, 1.8)},
                                    GetParam()};
    const Primitive primitive = bent_primitive(superquadric, {random.uniform(-0.9, 0.9), 0.0});
    const BentDistance distance(primitive);
    std::vector<Point> surface(3000);
    std::ranges::generate(surface, [&] { return surface_point(primitive, random); });
    for (int n = 0; n < 20; ++n) {
      const Point x{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-2, 2)};
      double nearest = infinity;
      for (const Point& s : surface) nearest = std::min(nearest, std::hypot(x[0] - s[0], x[1] - s[1], x[2] - s[2]));
      const Enclosure found = distance(x).distance;
      ASSERT_LE(found.lo, nearest + 1e-14);
      ASSERT_GE(found.hi, found.lo);
      if (found.lo > 0.0 && found.width() < 1e-12) ++tight;
    }
  }
  EXPECT_GT(tight, 80U);
}

INSTANTIATE_TEST_SUITE_P(Ratios, TaperedBentDistanceTest, testing::Values(1.0, 0.4, 3.0));

TEST(BentDistanceTest, InsideItIsZero) {
  const BentDistance solid(bent_primitive({{0.4, 0.5, 1.0}, {0.6, 1.2}}, {0.5, 25.0}));
  for (const Point& x : {Point{}, Point{0.0, 0.0, 0.5}, Point{0.3, -0.1, 0.2}}) {
    EXPECT_EQ(solid(x).distance.lo, 0.0);
    EXPECT_LE(solid(x).distance.hi, 1e-9);
  }
}

TEST(BentDistanceTest, SaysNothingWhereTheTangentPlaneCutsTheSquare) {
  const double k = 1.0;
  const BentDistance arch(bent_primitive({{0.2, 0.2, 1.5}, {0.5, 1.0}}, {k, 0.0}));
  const Point centre{1.0 / k, 0.0, 0.0};
  const Point between{1.4, 0.0, 0.0};  // beyond the centre: both ends are as near
  for (const Point& x : {centre, between, Point{1.4, 0.0, 1e-9}, Point{1e6, 0.0, 0.0}, Point{-1e6, 3.0, 2.0}}) {
    EXPECT_EQ(arch(x).distance.lo, 0.0);
    EXPECT_TRUE(std::isfinite(arch(x).distance.hi));
  }
  // Ends that nearly meet: the angle between them and a point beside one of them is nearly a whole turn.
  const BentDistance ring(bent_primitive({{0.2, 0.2, 3.1}, {0.5, 1.0}}, {k, 0.0}));
  for (const Point& x : {Point{2.0, 0.0, 0.0}, Point{2.0, 0.0, 1e-3}, Point{2.3, 0.0, -1e-3}}) {
    EXPECT_EQ(ring(x).distance.lo, 0.0);
  }
}

TEST(BentDistanceTest, NeedsNoConvexity) {
  // Beside a solid that reaches close to its centre of curvature, the squared distance is not convex in all of it. The
  // nearest point is (0.5, 0.3, 0): the sections s = const are all the same but for the rounding by e = 0.1.
  const BentDistance thick(bent_primitive({{0.93, 0.3, 1.0}, {0.1, 0.1}}, {1.0, 0.0}));
  for (const double apart : {0.1, 0.4, 2.0}) {
    const Enclosure found = thick({0.5, 0.3 + apart, 0.0}).distance;
    EXPECT_GE(found.lo, apart);
    EXPECT_LE(found.hi, apart + 1e-6);
    EXPECT_LE(found.width(), 1e-14);
  }
}

TEST(BentDistanceTest, NumbersAtTheEndOfTheRangeDoNotThrow) {
  for (const Superquadric& superquadric :
       {Superquadric{{1.0, 1e-308, 1.0}, {0.5, 0.5}}, Superquadric{{1e-320, 1.0, 1.0}, {2.0, 2.0}},
        Superquadric{{1.0, 1.0, 1e-310}, {1e-300, 1.0}}}) {
    for (const double k : {0.5, 1e-308, -0.5}) {
      const BentDistance solid(bent_primitive(superquadric, {k, 10.0}));
      for (const double c : {0.0, 1e-320, 1.0, 1e200, 1.7e308}) {
        for (const Point& x : {Point{c, -c, c}, Point{-c, 0.0, 0.0}, Point{0.0, 1.0, c}}) {
          const Enclosure found = solid(x).distance;
          EXPECT_LE(found.lo, found.hi);
          EXPECT_GE(found.lo, 0.0);
        }
      }
    }
  }
}

/// Strongly to gently bent, with any exponents and proportions.
Primitive random_bent(RandomCases& random) {
  const auto exponent = [&] {
    return std::array{0.01, 0.3, 1.0, 1.7, 2.0, random.uniform(0.1, 2.0)}[random.choice(6)];
  };
  const Superquadric superquadric{{random.uniform(0.1, 0.6), random.uniform(0.1, 0.6), random.uniform(0.3, 1.5)},
                                  {exponent(), exponent()}};
  const double across = std::hypot(superquadric.semi_axes[0], superquadric.semi_axes[1]);
  const double most = std::min(0.95 / across, 3.1 / superquadric.semi_axes[2]);
  const double k = random.uniform(-1, 1) * most;
  const Pose pose{{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)},
                  {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), 1.0}};
  return bent_primitive(superquadric, {k, random.uniform(-180, 180)}, pose);
}

TEST(BentDistanceTest, HoldsAgainstTheReference) {
  RandomCases random(7);
  std::size_t certain = 0;
  std::size_t outside = 0;
  std::size_t sharp = 0;
  for (int i = 0; i < 60; ++i) {
    const Primitive primitive = random_bent(random);
    const BentDistance solid(primitive);
    const oracle::SolidReference reference({"", {primitive}});
    for (int j = 0; j < 12; ++j) {
      const double reach = random.uniform(0.5, 2.0);
      Point x = primitive.pose.translation;
      for (double& c : x) c += random.uniform(-reach, reach);
      const oracle::SolidFacts facts = reference.facts(x, 300);
      const auto [found, point] = solid(x);
      ASSERT_LE(found.lo, found.hi);
      if (facts.side != oracle::Membership::outside) {
        EXPECT_EQ(found.lo, 0.0);
        continue;
      }
      ++outside;
      EXPECT_TRUE(found.lo <= facts.upper) << i << ' ' << j;
      EXPECT_TRUE(found.hi >= facts.lower) << i << ' ' << j;
      sharp += facts.upper - oracle::Real(found.lo) < 1e-6 ? 1 : 0;
      if (found.lo == 0.0) continue;
      ++certain;
      EXPECT_LE(found.width(), 1e-14 * found.hi + 1e-15) << i << ' ' << j;
      EXPECT_NEAR(std::hypot(point[0] - x[0], point[1] - x[1], point[2] - x[2]), found.hi, 1e-14);
    }
  }
  EXPECT_GT(outside, 400U);
  EXPECT_GT(2 * certain, outside);
  EXPECT_GT(2 * sharp, outside) << "the reference would hardly notice an escape";
}

/// Bounds are proven from any candidate: deep inside K, beside it, far off; towards its image or past it.
TEST(BentDistanceTest, HoldsForAnyCandidate) {
  RandomCases random(9);
  std::size_t bounds = 0;
  for (int i = 0; i < 400; ++i) {
    const Primitive primitive = random_bent(random);
    const auto& a = primitive.superquadric.semi_axes;
    const BentDistance solid(primitive);
    const BendMap<Real> map(*primitive.bend);
    const RigidMotion motion(primitive.pose);
    Point x = primitive.pose.translation;
    for (double& c : x) c += random.uniform(-1.5, 1.5);
    const Enclosure best = solid(x).distance;
    for (int j = 0; j < 40; ++j) {
      const double scale = std::array{0.3, 1.0, 3.0}[random.choice(3)];
      const Proposal point{scale * a[0] * random.uniform(-1, 1), scale * a[1] * random.uniform(-1, 1),
                           scale * a[2] * random.uniform(-1, 1)};
      Proposal direction = midpoint(PreciseVector(map.bent(precise(point)) - motion.local_point(x)));
      if (random.choice(2) == 0) {
        for (long double& c : direction) c += random.uniform(-0.3, 0.3);
      }
      const Enclosure found = solid.proven(x, {point, direction}).distance;
      EXPECT_LE(found.lo, best.hi) << i << ' ' << j;
      EXPECT_GE(found.hi, best.lo) << i << ' ' << j;
      bounds += found.lo > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(bounds, 500U);
}

TEST(BentDistanceTest, NothingIsProvenByNonsense) {
  const BentDistance solid(bent_primitive({{0.4, 0.5, 1.0}, {0.6, 1.2}}, {0.5, 25.0}));
  const long double nan = std::numeric_limits<long double>::quiet_NaN();
  const Point x{0.8, 0.9, 0.7};
  const double exact = solid(x).distance.hi;
  for (const Proposal& v :
       {Proposal{}, Proposal{nan, 1, 1}, Proposal{infinity, 0, 0}, Proposal{1e4000L, -1e4000L, 1}}) {
    const Enclosure found = solid.proven(x, {v, v}).distance;
    EXPECT_EQ(found.lo, 0.0);
    EXPECT_GE(found.hi, exact);
    EXPECT_LT(found.hi, 4.0);
  }
}

TEST(BentDistanceTest, SpheresBoundIt) {
  RandomCases random(8);
  for (int i = 0; i < 50; ++i) {
    const Primitive primitive = random_bent(random);
    const BentDistance solid(primitive);
    const Point x{random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-4, 4)};
    EXPECT_LE(solid.lower_by_sphere(x), solid(x).distance.hi);
    EXPECT_GT(solid.lower_by_sphere({1e3, 0.0, 0.0}), 9e2);
    EXPECT_LT(solid(x).distance.hi, infinity);
  }
}

}  // namespace
}  // namespace verisq::verify
