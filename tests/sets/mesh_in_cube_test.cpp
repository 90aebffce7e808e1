/// Closed meshes over cubes: colours and half-spaces against exact membership, and distances to sets of meshes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "tests/fixtures/mesh_scenes.hpp"
#include "tests/fixtures/random.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "tests/oracle/exact_mesh.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/search/closed_mesh.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/search/solid_distance.hpp"
#include "verify/solids/superquadric.hpp"

namespace verisq::verify {
namespace {

using testing::join;
using testing::moved;
using testing::Random;
using testing::sphere_mesh;
using testing::star_mesh;
using testing::tetrahedron;
using testing::torus_mesh;
using testing::turned;

/// |x_i| <= half_i.
Mesh box_mesh(const Point& half) {
  Mesh mesh;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) mesh.vertices.push_back({x * half[0], y * half[1], z * half[2]});
    }
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return mesh;
}

struct NamedMesh {
  std::string name;
  Mesh mesh;
};

std::vector<NamedMesh> meshes() {
  return {{"tetrahedron", tetrahedron()},
          {"turned inward", turned(box_mesh({1.0, 0.5, 0.25}))},
          {"torus", torus_mesh(1.0, 0.4, 8, 5)},
          {"star", star_mesh(1, 5)},
          {"hollow", join(sphere_mesh(1), turned(moved(sphere_mesh(1), 0.75, {})))},
          {"nested alike", join(sphere_mesh(1), moved(sphere_mesh(1), 0.5, {}))},
          {"crossing", join(sphere_mesh(1), moved(sphere_mesh(1), 1.0, {0.5, 0.25, 0.0}))},
          {"thin", box_mesh({1.0, 1.0, 0x1p-6})}};
}

std::vector<Pose> poses() {
  return {{}, {{0.3, -0.2, 0.1}, {1, 0, 0, 0}}, {{0.25, 0.5, -0.75}, {0.8, 0.1, -0.5, 0.3}}};
}

Mesh moved(Mesh mesh, const Point& by) {
  return moved(std::move(mesh), 1.0, by);
}

/// Where points lie to a mesh that is moved by `shift`, then posed, by the mesh without both. Points less than `doubt`
/// away from a triangle are left out.
class Membership {
 public:
  Membership(const Mesh& mesh, const Point& shift, const Pose& pose)
      : exact_(triangles_of(mesh)), shift_(precise(shift)), motion_(pose) {}

  [[nodiscard]] std::optional<bool> operator()(const Point& x) const {
    const PreciseVector local = motion_.local_point(x) - shift_;
    Point own;
    for (int i = 0; i < 3; ++i) own[static_cast<std::size_t>(i)] = local[i].lower().to_double(Direction::down);
    constexpr double doubt = 0x1p-50;
    if (oracle::holds_root({0.0, doubt}, exact_.squared_distance(own))) return std::nullopt;
    return exact_.winding_number(own) != 0;
  }

 private:
  oracle::ExactMesh exact_;
  PreciseVector shift_;
  RigidMotion motion_;
};

Point point_of(const Cube& cube, Random& random) {
  Point point = cube.centre;
  for (double& x : point) x += cube.half_width * random.uniform(-1.0, 1.0);
  return point;
}

Cube cube_about_surface(const PosedMesh& mesh, double largest, Random& random) {
  const auto n = static_cast<std::uint32_t>(random.uniform(0.0, static_cast<double>(mesh.mesh().tree().size()) - 0.5));
  const Triangle triangle = mesh.triangle(n);
  const double b = random.uniform(0.0, 1.0);
  const double c = random.uniform(0.0, 1.0 - b);
  const double half_width = std::ldexp(largest, -static_cast<int>(random.uniform(0.0, 9.0)));
  Cube cube{{}, half_width};
  for (std::size_t i = 0; i < 3; ++i) {
    cube.centre[i] = (1.0 - b - c) * triangle[0][i] + b * triangle[1][i] + c * triangle[2][i] +
                     random.uniform(-1.5, 1.5) * half_width;
  }
  return cube;
}

bool holds(const HalfSpace& half_space, const Cube& cube, const Point& x) {
  Interval along(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    along = along + Interval(half_space.normal[i]) * (Interval(x[i]) - Interval(cube.centre[i]));
  }
  return along.lower() <= half_space.offset;
}

struct Counts {
  int decided = 0;
  int cut = 0;
};

/// Cubes about the surface, up to the largest half-width, and points of each.
Counts expect_sound(const NamedMesh& named, const Point& shift, const Pose& pose, double largest, Random& random) {
  const auto& [name, mesh] = named;
  const PosedMesh posed(mesh_primitive(name, moved(mesh, shift), pose));
  const Membership contains(mesh, shift, pose);
  Counts counts;
  for (int k = 0; k < 60; ++k) {
    const Cube cube = cube_about_surface(posed, largest, random);
    const Colour found = colour(posed, cube);
    const HalfSpace inside = half_space(posed, cube, Side::inside);
    const HalfSpace outside = half_space(posed, cube, Side::outside);
    counts.decided += found != Colour::gray ? 1 : 0;
    counts.cut += found == Colour::gray && std::isfinite(inside.offset) && std::isfinite(outside.offset) ? 1 : 0;
    for (int i = 0; i < 8; ++i) {
      const Point x = point_of(cube, random);
      const std::optional<bool> is_in = contains(x);
      if (!is_in) continue;
      EXPECT_NE(found, *is_in ? Colour::white : Colour::black) << name;
      EXPECT_TRUE(holds(*is_in ? inside : outside, cube, x)) << name << ' ' << k << ' ' << cube.half_width;
    }
  }
  return counts;
}

TEST(MeshInCubeTest, ColoursAndHalfSpacesHoldForEveryPointOfTheCube) {
  Random random(3);
  for (const NamedMesh& mesh : meshes()) {
    for (const Pose& pose : poses()) {
      const Counts counts = expect_sound(mesh, {}, pose, 1.0, random);
      EXPECT_GT(counts.decided, 0) << mesh.name;
      EXPECT_GT(counts.cut, 10) << mesh.name;
    }
  }
}

Mesh on_grid(Mesh mesh) {
  for (Point& vertex : mesh.vertices) {
    for (double& x : vertex) x = std::nearbyint(x * 0x1p20) * 0x1p-20;
  }
  return mesh;
}

/// Far from the origin of its frame the coordinates of a mesh are exact, and those in the model's frame are rounded by
/// as much as small cubes measure.
TEST(MeshInCubeTest, RoundingIsCovered) {
  Random random(9);
  const Point shift{0x1p20, -0x1p21, 0x1p19};
  const Pose pose{{-0x1p20 + 0.3, 0.7, 3.0}, {0.8, 0.1, -0.5, 0.3}};
  for (const auto& [name, mesh] : meshes()) {
    int cut = 0;
    for (const double largest : {0x1p-12, 0x1p-18, 0x1p-22, 0x1p-25, 0x1p-25}) {
      cut += expect_sound({name, on_grid(mesh)}, shift, pose, largest, random).cut;
    }
    EXPECT_GT(cut, 20) << name;
  }
}

/// The triangle nearest to the centre misses the cube, and another one meets it at a corner.
TEST(MeshInCubeTest, TheNearestTriangleIsNotAll) {
  const Mesh before_face = moved(box_mesh({0.5, 0.25, 0.25}), {1.5625, 0.0, 0.0});
  const Mesh at_corner = moved(box_mesh({0.5, 0.5, 0.5}), {1.4375, 1.4375, 1.4375});
  const Cube cube{{}, 1.0};
  EXPECT_EQ(colour(PosedMesh(mesh_primitive("", before_face)), cube), Colour::white);
  EXPECT_EQ(colour(PosedMesh(mesh_primitive("", join(before_face, at_corner))), cube), Colour::gray);
}

/// The solid holds a corner of the cube, less than what is worth cutting: its triangles face inward.
TEST(MeshInCubeTest, SmallPartsAreNotCutOff) {
  for (const double part : {0x1p-16, 0x1p-14, 0x1p-12, 0x1p-10}) {
    Mesh mesh;
    const double a = 3.0 - 3.0 * part;
    mesh.vertices = {{a + 8, -4, -4}, {-4, a + 8, -4}, {-4, -4, a + 8}, {5, 5, 5}};
    mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    const double within = 1.0 - part / 2;
    for (const Mesh& solid : {mesh, turned(mesh)}) {
      const HalfSpace inside = half_space(PosedMesh(mesh_primitive("", solid)), {{}, 1.0}, Side::inside);
      EXPECT_TRUE(holds(inside, {{}, 1.0}, {within, within, within})) << part;
    }
  }
}

/// How far the surface in the cube reaches, by points of its triangles.
double reach_of_surface(const PosedMesh& mesh, const Cube& cube, const Point& n, Random& random) {
  double reach = -infinity;
  for (std::uint32_t k = 0; k < mesh.mesh().tree().size(); ++k) {
    const Triangle triangle = mesh.triangle(k);
    for (int i = 0; i < 4000; ++i) {
      const double b = random.uniform(0.0, 1.0);
      const double c = random.uniform(0.0, 1.0 - b);
      double along = 0.0;
      bool is_in = true;
      for (std::size_t j = 0; j < 3; ++j) {
        const double e = (1.0 - b - c) * triangle[0][j] + b * triangle[1][j] + c * triangle[2][j] - cube.centre[j];
        is_in = is_in && std::abs(e) <= cube.half_width;
        along += n[j] * e;
      }
      if (is_in) reach = std::max(reach, along);
    }
  }
  return reach;
}

TEST(MeshInCubeTest, HalfSpacesReachNoFartherThanTheSurface) {
  Random random(12);
  Mesh flat = box_mesh({1.0, 0.75, 0.5});
  flat.vertices[7] = {1.5, 1.25, 0.25};
  const PosedMesh mesh(mesh_primitive("skew", flat, {{}, {0.8, 0.1, -0.5, 0.3}}));
  int checked = 0;
  for (int k = 0; k < 60; ++k) {
    Cube cube = cube_about_surface(mesh, 1.0, random);
    cube.half_width = random.uniform(0.3, 0.6);
    for (const Side side : {Side::inside, Side::outside}) {
      const HalfSpace found = half_space(mesh, cube, side);
      if (colour(mesh, cube) != Colour::gray || !std::isfinite(found.offset)) continue;
      ++checked;
      EXPECT_LE(found.offset - reach_of_surface(mesh, cube, found.normal, random), 0.25 * cube.half_width) << k;
    }
  }
  EXPECT_GT(checked, 60);
}

/// A triangle touches a cube's edge, side or corner, or passes it by: as the exact distance of the cube says.
TEST(MeshInCubeTest, CubesFreeOfTrianglesAreDecided) {
  Random random(8);
  for (const auto& [name, mesh] : meshes()) {
    const PosedMesh posed(mesh_primitive(name, mesh));
    for (int k = 0; k < 200; ++k) {
      const Cube cube = cube_about_surface(posed, 1.0, random);
      if (cube.half_width > 0.1) continue;
      // The least distance of a dense lattice of the cube's points to the triangles, less half the lattice's diagonal.
      constexpr int n = 12;
      double least = infinity;
      for (int i = 0; i < n * n * n; ++i) {
        const std::array place{i % n, i / n % n, i / n / n};
        Point x = cube.centre;
        for (std::size_t axis = 0; axis < 3; ++axis) x[axis] += cube.half_width * (2 * place[axis] + 1 - n) / n;
        const Enclosure there = posed.signed_distance(x).signed_distance;
        least = std::min({least, std::abs(there.lo), std::abs(there.hi)});
      }
      const Colour found = colour(posed, cube);
      const double between = std::sqrt(3.0) * cube.half_width / n;
      EXPECT_FALSE(found == Colour::gray && least > 1.001 * between) << name << ' ' << k;
    }
  }
}

/// Points beside the surface, on it, far away, and where numbers end.
TEST(MeshInCubeTest, Points) {
  const PosedMesh box(mesh_primitive("box", box_mesh({1.0, 1.0, 1.0})));
  EXPECT_EQ(colour(box, {{0.0, 0.0, 0.0}, 0.0}), Colour::black);
  EXPECT_EQ(colour(box, {{1.0, 0.25, 0.5}, 0.0}), Colour::gray);
  EXPECT_EQ(colour(box, {{1.0 + 1e-13, 0.25, 0.5}, 0.0}), Colour::white);
  EXPECT_EQ(colour(box, {{1.0 - 1e-13, 0.25, 0.5}, 0.0}), Colour::black);
  EXPECT_EQ(colour(box, {{0.25, 0.0, 0.0}, 0.5}), Colour::black);
  EXPECT_EQ(colour(box, {{0.25, 0.0, 0.0}, 0.75}), Colour::gray);
  const PosedMesh posed(mesh_primitive("box", box_mesh({1.0, 1.0, 1.0}), {{1.0, 2.0, 3.0}, {0.9, 0.1, 0.2, 0.3}}));
  for (const double far : {1e10, 1e100, 1e300, 1.7e308}) {
    for (const PosedMesh* const mesh : {&box, &posed}) {
      for (const double half_width : {0.0, 1.0, far / 4, far, 1.7e308}) {
        for (const Point& at : {Point{far, far, far}, Point{-far, far, 0.0}, Point{0.0, 0.0, far}}) {
          EXPECT_NE(colour(*mesh, {at, half_width}), Colour::black);
          for (const Side side : {Side::inside, Side::outside}) {
            EXPECT_FALSE(std::isnan(half_space(*mesh, {at, half_width}, side).offset));
          }
        }
      }
    }
  }
  EXPECT_EQ(colour(box, {{0.0, 0.0, 0.0}, 1e300}), Colour::gray);
}

/// Over one plane half-spaces are that plane; over an edge that of the solid touches it.
TEST(MeshInCubeTest, HalfSpacesTouchTheSurface) {
  const PosedMesh box(mesh_primitive("box", box_mesh({1.0, 1.0, 1.0})));
  const auto distance_of_plane = [](const HalfSpace& h) {
    return h.offset / std::hypot(h.normal[0], h.normal[1], h.normal[2]);
  };
  const Cube at_face{{0.95, 0.3, 0.2}, 0.1};
  EXPECT_NEAR(distance_of_plane(half_space(box, at_face, Side::inside)), 0.05, 1e-12);
  EXPECT_NEAR(distance_of_plane(half_space(box, at_face, Side::outside)), -0.05, 1e-12);
  const Cube at_edge{{1.0, 1.0, 0.2}, 0.1};
  EXPECT_NEAR(distance_of_plane(half_space(box, at_edge, Side::inside)), 0.0, 1e-12);
  EXPECT_NEAR(distance_of_plane(half_space(box, at_edge, Side::outside)), 0.1 / std::sqrt(2.0), 1e-12);
  const Cube at_corner{{1.0, 1.0, 1.0}, 0.1};
  EXPECT_NEAR(distance_of_plane(half_space(box, at_corner, Side::inside)), 0.0, 1e-12);
}

// Distances to sets of meshes and superquadrics.

SetExpression leaf(std::uint32_t primitive) {
  return {.operands = {}, .operation = SetOperation::unite, .primitive = primitive};
}

Model combined(std::vector<Primitive> primitives, SetOperation operation) {
  SetExpression all{.operands = {}, .operation = operation};
  for (std::uint32_t i = 0; i < primitives.size(); ++i) all.operands.push_back(leaf(i));
  return {"", std::move(primitives), all};
}

bool never() {
  return false;
}

Enclosure distance(const SolidDistance& search, const Point& x, double tolerance) {
  return search(x, tolerance, {-infinity, infinity}, never);
}

/// A single mesh in a tree of its own: the search finds what the mesh knows.
TEST(MeshSetTest, OneMeshAloneHasItsOwnDistance) {
  Random random(4);
  for (const auto& [name, mesh] : meshes()) {
    if (name == "crossing" || name == "nested alike") continue;  // triangles within hide the depth
    const oracle::ExactMesh exact(triangles_of(mesh));
    const SolidDistance search(combined({mesh_primitive(name, mesh)}, SetOperation::unite));
    for (int k = 0; k < 30; ++k) {
      const Point x = random.point(k % 2 == 0 ? 1.0 : 2.5);
      const Enclosure found = distance(search, x, 1e-6);
      EXPECT_LE(found.width(), 1e-6) << name;
      const oracle::Fraction squared = exact.squared_distance(x);
      const bool is_in = exact.winding_number(x) != 0;
      EXPECT_TRUE(oracle::holds_root(is_in ? Enclosure{-found.hi, -found.lo} : found, squared)) << name;
    }
  }
}

/// The cube [-1, 1]^3 and a box over the upper half: of superquadrics, or meshes, in their place or posed.
Point turned_about_z(const Point& x, double degrees) {
  const double a = degrees * 0.017453292519943295;
  return {std::cos(a) * x[0] - std::sin(a) * x[1], std::sin(a) * x[0] + std::cos(a) * x[1], x[2]};
}

Pose about_z(double degrees) {
  const double a = degrees * 0.017453292519943295 / 2;
  return {{}, {std::cos(a), 0.0, 0.0, std::sin(a)}};
}

/// Signed distance of the box [lower, upper].
double of_box(const Point& x, const Point& lower, const Point& upper) {
  double outside = 0.0;
  double inside = -infinity;
  for (std::size_t i = 0; i < 3; ++i) {
    const double beyond = std::max(lower[i] - x[i], x[i] - upper[i]);
    outside = std::hypot(outside, std::max(0.0, beyond));
    inside = std::max(inside, beyond);
  }
  return inside > 0.0 ? outside : inside;
}

TEST(MeshSetTest, AMeshCutByABoxIsABox) {
  Random random(6);
  const Mesh cube = box_mesh({1.0, 1.0, 1.0});
  for (const double degrees : {0.0, 30.0}) {
    const Primitive mesh = mesh_primitive("cube", cube, about_z(degrees));
    Primitive upper{"", {{8.0, 8.0, 8.0}, {0.02, 0.02}}, about_z(degrees)};
    upper.pose.translation = {0.0, 0.0, 8.25};
    // As good as a box where it matters: near its axis, the face is flat to rounding.
    const SolidDistance both(combined({mesh, upper}, SetOperation::intersect));
    const SolidDistance rest(combined({mesh, upper}, SetOperation::subtract));
    const Primitive block =
        mesh_primitive("block", moved(box_mesh({8.0, 8.0, 8.0}), 1.0, {0, 0, 8.25}), about_z(degrees));
    const SolidDistance of_meshes(combined({mesh, block}, SetOperation::intersect));
    const SolidDistance rest_of_meshes(combined({mesh, block}, SetOperation::subtract));
    for (int k = 0; k < 40; ++k) {
      const Point x = random.point(k % 2 == 0 ? 1.0 : 2.0);
      const Point at = turned_about_z(x, degrees);
      const double upper_part = of_box(x, {-1, -1, 0.25}, {1, 1, 1});
      const double lower_part = of_box(x, {-1, -1, -1}, {1, 1, 0.25});
      for (const auto& [search, exact] : {std::pair(&both, upper_part), std::pair(&rest, lower_part),
                                          std::pair(&of_meshes, upper_part), std::pair(&rest_of_meshes, lower_part)}) {
        const Enclosure found = distance(*search, at, 1e-5);
        EXPECT_LE(found.lo, exact + 1e-12) << k << ' ' << degrees;
        EXPECT_GE(found.hi, exact - 1e-12) << k << ' ' << degrees;
        EXPECT_LE(found.width(), 1e-5) << k << ' ' << degrees << ' ' << exact << ' ' << found.lo << ' ' << found.hi;
      }
    }
  }
}

}  // namespace
}  // namespace verisq::verify
