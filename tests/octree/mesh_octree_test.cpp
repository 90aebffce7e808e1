/// Octrees of closed meshes: volumes that hold the exact one, who colours them, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/octree.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/grown_octree.hpp"
#include "tests/fixtures/mesh_scenes.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/superquadric.hpp"

namespace verisq::testing {
namespace {

/// By the divergence theorem: a sixth of the sum of determinants.
Enclosure exact_volume(const Mesh& mesh) {
  verify::PreciseInterval six(0);
  for (const auto& [i, j, k] : mesh.triangles) {
    const verify::PreciseVector a = verify::precise(mesh.vertices[i]);
    const verify::PreciseVector b = verify::precise(mesh.vertices[j]);
    const verify::PreciseVector c = verify::precise(mesh.vertices[k]);
    six += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return verify::rounded_outward(six / verify::PreciseInterval(6));
}

OctreeSummary grown(const Model& model, int depth, const std::string& device = "host") {
  OctreeOptions options;
  options.depth = depth;
  options.device = device;
  return OctreeBuilder(model, options).build();
}

/// A tetrahedron has more surface for its volume than a ball: its share is larger.
void expect_holds(const OctreeSummary& summary, const Enclosure& volume, double share) {
  EXPECT_LE(summary.volume.lo, volume.lo);
  EXPECT_GE(summary.volume.hi, volume.hi);
  EXPECT_LE(summary.volume.hi - summary.volume.lo, share * volume.hi);
}

TEST(MeshOctree, HoldsTheExactVolume) {
  const Pose pose{{0.25, 0.5, -0.75}, {0.8, 0.1, -0.5, 0.3}};
  for (const Mesh& mesh : {tetrahedron(), sphere_mesh(3), torus_mesh(1.0, 0.4, 24, 12)}) {
    const Enclosure volume = exact_volume(mesh);
    const double share = mesh.triangles.size() == 4 ? 0.75 : 0.5;
    for (const Mesh& solid : {mesh, turned(mesh)}) {
      expect_holds(grown({"", {mesh_primitive("mesh", solid)}}, 6), volume, share);
      expect_holds(grown({"", {mesh_primitive("mesh", solid, pose)}}, 6), volume, share);
    }
  }
}

/// A hollow ball as one mesh, and as a difference of two.
TEST(MeshOctree, OfDifferencesOfMeshes) {
  const Mesh outer = sphere_mesh(3);
  const Mesh inner = moved(outer, 0.75);
  const Enclosure of_outer = exact_volume(outer);
  const Enclosure of_inner = exact_volume(inner);
  const Enclosure volume{of_outer.lo - of_inner.hi - 1e-12, of_outer.hi - of_inner.lo + 1e-12};
  const SetExpression difference{{{{}, SetOperation::unite, 0}, {{}, SetOperation::unite, 1}}, SetOperation::subtract};
  expect_holds(grown({"", {mesh_primitive("hollow", join(outer, turned(inner)))}}, 6), volume, 0.5);
  expect_holds(grown({"", {mesh_primitive("outer", outer), mesh_primitive("inner", inner)}, difference}, 6), volume,
               0.5);
  const Primitive ball{"ball", {{0.75, 0.75, 0.75}, {1.0, 1.0}}, {}};
  const OctreeSummary mixed = grown({"", {mesh_primitive("outer", outer), ball}, difference}, 6);
  EXPECT_LT(mixed.volume.lo, volume.lo);
  EXPECT_GT(mixed.volume.hi, of_outer.lo - 4.0 / 3.0 * 3.1416 * 0.421875);
}

/// Unions, differences and intersections, in their place and turned.
std::vector<Model> checked_models() {
  const Pose pose{{0.25, 0.5, -0.75}, {0.8, 0.1, -0.5, 0.3}};
  const Mesh ball = sphere_mesh(2);
  const Primitive soap{"soap", {{0.75, 0.5, 1.25}, {0.5, 1.0}}, {.translation = {0.5, 0.0, 0.0}}};
  const SetExpression difference{{{{}, SetOperation::unite, 0}, {{}, SetOperation::unite, 1}}, SetOperation::subtract};
  SetExpression intersection = difference;
  intersection.operation = SetOperation::intersect;
  return {{"", {mesh_primitive("torus", torus_mesh(1.0, 0.4, 16, 8), pose)}},
          {"", {mesh_primitive("ball", ball), soap}},
          {"", {mesh_primitive("ball", ball, pose), soap}, difference},
          {"", {mesh_primitive("ball", ball), mesh_primitive("other", turned(ball), pose)}, intersection}};
}

TEST(MeshOctreeChecker, ProvesEveryCubeAndTheVolume) {
  for (const Model& model : checked_models()) {
    const auto [summary, cubes] = grow(model, 4);
    const OctreeChecker checker(model, summary.root, cubes);
    std::size_t black = 0;
    for (const ColouredCube& cube : checker.cubes()) {
      EXPECT_TRUE(checker.proves(cube));
      black += cube.colour == CubeColour::black ? 1 : 0;
    }
    EXPECT_GT(black, 0U);
    if (model.primitives.size() > 1) continue;
    const Enclosure volume = exact_volume(*model.primitives[0].mesh);
    EXPECT_LE(checker.volume().lo, volume.lo);
    EXPECT_GE(checker.volume().hi, volume.hi);
  }
}

/// Cubes through which the surface goes, and those of the other colour.
TEST(MeshOctreeChecker, ProvesNoFalseColour) {
  for (const Model& model : checked_models()) {
    const auto [summary, cubes] = grow(model, 4);
    std::vector<OctreeCube> black = cubes;
    for (OctreeCube& cube : black) cube.colour = CubeColour::black;
    const OctreeChecker of_black(model, summary.root, black);
    std::size_t proved = 0;
    for (const ColouredCube& cube : of_black.cubes()) {
      proved += cube.colour == CubeColour::black && of_black.proves(cube) ? 1 : 0;
    }
    const auto truly = static_cast<std::size_t>(std::ranges::count(cubes, CubeColour::black, &OctreeCube::colour));
    EXPECT_GE(proved, truly);
    const OctreeChecker of_white(model, summary.root, {});
    std::size_t white = 0;
    for (const OctreeCube& cube : cubes) {
      const double half = std::ldexp(1.0, -cube.level);
      Point centre;
      for (std::size_t i = 0; i < 3; ++i) centre[i] = (2.0 * cube.position[i] + 1.0) * half - 1.0;
      const bool as_white = of_white.proves({centre, half, CubeColour::white});
      const bool as_black = of_white.proves({centre, half, CubeColour::black});
      ASSERT_FALSE(as_white && as_black);
      ASSERT_FALSE(as_white && cube.colour == CubeColour::black);
      ASSERT_FALSE(as_black && cube.colour == CubeColour::white);
      white += as_white ? 1 : 0;
    }
    EXPECT_GT(white, 0U);
  }
}

/// Every cube of the surface holds points of both sides: neither colour is true.
TEST(MeshOctreeChecker, ProvesNoColourOfCubesThroughWhichTheSurfaceGoes) {
  const Mesh mesh = torus_mesh(1.0, 0.4, 16, 8);
  const Model model{"", {mesh_primitive("torus", mesh)}};
  const OctreeRoot root = grow(model, 1).summary.root;
  const OctreeChecker checker(model, root, {});
  for (const Point& vertex : mesh.vertices) {
    for (const double half : {0x1p-4, 0x1p-10, 0x1p-20}) {
      Point centre;
      for (std::size_t i = 0; i < 3; ++i) {
        const double place = (vertex[i] - root.centre[i]) / root.half_width;
        centre[i] = (std::floor(place / (2.0 * half)) * 2.0 + 1.0) * half;
      }
      EXPECT_FALSE(checker.proves({centre, half, CubeColour::white}));
      EXPECT_FALSE(checker.proves({centre, half, CubeColour::black}));
    }
  }
}

TEST(MeshOctree, IsTheHosts) {
  const Model model{"", {mesh_primitive("mesh", sphere_mesh(1))}};
  EXPECT_EQ(grown(model, 3, "auto").device, "host");
  for (const DeviceReport& report : test_devices()) {
    expect_error([&] { grown(model, 3, std::to_string(report.index)); }, ErrorKind::input, "",
                 "octree: the host colours meshes: no other device yet");
  }
}

TEST(MeshOctree, RefusesOpenMeshes) {
  Mesh open = tetrahedron();
  open.triangles.pop_back();
  Primitive primitive = mesh_primitive("mesh", tetrahedron());
  primitive.mesh = std::make_shared<const Mesh>(open);
  EXPECT_THAT([&] { grown({"", {primitive}}, 3); }, ::testing::Throws<Error>());
}

}  // namespace
}  // namespace verisq::testing
