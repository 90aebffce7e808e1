/// Penetration depths contain what is known of simple solids, and forged certificates prove nothing false.
/// VERISQ_FORGED_PENETRATIONS says how many pairs are tried.
#include "verisq/penetration.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/forgeries.hpp"
#include "tests/fixtures/mesh_scenes.hpp"
#include "tests/fixtures/random.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/random_pairs.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/overlap.hpp"

namespace verisq {
namespace {

using oracle::RandomCases;
using testing::Random;

Primitive superquadric(const std::array<double, 3>& semi_axes, double exponent, const Point& centre = {}) {
  Primitive primitive;
  primitive.superquadric.semi_axes = semi_axes;
  primitive.superquadric.exponents = {exponent, exponent};
  primitive.pose.translation = centre;
  return primitive;
}

Primitive ball(double radius, const Point& centre = {}) {
  return superquadric({radius, radius, radius}, 1.0, centre);
}

Model model_of(std::vector<Primitive> primitives) {
  return {"", std::move(primitives)};
}

Model mesh_model(const Mesh& mesh) {
  return model_of({mesh_primitive("mesh", mesh)});
}

CertifiedPenetration depth_of(const Model& a, const Model& b, double tolerance, const Pose& pose = {}) {
  const CertifiedPenetration found = PenetrationDepth(a, b)(pose, {.tolerance = tolerance});
  EXPECT_EQ(PenetrationChecker(a, b)(pose, found.depth, found.certificate).verdict, Verdict::proved);
  return found;
}

// Solids whose depth is known.

TEST(PenetrationTest, IsTheSumOfRadiiLessTheWayBetweenTwoBalls) {
  Random random(301);
  for (int k = 0; k < 200; ++k) {
    SCOPED_TRACE(k);
    const double radius_a = random.uniform(0.1, 3.0);
    const double radius_b = random.uniform(0.1, 3.0);
    const Point centre = random.point(2.0);
    const long double way = std::hypot(static_cast<long double>(centre[0]), static_cast<long double>(centre[1]),
                                       static_cast<long double>(centre[2]));
    const long double exact = std::max(0.0L, static_cast<long double>(radius_a) + radius_b - way);
    constexpr double tolerance = 1e-7;
    const Enclosure depth = depth_of(model_of({ball(radius_a)}), model_of({ball(radius_b, centre)}), tolerance).depth;
    EXPECT_LE(depth.lo, exact + 1e-15L);
    EXPECT_GE(depth.hi, exact - 1e-15L);
    EXPECT_LE(depth.width(), tolerance);
  }
}

TEST(PenetrationTest, IsExactWhereBallsHaveOneCentre) {
  const CertifiedPenetration found = depth_of(model_of({ball(1.0)}), model_of({ball(0.5)}), 1e-12);
  EXPECT_TRUE(found.depth.contains(1.5));
  EXPECT_LE(found.depth.width(), 1e-12);
  EXPECT_TRUE(found.certificate.balls.has_value());
}

TEST(PenetrationTest, IsZeroWhereSolidsTouchOrAreApart) {
  for (const double way : {2.0, 2.5, 1e3})
    EXPECT_EQ(depth_of(model_of({ball(1.0)}), model_of({ball(1.0, {0.0, way, 0.0})}), 1e-9).depth, (Enclosure{0, 0}));
  const Enclosure nearly = depth_of(model_of({ball(1.0)}), model_of({ball(1.0, {1.9999999, 0, 0})}), 1e-9).depth;
  EXPECT_GT(nearly.lo, 0.9e-7);
  EXPECT_LT(nearly.hi, 1.1e-7);
}

TEST(PenetrationTest, IsAsTightAtHugeAndTinySizesAsAtOne) {
  for (const double size : {1e-300, 1e-150, 1.0, 1e150, 1e300}) {
    const Model a = model_of({ball(size)});
    const Enclosure depth = depth_of(a, model_of({ball(size, {1.5 * size, 0.0, 0.0})}), 1e-6 * size).depth;
    EXPECT_NEAR(depth.lo / size, 0.5, 1e-6);
    EXPECT_NEAR(depth.hi / size, 0.5, 1e-15);
    EXPECT_GE(depth.hi, 0.5 * size * (1.0 - 1e-15));
  }
}

TEST(PenetrationTest, OfBoxesIsTheLeastOverlapOfTheirSides) {
  Random random(302);
  for (int k = 0; k < 100; ++k) {
    SCOPED_TRACE(k);
    std::array<double, 3> one{};
    std::array<double, 3> other{};
    for (std::size_t i = 0; i < 3; ++i) {
      one[i] = random.uniform(0.5, 3.0);
      other[i] = random.uniform(0.5, 3.0);
    }
    const Point centre = random.point(1.5);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) least = std::min(least, one[i] + other[i] - std::fabs(centre[i]));
    if (least < 0.1) continue;
    constexpr double exponent = 1e-3;  // corners are rounded by some thousandths of the edges at most
    const Model a = model_of({superquadric(one, exponent)});
    const Model b = model_of({superquadric(other, exponent, centre)});
    const Enclosure depth = depth_of(a, b, 1e-6).depth;
    EXPECT_LE(depth.width(), 1e-6);
    EXPECT_LE(depth.hi, least + 1e-12);
    EXPECT_GE(depth.lo, least - 0.01);
  }
}

/// The least overlap of the support functions over many directions.
double sampled_depth(const Primitive& a, const Primitive& b, Random& random) {
  const auto set_a = verify::posed_set<long double>(a);
  const auto set_b = verify::posed_set<long double>(b);
  const auto overlap = [&](const Point& v) {
    const long double length = std::sqrt(static_cast<long double>(verify::dot(v, v)));
    const verify::Coordinates<long double> n{v[0] / length, v[1] / length, v[2] / length};
    return static_cast<double>(verify::dot(n, set_a(n)) - verify::dot(n, set_b({-n[0], -n[1], -n[2]})));
  };
  Point best = random.point(1.0);
  double least = overlap(best);
  const auto offer = [&](const Point& v) {
    if (const double found = overlap(v); found < least) {
      least = found;
      best = v;
    }
  };
  for (int k = 0; k < 500; ++k) offer(random.point(1.0));
  for (double step = 0.3; step > 1e-7; step *= 0.9) {
    for (int k = 0; k < 12; ++k) {
      const Point turn = random.point(step);
      const double length = std::sqrt(verify::dot(best, best));
      offer({best[0] / length + turn[0], best[1] / length + turn[1], best[2] / length + turn[2]});
    }
  }
  return std::max(0.0, least);
}

TEST(PenetrationTest, OfConvexSolidsIsThatOfSampledDirections) {
  RandomCases random(303);
  Random directions(304);
  int overlapping = 0;
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(k);
    const auto [a, b, family] = oracle::random_pair(random);
    const double size = std::max(bounding_radius(model_of({a})), bounding_radius(model_of({b})));
    const Enclosure depth = depth_of(model_of({a}), model_of({b}), 1e-6 * size).depth;
    const double sampled = sampled_depth(a, b, directions);
    EXPECT_LE(depth.lo, sampled + 1e-12 * size) << to_string(family);
    EXPECT_LE(depth.hi, sampled + 2e-6 * size) << to_string(family);
    overlapping += depth.lo > 0.0 ? 1 : 0;
  }
  EXPECT_GT(overlapping, 50);
}

TEST(PenetrationTest, OfUnionsIsAtLeastThatOfEachPairOfMembers) {
  const Model a = model_of({ball(1.0), ball(0.5, {3.0, 0.0, 0.0})});
  const Model b = model_of({ball(0.6, {3.0, 1.0, 0.0}), ball(0.2, {0.0, 1.0, 0.0})});
  const Enclosure depth = depth_of(a, b, 1e-6).depth;
  EXPECT_GE(depth.lo, 0.2 - 1e-6);
  EXPECT_GE(depth.hi, depth.lo);
  EXPECT_LE(depth.hi, 1.0);
}

TEST(PenetrationTest, OfMeshesLiesBetweenBallsInThemAndAWayThatPartsThem) {
  const Mesh cube = testing::cube_mesh(2);
  const auto [low, high] = std::ranges::minmax(cube.vertices, {}, [](const Point& x) { return x[0]; });
  const double edge = high[0] - low[0];
  const Model a = mesh_model(cube);
  const Enclosure beside = depth_of(a, a, 1e-6, {{0.75 * edge, 0.0, 0.0}, {1, 0, 0, 0}}).depth;
  EXPECT_TRUE(beside.contains(0.25 * edge));
  EXPECT_GT(beside.lo, 0.2 * edge);
  EXPECT_LT(beside.hi, 0.26 * edge);
  const Enclosure apart = depth_of(a, a, 1e-6, {{1.5 * edge, 0.0, 0.0}, {1, 0, 0, 0}}).depth;
  EXPECT_EQ(apart, (Enclosure{0, 0}));
}

/// A ball on the ground of a cup leaves it by less than what parts it from the cup's hull.
TEST(PenetrationTest, OfABallInABowlIsNotThatOfTheBowlsHull) {
  Model bowl = model_of({ball(2.0), ball(1.8), superquadric({3.0, 3.0, 3.0}, 0.05, {0.0, 0.0, 3.0})});
  SetExpression parts{{}, SetOperation::subtract, 0};
  for (std::uint32_t i = 0; i < 3; ++i) parts.operands.push_back({{}, SetOperation::unite, i});
  bowl.csg = parts;
  const Model round = model_of({ball(0.5, {0.0, 0.0, -1.35})});
  const CertifiedPenetration found = depth_of(bowl, round, 1e-4);
  EXPECT_GT(found.depth.lo, 0.02);
  EXPECT_LT(found.depth.hi, 0.1);
  EXPECT_TRUE(found.certificate.parting.has_value());
}

TEST(PenetrationTest, OfBentSolidsHasBothEnds) {
  Primitive bent = superquadric({0.5, 0.5, 3.0}, 1.0);
  bent.bend = Bend{0.2, 0.0};
  const Enclosure depth = depth_of(model_of({bent}), model_of({ball(0.5, {0.0, 0.8, 0.0})}), 1e-6).depth;
  EXPECT_GT(depth.lo, 0.1);
  EXPECT_LT(depth.hi, 0.25);
}

// Claims that the certificate does not prove.

struct Case {
  Model a, b;
  CertifiedPenetration found;
};

/// A pair of convex solids that overlap, with its surface.
Case overlapping_case(RandomCases& random) {
  for (;;) {
    const auto [one, other, family] = oracle::random_pair(random);
    Case tried{model_of({one}), model_of({other}), {}};
    const double size = std::max(bounding_radius(tried.a), bounding_radius(tried.b));
    tried.found = PenetrationDepth(tried.a, tried.b)({}, {.tolerance = 1e-5 * size});
    if (tried.found.depth.lo > 1e-3 * size && tried.found.certificate.surface) return tried;
  }
}

class ForgedPenetrationTest : public ::testing::Test {
 protected:
  void expect_not_proved(const Case& forged, const Enclosure& claimed, const char* what) {
    forgeries_.expect_not_proved(PenetrationChecker(forged.a, forged.b)({}, claimed, forged.found.certificate), claimed,
                                 what);
  }

  /// The proof that remains says that the depth is at least 0.
  static void expect_no_lower_end(const Case& forged, const char* what) {
    EXPECT_EQ(PenetrationChecker(forged.a, forged.b).prove({}, forged.found.certificate).lo, 0.0) << what;
  }

  /// A change of the certificate may leave the claim proven only if the claim is true: it is, so that the ends must
  /// still contain what was proven of the honest one.
  static void expect_sound(const Case& forged, const Enclosure& honest, const char* what) {
    const Enclosure proven = PenetrationChecker(forged.a, forged.b).prove({}, forged.found.certificate);
    EXPECT_LE(proven.lo, honest.hi) << what;
    EXPECT_GE(proven.hi, honest.lo) << what;
  }

  oracle::Forgeries forgeries_;
};

TEST_F(ForgedPenetrationTest, ProvesNoOtherEnds) {
  RandomCases random(311);
  const std::size_t count = oracle::requested_count("VERISQ_FORGED_PENETRATIONS", 60);
  for (std::size_t k = 0; k < count; ++k) {
    SCOPED_TRACE(k);
    const Case honest = overlapping_case(random);
    const auto [lo, hi] = honest.found.depth;
    for (const double towards : {0.0, 1.0, 2.0, 3.0}) {
      const double share = std::pow(10.0, -4.0 * towards);
      expect_not_proved(honest, {hi + share * hi, 2.0 * hi + share * hi}, "beyond the upper end");
      expect_not_proved(honest, {0.0, lo - share * lo}, "short of the lower end");
    }
    expect_not_proved(honest, {oracle::moved(lo, infinity), hi}, "a higher lower end");
    expect_not_proved(honest, {lo, oracle::moved(hi, -infinity)}, "a lower upper end");
    expect_not_proved(honest, {hi, lo}, "ends exchanged");
    expect_not_proved(honest, {0.0, 0.0}, "no overlap");
  }
  EXPECT_GE(forgeries_.told(), 12 * count);
}

TEST_F(ForgedPenetrationTest, ProvesNoLowerEndByAnOpenSurface) {
  RandomCases random(312);
  for (int k = 0; k < 60; ++k) {
    SCOPED_TRACE(k);
    const Case honest = overlapping_case(random);
    Case forged = honest;
    auto& [i, j, surface, on_a] = *forged.found.certificate.surface;
    const std::size_t n = random.choice(surface.triangles.size());
    surface.triangles.erase(surface.triangles.begin() + static_cast<std::ptrdiff_t>(n));
    expect_no_lower_end(forged, "a triangle less");
    forged = honest;
    auto& turned = forged.found.certificate.surface->surface.triangles[n];
    std::swap(turned[0], turned[1]);
    expect_no_lower_end(forged, "a triangle turned");
    forged = honest;
    forged.found.certificate.surface->surface.triangles[n][1] = 1U << 30U;
    expect_no_lower_end(forged, "a corner that is not there");
    forged.found.certificate.surface->surface.triangles.clear();
    expect_no_lower_end(forged, "no triangles");
  }
}

TEST_F(ForgedPenetrationTest, ProvesNoLowerEndByPointsOutside) {
  RandomCases random(313);
  for (int k = 0; k < 60; ++k) {
    SCOPED_TRACE(k);
    const Case honest = overlapping_case(random);
    const std::size_t n = random.choice(honest.found.certificate.surface->on_a.size());
    Case forged = honest;
    for (double& x : forged.found.certificate.surface->on_a[n]) x *= 1.001;
    expect_no_lower_end(forged, "a point outside of A");
    forged = honest;
    for (Point& x : forged.found.certificate.surface->surface.vertices)
      for (double& c : x) c *= 1.001;
    expect_no_lower_end(forged, "a larger surface");
    forged = honest;
    forged.found.certificate.surface->on_a.pop_back();
    expect_no_lower_end(forged, "a point too few");
    forged = honest;
    forged.found.certificate.surface->on_a[n][0] = std::numeric_limits<double>::quiet_NaN();
    expect_no_lower_end(forged, "no number");
    forged = honest;
    forged.found.certificate.surface->primitive_b = 7;
    expect_no_lower_end(forged, "a primitive that is not there");
    forged = honest;
    std::swap(forged.a, forged.b);
    expect_sound(forged, honest.found.depth, "models exchanged");
  }
}

/// A closed surface of true points that does not wind about the origin: the two shells of a hull, one turned; a
/// tetrahedron beside the origin.
TEST_F(ForgedPenetrationTest, ProvesNoLowerEndByASurfaceThatDoesNotWind) {
  RandomCases random(314);
  for (int k = 0; k < 30; ++k) {
    SCOPED_TRACE(k);
    const Case honest = overlapping_case(random);
    Case forged = honest;
    Mesh& surface = forged.found.certificate.surface->surface;
    const Mesh turned = testing::turned(surface);
    surface.triangles.insert(surface.triangles.end(), turned.triangles.begin(), turned.triangles.end());
    expect_no_lower_end(forged, "twice, once turned");
    forged = honest;
    Mesh& shrunken = forged.found.certificate.surface->surface;
    for (std::size_t n = 0; n < shrunken.vertices.size(); ++n) {
      const Point& first = honest.found.certificate.surface->surface.vertices.front();
      for (std::size_t c = 0; c < 3; ++c)
        shrunken.vertices[n][c] = first[c] + 0.01 * (shrunken.vertices[n][c] - first[c]);
      const Point& first_on_a = honest.found.certificate.surface->on_a.front();
      Point& on_a = forged.found.certificate.surface->on_a[n];
      for (std::size_t c = 0; c < 3; ++c) on_a[c] = first_on_a[c] + 0.01 * (on_a[c] - first_on_a[c]);
    }
    expect_no_lower_end(forged, "a small surface beside the origin");
  }
}

TEST_F(ForgedPenetrationTest, ProvesNothingFalseByChangedNumbers) {
  RandomCases random(315);
  const std::size_t count = oracle::requested_count("VERISQ_FORGED_PENETRATIONS", 60);
  std::size_t changes = 0;
  for (std::size_t k = 0; k < count; ++k) {
    SCOPED_TRACE(k);
    const Case honest = overlapping_case(random);
    const auto tried = [&](const auto& change, const char* what) {
      Case forged = honest;
      change(forged.found.certificate);
      expect_sound(forged, honest.found.depth, what);
      ++changes;
    };
    for (std::size_t c = 0; c < 3; ++c) {
      tried([&](auto& proof) { proof.direction[c] = oracle::with_wrong_digit(proof.direction[c], random); },
            "direction");
      tried([&](auto& proof) { proof.direction[c] = -3.0 * proof.direction[c]; }, "direction turned");
      tried([&](auto& proof) { proof.direction[c] = infinity; }, "direction without an end");
    }
    const std::size_t vertices = honest.found.certificate.surface->on_a.size();
    for (int times = 0; times < 10; ++times) {
      const std::size_t n = random.choice(vertices);
      const std::size_t c = random.choice(3);
      tried(
          [&](auto& proof) {
            double& x = proof.surface->surface.vertices[n][c];
            x = oracle::with_wrong_digit(x, random);
          },
          "vertex");
      tried(
          [&](auto& proof) {
            double& x = proof.surface->on_a[n][c];
            x = oracle::with_wrong_digit(x, random);
          },
          "point of A");
      tried(
          [&](auto& proof) {
            auto& triangles = proof.surface->surface.triangles;
            triangles[random.choice(triangles.size())][c] = static_cast<std::uint32_t>(random.choice(vertices));
          },
          "triangle");
    }
  }
  EXPECT_GE(changes, 39 * count);
}

TEST_F(ForgedPenetrationTest, ProvesNothingByBallsAndTranslationsThatAreTooGood) {
  const Model a = model_of({ball(1.0)});
  const Model b = model_of({ball(1.0, {1.5, 0.0, 0.0})});
  const PenetrationChecker checker(a, b);
  const Certificate proof{.normals = {{0, {1.0, 0.0, 0.0}}}, .escape = {}};
  for (const double radius : {0.2501, 0.3, 1.0, 1e9, infinity}) {
    PenetrationCertificate certificate{.direction = {1.0, 0.0, 0.0}};
    certificate.balls = {InnerBall{{0.75, 0.0, 0.0}, radius, proof}, InnerBall{{0.75, 0.0, 0.0}, radius, proof}};
    EXPECT_LE(checker.prove({}, certificate).lo, 0.5) << radius;
  }
  for (const double way : {0.4, 0.499999, -0.5, 0.0}) {
    PenetrationCertificate certificate{};
    certificate.parting =
        PartingTranslation{{way, 0.0, 0.0}, {.separations = {{0, 0, {1, 0, 0}, {1, 0, 0}, {-1, 0, 0}}}}};
    EXPECT_EQ(checker.prove({}, certificate).hi, infinity) << way;
  }
  PenetrationCertificate parted{};
  parted.parting = PartingTranslation{{0.51, 0.0, 0.0}, {.separations = {{0, 0, {1, 0, 0}, {1, 0, 0}, {-1, 0, 0}}}}};
  EXPECT_NEAR(checker.prove({}, parted).hi, 0.51, 1e-15);
  EXPECT_EQ(checker.prove({}, {}), (Enclosure{0.0, infinity}));
}

/// A surface with the origin in a hollow of it: the signed distance is what decides, not the number of triangles.
TEST(DifferenceHullTest, GrowsAboutAnOriginThatIsOutsideOfItsFirstPoints) {
  const auto support = [](const verify::DifferenceHull::Vector& n) {
    const long double length = std::sqrt(verify::dot(n, n));
    const verify::DifferenceHull::Vector x{0.99L + n[0] / length, n[1] / length, n[2] / length};
    return std::optional(verify::FarthestPoint{
        x, {static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2])}, {}});
  };
  verify::DifferenceHull hull(support);
  hull.grow({.tolerance = 1e-6, .enough = 0.0, .facets = 2000, .interrupted = [] { return false; }});
  EXPECT_NEAR(hull.reach(), 0.01, 1e-6);
  EXPECT_NEAR(hull.depth(), 0.01, 2e-6);
  EXPECT_LT(hull.surface().mesh.triangles.size(), 400U);
}

}  // namespace
}  // namespace verisq
