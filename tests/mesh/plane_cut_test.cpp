/// Meshes cut off at planes: what is kept, what is new, and that both sides make the whole.
#include <gtest/gtest.h>

#include <cmath>
#include <verisq/mesh_topology.hpp>

#include "tests/fixtures/sample_meshes.hpp"
#include "verify/proof/closed_surface.hpp"

namespace verisq {
namespace {

using verisq::testing::sphere_mesh;

double height(const Point& x, const Plane& plane) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) sum += (x[i] - plane.point[i]) * plane.normal[i];
  return sum;
}

Plane turned_round(Plane plane) {
  for (double& x : plane.normal) x = -x;
  return plane;
}

double area(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Point& a = mesh.vertices[i];
    const Point& b = mesh.vertices[j];
    const Point& c = mesh.vertices[k];
    const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const Point v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    sum += std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2.0;
  }
  return sum;
}

const Plane oblique{{0.1, 0.2, 0.15}, {0.6, -0.4, 1.3}};

TEST(PlaneCut, TakesNormalsOfAnyLength) {
  const Mesh whole = sphere_mesh(3);
  const CutMesh cut = cut_off(whole, oblique);
  for (const int exponent : {-1020, 1020}) {
    Plane same = oblique;
    for (double& x : same.normal) x = std::ldexp(x, exponent);
    EXPECT_EQ(cut_off(whole, same).mesh.vertices, cut.mesh.vertices) << exponent;
  }
}

TEST(PlaneCut, KeepsOneSide) {
  const Mesh whole = sphere_mesh(3);
  const CutMesh cut = cut_off(whole, oblique);
  ASSERT_EQ(cut.origin.size(), cut.mesh.vertices.size());
  for (std::size_t v = 0; v < cut.origin.size(); ++v) {
    EXPECT_LE(height(cut.mesh.vertices[v], oblique), 1e-15);
    EXPECT_LE(height(whole.vertices[cut.origin[v]], oblique), 0.0);
  }
  const MeshTopology topology = mesh_topology(cut.mesh);
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented());
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(verify::closing_over_rims(cut.mesh).rims, 1U);
}

TEST(PlaneCut, BothSidesMakeTheWhole) {
  const Mesh whole = sphere_mesh(3);
  EXPECT_NEAR(area(cut_off(whole, oblique).mesh) + area(cut_off(whole, turned_round(oblique)).mesh), area(whole),
              1e-12);
}

/// The equator's vertices lie in the plane: nothing is new.
TEST(PlaneCut, TakesVerticesInThePlaneAsTheyAre) {
  const Mesh whole = sphere_mesh(2);
  const CutMesh half = cut_off(whole, {{0.0, 0.0, 0.0}, {0.0, 0.0, 2.0}});
  EXPECT_EQ(half.mesh.triangles.size(), whole.triangles.size() / 2);
  for (std::size_t v = 0; v < half.origin.size(); ++v) EXPECT_EQ(half.mesh.vertices[v], whole.vertices[half.origin[v]]);
}

TEST(PlaneCut, LeavesAllOrNothing) {
  const Mesh whole = sphere_mesh(1);
  EXPECT_EQ(cut_off(whole, {{0.0, 0.0, 2.0}, {0.0, 0.0, 1.0}}).mesh.triangles, whole.triangles);
  EXPECT_TRUE(cut_off(whole, {{0.0, 0.0, 2.0}, {0.0, 0.0, -1.0}}).mesh.vertices.empty());
}

}  // namespace
}  // namespace verisq
