/// Surfaces from clouds of known solids: closed, of the right genus and volume; holes, orientation, smoothing.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <set>
#include <utility>
#include <vector>
#include <verisq/surface.hpp>

#include "host/surface/surface_steps.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/sample_meshes.hpp"

namespace verisq {
namespace {

using testing::expect_error;
using testing::join;
using testing::sphere_mesh;
using testing::tetrahedron;

constexpr double ball_volume = 4.0 / 3.0 * std::numbers::pi;

/// The unit sphere, radii scattered by 0.5 %.
Mesh noisy_sphere(int points) {
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  Mesh cloud;
  for (int k = 0; k < points; ++k) {
    const Point p{normal(generator), normal(generator), normal(generator)};
    const double scale = (1.0 + 0.005 * normal(generator)) / std::hypot(p[0], p[1], p[2]);
    cloud.vertices.push_back({scale * p[0], scale * p[1], scale * p[2]});
  }
  return cloud;
}

/// Radii 3 and 1, evenly sampled with an irrational twist, so that no four neighbours are cocircular.
Mesh torus_cloud(int points) {
  Mesh cloud;
  for (int k = 0; k < points; ++k) {
    const double u = 2.0 * std::numbers::pi * k / points;
    const double v = 2.0 * std::numbers::pi * std::fmod(k * std::numbers::phi * 20.0, 1.0);
    const double from_axis = 3.0 + std::cos(v);
    cloud.vertices.push_back({from_axis * std::cos(u), from_axis * std::sin(u), std::sin(v)});
  }
  return cloud;
}

Mesh reversed(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  return mesh;
}

Mesh scaled(Mesh mesh, double factor) {
  for (Point& vertex : mesh.vertices)
    for (double& coordinate : vertex) coordinate *= factor;
  return mesh;
}

/// Root mean square of the ways from the vertices to the means of their neighbours.
double roughness(const Mesh& mesh) {
  std::vector<std::set<std::uint32_t>> neighbours(mesh.vertices.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    neighbours[a].insert({b, c});
    neighbours[b].insert({c, a});
    neighbours[c].insert({a, b});
  }
  double sum = 0.0;
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double mean = 0.0;
      for (const std::uint32_t neighbour : neighbours[k])
        mean += mesh.vertices[neighbour][axis] / static_cast<double>(neighbours[k].size());
      sum += (mean - mesh.vertices[k][axis]) * (mean - mesh.vertices[k][axis]);
    }
  }
  return std::sqrt(sum / static_cast<double>(mesh.vertices.size()));
}

void expect_solid(const Mesh& mesh, std::size_t components, std::int64_t genus) {
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_TRUE(topology.bounds_solid());
  EXPECT_EQ(topology.components, components);
  EXPECT_EQ(topology.genus(), genus);
}

// --- Alpha wrap ------------------------------------------------------------------------------------------------------

TEST(AlphaWrap, OfANoisySphere) {
  const Mesh cloud = noisy_sphere(2000);
  const PreparedSurface surface = prepare_surface(cloud, {.method = SurfaceMethod::wrap, .alpha = 0.2, .offset = 0.01});
  expect_solid(surface.mesh, 1, 0);
  const SurfaceCheck check = check_surface(surface.mesh, cloud.vertices);
  EXPECT_FALSE(check.self_intersecting);
  // It contains the points, and a triangle of circumradius alpha on the sphere sags by alpha^2/2 at most.
  EXPECT_GT(check.volume, ball_volume * std::pow(1.0 - 0.2 * 0.2 / 2.0, 3));
  // Outermost are the points three or four deviations out, and the offset.
  EXPECT_LT(check.volume, ball_volume * std::pow(1.0 + 4.0 * 0.005 + 0.01, 3));
  EXPECT_LT(check.farthest_point, 0.08);
}

TEST(AlphaWrap, ChoosesAnAlphaThatThePointsKeepOut) {
  const Mesh cloud = noisy_sphere(2000);
  const PreparedSurface surface = prepare_surface(cloud, {.method = SurfaceMethod::wrap});
  expect_solid(surface.mesh, 1, 0);
  EXPECT_NEAR(signed_volume(surface.mesh), ball_volume, 0.05 * ball_volume);
  ASSERT_TRUE(surface.alpha && surface.offset);
  EXPECT_DOUBLE_EQ(*surface.offset, *surface.alpha / 100.0);
  const double diagonal = 2.0 * std::sqrt(3.0);
  EXPECT_LT(*surface.alpha, 1.05 * diagonal / 20.0);
}

TEST(AlphaWrap, OfATorusHasAHandle) {
  const PreparedSurface surface = prepare_surface(torus_cloud(2000), {.method = SurfaceMethod::wrap, .alpha = 0.6});
  expect_solid(surface.mesh, 1, 1);
  const double torus_volume = 6.0 * std::numbers::pi * std::numbers::pi;
  EXPECT_NEAR(signed_volume(surface.mesh), torus_volume, 0.05 * torus_volume);
}

TEST(AlphaWrap, OfATriangleSoup) {
  Mesh soup = sphere_mesh(3);
  for (std::size_t k = 0; k < soup.triangles.size(); k += 3) std::swap(soup.triangles[k][0], soup.triangles[k][1]);
  soup.triangles.erase(soup.triangles.begin() + 100, soup.triangles.begin() + 104);
  soup.triangles.push_back(soup.triangles[7]);
  EXPECT_FALSE(mesh_topology(soup).bounds_solid());
  const PreparedSurface surface = prepare_surface(soup, {.method = SurfaceMethod::wrap, .alpha = 0.3});
  expect_solid(surface.mesh, 1, 0);
  EXPECT_NEAR(signed_volume(surface.mesh), ball_volume, 0.05 * ball_volume);
}

TEST(AlphaWrap, IsTheSameEachTime) {
  const Mesh cloud = noisy_sphere(500);
  const PreparedSurface first = prepare_surface(cloud, {.method = SurfaceMethod::wrap});
  const PreparedSurface second = prepare_surface(cloud, {.method = SurfaceMethod::wrap});
  EXPECT_EQ(first.mesh.vertices, second.mesh.vertices);
  EXPECT_EQ(first.mesh.triangles, second.mesh.triangles);
}

TEST(AlphaWrap, RefusesPointsThatCoincide) {
  const Mesh cloud{.vertices = {{1, 2, 3}, {1, 2, 3}}, .triangles = {}};
  expect_error([&] { (void)prepare_surface(cloud, {.method = SurfaceMethod::wrap}); }, ErrorKind::input,
               "all points coincide", ": there is nothing to wrap");
}

// --- Alpha shape -----------------------------------------------------------------------------------------------------

TEST(AlphaShape, OfANoisySphere) {
  const Mesh cloud = noisy_sphere(2000);
  const PreparedSurface surface = prepare_surface(cloud, {.method = SurfaceMethod::alpha_shape});
  expect_solid(surface.mesh, 1, 0);
  const SurfaceCheck check = check_surface(surface.mesh, cloud.vertices);
  EXPECT_FALSE(check.self_intersecting);
  EXPECT_NEAR(check.volume, ball_volume, 0.03 * ball_volume);
  EXPECT_LT(check.farthest_point, 0.05);  // the noise puts points under the surface of the others
}

TEST(AlphaShape, OfATorusGoesThroughAllPoints) {
  const Mesh cloud = torus_cloud(2000);
  const PreparedSurface surface = prepare_surface(cloud, {.method = SurfaceMethod::alpha_shape});
  expect_solid(surface.mesh, 1, 1);
  const double torus_volume = 6.0 * std::numbers::pi * std::numbers::pi;
  EXPECT_NEAR(surface.volume, torus_volume, 0.03 * torus_volume);
  EXPECT_NEAR(check_surface(surface.mesh, cloud.vertices).farthest_point, 0.0, 1e-12);
}

// Tetrahedra that share edges and vertices alone are what a small alpha leaves of a filled cloud.
TEST(AlphaShape, IsMadeManifold) {
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Point> cloud(300);
  for (Point& point : cloud) point = {uniform(generator), uniform(generator), uniform(generator)};
  for (const double alpha : {0.2, 0.25, 0.3}) {
    const surface::AlphaShape shape = surface::alpha_shape(cloud, alpha);
    const MeshTopology topology = mesh_topology(shape.mesh);
    EXPECT_TRUE(topology.bounds_solid()) << alpha;
    EXPECT_GT(signed_volume(shape.mesh), 0.0) << alpha;
    EXPECT_FALSE(check_surface(shape.mesh, cloud).self_intersecting) << alpha;
  }
}

TEST(AlphaShape, KeepsTheLargestComponent) {
  const Mesh small = scaled(sphere_mesh(2), 0.5);
  Mesh cloud = sphere_mesh(3);
  for (Point vertex : small.vertices) cloud.vertices.push_back({vertex[0] + 4.0, vertex[1], vertex[2]});
  const PreparedSurface surface = prepare_surface(cloud, {.method = SurfaceMethod::alpha_shape, .alpha = 1.1});
  expect_solid(surface.mesh, 1, 0);
  EXPECT_NEAR(surface.volume, ball_volume, 0.05 * ball_volume);
}

TEST(AlphaShape, RefusesWhatHasNoSolid) {
  const Mesh flat{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 3, 0}}, .triangles = {}};
  expect_error([&] { (void)prepare_surface(flat, {.method = SurfaceMethod::alpha_shape}); }, ErrorKind::input,
               "the points lie in one plane", ": they have no alpha shape that is a solid");
  expect_error([&] { (void)prepare_surface(tetrahedron(), {.method = SurfaceMethod::alpha_shape, .alpha = 0.125}); },
               ErrorKind::input, "alpha = 0.125", ": no tetrahedron of the points is as small as that");
}

// Two tetrahedra at a common edge, and two that fill the gaps on both sides of it: the smaller one is added.
TEST(Tetrahedra, BecomeManifoldByTheSmallestAddition) {
  const surface::Tetrahedra tetrahedra{.points = {{0, 0, -1}, {0, 0, 1}, {2, 0, 0}, {0, 1, 0}, {-2, 0, 0}, {0, -3, 0}},
                                       .corners = {{0, 1, 2, 3}, {0, 1, 3, 4}, {0, 1, 4, 5}, {0, 1, 5, 2}},
                                       .neighbours = {{surface::no_neighbour, surface::no_neighbour, 1, 3},
                                                      {surface::no_neighbour, surface::no_neighbour, 2, 0},
                                                      {surface::no_neighbour, surface::no_neighbour, 3, 1},
                                                      {surface::no_neighbour, surface::no_neighbour, 0, 2}},
                                       .circumradii = {1.0, 3.0, 1.0, 2.0}};
  surface::Solid solid{true, false, true, false};
  EXPECT_EQ(mesh_topology(boundary(tetrahedra, solid)).non_manifold_edges, 1U);
  EXPECT_GT(signed_volume(boundary(tetrahedra, solid)), 0.0);
  EXPECT_EQ(with_manifold_boundary(tetrahedra, solid), (surface::Solid{true, false, true, true}));
}

// --- Given meshes ----------------------------------------------------------------------------------------------------

TEST(GivenMesh, IsFilledWhereItHasHoles) {
  Mesh open = sphere_mesh(3);
  std::erase_if(open.triangles, [&](const auto& triangle) {
    const Point& p = open.vertices[triangle[0]];
    return p[2] > 0.8 || p[0] > 0.9;
  });
  EXPECT_FALSE(mesh_topology(open).closed());
  const PreparedSurface surface = prepare_surface(open, {.method = SurfaceMethod::given, .fill_holes = true});
  EXPECT_EQ(surface.holes, 2U);
  EXPECT_EQ(surface.holes_filled, 2U);
  expect_solid(surface.mesh, 1, 0);
  EXPECT_NEAR(surface.volume, signed_volume(sphere_mesh(3)), 0.03 * ball_volume);  // fairing rounds the caps
  const PreparedSurface left_open = prepare_surface(open, {.method = SurfaceMethod::given});
  EXPECT_FALSE(mesh_topology(left_open.mesh).closed());
  EXPECT_EQ(left_open.mesh.triangles.size(), open.triangles.size());
}

TEST(GivenMesh, IsTurnedOutward) {
  Mesh mesh = reversed(sphere_mesh(2));
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  const PreparedSurface surface = prepare_surface(mesh, {.method = SurfaceMethod::given});
  expect_solid(surface.mesh, 1, 0);
  EXPECT_DOUBLE_EQ(surface.volume, signed_volume(sphere_mesh(2)));
}

TEST(GivenMesh, KeepsTheCavitiesOfASolid) {
  const Mesh hollow = join(sphere_mesh(2), scaled(sphere_mesh(2), 0.5));
  const PreparedSurface surface = prepare_surface(hollow, {.method = SurfaceMethod::given});
  expect_solid(surface.mesh, 2, 0);
  EXPECT_NEAR(surface.volume, 0.875 * signed_volume(sphere_mesh(2)), 1e-12);
}

TEST(GivenMesh, NeedsTriangles) {
  expect_error([] { (void)prepare_surface(noisy_sphere(10), {.method = SurfaceMethod::given}); }, ErrorKind::input,
               "the mesh has no triangles", ": its points need a method, wrap or alpha");
}

// --- All of them -----------------------------------------------------------------------------------------------------

TEST(Facing, InwardFlipsTheVolumesSign) {
  const Mesh sphere = sphere_mesh(2);
  for (const SurfaceMethod method : {SurfaceMethod::given, SurfaceMethod::wrap, SurfaceMethod::alpha_shape}) {
    const PreparedSurface outward = prepare_surface(sphere, {.method = method, .alpha = 1.1});
    const PreparedSurface inward = prepare_surface(sphere, {.method = method, .alpha = 1.1, .facing = Facing::inward});
    EXPECT_GT(signed_volume(outward.mesh), 0.0);
    EXPECT_NEAR(signed_volume(inward.mesh), -signed_volume(outward.mesh), 1e-12);
    EXPECT_TRUE(mesh_topology(inward.mesh).bounds_solid());
    EXPECT_EQ(inward.volume, outward.volume);
  }
}

TEST(Smoothing, TakesRoughnessAndKeepsVolume) {
  std::mt19937 generator(3);
  std::normal_distribution<double> normal(1.0, 0.01);
  Mesh rough = sphere_mesh(4);
  for (Point& vertex : rough.vertices) {
    const double factor = normal(generator);
    for (double& coordinate : vertex) coordinate *= factor;
  }
  const PreparedSurface surface = prepare_surface(rough, {.method = SurfaceMethod::given, .smoothing_rounds = 30});
  const double of_the_sphere = roughness(sphere_mesh(4));  // its curvature, and edges that are not equally long
  EXPECT_LT(roughness(surface.mesh) - of_the_sphere, 0.1 * (roughness(rough) - of_the_sphere));
  EXPECT_EQ(surface.volume_before_smoothing, signed_volume(rough));
  EXPECT_NEAR(surface.volume, surface.volume_before_smoothing, 0.02 * surface.volume_before_smoothing);
  expect_solid(surface.mesh, 1, 0);
}

TEST(Smoothing, LeavesBordersWhereTheyAre) {
  Mesh open = sphere_mesh(3);
  std::erase_if(open.triangles, [&](const auto& triangle) { return open.vertices[triangle[0]][2] > 0.5; });
  const Mesh before = prepare_surface(open, {.method = SurfaceMethod::given}).mesh;
  const Mesh after = prepare_surface(open, {.method = SurfaceMethod::given, .smoothing_rounds = 5}).mesh;
  ASSERT_EQ(before.triangles, after.triangles);
  double highest_before = -1.0;
  double highest_after = -1.0;
  for (const Point& p : before.vertices) highest_before = std::max(highest_before, p[2]);
  for (const Point& p : after.vertices) highest_after = std::max(highest_after, p[2]);
  EXPECT_EQ(highest_before, highest_after);
}

TEST(Check, SeesSelfIntersectionsAndFarPoints) {
  Mesh crossing = join(tetrahedron(), tetrahedron());
  for (std::size_t k = 4; k < 8; ++k) crossing.vertices[k][0] += 0.25;
  const std::vector<Point> points{{0.5, 0.0, 0.0}, {0.0, 0.0, -3.0}};
  const SurfaceCheck check = check_surface(crossing, points);
  EXPECT_TRUE(check.self_intersecting);
  EXPECT_EQ(check.farthest_point, 3.0);
  EXPECT_EQ(check.topology.components, 2U);
  EXPECT_FALSE(check_surface(tetrahedron(), points).self_intersecting);
}

}  // namespace
}  // namespace verisq
