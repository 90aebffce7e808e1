/// `verisq surface` as its user meets it: results, messages and exit status, with CGAL and without.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <verisq/files.hpp>
#include <verisq/mesh_topology.hpp>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "tests/fixtures/volume_files.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;

/// Of a program in this folder.
std::string not_there(const std::filesystem::path& folder) {
  return "surface: " + (folder / "verisq-surface").string() +
         " is not there; it is built where CGAL is (Debian: libcgal-dev)";
}

class SurfaceCommand : public ProgramTest {
 protected:
  [[nodiscard]] Outcome surface(Arguments arguments) const {
    arguments.insert(arguments.begin(), "surface");
    return run(arguments);
  }
  [[nodiscard]] std::string mesh(const std::string& name, const Mesh& contents) const {
    write_mesh(path(name), contents);
    return path(name);
  }
  /// The sphere's vertices as a CSV file.
  [[nodiscard]] std::string cloud() const {
    std::string text = "x,y,z\n";
    for (const auto& [x, y, z] : sphere_mesh(4).vertices) text += fmt::format("{},{},{}\n", x, y, z);
    return write("cloud.csv", text);
  }
  void expect_refusal(const Arguments& arguments, const std::string& message) const {
    const Outcome outcome = surface(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err, "verisq: " + message + "\n");
    EXPECT_EQ(outcome.out, "");
  }
};

Mesh open_sphere() {
  Mesh mesh = sphere_mesh(3);
  std::erase_if(mesh.triangles, [&](const auto& triangle) { return mesh.vertices[triangle[0]][2] > 0.8; });
  return mesh;
}

#if VERISQ_HAS_SURFACE

/// The path of another program of the same build.
std::string program_beside(const std::string& name) {
  return (std::filesystem::path(places::program()).parent_path() / name).string();
}

constexpr double ball_volume = 4.0 / 3.0 * std::numbers::pi;

TEST_F(SurfaceCommand, WrapsACloud) {
  const Outcome outcome = surface({"--points", cloud(), "-o", path("out.ply"), "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["method"], "alpha wrap");
  EXPECT_EQ(json["points"], 1026);
  EXPECT_EQ(json["genus"], 0);
  EXPECT_EQ(json["closed"], true);
  EXPECT_EQ(json["manifold"], true);
  EXPECT_EQ(json["oriented"], true);
  EXPECT_EQ(json["self_intersecting"], false);
  const Mesh written = read_mesh(path("out.ply"));
  EXPECT_TRUE(mesh_topology(written).bounds_solid());
  EXPECT_EQ(json["triangles"], written.triangles.size());
  EXPECT_DOUBLE_EQ(json["volume"], signed_volume(written));
  EXPECT_NEAR(signed_volume(written), ball_volume, 0.05 * ball_volume);
}

TEST_F(SurfaceCommand, MakesAnAlphaShapeOfTheVerticesOfAMesh) {
  const std::string input = mesh("in.off", sphere_mesh(4));
  const Outcome outcome =
      surface({"--points", input, "--method", "alpha", "--smooth", "3", "--inward", "-o", path("out.stl")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* line :
       {"input points       1026\n", "method             alpha shape, alpha ", "smoothing          3 rounds, volume ",
        "closed             yes\n", "manifold           yes\n", "oriented           yes, normals inward\n",
        "self-intersections no\n", "components         1\n", "Euler character.   2, genus 0\n",
        "volume             -4."})
    EXPECT_THAT(outcome.out, HasSubstr(line));
  EXPECT_NEAR(signed_volume(read_mesh(path("out.stl"))), -ball_volume, 0.05 * ball_volume);
}

TEST_F(SurfaceCommand, FillsTheHolesOfAMesh) {
  const std::string input = mesh("in.ply", open_sphere());
  const Outcome outcome = surface({"--mesh", input, "--fill-holes", "-o", path("out.obj")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("holes filled       1 of 1\n"));
  EXPECT_TRUE(mesh_topology(read_mesh(path("out.obj"))).bounds_solid());
}

TEST_F(SurfaceCommand, SaysWhatIsWrongWithASurface) {
  const Outcome open = surface({"--mesh", mesh("open.ply", open_sphere()), "-o", path("out.ply")});
  EXPECT_EQ(open.status, 3);
  EXPECT_THAT(open.out, HasSubstr("closed             no\n"));
  EXPECT_THAT(open.err, HasSubstr(path("out.ply") + " bounds no solid: "));
  EXPECT_THAT(open.err, HasSubstr(" boundary edges\n"));
  EXPECT_FALSE(mesh_topology(read_mesh(path("out.ply"))).closed());  // written all the same
}

// In the file the bow tie comes back: STL merges equal vertices.
TEST_F(SurfaceCommand, ChecksTheFileAndNotTheMesh) {
  Mesh bow_tie = join(tetrahedron(), tetrahedron());
  for (std::size_t k = 4; k < 8; ++k)
    for (double& coordinate : bow_tie.vertices[k]) coordinate = 0.0 - coordinate;
  for (std::size_t k = 4; k < 8; ++k) std::swap(bow_tie.triangles[k][0], bow_tie.triangles[k][1]);
  const std::string input = mesh("in.ply", bow_tie);
  EXPECT_EQ(surface({"--mesh", input, "-o", path("out.ply")}).status, 0);
  const Outcome stl = surface({"--mesh", input, "-o", path("out.stl")});
  EXPECT_EQ(stl.status, 3);
  EXPECT_THAT(stl.err, HasSubstr("bounds no solid: 1 non-manifold vertices\n"));
}

TEST_F(SurfaceCommand, RefusesBadUsage) {
  const std::string points = cloud();
  const std::string out = path("out.ply");
  const std::string input = mesh("in.ply", sphere_mesh(1));
  expect_refusal({"-o", out}, "give one of --points, --mesh and --volume");
  expect_refusal({"--points", points, "--mesh", input, "-o", out}, "give one of --points, --mesh and --volume");
  expect_refusal({"--points", points, "-o", out, "--inward", "--outward"}, "give either --inward or --outward");
  expect_refusal({"--points", points, "-o", out, "--method", "ball"}, "--method: ball is not one of wrap, alpha");
  expect_refusal({"--points", points, "-o", out, "--alpha", "0"}, "--alpha: 0 is not above 0");
  expect_refusal({"--points", points, "-o", out, "--alpha", "x"}, "--alpha: x is not a finite number of at least 0");
  expect_refusal({"--points", points, "-o", out, "--smooth", "-1"}, "--smooth: -1 is not at least 0");
  expect_refusal({"--points", points, "-o", out, "--method", "alpha", "--offset", "1"},
                 "--offset: is for --method wrap");
  expect_refusal({"--mesh", input, "-o", out, "--alpha", "1"}, "--alpha: needs --method");
  expect_refusal({"--points", points, "-o", out, "--fill-holes"},
                 "--fill-holes: is for the triangles of --mesh without --method; other surfaces have no holes");
  expect_refusal({"--points", points, "-o", path("out.vtp")},
                 path("out.vtp") + ": unknown mesh format '.vtp': written are .ply, .stl, .off, .obj");
  expect_refusal({"--points", path("none.csv"), "-o", out}, path("none.csv") + ": no such file");
  EXPECT_EQ(surface({"--mesh", input, "-o", input}).status, 2);
  EXPECT_EQ(surface({"--points", points, "-o", path("none/out.ply")}).status, 1);
  EXPECT_EQ(surface({"--points", points}).status, 2);
}

/// 19 voxels along each axis.
std::string volume_of(const std::vector<int>& labels) {
  const NrrdFile file{.sizes = "19 19 19",
                      .space = "RAS",
                      .directions = "(0.5,0,0) (0,0.5,0) (0,0,0.5)",
                      .origin = "(15.5,15.5,15.5)",
                      .encoding = "gzip"};
  return file.header() + gzipped(volume_bytes<std::int16_t>(labels));
}

/// Label 4 within a ball of 6 about the middle, label 9 in one more voxel.
std::string ball_of_voxels() {
  std::vector<int> labels;
  for (int k = -9; k <= 9; ++k)
    for (int j = -9; j <= 9; ++j)
      for (int i = -9; i <= 9; ++i) labels.push_back(i * i + j * j + k * k <= 36 ? 4 : 0);
  labels.front() = 9;
  return volume_of(labels);
}

/// A plate, one voxel thick at its rim, two elsewhere.
std::string plate_of_voxels() {
  std::vector<int> labels;
  for (int k = -9; k <= 9; ++k)
    for (int j = -9; j <= 9; ++j)
      for (int i = -9; i <= 9; ++i) {
        const bool inner = std::abs(i) <= 4 && std::abs(j) <= 4;
        const bool plate = std::abs(i) <= 7 && std::abs(j) <= 7 && (k == 0 || (inner && k == 1));
        labels.push_back(plate ? 1 : 0);
      }
  return volume_of(labels);
}

TEST_F(SurfaceCommand, MakesTheSurfaceOfALabel) {
  const std::string volume = write("ball.nrrd", ball_of_voxels());
  expect_refusal({"--volume", volume, "-o", path("out.ply")},
                 volume + ": give --label, one of 4 (925 voxels), 9 (1 voxels)");
  expect_refusal({"--volume", volume, "--label", "7", "-o", path("out.ply")},
                 "--label: " + volume + " has no label 7, but 4 (925 voxels), 9 (1 voxels)");
  for (const std::string space : {"lps", "ras"}) {
    const Outcome outcome =
        surface({"--volume", volume, "--label", "4", "--space", space, "-o", path("out.ply"), "--json"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(json["method"], "label");
    EXPECT_EQ(json["voxels"], 925);
    EXPECT_EQ(json["space"], space == "lps" ? "LPS" : "RAS");
    EXPECT_NEAR(json["volume"].get<double>(), 27.0 * ball_volume, 0.05 * 27.0 * ball_volume);
    const double sign = space == "lps" ? -1.0 : 1.0;
    for (const Point& x : read_mesh(path("out.ply")).vertices)
      EXPECT_NEAR(std::hypot(x[0] - sign * 20.0, x[1] - sign * 20.0, x[2] - 20.0), 3.0, 0.25);
  }
}

TEST_F(SurfaceCommand, SaysThatVoxelsAreTooCoarseForAThinLabel) {
  const std::string volume = write("plate.nrrd", plate_of_voxels());
  const Outcome outcome = surface({"--volume", volume, "-o", path("out.ply"), "--json"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err, HasSubstr("verisq: label 1: the surface has lost "));
  EXPECT_THAT(outcome.err, HasSubstr(" % of the volume of its voxels, more than 10 %: they are too coarse"));
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_TRUE(json["closed"].get<bool>());
  EXPECT_LT(std::abs(json["volume"].get<double>()),
            0.9 * json["voxels"].get<double>() * json["voxel_volume"].get<double>());
}

TEST_F(SurfaceCommand, MakesACanalThatAFitTakesAtOnce) {
  Mesh bone = sphere_mesh(4);
  for (Point& vertex : bone.vertices)
    for (double& coordinate : vertex) coordinate *= 10.0;
  const std::string outer = mesh("bone.ply", bone);
  const Outcome outcome = surface({"--mesh", outer, "--thickness", "-8,4", "--thickness", "0,2", "--resection",
                                   "0,0,5,0,0,1", "--edge", "1.5", "-o", path("canal.ply"), "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["method"], "canal");
  EXPECT_EQ(json["rims"], 1);
  EXPECT_EQ(json["closed"], false);
  EXPECT_EQ(json["facing"], "inward");
  EXPECT_TRUE(json["volume"].is_null());
  EXPECT_LT(json["wall"]["largest_error"].get<double>(), 0.2);
  const std::string implant = write("implant.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
      {"name": "plug", "superquadric": {"semi_axes": [3, 3, 3], "exponents": [1, 1]}}]})");
  const Outcome fit = run({"fit", "--implant", implant, "--mesh", path("canal.ply"), "--cavity", "--samples", "64",
                           "--device", "host", "-o", path("fitted.json")});
  EXPECT_EQ(fit.status, 0) << fit.err;
  EXPECT_THAT(fit.out, HasSubstr("inside the cavity    proven of \"plug\""));
}

TEST_F(SurfaceCommand, RefusesWhatMakesNoCanal) {
  const std::string bone = mesh("bone.ply", sphere_mesh(2));
  const std::string out = path("out.ply");
  expect_refusal({"--mesh", bone, "--thickness", "1", "--thickness", "2,3", "-o", out},
                 "--thickness: 1 has no height: of several each is AT,T");
  expect_refusal({"--mesh", bone, "--thickness", "2,1", "--thickness", "2,3", "-o", out},
                 "--thickness: height 2 is given twice");
  expect_refusal({"--mesh", bone, "--thickness", "neck_centre,3", "-o", out},
                 "--thickness: neck_centre,3: --landmarks has no neck_centre");
  expect_refusal({"--points", bone, "--thickness", "3", "-o", out},
                 "--thickness: needs the surface of a bone, --mesh or --volume");
  expect_refusal({"--mesh", bone, "--label", "3", "-o", out}, "--label: is for --volume");
  expect_refusal({"--mesh", bone, "--axis", "0,0,1", "-o", out}, "--axis: is for --thickness");
  expect_refusal({"--mesh", bone, "--thickness", "2", "-o", out},
                 "nothing is left of the bone: it is nowhere thicker than two cortices");
}

TEST_F(SurfaceCommand, ExplainsItself) {
  const Outcome outcome = surface({"--help"});
  EXPECT_EQ(outcome.status, 0);
  for (const char* word : {"--points", "--alpha", "--offset", "--fill-holes", "--smooth", "--inward", "Exit status"})
    EXPECT_THAT(outcome.out, HasSubstr(word));
}

TEST_F(SurfaceCommand, IsAProgramOfItsOwn) {
  const Outcome outcome = Process({program_beside("verisq-surface")}, folder_.path()).wait();
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err, "verisq-surface: --output is required (see verisq-surface --help)\n");
  const std::string of_cgal = "N4CGAL";  // a name in its namespace, as compilers write it
  EXPECT_NE(contents(program_beside("verisq-surface")).find(of_cgal), std::string::npos);
  EXPECT_EQ(contents(places::program()).find(of_cgal), std::string::npos);
}

TEST_F(SurfaceCommand, HandsEverythingOn) {
  EXPECT_THAT(surface({"-h"}).out, HasSubstr("Usage: verisq surface [OPTIONS]"));
  expect_refusal({"--nonsense", "two words"}, "--output is required (see verisq --help)");
  const std::string out = path("two words.ply");
  EXPECT_EQ(surface({"--mesh", mesh("in.ply", sphere_mesh(1)), "-o", out}).status, 0);
  EXPECT_EQ(read_mesh(out).triangles.size(), sphere_mesh(1).triangles.size());
}

#else

TEST_F(SurfaceCommand, SaysThatItIsNotInThisBuild) {
  const std::string missing = not_there(std::filesystem::path(places::program()).parent_path());
  expect_refusal({}, missing);
  expect_refusal({"--help"}, missing);
  expect_refusal({"--points", cloud(), "-o", path("out.ply"), "--json"}, missing);
  expect_refusal({"--mesh", mesh("in.ply", open_sphere()), "--fill-holes", "-o", path("out.ply")}, missing);
}

#endif

TEST_F(SurfaceCommand, SaysThatItsProgramIsMissing) {
  const std::string alone = path("verisq");
  std::filesystem::copy_file(places::program(), alone);
  for (const char* const argument : {"--help", "--json"}) {
    const Outcome outcome = Process({alone, "surface", argument}, folder_.path()).wait();
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err, "verisq: " + not_there(folder_.path()) + "\n");
  }
}

}  // namespace
}  // namespace verisq::testing
