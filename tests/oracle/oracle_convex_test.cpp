/// The references for triangles and pairs of solids against closed forms, against the reference for points and against
/// identities of the mathematics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/oracle/containment.hpp"
#include "tests/oracle/pair_reference.hpp"
#include "tests/oracle/random_pairs.hpp"
#include "tests/oracle/random_triangles.hpp"
#include "tests/oracle/triangle_reference.hpp"

namespace verisq::oracle {
namespace {

/// Gaps and errors, in units of the largest semi-axis.
const Real tiny = 1e-25;

[[nodiscard]] PosedSolid posed(const Primitive& primitive) {
  return {primitive.superquadric, primitive.pose};
}

[[nodiscard]] Superquadric sphere(double radius) {
  return {{radius, radius, radius}, {1.0, 1.0}};
}

template <class Reference>
void expect_distance(const Reference& found, const Real& expected, const Real& size) {
  EXPECT_LE(found.lower, found.upper);
  EXPECT_LE(abs(found.lower - expected), tiny * size) << text(found.lower) << " is not " << text(expected);
  EXPECT_LE(abs(found.upper - expected), tiny * size) << text(found.upper) << " is not " << text(expected);
}

/// Distance of the origin to a segment, at 200 bits.
[[nodiscard]] Real distance_to_segment(const Vector& from, const Vector& to) {
  const Vector edge = difference(to, from);
  const Real squared = dot(edge, edge);
  const Real along = squared == 0 ? Real(0) : Real(-dot(from, edge) / squared);
  const Real clamped = std::clamp<Real>(along, Real(0), Real(1));
  return length(difference(from, scaled<Real>(edge, -clamped)));
}

/// Distance of a point to a triangle by its features.
[[nodiscard]] Real distance_to_triangle(const Point& point, const Triangle& triangle) {
  std::array<Vector, 3> t;
  for (std::size_t i = 0; i < 3; ++i) t[i] = difference(widened(triangle[i]), widened(point));
  Real best =
      std::min({distance_to_segment(t[0], t[1]), distance_to_segment(t[1], t[2]), distance_to_segment(t[2], t[0])});
  const Vector e = difference(t[1], t[0]);
  const Vector f = difference(t[2], t[0]);
  const Real determinant = dot(e, e) * dot(f, f) - dot(e, f) * dot(e, f);
  if (determinant <= 0) return best;
  const Real u = (dot(e, f) * dot(t[0], f) - dot(f, f) * dot(t[0], e)) / determinant;
  const Real v = (dot(e, f) * dot(t[0], e) - dot(e, e) * dot(t[0], f)) / determinant;
  if (u < 0 || v < 0 || u + v > 1) return best;
  Vector foot;
  for (std::size_t k = 0; k < 3; ++k) foot[k] = t[0][k] + u * e[k] + v * f[k];
  return std::min<Real>(best, length(foot));
}

TEST(TriangleReferenceTest, SphereIsTheDistanceToTheCentreLessTheRadius) {
  RandomCases random(1);
  for (int i = 0; i < 200; ++i) {
    const double radius = random.log_uniform(1e-3, 1e3);
    Primitive ball = random.solid();
    ball.superquadric = sphere(radius);
    const RandomTriangle query = random_triangle(random, ball);
    const Real expected = distance_to_triangle(ball.pose.translation, query.triangle) - radius;
    const TriangleReference found = reference_distance(posed(ball), query.triangle);
    expect_distance(found, std::max<Real>(expected, Real(0)), Real(radius));
    if (expected < -1e-20 * radius) {
      EXPECT_TRUE(found.common.has_value());
    }
    if (expected > 0) {
      EXPECT_FALSE(found.common.has_value());
    }
  }
}

TEST(TriangleReferenceTest, PointTriangleIsThePointDistance) {
  RandomCases random(2);
  int wide = 0;
  for (int i = 0; i < 300; ++i) {
    const Primitive primitive = random.solid();
    const PosedSolid solid = posed(primitive);
    const Point point = random.point(primitive).point;
    const ReferenceDistance expected = solid.signed_distance(point);
    const TriangleReference found = reference_distance(solid, Triangle{point, point, point});
    EXPECT_LE(found.lower, std::max<Real>(expected.upper, Real(0)));
    EXPECT_GE(found.upper, std::max<Real>(expected.lower, Real(0)));
    if (found.upper - found.lower > tiny * solid.magnitude(point)) ++wide;
  }
  EXPECT_LE(wide, 1);
}

TEST(TriangleReferenceTest, OctahedronWithParallelFacesEdgesAndTips) {
  const PosedSolid solid({{1.0, 1.0, 1.0}, {2.0, 2.0}}, {});
  // In the plane x + y + z = 3, above the whole face and overlapping part of it only.
  expect_distance(reference_distance(solid, {Point{9.0, -3.0, -3.0}, {-3.0, 9.0, -3.0}, {-3.0, -3.0, 9.0}}),
                  Real(2) / sqrt(Real(3)), Real(1));
  expect_distance(reference_distance(solid, {Point{1.0, 1.0, 1.0}, {3.0, 0.0, 0.0}, {3.0, 1.0, -1.0}}),
                  Real(2) / sqrt(Real(3)), Real(1));
  // An edge parallel to one of the octahedron's, and a plane over its tip.
  expect_distance(reference_distance(solid, {Point{2.0, 0.0, 0.0}, {0.0, 2.0, 0.0}, {2.0, 2.0, 5.0}}), sqrt(Real(0.5)),
                  Real(1));
  expect_distance(reference_distance(solid, {Point{-1.0, -1.0, 1.5}, {3.0, 0.0, 1.5}, {0.0, 3.0, 1.5}}), Real(0.5),
                  Real(1));
  EXPECT_TRUE(reference_distance(solid, {Point{-9.0, -9.0, 0.875}, {9.0, 0.0, 0.875}, {0.0, 9.0, 0.875}}).common);
}

TEST(TriangleReferenceTest, SmallExponentsApproachTheBox) {
  const PosedSolid solid({{1.0, 2.0, 3.0}, {0.05, 0.05}}, {});
  expect_distance(reference_distance(solid, {Point{1.5, 0.0, 0.0}, {1.5, 1.0, 0.0}, {1.5, 0.0, -1.0}}), Real(0.5),
                  Real(3));
  expect_distance(reference_distance(solid, {Point{-4.0, -4.0, 5.0}, {4.0, -4.0, 5.0}, {0.0, 8.0, 5.0}}), Real(2),
                  Real(3));
  // Beside the edge of the box: the solid lies in the box and contains its copy shrunk by 3^(1/40).
  const TriangleReference beside = reference_distance(solid, {Point{2.0, 3.0, -9.0}, {2.0, 3.0, 9.0}, {8.0, 9.0, 0.0}});
  EXPECT_GT(beside.lower, sqrt(Real(2)));
  EXPECT_LT(beside.upper, sqrt(Real(2)) + (1 - pow(Real(3), Real(-1) / 40)) * sqrt(Real(5)));
}

TEST(TriangleReferenceTest, ClosesOnRandomCases) {
  int wide = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    RandomCases random(seed);
    const Primitive primitive = random.solid();
    const PosedSolid solid = posed(primitive);
    const RandomTriangle query = random_triangle(random, primitive);
    const TriangleReference found = reference_distance(solid, query.triangle);
    EXPECT_LE(found.lower, found.upper);
    EXPECT_GE(found.lower, 0);
    if (found.upper - found.lower > tiny * solid.largest_semi_axis()) ++wide;
  }
  EXPECT_LE(wide, 1);
}

TEST(PairReferenceTest, SpheresAreTheDistanceOfTheCentresLessTheRadii) {
  RandomCases random(3);
  for (int i = 0; i < 200; ++i) {
    const Superquadric a = sphere(random.log_uniform(1e-3, 1e3));
    const Superquadric b = sphere(a.semi_axes[0] * random.log_uniform(0.1, 10));
    const RandomPair pair = random_pair(random, a, b);
    const PairReference found = reference_distance(posed(pair.a), posed(pair.b));
    const Real centres = length(difference(widened(pair.b.pose.translation), widened(pair.a.pose.translation)));
    const Real expected = centres - a.semi_axes[0] - b.semi_axes[0];
    const Real size = std::max(a.semi_axes[0], b.semi_axes[0]);
    expect_distance(found, std::max<Real>(expected, Real(0)), size);
    if (expected < -1e-20 * size) {
      EXPECT_TRUE(found.common.has_value());
    }
    if (expected > 0) {
      EXPECT_FALSE(found.common.has_value());
    }
  }
}

/// The distance to a ball is that to its centre less the radius; the closest point of the solid is the same.
TEST(PairReferenceTest, BallBesideASolidIsThePointDistanceLessTheRadius) {
  RandomCases random(4);
  int wide = 0;
  for (int i = 0; i < 200; ++i) {
    const Superquadric a = random.solid().superquadric;
    const double size = *std::max_element(a.semi_axes.begin(), a.semi_axes.end());
    const double radius = size * random.log_uniform(0.1, 10);
    const RandomPair pair = random_pair(random, a, sphere(radius));
    const PosedSolid solid = posed(pair.a);
    const ReferenceDistance centre = solid.signed_distance(pair.b.pose.translation);
    const PairReference found = reference_distance(solid, posed(pair.b));
    EXPECT_LE(found.lower, std::max<Real>(centre.upper - radius, Real(0)));
    EXPECT_GE(found.upper, std::max<Real>(centre.lower - radius, Real(0)));
    if (found.upper - found.lower > tiny * std::max(size, radius)) ++wide;
  }
  EXPECT_LE(wide, 1);
}

TEST(PairReferenceTest, OctahedraAndBoxes) {
  const Superquadric octahedron{{1.0, 1.0, 1.0}, {2.0, 2.0}};
  const PosedSolid a(octahedron, {});
  const auto beside_at = [](const Superquadric& s, const Point& translation) {
    return PosedSolid(s, {translation, {1.0, 0.0, 0.0, 0.0}});
  };
  // Parallel faces x + y + z = 1 and 6 - 1; tip against tip; overlapping.
  expect_distance(reference_distance(a, beside_at(octahedron, {2.0, 2.0, 2.0})), Real(4) / sqrt(Real(3)), Real(1));
  expect_distance(reference_distance(a, beside_at(octahedron, {0.0, 0.0, 5.0})), Real(3), Real(1));
  EXPECT_TRUE(reference_distance(a, beside_at(octahedron, {0.5, 0.5, 0.875})).common);
  // Boxes in the limit, faces parallel: the middles of the faces are flat to 40th order.
  const Superquadric box{{1.0, 2.0, 3.0}, {0.05, 0.05}};
  expect_distance(reference_distance(PosedSolid(box, {}), beside_at(box, {2.5, 0.0, 0.0})), Real(0.5), Real(3));
  const PairReference shifted = reference_distance(PosedSolid(box, {}), beside_at(box, {2.5, 1.0, 1.0}));
  EXPECT_GE(shifted.upper, 0.5);
  EXPECT_LT(shifted.lower, 0.5 + 1e-9);
}

TEST(PairReferenceTest, ClosestPointsOfEllipsoidsOnTheirAxes) {
  const PosedSolid a({{0.5, 2.0, 8.0}, {1.0, 1.0}}, {});
  const PosedSolid b({{1.0, 2.0, 3.0}, {1.0, 1.0}}, {{4.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}});
  const PairReference found = reference_distance(a, b);
  expect_distance(found, Real(2.5), Real(8));
  EXPECT_LE(length(difference(found.on_a, widened({0.5, 0.0, 0.0}))), found.reach.value());
  EXPECT_LE(length(difference(found.on_b, widened({3.0, 0.0, 0.0}))), found.reach.value());
  EXPECT_LT(found.reach.value(), 1e-20);
}

TEST(PairReferenceTest, ReachCoversTheErrorOfTheClosestPoints) {
  RandomCases random(5);
  int settled = 0;
  for (int i = 0; i < 100; ++i) {
    const RandomPair pair = random_pair(random);
    const PosedSolid a = posed(pair.a);
    const PosedSolid b = posed(pair.b);
    const PairReference forth = reference_distance(a, b);
    const PairReference back = reference_distance(b, a);
    if (!forth.reach || !back.reach || forth.common || forth.lower <= 0) continue;
    ++settled;
    // Another path to the same optimum, which for non-unique closest points ends in the same analytic centre.
    const Real allowed = *forth.reach + *back.reach;
    EXPECT_LE(length(difference(forth.on_a, back.on_b)), allowed) << i;
    EXPECT_LE(length(difference(forth.on_b, back.on_a)), allowed) << i;
  }
  EXPECT_GT(settled, 20);
}

TEST(PairReferenceTest, AFurtherMotionIsThatOfTheWhole) {
  RandomCases random(6);
  for (int i = 0; i < 50; ++i) {
    const RandomPair pair = random_pair(random);
    const Primitive other = random.solid();
    const PosedSolid a = posed(pair.a);
    const PosedSolid b = posed(pair.b);
    const PairReference still = reference_distance(a, b);
    const PairReference moved = reference_distance(a.moved(other.pose), b.moved(other.pose));
    const Real size = length(a.moved(other.pose).centre()) + a.largest_semi_axis() + b.largest_semi_axis();
    EXPECT_LE(moved.lower, still.upper + tiny * size);
    EXPECT_GE(moved.upper, still.lower - tiny * size);
    // A quarter turn after a pose is a pose of binary64.
    const Pose quarter{{1.0, -2.0, 3.0}, {1.0, 0.0, 0.0, 1.0}};
    const Point point = random.point(pair.a).point;
    const Point turned{1.0 - point[1], -2.0 + point[0], 3.0 + point[2]};
    const Vector expected = a.to_own_frame(widened(point));
    const Vector found = a.moved(quarter).to_own_frame(widened(turned));
    EXPECT_LE(length(difference(expected, found)), 1e-15 * (length(widened(turned)) + 4)) << i;
  }
}

TEST(PairReferenceTest, ClosesOnRandomCases) {
  int wide = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    RandomCases random(seed);
    const RandomPair pair = random_pair(random);
    const PosedSolid a = posed(pair.a);
    const PosedSolid b = posed(pair.b);
    const PairReference found = reference_distance(a, b);
    EXPECT_LE(found.lower, found.upper);
    EXPECT_GE(found.lower, 0);
    if (found.upper - found.lower > tiny * std::max(a.largest_semi_axis(), b.largest_semi_axis())) ++wide;
    // Opened by construction by no less than 1e-9 sizes, or closed by as much.
    if (pair.family == PairFamily::far) {
      EXPECT_FALSE(found.common.has_value());
    }
  }
  EXPECT_LE(wide, 1);
}

TEST(ConvexContainmentTest, ReportsEveryKindOfEscape) {
  const Primitive ball{"ball", sphere(1.0), {}};
  Primitive other = ball;
  other.pose.translation = {4.0, 0.0, 0.0};
  const PairReference pair = reference_distance(posed(ball), posed(other));
  const Triangle triangle{Point{3.0, -1.0, -1.0}, {3.0, 1.0, -1.0}, {3.0, 0.0, 2.0}};
  const TriangleReference facing = reference_distance(posed(ball), triangle);
  const auto escapes = [&](const Enclosure& enclosure) {
    const bool first = escape(enclosure, ball, other, pair).has_value();
    EXPECT_EQ(first, escape(enclosure, ball, triangle, facing).has_value());
    return first;
  };
  EXPECT_FALSE(escapes({2.0, 2.0}));
  EXPECT_FALSE(escapes({0.0, 9.0}));
  EXPECT_TRUE(escapes({std::nextafter(2.0, 3.0), 3.0}));
  EXPECT_TRUE(escapes({1.0, std::nextafter(2.0, 1.0)}));
  EXPECT_TRUE(escapes({3.0, 1.0}));
  EXPECT_TRUE(escapes({std::nan(""), 3.0}));
}

}  // namespace
}  // namespace verisq::oracle
