/// Closest points of meshes and of unions with meshes: boxes that contain them, and when they are unique.
#include "verify/search/mesh_union.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

#include "tests/fixtures/random.hpp"
#include "tests/fixtures/sample_meshes.hpp"

namespace verisq::verify {
namespace {

using testing::Random;
using testing::sphere_mesh;

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

bool contains(const EnclosedPoint& box, const Point& point, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (point[i] < box[i].lo - tolerance || point[i] > box[i].hi + tolerance) return false;
  }
  return true;
}

double widest(const EnclosedPoint& box) {
  return std::max({box[0].width(), box[1].width(), box[2].width()});
}

struct Expected {
  Point query;
  Point closest;
  Point normal;
};

/// On a face, a side, a corner; and from inside.
TEST(MeshClosestPoint, IsProvenOnFacesSidesAndCorners) {
  const PosedMesh mesh(mesh_primitive("cube", cube()));
  const double third = 1.0 / std::sqrt(3.0);
  for (const auto& [query, closest, normal] :
       std::vector<Expected>{{{3.0, 0.25, 0.5}, {1.0, 0.25, 0.5}, {1.0, 0.0, 0.0}},
                             {{4.0, 5.0, 0.125}, {1.0, 1.0, 0.125}, {0.6, 0.8, 0.0}},
                             {{2.0, -2.0, 2.0}, {1.0, -1.0, 1.0}, {third, -third, third}},
                             {{0.5, 0.25, -0.75}, {0.5, 0.25, -1.0}, {0.0, 0.0, -1.0}}}) {
    const std::optional<ClosestPoint> found = closest_point(mesh, query);
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->unique);
    EXPECT_TRUE(contains(found->point, closest, 0.0));
    EXPECT_TRUE(contains(found->normal, normal, 1e-16));
    EXPECT_LE(widest(found->point), 1e-15);
    EXPECT_LE(widest(found->normal), 1e-15);
  }
}

TEST(MeshClosestPoint, IsNotUniqueWhereSeveralAreAsNear) {
  const PosedMesh mesh(mesh_primitive("cube", cube()));
  for (const Point& query : {Point{0.5, 0.5, 0.0}, Point{0.0, 0.0, 0.0}, Point{1.0, 0.25, 0.5}})
    EXPECT_FALSE(closest_point(mesh, query));
  Model two{"", {mesh_primitive("left", cube()), mesh_primitive("right", cube(), {.translation = {6.0, 0.0, 0.0}})}};
  EXPECT_FALSE(MeshUnion(two).closest_point({3.0, 0.25, 0.5})) << "in the middle between both";
  EXPECT_EQ(MeshUnion(two).closest_point({3.5, 0.25, 0.5})->primitive, 1U);
}

/// Samples of the surface are no nearer than the closest point, and the gradient is what small steps say.
TEST(MeshClosestPoint, AgreesWithSamplesInAnyPlace) {
  Random random(5);
  const Pose pose{.translation = {3.0, -1.0, 2.0}, .quaternion = {0.3, -0.7, 0.5, 0.9}};
  const PosedMesh mesh(mesh_primitive("ball", sphere_mesh(2), pose));
  int unique = 0;
  for (int n = 0; n < 200; ++n) {
    Point query = pose.translation;
    for (double& x : query) x += random.uniform(-2.0, 2.0);
    const std::optional<ClosestPoint> found = closest_point(mesh, query);
    if (!found) continue;
    ++unique;
    Point closest;
    for (std::size_t i = 0; i < 3; ++i) closest[i] = found->point[i].lo;
    const double distance = std::hypot(query[0] - closest[0], query[1] - closest[1], query[2] - closest[2]);
    EXPECT_NEAR(std::abs(found->distance.lo), distance, 1e-13);
    EXPECT_NEAR(mesh.signed_distance(closest).signed_distance.hi, 0.0, 1e-14) << "it lies on the surface";
    for (std::size_t i = 0; i < 3; ++i) {
      Point beside = query;
      beside[i] += 1e-6;
      const double slope = (mesh.signed_distance(beside).signed_distance.lo - found->distance.lo) * 1e6;
      EXPECT_NEAR(slope, found->normal[i].lo, 1e-4);
    }
  }
  EXPECT_GT(unique, 190);
}

TEST(MeshUnion, KnowsAWayOutOfOverlappingSolids) {
  const Model model{
      "", {mesh_primitive("left", cube()), mesh_primitive("right", cube(), {.translation = {1.0, 0.0, 0.0}})}};
  const MeshUnion solids(model);
  const auto found = solids({0.5, 0.25, 0.0}, 0.0, true, [] { return false; });
  EXPECT_LE(found.distance.lo, -0.75);
  EXPECT_GE(found.distance.lo, -0.75 - 1e-6) << "the way out in y is 0.75 long";
  EXPECT_LE(found.distance.hi, -0.5 + 1e-14) << "each alone is 0.5 deep";
  ASSERT_TRUE(found.certificate.escape);
  const Enclosure searched = solids({0.5, 0.25, 0.0}, 1e-3, false, [] { return false; }).distance;
  EXPECT_LE(searched.lo, -0.75);
  EXPECT_GE(searched.hi, -0.75);
  EXPECT_LE(searched.width(), 1e-3);
  for (const MeshUnion::Part& part : solids.meshes())
    EXPECT_GT(part.mesh.signed_distance(*found.certificate.escape).signed_distance.lo, 0.0);
}

bool never() {
  return false;
}

/// A mesh that crosses itself: inside, the nearest triangle may not belong to the boundary.
TEST(MeshClosestPoint, IsUnknownInsideWhereTrianglesCross) {
  Mesh beside = cube();
  for (Point& vertex : beside.vertices) vertex[0] += 1.0;
  const PosedMesh mesh(mesh_primitive("both", testing::join(cube(), beside)));
  EXPECT_FALSE(closest_point(mesh, {0.875, 0.25, 0.125})) << "the side of the other cube at x = 1 is nearest";
  EXPECT_TRUE(closest_point(mesh, {-1.5, 0.25, 0.125}));
}

TEST(MeshUnion, IsAsDeepAsItsDeepestPart) {
  const MeshUnion solids({"",
                          {mesh_primitive("left", cube()),
                           mesh_primitive("right", cube(), {.translation = {1.0, 0.0, 0.0}}),
                           {"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {.translation = {9.0, 0.0, 0.0}}}}});
  const auto inside = solids({0.875, 0.25, 0.125}, 0.0, true, never);
  EXPECT_LE(inside.distance.hi, -0.75 + 1e-14) << "of the right one, the left one is 0.125 deep";
  EXPECT_LE(inside.distance.lo, -0.75);
  EXPECT_FALSE(solids.closest_point({0.875, 0.25, 0.125})) << "inside of several";
  const auto beside_ball = solids({9.0, 3.0, 0.5}, 0.0, true, never);
  ASSERT_FALSE(beside_ball.certificate.normals.empty());
  for (const Normal& normal : beside_ball.certificate.normals) EXPECT_EQ(normal.primitive, 2U);
  EXPECT_EQ(solids.closest_point({9.0, 3.0, 0.5})->primitive, 2U);
}

/// A common point of touching solids may lie outside of each, as far as is known, where poses round. It is deep.
TEST(MeshUnion, CoversTheCommonFaceOfPosedSolids) {
  const MeshUnion solids({"",
                          {mesh_primitive("left", cube(), {.translation = {-1.0, 0.0, 0.0}}),
                           mesh_primitive("right", cube(), {.translation = {1.0, 0.0, 0.0}})}});
  const auto found = solids({0.0, 0.25, 0.0}, 0.0, true, never);
  EXPECT_LE(found.distance.lo, -0.75);
}

/// A point that is called a way out is proven to be outside, in any place.
TEST(MeshUnion, WaysOutLieOutside) {
  Random random(6);
  for (int n = 0; n < 20; ++n) {
    const auto pose = [&] {
      return Pose{random.point(0.5),
                  {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}};
    };
    const MeshUnion solids({"", {mesh_primitive("one", cube(), pose()), mesh_primitive("other", cube(), pose())}});
    const auto found = solids(random.point(0.25), 0.0, true, never);
    ASSERT_TRUE(found.certificate.escape);
    for (const MeshUnion::Part& part : solids.meshes())
      EXPECT_GT(part.mesh.signed_distance(*found.certificate.escape).signed_distance.lo, 0.0);
  }
}

}  // namespace
}  // namespace verisq::verify
