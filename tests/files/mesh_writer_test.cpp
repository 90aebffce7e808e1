/// The mesh writers: what they write is what `read_mesh` reads.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <string>
#include <verisq/files.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using ::testing::ElementsAre;
using testing::expect_error;
using testing::expect_input_error;
using testing::TemporaryFolder;

/// Coordinates that short text or binary32 would change, and a vertex of no triangle.
Mesh awkward() {
  Mesh mesh = testing::tetrahedron();
  mesh.vertices[1] = {0.1, -1e-300, 1e300};
  mesh.vertices[2] = {1.0 / 3.0, 5e-324, -0.0};
  mesh.vertices.push_back({std::nextafter(1.0, 2.0), 123456789.123456789, -7.0});
  return mesh;
}

Mesh written_and_read(const Mesh& mesh, std::string_view name) {
  const TemporaryFolder folder;
  write_mesh(folder / name, mesh);
  EXPECT_THAT(folder.names(), ElementsAre(name));
  return read_mesh(folder / name);
}

TEST(WriteMesh, KeepsEveryBitInPlyOffAndObj) {
  const Mesh mesh = awkward();
  for (const char* name : {"mesh.ply", "mesh.off", "mesh.obj", "MESH.PLY"}) {
    const Mesh again = written_and_read(mesh, name);
    EXPECT_EQ(again.vertices, mesh.vertices) << name;
    EXPECT_TRUE(std::signbit(again.vertices[2][2])) << name;
    EXPECT_EQ(again.triangles, mesh.triangles) << name;
  }
}

TEST(WriteMesh, RoundsStlToBinary32) {
  Mesh mesh = testing::tetrahedron();
  mesh.vertices[3] = {0.1, 0.2, 1.0};
  const Mesh again = written_and_read(mesh, "mesh.stl");
  ASSERT_EQ(again.vertices.size(), 4U);
  ASSERT_EQ(again.triangles.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Point& exact = mesh.vertices[mesh.triangles[k][corner]];
      const Point& read = again.vertices[again.triangles[k][corner]];
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(read[i], static_cast<double>(static_cast<float>(exact[i])));
    }
  }
}

TEST(WriteMesh, GivesStlItsNormals) {
  const TemporaryFolder folder;
  const Mesh triangle{.vertices = {{0, 0, 5}, {2, 0, 5}, {0, 3, 5}}, .triangles = {{0, 1, 2}}};
  write_mesh(folder / "mesh.stl", triangle);
  const std::string contents = folder.contents("mesh.stl");
  ASSERT_EQ(contents.size(), 134U);
  EXPECT_EQ(contents.substr(84, 12), std::string("\0\0\0\0\0\0\0\0\0\0\x80\x3f", 12));  // 0, 0, 1.0F
}

TEST(WriteMesh, TakesPointsWithoutTriangles) {
  const Mesh points{.vertices = {{1, 2, 3}, {4, 5, 6}}, .triangles = {}};
  for (const char* name : {"points.ply", "points.off", "points.obj"})
    EXPECT_EQ(written_and_read(points, name).vertices, points.vertices) << name;
}

TEST(WriteMesh, ReplacesAnOlderFileOnlyByACompleteOne) {
  const TemporaryFolder folder;
  const auto file = folder.file("mesh.stl", "older");
  Mesh flat = testing::tetrahedron();
  flat.vertices[3] = {1e-60, 0.0, 0.0};  // 0 in binary32; beside the first two it has no area before
  const std::string once_rounded = " once rounded to STL's binary32; write a .ply";
  expect_input_error([&] { write_mesh(file, flat); }, file, ": triangle 3 has zero area" + once_rounded);
  EXPECT_EQ(folder.contents("mesh.stl"), "older");
  write_mesh(file, testing::tetrahedron());
  EXPECT_EQ(read_mesh(file).triangles.size(), 4U);
  EXPECT_THAT(folder.names(), ElementsAre("mesh.stl"));
}

TEST(WriteMesh, RefusesVerticesThatBinary32MakesOne) {
  const TemporaryFolder folder;
  Mesh apart = testing::tetrahedron();
  apart.vertices.push_back({1 + 1e-12, 0, 0});
  apart.triangles[3] = {4, 2, 3};
  expect_input_error([&] { write_mesh(folder / "mesh.stl", apart); }, folder / "mesh.stl",
                     ": vertices 1 and 4 are one point once rounded to STL's binary32; write a .ply");
  EXPECT_THAT(folder.names(), ElementsAre());
  write_mesh(folder / "mesh.ply", apart);
}

TEST(WriteMesh, Refuses) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& name, const Mesh& mesh, const std::string& rest) {
    expect_input_error([&] { write_mesh(folder / name, mesh); }, folder / name, rest);
    EXPECT_THAT(folder.names(), ElementsAre());
  };
  Mesh mesh = testing::tetrahedron();
  refused("mesh.vtk", mesh, ": unknown mesh format '.vtk': written are .ply, .stl, .off, .obj");
  expect_input_error([&] { check_mesh_name(folder / "mesh"); }, folder / "mesh",
                     ": unknown mesh format '': written are .ply, .stl, .off, .obj");
  mesh.vertices[2][1] = -1e39;
  refused("mesh.stl", mesh,
          ": vertex 2: a coordinate is not a finite number once rounded to STL's binary32; write a .ply");
  mesh.vertices[2][1] = std::numeric_limits<double>::quiet_NaN();
  refused("mesh.off", mesh, ": vertex 2: a coordinate is not a finite number");
  mesh = testing::tetrahedron();
  mesh.triangles[0] = {1, 2, 1};
  refused("mesh.obj", mesh, ": triangle 1 names a vertex twice");
  const auto nowhere = folder / "none/mesh.ply";
  expect_error([&] { write_mesh(nowhere, testing::tetrahedron()); }, ErrorKind::failure, nowhere.string(),
               ": cannot be written: No such file or directory");
}

}  // namespace
}  // namespace verisq
