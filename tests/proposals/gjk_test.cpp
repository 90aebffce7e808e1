/// GJK and the support mappings: against proven bounds, other solvers, the oracle, and in every known mode of failure.
#include "verify/proposals/gjk.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/oracle/pair_reference.hpp"
#include "tests/oracle/random_pairs.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/contact.hpp"

namespace verisq::verify {
namespace {

using oracle::RandomCases;
using Vector = Coordinates<double>;
using Solid = SuperquadricSet<double>;

Vector negative(const Vector& v) {
  return {-v[0], -v[1], -v[2]};
}

double norm(const Vector& v) {
  return std::hypot(v[0], v[1], v[2]);
}

double largest_axis(const Superquadric& s) {
  return std::max({s.semi_axes[0], s.semi_axes[1], s.semi_axes[2]});
}

Vector3<double> exact(const Vector& v) {
  return {v[0], v[1], v[2]};
}

/// What is left of binary64, in units of the size, where sets (nearly) touch: the simplices are slivers there.
constexpr double kBesideTheSurface = 1e-8;
constexpr double kNearlyTouchingPair = 1e-5;

GjkResult<double> point_to_solid(const Superquadric& solid, const Vector& q) {
  return gjk<double>(Solid(solid), PointSet<double>{q}, q);
}

/// sin(x), cos(x) to the power e with the sign of the base: the paper's Eq. (6).
double signed_power(double x, double e) {
  return std::copysign(std::pow(std::fabs(x), e), x);
}

/// The support point by the angles of Eqs. (14) and (15), as the paper writes it.
Vector by_angles(const Superquadric& s, const Vector& v) {
  const auto [e1, e2] = s.exponents;
  const double x = s.semi_axes[0] * v[0];
  const double y = s.semi_axes[1] * v[1];
  const double omega = std::atan2(signed_power(y, 1 / (2 - e2)), signed_power(x, 1 / (2 - e2)));
  const double q2 = 2 / (2 - e2);
  const double section = std::pow(std::pow(std::fabs(x), q2) + std::pow(std::fabs(y), q2), 1 / q2);
  const double eta = std::atan2(signed_power(s.semi_axes[2] * v[2], 1 / (2 - e1)), signed_power(section, 1 / (2 - e1)));
  return {s.semi_axes[0] * signed_power(std::cos(eta), e1) * signed_power(std::cos(omega), e2),
          s.semi_axes[1] * signed_power(std::cos(eta), e1) * signed_power(std::sin(omega), e2),
          s.semi_axes[2] * signed_power(std::sin(eta), e1)};
}

TEST(SupportMappingTest, IsThePapersEquationsFiveFourteenFifteen) {
  RandomCases random(1);
  for (int i = 0; i < 2000; ++i) {
    const Superquadric s{{random.log_uniform(0.1, 10), random.log_uniform(0.1, 10), random.log_uniform(0.1, 10)},
                         {random.uniform(0.1, 1.9), random.uniform(0.1, 1.9)}};
    const Vector v = random.direction();
    const Vector expected = by_angles(s, v);
    const Vector found = Solid(s)(v);
    for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(found[k], expected[k], 1e-12 * s.semi_axes[k]) << "case " << i;
  }
}

TEST(SupportMappingTest, LiesInTheSolidAndAttainsTheProvenSupportFunction) {
  RandomCases random(2);
  for (int i = 0; i < 5000; ++i) {
    const Superquadric s = random.solid().superquadric;
    const SuperquadricBounds<double> bounds(s);
    Vector v = random.direction();
    if (i % 5 == 0) v[random.choice(3)] = 0.0;
    if (i % 7 == 0) v[random.choice(3)] *= random.log_uniform(1e-300, 1.0);
    const Vector x = Solid(s)(v);
    ASSERT_LE(bounds.gauge(exact(x)).lower(), 1 + 1e-14) << "case " << i;
    ASSERT_GE(dot(v, x), bounds.support(exact(v)).lower() * (1 - 1e-14)) << "case " << i;
  }
}

TEST(SupportMappingTest, OfTheLargestExponentIsAMaximum) {
  const Superquadric octahedron{{1, 2, 3}, {2, 2}};
  EXPECT_EQ(Solid(octahedron)({1.0, 0.4, 0.3}), (Vector{1, 0, 0}));
  EXPECT_EQ(Solid(octahedron)({0.1, -0.4, 0.2}), (Vector{0, -2, 0}));
  EXPECT_EQ(Solid(octahedron)({0.1, 0.2, -0.4}), (Vector{0, 0, -3}));
  EXPECT_EQ(dot(Solid(octahedron)({2, 1, 0}), {2, 1, 0}), 2) << "any point of the edge";
}

TEST(SupportMappingTest, OfTheSmallestExponentsIsACorner) {
  const Superquadric box{{1, 2, 3}, {1e-300, 1e-300}};
  EXPECT_EQ(Solid(box)({1, -1e-3, 1}), (Vector{1, -2, 3}));
}

TEST(SupportMappingTest, OfNoDirectionIsAPointOfTheSolid) {
  EXPECT_EQ(Solid({{1, 2, 3}, {1, 1}})({0, 0, 0}), (Vector{0, 0, 0}));
}

TEST(SupportMappingTest, PosedIsTheFrameOfTheProofs) {
  RandomCases random(3);
  for (int i = 0; i < 500; ++i) {
    const Primitive solid = random.solid();
    const PosedSuperquadric posed(solid);
    const double size = largest_axis(solid.superquadric);
    const Vector v = random.direction();
    const Vector x = posed_set<double>(solid)(v);
    const Proposal local = midpoint(posed.motion().local_point(x));
    const Proposal u = midpoint(posed.motion().rotation.transpose() * precise(Point{v[0], v[1], v[2]}));
    const auto reached = static_cast<double>(dot<long double>(local, u));
    const double support = posed.bounds().support(precise(u)).upper().to_double(Direction::up);
    ASSERT_NEAR(reached, support, 1e-14 * (size + norm(solid.pose.translation))) << "case " << i;
  }
}

TEST(GjkTest, AgreesWithTheContactSolverOnRandomPoints) {
  RandomCases random(4);
  int tested = 0;
  for (int i = 0; i < 4000; ++i) {
    Primitive solid = random.solid();
    solid.pose = {};
    const Vector q = random.point(solid).point;
    if (SuperquadricBounds<double>(solid.superquadric).gauge(exact(q)).lower() <= 1.0) continue;
    ++tested;
    const Contact contact = fast_contact(solid.superquadric, {q[0], q[1], q[2]});
    const Vector x{static_cast<double>(contact.point[0]), static_cast<double>(contact.point[1]),
                   static_cast<double>(contact.point[2])};
    const double distance = norm(difference(q, x));
    const double size = largest_axis(solid.superquadric) + norm(q);
    const GjkResult<double> found = point_to_solid(solid.superquadric, q);
    const double accuracy = distance > 1e-3 * size ? 1e-12 : kBesideTheSurface;
    ASSERT_NEAR(found.upper, distance, accuracy * size) << "case " << i;
    ASSERT_LE(found.lower, distance + 1e-14 * size) << "case " << i;
    ASSERT_LT(found.steps, 200) << "case " << i;
  }
  EXPECT_GT(tested, 1000);
}

TEST(GjkTest, FindsARandomPairsReferenceDistance) {
  RandomCases random(5);
  for (int i = 0; i < 200; ++i) {
    const oracle::RandomPair pair = oracle::random_pair(random);
    const oracle::PairReference reference = reference_distance(oracle::PosedSolid(pair.a.superquadric, pair.a.pose),
                                                               oracle::PosedSolid(pair.b.superquadric, pair.b.pose));
    const Vector step = difference(pair.b.pose.translation, pair.a.pose.translation);
    const GjkResult<double> found = gjk<double>(posed_set<double>(pair.a), posed_set<double>(pair.b), step);
    const double scale = largest_axis(pair.a.superquadric) + largest_axis(pair.b.superquadric) +
                         norm(pair.a.pose.translation) + norm(pair.b.pose.translation);
    const double distance = found.end == GjkEnd::common ? 0.0 : found.upper;
    ASSERT_GE(distance, reference.lower.convert_to<double>() - 1e-14 * scale) << "case " << i;
    const double accuracy = distance > 1e-3 * scale ? 1e-11 : kNearlyTouchingPair;
    ASSERT_LE(distance, reference.upper.convert_to<double>() + accuracy * scale) << "case " << i;
  }
}

TEST(GjkTest, PointInsideIsACommonPoint) {
  RandomCases random(6);
  for (int i = 0; i < 1000; ++i) {
    const Superquadric s = random.solid().superquadric;
    const double depth = random.uniform(0, 0.99);
    Vector q = Solid(s)(random.direction());
    for (double& c : q) c *= depth;
    const GjkResult<double> found = point_to_solid(s, q);
    ASSERT_EQ(found.end, GjkEnd::common) << "case " << i;
    ASSERT_LE(norm(difference(found.on_a, q)), 1e-13 * largest_axis(s)) << "case " << i;
    ASSERT_LE(SuperquadricBounds<double>(s).gauge(exact(found.on_a)).lower(), 1.0) << "case " << i;
  }
}

TEST(GjkTest, TouchingPointHasNoDistance) {
  RandomCases random(7);
  for (int i = 0; i < 1000; ++i) {
    const Superquadric s = random.solid().superquadric;
    const GjkResult<double> found = point_to_solid(s, Solid(s)(random.direction()));
    ASSERT_LE(found.upper, kBesideTheSurface * largest_axis(s)) << "case " << i;
    ASSERT_LT(found.steps, 200) << "case " << i;
  }
}

TEST(GjkTest, OverlappingSolidsHaveACommonPoint) {
  RandomCases random(8);
  for (int i = 0; i < 500; ++i) {
    const Superquadric a = random.solid().superquadric;
    const Superquadric b = random.solid().superquadric;
    // Centres as far apart as half a radius of each together.
    const Vector v = random.direction();
    const Vector shift = difference(Solid(a)(v), Solid(b)(negative(v)));
    const ApproximateMotion<double> motion({{shift[0] / 2, shift[1] / 2, shift[2] / 2}, {1, 0, 0, 0}});
    const PosedSet<double, Solid> moved(Solid(b), motion);
    const GjkResult<double> found = gjk<double>(Solid(a), moved, shift);
    ASSERT_EQ(found.end, GjkEnd::common) << "case " << i;
    ASSERT_LE(SuperquadricBounds<double>(a).gauge(exact(found.on_a)).lower(), 1.0 + 1e-13) << "case " << i;
    const Vector in_b = motion.inverse_point(found.on_b);
    const double size = largest_axis(a) + largest_axis(b);
    const double moved_by_rounding = 1e-15 * size / *std::ranges::min_element(b.semi_axes);
    ASSERT_LE(SuperquadricBounds<double>(b).gauge(exact(in_b)).lower(), 1.0 + moved_by_rounding) << "case " << i;
    ASSERT_LE(norm(difference(found.on_a, found.on_b)), 1e-13 * size) << "case " << i;
  }
}

TEST(GjkTest, SpheresAreTheirCentresDistanceApart) {
  const Superquadric unit{{1, 1, 1}, {1, 1}};
  RandomCases random(9);
  for (int i = 0; i < 200; ++i) {
    const double gap = random.log_uniform(1e-12, 1e6);
    const Vector u = random.direction();
    const double s = 2 + gap;
    const ApproximateMotion<double> motion({{s * u[0], s * u[1], s * u[2]}, {1, 0, 0, 0}});
    const PosedSet<double, Solid> moved(Solid(unit), motion);
    const GjkResult<double> found = gjk<double>(Solid(unit), moved, u);
    ASSERT_NEAR(found.upper, gap, 1e-14 * (1 + s));
    ASSERT_GT(dot(found.separation, u), 0.999 * norm(found.separation));
  }
}

TEST(GjkTest, ParallelFacesAreAsFarAsTheirPlanes) {
  const Superquadric box{{1, 2, 3}, {1e-3, 1e-3}};
  const ApproximateMotion<double> motion({{2.5, 0.1, -0.2}, {1, 0, 0, 0}});
  const PosedSet<double, Solid> moved(Solid(box), motion);
  const GjkResult<double> found = gjk<double>(Solid(box), moved, {1, 1, 1});
  EXPECT_NEAR(found.upper, 0.5, 1e-13);
  EXPECT_NEAR(found.lower, 0.5, 1e-13);
}

TEST(GjkTest, DegenerateTriangles) {
  const Superquadric ball{{1, 1, 1}, {1, 1}};
  const auto distance = [&](const std::array<Vector, 3>& corners) {
    return gjk<double>(Solid(ball), TriangleSet<double>{corners}, corners[0]);
  };
  EXPECT_NEAR(distance({{{3, 0, 0}, {3, 0, 0}, {3, 0, 0}}}).upper, 2, 1e-15) << "a point";
  EXPECT_NEAR(distance({{{3, -5, 0}, {3, 5, 0}, {3, 5, 0}}}).upper, 2, 1e-15) << "a segment";
  EXPECT_NEAR(distance({{{3, -5, 0}, {3, -1, 0}, {3, 7, 0}}}).upper, 2, 1e-15) << "three corners on a line";
  EXPECT_NEAR(distance({{{3, -5, 0}, {3, 5, 1e-17}, {3, 1, 0}}}).upper, 2, 1e-15) << "nearly on a line";
  EXPECT_NEAR(distance({{{3, -5, -5}, {3, 5, -5}, {3, 0, 9}}}).upper, 2, 1e-15) << "the inside of the face";
  EXPECT_EQ(distance({{{0.9, -5, 0}, {0.9, 5, 0}, {0.9, 0, 5}}}).end, GjkEnd::common) << "through the ball";
  EXPECT_LE(distance({{{1, -5, -5}, {1, 5, -5}, {1, 0, 5}}}).upper, 5 * kBesideTheSurface) << "tangent";
}

TEST(GjkTest, CrossingTrianglesMeet) {
  const TriangleSet<double> a{{{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}}};
  const TriangleSet<double> b{{{{0, 0, -1}, {0, 0, 1}, {0, 5, 0}}}};
  const TriangleSet<double> same = a;
  EXPECT_EQ(gjk<double>(a, b, {1, 0, 0}).end, GjkEnd::common);
  EXPECT_EQ(gjk<double>(a, same, {0, 0, 0}).upper, 0.0);
}

TEST(GjkTest, PointsOfOneLineAndOnePoint) {
  const PointSet<double> a{{1, 2, 3}};
  EXPECT_EQ(gjk<double>(a, a, {1, 0, 0}).end, GjkEnd::common);
  EXPECT_EQ(gjk<double>(a, PointSet<double>{{1, 2, 5}}, {0, 0, 0}).upper, 2.0);
}

/// Every start must lead to the same distance, a wrong one and none included.
TEST(GjkTest, TheStartDoesNotMatter) {
  RandomCases random(10);
  const Superquadric needle{{400, 1, 2}, {1.95, 0.05}};
  const Vector q{100, 30, -3};
  const double distance = point_to_solid(needle, q).upper;
  for (int i = 0; i < 100; ++i) {
    const Vector start = i == 0 ? Vector{} : random.direction();
    EXPECT_NEAR(gjk<double>(Solid(needle), PointSet<double>{q}, start).upper, distance, 1e-12);
  }
}

TEST(GjkTest, HugeDistances) {
  RandomCases random(11);
  const Superquadric s{{0.43, 0.6, 1.9}, {1.5, 0.4}};
  for (int i = 0; i < 200; ++i) {
    const double far = random.log_uniform(1e6, 1e100);
    const Vector u = random.direction();
    const Vector q{far * u[0], far * u[1], far * u[2]};
    const GjkResult<double> found = point_to_solid(s, q);
    ASSERT_LE(found.upper - found.lower, 1e-15 * far);
    ASSERT_LT(found.steps, 50);
  }
}

TEST(GjkTest, StopsAtItsTolerance) {
  const Superquadric s{{0.75, 0.75, 1.0}, {1.0, 0.8}};
  const Vector q{1.0, 0.9, 0.7};
  const auto at = [&](const GjkTolerance<double>& tolerance) {
    return gjk<double>(Solid(s), PointSet<double>{q}, q, tolerance);
  };
  const GjkResult<double> coarse = at({.relative = 1e-2});
  EXPECT_EQ(coarse.end, GjkEnd::converged);
  EXPECT_LE(coarse.upper - coarse.lower, 1e-2 * coarse.upper);
  EXPECT_LT(coarse.steps, at({.absolute = 1e-9}).steps);
  EXPECT_EQ(at({.most_steps = 3}).end, GjkEnd::exhausted);
}

TEST(GjkTest, LongDoubleIsMorePrecise) {
  const Superquadric s{{0.43, 0.6, 1.9}, {1.5, 0.4}};
  const Coordinates<long double> q{1.0L, 0.9L, 0.7L};
  const auto found = gjk<long double>(SuperquadricSet<long double>(s), PointSet<long double>{q}, q);
  EXPECT_LE(found.upper - found.lower, 1e-18L);
}

/// Four points without volume do not hold the origin, whatever the signs of the rounding errors say.
TEST(GjkSimplexTest, FlatTetrahedronIsSearchedFaceByFace) {
  RandomCases random(12);
  for (int i = 0; i < 2000; ++i) {
    const Vector n = random.direction();
    const Vector a = random.direction();
    const double height = random.log_uniform(1e-10, 1.0);
    const Vector u{n[1] * a[2] - n[2] * a[1], n[2] * a[0] - n[0] * a[2], n[0] * a[1] - n[1] * a[0]};
    const Vector w{n[1] * u[2] - n[2] * u[1], n[2] * u[0] - n[0] * u[2], n[0] * u[1] - n[1] * u[0]};
    const double size = random.log_uniform(1e-8, 1.0);
    const auto vertex = [&](double s, double t) {
      const Vector x = along(along(along(Vector{}, n, height), u, size * s), w, size * t);
      return GjkVertex<double>{{}, x, x};
    };
    GjkSimplex<double> simplex(vertex(-1, -1));
    for (const auto& corner : {vertex(1, -1), vertex(1, 1), vertex(-1, 1)}) simplex.add(corner);
    ASSERT_FALSE(simplex.full()) << "case " << i;
    ASSERT_NEAR(norm(simplex.closest().difference), height, 1e-15) << "case " << i;
  }
}

TEST(GjkSimplexTest, TetrahedronHoldsTheOrigin) {
  const auto vertex = [](const Vector& x) { return GjkVertex<double>{{}, x, x}; };
  GjkSimplex<double> simplex(vertex({1, 1, 1}));
  for (const Vector& x : {Vector{-1, -1, 1}, Vector{-1, 1, -1}}) simplex.add(vertex(x));
  EXPECT_FALSE(simplex.full());
  simplex.add(vertex({1, -1, -1}));
  EXPECT_TRUE(simplex.full());
  EXPECT_TRUE(simplex.contains({-1, 1, -1}));
  EXPECT_FALSE(simplex.contains({0, 0, 0}));
}

}  // namespace
}  // namespace verisq::verify
