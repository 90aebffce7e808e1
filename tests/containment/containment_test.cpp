/// Models within and around meshes whose answers are known, and what must not be proven.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "verify/proof/closed_surface.hpp"
#include "verify/proof/side_checker.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/search/mesh_side.hpp"
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
  const auto is_without = [](std::span<const Primitive> primitives, const std::function<bool()>& ended) {
    return verify::is_without_cavities(primitives, verify::certified_union(primitives, ended), ended);
  };
  const auto never = [] { return false; };
  std::vector<Primitive> all = walls();
  EXPECT_FALSE(is_without(all, never));
  EXPECT_TRUE(is_without(std::span(all).first(5), never));
  EXPECT_TRUE(is_without(std::span(all).first(4), never));
  EXPECT_FALSE(is_without(all, [] { return true; }));
}

ContainmentFinding checked(const Model& model, const Mesh& mesh, Containment containment) {
  return ContainmentChecker(model, mesh)(containment, proof(model, mesh, containment).certificate);
}

TEST(ContainmentChecker, ProvesWhatTheSearchProves) {
  const Mesh mesh = cube(1.0);
  EXPECT_EQ(checked(model_of({ball(0.99)}), mesh, Containment::within).verdict, Verdict::proved);
  EXPECT_EQ(checked(model_of({ball(1.74)}), mesh, Containment::around).verdict, Verdict::proved);
  // Triangles that lie in no primitive as a whole are halved along the seam.
  const Model halves =
      model_of({block("left", {1.0, 1.5, 1.5}, {-0.9, 0.0, 0.0}), block("right", {1.0, 1.5, 1.5}, {0.9, 0.0, 0.0})});
  EXPECT_EQ(checked(halves, mesh, Containment::around).verdict, Verdict::proved);
  Primitive bent = block("bent", {0.3, 0.3, 0.8}, {0.0, 0.0, 0.0}, 1.0);
  bent.bend = Bend{0.3, 20.0};
  EXPECT_EQ(checked(model_of({bent}), mesh, Containment::within).verdict, Verdict::proved);
  std::vector<Primitive> filled = walls();
  filled.push_back(block("filling", {1.9, 1.9, 1.9}, {0.0, 0.0, 0.0}));
  EXPECT_EQ(checked(model_of(filled), cube(2.0), Containment::around).verdict, Verdict::proved);
}

TEST(ContainmentChecker, ProvesNothingElse) {
  const Mesh mesh = cube(1.0);
  const ContainmentFinding beside =
      checked(model_of({ball(0.5), ball(0.5, {5.0, 0.0, 0.0})}), mesh, Containment::within);
  EXPECT_EQ(beside.verdict, Verdict::refuted);
  EXPECT_EQ(checked(model_of({ball(1.01)}), mesh, Containment::within).verdict, Verdict::unproved);
  const ContainmentFinding too_small = checked(model_of({ball(1.73)}), mesh, Containment::around);
  EXPECT_EQ(too_small.verdict, Verdict::unproved);
  EXPECT_EQ(too_small.open, "12 of 12 triangles");
  const Model apart =
      model_of({block("left", {0.8, 1.5, 1.5}, {-1.0, 0.0, 0.0}), block("right", {1.0, 1.5, 1.5}, {0.9, 0.0, 0.0})});
  EXPECT_EQ(checked(apart, mesh, Containment::around).verdict, Verdict::unproved);
  EXPECT_EQ(
      ContainmentChecker(model_of({ball(0.5)}), mesh)(Containment::within, {}, {.interrupted = [] { return true; }})
          .verdict,
      Verdict::unproved);
}

/// About the top of this surface, which crosses itself, it winds the other way: parity says inside there.
TEST(ContainmentChecker, DoesNotRefuteWhereTheMeshCrossesItself) {
  Mesh crossing = cube(1.0);
  for (std::size_t corner = 4; corner < 8; ++corner) {
    crossing.vertices[corner][0] *= -0.5;
    crossing.vertices[corner][1] *= 0.5;
  }
  const Point top{0.0, 0.0, 0.8};
  EXPECT_EQ(verify::ClosedSurface(verify::triangles_of(crossing)).odd(top), true);
  EXPECT_NE(ContainmentChecker(model_of({ball(0.02, top)}), crossing)(Containment::within, {}).verdict,
            Verdict::refuted);
}

/// Whatever the certificate says, a hollow is not filled.
TEST(ContainmentChecker, BelievesNoForgedCertificate) {
  const Model hollow = model_of(walls());
  const ContainmentChecker checker(hollow, cube(2.0));
  ContainmentCertificate forged;
  for (std::uint32_t i = 0; i < 6; ++i)
    for (std::uint32_t j = i + 1; j < 6; ++j) forged.apart.push_back({i, j, {1.0, 0.3, -0.2}, {}, {}});
  for (std::uint32_t i = 0; i < 3; ++i)
    for (std::uint32_t k = i + 3; k < 6; ++k) forged.common.push_back({{i, i + 1, i + 2, k}, {2.0, 2.0, 2.0}});
  forged.common.push_back({{5, 5, 5, 5}, {2.0, 2.0, 2.0}});
  forged.common.push_back({{0, 1, 2, 77}, {2.0, 2.0, 2.0}});
  forged.apart.push_back({77, 0, {1.0, 0.0, 0.0}, {}, {}});
  forged.apart.push_back({0, 77, {1.0, 0.0, 0.0}, {}, {}});
  EXPECT_EQ(checker(Containment::around, forged).verdict, Verdict::unproved);
  std::vector<Primitive> filled = walls();
  filled.push_back(block("filling", {1.9, 1.9, 1.9}, {0.0, 0.0, 0.0}));
  const ContainmentChecker of_filled(model_of(filled), cube(2.0));
  ContainmentCertificate less = proof(model_of(filled), cube(2.0), Containment::around).certificate;
  EXPECT_EQ(of_filled(Containment::around, less).verdict, Verdict::proved);
  less.common.pop_back();
  EXPECT_EQ(of_filled(Containment::around, less).verdict, Verdict::unproved);
}

TEST(ContainmentChecker, RefusesMeshesThatAreNotClosed) {
  Mesh open = cube(1.0);
  open.triangles.pop_back();
  EXPECT_THROW(ContainmentChecker(model_of({ball(0.1)}), open), Error);
  Mesh turned = cube(1.0);
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_THROW(ContainmentChecker(model_of({ball(0.1)}), turned), Error);
  Model cut = model_of({ball(0.1)});
  cut.csg = SetExpression{};
  EXPECT_THROW(ContainmentChecker(cut, cube(1.0)), Error);
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
