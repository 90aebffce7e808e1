/// On which side of a surface a primitive lies: boxes, balls and tubes where the answer is known, and closed surfaces
/// against the winding numbers of their solid angles.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/plan/clearance.hpp"
#include "host/plan/primitive_projection.hpp"
#include "host/plan/requirements.hpp"
#include "host/prepare/eigen_points.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/random.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verisq/clearance.hpp"
#include "verisq/distance.hpp"

namespace verisq {
namespace {

using ::testing::ElementsAre;
using verisq::testing::expect_error;
using verisq::testing::join;
using verisq::testing::Random;
using verisq::testing::sphere_mesh;
using verisq::testing::torus_mesh;

Mesh turned_round(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  return mesh;
}

Mesh scaled(Mesh mesh, double factor) {
  for (Point& vertex : mesh.vertices)
    for (double& x : vertex) x *= factor;
  return mesh;
}

/// Where products of three coordinates underflow or overflow, too.
TEST(Facing, IsToldAtEverySize) {
  for (const double size : {1e-300, 1e-110, 1e-3, 1e110, 1e300}) {
    EXPECT_EQ(facing_of(scaled(sphere_mesh(2), size)), 1) << size;
    EXPECT_EQ(facing_of(scaled(turned_round(sphere_mesh(2)), size)), -1) << size;
  }
  EXPECT_EQ(facing_of({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}}), std::nullopt) << "it is flat";
}

/// Of a sphere the triangles below a height: an open bowl.
Mesh bowl(double height) {
  Mesh mesh = sphere_mesh(3);
  std::erase_if(mesh.triangles, [&](const auto& corners) {
    return std::ranges::any_of(corners, [&](std::uint32_t v) { return mesh.vertices[v][2] > height; });
  });
  return mesh;
}

std::optional<int> winding(const Point& point, const Mesh& mesh) {
  return verify::ClosedSurface(verify::closed_triangles(mesh, verify::closing_over_rims(mesh))).winding_number(point);
}

/// The sum of the triangles' solid angles over 4 pi (Van Oosterom and Strackee, The solid angle of a plane triangle,
/// 1983), to nearest.
double winding_by_angles(const Point& point, const Mesh& mesh) {
  const auto from_point = [&](std::uint32_t v) {
    const Point& x = mesh.vertices[v];
    return Point{x[0] - point[0], x[1] - point[1], x[2] - point[2]};
  };
  const auto dot = [](const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  double sum = 0.0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Point a = from_point(i);
    const Point b = from_point(j);
    const Point c = from_point(k);
    const double la = std::sqrt(dot(a, a));
    const double lb = std::sqrt(dot(b, b));
    const double lc = std::sqrt(dot(c, c));
    const Point bc{b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]};
    sum += 2.0 * std::atan2(dot(a, bc), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4.0 * std::numbers::pi);
}

TEST(WindingNumber, IsThatOfTheSolidAngles) {
  const std::vector<Mesh> meshes{sphere_mesh(2),
                                 turned_round(sphere_mesh(1)),
                                 torus_mesh(1.0, 0.4, 24, 12),
                                 join(sphere_mesh(2), turned_round(scaled(sphere_mesh(1), 0.5))),
                                 join(sphere_mesh(2), scaled(sphere_mesh(1), 0.5)),
                                 bowl(0.3)};
  Random random(1);
  for (const Mesh& mesh : meshes) {
    Mesh closed = mesh;
    const verify::Closing closing = verify::closing_over_rims(mesh);
    if (closing.rims > 0) closed = join(mesh, closing.mesh);
    for (int i = 0; i < 60; ++i) {
      const Point point{random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3)};
      const double by_angles = winding_by_angles(point, closed);
      ASSERT_NEAR(by_angles, std::round(by_angles), 1e-6);
      EXPECT_EQ(winding(point, mesh), static_cast<int>(std::round(by_angles)));
    }
  }
}

TEST(WindingNumber, IsOpenOnTheSurface) {
  const Mesh mesh = sphere_mesh(1);
  for (const Point& vertex : mesh.vertices) EXPECT_EQ(winding(vertex, mesh), std::nullopt);
  for (const auto& [a, b, c] : verify::triangles_of(mesh)) {
    const Point middle{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
    EXPECT_THAT(winding(middle, mesh), ::testing::AnyOf(std::optional<int>(0), std::optional<int>(1), std::nullopt));
  }
}

/// The rays of the directions pass exactly through vertices and edges.
TEST(WindingNumber, IsKnownWhereRaysMeetVertices) {
  const Mesh box{
      .vertices = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, 1}},
      .triangles = {{0, 2, 1},
                    {1, 2, 3},
                    {4, 5, 6},
                    {5, 7, 6},
                    {0, 1, 4},
                    {1, 5, 4},
                    {2, 6, 3},
                    {3, 6, 7},
                    {0, 4, 2},
                    {2, 4, 6},
                    {1, 3, 5},
                    {3, 7, 5}}};
  const Point first{0.0123, 0.0217, 1.0};  // along the segment that is tried first
  const Point below{1 - first[0], 1 - first[1], 1 - first[2]};
  EXPECT_EQ(winding(below, box), 1);
  EXPECT_EQ(winding({1 + first[0], 1 + first[1], 1 + first[2]}, box), 0);
  EXPECT_EQ(winding({1 - 4 * first[0], 1 - 4 * first[1], 1 - 4 * first[2]}, box), 0);
}

TEST(InsideTest, AgreesWithTheProof) {
  Random random(2);
  for (const Mesh& mesh : {sphere_mesh(3), torus_mesh(1.0, 0.4, 24, 12), bowl(0.3), turned_round(sphere_mesh(2))}) {
    const fit_search::InsideTest inside(mesh);
    for (int i = 0; i < 100; ++i) {
      const Point point{random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3)};
      EXPECT_EQ(inside(point), winding(point, mesh) != 0);
    }
  }
}

TEST(ClosingOverRims, ClosesEveryRim) {
  EXPECT_EQ(verify::closing_over_rims(sphere_mesh(1)).rims, 0U);
  EXPECT_EQ(verify::closing_over_rims(bowl(0.3)).rims, 1U);
  Mesh tube = bowl(0.5);
  std::erase_if(tube.triangles, [&](const auto& corners) {
    return std::ranges::any_of(corners, [&](std::uint32_t v) { return tube.vertices[v][2] < -0.5; });
  });
  const verify::Closing closing = verify::closing_over_rims(tube);
  EXPECT_EQ(closing.rims, 2U);
  EXPECT_EQ(closing.mesh.triangles.size(), closing.edges);
  Mesh closed{closing.mesh.vertices, tube.triangles};
  closed.triangles.insert(closed.triangles.end(), closing.mesh.triangles.begin(), closing.mesh.triangles.end());
  EXPECT_EQ(verify::closing_over_rims(closed).rims, 0U);
}

Primitive ellipsoid(const Point& centre, const Point& semi_axes) {
  return {"part", {semi_axes, {1.0, 1.0}}, {centre}, {}};
}

std::vector<SideFinding> findings(const Model& model, const Mesh& surface, const std::vector<SurfaceSide>& required,
                                  double limit = 0.0) {
  return prove_sides(model, surface, required, limit).of_primitives;
}

SideFinding finding(const Primitive& primitive, const Mesh& surface, SurfaceSide required, double limit = 0.0) {
  return findings({"", {primitive}, {}}, surface, {required}, limit).front();
}

constexpr Point small{0.2, 0.2, 0.2};

TEST(Sides, TellsInsideFromOutside) {
  for (const Mesh& surface : {sphere_mesh(3), turned_round(sphere_mesh(3))}) {
    EXPECT_EQ(finding(ellipsoid({0.1, 0.2, 0.3}, small), surface, SurfaceSide::inside), SideFinding::kept);
    EXPECT_EQ(finding(ellipsoid({0.1, 0.2, 0.3}, small), surface, SurfaceSide::outside), SideFinding::other_side);
    EXPECT_EQ(finding(ellipsoid({0.1, 0.2, 1.5}, small), surface, SurfaceSide::inside), SideFinding::other_side);
    EXPECT_EQ(finding(ellipsoid({0.1, 0.2, 1.5}, small), surface, SurfaceSide::outside), SideFinding::kept);
  }
}

TEST(Sides, IsNotProvenWhereTheSurfaceIsEntered) {
  const Primitive through = ellipsoid({0.0, 0.0, 0.9}, small);
  EXPECT_EQ(finding(through, sphere_mesh(3), SurfaceSide::inside), SideFinding::enters_surface);
  EXPECT_EQ(finding(through, sphere_mesh(3), SurfaceSide::any), SideFinding::kept);
  EXPECT_EQ(finding(ellipsoid({0.0, 0.0, 0.7}, small), sphere_mesh(3), SurfaceSide::inside), SideFinding::kept);
}

/// Within the limit of penetration: what lies deeper than that is inside, and there must be such points.
TEST(Sides, LeavesWhatTheLimitAllows) {
  const Primitive through = ellipsoid({0.0, 0.0, 0.85}, small);
  EXPECT_EQ(finding(through, sphere_mesh(4), SurfaceSide::inside, 0.15), SideFinding::kept);
  EXPECT_EQ(finding(ellipsoid({0.0, 0.0, 0.5}, small), sphere_mesh(4), SurfaceSide::inside, 0.25),
            SideFinding::no_deep_point);
}

TEST(Sides, KeepsOffTheOpenings) {
  const Mesh open = bowl(0.3);
  EXPECT_EQ(finding(ellipsoid({0.0, 0.0, -0.2}, small), open, SurfaceSide::inside), SideFinding::kept);
  EXPECT_EQ(finding(ellipsoid({0.0, 0.0, 0.1}, {0.2, 0.2, 0.4}), open, SurfaceSide::inside),
            SideFinding::reaches_through);
  EXPECT_EQ(finding(ellipsoid({0.0, 0.0, 0.7}, small), open, SurfaceSide::inside), SideFinding::other_side);
  EXPECT_EQ(finding(ellipsoid({0.0, 0.0, 0.7}, small), open, SurfaceSide::outside), SideFinding::kept);
}

TEST(Sides, AreThoseOfEachPrimitive) {
  const Model implant{"",
                      {ellipsoid({0.0, 0.0, -0.3}, small), ellipsoid({0.0, 0.0, 0.2}, {0.1, 0.1, 0.5}),
                       ellipsoid({0.0, 0.0, 0.9}, small)},
                      {}};
  const Mesh open = bowl(0.3);
  EXPECT_THAT(findings(implant, open, {SurfaceSide::inside, SurfaceSide::any, SurfaceSide::outside}),
              ElementsAre(SideFinding::kept, SideFinding::kept, SideFinding::kept));
  EXPECT_THAT(findings(implant, open, {SurfaceSide::inside, SurfaceSide::inside, SurfaceSide::inside}),
              ElementsAre(SideFinding::kept, SideFinding::reaches_through, SideFinding::other_side));
}

/// A part that is turned inside out, as where a surface has crossed itself: no side at all.
TEST(Sides, AreNotThoseOfWhatIsTurnedInsideOut) {
  Mesh lobe = turned_round(scaled(sphere_mesh(2), 0.5));
  for (Point& vertex : lobe.vertices) vertex[0] += 2.0;
  const Mesh surface = join(sphere_mesh(2), lobe);
  EXPECT_TRUE(faces_outward(surface));
  EXPECT_FALSE(faces_outward(lobe));
  EXPECT_EQ(finding(ellipsoid({2.0, 0.0, 0.0}, small), surface, SurfaceSide::inside), SideFinding::other_side);
  EXPECT_EQ(finding(ellipsoid({2.0, 0.0, 0.0}, small), surface, SurfaceSide::outside), SideFinding::other_side);
  EXPECT_EQ(finding(ellipsoid({2.0, 0.0, 0.0}, small), lobe, SurfaceSide::inside), SideFinding::kept);
}

Primitive bent(const Point& centre, const Point& semi_axes, double curvature) {
  return {"part", {semi_axes, {1.0, 1.0}}, {centre}, Bend{curvature, 0.0}};
}

TEST(Sides, AreThoseOfBentPrimitives) {
  const Point slender{0.08, 0.1, 0.5};
  EXPECT_EQ(finding(bent({-0.2, 0.0, 0.0}, slender, 2.0), sphere_mesh(2), SurfaceSide::inside), SideFinding::kept);
  EXPECT_EQ(finding(bent({1.2, 0.0, 0.0}, slender, 2.0), sphere_mesh(2), SurfaceSide::outside), SideFinding::kept);
  EXPECT_EQ(finding(bent({1.2, 0.0, 0.0}, slender, 2.0), sphere_mesh(2), SurfaceSide::inside), SideFinding::other_side);
  // Its ends reach through the surface; straight it would not.
  EXPECT_EQ(finding(bent({0.72, 0.0, 0.0}, slender, 2.0), sphere_mesh(2), SurfaceSide::inside),
            SideFinding::enters_surface);
  EXPECT_EQ(finding(ellipsoid({0.72, 0.0, 0.0}, slender), sphere_mesh(2), SurfaceSide::inside), SideFinding::kept);
  const Primitive shallow = bent({-0.72, 0.0, 0.0}, {0.3, 0.3, 0.4}, 0.5);
  EXPECT_EQ(finding(shallow, sphere_mesh(3), SurfaceSide::inside), SideFinding::enters_surface);
  EXPECT_EQ(finding(shallow, sphere_mesh(3), SurfaceSide::inside, 0.1), SideFinding::kept);
}

TEST(Sides, AreNotSaidOfWhatIsBentTooStronglyForTheLimit) {
  const Primitive part = bent({0.0, 0.0, 0.0}, {0.4, 0.4, 0.5}, 1.8);
  EXPECT_EQ(finding(part, sphere_mesh(2), SurfaceSide::inside, 0.13), SideFinding::kept);
  EXPECT_EQ(finding(part, sphere_mesh(2), SurfaceSide::inside, 0.15), SideFinding::strongly_bent);
}

/// docs/mathematics.md §22: between two points that lie deeper than L the way that is straight before the bend stays so
/// deep.
TEST(Sides, DeepPointsOfBentSolidsAreConvexBeforeTheBend) {
  Random random(9);
  int tried = 0;
  for (int round = 0; round < 60; ++round) {
    const Primitive part{"",
                         {{random.uniform(0.5, 1.5), random.uniform(0.5, 1.5), random.uniform(1.0, 3.0)},
                          {random.uniform(0.2, 1.6), random.uniform(0.2, 1.6)}},
                         {},
                         Bend{random.uniform(-0.4, 0.4), random.uniform(-180.0, 180.0)}};
    const double limit = random.uniform(0.0, 0.4);
    const SignedDistance distance({"", {part}, {}});
    const fit_search::BentProjection bend(part.superquadric, *part.bend);
    const auto depth = [&](const Eigen::Vector3d& unbent) {
      const Eigen::Vector3d p = bend.image(unbent);
      return -distance({p[0], p[1], p[2]}, 1e-6).hi;
    };
    std::vector<Eigen::Vector3d> deep;
    for (int i = 0; i < 60 && deep.size() < 6; ++i) {
      const Eigen::Vector3d x(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-3.0, 3.0));
      if (x.cwiseAbs().cwiseQuotient(vector_of(part.superquadric.semi_axes)).maxCoeff() < 1.0 && depth(x) > limit)
        deep.push_back(x);
    }
    for (std::size_t i = 1; i < deep.size(); ++i) {
      EXPECT_GE(depth((deep[i - 1] + deep[i]) / 2.0), limit - 2e-6) << round;
      ++tried;
    }
  }
  EXPECT_GT(tried, 60);
}

/// A bowl whose hollow the surface enters: of the whole ball, which holds it, nothing can be said.
TEST(Sides, OfSetsAreThoseOfWhatHoldsThem) {
  Model cut{"", {ellipsoid({0.0, 0.0, 0.2}, {0.3, 0.3, 0.3}), ellipsoid({0.0, 0.0, 0.45}, {0.3, 0.3, 0.3})}, {}};
  cut.csg = SetExpression{{{.primitive = 0}, {.primitive = 1}}, SetOperation::subtract};
  EXPECT_EQ(covering_primitives(cut), std::vector<std::uint32_t>{0});
  EXPECT_THAT(findings(cut, sphere_mesh(1), {SurfaceSide::inside, SurfaceSide::any}),
              ElementsAre(SideFinding::kept, SideFinding::kept));
  Mesh bead = scaled(sphere_mesh(1), 0.03);
  for (Point& vertex : bead.vertices) vertex[2] += 0.4;
  EXPECT_THAT(findings(cut, join(sphere_mesh(1), turned_round(bead)), {SurfaceSide::inside, SurfaceSide::any}),
              ElementsAre(SideFinding::enters_surface, SideFinding::kept));
}

TEST(Sides, RefusesSurfacesWithoutAny) {
  Mesh twisted = sphere_mesh(1);
  std::swap(twisted.triangles[0][0], twisted.triangles[0][1]);
  expect_error([&] { check_surface_has_sides(twisted); }, ErrorKind::input, "has no sides",
               ": edges of more than two triangles, or triangles that are not turned alike");
  expect_error(
      [&] {
        check_surface_has_sides({{{0, 0, 0}}, {}});
      },
      ErrorKind::input, "has no triangles", ", so that it has no sides");
  EXPECT_NO_THROW(check_surface_has_sides(bowl(0.3)));
}

}  // namespace
}  // namespace verisq
