/// The topology of meshes made by hand: what is closed, manifold and oriented, and what is not.
#include <gmock/gmock.h>

#include <optional>
#include <verisq/mesh_topology.hpp>

#include "host/prepare/mesh_geometry.hpp"
#include "tests/fixtures/sample_meshes.hpp"

namespace verisq {
namespace {

using ::testing::ElementsAre;
using testing::join;
using testing::tetrahedron;
using testing::torus_mesh;

TEST(MeshTopology, OfATetrahedron) {
  const MeshTopology topology = mesh_topology(tetrahedron());
  EXPECT_EQ(topology.vertices, 4U);
  EXPECT_EQ(topology.edges, 6U);
  EXPECT_EQ(topology.triangles, 4U);
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.euler_characteristic(), 2);
  EXPECT_EQ(topology.genus(), 0);
  EXPECT_TRUE(topology.bounds_solid());
}

TEST(MeshTopology, OfATorus) {
  const Mesh torus = torus_mesh(3.0, 1.0, 12, 7);
  const MeshTopology topology = mesh_topology(torus);
  EXPECT_TRUE(topology.bounds_solid());
  EXPECT_EQ(topology.euler_characteristic(), 0);
  EXPECT_EQ(topology.genus(), 1);
  EXPECT_GT(signed_volume(torus), 0.0);
}

TEST(MeshTopology, OfTwoComponents) {
  const MeshTopology topology = mesh_topology(join(tetrahedron(), torus_mesh(3.0, 1.0, 8, 5)));
  EXPECT_EQ(topology.components, 2U);
  EXPECT_EQ(topology.euler_characteristic(), 2);
  EXPECT_EQ(topology.genus(), 1);
  EXPECT_TRUE(topology.bounds_solid());
}

TEST(MeshTopology, OfAnOpenMesh) {
  Mesh mesh = tetrahedron();
  mesh.triangles.pop_back();
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_FALSE(topology.closed());
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented());
  EXPECT_EQ(topology.boundary_edges, 3U);
  EXPECT_EQ(topology.euler_characteristic(), 1);
  EXPECT_EQ(topology.genus(), std::nullopt);
}

TEST(MeshTopology, OfAFlippedTriangle) {
  Mesh mesh = tetrahedron();
  std::swap(mesh.triangles[2][0], mesh.triangles[2][1]);
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_TRUE(topology.manifold());
  EXPECT_FALSE(topology.oriented());
  EXPECT_EQ(topology.inconsistent_edges, 3U);
}

// Two tetrahedra on both sides of a common edge, their corners 0 and 1.
TEST(MeshTopology, OfANonManifoldEdge) {
  Mesh mesh = tetrahedron();
  mesh.vertices.push_back({-1.0, -2.0, 0.0});
  mesh.vertices.push_back({0.0, -2.0, -1.0});
  for (auto triangle : tetrahedron().triangles) {
    for (std::uint32_t& vertex : triangle) vertex = vertex < 2 ? vertex : vertex + 2;
    mesh.triangles.push_back(triangle);
  }
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_FALSE(topology.manifold());
  EXPECT_EQ(topology.non_manifold_edges, 1U);
  EXPECT_EQ(topology.non_manifold_vertices, 2U);
  EXPECT_THAT(non_manifold_vertices(mesh), ElementsAre(0U, 1U));
  EXPECT_EQ(topology.components, 1U);
}

// Two tetrahedra that share their corner 0 alone.
TEST(MeshTopology, OfABowTie) {
  Mesh mesh = join(tetrahedron(), tetrahedron());
  for (auto& triangle : mesh.triangles)
    for (std::uint32_t& vertex : triangle) vertex = vertex == 4 ? 0 : vertex;
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_TRUE(topology.oriented());
  EXPECT_FALSE(topology.manifold());
  EXPECT_EQ(topology.non_manifold_edges, 0U);
  EXPECT_EQ(topology.non_manifold_vertices, 1U);
  EXPECT_THAT(non_manifold_vertices(mesh), ElementsAre(0U));
  EXPECT_EQ(topology.vertices, 7U);
  EXPECT_EQ(topology.components, 2U);
}

// An open fan around a vertex is one fan: the rim of a mesh is manifold; two fans are not.
TEST(MeshTopology, OfOpenFans) {
  Mesh mesh{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}},
            .triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}};
  EXPECT_TRUE(mesh_topology(mesh).manifold());
  mesh.triangles.erase(mesh.triangles.begin() + 1);
  EXPECT_EQ(mesh_topology(mesh).non_manifold_vertices, 1U);
}

TEST(MeshTopology, OfNothingIsNotClosed) {
  const Mesh points{.vertices = {{0, 0, 0}}, .triangles = {}};
  EXPECT_FALSE(mesh_topology(points).closed());
  EXPECT_EQ(mesh_topology(points).vertices, 0U);
  EXPECT_EQ(signed_volume(points), 0.0);
}

TEST(SignedVolume, FollowsTheOrientationAndNotThePlace) {
  Mesh mesh = tetrahedron();
  EXPECT_DOUBLE_EQ(signed_volume(mesh), 1.0 / 6.0);
  for (Point& vertex : mesh.vertices) vertex[0] += 1048576.0;
  EXPECT_DOUBLE_EQ(signed_volume(mesh), 1.0 / 6.0);
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_DOUBLE_EQ(signed_volume(mesh), -1.0 / 6.0);
}

/// Of the smallest ones the volume is 0, of the largest ones infinite.
TEST(SignedVolume, HasASignAtEverySize) {
  for (const double size : {5e-324, 1e-200, 1e-110, 1.0, 1e110, 1e200, 1e308}) {
    Mesh mesh = tetrahedron();
    for (Point& vertex : mesh.vertices) {
      for (double& x : vertex) x *= size;
    }
    EXPECT_EQ(volume_sign(mesh), 1) << size;
    EXPECT_EQ(volume_sign(mesh, {size, size, size}), 1) << size;
    for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
    EXPECT_EQ(volume_sign(mesh), -1) << size;
  }
  EXPECT_EQ(volume_sign({}), 0);
}

}  // namespace
}  // namespace verisq
