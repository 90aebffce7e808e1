/// Tapered solids: triangles and pairs whose distances follow from closed forms or from a reflection.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/distance.hpp>

#include "tests/oracle/tapered_contact.hpp"

namespace verisq {
namespace {

constexpr double kWidth = 1e-13;  // in units of the largest semi-axis, which is 2 here

Model model(const Superquadric& solid, const Pose& pose = {}) {
  return {"", {{"solid", solid, pose}}};
}

Pose at(double x, double y, double z) {
  return {{x, y, z}, {1.0, 0.0, 0.0, 0.0}};
}

std::vector<Superquadric> solids() {
  std::vector<Superquadric> result;
  for (const double e1 : {0.05, 0.7, 1.0, 1.6, 2.0}) {
    for (const double e2 : {0.1, 1.0, 1.3, 2.0}) {
      for (const double taper : {0.0625, 0.5, 4.0, 16.0}) result.push_back({{1.0, 0.5, 2.0}, {e1, e2}, taper});
    }
  }
  return result;
}

std::string described(const Superquadric& solid) {
  return fmt::format("exponents {} {}, taper {}", solid.exponents[0], solid.exponents[1], solid.taper);
}

void expect_enclosed(const Enclosure& found, double exact, double rounding = 0.0) {
  EXPECT_LE(found.lo, exact + rounding);
  EXPECT_GE(found.hi, exact - rounding);
  EXPECT_LE(found.width(), kWidth);
}

/// The point reflection of the solid at `q`: the taper is the other way round, which of a power of two is exact.
Model reflected(const Superquadric& solid, const Pose& pose, const Point& q) {
  Superquadric other = solid;
  other.taper = 1.0 / solid.taper;
  Pose moved = pose;
  for (std::size_t k = 0; k < 3; ++k) moved.translation[k] = 2.0 * q[k] - pose.translation[k];
  return model(other, moved);
}

TEST(TaperedSolidTest, EndsAreAsFarApartAsTheirHeights) {
  for (const Superquadric& solid : solids()) {
    SCOPED_TRACE(described(solid));
    const Superquadric other{{0.5, 1.0, 0.25}, {1.0, 1.0}, 0.125};
    for (const double side : {-1.0, 1.0}) {
      const ModelDistance found = PairDistance(model(solid), model(other, at(0.0, 0.0, side * 3.0)))();
      expect_enclosed(found.distance, 0.75);
      EXPECT_EQ(found.proximity, Proximity::separated);
      const PairChecker checker(model(solid), model(other, at(0.0, 0.0, side * 3.0)));
      EXPECT_EQ(checker.prove({}, found.certificate), found.distance);
      const double z = side * 2.5;
      expect_enclosed(TriangleDistance(model(solid))({{{-9, -9, z}, {9, -9, z}, {0, 9, z}}}), 0.5);
      expect_enclosed(TriangleDistance(model(solid))({{{0, 0, z}, {9, -9, 2 * z}, {9, 9, 3 * z}}}), 0.5);
    }
  }
}

// No two points of a convex solid and of its reflection at q are closer than q's closest point and its reflection.
TEST(TaperedSolidTest, OfTheReflectionAtAPointIsTwiceThePoints) {
  std::mt19937_64 random(3);
  const Pose pose{{0.25, -0.5, 0.125}, {0.5, -1.0, 0.75, 0.25}};
  for (const Superquadric& solid : solids()) {
    SCOPED_TRACE(described(solid));
    const auto coordinate = [&] { return std::ldexp(std::round(std::normal_distribution(0.0, 2e3)(random)), -10); };
    const Point q{coordinate(), coordinate(), coordinate()};
    const Enclosure of_point = SignedDistance(model(solid, pose))(q, 0.0);
    const ModelDistance found = PairDistance(model(solid, pose), reflected(solid, pose, q))();
    if (of_point.lo > 0.0) {
      EXPECT_LE(of_point.width(), kWidth);
    }
    if (of_point.hi < 0.0) {
      EXPECT_EQ(found.proximity, Proximity::overlapping);
      EXPECT_EQ(found.distance, (Enclosure{0.0, 0.0}));
      continue;
    }
    EXPECT_LE(found.distance.lo, 2.0 * of_point.hi);
    EXPECT_GE(found.distance.hi, 2.0 * of_point.lo);
    EXPECT_LE(found.distance.width(), kWidth);
    const Enclosure of_triangle = TriangleDistance(model(solid, pose))({q, q, q});
    EXPECT_LE(of_triangle.lo, of_point.hi);
    EXPECT_GE(of_triangle.hi, of_point.lo);
    EXPECT_LE(of_triangle.width(), kWidth);
  }
}

TEST(TaperedSolidTest, ClosestPointsOfTheReflectionAreReflected) {
  const Pose pose{{0.25, -0.5, 0.125}, {0.5, -1.0, 0.75, 0.25}};
  for (const Superquadric& solid : solids()) {
    if (solid.exponents[0] == 2.0 || solid.exponents[1] == 2.0) continue;
    SCOPED_TRACE(described(solid));
    const Point q{1.75, 1.5, -2.25};
    const PairDistance distance(model(solid, pose), reflected(solid, pose, q));
    const ModelDistance found = distance();
    const std::optional<ClosestPoints> points = distance.closest_points(found);
    ASSERT_TRUE(points);
    EXPECT_TRUE(points->unique);
    for (std::size_t k = 0; k < 3; ++k) {
      const Enclosure& a = points->on_a[k];
      const Enclosure& b = points->on_b[k];
      EXPECT_LE(a.lo + b.lo, 2.0 * q[k] + 1e-15);
      EXPECT_GE(a.hi + b.hi, 2.0 * q[k] - 1e-15);
      EXPECT_LE(a.width(), 1e-9);
      EXPECT_LE(b.width(), 1e-9);
    }
  }
}

// Side by side nothing but z tells the middle of a tapered solid: its closest points are not there.
TEST(TaperedSolidTest, NothingIsSymmetricAlongZ) {
  const Superquadric solid{{1.0, 0.5, 2.0}, {0.9, 1.1}, 4.0};
  const PairDistance distance(model(solid), model(solid, at(5.0, 0.0, 0.0)));
  const ModelDistance found = distance();
  const Enclosure half = TriangleDistance(model(solid))({{{2.5, -99, -99}, {2.5, 99, -99}, {2.5, 0, 99}}});
  EXPECT_LE(found.distance.lo, 2.0 * half.hi);
  EXPECT_GE(found.distance.hi, 2.0 * half.lo);
  EXPECT_LE(found.distance.width(), kWidth);
  const std::optional<ClosestPoints> points = distance.closest_points(found);
  ASSERT_TRUE(points);
  EXPECT_GT(points->on_a[2].lo, 0.1);  // towards the larger end
  EXPECT_GE(points->on_a[2].hi, points->on_b[2].lo);
  EXPECT_LE(points->on_a[2].lo, points->on_b[2].hi);
  EXPECT_LE(points->on_a[2].width(), 1e-9);
  EXPECT_TRUE(points->on_a[1].contains(0.0));
  const PairDistance upright(model(solid), model(solid, {{5.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}}));
  const ModelDistance turned = upright();  // the larger ends at opposite heights
  EXPECT_GT(turned.distance.lo, found.distance.hi);
}

TEST(TaperedSolidTest, CertificatesOfTrianglesProveThem) {
  std::mt19937_64 random(4);
  const Pose pose{{0.25, -0.5, 0.125}, {0.5, -1.0, 0.75, 0.25}};
  for (const Superquadric& solid : solids()) {
    SCOPED_TRACE(described(solid));
    std::normal_distribution<double> normal(0.0, 2.0);
    Triangle triangle;
    for (Point& corner : triangle) corner = {normal(random), normal(random), normal(random)};
    const CertifiedEnclosure found = TriangleDistance(model(solid, pose)).certified(triangle);
    EXPECT_LE(found.distance.width(), kWidth);
    const Finding finding = Checker(model(solid, pose))(triangle, found.distance, found.certificate);
    EXPECT_EQ(finding.verdict, Verdict::proved);
    EXPECT_EQ(finding.proven, found.distance);
  }
}

// |u_z/a3|^(p1-1) is not small at any height that binary64 resolves: the closest point lies on the widest section, or
// at an end, in all digits, with a normal between those about it.
TEST(TaperedSolidTest, NearlyDoubleConesAreAsTightAsOthers) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (const double below_two : {0.03, 0.02, 1e-3, 1e-5, 1e-8, 1e-12, 0.0}) {
    for (const double taper : {3.0, 10.0, 0.2}) {
      const Superquadric solid{{0.5, 1.25, 0.75}, {2.0 - below_two, 1.0}, taper};
      SCOPED_TRACE(described(solid));
      const Model tapered = model(solid);
      for (const double reach : {1.5, 3.0, 16000.0}) {
        Point place;
        for (double& c : place) c = reach * normal(random);
        Triangle triangle;
        for (Point& corner : triangle)
          for (std::size_t k = 0; k < 3; ++k) corner[k] = place[k] + normal(random);
        const CertifiedEnclosure found = TriangleDistance(tapered).certified(triangle);
        EXPECT_LE(found.distance.width(), kWidth * reach);
        EXPECT_LE(SignedDistance(tapered)(place, 0.0).width(), 1e-8 + kWidth * reach);  // inside as covers leave it
        for (const Point& corner : triangle)
          EXPECT_LE(found.distance.lo, std::max(0.0, SignedDistance(tapered)(corner, 0.0).hi));
      }
    }
  }
}

// Its edge at the widest section has the normals between those of both sides.
TEST(TaperedSolidTest, PointsBesideAnEdgeAreEnclosedTightly) {
  const Superquadric solid{{1.0, 0.5, 2.0}, {2.0, 1.0}, 0.25};  // the edge lies at z = 1.2 with the radius 0.64 a1
  const SignedDistance distance(model(solid));
  for (const double z : {1.2, 1.5, 1.0}) {
    const Enclosure found = distance({4.64, 0.0, z}, 0.0);
    expect_enclosed(found, std::hypot(4.0, z - 1.2), 1e-15);
  }
}

// There the difference of the point and its foot knows its direction to some digits alone.
TEST(TaperedSolidTest, PointsHardlyOffAFlatFaceAreEnclosedTightly) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  double widest = 0.0;
  for (const double e1 : {0.02, 0.05, 0.3, 2.0}) {
    for (const double taper : {2.0, 0.5, 15.0}) {
      const Superquadric solid{{0.9, 0.6, 0.3}, {e1, 2.0}, taper};
      const oracle::TaperedSolid known({"", solid, {}});
      const SignedDistance distance(model(solid));
      for (int i = 0; i < 60; ++i) {
        const oracle::KnownContact contact = known.contact({normal(random), normal(random), normal(random)}, 3e-9);
        const Enclosure found = distance(contact.query, 0.0);
        EXPECT_LE(found.lo, contact.upper) << described(solid);
        EXPECT_GE(found.hi, contact.lower) << described(solid);
        widest = std::max(widest, found.width());
      }
    }
  }
  fmt::print("largest width {:.2g}\n", widest);
  EXPECT_LE(widest, 2e-14);
}

}  // namespace
}  // namespace verisq
