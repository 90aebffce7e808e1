/// What is found of sides is proved again from model and mesh alone, and nothing that a point of the surface refutes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/forgeries.hpp"
#include "tests/fixtures/random.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "verify/solids/model.hpp"
#include "verisq/clearance.hpp"
#include "verisq/distance.hpp"

namespace verisq {
namespace {

using verisq::oracle::Forgeries;
using verisq::oracle::requested_count;
using verisq::testing::expect_error;
using verisq::testing::join;
using verisq::testing::Random;
using verisq::testing::sphere_mesh;
using verisq::testing::torus_mesh;

Mesh moved(Mesh mesh, const Point& by, double factor = 1.0) {
  for (Point& vertex : mesh.vertices)
    for (std::size_t i = 0; i < 3; ++i) vertex[i] = factor * vertex[i] + by[i];
  return mesh;
}

Mesh turned_round(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  return mesh;
}

/// Of a sphere the triangles below a height.
Mesh bowl(int rounds, double height) {
  Mesh mesh = sphere_mesh(rounds);
  std::erase_if(mesh.triangles, [&](const auto& corners) {
    return std::ranges::any_of(corners, [&](std::uint32_t v) { return mesh.vertices[v][2] > height; });
  });
  return mesh;
}

Model alone(const Primitive& primitive) {
  return {"", {primitive}, {}};
}

Verdict verdict(const Primitive& primitive, const Mesh& mesh, SurfaceSide side, double limit = 0.0) {
  return verdict_of(SideChecker(alone(primitive), mesh, limit)({0, side}));
}

Primitive ellipsoid(const Point& centre, const Point& semi_axes) {
  return {"part", {semi_axes, {1.0, 1.0}}, {centre}, {}};
}

constexpr Point small{0.2, 0.2, 0.2};

TEST(SideChecker, TellsInsideFromOutside) {
  for (const Mesh& mesh : {sphere_mesh(3), turned_round(sphere_mesh(3))}) {
    EXPECT_EQ(verdict(ellipsoid({0.1, 0.2, 0.3}, small), mesh, SurfaceSide::inside), Verdict::proved);
    EXPECT_EQ(verdict(ellipsoid({0.1, 0.2, 0.3}, small), mesh, SurfaceSide::outside), Verdict::refuted);
    EXPECT_EQ(verdict(ellipsoid({0.1, 0.2, 1.5}, small), mesh, SurfaceSide::inside), Verdict::refuted);
    EXPECT_EQ(verdict(ellipsoid({0.1, 0.2, 1.5}, small), mesh, SurfaceSide::outside), Verdict::proved);
  }
}

TEST(SideChecker, LeavesWhatTheLimitAllows) {
  const Primitive through = ellipsoid({0.0, 0.0, 0.85}, small);
  EXPECT_EQ(verdict(through, sphere_mesh(4), SurfaceSide::inside), Verdict::unproved);
  EXPECT_EQ(verdict(through, sphere_mesh(4), SurfaceSide::inside, 0.049), Verdict::unproved);
  EXPECT_EQ(verdict(through, sphere_mesh(4), SurfaceSide::inside, 0.055), Verdict::proved);
  // None of its points is deeper than that.
  EXPECT_EQ(verdict(ellipsoid({0.0, 0.0, 0.5}, small), sphere_mesh(4), SurfaceSide::inside, 0.2), Verdict::unproved);
}

TEST(SideChecker, KeepsOffTheOpenings) {
  const Mesh open = bowl(3, 0.3);
  EXPECT_EQ(SideChecker(alone(ellipsoid({}, small)), open, 0.0).rims(), 1U);
  EXPECT_EQ(verdict(ellipsoid({0.0, 0.0, -0.2}, small), open, SurfaceSide::inside), Verdict::proved);
  EXPECT_EQ(verdict(ellipsoid({0.0, 0.0, 0.1}, {0.2, 0.2, 0.4}), open, SurfaceSide::inside), Verdict::unproved);
  EXPECT_EQ(verdict(ellipsoid({0.0, 0.0, 0.7}, small), open, SurfaceSide::inside), Verdict::refuted);
  EXPECT_EQ(verdict(ellipsoid({0.0, 0.0, 0.7}, small), open, SurfaceSide::outside), Verdict::proved);
}

/// A part that is turned inside out is no side at all; inside of one of several parts is not inside of the bone.
TEST(SideChecker, IsOfOneSurface) {
  const Mesh lobe = moved(turned_round(sphere_mesh(2)), {2.0, 0.0, 0.0}, 0.5);
  EXPECT_EQ(verdict(ellipsoid({2.0, 0.0, 0.0}, small), join(sphere_mesh(2), lobe), SurfaceSide::outside),
            Verdict::refuted);
  const Mesh bead = moved(sphere_mesh(2), {3.0, 0.0, 0.0});
  EXPECT_EQ(verdict(ellipsoid({3.0, 0.0, 0.0}, small), join(sphere_mesh(2), bead), SurfaceSide::inside),
            Verdict::unproved);
  EXPECT_EQ(verdict(ellipsoid({0.0, 0.0, 0.0}, small), join(sphere_mesh(2), bead), SurfaceSide::inside),
            Verdict::unproved);
  EXPECT_EQ(verdict(ellipsoid({1.5, 0.0, 0.0}, small), join(sphere_mesh(2), bead), SurfaceSide::outside),
            Verdict::unproved);
  // Triangles that do not share vertices, each closed by a fan of its own, wind about nothing.
  const Mesh ball = sphere_mesh(2);
  Mesh soup;
  for (const auto& corners : ball.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : corners) soup.vertices.push_back(ball.vertices[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(SideChecker(alone(ellipsoid({}, small)), soup, 0.0)({0, SurfaceSide::outside}), SideFinding::several_parts);
  soup.triangles.resize(1);
  EXPECT_EQ(SideChecker(alone(ellipsoid({}, small)), soup, 0.0)({0, SurfaceSide::outside}), SideFinding::no_volume);
}

TEST(SideChecker, IsOfBentPrimitives) {
  const auto bent = [](const Point& centre, const Point& semi_axes, double curvature) {
    return Primitive{"part", {semi_axes, {1.0, 1.0}}, {centre}, Bend{curvature, 0.0}};
  };
  const Point slender{0.08, 0.1, 0.5};
  EXPECT_EQ(verdict(bent({-0.2, 0.0, 0.0}, slender, 2.0), sphere_mesh(2), SurfaceSide::inside), Verdict::proved);
  EXPECT_EQ(verdict(bent({1.2, 0.0, 0.0}, slender, 2.0), sphere_mesh(2), SurfaceSide::outside), Verdict::proved);
  EXPECT_EQ(verdict(bent({0.72, 0.0, 0.0}, slender, 2.0), sphere_mesh(2), SurfaceSide::inside), Verdict::unproved);
  const Primitive shallow = bent({-0.72, 0.0, 0.0}, {0.3, 0.3, 0.4}, 0.5);
  EXPECT_EQ(verdict(shallow, sphere_mesh(3), SurfaceSide::inside), Verdict::unproved);
  EXPECT_EQ(verdict(shallow, sphere_mesh(3), SurfaceSide::inside, 0.1), Verdict::proved);
  const Primitive strongly = bent({0.0, 0.0, 0.0}, {0.4, 0.4, 0.5}, 1.8);
  EXPECT_EQ(verdict(strongly, sphere_mesh(2), SurfaceSide::inside, 0.13), Verdict::proved);
  EXPECT_EQ(verdict(strongly, sphere_mesh(2), SurfaceSide::inside, 0.15), Verdict::unproved);
}

TEST(SideChecker, RefusesWhatHasNoSides) {
  const Model ball = alone(ellipsoid({}, small));
  Mesh twisted = sphere_mesh(1);
  std::swap(twisted.triangles[0][0], twisted.triangles[0][1]);
  expect_error([&] { SideChecker(ball, twisted, 0.0); }, ErrorKind::input, "has no sides",
               ": edges of more than two triangles, or triangles that are not turned alike");
  expect_error(
      [&] {
        SideChecker(ball, {{{0, 0, 0}}, {}}, 0.0);
      },
      ErrorKind::input, "has no triangles", ", so that it has no sides");
  expect_error([&] { SideChecker(ball, sphere_mesh(1), -1.0); }, ErrorKind::input, "sides: penetration limit",
               ": must be finite and at least 0, not -1");
}

/// A primitive, a mesh, and on which side of it the primitive begins.
struct Scene {
  Primitive primitive;
  Mesh mesh;
  SurfaceSide side;
  double limit;
  Point target = {};  ///< a vertex that it is moved towards
};

Primitive random_primitive(Random& random) {
  Superquadric solid{{random.uniform(0.06, 0.3), random.uniform(0.06, 0.3), random.uniform(0.06, 0.4)},
                     {random.uniform(0.1, 1.9), random.uniform(0.1, 1.9)}};
  if (random.uniform(0.0, 1.0) < 0.4) solid.taper = random.uniform(0.4, 2.5);
  Primitive primitive{"", solid, {}, {}};
  for (double& q : primitive.pose.quaternion) q = random.uniform(-1.0, 1.0);
  if (random.uniform(0.0, 1.0) < 0.5) {
    primitive.bend = Bend{random.uniform(-2.0, 2.0), random.uniform(-180.0, 180.0)};
    if (verify::fault_of(Model{"", {primitive}})) primitive.bend.reset();
  }
  return primitive;
}

/// Of one of its triangles.
Point random_vertex(const Mesh& mesh, Random& random) {
  const auto n = static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(mesh.triangles.size())));
  return mesh.vertices[mesh.triangles[n][0]];
}

/// With the centre in the hollow, or beside the mesh.
Scene random_scene(Random& random) {
  const bool inside = random.uniform(0.0, 1.0) < 0.5;
  const bool open = random.uniform(0.0, 1.0) < 0.4;
  Scene scene{random_primitive(random), open ? bowl(2, 0.45) : sphere_mesh(2),
              inside ? SurfaceSide::inside : SurfaceSide::outside,
              random.uniform(0.0, 1.0) < 0.5 ? 0.0 : random.uniform(0.0, 0.04)};
  if (!open && random.uniform(0.0, 1.0) < 0.3) scene.mesh = torus_mesh(1.0, 0.5, 12, 8);
  const bool ring = scene.mesh.vertices.size() == 96;
  Point& centre = scene.primitive.pose.translation;
  if (inside) {
    centre = {ring ? 1.0 : random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), ring ? 0.0 : -0.3};
  } else {
    centre = {random.uniform(-0.3, 0.3), random.uniform(1.7, 2.2), random.uniform(-0.3, 0.3)};
  }
  scene.target = random_vertex(scene.mesh, random);
  return scene;
}

Point between(const Point& a, const Point& b, double share) {
  return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])};
}

Primitive at(Primitive primitive, const Point& centre) {
  primitive.pose.translation = centre;
  return primitive;
}

/// Moved towards the target: how far until that is proven to be a little deeper in the primitive than the limit.
/// Nothing where it does not come so deep.
std::optional<double> share_that_is_too_deep(const Scene& scene) {
  const Point begin = scene.primitive.pose.translation;
  const auto too_deep = [&](double share, double tolerance = 1e-12) {
    const Primitive moved_there = at(scene.primitive, between(begin, scene.target, share));
    return SignedDistance(alone(moved_there))(scene.target, tolerance).hi < -scene.limit;
  };
  double low = 0.0;
  double high = 1.0;
  if (too_deep(low) || !too_deep(high)) return std::nullopt;
  for (int i = 0; i < 34; ++i) {
    const double middle = 0.5 * (low + high);
    (too_deep(middle, std::max(1e-12, 0.01 * (high - low))) ? high : low) = middle;
  }
  return high;
}

/// A vertex that lies deeper than the limit, by some 10^-11 in the least case, has deep points on both of its sides.
TEST(SideChecker, NeverProvesAForgery) {
  Random random(31);
  Forgeries forgeries;
  std::size_t proved = 0;
  std::size_t scenes = 0;
  for (std::size_t i = 0; i < requested_count("VERISQ_FORGED_SIDES", 15); ++i) {
    const Scene scene = random_scene(random);
    const std::optional<double> share = share_that_is_too_deep(scene);
    if (!share) continue;
    ++scenes;
    const auto check = [&](double of_way, SurfaceSide side, double limit) {
      const Point& begin = scene.primitive.pose.translation;
      return verdict(at(scene.primitive, between(begin, scene.target, of_way * *share)), scene.mesh, side, limit);
    };
    const auto forge = [&](double of_way, SurfaceSide side, double limit, const char* what) {
      forgeries.expect_not_proved({check(of_way, side, limit), {}}, {}, what);
    };
    const SurfaceSide other = scene.side == SurfaceSide::inside ? SurfaceSide::outside : SurfaceSide::inside;
    for (const double of_way : {0.0, 0.5, 0.8}) {
      if (check(of_way, scene.side, scene.limit) != Verdict::proved) continue;
      ++proved;
      forge(of_way, other, scene.limit, "the other side");
    }
    for (const double of_way : {1.0, 1.0 + 1e-6, 1.01, 1.1}) {
      if (of_way * *share > 1.0) continue;
      forge(of_way, scene.side, scene.limit, "a vertex too deep");
      forge(of_way, other, scene.limit, "a vertex too deep, the other side");
      forge(of_way, scene.side, scene.limit * (1.0 - 1e-6), "a smaller limit");
    }
  }
  EXPECT_GT(forgeries.told(), 8 * scenes);
  EXPECT_GT(2 * proved, 3 * scenes) << "of " << 3 * scenes;
}

TEST(SideChecker, SaysNothingOnceInterrupted) {
  const SideChecker checker(alone(ellipsoid({}, small)), sphere_mesh(3), 0.0);
  EXPECT_EQ(checker({0, SurfaceSide::inside}, {.interrupted = [] { return true; }}), SideFinding::enters_surface);
}

}  // namespace
}  // namespace verisq
