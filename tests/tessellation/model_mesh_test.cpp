/// Meshes of models: closed, manifold, outward, as near to the surface as asked, in both directions, by proofs that
/// share nothing with what made them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/files.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/octree.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/places.hpp"

namespace verisq::testing {
namespace {

using std::numbers::pi;
using ::testing::SizeIs;

Model ball(const Point& centre, double radius) {
  return {"mm", {{"ball", {{radius, radius, radius}, {1.0, 1.0}}, {centre, {1.0, 0.0, 0.0, 0.0}}}}};
}

/// A and B by an operation.
Model combined(const Model& a, const Model& b, SetOperation operation) {
  Model model{"mm", {a.primitives[0], b.primitives[0]}};
  model.csg = SetExpression{.operands = {{.primitive = 0}, {.primitive = 1}}, .operation = operation};
  return model;
}

Model example(const char* name) {
  return read_model(std::string(places::example("")) + name);
}

Mesh mesh_of(const Model& model, double deviation) {
  return model_mesh(model, {.deviation = deviation}).mesh;
}

void expect_solid(const Mesh& mesh, std::size_t components) {
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented());
  EXPECT_EQ(topology.components, components);
}

double area(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Point& a = mesh.vertices[i];
    Point u;
    Point v;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      u[axis] = mesh.vertices[j][axis] - a[axis];
      v[axis] = mesh.vertices[k][axis] - a[axis];
    }
    sum += std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2.0;
  }
  return sum;
}

/// The proven volume, and what a layer of the deviation on the surface may add or take.
void expect_volume(const Mesh& mesh, const Model& model, double deviation) {
  OctreeOptions options;
  options.device = "host";
  options.depth = 6;
  const Enclosure volume = OctreeBuilder(model, options).build().volume;
  const double layer = deviation * area(mesh);
  EXPECT_GE(signed_volume(mesh), volume.lo - layer);
  EXPECT_LE(signed_volume(mesh), volume.hi + layer);
}

/// Proven distances of vertices and of centres of triangles, `count` of them.
void expect_on_surface(const Mesh& mesh, const Model& model, double deviation, std::size_t count) {
  const SignedDistance signed_distance(model);
  const std::size_t step = std::max<std::size_t>(1, mesh.triangles.size() / count);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += step) {
    const auto& [i, j, k] = mesh.triangles[t];
    const Point& corner = mesh.vertices[i];
    Point centre;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      centre[axis] = (corner[axis] + mesh.vertices[j][axis] + mesh.vertices[k][axis]) / 3.0;
    }
    for (const Point& point : {corner, centre}) {
      const Enclosure distance = signed_distance(point, 0.05 * deviation);
      EXPECT_LE(std::max(std::abs(distance.lo), std::abs(distance.hi)), deviation) << "triangle " << t;
    }
  }
}

double distance_to_vertices(const Mesh& mesh, const Point& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const Point& vertex : mesh.vertices) {
    least = std::min(least, std::hypot(vertex[0] - point[0], vertex[1] - point[1], vertex[2] - point[2]));
  }
  return least;
}

TEST(ModelMesh, OfOnePrimitiveHasVerticesOnItsEdgesAndCorners) {
  const Model box{"mm", {{"box", {{3.0, 2.0, 1.0}, {0.01, 0.01}}, {}}}};
  const Mesh mesh = mesh_of(box, 0.01);
  expect_solid(mesh, 1);
  EXPECT_THAT(mesh.triangles, SizeIs(::testing::Lt(3000)));
  EXPECT_NEAR(signed_volume(mesh), 48.0, 0.01 * area(mesh));
  // The corner of Eq. (1) itself: (1/2)^(e/2) of each semi-axis.
  const double corner = std::pow(0.5, 0.005);
  EXPECT_LT(distance_to_vertices(mesh, {3.0 * corner * corner, 2.0 * corner * corner, corner}), 1e-9);

  const Model octahedron{"mm", {{"octahedron", {{3.0, 2.0, 1.0}, {2.0, 2.0}}, {}}}};
  const Mesh faces = mesh_of(octahedron, 0.01);
  expect_solid(faces, 1);
  EXPECT_THAT(faces.triangles, SizeIs(::testing::Le(64)));
  EXPECT_NEAR(signed_volume(faces), 8.0, 1e-9);  // its faces are flat
}

TEST(ModelMesh, OfAPrimitiveIsAsNearAsAsked) {
  const Pose pose{{10.0, -3.0, 4.0}, {0.4, -1.0, 0.2, 3.0}};
  const std::vector<Primitive> primitives{{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, pose},
                                          {"soap", {{3.0, 2.0, 1.0}, {0.1, 0.3}}, pose},
                                          {"lens", {{2.0, 2.0, 0.1}, {1.7, 1.0}}, pose},
                                          {"wedge", {{1.0, 0.7, 4.0}, {0.3, 0.6}, 5.0}, pose},
                                          {"hook", {{0.3, 0.4, 3.0}, {0.4, 0.8}, 0.5}, pose, Bend{0.4, 30.0}}};
  for (const Primitive& primitive : primitives) {
    SCOPED_TRACE(primitive.name);
    const Model model{"mm", {primitive}};
    const ModelMesh found = model_mesh(model, {.deviation = 0.01});
    expect_solid(found.mesh, 1);
    EXPECT_LE(found.estimated_deviation, 0.01);
    EXPECT_LT(found.mesh.triangles.size(), 10000U);
    expect_on_surface(found.mesh, model, 0.01, 40);
    expect_volume(found.mesh, model, 0.01);
  }
}

TEST(ModelMesh, OfAUnionIsTheBoundaryOfTheWhole) {
  const auto expect = [](const char* name, double deviation, std::size_t components) {
    SCOPED_TRACE(name);
    const Model model = example(name);
    const ModelMesh found = model_mesh(model, {.deviation = deviation});
    expect_solid(found.mesh, components);
    EXPECT_LE(found.estimated_deviation, deviation);
    EXPECT_LT(found.mesh.triangles.size(), 20000U);
    expect_on_surface(found.mesh, model, deviation, 8);
    expect_volume(found.mesh, model, deviation);
  };
  expect("stem_mm.json", 0.2, 1);
  expect("bent_tapered_stem.json", 0.2, 1);
  expect("bent_stem.json", 0.001, 2);  // the head is bored wider than the neck
}

// Two balls of radius 1 whose centres are 1 apart: union, lens and crescent have known volumes.
TEST(ModelMesh, OfSetOperationsHasTheirVolume) {
  const Model a = ball({}, 1.0);
  const Model b = ball({1.0, 0.0, 0.0}, 1.0);
  const double lens = 5.0 * pi / 12.0;
  const double whole = 4.0 * pi / 3.0;
  const auto expect = [&](SetOperation operation, double volume) {
    const Model model = combined(a, b, operation);
    const Mesh mesh = mesh_of(model, 0.01);
    expect_solid(mesh, 1);
    EXPECT_NEAR(signed_volume(mesh), volume, 0.01 * area(mesh));
    expect_on_surface(mesh, model, 0.01, 8);
    // A point of the crease, which no vertex need meet.
    EXPECT_LT(distance_to_vertices(mesh, {0.5, 0.0, std::sqrt(0.75)}), 0.2);
  };
  expect(SetOperation::unite, 2.0 * whole - lens);
  expect(SetOperation::intersect, lens);
  expect(SetOperation::subtract, whole - lens);
}

TEST(ModelMesh, OfAShellHasAnInnerSurface) {
  const Model model = combined(ball({}, 1.0), ball({}, 0.8), SetOperation::subtract);
  const Mesh mesh = mesh_of(model, 0.01);
  expect_solid(mesh, 2);
  EXPECT_NEAR(signed_volume(mesh), 4.0 * pi / 3.0 * (1.0 - 0.512), 0.01 * area(mesh));
}

// In units of its size it is the same: squares of these lengths are no binary64 numbers.
TEST(ModelMesh, OfAHugeOrTinyModelIsThatOfAnOrdinaryOne) {
  const auto at_size = [](double size) {
    return model_mesh(combined(ball({}, size), ball({size, 0.0, 0.0}, 0.75 * size), SetOperation::subtract),
                      {.deviation = 0.05 * size});
  };
  const ModelMesh ordinary = at_size(1.0);
  for (const double size : {0x1p-997, 0x1p-515, 0x1p498, 0x1p997}) {
    SCOPED_TRACE(size);
    const ModelMesh found = at_size(size);
    EXPECT_EQ(found.mesh.triangles, ordinary.mesh.triangles);
    EXPECT_EQ(found.estimated_deviation, ordinary.estimated_deviation * size);
    for (std::size_t i = 0; i < ordinary.mesh.vertices.size(); ++i) {
      const auto& [x, y, z] = ordinary.mesh.vertices[i];
      EXPECT_EQ(found.mesh.vertices.at(i), (Point{x * size, y * size, z * size}));
    }
  }
}

TEST(ModelMesh, GridsPrimitivesThatAreApart) {
  Model model = ball({}, 1.0);
  const std::size_t alone = mesh_of(model, 0.01).triangles.size();
  model.primitives.push_back(ball({2.5, 0.0, 0.0}, 1.0).primitives[0]);
  const Mesh mesh = mesh_of(model, 0.01);
  expect_solid(mesh, 2);
  EXPECT_EQ(mesh.triangles.size(), 2 * alone);
}

TEST(ModelMesh, LeavesOutPrimitivesThatAreInside) {
  Model model = ball({}, 1.0);
  model.primitives.push_back(ball({0.1, 0.0, 0.0}, 0.5).primitives[0]);
  const Mesh mesh = mesh_of(model, 0.01);
  expect_solid(mesh, 1);
  EXPECT_NEAR(signed_volume(mesh), 4.0 * pi / 3.0, 0.01 * area(mesh));
}

TEST(ModelMesh, RefusesWhatHasNoMesh) {
  const Model one = ball({}, 1.0);
  expect_input_error([&] { (void)mesh_of(one, 0.0); }, "deviation", ": 0 is not a positive number");
  expect_input_error([&] { (void)mesh_of(one, std::nan("")); }, "deviation", ": nan is not a positive number");
  expect_input_error(
      [&] {
        (void)mesh_of(ball({1e15, 0.0, 0.0}, 1.0), 0.01);
      },
      "deviation 0.01", ": lost in the rounding of coordinates of 1e+15");
  const Model nothing = combined(ball({}, 1.0), ball({5.0, 0.0, 0.0}, 1.0), SetOperation::intersect);
  expect_input_error([&] { (void)mesh_of(nothing, 0.01); }, "model",
                     ": its solid has no point, or is thinner than the deviation");
  expect_input_error([&] { (void)model_mesh(example("stem_mm.json"), {.deviation = 0.1, .most_triangles = 1000}); },
                     "deviation 0.1", ": the mesh has more than 1000 triangles; give a larger one");
}

TEST(ModelMesh, EndsWhenInterrupted) {
  int polled = 0;
  ModelMeshOptions options{.deviation = 0.1};
  options.interrupted = [&] { return ++polled > 3; };
  const ModelMesh found = model_mesh(example("stem_mm.json"), options);
  EXPECT_TRUE(found.interrupted);
  EXPECT_TRUE(found.mesh.triangles.empty());
}

}  // namespace
}  // namespace verisq::testing
