/// The checker proves distances of meshes to meshes and to superquadrics by itself, and nothing that is false.
/// VERISQ_MESH_PAIRS says how many pairs of each kind are tried.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/distance.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>
#include <verisq/path.hpp>

#include "tests/fixtures/mesh_scenes.hpp"
#include "tests/fixtures/random.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/sample_meshes.hpp"

namespace verisq {
namespace {

using testing::join;
using testing::moved;
using testing::Random;
using testing::sphere_mesh;
using testing::turned;

std::size_t count() {
  return oracle::requested_count("VERISQ_MESH_PAIRS", 60);
}

/// Multiples of 1/64, so that moves and mirrors are exact.
double coarse(double x) {
  return std::round(64.0 * x) / 64.0;
}

/// A tetrahedron in {z <= 0} with `touching` corners at z = 0, the origin among their means.
Mesh below_origin(Random& random, int touching) {
  Mesh mesh = testing::tetrahedron();
  for (std::size_t k = 0; k < 4; ++k) {
    for (double& x : mesh.vertices[k]) x = coarse(random.uniform(-8.0, 8.0));
    mesh.vertices[k][2] = static_cast<int>(k) < touching ? 0.0 : -1.0 - std::abs(mesh.vertices[k][2]);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    Point* const corners = mesh.vertices.data();
    if (touching == 1) corners[0][i] = 0.0;
    if (touching == 2) corners[1][i] = -corners[0][i];
    if (touching == 3) corners[2][i] = -corners[0][i] - corners[1][i];
  }
  return mesh;
}

/// The same above {z = gap}, whose faces are turned.
Mesh mirrored(Mesh mesh, double gap) {
  for (Point& vertex : mesh.vertices) vertex[2] = gap - vertex[2];
  return turned(std::move(mesh));
}

Model model_of(Mesh mesh, const Pose& pose = {}) {
  return {"", {mesh_primitive("mesh", std::move(mesh), pose)}};
}

Pose random_pose(Random& random, double reach) {
  Pose pose;
  for (double& x : pose.translation) x = random.uniform(-reach, reach);
  for (double& x : pose.quaternion) x = random.uniform(-1.0, 1.0);
  return pose;
}

struct KnownPair {
  Model a;
  Model b;
  double gap;
};

/// The features that are nearest are corners, sides and faces in turn.
KnownPair known_pair(Random& random, std::size_t n) {
  const double gap = std::exp2(std::round(random.uniform(-20.0, 4.0)));
  const Mesh a = below_origin(random, 1 + static_cast<int>(n % 3));
  const Mesh b = mirrored(below_origin(random, 1 + static_cast<int>(n / 3 % 3)), gap);
  return {model_of(a), model_of(b), gap};
}

TEST(MeshPairCertificate, EnclosesKnownDistancesTightly) {
  Random random(21);
  for (std::size_t n = 0; n < count(); ++n) {
    const auto [a, b, gap] = known_pair(random, n);
    for (const Enclosure& proven : {PairChecker(a, b).prove({}, {}), PairChecker(b, a).prove({}, {})}) {
      ASSERT_LE(proven.lo, gap) << n;
      ASSERT_GE(proven.hi, gap) << n;
      ASSERT_LE(proven.width(), 0x1p-51 * gap) << n;
    }
  }
}

/// By one unit in the last place, and by much: whatever the certificate says.
TEST(MeshPairCertificate, ProvesNoFalseClaim) {
  Random random(22);
  for (std::size_t n = 0; n < 5 * count(); ++n) {
    const auto [a, b, gap] = known_pair(random, n);
    const PairChecker checker(a, b);
    const double off = gap * std::exp2(std::round(random.uniform(-50.0, 3.0)));
    const Point anywhere{random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0)};
    const PairCertificate certificate{
        .separations = {{0, 0, {0.0, 0.0, 1.0}, {}, {}}}, .near_points = {{anywhere, anywhere}}, .common = anywhere};
    const Enclosure above{gap + off, gap + 2.0 * off};
    const Enclosure below{std::max(0.0, gap - 2.0 * off), std::max(0.0, gap - off)};
    ASSERT_NE(checker({}, above, certificate).verdict, Verdict::proved) << n;
    ASSERT_NE(checker({}, below, certificate).verdict, Verdict::proved) << n;
    ASSERT_NE(checker({}, {0.0, 0.0}, certificate).verdict, Verdict::proved) << n;
    ASSERT_EQ(checker({}, above, {}).verdict, Verdict::refuted) << n;
  }
}

std::vector<Model> solids() {
  const Primitive soap{"soap", {{0.8, 0.5, 1.25}, {0.4, 0.75}}, {.translation = {0.25, 0.0, 0.5}}};
  Mesh star = sphere_mesh(2);
  Random random(23);
  for (Point& vertex : star.vertices) {
    const double radius = random.uniform(0.5, 1.5);
    for (double& x : vertex) x *= radius;
  }
  const Pose turned{.translation = {0.1, -0.2, 0.3}, .quaternion = {0.8, 0.1, -0.5, 0.3}};
  return {model_of(sphere_mesh(2)),
          model_of(star, turned),
          {"", {soap}},
          {"", {mesh_primitive("ring", testing::torus_mesh(1.5, 0.25, 16, 8), turned), soap}}};
}

/// Both directions of a pair, apart and overlapping, agree with the search, which shares no code with the checker.
TEST(MeshPairCertificate, ProvesWhatTheSearchFinds) {
  Random random(24);
  const std::vector<Model> all = solids();
  std::size_t apart = 0;
  std::size_t meeting = 0;
  for (std::size_t n = 0; n < count(); ++n) {
    const Model& a = all[n % 4];
    const Model& b = all[n / 4 % 4];
    if (n % 4 == 2 && n / 4 % 4 == 2) continue;  // two superquadrics: another checker's
    const Pose pose = random_pose(random, n % 2 == 0 ? 3.0 : 1.0);
    const ModelSearch search(a, b);
    const SearchedDistance found = search(pose, {.tolerance = 0.0});
    const CertifiedDistance certified = search.certified(pose, found, {.tolerance = 0.0});
    const Finding finding = PairChecker(a, b)(pose, certified.distance, certified.certificate);
    ASSERT_EQ(finding.verdict, Verdict::proved) << n;
    ASSERT_LE(finding.proven.lo, found.distance.hi) << n;
    ASSERT_GE(finding.proven.hi, found.distance.lo) << n;
    ASSERT_LE(certified.distance.width(), 1e-11) << n;
    apart += certified.distance.lo > 0.0 ? 1 : 0;
    meeting += certified.distance.hi == 0.0 ? 1 : 0;
  }
  EXPECT_GT(apart, count() / 6);
  EXPECT_GT(meeting, count() / 6) << "a common point proves it";
}

TEST(MeshPairCertificate, ProvesThatOneHoldsTheOtherAndThatHollowsAreFree) {
  const Model large = model_of(sphere_mesh(2));
  const Model ball{"", {{"ball", {{0.25, 0.25, 0.25}, {1.0, 1.0}}, {}}}};
  for (const Model& small : {model_of(moved(sphere_mesh(1), 0.25)), ball}) {
    EXPECT_EQ(PairChecker(large, small).prove({}, {}), (Enclosure{0.0, 0.0}));
    EXPECT_EQ(PairChecker(small, large).prove({}, {}), (Enclosure{0.0, 0.0}));
  }
  const Model shell = model_of(join(moved(sphere_mesh(2), 2.0), turned(sphere_mesh(2))));
  for (const Model& small : {model_of(moved(sphere_mesh(1), 0.25)), ball}) {
    const Enclosure proven = PairChecker(shell, small).prove({}, {});
    EXPECT_GT(proven.lo, 0.6);
    EXPECT_LT(proven.hi, 0.76);
  }
}

/// The same triangles, whose corners are named from another one on.
Mesh named_from(Mesh mesh, std::size_t first) {
  for (auto& triangle : mesh.triangles)
    std::rotate(triangle.begin(), triangle.begin() + static_cast<std::ptrdiff_t>(first), triangle.end());
  return mesh;
}

/// A tetrahedron of these corners.
Mesh tetrahedron_of(const std::array<Point, 4>& corners) {
  return {{corners.begin(), corners.end()}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

struct TwoMeshes {
  Mesh a;
  Mesh b;
};

/// Each triangle of both, named from each of its corners on.
std::vector<Enclosure> proven_of_all_names(const TwoMeshes& pair) {
  std::vector<Enclosure> proven;
  for (std::size_t of_a = 0; of_a < 3; ++of_a) {
    for (std::size_t of_b = 0; of_b < 3; ++of_b) {
      const Model a = model_of(named_from(pair.a, of_a));
      const Model b = model_of(named_from(pair.b, of_b));
      proven.push_back(PairChecker(a, b).prove({}, {}));
      proven.push_back(PairChecker(b, a).prove({}, {}));
    }
  }
  return proven;
}

/// The last corner of B comes through a face of A, whose normal is no proof then.
TEST(MeshPairCertificate, CrossingTrianglesMeetWhicheverCornerIsNamedFirst) {
  for (const double depth : {0x1p-40, 0.125, 1.5}) {
    const TwoMeshes pair{
        tetrahedron_of({Point{-9.0, -8.0, 0.0}, {9.0, -7.0, 0.0}, {0.5, 10.0, 0.0}, {0.0, 0.0, -7.0}}),
        tetrahedron_of({Point{-2.0, -1.0, 3.0}, {2.0, -1.5, 4.0}, {0.5, 2.0, 5.0}, {0.25, 0.125, -depth}})};
    for (const Enclosure& proven : proven_of_all_names(pair)) EXPECT_EQ(proven, (Enclosure{0.0, 0.0})) << depth;
  }
}

/// The tip of a needle is the nearest, though the middle of the needle is not: a small solid beside it is nearer.
TEST(MeshPairCertificate, FindsTheTipOfANeedleBesideASmallSolid) {
  const Mesh floor = tetrahedron_of({Point{-9.0, -8.0, 0.0}, {9.0, -7.0, 0.0}, {0.5, 10.0, 0.0}, {0.0, 0.0, -7.0}});
  const Mesh needle = tetrahedron_of({Point{0.5, 0.0, 64.0}, {-0.5, 0.5, 64.0}, {-0.5, -0.5, 64.0}, {0.0, 0.0, 1.0}});
  const Mesh small = tetrahedron_of({Point{1.0, 0.0, 6.0}, {2.0, 1.0, 6.0}, {2.0, -1.0, 6.0}, {2.0, 0.0, 5.0}});
  const Model ball{"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {.translation = {0.0, 0.0, -1.0}}}}};
  for (const Enclosure& proven : proven_of_all_names({floor, join(needle, small)})) {
    EXPECT_LE(proven.lo, 1.0);
    EXPECT_GE(proven.hi, 1.0);
    EXPECT_LT(proven.width(), 1e-15);
  }
  for (std::size_t first = 0; first < 3; ++first) {
    const Enclosure proven = PairChecker(ball, model_of(named_from(join(needle, small), first))).prove({}, {});
    EXPECT_LE(proven.lo, 1.0);
    EXPECT_GE(proven.hi, 1.0);
    EXPECT_LT(proven.width(), 1e-12);
  }
}

/// The corner of a mesh just before a ball: neither a corner nor a common point that lies outside by 2^-11 proves more.
TEST(MeshPairCertificate, CornersAndCommonPointsJustOutsideOfABallAreOutside) {
  const Model ball{"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {.translation = {0.0, 0.0, -1.0}}}}};
  const Point tip{0.0, 0.0, 0x1p-11};
  const Model mesh = model_of(tetrahedron_of({Point{3.0, 0.0, 4.0}, {-3.0, 3.0, 4.0}, {-3.0, -3.0, 4.0}, tip}));
  const PairCertificate certificate{.common = tip};
  for (const PairChecker& checker : {PairChecker(ball, mesh), PairChecker(mesh, ball)}) {
    const Finding finding = checker({}, {0.0, 0.0}, certificate);
    EXPECT_NE(finding.verdict, Verdict::proved);
    EXPECT_LE(finding.proven.lo, 0x1p-11);
    EXPECT_GE(finding.proven.hi, 0x1p-11);
  }
}

/// A mesh that touches neither the origin nor the boundary of the ball that holds it.
TEST(MeshPairCertificate, MeetsTheBallThatHoldsIt) {
  const Model ball{"", {{"ball", {{4.0, 4.0, 4.0}, {1.0, 1.0}}, {}}}};
  const Model mesh = model_of(moved(sphere_mesh(1), 0.25), {.translation = {2.0, 0.0, 0.0}});
  EXPECT_EQ(PairChecker(ball, mesh).prove({}, {}), (Enclosure{0.0, 0.0}));
  EXPECT_EQ(PairChecker(mesh, ball).prove({}, {}), (Enclosure{0.0, 0.0}));
}

/// Where binary64 numbers lie 2 and 4 apart, middles of triangles are rounded down by more than small ones measure:
/// away from a wall above them, towards one below.
TEST(MeshPairCertificate, MiddlesOfTrianglesAreRoundedFarFromTheOrigin) {
  const Mesh large = tetrahedron_of({Point{1.0, 0.0, 0.0}, {-2.0, 2.0, 0.0}, {-2.0, -2.0, 1.0}, {-2.0, -1.0, -2.0}});
  const auto small = [](double tip, double base) {
    return tetrahedron_of({Point{tip, 5.0, 5.0}, {base, 5.125, 5.0}, {base, 5.0, 5.125}, {base, 4.9, 4.9}});
  };
  const auto wall = [](double face, double apex) {
    return tetrahedron_of({Point{face, -64.0, -64.0}, {face, 64.0, -64.0}, {face, 0.0, 64.0}, {apex, 0.0, 0.0}});
  };
  struct Case {
    double far;
    Mesh wall;
    Mesh beside;
    double gap;
  };
  for (const auto& [far, solid, beside, gap] :
       {Case{0x1p53, wall(0x1p53 + 4.0, 0x1p53 + 64.0), join(large, small(2.0, 1.875)), 2.0},
        Case{0x1p54, wall(0x1p54 - 8.0, 0x1p54 - 64.0), small(-3.0, -2.875), 5.0}}) {
    const Model a = model_of(solid);
    const Model b = model_of(beside, {.translation = {far, 0.0, 0.0}});
    for (const Enclosure& proven : {PairChecker(a, b).prove({}, {}), PairChecker(b, a).prove({}, {})}) {
      EXPECT_LE(proven.lo, gap);
      EXPECT_GE(proven.hi, gap);
      EXPECT_LT(proven.width(), 1e-14);
    }
  }
}

/// A triangle and its opposite: a closed mesh without an inside.
Mesh sheet_of(const Triangle& corners) {
  return {{corners.begin(), corners.end()}, {{0, 1, 2}, {1, 0, 2}}};
}

/// A side of B comes through A beside a side of A: without their last corners the way between the sides parts them.
TEST(MeshPairCertificate, EveryCornerCountsWhereSheetsCross) {
  for (const double beside : {0x1p-40, 0x1p-10, 0.5}) {
    const TwoMeshes pair{sheet_of({Point{0.0, 0.0, 0.0}, {4.0, 0.0, 0.0}, {2.0, 4.0, 0.0}}),
                         sheet_of({Point{2.0, beside, -1.0}, {2.0, beside, 1.0}, {2.25, 3.0, 0.5}})};
    for (const Enclosure& proven : proven_of_all_names(pair)) EXPECT_EQ(proven, (Enclosure{0.0, 0.0})) << beside;
  }
}

/// Closer than 127 bits tell, but apart: the side of B passes beside that of A by 2^-201, or the corner of B ends
/// 2^-200 before the face of A, or the side of B passes by a face of size 2^-200. An upper end is all that can be
/// proven.
TEST(MeshPairCertificate, WhatPassesCloselyDoesNotMeet) {
  const TwoMeshes side_beside_side{
      tetrahedron_of({Point{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {-1.0, -1.0, -1.0}}),
      tetrahedron_of({Point{1.0, 0.25, -1.0}, {0x1p-200, 0.75, 1.0}, {4.0, 4.0, 0.0}, {3.0, 5.0, 0.25}})};
  const TwoMeshes corner_before_face{
      tetrahedron_of({Point{3.0, -1.0, -2.0}, {0.0, 2.0, -2.0}, {0.0, -1.0, 1.0}, {-4.0, -5.0, -6.0}}),
      tetrahedron_of({Point{1.0, 0x1p-200, -1.0}, {7.0, 5.0, 4.0}, {6.0, 6.0, 4.0}, {6.0, 5.0, 5.0}})};
  const TwoMeshes side_beside_tiny_face{
      tetrahedron_of({Point{0.0, 0.0, 0.0}, {0x1p-200, 0.0, 0.0}, {0.0, 0x1p-200, 0.0}, {0.0, 0.0, -1.0}}),
      tetrahedron_of({Point{1.0, 0.0, -1.0}, {-1.0, 0x1p-190, 1.0}, {0.0, 3.0, 1.0}, {0.0, 3.0, -1.0}})};
  for (const TwoMeshes& pair : {side_beside_side, corner_before_face, side_beside_tiny_face}) {
    for (const Enclosure& proven : proven_of_all_names(pair)) {
      EXPECT_LT(proven.lo, 0x1p-190);
      EXPECT_GT(proven.hi, 0.0);
      EXPECT_LT(proven.hi, 0x1p-50);
    }
  }
}

TEST(MeshPairCertificate, SaysNothingOfPlacesAtTheEndOfAllNumbers) {
  const Model mesh = model_of(sphere_mesh(1));
  const Model ball{"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}}}};
  for (const Point& place : {Point{1e308, -1e308, 0.0}, Point{-1.7e308, 1.7e308, 1.7e308}}) {
    const Pose pose{.translation = place, .quaternion = {1.0, 2.0, 3.0, 4.0}};
    for (const Model& other : {mesh, ball}) {
      for (const Enclosure& proven :
           {PairChecker(mesh, other).prove(pose, {}), PairChecker(other, mesh).prove(pose, {})}) {
        EXPECT_LE(proven.lo, proven.hi);
        EXPECT_GE(proven.hi, 1e308);
      }
    }
  }
}

TEST(MeshPairCertificate, RefusesWhatItCannotProve) {
  const Model mesh = model_of(sphere_mesh(0));
  Primitive bent{"bent", {{0.5, 0.5, 2.0}, {1.0, 1.0}}, {}};
  bent.bend = Bend{0.2, 30.0};
  EXPECT_THROW(PairChecker(mesh, {"", {bent}}), Error);
  const SetExpression both{{{.primitive = 0}, {.primitive = 1}}, SetOperation::intersect};
  EXPECT_THROW(PairChecker(mesh, {"", {mesh.primitives[0], mesh.primitives[0]}, both}), Error);
}

/// Between two poses the lower end is that of the whole way.
TEST(MeshPathCertificate, ProvesTheWholeWayAndNoFalseClaim) {
  const Model a = model_of(moved(sphere_mesh(1), 0.5));
  const Model box{"", {{"box", {{0.5, 0.5, 0.5}, {0.1, 0.1}}, {}}}};
  const std::vector<Pose> beside{{.translation = {3.0, 2.0, 0.25}},
                                 {.translation = {-3.0, 2.0, 0.25}, .quaternion = {0.8, 0.0, 0.0, 0.6}}};
  for (const Model& b : {a, box}) {
    const PathDistanceOptions options{.tolerance = 0.1};
    const PathDistance found = distance_along(beside, a, b, options);
    const CertifiedPath certified = certified_path(beside, a, b, found, options);
    const PathChecker checker(a, b, beside);
    const PathClaims proven = checker.prove(certified.certificate, {});
    EXPECT_GT(proven.smallest.lo, found.smallest.lo - 0.1);
    EXPECT_LE(proven.smallest.lo, found.smallest.hi);
    EXPECT_GE(proven.smallest.hi, found.smallest.lo);
    ASSERT_GT(certified.certificate.parts.size(), 1U);
    PathCertificate cut = certified.certificate;
    cut.parts.resize(1);
    EXPECT_EQ(checker.prove(cut, {}).smallest.lo, 0.0) << "a part of the way is not proven";
    PathCertificate whole = certified.certificate;
    whole.parts = {{1.0, {}}};
    EXPECT_LE(checker.prove(whole, {}).smallest.lo, found.smallest.hi) << "by the longest way of any point";
  }
}

/// A rod turns about its middle until its end is close: the ends go farther than any other point.
TEST(MeshPathCertificate, EndsOfATurningRodGoFarthest) {
  Mesh rod = sphere_mesh(1);
  for (Point& vertex : rod.vertices) vertex = {4.0 * vertex[0], 0.25 * vertex[1], 0.25 * vertex[2]};
  const std::vector<Pose> turn{{}, {.translation = {}, .quaternion = {0.8, 0.0, 0.0, 0.6}}};
  const Pose before_end{.translation = {1.33, 4.56, 0.0}};  // in the direction that the end reaches
  const Model mesh_rod = model_of(rod);
  const Model solid_rod{"", {{"rod", {{4.0, 0.25, 0.25}, {1.0, 1.0}}, {}}}};
  for (const Model& b : {mesh_rod, solid_rod}) {
    const Model a = model_of(moved(sphere_mesh(1), 0.5), before_end);
    const PathDistance found = distance_along(turn, a, b, {.tolerance = 0.01});
    ASSERT_LT(found.smallest.hi, 0.5);
    PathCertificate whole;
    whole.parts = {{1.0, {}}};
    EXPECT_LE(PathChecker(a, b, turn).prove(whole, {}).smallest.lo, found.smallest.hi);
  }
}

// Triangles about models with meshes.

std::vector<Triangle> triangles_of(const Model& model) {
  const Mesh& mesh = *model.primitives[0].mesh;
  std::vector<Triangle> triangles;
  for (const auto& [i, j, k] : mesh.triangles)
    triangles.push_back({mesh.vertices[i], mesh.vertices[j], mesh.vertices[k]});
  return triangles;
}

/// What a checker proves of the nearest of B's triangles, which is as far as B.
TEST(MeshTriangleCertificate, EnclosesKnownDistancesTightlyAndProvesNoFalseClaim) {
  constexpr Enclosure anything{0.0, std::numeric_limits<double>::infinity()};
  Random random(25);
  for (std::size_t n = 0; n < 5 * count(); ++n) {
    const auto [a, b, gap] = known_pair(random, n);
    const Checker checker{UncertainModel(a)};
    Enclosure least = {anything.hi, anything.hi};
    for (const Triangle& triangle : triangles_of(b)) {
      const Enclosure proven = checker(triangle, anything, {}).proven;
      ASSERT_GE(proven.hi, gap) << n;
      least = {std::min(least.lo, proven.lo), std::min(least.hi, proven.hi)};
      const double off = gap * std::exp2(std::round(random.uniform(-50.0, 3.0)));
      const Certificate forged{{{0, {0.0, 0.0, 1.0}}}, Point{}, std::array{0.25, 0.5}, Point{}, {false}};
      ASSERT_NE(checker(triangle, {std::max(0.0, gap - 2.0 * off), std::max(0.0, gap - off)}, forged).verdict,
                Verdict::proved);
      ASSERT_NE(checker(triangle, {0.0, 0.0}, forged).verdict, Verdict::proved) << n;
      ASSERT_NE(checker(triangle, {proven.hi + off, proven.hi + 2.0 * off}, forged).verdict, Verdict::proved) << n;
    }
    ASSERT_LE(least.lo, gap) << n;
    ASSERT_LE(least.width(), 0x1p-51 * gap) << n;
  }
}

/// The checker shares no code with the search.
TEST(MeshTriangleCertificate, ProvesWhatTheSearchFinds) {
  Random random(26);
  std::size_t apart = 0;
  std::size_t meeting = 0;
  for (const Model& model : solids()) {
    if (!has_mesh(model)) continue;
    const TriangleSearch search(model);
    const Checker checker{UncertainModel(model)};
    for (std::size_t n = 0; n < 2 * count(); ++n) {
      Triangle triangle;
      const double size = std::exp2(random.uniform(-6.0, 2.0));
      for (Point& corner : triangle)
        for (double& x : corner) x = size * random.uniform(-1.0, 1.0);
      for (std::size_t i = 0; i < 3; ++i) {
        const double by = random.uniform(-2.5, 2.5);
        for (Point& corner : triangle) corner[i] += by;
      }
      const Enclosure found = search(triangle, 0.0);
      const auto [distance, certificate] = search.certified(triangle, 0.0);
      ASSERT_EQ(checker(triangle, distance, certificate).verdict, Verdict::proved) << n;
      ASSERT_LE(distance.lo, found.hi) << n;
      ASSERT_GE(distance.hi, found.lo) << n;
      ASSERT_LE(distance.width(), 1e-11) << n;
      const double off = 1e-9 + distance.hi / 8.0;
      ASSERT_NE(checker(triangle, {distance.hi + off, distance.hi + 2.0 * off}, certificate).verdict, Verdict::proved);
      if (distance.lo > 0.0) {
        ASSERT_NE(checker(triangle, {0.0, 0.5 * distance.lo}, certificate).verdict, Verdict::proved) << n;
      }
      apart += distance.lo > 0.0 ? 1 : 0;
      meeting += distance.hi == 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(apart, count());
  EXPECT_GT(meeting, count() / 2);
}

/// Within a solid, through its face, and exactly through an edge between two of its triangles.
TEST(MeshTriangleCertificate, MeetsWhatItEntersOrLiesIn) {
  const Model solid =
      model_of(tetrahedron_of({Point{-9.0, -8.0, 0.0}, {9.0, -8.0, 0.0}, {0.0, 10.0, 0.0}, {0.0, 0.0, -7.0}}));
  const Checker checker{UncertainModel(solid)};
  const TriangleSearch search(solid);
  const Triangle within{{{0.0, 0.0, -1.0}, {1.0, 0.0, -1.0}, {0.0, 1.0, -1.0}}};
  const Triangle through_face{{{0.5, 0.25, 3.0}, {0.25, 0.5, -20.0}, {40.0, 40.0, 3.0}}};
  const Triangle through_edge{{{0.0, -8.0, 4.0}, {0.0, -8.0, -4.0}, {0.0, -30.0, 0.0}}};
  for (const Triangle& triangle : {within, through_face, through_edge}) {
    EXPECT_EQ(search.certified(triangle, 0.0).distance, (Enclosure{0.0, 0.0}));
    EXPECT_EQ(checker(triangle, {0.0, 0.0}, {}).verdict, Verdict::proved);
    EXPECT_EQ(checker(triangle, {0x1p-1000, 1.0}, {}).verdict, Verdict::refuted);
  }
}

TEST(MeshTriangleCertificate, LeavesHollowsFreeAndPlacesAtTheEndOfAllNumbersOpen) {
  const Model shell = model_of(join(moved(sphere_mesh(2), 2.0), turned(sphere_mesh(2))));
  const Triangle in_hollow{{{0.25, 0.0, 0.0}, {0.0, 0.25, 0.0}, {0.0, 0.0, 0.25}}};
  const auto [distance, certificate] = TriangleSearch(shell).certified(in_hollow, 0.0);
  EXPECT_GT(distance.lo, 0.6);
  EXPECT_LT(distance.hi, 0.76);
  EXPECT_EQ(Checker{UncertainModel(shell)}(in_hollow, distance, certificate).verdict, Verdict::proved);
  const Triangle far{{{1e308, 0, 0}, {0, 1e308, 0}, {0, 0, -1e308}}};
  const Finding finding = Checker{UncertainModel(shell)}(far, {1.0, 2.0}, {});
  EXPECT_NE(finding.verdict, Verdict::proved);
}

}  // namespace
}  // namespace verisq
