/// Distances of triangles to triangles, to meshes, and of whole solids: known ones, and those that samples bound.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>
#include <verisq/path.hpp>

#include "tests/fixtures/random.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "tests/oracle/exact_mesh.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/search/mesh_union.hpp"

namespace verisq::verify {
namespace {

using testing::Random;
using testing::sphere_mesh;

Triangle random_triangle(Random& random, double size) {
  Triangle triangle;
  for (Point& corner : triangle)
    for (double& x : corner) x = random.uniform(-size, size);
  return triangle;
}

/// Multiples of 1/64, so that moves and mirrors are exact.
double coarse(double x) {
  return std::round(64.0 * x) / 64.0;
}

/// A triangle in {z <= 0} with `touching` corners at z = 0, the last of them, or their middle, or their centre at 0.
Triangle below_origin(Random& random, int touching) {
  Triangle triangle = random_triangle(random, 8.0);
  for (std::size_t k = 0; k < 3; ++k) {
    for (double& x : triangle[k]) x = coarse(x);
    triangle[k][2] = static_cast<int>(k) < touching ? 0.0 : -1.0 - std::abs(triangle[k][2]);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (touching == 1) triangle[0][i] = 0.0;
    if (touching == 2) triangle[1][i] = -triangle[0][i];
    if (touching == 3) triangle[2][i] = -triangle[0][i] - triangle[1][i];
  }
  return triangle;
}

Triangle mirrored(Triangle triangle, double gap) {
  for (Point& corner : triangle) corner[2] = gap - corner[2];
  return triangle;
}

/// Corners to any axes, scaled by a power of two.
Triangle placed(const Triangle& triangle, std::size_t turn, double scale) {
  Triangle result;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) result[k][(i + turn) % 3] = scale * triangle[k][i];
  return result;
}

TEST(TrianglePair, EnclosesKnownDistancesOfAllFeatures) {
  Random random(11);
  for (int n = 0; n < 3000; ++n) {
    const int a = 1 + n % 3;
    const int b = 1 + n / 3 % 3;
    const double gap = std::exp2(std::round(random.uniform(-20.0, 6.0)));
    const auto turn = static_cast<std::size_t>(n % 3);
    const double scale = std::exp2(std::round(random.uniform(-30.0, 30.0)));
    const Triangle first = placed(below_origin(random, a), turn, scale);
    const Triangle second = placed(mirrored(below_origin(random, b), gap), turn, scale);
    for (const Enclosure& found : {distance_of_triangles(first, second), distance_of_triangles(second, first)}) {
      ASSERT_LE(found.lo, gap * scale) << n;
      ASSERT_GE(found.hi, gap * scale) << n;
      ASSERT_LE(found.width(), 1e-12 * (8.0 + gap) * scale) << n;
    }
  }
}

/// Samples of one triangle are no nearer than the lower end, and the nearest of a fine grid is hardly farther.
TEST(TrianglePair, AgreesWithSamples) {
  Random random(12);
  int meeting = 0;
  for (int n = 0; n < 300; ++n) {
    const Triangle a = random_triangle(random, 1.0);
    const Triangle b = random_triangle(random, n % 2 == 0 ? 1.0 : 2.0);
    const Enclosure found = distance_of_triangles(a, b);
    constexpr int steps = 40;
    double least = infinity;
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        Point point;
        for (std::size_t k = 0; k < 3; ++k)
          point[k] = a[0][k] + i * (a[1][k] - a[0][k]) / steps + j * (a[2][k] - a[0][k]) / steps;
        least = std::min(least, distance_from_triangle_up(point, b));
      }
    }
    meeting += found.hi == 0.0 ? 1 : 0;
    ASSERT_LE(found.lo, least) << n;
    ASSERT_GE(found.hi, least - 4.0 / steps) << n;
    ASSERT_LE(found.width(), 1e-12) << n;
  }
  EXPECT_GT(meeting, 20);
}

TEST(TrianglePair, ProvesThatTrianglesMeetOnlyWhereTheyDo) {
  const Triangle flat{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
  EXPECT_EQ(distance_of_triangles(flat, {{{1, 1, -1}, {1, 1, 1}, {5, 5, 5}}}), (Enclosure{0.0, 0.0}));
  EXPECT_GT(distance_of_triangles(flat, {{{3, 3, -1}, {3, 3, 1}, {5, 5, 5}}}).lo, 1.0) << "beside the long side";
  const double above = 0x1p-40;
  EXPECT_GT(distance_of_triangles(flat, {{{1, 1, above}, {2, 1, above}, {1, 2, above}}}).lo, 0.5 * above);
}

Point along(const Point& from, const Point& direction, double way) {
  return {from[0] + way * direction[0], from[1] + way * direction[1], from[2] + way * direction[2]};
}

Point outer(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Three directions at right angles, to rounding.
std::array<Point, 3> random_frame(Random& random) {
  const auto unit = [](Point x) {
    const double size = std::hypot(x[0], x[1], x[2]);
    for (double& coordinate : x) coordinate /= size;
    return x;
  };
  const Point first = unit(random.point(1.0));
  const Point second = unit(outer(first, random.point(1.0)));
  return {first, second, unit(outer(first, second))};
}

/// Corners are rounded, and the distance of the rounded ones is not that of the construction: integers know it.
TEST(TrianglePair, EnclosesTheExactDistanceOfACornerToAFace) {
  Random random(17);
  for (int n = 0; n < 2000; ++n) {
    const auto [x, y, up] = random_frame(random);
    const Point foot = random.point(8.0);
    const double gap = std::exp2(random.uniform(-30.0, 0.0));
    const Triangle face{along(along(foot, x, -3.0), y, -2.0), along(along(foot, x, 4.0), y, -2.0), along(foot, y, 5.0)};
    const Point corner = along(foot, up, gap);
    const Triangle above{corner, along(along(corner, up, 1.5), x, 1.0), along(along(corner, up, 2.0), y, 1.0)};
    const oracle::Fraction exact = oracle::ExactMesh(std::array<Triangle, 1>{face}).squared_distance(corner);
    EXPECT_TRUE(holds_root(distance_of_triangles(face, above), exact)) << n;
    EXPECT_TRUE(holds_root(distance_of_triangles(above, face), exact)) << n;
    const WideTree tree({above});
    EXPECT_TRUE(holds_root(distance_of_triangles(std::array<Triangle, 1>{face}, tree, {}), exact)) << n;
    EXPECT_EQ(distance_of_triangles(std::array<Triangle, 1>{face}, tree, [] { return true; }).lo, 0.0);
  }
}

/// The same of two sides, in numbers of 64 bits, whose own error is far below what rounding to 53 bits hides.
TEST(TrianglePair, EnclosesTheExactDistanceOfTwoSides) {
  using Long = std::array<long double, 3>;
  const auto way = [](const Point& from, const Point& to) {
    return Long{(long double)to[0] - from[0], (long double)to[1] - from[1], (long double)to[2] - from[2]};
  };
  Random random(18);
  for (int n = 0; n < 2000; ++n) {
    const auto [x, y, up] = random_frame(random);
    const Point foot = random.point(8.0);
    const Point head = along(foot, up, std::exp2(random.uniform(-30.0, 0.0)));
    const Triangle below{along(foot, x, -3.0), along(foot, x, 4.0), along(foot, up, -2.0)};
    const Triangle above{along(head, y, -4.0), along(head, y, 3.0), along(head, up, 2.0)};
    const Long a = way(below[0], below[1]);
    const Long b = way(above[0], above[1]);
    const Long apart = way(below[0], above[0]);
    const Long normal{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    const long double exact = std::abs(normal[0] * apart[0] + normal[1] * apart[1] + normal[2] * apart[2]) /
                              std::hypot(normal[0], normal[1], normal[2]);
    constexpr long double error = 0x1p-57L;
    for (const Enclosure& found : {distance_of_triangles(below, above), distance_of_triangles(above, below)}) {
      EXPECT_LE(found.lo, exact + error) << n;
      EXPECT_GE(found.hi, exact - error) << n;
    }
  }
}

/// In one plane, or tilted across it by little: no normal of theirs parts them, and the way between them is rounded too
/// much. Sides that pass through the other's plane pass beside the other.
TEST(TrianglePair, DoesNotMeetBesideInOnePlane) {
  Random random(21);
  const double gap = 0x1p-30;
  for (int n = 0; n < 500; ++n) {
    const double angle = random.uniform(0.1, 1.4);
    const Point x{std::cos(angle), std::sin(angle), 0.0};
    const Point y{-x[1], x[0], 0.0};
    const Point foot{random.uniform(-8, 8), random.uniform(-8, 8), 0.0};
    const auto at = [&](double u, double v, double height) {
      return along(along(along(foot, x, u), y, v), {0.0, 0.0, 1.0}, height);
    };
    const double tilt = n % 2 == 0 ? 0.0 : 0x1p-52;
    const Triangle flat{at(0, -3, 0), at(0, 4, 0), at(-5, 0.5, 0)};
    const Triangle beside{at(gap, random.uniform(-2, 3), tilt), at(4, 2, -tilt), at(5, -3, tilt)};
    EXPECT_GE(distance_of_triangles(flat, beside).hi, 0.99 * gap) << n;
    EXPECT_GE(distance_of_triangles(beside, flat).hi, 0.99 * gap) << n;
  }
}

TEST(MeshTriangleDistance, KnowsTrianglesOutsideAcrossAndInside) {
  const Model model{"", {mesh_primitive("ball", sphere_mesh(3), {.translation = {10.0, 0.0, 0.0}})}};
  const MeshTriangleDistance distance(model);
  const Enclosure outside = distance({{{13, -1, -1}, {13, 1, -1}, {13, 0, 2}}});
  EXPECT_GE(outside.lo, 2.0 - 1e-12);
  EXPECT_LE(outside.hi, 2.02);
  EXPECT_LE(outside.width(), 1e-12);
  EXPECT_EQ(distance({{{10, 0, 0}, {10.1, 0, 0}, {10, 0.1, 0}}}), (Enclosure{0.0, 0.0})) << "inside";
  EXPECT_EQ(distance({{{10, 0, 0}, {13, 0, 0}, {13, 1, 0}}}), (Enclosure{0.0, 0.0})) << "a corner inside";
  const Enclosure across = distance({{{10, -9, -9}, {10, 9, -9}, {10, 0, 20}}});
  EXPECT_LE(across.hi, 1e-12) << "all corners outside";
}

double gap_of_balls(const Point& centre) {
  return std::hypot(centre[0], centre[1], centre[2]) - 2.0;
}

/// Polyhedra inscribed in balls of radius 1 are a little farther apart than these.
TEST(MeshPairDistance, IsThatOfTheSolids) {
  Random random(13);
  const Model a{"", {mesh_primitive("a", sphere_mesh(3))}};
  const Model b{"", {mesh_primitive("b", sphere_mesh(2))}};
  const MeshPairDistance distance(a, b);
  for (int n = 0; n < 50; ++n) {
    Pose pose;
    for (double& x : pose.translation) x = random.uniform(-3.0, 3.0);
    for (double& x : pose.quaternion) x = random.uniform(-1.0, 1.0);
    const double gap = gap_of_balls(pose.translation);
    const SearchedDistance found = distance.searched(pose, {.tolerance = 0.0});
    EXPECT_TRUE(found.reached);
    if (gap > 0.0) {
      EXPECT_GE(found.distance.hi, gap);
      EXPECT_LE(found.distance.lo, gap + 0.1);
      EXPECT_EQ(found.proximity, Proximity::separated);
    }
    if (gap < -0.1) {
      EXPECT_EQ(found.proximity, Proximity::overlapping) << gap;
    }
  }
}

TEST(MeshPairDistance, IsZeroWhereOneHoldsTheOther) {
  Mesh small = sphere_mesh(1);
  for (Point& vertex : small.vertices)
    for (double& x : vertex) x *= 0.25;
  const Model large{"", {mesh_primitive("large", sphere_mesh(2))}};
  const Model within{"", {mesh_primitive("small", small)}};
  const Model ball{"", {{"ball", {{0.25, 0.25, 0.25}, {1.0, 1.0}}, {}}}};
  for (const Model& other : {within, ball}) {
    EXPECT_EQ(MeshPairDistance(large, other).searched({}, {.tolerance = 0.0}).proximity, Proximity::overlapping);
    EXPECT_EQ(MeshPairDistance(other, large).searched({}, {.tolerance = 0.0}).proximity, Proximity::overlapping);
  }
}

/// A shell with a hollow: what lies in the hollow is apart from it.
TEST(MeshPairDistance, LeavesHollowsFree) {
  Mesh inner = sphere_mesh(2);
  for (auto& triangle : inner.triangles) std::swap(triangle[1], triangle[2]);
  Mesh outer = sphere_mesh(2);
  for (Point& vertex : outer.vertices)
    for (double& x : vertex) x *= 2.0;
  const Model shell{"", {mesh_primitive("shell", testing::join(outer, inner))}};
  Mesh small = sphere_mesh(1);
  for (Point& vertex : small.vertices)
    for (double& x : vertex) x *= 0.25;
  const SearchedDistance found =
      MeshPairDistance(shell, {"", {mesh_primitive("small", small)}}).searched({}, {.tolerance = 0.0});
  EXPECT_EQ(found.proximity, Proximity::separated);
  EXPECT_GT(found.distance.lo, 0.6);
  EXPECT_LT(found.distance.hi, 0.76);
}

TEST(MeshPairDistance, JoinsAllPrimitivesOfBothModels) {
  const Primitive ball{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {.translation = {0.0, 5.0, 0.0}}};
  const Model a{"", {mesh_primitive("mesh", sphere_mesh(2)), ball}};
  const SearchedDistance found = MeshPairDistance(a, a).searched({.translation = {3.0, -5.5, 0.0}}, {.tolerance = 0.0});
  const double nearest = std::hypot(3.0, 0.5) - 2.0;  // of the ball of the one to the mesh of the other
  EXPECT_LE(found.distance.lo, nearest + 0.1);
  EXPECT_GE(found.distance.hi, nearest);
  const SearchedDistance of_balls =
      MeshPairDistance({"", {mesh_primitive("far", sphere_mesh(0), {.translation = {0.0, -50.0, 0.0}}), ball}}, a)
          .searched({.translation = {2.5, 0.25, 0.0}}, {.tolerance = 1e-6});
  EXPECT_NEAR(of_balls.distance.lo, std::hypot(2.5, 0.25) - 2.0, 1e-6);
  EXPECT_NEAR(of_balls.distance.hi, std::hypot(2.5, 0.25) - 2.0, 1e-6);
}

TEST(MeshPairDistance, SaysNothingOfPlacesAtTheEndOfAllNumbers) {
  const Model mesh{"", {mesh_primitive("mesh", sphere_mesh(1))}};
  const Model ball{"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}}}};
  for (const Point& place : {Point{1e308, -1e308, 0.0}, Point{-1.7e308, 1.7e308, 1.7e308}, Point{1e200, 0.0, 0.0}}) {
    const Pose pose{.translation = place, .quaternion = {1.0, 2.0, 3.0, 4.0}};
    for (const Model& other : {mesh, ball}) {
      const SearchedDistance found = MeshPairDistance(mesh, other).searched(pose, {.tolerance = 0.0});
      EXPECT_EQ(found.distance, (Enclosure{0.0, infinity}));
      EXPECT_EQ(found.proximity, Proximity::undecided);
    }
  }
  EXPECT_EQ(MeshTriangleDistance(mesh)({{{1e308, 0, 0}, {0, 1e308, 0}, {0, 0, -1e308}}}), (Enclosure{0.0, infinity}));
}

TEST(MeshPairDistance, AnswersForSuperquadrics) {
  const Model mesh{"", {mesh_primitive("ball", sphere_mesh(3))}};
  const Model box{"", {{"box", {{1.0, 2.0, 3.0}, {0.1, 0.1}}, {}}}};
  for (const double x : {3.0, 2.5, 2.25}) {
    const SearchedDistance found =
        MeshPairDistance(mesh, box).searched({.translation = {x, 0.0, 0.0}}, {.tolerance = 0.0});
    EXPECT_NEAR(found.distance.lo, x - 2.0, 1e-12);
    EXPECT_NEAR(found.distance.hi, x - 2.0, 1e-12);
    const SearchedDistance turned =
        MeshPairDistance(box, mesh).searched({.translation = {-x, 0.0, 0.0}}, {.tolerance = 0.0});
    EXPECT_NEAR(turned.distance.lo, x - 2.0, 1e-12);
  }
}

/// The surface of [-1, 1]^3.
Mesh cube() {
  Mesh mesh;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) mesh.vertices.push_back({x, y, z});
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return mesh;
}

Mesh tetrahedron_of(const std::array<Point, 4>& corners) {
  Mesh mesh = testing::tetrahedron();
  mesh.vertices.assign(corners.begin(), corners.end());
  return mesh;
}

/// The tip of long triangles is nearest, their middle is far; a smaller part of the mesh is hardly farther.
TEST(MeshPairDistance, FindsTipsOfLongTriangles) {
  const Mesh needle = tetrahedron_of({{{1.5, 0, 0}, {41, -1, -1}, {41, 1, -1}, {41, 0, 1}}});
  const Mesh small = tetrahedron_of({{{-1.625, 0, 0}, {-3, 1, -1}, {-3, -1, -1}, {-3, 0, 1}}});
  const Model tips{"", {mesh_primitive("tips", testing::join(small, needle))}};
  const Model box{"", {mesh_primitive("box", cube())}};
  const Model ball{"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}}}};
  for (const Model& other : {box, ball}) {
    for (const Enclosure& found : {MeshPairDistance(tips, other).searched({}, {.tolerance = 0.0}).distance,
                                   MeshPairDistance(other, tips).searched({}, {.tolerance = 0.0}).distance}) {
      EXPECT_NEAR(found.lo, 0.5, 1e-12);
      EXPECT_NEAR(found.hi, 0.5, 1e-12);
      EXPECT_LE(found.lo, 0.5);
      EXPECT_GE(found.hi, 0.5);
    }
  }
}

Triangle moved_by(const RigidMotion& motion, Triangle triangle) {
  for (Point& corner : triangle) {
    const Vector3<double> exact = in_binary64(motion(precise(corner)));
    for (std::size_t i = 0; i < 3; ++i) corner[i] = exact[i].lower();
  }
  return triangle;
}

/// Beside all pairs of triangles, for solids without symmetry that are placed in their models, too.
TEST(MeshPairDistance, IsThatOfAllPairsOfTriangles) {
  Random random(19);
  const auto random_pose = [&](double reach) {
    const Point place = random.point(reach);
    return Pose{place, {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}};
  };
  const auto random_solid = [&](int rounds) {
    Mesh mesh = rounds == 0 ? testing::tetrahedron() : sphere_mesh(rounds);
    for (Point& vertex : mesh.vertices) vertex = along(vertex, vertex, random.uniform(0.0, 3.0));
    return mesh;
  };
  int apart = 0;
  for (int n = 0; n < 40; ++n) {
    const Model a{"", {mesh_primitive("a", random_solid(n % 2), random_pose(3.0))}};
    const Model b{"", {mesh_primitive("b", random_solid(1 - n % 2), random_pose(3.0))}};
    const Pose pose = random_pose(12.0);
    const Primitive& first = a.primitives[0];
    const Primitive& second = b.primitives[0];
    Enclosure least{infinity, infinity};
    for (const Triangle& x : triangles_of(*first.mesh)) {
      const Triangle here = moved_by(RigidMotion(first.pose), x);
      for (const Triangle& y : triangles_of(*second.mesh)) {
        const Triangle there = moved_by(RigidMotion(pose).after(RigidMotion(second.pose)), y);
        const Enclosure found = distance_of_triangles(here, there);
        least = {std::min(least.lo, found.lo), std::min(least.hi, found.hi)};
      }
    }
    const Enclosure found = MeshPairDistance(a, b).searched(pose, {.tolerance = 0.0}).distance;
    if (!(found.lo > 0.0)) continue;
    ++apart;
    EXPECT_NEAR(found.lo, least.lo, 1e-11) << n;
    EXPECT_NEAR(found.hi, least.hi, 1e-11) << n;
  }
  EXPECT_GT(apart, 20);
}

/// A corner 2^30 from the origin is moved by 1e-7 where a pose turns it: the exact place is known in 64 bits.
TEST(MeshPairDistance, HoldsWhatAPoseRounds) {
  Random random(20);
  const long double far = 0x1p30L;
  for (int n = 0; n < 20; ++n) {
    const double angle = random.uniform(0.2, 1.2);  // of the quaternion: half of the turn about z
    const Pose pose{{}, {std::cos(angle), 0.0, 0.0, std::sin(angle)}};
    const long double w = pose.quaternion[0];
    const long double z = pose.quaternion[3];
    const long double c = (w * w - z * z) / (w * w + z * z);
    const long double s = 2 * w * z / (w * w + z * z);
    const Point corner{0x1p30 + random.uniform(0, 1), 0x1p28 + random.uniform(0, 1), 0.0};
    const Point ahead{static_cast<double>(c), static_cast<double>(-s), 0.0};  // is turned to x
    const Point aside{static_cast<double>(s), static_cast<double>(c), 0.0};
    const Point base = along(corner, ahead, 5.0);
    const Mesh tip =
        tetrahedron_of({corner, along(base, aside, -1.0), along(base, aside, 1.0), along(base, {0.0, 0.0, 1.0}, 1.0)});
    const long double x = c * corner[0] - s * corner[1];
    const auto y = static_cast<double>(s * corner[0] + c * corner[1]);
    const double face = std::floor(static_cast<double>(x));
    const Mesh wall = tetrahedron_of({{{face - 9, y, 0}, {face, y - 9, -9}, {face, y + 9, -9}, {face, y, 9}}});
    const Model ball{"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {.translation = {face - 1.0, y, 0.0}}}}};
    constexpr long double error = 0x1p-30L;
    ASSERT_LT(std::abs(x), 2 * far);
    for (const Model& other : {Model{"", {mesh_primitive("wall", wall)}}, ball}) {
      const Model turned{"", {mesh_primitive("tip", tip)}};
      const Enclosure found = MeshPairDistance(other, turned).searched(pose, {.tolerance = 0.0}).distance;
      // The ball: y is off by as much as 2^-23, which adds nothing to speak of beside 1.
      EXPECT_LE(found.lo, x - face + error) << n;
      EXPECT_GE(found.hi, x - face - error) << n;
    }
  }
}

/// One part of a surface lies outside of the other solid, and a later one within it.
TEST(MeshPairDistance, AsksEveryPartOfASurface) {
  Mesh far = testing::tetrahedron();
  for (Point& vertex : far.vertices) vertex = along(vertex, {10.0, 0.0, 0.0}, 1.0);
  Mesh small = testing::tetrahedron();
  for (Point& vertex : small.vertices)
    for (double& x : vertex) x *= 0.25;
  const Model parts{"", {mesh_primitive("parts", testing::join(far, small))}};
  const Model box{"", {mesh_primitive("box", cube())}};
  EXPECT_EQ(MeshPairDistance(parts, box).searched({}, {.tolerance = 0.0}).proximity, Proximity::overlapping);
  EXPECT_EQ(MeshPairDistance(box, parts).searched({}, {.tolerance = 0.0}).proximity, Proximity::overlapping);
}

/// So near that the lower end of a corner's distance is 0: nothing is claimed.
TEST(MeshPairDistance, SaysNothingOfCornersThatAlmostTouch) {
  const Mesh solid = tetrahedron_of({{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}}});
  const double least = 0x1p-51;
  const Point corner{1.5 + least, 1.5 + least, 1.0};  // above the plane of all x + y + z = 4
  const Triangle above{corner, along(corner, {1, 2, 2}, 1.0), along(corner, {2, 1, 2}, 1.0)};
  const Mesh tip = tetrahedron_of({above[0], above[1], above[2], along(corner, {2, 2, 1}, 1.0)});
  const Model a{"", {mesh_primitive("solid", solid)}};
  const Model b{"", {mesh_primitive("tip", tip)}};
  const double gap = 1.1 * least;  // 2 / sqrt 3 of it
  EXPECT_GE(MeshPairDistance(a, b).searched({}, {.tolerance = 0.0}).distance.hi, gap);
  EXPECT_GE(MeshPairDistance(b, a).searched({}, {.tolerance = 0.0}).distance.hi, gap);
  EXPECT_GE(MeshTriangleDistance(a)(above).hi, gap);
}

/// The middle of a triangle is rounded, by 2^-22 here: where it lies in the ball, the triangle may still not.
TEST(MeshPairDistance, SaysNothingOfMiddlesThatRoundingMoves) {
  Random random(22);
  const double gap = 0x1p-30;
  const double place = 1.75 * 0x1p30;
  for (int n = 0; n < 200; ++n) {
    const std::array<double, 3> d{std::floor(random.uniform(0, 0x1p27)) * 0x1p-22,
                                  std::floor(random.uniform(0, 0x1p27)) * 0x1p-22,
                                  std::floor(random.uniform(0, 0x1p27)) * 0x1p-22};
    // A triangle in the plane x + y = 2 place.
    const Mesh wall = tetrahedron_of({{{place + d[0], place - d[0], -1},
                                       {place + d[1], place - d[1], -1},
                                       {place + d[2], place - d[2], 2},
                                       {place - 99, place - 99, 0}}});
    const double middle = std::floor((d[0] + d[1] + d[2]) / 3 * 0x1p22) * 0x1p-22;
    const double aside = 0.75;  // along x and along y
    const double radius = std::sqrt(2.0) * aside - gap;
    const Point centre{place + middle + aside, place - middle + aside, 0.0};
    const Model ball{"", {{"ball", {{radius, radius, radius}, {1, 1}}, {.translation = centre}}}};
    const Model solid{"", {mesh_primitive("wall", wall)}};
    EXPECT_GE(MeshPairDistance(solid, ball).searched({}, {.tolerance = 0.0}).distance.hi, 0.99 * gap) << n;
  }
}

/// Whoever moves one solid by that much leaves them meeting.
TEST(MeshPairDistance, DepthIsNoMoreThanTheyOverlap) {
  const auto never = [] { return false; };
  const Model box{"", {mesh_primitive("box", cube())}};
  const double depth = MeshPairDistance(box, box)({.translation = {1.5, 0.0, 0.0}}, never).depth;
  EXPECT_LE(depth, 0.5);
  EXPECT_GE(depth, 0.5 - 1e-12);
  const Model ball{"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}}}};
  Mesh beside = cube();
  for (Point& vertex : beside.vertices) vertex[0] += 1.75;
  const double in_ball = MeshPairDistance({"", {mesh_primitive("beside", beside)}}, ball)({}, never).depth;
  EXPECT_LE(in_ball, 1.0 - std::sqrt(0.75L * 0.75L + 2.0L / 9.0L));  // of the middles of the face's triangles
  EXPECT_GT(in_ball, 0.0);
  // The middle of a sheet is 0.6 deep in the union of two balls.
  const Mesh sheet{.vertices = {{0.8, -1, -1}, {0.8, 1, -1}, {0.8, 0, 2}}, .triangles = {{0, 1, 2}, {1, 0, 2}}};
  Model balls = ball;
  balls.primitives.push_back({"other", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {.translation = {1.6, 0.0, 0.0}}});
  const double in_balls = MeshPairDistance({"", {mesh_primitive("sheet", sheet)}}, balls)({}, never).depth;
  EXPECT_LE(in_balls, 0.6);
  EXPECT_GT(in_balls, 0.0);
}

TEST(MeshPath, EnclosesTheSmallestDistanceAndTheFirstContact) {
  const Model a{"", {mesh_primitive("a", cube())}};
  const Model box{"", {{"box", {{1.0, 1.0, 1.0}, {0.1, 0.1}}, {}}}};
  for (const Model& b : {a, box}) {
    const std::vector<Pose> beside{{.translation = {5.0, 4.0, 0.25}}, {.translation = {-5.0, 4.0, 0.25}}};
    const PathDistance past = distance_along(beside, a, b, {.tolerance = 0.02});
    EXPECT_EQ(past.proximity, PathProximity::apart);
    EXPECT_TRUE(past.reached);
    EXPECT_LE(past.smallest.lo, 2.0);
    EXPECT_GE(past.smallest.hi, 2.0);
    const std::vector<Pose> towards{{.translation = {5.0, 0.0, 0.0}}, {.translation = {1.0, 0.0, 0.0}}};
    const PathDistance met = distance_along(towards, a, b, {.tolerance = 1e-6, .time_tolerance = 1e-4});
    ASSERT_TRUE(met.meet_at);
    EXPECT_LE(met.apart_before, 0.75);
    EXPECT_GE(*met.meet_at, 0.75);
    EXPECT_LE(*met.meet_at - met.apart_before, 1e-4);
  }
}

}  // namespace
}  // namespace verisq::verify
