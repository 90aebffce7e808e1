/// Models within and around meshes whose answers are known, and what must not be proven.
#include "verisq/containment.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "verify/containment/closed_surface.hpp"
#include "verify/containment/union_cavities.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verisq/error.hpp"
#include "verisq/recovery.hpp"

namespace verisq::testing {
namespace {

/// The surface of the cube |x|, |y|, |z| <= half, two triangles a face.
Mesh cube(double half, const Point& centre = {0.0, 0.0, 0.0}) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.push_back({centre[0] + ((corner & 1) != 0 ? half : -half),
                             centre[1] + ((corner & 2) != 0 ? half : -half),
                             centre[2] + ((corner & 4) != 0 ? half : -half)});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Both surfaces as one mesh.
Mesh joined(Mesh a, const Mesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({first + i, first + j, first + k});
  return a;
}

Primitive block(const std::string& name, const std::array<double, 3>& half, const Point& centre,
                double exponent = 0.05) {
  return {.name = name,
          .superquadric = {.semi_axes = half, .exponents = {exponent, exponent}},
          .pose = {.translation = centre}};
}

Primitive ball(double radius, const Point& centre = {0.0, 0.0, 0.0}) {
  return block("ball", {radius, radius, radius}, centre, 1.0);
}

Model model_of(std::vector<Primitive> primitives) {
  return {"", std::move(primitives), {}};
}

ContainmentProof proof(const Model& model, const Mesh& mesh, Containment containment) {
  return prove_containment(model, mesh, containment, {.device = "host"});
}

TEST(ContainmentTest, ABallInACubeAndAroundIt) {
  const Mesh mesh = cube(1.0);
  EXPECT_TRUE(proof(model_of({ball(0.99)}), mesh, Containment::within).proven);
  EXPECT_TRUE(proof(model_of({ball(1.74)}), mesh, Containment::around).proven);
  const ContainmentProof too_large = proof(model_of({ball(1.01)}), mesh, Containment::within);
  EXPECT_FALSE(too_large.proven);
  EXPECT_EQ(too_large.triangles_refuted + too_large.triangles_undecided, 12U);
  EXPECT_GT(too_large.triangles_refuted, 0U);
  const ContainmentProof too_small = proof(model_of({ball(1.73)}), mesh, Containment::around);
  EXPECT_FALSE(too_small.proven);
  EXPECT_EQ(too_small.triangles_refuted, 12U);
  ASSERT_FALSE(too_small.across.empty());
  EXPECT_NEAR(too_small.across[0].excess, std::sqrt(3.0) - 1.73, 1e-6);
}

TEST(ContainmentTest, AModelBesideTheMeshIsNotWithinIt) {
  const ContainmentProof beside =
      proof(model_of({ball(0.5), ball(0.5, {5.0, 0.0, 0.0})}), cube(1.0), Containment::within);
  EXPECT_EQ(beside.triangles_proven, 12U);
  EXPECT_EQ(beside.centres_outside.size(), 1U);
  EXPECT_FALSE(beside.proven);
  // In the hollow of a hollow cube is outside, too.
  const Mesh hollow = joined(cube(2.0), cube(1.0));
  EXPECT_FALSE(proof(model_of({ball(0.5)}), hollow, Containment::within).proven);
  EXPECT_TRUE(proof(model_of({ball(0.4, {1.5, 0.0, 0.0})}), hollow, Containment::within).proven);
}

TEST(ContainmentTest, ABentModelWithinAndAround) {
  Primitive bent = block("bent", {0.3, 0.3, 0.8}, {0.0, 0.0, 0.0}, 1.0);
  bent.bend = Bend{0.3, 20.0};
  EXPECT_TRUE(proof(model_of({bent}), cube(1.0), Containment::within).proven);
  EXPECT_TRUE(proof(model_of({bent}), cube(0.1), Containment::around).proven);
  EXPECT_FALSE(proof(model_of({bent, ball(0.5)}), cube(0.1), Containment::around).proven);
}

/// The six walls of a hollow cube: their middle surface is a cube of half 2.
std::vector<Primitive> walls() {
  std::vector<Primitive> result;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double side : {-2.0, 2.0}) {
      std::array<double, 3> half{2.6, 2.6, 2.6};
      Point centre{0.0, 0.0, 0.0};
      half[axis] = 0.5;
      centre[axis] = side;
      result.push_back(block("wall" + std::to_string(result.size()), half, centre));
    }
  }
  return result;
}

TEST(ContainmentTest, AHollowModelIsNotAroundWhatItsHollowBelongsTo) {
  const Mesh mesh = cube(2.0);
  const ContainmentProof hollow = proof(model_of(walls()), mesh, Containment::around);
  EXPECT_EQ(hollow.triangles_proven, 12U);
  EXPECT_TRUE(hollow.maybe_with_cavities);
  EXPECT_FALSE(hollow.proven);
  std::vector<Primitive> filled = walls();
  filled.push_back(block("filling", {1.9, 1.9, 1.9}, {0.0, 0.0, 0.0}));
  EXPECT_TRUE(proof(model_of(filled), mesh, Containment::around).proven);
  // A pea in the hollow fills nothing.
  filled.back() = ball(0.5);
  EXPECT_FALSE(proof(model_of(filled), mesh, Containment::around).proven);
}

TEST(ContainmentTest, ARingHasNoCavity) {
  const auto never = [] { return false; };
  std::vector<Primitive> all = walls();
  EXPECT_FALSE(verify::is_without_cavities(all, never));
  EXPECT_TRUE(verify::is_without_cavities(std::span(all).first(5), never));
  EXPECT_TRUE(verify::is_without_cavities(std::span(all).first(4), never));
  EXPECT_FALSE(verify::is_without_cavities(all, [] { return true; }));
}

TEST(ContainmentTest, ParityKnowsInsideFromOutside) {
  const verify::ClosedSurface surface(verify::triangles_of(joined(joined(cube(3.0), cube(2.0)), cube(1.0))));
  const auto inside = [&surface](double x) { return surface.odd({x, 0.0, 0.0}); };
  EXPECT_EQ(inside(0.0), true);
  EXPECT_EQ(inside(0.999), true);
  EXPECT_EQ(inside(1.5), false);
  EXPECT_EQ(inside(-2.5), true);
  EXPECT_EQ(inside(3.5), false);
  EXPECT_EQ(inside(2.0), std::nullopt);
  EXPECT_EQ(surface.odd({2.0, 2.0, 2.0}), std::nullopt);
}

TEST(ContainmentTest, RefusesWhatBoundsNothing) {
  Mesh open = cube(1.0);
  open.triangles.pop_back();
  const auto refused = [](const Model& model, const Mesh& mesh) {
    try {
      (void)proof(model, mesh, Containment::within);
    } catch (const Error& error) {
      return error.kind() == ErrorKind::input;
    }
    return false;
  };
  EXPECT_TRUE(refused(model_of({ball(0.1)}), open));
  Mesh fin = cube(1.0);
  fin.vertices.push_back({3.0, 3.0, 3.0});
  fin.triangles.insert(fin.triangles.end(), {{0, 1, 8}, {0, 1, 8}});
  EXPECT_TRUE(refused(model_of({ball(0.1)}), fin));
  Model cut = model_of({ball(0.1)});
  cut.csg = SetExpression{};
  EXPECT_TRUE(refused(cut, cube(1.0)));
  EXPECT_TRUE(refused({}, cube(1.0)));
}

}  // namespace
}  // namespace verisq::testing
