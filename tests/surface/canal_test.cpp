/// Canals of bones whose canal is known: balls within balls, cortices that thicken with the height, open bones.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <verisq/mesh_topology.hpp>
#include <verisq/surface.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/sample_meshes.hpp"

namespace verisq {
namespace {

using testing::expect_error;
using testing::sphere_mesh;

Mesh ball(double radius, int refinements = 4) {
  Mesh mesh = sphere_mesh(refinements);
  for (Point& vertex : mesh.vertices)
    for (double& coordinate : vertex) coordinate *= radius;
  return mesh;
}

double ball_volume(double radius) {
  return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

/// How far linear interpolation along an edge of the lattice may be off: a ball of this radius sags, a thickness that
/// changes by `slope` from here on is met halfway, and no vertex comes nearer to a sample than a fiftieth of the edge.
double interpolation_error(double spacing, double radius, double slope) {
  const double edge = std::numbers::sqrt3 * spacing;
  return edge * edge / (8.0 * radius) + slope * edge / 4.0 + (1.0 + slope) * edge / 50.0;
}

TEST(Canals, OfABallAreASmallerBall) {
  const Mesh bone = ball(20.0, 5);
  const CorticalThickness thickness{.at = {{0.0, 5.0}}};
  const Canal canal = canal_of(bone, {.thickness = thickness, .spacing = 1.0});
  const MeshTopology topology = mesh_topology(canal.mesh);
  EXPECT_TRUE(topology.bounds_solid());
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.genus(), 0);
  EXPECT_EQ(canal.parts_left_out, 0U);
  EXPECT_NEAR(signed_volume(canal.mesh), ball_volume(15.0), 0.01 * ball_volume(15.0));
  const WallCheck wall = check_wall(canal.mesh, bone, thickness);
  EXPECT_LT(wall.largest_error, interpolation_error(1.0, 15.0, 0.0));
  EXPECT_NEAR(wall.mean, 5.0, 0.02);
}

TEST(Canals, KeepToAThicknessThatChangesWithTheHeight) {
  const CorticalThickness thickness{.at = {{-10.0, 8.0}, {10.0, 3.0}}, .axis = {0.0, 2.0, 0.0}};
  EXPECT_DOUBLE_EQ(thickness({1.0, -30.0, 5.0}), 8.0);
  EXPECT_DOUBLE_EQ(thickness({1.0, 6.0, 5.0}), 4.0);
  EXPECT_DOUBLE_EQ(thickness({1.0, 11.0, 5.0}), 3.0);
  const Mesh bone = ball(20.0);
  const Canal canal = canal_of(bone, {.thickness = thickness, .spacing = 1.0});
  EXPECT_TRUE(mesh_topology(canal.mesh).bounds_solid());
  const WallCheck wall = check_wall(canal.mesh, bone, thickness);
  EXPECT_LT(wall.largest_error, interpolation_error(1.0, 12.0, 0.25));
  EXPECT_NEAR(wall.least, 3.0, interpolation_error(1.0, 12.0, 0.25));
  EXPECT_NEAR(wall.largest, 8.0, interpolation_error(1.0, 12.0, 0.25));
}

/// What is skipped because a cube's middle decides it must not be seen.
TEST(Canals, AreTheSameWhateverIsSampled) {
  const Mesh bone = ball(20.0);
  const CorticalThickness steep{.at = {{-1.0, 12.0}, {1.0, 1.0}}};  // changes faster than the point moves
  const Canal canal = canal_of(bone, {.thickness = steep, .spacing = 1.0});
  EXPECT_LT(check_wall(canal.mesh, bone, steep).largest_error, interpolation_error(1.0, 8.0, 5.5));
  EXPECT_TRUE(mesh_topology(canal.mesh).bounds_solid());
}

TEST(Canals, OfAnOpenBoneReachItsRim) {
  const Mesh bone = cut_off(ball(20.0), {{0.0, 0.0, -8.0}, {0.0, 0.0, -1.0}}).mesh;
  const Canal canal = canal_of(bone, {.thickness = {.at = {{0.0, 4.0}}}, .spacing = 1.0});
  EXPECT_TRUE(mesh_topology(canal.mesh).bounds_solid());
  EXPECT_EQ(canal.rims_closed, 1U);
  const double lowest = std::ranges::min_element(canal.mesh.vertices, {}, [](const Point& x) { return x[2]; })->at(2);
  EXPECT_NEAR(lowest, -8.0, 0.05);
  // The ball of 16 without a cap of height 8.
  const double cap = std::numbers::pi * 64.0 * (16.0 - 8.0 / 3.0);
  EXPECT_NEAR(signed_volume(canal.mesh), ball_volume(16.0) - cap, 0.02 * ball_volume(16.0));
}

TEST(Canals, AreOpenedAtAPlaneByOneRim) {
  const Canal canal = canal_of(ball(20.0), {.thickness = {.at = {{0.0, 5.0}}}, .spacing = 1.0});
  const PreparedSurface surface = prepare_surface(canal.mesh, {.method = SurfaceMethod::given,
                                                               .opening = Plane{{0.0, 0.0, 9.0}, {0.0, 0.0, 3.0}},
                                                               .edge = 1.5,
                                                               .facing = Facing::inward});
  const SurfaceCheck check = check_surface(surface.mesh, {});
  EXPECT_TRUE(check.topology.manifold());
  EXPECT_TRUE(check.topology.oriented());
  EXPECT_EQ(check.rims, 1U);
  EXPECT_FALSE(check.self_intersecting);
  for (const Point& x : surface.mesh.vertices) EXPECT_LE(x[2], 9.0 + 1e-12);
  EXPECT_LT(signed_volume(surface.mesh, {0.0, 0.0, 0.0}), 0.0);
  expect_error(
      [&] {
        (void)prepare_surface(canal.mesh,
                              {.method = SurfaceMethod::given, .opening = Plane{{0.0, 0.0, -90.0}, {0.0, 0.0, 1.0}}});
      },
      ErrorKind::input, "", "all of the surface lies beyond the plane where it is to be opened");
}

TEST(Canals, OfABoneThatNarrowsAreTheLargestPart) {
  Mesh bone = testing::join(ball(12.0, 4), ball(8.0, 4));
  for (std::size_t v = bone.vertices.size() / 2; v < bone.vertices.size(); ++v) bone.vertices[v][2] += 30.0;
  const Canal canal = canal_of(bone, {.thickness = {.at = {{0.0, 3.0}}}, .spacing = 1.0});
  EXPECT_EQ(canal.parts_left_out, 1U);
  EXPECT_NEAR(signed_volume(canal.mesh), ball_volume(9.0), 0.03 * ball_volume(9.0));
}

TEST(Canals, NeedABoneThickerThanTwoCortices) {
  expect_error(
      [] {
        (void)canal_of(ball(4.0, 3), {.thickness = {.at = {{0.0, 5.0}}}, .spacing = 0.5});
      },
      ErrorKind::input, "", "nothing is left of the bone: it is nowhere thicker than two cortices");
  expect_error(
      [] {
        (void)canal_of(Mesh{{{0, 0, 0}}, {}}, {.thickness = {.at = {{0.0, 5.0}}}});
      },
      ErrorKind::input, "", "the bone has no triangles: a canal needs its surface");
  expect_error(
      [] {
        (void)canal_of(ball(4.0, 3), {.thickness = {.at = {{0.0, 1.0}}}, .spacing = 1e-4});
      },
      ErrorKind::input, "", "a spacing of 0.0001: more than 1000000000 samples of the bone's box");
  Mesh three_at_an_edge = ball(4.0, 3);
  three_at_an_edge.triangles.push_back({three_at_an_edge.triangles[0][0], three_at_an_edge.triangles[0][1], 200});
  expect_error(
      [&] {
        (void)canal_of(three_at_an_edge, {.thickness = {.at = {{0.0, 1.0}}}, .spacing = 0.5});
      },
      ErrorKind::input, "",
      "the bone has no inside: more than two triangles meet at 1 of its edges (verisq surface --method wrap mends "
      "that)");
}

}  // namespace
}  // namespace verisq
