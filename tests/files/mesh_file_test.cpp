/// The mesh readers: every format, merging, fans, exact zero areas, and the message for everything refused.
#include "host/files/mesh_file.hpp"

#include <gmock/gmock.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <verisq/enclosure.hpp>
#include <verisq/files.hpp>

#include "host/files/input_file.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using ::testing::ElementsAre;
using testing::expect_input_error;
using ::testing::IsEmpty;
using testing::TemporaryFolder;
using Triangle = std::array<std::uint32_t, 3>;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

template <class Number>
std::string bytes(Number number, std::endian order) {
  if (order != std::endian::native) number = reversed_bytes(number);
  const auto array = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  return {array.data(), array.size()};
}

template <class Number>
std::string little(Number number) {
  return bytes(number, std::endian::little);
}

using Corner = std::array<float, 3>;

std::string binary_stl(const std::vector<std::array<Corner, 3>>& triangles, std::string header = "binary") {
  header.resize(80, ' ');
  std::string result = header + little(static_cast<std::uint32_t>(triangles.size()));
  for (const auto& triangle : triangles) {
    result += little(nan) + little(nan) + little(nan);  // the normal is not read
    for (const Corner& corner : triangle) result += little(corner[0]) + little(corner[1]) + little(corner[2]);
    result += "\1\2";
  }
  return result;
}

/// Reads `contents` as a file of that extension.
Mesh read(std::string_view extension, std::string_view contents) {
  const TemporaryFolder folder;
  return read_mesh(folder.file("mesh" + std::string(extension), contents));
}

void expect_refusal(std::string_view extension, std::string_view contents, const std::string& rest) {
  const TemporaryFolder folder;
  const auto path = folder.file("mesh" + std::string(extension), contents);
  expect_input_error([&] { (void)read_mesh(path); }, path, rest);
}

// --- any format --------------------------------------------------------------------------------------------------

TEST(MeshFile, RefusesWhatIsNoMeshFile) {
  const TemporaryFolder folder;
  const auto refused = [](const std::filesystem::path& path, const std::string& rest) {
    expect_input_error([&] { (void)read_mesh(path); }, path, rest);
  };
  refused(folder / "none.stl", ": no such file");
  refused(folder.file("m.3mf", "x"), ": unknown mesh format '.3mf': known are .stl, .obj, .ply, .off, .vtp, .vtk");
  refused(folder.file("m", "x"), ": unknown mesh format '': known are .stl, .obj, .ply, .off, .vtp, .vtk");
  std::filesystem::create_directory(folder / "d.stl");
  refused(folder / "d.stl", ": is a directory, not a file");
  std::filesystem::create_directory(folder / "d");
  refused(folder / "d", ": is a directory, not a file");
  for (const char* name : {"m.stl", "m.obj", "m.ply", "m.off", "m.vtp", "m.vtk"})
    refused(folder.file(name, ""), ": the file is empty");
}

TEST(MeshFile, ExtensionsInAnyCase) {
  EXPECT_EQ(read(".ObJ", "v 1 2 3\n").vertices.size(), 1U);
}

TEST(MeshFile, ReadsTextToTheNearestBinary64) {
  const Mesh mesh = read(".obj", "v 0.1 +1e-400 1.00000000000000011102230246251565405\nv -4e-324 1e23 .5\n");
  EXPECT_THAT(mesh.vertices, ElementsAre(Point{0.1, 0.0, 1.0 + std::numeric_limits<double>::epsilon()},
                                         Point{-std::numeric_limits<double>::denorm_min(), 1e23, 0.5}));
}

// --- zero area ---------------------------------------------------------------------------------------------------

TEST(TriangleArea, IsExact) {
  EXPECT_TRUE(has_zero_area({0, 0, 0}, {1, 1, 1}, {3, 3, 3}));
  EXPECT_TRUE(has_zero_area({1, 2, 3}, {1, 2, 3}, {0, 0, 0}));
  EXPECT_FALSE(has_zero_area({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  // The rounded edges 1e16 - 1 and so on lose the units that make the difference.
  EXPECT_FALSE(has_zero_area({1, 1, 0}, {1e16, 1e16, 0}, {-1e16, -1e16 + 2, 0}));
  EXPECT_TRUE(has_zero_area({1, 1, 0}, {1e16, 1e16, 0}, {-1e16, -1e16, 0}));
  // One unit in the last place off the line, which the rounded products do not show.
  const double above = std::nextafter(0.6, 1.0);
  EXPECT_TRUE(has_zero_area({0, 0, 0}, {0.1, 0.2, 0}, {0.3, 2 * 0.3, 0}));
  EXPECT_FALSE(has_zero_area({0, 0, 0}, {0.1, 0.2, 0}, {0.3, above, 0}));
}

TEST(TriangleArea, NeitherUnderflowsNorOverflows) {
  const double tiny = std::numeric_limits<double>::denorm_min();
  const double huge = std::numeric_limits<double>::max();
  EXPECT_FALSE(has_zero_area({0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}));
  EXPECT_TRUE(has_zero_area({0, 0, 0}, {tiny, tiny, 0}, {3 * tiny, 3 * tiny, 0}));
  EXPECT_FALSE(has_zero_area({-huge, -huge, 0}, {huge, -huge, 0}, {0, huge, 0}));
  EXPECT_TRUE(has_zero_area({-huge, -huge, -huge}, {huge, huge, huge}, {1, 1, 1}));
  EXPECT_FALSE(has_zero_area({-huge, -huge, -huge}, {huge, huge, huge}, {1, 1, 1 + 1e-15}));
  EXPECT_TRUE(has_zero_area({0, 0, 0}, {huge, huge, huge}, {tiny, tiny, tiny}));
  EXPECT_FALSE(has_zero_area({0, 0, 0}, {huge, huge, huge}, {tiny, tiny, 2 * tiny}));
}

// --- STL ---------------------------------------------------------------------------------------------------------

const std::vector<std::array<Corner, 3>> two_triangles{{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                                                       {{{1, 0, 0}, {1, 1, 0.1F}, {-0.0F, 1, -0.0F}}}};

TEST(Stl, BinaryMergesEqualCorners) {
  const Mesh mesh = read(".stl", binary_stl(two_triangles));
  EXPECT_THAT(mesh.vertices,
              ElementsAre(Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}, Point{1, 1, static_cast<double>(0.1F)}));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
}

TEST(Stl, BinaryMayStartWithSolid) {
  EXPECT_EQ(read(".stl", binary_stl(two_triangles, "solid says the header")).triangles.size(), 2U);
}

TEST(Stl, MergesAcrossTheGrowthOfTheTable) {
  constexpr int side = 150;  // (side + 1)^2 vertices: the table grows five times
  std::vector<std::array<Corner, 3>> triangles;
  const auto corner = [](int i, int j) { return Corner{static_cast<float>(i), static_cast<float>(j) / 3, 0}; };
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      triangles.push_back({corner(i, j), corner(i + 1, j), corner(i, j + 1)});
      triangles.push_back({corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)});
    }
  }
  const Mesh mesh = read(".stl", binary_stl(triangles));
  EXPECT_EQ(mesh.vertices.size(), static_cast<std::size_t>((side + 1) * (side + 1)));
  ASSERT_EQ(mesh.triangles.size(), triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const Corner& expected = triangles[t][c];
      EXPECT_EQ(mesh.vertices[mesh.triangles[t][c]], (Point{expected[0], expected[1], expected[2]}));
    }
  }
}

std::string facet(const std::string& a, const std::string& b, const std::string& c) {
  return " facet normal 0 0 nan\n  outer loop\n   vertex " + a + "\n   vertex " + b + "\n   vertex " + c +
         "\n  endloop\n endfacet\n";
}

TEST(Stl, AsciiMergesAndJoinsSolids) {
  const std::string text = "\nSolid one\r\n" + facet("0 0 0", "1 0 0", "0 1 0") + "endsolid one\nsolid\n" +
                           facet("1 0 0", "1 1 0.1", "-0 1.0 -0.0") + "endsolid";
  const Mesh mesh = read(".STL", text);
  EXPECT_THAT(mesh.vertices, ElementsAre(Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}, Point{1, 1, 0.1}));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
}

TEST(Stl, RefusesBinary) {
  const std::string whole = binary_stl(two_triangles);
  expect_refusal(".stl", whole.substr(0, 183),
                 ": truncated: the header promises 2 triangles, 184 bytes; the file has 183 bytes");
  expect_refusal(".stl", binary_stl(two_triangles, "solid").substr(0, 150),
                 ": truncated: the header promises 2 triangles, 184 bytes; the file has 150 bytes");
  expect_refusal(".stl", whole + "x", ": too long: the header promises 2 triangles, 184 bytes; the file has 185 bytes");
  expect_refusal(".stl", std::string(80, '\0') + "\xff\xff\xff\xff",
                 ": truncated: the header promises 4294967295 triangles, 214748364834 bytes; the file has 84 bytes");
  expect_refusal(".stl", std::string(40, '\0'), ": byte 0: truncated: the file ends after 40 bytes, inside the header");
  expect_refusal(".stl", binary_stl({}), ": no triangles");
  expect_refusal(".stl", "Hello", ": not an STL file: text that does not start with 'solid'");
}

TEST(Stl, ALineEndMayFollow) {
  const std::string whole = binary_stl(two_triangles, std::string("by hand\0", 8));
  EXPECT_EQ(read(".stl", whole + "\n").triangles.size(), 2U);
  EXPECT_EQ(read(".stl", whole + "\r\n").triangles.size(), 2U);
  expect_refusal(".stl", whole + "\n\n",
                 ": too long: the header promises 2 triangles, 184 bytes; the file has 186 bytes");
}

TEST(Stl, TextWithAZeroByteIsText) {
  expect_refusal(".stl", "solid a\n" + facet("0 0 0", "1 0 0", "0 1 0") + std::string("endsolid a\n\0", 12),
                 ": line 10: expected 'solid', found '\\x00'");
}

/// A square of two triangles; beside them its diagonal once more, a side, a corner, and a line through three vertices.
TEST(MeshFile, KeepsTrianglesWithoutAreaUnlessTheyAreSidesOfOthers) {
  const Mesh obj = read(".obj",
                        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 2 0\n"
                        "f 1 2 3\nf 1 3 1\nf 1 3 4\nf 2 1 1\nf 4 4 4\nf 1 3 5\n");
  EXPECT_EQ(obj.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 2, 4}}));
  std::vector<std::array<Corner, 3>> triangles = two_triangles;
  triangles.push_back({{{1, 0, 0}, {1, 0, 0}, {0, 0, 0}}});
  triangles.push_back({{{1, 0, 0}, {2, 0, 0}, {4, 0, 0}}});
  EXPECT_EQ(read(".stl", binary_stl(triangles)).triangles.size(), 3U);
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nf 1 2 3\n";
  expect_refusal(".obj", three + "f 4 4 4\n",
                 ": triangle 2 names a vertex twice, and its line from (9, 9, 9) to (9, 9, 9) is no side of another "
                 "triangle: leave it out");
}

TEST(Stl, RefusesBinaryValues) {
  auto triangles = two_triangles;
  triangles[1][1][2] = nan;
  expect_refusal(".stl", binary_stl(triangles), ": byte 134: triangle 2: coordinate z = nan: not a finite number");
  triangles[1][1][2] = -std::numeric_limits<float>::infinity();
  expect_refusal(".stl", binary_stl(triangles), ": byte 134: triangle 2: coordinate z = -inf: not a finite number");
  triangles[1] = {{{1, 0, 0}, {2, 0, 0}, {2, 0, 0}}};
  expect_refusal(".stl", binary_stl(triangles),
                 ": triangle 2 names a vertex twice, and its line from (1, 0, 0) to (2, 0, 0) is no side of another "
                 "triangle: leave it out");
}

TEST(Stl, RefusesAscii) {
  const std::string good = facet("0 0 0", "1 0 0", "0 1 0");
  expect_refusal(".stl", "solid\n" + facet("0 0 0", "1 nan 0", "0 1 0"), ": line 5: y = 'nan': not a finite number");
  expect_refusal(".stl", "solid\n" + facet("0 0 0", "1 0 -inf", "0 1 0"), ": line 5: z = '-inf': not a finite number");
  expect_refusal(".stl", "solid\n" + facet("0 0 1e999", "1 0 0", "0 1 0"),
                 ": line 4: z = '1e999': beyond the range of binary64");
  expect_refusal(".stl", "solid\n" + facet("0 0 0", "1 0,5 0", "0 1 0"), ": line 5: y = '0,5': not a number");
  expect_refusal(".stl", "solid\n" + facet("0 0 0", "1 0", "0 1 0"), ": line 5: z is missing");
  expect_refusal(".stl", "solid\n" + facet("0 0 0", "1 0 0 0", "0 1 0"), ": line 5: unexpected '0'");
  expect_refusal(".stl", "solid\n" + good + facet("0 0 0", "2 0 0", "-0 0 0") + "endsolid\n",
                 ": triangle 2 names a vertex twice, and its line from (0, 0, 0) to (2, 0, 0) is no side of another "
                 "triangle: leave it out");
  expect_refusal(".stl", "solid\n" + good, ": line 8: truncated: the file ends without 'endsolid'");
  expect_refusal(".stl", "solid\nfacet\n outer loop\n",
                 ": line 3: truncated: the file ends where 'vertex' should follow");
  expect_refusal(".stl", "solid\nfacet\n vertex 1 2 3\n", ": line 3: expected 'outer loop', found 'vertex 1 2 3'");
  expect_refusal(".stl", "solid\nvertex\n", ": line 2: expected 'facet' or 'endsolid', found 'vertex'");
  expect_refusal(".stl", "solid\nendsolid\nfacet\n", ": line 3: expected 'solid', found 'facet'");
  expect_refusal(".stl", "solid\nendsolid\n", ": no triangles");
}

// --- OBJ ---------------------------------------------------------------------------------------------------------

TEST(Obj, ReadsAllFormsOfFaces) {
  const Mesh mesh = read(".obj",
                         "# a comment\nmtllib x.mtl\r\nv 0 0 0\r\nv 1 0 0 1.0\n  v\t1 1 0 0.5 0.5 0.5\nv 0 1 0 # last\n"
                         "vt 0 0\nvn 0 0 1\ng x\nf 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\nf 1/1/1 2/1/1 3/1/1\n"
                         "f -4 -3 -2 -1\nl 1 2");
  EXPECT_THAT(mesh.vertices, ElementsAre(Point{0, 0, 0}, Point{1, 0, 0}, Point{1, 1, 0}, Point{0, 1, 0}));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 1, 2}, Triangle{0, 1, 2}, Triangle{0, 1, 2},
                                          Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(Obj, PointClouds) {
  EXPECT_THAT(read(".obj", "v 0 0 0\nv 1 0 0\n").triangles, IsEmpty());
}

TEST(Obj, Refuses) {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_refusal(".obj", "v 0 NaN 0\n", ": line 1: y = 'NaN': not a finite number");
  expect_refusal(".obj", "v 0 0 0x1\n", ": line 1: z = '0x1': not a number");
  expect_refusal(".obj", "v 0 0\n", ": line 1: z is missing");
  expect_refusal(".obj", "v 0 0 0 red\n", ": line 1: weight or colour = 'red': not a number");
  expect_refusal(".obj", three + "f 1 2 4\n",
                 ": line 4: vertex index 4: out of range, 3 vertices so far, counted from 1");
  expect_refusal(".obj", three + "f 0 1 2\n",
                 ": line 4: vertex index 0: out of range, 3 vertices so far, counted from 1");
  expect_refusal(".obj", three + "f -4 1 2\n",
                 ": line 4: vertex index -4: out of range, 3 vertices so far, counted from 1");
  expect_refusal(".obj", three + "f 1 2 3.0\n",
                 ": line 4: face corner '3.0': not of the form v, v/vt, v//vn or v/vt/vn");
  expect_refusal(".obj", three + "f 1 2 3/1/1/1\n",
                 ": line 4: face corner '3/1/1/1': not of the form v, v/vt, v//vn or v/vt/vn");
  expect_refusal(".obj", three + "f 1 2 /3\n", ": line 4: vertex index is missing");
  expect_refusal(".obj", three + "f 1 2 99999999999999999999\n",
                 ": line 4: vertex index = '99999999999999999999': not an integer");
  expect_refusal(".obj", three + "f 1 2\n", ": line 4: number of corners = 2: a face needs at least 3");
  expect_refusal(".obj", three + "\nf 1 2 2\n",
                 ": triangle 1 names a vertex twice, and its line from (0, 0, 0) to (1, 0, 0) is no side of another "
                 "triangle: leave it out");
  expect_refusal(".obj", "# nothing\n", ": no vertices");
  expect_refusal(".obj", std::string("\0\1\2", 3), ": line 1: record '\\x00\\x01\\x02': not one of OBJ");
}

TEST(Obj, RefusesRecordsThatAreGeometryToOthers) {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_refusal(".obj", "V 0 0 0\n" + three, ": line 1: record 'V': not one of OBJ");
  expect_refusal(".obj", "\xA0v 0 0 0\n" + three, ": line 1: record '\\xa0v': not one of OBJ");
  expect_refusal(".obj", three + "face 1 2 3\n", ": line 4: record 'face': not one of OBJ");
  for (const std::string record : {"surf", "curv", "bzp", "cstype", "call"}) {
    expect_refusal(".obj", three + record + " 0 1\n",
                   ": line 4: record '" + record +
                       "': only surfaces of polygons in one file are read, by v and f; export polygons");
  }
  EXPECT_EQ(
      read(".obj", three + "o a\ng a b\ns off\nusemtl x\nvp 0.5\np 1\nl 1 2 3\nlod 1\nfo 1 2 3\n").triangles.size(),
      1U);
}

TEST(Obj, RecordsGoOnBehindABackslash) {
  const std::string four = "v 0 0 0\nv 10 0 \\\r\n 0\nv 10 10 0\nv 0 10 0\n";
  EXPECT_THAT(read(".obj", four + "f 1 2 \\\n3 \\ \n\\\n 4 # the last\n").triangles,
              ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  // One that ends a comment, or a folder's name, does not take the next record with it.
  EXPECT_EQ(read(".obj", "# C:\\bones\\\n" + four).vertices.size(), 4U);
  expect_refusal(".obj", "mtllib C:\\bones\\\n" + four,
                 ": line 2: record 'v' behind a line that ends with a backslash: it would belong to that");
  expect_refusal(".obj", four + "f 1 2 3 \\",
                 ": line 6: truncated: the file ends where a line should follow that ends with a backslash");
}

// --- polygons --------------------------------------------------------------------------------------------------------

TEST(Polygons, OfAllFormatsAreCutAlike) {
  const auto expect_cut = [](const Mesh& mesh) {
    ASSERT_EQ(mesh.triangles.size(), 4U);
    double area = 0.0;
    for (const Triangle& corners : mesh.triangles) {
      const auto at = [&](std::size_t corner, std::size_t axis) {
        return mesh.vertices[corners[corner]][axis] - mesh.vertices[corners[0]][axis];
      };
      const double twice = at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0);
      EXPECT_GT(twice, 0.0);
      area += twice / 2;
    }
    EXPECT_EQ(area, 3.0) << "of the L";
  };
  const std::string points = "0 0 0\n2 0 0\n2 1 0\n1 1 0\n1 2 0\n0 2 0\n";
  expect_cut(read(".off", "OFF\n6 1 0\n" + points + "6 2 3 4 5 0 1\n"));
  expect_cut(read(".ply",
                  "ply\nformat ascii 1.0\nelement vertex 6\nproperty int x\nproperty int y\nproperty int z\n"
                  "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
                      points + "6 2 3 4 5 0 1\n"));
  expect_cut(read(".obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 3 4 5 6 1 2\n"));
}

TEST(Polygons, AreRefusedByTheirNumber) {
  expect_refusal(".off", "OFF\n4 2 0\n0 0 0\n1 1 0\n1 0 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n",
                 ": line 8: face 2: its outline crosses or touches itself, at the edges from corners 1 and 3; split it "
                 "into triangles");
}

TEST(Obj, RefusesEndlessLines) {
  expect_refusal(".obj", "v 1 2 3\nv " + std::string(17000000, ' '), ": line 2: longer than 16777216 characters");
}

TEST(Obj, LinesAcrossTheBlocksOfTheReader) {
  std::string text;
  for (int k = 0; k < 120000; ++k) text += "v " + std::to_string(k) + ".5 -1.25 1e-3\n";
  ASSERT_GT(text.size(), std::size_t{1} << 21);
  const Mesh mesh = read(".obj", text);
  ASSERT_EQ(mesh.vertices.size(), 120000U);
  for (std::size_t k = 0; k < 120000; ++k) {
    ASSERT_EQ(mesh.vertices[k], (Point{static_cast<double>(k) + 0.5, -1.25, 1e-3}));
  }
}

// --- PLY ---------------------------------------------------------------------------------------------------------

std::string ply_header(const std::string& format, const std::string& rest) {
  return "ply\nformat " + format + " 1.0\ncomment a comment\nobj_info none\n" + rest + "end_header\n";
}

TEST(Ply, AsciiWithOtherPropertiesAndElements) {
  const Mesh mesh =
      read(".ply", ply_header("ascii",
                              "element material 1\nproperty list uchar float shades\nproperty int id\n"
                              "element vertex 4\nproperty float nx\nproperty double z\nproperty float y\n"
                              "property float32 x\nproperty uchar red\nelement face 2\nproperty uchar flag\n"
                              "property list uchar int vertex_index\nelement edge 1\nproperty int a\n") +
                       "3 .1 .2 .3 7\n"
                       "nan 0 0 0 255\nnan 0.1 0 1 255\nnan 0 1 1 255\nnan 0 1 0 255\n"
                       "9 4 0 1 2 3\n9 3 0 1 2\n5\n\n");
  EXPECT_THAT(mesh.vertices, ElementsAre(Point{0, 0, 0}, Point{1, 0, 0.1}, Point{1, 1, 0}, Point{0, 1, 0}));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{0, 1, 2}));
}

std::string binary_ply(std::endian order) {
  const std::string name = order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
  std::string result =
      ply_header(name,
                 "element material 1\nproperty list ushort double shades\n"
                 "element vertex 3\nproperty short x\nproperty double y\nproperty list char uint16 tags\n"
                 "property float z\n"
                 "element face 1\nproperty list uint uint vertex_indices\nproperty char flag\n");
  result += bytes<std::uint16_t>(2, order) + bytes(infinity, order) + bytes(1.0, order);
  const std::array<Point, 3> points{{{-300, 0.1, 0}, {1, 2, 3}, {258, 1e300, static_cast<double>(0.1F)}}};
  for (const Point& p : points) {
    result += bytes(static_cast<std::int16_t>(p[0]), order) + bytes(p[1], order) + bytes<std::int8_t>(1, order) +
              bytes<std::uint16_t>(77, order) + bytes(static_cast<float>(p[2]), order);
  }
  return result + bytes<std::uint32_t>(3, order) + bytes<std::uint32_t>(2, order) + bytes<std::uint32_t>(0, order) +
         bytes<std::uint32_t>(1, order) + "\xff";
}

TEST(Ply, BinaryOfBothByteOrders) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const Mesh mesh = read(".ply", binary_ply(order));
    EXPECT_THAT(mesh.vertices,
                ElementsAre(Point{-300, 0.1, 0}, Point{1, 2, 3}, Point{258, 1e300, static_cast<double>(0.1F)}));
    EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{2, 0, 1}));
  }
}

TEST(Ply, CommentsMayComeFirstAndALineEndLast) {
  const std::string rest = "element vertex 1\nproperty char x\nproperty char y\nproperty char z\nend_header\n";
  for (const std::string end : {"", "\n", "\r\n"}) {
    EXPECT_THAT(
        read(".ply", "ply\ncomment by hand\nformat binary_little_endian 1.0\n" + rest + "\1\2\3" + end).vertices,
        ElementsAre(Point{1, 2, 3}));
  }
}

TEST(Ply, HeaderWithCarriageReturns) {
  const Mesh mesh = read(".ply",
                         "ply\r\nformat ascii 1.0\r\nelement vertex 1\r\nproperty float x\r\nproperty float y\r\n"
                         "property float z\r\nend_header\r\n1 2 3\r\n");
  EXPECT_THAT(mesh.vertices, ElementsAre(Point{1, 2, 3}));
}

TEST(Ply, RefusesEveryTruncationOfABinary) {
  const TemporaryFolder folder;
  const std::string whole = binary_ply(std::endian::little);
  for (std::size_t length = 1; length < whole.size(); ++length) {
    const auto path = folder.file("cut.ply", std::string_view(whole).substr(0, length));
    EXPECT_THROW((void)read_mesh(path), Error) << length;
  }
}

const std::string xyz = "property double x\nproperty double y\nproperty double z\n";
const std::string faces = "property list uchar int vertex_indices\n";

std::string ascii_ply(const std::string& vertices, int vertex_count, const std::string& face_rows, int face_count) {
  return ply_header("ascii", "element vertex " + std::to_string(vertex_count) + "\n" + xyz + "element face " +
                                 std::to_string(face_count) + "\n" + faces) +
         vertices + face_rows;
}

TEST(Ply, RefusesAscii) {
  const std::string three = "0 0 0\n1 0 0\n0 1 0\n";  // lines 12 to 14
  expect_refusal(".ply", ascii_ply("0 0 nan\n", 1, "", 0), ": line 12: z = 'nan': not a finite number");
  expect_refusal(".ply", ascii_ply("0 0 0 0\n", 1, "", 0), ": line 12: unexpected '0' after the last property");
  expect_refusal(".ply", ascii_ply("0 0  \n1 1 1", 1, "", 0), ": line 12: z is missing");
  expect_refusal(".ply", ascii_ply(three, 3, "3 0 1 3\n", 1),
                 ": line 15: vertex index 3: out of range, the file has 3 vertices, counted from 0");
  expect_refusal(".ply", ascii_ply(three, 3, "3 0 1 -1\n", 1),
                 ": line 15: vertex index -1: out of range, the file has 3 vertices, counted from 0");
  expect_refusal(".ply", ascii_ply(three, 3, "3 0 1 1.5\n", 1), ": line 15: vertex index = '1.5': not an integer");
  expect_refusal(".ply", ascii_ply(three, 3, "3 0 1\n", 1), ": line 15: vertex index is missing");
  expect_refusal(".ply", ascii_ply(three, 3, "3 0 1 0\n", 1),
                 ": triangle 1 names a vertex twice, and its line from (0, 0, 0) to (1, 0, 0) is no side of another "
                 "triangle: leave it out");
  expect_refusal(".ply", ascii_ply(three, 3, "2 0 1\n", 1),
                 ": line 15: number of corners = 2: a face needs at least 3");
  expect_refusal(".ply", ascii_ply(three, 3, "3 0 1 2\n5\n", 1), ": line 16: unexpected '5' after the last element");
  expect_refusal(".ply", ascii_ply(three, 3, "3 0 1 2\n", 2),
                 ": line 15: truncated: the file ends inside element 'face'");
  expect_refusal(".ply", ascii_ply("", 0, "", 0), ": no vertices");
}

TEST(Ply, RefusesHeaders) {
  const auto refused = [](const std::string& text, const std::string& rest) { expect_refusal(".ply", text, rest); };
  refused("solid\n", ": line 1: not a PLY file: the first line must be 'ply'");
  refused("ply\nelement vertex 1\n", ": line 2: the first line after 'ply' and comments must be 'format ENCODING 1.0'");
  refused("ply\nformat ascii 2.0\n", ": line 2: version '2.0': must be 1.0");
  refused("ply\nformat binary 1.0\n",
          ": line 2: format 'binary': known are ascii, binary_little_endian, binary_big_endian");
  refused("ply\nformat ascii 1.0\nelement vertex\n", ": line 3: number of elements is missing");
  refused("ply\nformat ascii 1.0\nelement vertex -3\n", ": line 3: number of elements = -3: must not be negative");
  refused("ply\nformat ascii 1.0\nproperty int x\n", ": line 3: a property before the first element");
  refused("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\n",
          ": line 4: property type 'real': not a type of PLY");
  refused("ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\n",
          ": line 4: the length of a list must have an integer type");
  refused("ply\nformat ascii 1.0\nelement vertex 1\nproperty int\n", ": line 4: a property without a name");
  refused("ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int x\n",
          ": line 5: property 'x': appears twice");
  refused("ply\nformat ascii 1.0\nelement vertex 1\nelement vertex 1\n", ": line 4: element 'vertex': appears twice");
  refused("ply\nformat ascii 1.0\nelement vertex 1\nend_header\n", ": line 4: element 'vertex': has no properties");
  refused("ply\nformat ascii 1.0\nhello\n", ": line 3: header keyword 'hello': not known");
  refused("ply\nformat ascii 1.0\n", ": line 2: truncated: the file ends without 'end_header'");
  refused(ply_header("ascii", "element vertex 1\nproperty int x\nproperty int y\n") + "1 2\n",
          ": element 'vertex' has no property 'z' of a single number");
  refused(ply_header("ascii", "element vertex 1\n" + xyz + "element face 1\nproperty int x\n") + "1 2 3\n1\n",
          ": element 'face' has no property 'vertex_indices' or 'vertex_index'");
  refused(ply_header("ascii", "element vertex 1\n" + xyz + "element face 1\nproperty list uchar float vertex_index\n") +
              "1 2 3\n1 1\n",
          ": element 'face': property 'vertex_index' must be a list of integers");
  refused(ply_header("ascii", "element face 1\n" + faces + "element vertex 1\n" + xyz) + "3 0 0 0\n1 2 3\n",
          ": element 'face' before element 'vertex' is not supported");
  refused(ply_header("ascii", "element vertex 1\n" + xyz + "element tristrips 1\n" + faces) + "1 2 3\n3 0 0 0\n",
          ": element 'tristrips' is not supported: triangles must be in element 'face'");
}

TEST(Ply, ShowsHostileNamesInOneShortLine) {
  const std::string vertex = "element vertex 1\n" + xyz;
  expect_refusal(".ply", ply_header("ascii", vertex + "property int \x1b[2J\xff\n") + "1.0 2.0 3.0\n",
                 ": line 11: '\\x1b[2J\\xff' is missing");
  expect_refusal(
      ".ply", ply_header("ascii", vertex + "property list int int " + std::string(1000, 'n') + "\n") + "1.0 2.0 3.0\n",
      ": line 11: '" + std::string(60, 'n') + "...' is missing");
}

// A name is looked up among all others: the time must not grow with the square of their number.
TEST(Ply, ReadsVeryLongHeaders) {
  constexpr int many = 200'000;
  std::string elements = "element vertex 1\n" + xyz + "element other 0\n";
  for (int k = 0; k < many; ++k) elements += "property char p" + std::to_string(k) + "\n";
  for (int k = 0; k < many; ++k) elements += "element e" + std::to_string(k) + " 0\n";
  EXPECT_THAT(read(".ply", ply_header("ascii", elements) + "1 2 3\n").vertices, ElementsAre(Point{1, 2, 3}));
}

TEST(Ply, RefusesCountsThatTheFileCannotHold) {
  expect_refusal(".ply", ply_header("ascii", "element vertex 9000000000000000000\n" + xyz) + "1 2 3\n",
                 ": truncated: the header promises 9000000000000000000 of element 'vertex', at least 6 bytes each; 6 "
                 "bytes follow it");
  expect_refusal(".ply", ply_header("binary_little_endian", "element vertex 2\n" + xyz) + little(1.0) + little(1.0),
                 ": truncated: the header promises 2 of element 'vertex', at least 24 bytes each; 16 bytes follow it");
}

TEST(Ply, RefusesBinary) {
  const std::string header = ply_header(
      "binary_little_endian", "element vertex 1\n" + xyz + "element tag 1\n" + "property list int uchar bytes\n");
  const std::string at = std::to_string(header.size() + 8);
  const std::string zero = little(0.0);
  const std::string tag = std::to_string(header.size() + 24);
  expect_refusal(".ply", header + zero + little(-infinity) + zero + little(0),
                 ": byte " + at + ": y = -inf: not a finite number");
  expect_refusal(".ply", header + zero + zero + zero + little(-1),
                 ": byte " + tag + ": length of list 'bytes' = -1: must not be negative");
  expect_refusal(".ply", header + zero + zero + zero + little(0) + "abc",
                 ": byte " + std::to_string(header.size() + 28) + ": 3 bytes after the last element");
  expect_refusal(".ply", header + zero + zero + zero + little(2000000000) + "abc",
                 ": byte " + std::to_string(header.size() + 31) + ": truncated: the file ends after " +
                     std::to_string(header.size() + 31) + " bytes, inside 'bytes'");
}

// --- OFF ---------------------------------------------------------------------------------------------------------

TEST(Off, FormsOfTheHeader) {
  const std::string body = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n";
  for (const std::string header : {"OFF\n4 1 0\n", "OFF 4 1 6\n", "4 1 0\n", "OFF\n# comment\n\n4 1 # counts\n",
                                   "off\n4 1 0\n", "OFF4 1 0\n", "Off4\t1 0\n"}) {
    const Mesh mesh = read(".off", header + body);
    EXPECT_EQ(mesh.vertices.size(), 4U) << header;
    EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2})) << header;
  }
}

TEST(Off, ColoursNormalsCommentsAndFans) {
  const Mesh mesh = read(".off",
                         "CNOFF\r\n5 2 0\r\n0 0 0 0 0 1 255 0 0 255\r\n1 0 0 0 0 1 0.5 0 0 1\r\n\r\n1.5 1 0 0 0 1\r\n"
                         "# between\r\n1 2 0\r\n0 1 0 # last\r\n5 0 1 2 3 4 255 0 0 # red\r\n3 0 1 2\r\n# end\r\n\r\n");
  EXPECT_EQ(mesh.vertices.size(), 5U);
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{0, 3, 4}, Triangle{0, 1, 2}));
}

TEST(Off, Refuses) {
  const auto refused = [](const std::string& text, const std::string& rest) { expect_refusal(".off", text, rest); };
  const std::string three = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
  refused("4OFF\n", ": line 1: keyword '4OFF': not supported, OFF with [ST][C][N] before it is");
  refused("nOFF\n3\n", ": line 1: keyword 'nOFF': not supported, OFF with [ST][C][N] before it is");
  refused("OFFX\n", ": line 1: keyword 'OFFX': not supported, OFF with [ST][C][N] before it is");
  refused("OFF BINARY\n", ": line 1: binary OFF is not supported");
  refused("OFF\n", ": line 1: truncated: the file ends where the counts should follow");
  refused("OFF\n3\n", ": line 2: number of faces is missing");
  refused("OFF\n3 x 0\n", ": line 2: number of faces = 'x': not an integer");
  refused("OFF\n-3 1 0\n", ": line 2: number of vertices = -3: must not be negative");
  refused("OFF\n3 1 0 0\n", ": line 2: unexpected '0' after the counts");
  refused("OFF\n3000000000 1 0\n", ": line 2: number of vertices = 3000000000: more than a file of 19 bytes can hold");
  refused("OFF\n0 0 0\n", ": no vertices");
  refused("OFF\n2 0 0\n0 0 0\n", ": line 3: truncated: the file ends where a vertex should follow");
  refused("OFF\n1 0 0\n0 inf 0\n", ": line 3: y = 'inf': not a finite number");
  refused("OFF\n1 0 0\n0 0\n0\n", ": line 3: z is missing");
  refused(three, ": line 5: truncated: the file ends where a face should follow");
  refused(three + "3 0 1 3\n", ": line 6: vertex index 3: out of range, the file has 3 vertices, counted from 0");
  refused(three + "3 0 1\n", ": line 6: vertex index is missing");
  refused(three + "-1 0 1\n", ": line 6: number of corners = -1: a face needs at least 3");
  refused(three + "2 0 1\n", ": line 6: number of corners = 2: a face needs at least 3");
  refused(three + "3 0 1 2 red\n", ": line 6: colour = 'red': not a number");
  refused(three + "3 0 1 1\n",
          ": triangle 1 names a vertex twice, and its line from (0, 0, 0) to (1, 0, 0) is no side of another triangle: "
          "leave it out");
  refused(three + "3 0 1 2\n3 0 1 2\n", ": line 7: unexpected '3 0 1 2' after the last face");
  refused("OFF\n1 9 0\n0 0 0\n9223372036854775807 0\n",
          ": line 2: number of faces = 9: more than a file of 38 bytes can hold");
}

}  // namespace
}  // namespace verisq
