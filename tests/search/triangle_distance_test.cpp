/// Triangles against posed superquadrics: closed forms, every kind of contact, certificates and their falsification.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>
#include <verisq/checker.hpp>

#include "tests/fixtures/forged_numbers.hpp"
#include "tests/oracle/random_cases.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

using oracle::moved;

using oracle::RandomCases;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

const Pose kTilted{{0.1, 0.2, 0.3}, {1.0, 2.0, 3.0, 4.0}};
const Primitive kCapsule{"capsule", {{0.75, 0.75, 1.0}, {1.0, 0.8}}, kTilted};
const Primitive kGem{"gem", {{0.43, 0.6, 1.9}, {1.5, 0.4}}, kTilted};
const Primitive kSoap{"soap", {{3.4, 4.3, 1.7}, {0.1, 0.1}}, kTilted};
const Primitive kBall{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}};
const Primitive kOctahedron{"octahedron", {{1.0, 1.0, 1.0}, {2.0, 2.0}}, {}};

Model model_of(const std::vector<Primitive>& primitives) {
  return {"", primitives};
}

double size_of(const Model& model) {
  double size = 0.0;
  for (const Primitive& primitive : model.primitives)
    size = std::max(size, std::ranges::max(primitive.superquadric.semi_axes));
  return size;
}

/// The largest length that a rounding error is relative to.
double reach_of(const Model& model, const Triangle& triangle) {
  double reach = size_of(model);
  for (const Point& corner : triangle)
    for (const double c : corner) reach = std::max(reach, std::abs(c));
  return reach;
}

std::string describe(const Model& model, const Triangle& triangle, const Enclosure& e) {
  const auto& [name, superquadric, pose, bend, mesh] = model.primitives.front();
  return fmt::format("{} axes {} e {} at {} {}, triangle {}: [{}, {}]", name, superquadric.semi_axes,
                     superquadric.exponents, pose.translation, pose.quaternion, triangle, e.lo, e.hi);
}

/// Neither of two enclosures of the same number excludes the other.
bool agree(const Enclosure& a, const Enclosure& b) {
  return a.lo <= b.hi && b.lo <= a.hi;
}

/// Corners within `extent` of the same random place, which is within `distance` of the centre.
Triangle random_triangle(RandomCases& random, const Point& centre, double distance, double extent) {
  Point place = centre;
  for (double& c : place) c += distance * random.uniform(-1, 1);
  Triangle triangle;
  for (Point& corner : triangle)
    for (std::size_t k = 0; k < 3; ++k) corner[k] = place[k] + extent * random.uniform(-1, 1);
  return triangle;
}

/// Degenerate and not, near the solid and far, tiny and huge.
Triangle hard_triangle(RandomCases& random, const Primitive& solid) {
  const double extent = std::ranges::max(solid.superquadric.semi_axes) * random.log_uniform(1e-6, 1e3);
  Triangle t = random_triangle(random, random.point(solid).point, 0.0, extent);
  const std::size_t kind = random.choice(6);
  const std::size_t axis = random.choice(3);
  for (std::size_t k = 0; k < 3; ++k) {
    if (kind == 0) t[2][k] = t[1][k] + 1e-9 * extent * random.uniform(-1, 1);
    if (kind == 1) t[2][k] = t[1][k];
    if (kind == 2) t[2][k] = 0.5 * (t[0][k] + t[1][k]);
  }
  if (kind == 3) t[1][axis] = t[2][axis] = t[0][axis];
  if (kind == 4)
    for (Point& corner : t) corner = random.point(solid).point;
  return t;
}

// Closed forms.

struct KnownCase {
  std::string name;
  Primitive solid;
  Triangle triangle;
  long double distance;
};

class KnownDistanceTest : public testing::TestWithParam<KnownCase> {};

TEST_P(KnownDistanceTest, IsEnclosedTightly) {
  const auto& [name, solid, triangle, distance] = GetParam();
  const Model model = model_of({solid});
  const Enclosure e = TriangleDistance(model)(triangle);
  EXPECT_LE(e.lo, distance);
  EXPECT_GE(e.hi, distance);
  EXPECT_LE(e.width(), 1e-14L * (size_of(model) + distance)) << describe(model, triangle, e);
  if (distance == 0.0L) {
    EXPECT_EQ(e, (Enclosure{0.0, 0.0}));
  }
}

const Primitive kBox{"box", {{1.0, 2.0, 3.0}, {0.05, 0.05}}, {}};
const Primitive kNeedle{"needle", {{0.01, 0.02, 4.0}, {0.05, 2.0}}, {}};
const Primitive kCone{"double cone", {{1.0, 1.0, 1.0}, {2.0, 1.0}}, {}};
constexpr double kUlp = 0x1p-52;

INSTANTIATE_TEST_SUITE_P(
    Cases, KnownDistanceTest,
    testing::Values(
        KnownCase{"Face", kBall, {{{-1, -1, 3}, {2, -1, 3}, {-1, 2, 3}}}, 2.0L},
        KnownCase{"Edge", kBall, {{{-1, 0, 3}, {2, 0, 3}, {0, 0, 9}}}, 2.0L},
        KnownCase{"SlantedEdge", kBall, {{{2, 0, 0}, {0, 2, 0}, {9, 9, 1}}}, std::sqrt(2.0L) - 1.0L},
        KnownCase{"Vertex", kBall, {{{2, 0, 0}, {3, 1, 0}, {3, 0, 1}}}, 1.0L},
        KnownCase{"SharpVertex", kOctahedron, {{{-3, -3, 2}, {3, -3, 2}, {0, 5, 2}}}, 1.0L},
        KnownCase{"ParallelFacet", kOctahedron, {{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}}, 1.0L / std::sqrt(3.0L)},
        // Both in planes parallel to the facet; the second overhangs it, no corner and no edge near the middle.
        KnownCase{"SmallOverParallelFacet",
                  kOctahedron,
                  {{{0.75, 0.625, 0.625}, {0.625, 0.75, 0.625}, {0.625, 0.625, 0.75}}},
                  1.0L / std::sqrt(3.0L)},
        KnownCase{
            "LargeOverParallelFacet", kOctahedron, {{{9, 0, -7}, {-7, 9, 0}, {0, -7, 9}}}, 1.0L / std::sqrt(3.0L)},
        KnownCase{"CornerOverParallelFacet",
                  kOctahedron,
                  {{{0.75, 0.625, 0.625}, {3, 3, -4}, {3, 4, -5}}},
                  1.0L / std::sqrt(3.0L)},
        KnownCase{"EdgeOverParallelFacet",
                  kOctahedron,
                  {{{4, 0.625, -2.625}, {9, 9, -16}, {-2.75, 0.625, 4.125}}},
                  1.0L / std::sqrt(3.0L)},
        KnownCase{"ParallelEdge", kOctahedron, {{{2, 0, 0}, {0, 2, 0}, {4, 4, 0}}}, std::sqrt(0.5L)},
        KnownCase{"PlaneThroughVertex", kOctahedron, {{{0, 0, 1.5}, {1, 0, 2}, {0, 1, 2}}}, 0.5L},
        KnownCase{"ConeApex", kCone, {{{-1, -1, 3}, {2, -1, 3}, {-1, 2, 3}}}, 2.0L},
        KnownCase{"AboveBox", kBox, {{{-0.5, -0.25, 4}, {0.5, -0.5, 4}, {0, 1, 4}}}, 1.0L},
        KnownCase{"LargeAboveBox", kBox, {{{-100, -100, 4}, {100, -100, 4}, {0, 100, 4}}}, 1.0L},
        KnownCase{"BesideBox", kBox, {{{3, 1, -1}, {3, -1, 1}, {4, 0, 0}}}, 2.0L},
        KnownCase{"AboveNeedle", kNeedle, {{{-1, -1, 5}, {1, -1, 5}, {0, 1, 5}}}, 1.0L},
        KnownCase{"AlmostTouching", kBall, {{{-1, -1, 1 + kUlp}, {2, -1, 1 + kUlp}, {-1, 2, 1 + kUlp}}}, kUlp},
        KnownCase{"BarelyCutFace", kBall, {{{-1, -1, 1 - kUlp}, {2, -1, 1 - kUlp}, {-1, 2, 1 - kUlp}}}, 0.0L},
        KnownCase{"BarelyCutEdge", kBall, {{{-1, 0, 1 - kUlp}, {2, 0, 1 - kUlp}, {0, 0, 9}}}, 0.0L},
        KnownCase{"Piercing", kBall, {{{-1, -1, 0.5}, {2, -1, 0.5}, {-1, 2, 0.5}}}, 0.0L},
        KnownCase{"PlaneThroughCentre", kBall, {{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}}, 0.0L},
        KnownCase{"EdgeThrough", kBox, {{{-9, 0, 0}, {9, 0, 0}, {0, 9, 9}}}, 0.0L},
        KnownCase{"VertexInside", kBox, {{{0.5, 0, 0}, {9, 0, 1}, {9, 9, 9}}}, 0.0L},
        KnownCase{"Contained", kBox, {{{0.5, 0, 0}, {0, 1, 1}, {-0.5, -1, 2}}}, 0.0L},
        KnownCase{"ContainedAtCentre", kBox, {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}}, 0.0L},
        KnownCase{"Spike", kNeedle, {{{-9, -9, 3}, {9, -9, 3}, {0, 9, 3}}}, 0.0L},
        KnownCase{"PlaneCutsTriangleDoesNot", kBall, {{{2, 0, 0}, {2, 1, 0.5}, {3, 0, 0}}}, 1.0L},
        KnownCase{"Point", kBall, {{{0, 3, 0}, {0, 3, 0}, {0, 3, 0}}}, 2.0L},
        KnownCase{"Segment", kBall, {{{-1, 3, 0}, {5, 3, 0}, {5, 3, 0}}}, 2.0L},
        KnownCase{"SegmentOfThree", kBall, {{{5, 3, 0}, {-1, 3, 0}, {2, 3, 0}}}, 2.0L},
        KnownCase{"Huge", kBall, {{{-1e6, -1e6, 3}, {2e6, -1e6, 3}, {-1e6, 2e6, 3}}}, 2.0L},
        KnownCase{"Tiny", kBall, {{{0, 0, 3}, {1e-300, 0, 3}, {0, 1e-300, 3}}}, 2.0L}),
    [](const auto& test) { return test.param.name; });

/// The distance of a triangle from the origin: the least over its face, where the foot lies in it, and its edges. In
/// long double from the textbook formulas, not those of verify/.
long double distance_from_origin(const Triangle& t) {
  using Vector = std::array<long double, 3>;
  const auto dot = [](const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const auto cross = [](const Vector& a, const Vector& b) {
    return Vector{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  std::array<Vector, 3> corner;
  for (std::size_t i = 0; i < 3; ++i) corner[i] = {t[i][0], t[i][1], t[i][2]};
  const auto edge = [&](std::size_t i) {
    const Vector& a = corner[i];
    const Vector& b = corner[(i + 1) % 3];
    return Vector{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  };
  const Vector normal = cross(edge(0), edge(1));
  long double least = std::numeric_limits<long double>::infinity();
  bool foot_inside = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const long double s = std::clamp(-dot(corner[i], edge(i)) / dot(edge(i), edge(i)), 0.0L, 1.0L);
    const Vector e = edge(i);
    least = std::min(least, std::hypot(corner[i][0] + s * e[0], corner[i][1] + s * e[1], corner[i][2] + s * e[2]));
    foot_inside = foot_inside && dot(cross(corner[i], e), normal) >= 0.0L;
  }
  return foot_inside ? std::abs(dot(normal, corner[0])) / std::sqrt(dot(normal, normal)) : least;
}

TEST(TriangleDistanceTest, OfABallIsThatOfItsCentreLessTheRadius) {
  RandomCases random(1);
  std::size_t apart = 0;
  for (int i = 0; i < 3000; ++i) {
    const double radius = random.log_uniform(0.01, 2.0);
    const Model model = model_of({{"ball", {{radius, radius, radius}, {1.0, 1.0}}, {{}, {1.0, 2.0, -3.0, 0.5}}}});
    const Triangle triangle = random_triangle(random, {}, 2.0, random.log_uniform(0.01, 5.0));
    const long double exact = std::max(0.0L, distance_from_origin(triangle) - radius);
    const Enclosure e = TriangleDistance(model)(triangle);
    const double reach = reach_of(model, triangle);
    EXPECT_LE(e.lo, exact + 1e-17L * reach) << describe(model, triangle, e);
    EXPECT_GE(e.hi, exact - 1e-17L * reach) << describe(model, triangle, e);
    EXPECT_LE(e.width(), 2e-15 * reach) << describe(model, triangle, e);
    apart += exact > 0.0L ? 1 : 0;
  }
  EXPECT_GT(apart, 1000U);
  EXPECT_LT(apart, 2900U);
}

/// Whether a triangle that touches meets the solid depends on rounding; that it is near does not.
TEST(TriangleDistanceTest, TouchingIsNearZero) {
  const TriangleDistance distance(model_of({kBall}));
  for (const Triangle& t :
       {Triangle{{{-1, -1, 1}, {2, -1, 1}, {-1, 2, 1}}}, Triangle{{{-1, 0, 1}, {2, 0, 1}, {0, 0, 9}}},
        Triangle{{{1, 0, 0}, {3, 1, 0}, {3, 0, 1}}}, Triangle{{{0.6, 0.8, 0}, {2, 2, 0}, {2, 2, 1}}},
        Triangle{{{1, 1, 1}, {1, -1, -1}, {1, -1, 1}}}}) {
    const Enclosure e = distance(t);
    EXPECT_LE(e.lo, 1e-16) << describe(model_of({kBall}), t, e);  // 0.6 and 0.8 are rounded
    EXPECT_LE(e.hi, 1e-16) << describe(model_of({kBall}), t, e);
  }
}

// Against points: a triangle is no farther than any of its points, and hardly nearer than the nearest of many.

TEST(TriangleDistanceTest, AgreesWithDenseSamples) {
  constexpr int steps = 12;
  std::size_t apart = 0;
  for (const Primitive& solid : {kCapsule, kGem, kSoap, kOctahedron, kBox}) {
    const Model model = model_of({solid});
    const double size = size_of(model);
    const TriangleDistance of_triangle(model);
    const SignedDistance of_point(model);
    RandomCases random(2);
    for (int i = 0; i < 25; ++i) {
      const Triangle t = random_triangle(random, solid.pose.translation, 1.5 * size, 0.7 * size);
      const Enclosure e = of_triangle(t);
      Enclosure nearest{infinity, infinity};
      for (int a = 0; a <= steps; ++a) {
        for (int b = 0; a + b <= steps; ++b) {
          Point x;
          for (std::size_t k = 0; k < 3; ++k)
            x[k] = t[0][k] + static_cast<double>(a) / steps * (t[1][k] - t[0][k]) +
                   static_cast<double>(b) / steps * (t[2][k] - t[0][k]);
          const Enclosure sample = of_point(x, 1e-3 * size);
          nearest = {std::min(nearest.lo, sample.lo), std::min(nearest.hi, sample.hi)};
        }
      }
      const double rounding = 1e-15 * reach_of(model, t);  // of the samples
      const double spacing = 1.4 * size * std::sqrt(3.0) * std::sqrt(2.0) / steps;
      EXPECT_LE(e.lo, std::max(0.0, nearest.hi) + rounding) << describe(model, t, e);
      EXPECT_GE(e.hi, nearest.lo - spacing) << describe(model, t, e);
      if (nearest.hi < 0.0) {
        EXPECT_EQ(e, (Enclosure{0.0, 0.0})) << describe(model, t, e);
      }
      apart += e.lo > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(apart, 40U);
}

TEST(TriangleDistanceTest, OfAPointIsThePointsOwn) {
  for (std::uint64_t k = 0; k < 60; ++k) {
    RandomCases random(k);
    const Model model = model_of({random.solid()});
    const TriangleDistance of_triangle(model);
    const SignedDistance of_point(model);
    for (int i = 0; i < 5; ++i) {
      const Point x = random.point(model.primitives[0]).point;
      const Enclosure e = of_triangle({x, x, x});
      const Enclosure point = of_point(x, size_of(model));
      EXPECT_TRUE(agree(e, {std::max(0.0, point.lo), std::max(0.0, point.hi)}))
          << describe(model, {x, x, x}, e) << fmt::format(" against [{}, {}]", point.lo, point.hi);
    }
  }
}

// Symmetries.

TEST(TriangleDistanceTest, DependsOnNoOrderOfCornersAndNoReflection) {
  for (const Primitive& posed : {kCapsule, kGem, kSoap, kOctahedron, kNeedle}) {
    const Model model = model_of({{posed.name, posed.superquadric, {}}});
    const TriangleDistance distance(model);
    RandomCases random(3);
    for (int i = 0; i < 20; ++i) {
      const Triangle t = random_triangle(random, {}, 2 * size_of(model), size_of(model));
      const Enclosure e = distance(t);
      for (const auto& order : {std::array{0, 2, 1}, std::array{1, 2, 0}, std::array{2, 1, 0}}) {
        const Triangle permuted{t[order[0]], t[order[1]], t[order[2]]};
        EXPECT_TRUE(agree(e, distance(permuted))) << describe(model, t, e);
      }
      for (std::size_t k = 0; k < 3; ++k) {
        Triangle reflected = t;
        for (Point& corner : reflected) corner[k] = -corner[k];
        EXPECT_TRUE(agree(e, distance(reflected))) << describe(model, t, e);
      }
    }
  }
}

// Widths.

double fraction_wider(const Model& model, double width, std::size_t count, bool certified) {
  const TriangleDistance distance(model);
  const double size = size_of(model);
  RandomCases random(4);
  std::size_t wider = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle t = random_triangle(random, model.primitives[0].pose.translation, 2.5 * size, size);
    const Enclosure e = certified ? distance.certified(t).distance : distance(t);
    if (!(e.width() <= width * size)) ++wider;
  }
  return static_cast<double>(wider) / static_cast<double>(count);
}

TEST(TriangleDistanceTest, IsTightOnTheObjectsOfThePaper) {
  for (const Primitive& solid : {kCapsule, kGem, kSoap}) {
    EXPECT_LE(fraction_wider(model_of({solid}), 1e-12, 4000, false), 1e-3) << solid.name;
    EXPECT_LE(fraction_wider(model_of({solid}), 1e-12, 4000, true), 1e-3) << solid.name;
  }
}

TEST(TriangleDistanceTest, IsTightOnHardSolids) {
  std::size_t wide = 0;
  std::size_t cases = 0;
  for (std::uint64_t k = 0; k < 150; ++k) {
    RandomCases random(k);
    const Model model = model_of({random.solid()});
    const TriangleDistance distance(model);
    for (int i = 0; i < 20; ++i, ++cases) {
      const Triangle t = hard_triangle(random, model.primitives[0]);
      const Enclosure e = distance(t);
      if (e.width() <= 1e-12 * reach_of(model, t)) continue;
      if (wide++ < 5) fmt::print("{}\n", describe(model, t, e));
    }
  }
  EXPECT_LE(wide, cases / 1000);
}

TEST(TriangleDistanceTest, ExtremeCornersGiveValidEnclosures) {
  const TriangleDistance distance(model_of({kGem, kBall}));
  RandomCases random(5);
  constexpr std::array extremes{0.0, 1.0, -2.0, 5e-324, -1e-300, 1e300, -std::numeric_limits<double>::max()};
  for (int i = 0; i < 300; ++i) {
    Triangle t;
    for (Point& corner : t)
      for (double& c : corner) c = extremes[random.choice(extremes.size())];
    const Enclosure e = distance(t);
    EXPECT_TRUE(0.0 <= e.lo && e.lo <= e.hi) << describe(model_of({kGem}), t, e);
  }
}

// Unions.

Model random_union(RandomCases& random, std::size_t count) {
  Model model;
  for (std::size_t i = 0; i < count; ++i) {
    Primitive next = std::array{kCapsule, kGem, kSoap, kBall, kOctahedron}[random.choice(5)];
    for (double& c : next.pose.translation) c = random.uniform(-8, 8);
    for (double& c : next.pose.quaternion) c = random.uniform(-1, 1);
    model.primitives.push_back(next);
  }
  return model;
}

TEST(TriangleDistanceTest, OfAUnionIsTheLeastOfItsPrimitives) {
  RandomCases random(6);
  for (int k = 0; k < 40; ++k) {
    const Model model = random_union(random, 5);
    for (int i = 0; i < 5; ++i) {
      const Triangle t = random_triangle(random, {}, 10, random.log_uniform(0.1, 10));
      Enclosure least{infinity, infinity};
      for (const Primitive& primitive : model.primitives) {
        const Enclosure e = TriangleDistance(model_of({primitive}))(t);
        least = {std::min(least.lo, e.lo), std::min(least.hi, e.hi)};
      }
      EXPECT_EQ(TriangleDistance(model)(t), least) << describe(model, t, least);
    }
  }
}

// Certificates.

struct CertifiedTriangle {
  Triangle triangle;
  CertifiedEnclosure found;
};

std::vector<CertifiedTriangle> certified_triangles(const Model& model, RandomCases& random, std::size_t count) {
  const TriangleDistance distance(model);
  std::vector<CertifiedTriangle> rows;
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle t = hard_triangle(random, model.primitives[random.choice(model.primitives.size())]);
    rows.push_back({t, distance.certified(t)});
  }
  return rows;
}

/// One solid, or two.
Model hard_model(RandomCases& random, std::uint64_t k) {
  Model model = model_of({random.solid()});
  if (k % 2 == 1) model.primitives.push_back(random.solid());
  return model;
}

TEST(TriangleCertificateTest, ProvesWhatItComesWithAndNothingPastTheTruth) {
  std::size_t refuted = 0;
  std::size_t false_claims = 0;
  for (std::uint64_t k = 0; k < 80; ++k) {
    RandomCases random(1000 + k);
    const Model model = hard_model(random, k);
    const Checker check(model);
    const TriangleDistance distance(model);
    for (const auto& [triangle, found] : certified_triangles(model, random, 12)) {
      const Enclosure& e = found.distance;
      const Enclosure truth = distance(triangle);  // lies in here
      EXPECT_TRUE(agree(e, truth));
      const Finding finding = check(triangle, e, found.certificate);
      EXPECT_EQ(finding.verdict, Verdict::proved) << describe(model, triangle, e);
      EXPECT_EQ(finding.proven, e) << describe(model, triangle, e);
      const double above = moved(truth.hi, infinity);
      const double below = moved(truth.lo, -infinity);
      for (const Enclosure& claim : {Enclosure{above, std::max(e.hi, above)}, Enclosure{std::min(0.0, below), below}}) {
        const Verdict verdict = check(triangle, claim, found.certificate).verdict;
        EXPECT_NE(verdict, Verdict::proved) << describe(model, triangle, claim);
        refuted += verdict == Verdict::refuted ? 1 : 0;
        ++false_claims;
      }
    }
  }
  EXPECT_GT(refuted, false_claims / 2);
}

/// Certificates are tight although their numbers are rounded to binary64.
TEST(TriangleCertificateTest, LosesOnlyRounding) {
  double worst = 0.0;
  for (std::uint64_t k = 0; k < 60; ++k) {
    RandomCases random(2000 + k);
    const Model model = hard_model(random, k);
    const TriangleDistance distance(model);
    for (const auto& [triangle, found] : certified_triangles(model, random, 12)) {
      const double excess = found.distance.width() - distance(triangle).width();
      worst = std::max(worst, excess / reach_of(model, triangle));
    }
  }
  EXPECT_LT(worst, 1e-14);
}

const Model kScene = model_of({kBall, {"gem", kGem.superquadric, {{0.0, 0.0, 5.0}, {1.0, 0.0, 0.0, 0.0}}}});
const Triangle kAboveBall{{{2, -1, -1}, {2, 2, -1}, {2, -1, 2}}};  // 1 from the ball, by (2, 0, 0)
const Certificate kHonest{{{0, {1.0, 0.0, 0.0}}}, {}, {}};

/// kHonest with a point of the triangle.
Certificate with_weights(double first, double second) {
  Certificate certificate = kHonest;
  certificate.weights = {first, second};
  return certificate;
}

TEST(TriangleCheckerTest, ProvesByHandMadeCertificates) {
  const Checker check(kScene);
  // The foot (2, 0, 0) has the weights 1/3, 1/3, which no binary64 numbers are: nearby points are a little farther.
  EXPECT_EQ(check(kAboveBall, {1.0, 1.000000001}, with_weights(0.33333333, 0.33333333)).verdict, Verdict::proved);
  EXPECT_EQ(check(kAboveBall, {1.0, 1.0}, with_weights(0.33333333, 0.33333333)).verdict, Verdict::unproved);
  EXPECT_EQ(check(kAboveBall, {-1.0, 1.5}, with_weights(0.3, 0.3)).verdict, Verdict::proved);
  const Triangle cutting{{{0.5, -1, -1}, {0.5, 2, -1}, {0.5, -1, 2}}};
  EXPECT_EQ(check(cutting, {0.0, 0.0}, with_weights(0.3, 0.3)).verdict, Verdict::proved);
  EXPECT_EQ(check(cutting, {0.0, 0.0}, with_weights(0.0, 0.0)).verdict, Verdict::unproved);
}

TEST(TriangleCheckerTest, WeightsOutsideTheTriangleProveNothing) {
  const Checker check(kScene);
  const Triangle beside{{{2, 3, 0}, {2, 6, 0}, {2, 3, 4}}};  // its plane is 1 away, it is not
  for (const auto& [first, second] : std::vector<std::pair<double, double>>{{-1.0, 0.0},
                                                                            {-0x1p-60, 0.5},
                                                                            {0.5, 0.5 + 0x1p-52},
                                                                            {1.0, 5e-324},
                                                                            {kNaN, 0.0},
                                                                            {0.0, kNaN},
                                                                            {infinity, 0.0},
                                                                            {infinity, -infinity}}) {
    const Finding finding = check(beside, {0.0, 9.0}, with_weights(first, second));
    EXPECT_EQ(finding.verdict, Verdict::unproved) << first << " " << second;
    EXPECT_EQ(finding.proven.hi, infinity);
  }
  EXPECT_EQ(check(beside, {0.0, 9.0}, with_weights(0.5, 0.5)).verdict, Verdict::proved);
  EXPECT_EQ(check(beside, {0.0, 9.0}, with_weights(1.0, 0.0)).verdict, Verdict::proved);
  Certificate none = kHonest;
  none.weights.reset();
  EXPECT_EQ(check(beside, {0.0, 9.0}, none).verdict, Verdict::unproved);
}

TEST(TriangleCheckerTest, RefutesWhatIsProvenFalse) {
  const Checker check(kScene);
  const Certificate certificate = with_weights(0.33333333, 0.33333333);
  EXPECT_EQ(check(kAboveBall, {1.1, 1.2}, certificate).verdict, Verdict::refuted);
  EXPECT_EQ(check(kAboveBall, {0.0, 0.9}, certificate).verdict, Verdict::refuted);
  EXPECT_EQ(check(kAboveBall, {1.5, 0.5}, certificate).verdict, Verdict::refuted);
  EXPECT_EQ(check(kAboveBall, {-1.0, -0.5}, certificate).verdict, Verdict::refuted);
}

/// Whatever stands in a certificate, a claim that excludes the truth is not proved.
TEST(TriangleCheckerTest, ProvesNothingFalseFromNonsense) {
  const Checker check(kScene);
  RandomCases random(7);
  constexpr std::array extremes{0.0, -0.0, 1.0, 1e308, 5e-324, -1e-200, infinity, kNaN};
  const auto number = [&](double low, double high) {
    return random.choice(4) == 0 ? extremes[random.choice(extremes.size())] : random.uniform(low, high);
  };
  for (int i = 0; i < 5000; ++i) {
    Certificate certificate;
    for (std::size_t n = random.choice(4); n > 0; --n)
      certificate.normals.push_back(
          {static_cast<std::uint32_t>(random.choice(3)), {number(-2, 2), number(-2, 2), number(-2, 2)}});
    if (random.choice(4) != 0) certificate.weights = {number(-0.2, 1.2), number(-0.2, 1.2)};
    EXPECT_NE(check(kAboveBall, {1.0000001, 9.0}, certificate).verdict, Verdict::proved);
    EXPECT_NE(check(kAboveBall, {0.0, 0.9999999}, certificate).verdict, Verdict::proved);
    EXPECT_NE(check(kAboveBall, {0.0, 0.0}, certificate).verdict, Verdict::proved);
  }
}

}  // namespace
}  // namespace verisq
