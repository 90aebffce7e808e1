/// The program as its user meets it: results, messages and exit status of every case of docs/formats.md.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>
#include <verisq/files.hpp>
#include <verisq/mesh.hpp>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"
#include "tests/fixtures/sample_meshes.hpp"

namespace verisq::testing {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string ball = places::example("capsule.json");  // semi-axis 1 along z
const std::string tetrahedron = "OFF\n4 4 0\n0 0 3\n1 0 4\n0 1 4\n-1 -1 4\n3 0 1 2\n3 0 2 3\n3 0 3 1\n3 1 3 2\n";

const std::string bent_stem = places::example("bent_stem.json");

/// A grid that the model's searches take milliseconds a point for, as `x,y,z` lines.
std::string points_about_the_bent_stem(int count) {
  std::string text;
  for (int k = 0; k < count; ++k) {
    const auto coordinate = [k](int step, double middle) {
      return std::to_string(middle + 0.004 * (k * step % 97 - 48));
    };
    text += coordinate(1, 0.0) + "," + coordinate(37, 0.0) + "," + coordinate(59, -0.2) + "\n";
  }
  return text;
}

class CommandLine : public ProgramTest {
 protected:
  /// `map` without OpenCL of what `arguments` name.
  [[nodiscard]] Outcome map(Arguments arguments) const {
    arguments.insert(arguments.begin(), {"map", "--device", "host"});
    return run(arguments);
  }
};

/// A variable of the environment that started programs inherit as long as this lives. Precondition: it was not set.
class EnvironmentVariable {
 public:
  EnvironmentVariable(std::string name, const std::string& value) : name_(std::move(name)) {
    setenv(name_.c_str(), value.c_str(), 1);
  }
  ~EnvironmentVariable() { unsetenv(name_.c_str()); }
  EnvironmentVariable(const EnvironmentVariable&) = delete;
  EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;

 private:
  std::string name_;
};

/// Names a case of a parametrised test.
constexpr auto name_of = [](const auto& test) { return test.param.name; };

// ---------------------------------------------------------------- results

TEST_F(CommandLine, RefusesTwoCommandsAtOnce) {
  const Outcome outcome = run({"devices", "distance", "a.json", "b.json"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "verisq: give one command, not both distance and devices\n");
}

TEST_F(CommandLine, RefusesOutputsThatAreOneFileByLinks) {
  std::filesystem::create_symlink(path("map.csv"), path("page.html"));
  const Outcome outcome = run({"map", "--model", places::example("stem_mm.json"), "--mesh",
                               places::example("cavity.off"), "-o", path("map.csv"), "--report", path("page.html")});
  EXPECT_EQ(outcome.status, 2) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("is the name of two outputs"));
  EXPECT_FALSE(std::filesystem::exists(path("map.csv")));
}

TEST_F(CommandLine, MapsAMeshOnTheHost) {
  const auto mesh = write("mesh.off", tetrahedron);
  const auto outcome = map({"--model", ball, "--mesh", mesh, "-o", path("map.csv")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, HasSubstr("host-verified    4\n"));
  EXPECT_THAT(outcome.out, HasSubstr("] of these points, not of what lies between\n"));
  const auto rows = rows_of(path("map.csv"));
  ASSERT_EQ(rows.size(), 4);
  EXPECT_LE(rows[0].distance.lo, 2.0);  // (0, 0, 3) is exactly 2 above the solid
  EXPECT_GE(rows[0].distance.hi, 2.0);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(rows[k].index, k);
    EXPECT_LE(rows[k].distance.lo, rows[k].distance.hi);
    EXPECT_LE(rows[k].distance.width(), 2e-6);
    EXPECT_EQ(rows[k].status, "host-verified");
  }
}

TEST_F(CommandLine, MapsPointsOfAStream) {
  const auto points = write("points.csv", "x,y,z\n0,0,3\n0,0,-11\n");
  const auto outcome = map({"--model", ball, "--points", points, "-o", path("map.csv")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto rows = rows_of(path("map.csv"));
  ASSERT_EQ(rows.size(), 2);
  EXPECT_LE(rows[1].distance.lo, 10.0);
  EXPECT_GE(rows[1].distance.hi, 10.0);
}

TEST_F(CommandLine, MapsByThePublishedMethod) {
  const auto points = write("points.csv", "0,0,3\n1,2,2\n0.1,0,0\n");
  const auto outcome =
      map({"--model", ball, "--points", points, "--method", "published", "--tol", "0", "-o", path("map.csv")});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  ASSERT_EQ(map({"--model", ball, "--points", points, "--tol", "0", "-o", path("dual.csv")}).status, 0);
  const auto rows = rows_of(path("map.csv"));
  const auto dual = rows_of(path("dual.csv"));
  ASSERT_EQ(rows.size(), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_LE(rows[k].distance.lo, dual[k].distance.hi);  // both contain the exact distance
    EXPECT_GE(rows[k].distance.hi, dual[k].distance.lo);
    EXPECT_LT(rows[k].distance.width(), 1e-4);
  }
  EXPECT_GT(rows[1].distance.width(), 1e3 * (dual[1].distance.width())) << "is it the paper's method?";
}

TEST_F(CommandLine, RefusesThePublishedMethodWithWhatItDoesNotKnow) {
  const auto mesh = write("mesh.off", tetrahedron);
  const std::vector<std::string> common{"--model",  ball,        "--mesh", mesh,
                                        "--method", "published", "-o",     path("map.csv")};
  const auto with = [&](std::initializer_list<std::string> more) {
    auto arguments = common;
    arguments.insert(arguments.end(), more);
    return map(arguments);
  };
  expect_refused(with({"--certificates"}), {"--method published", "certificates"});
  expect_refused(with({"--on", "triangles"}), {"published", "points"});
}

TEST_F(CommandLine, ACertifiedReportIsOfFilesThatCanBeReadAgain) {
  const auto mesh = write("mesh.off", tetrahedron);
  const std::vector<std::string> common{"--mesh", mesh, "--certificates", "--report", path("page.html")};
  const auto with = [&](std::initializer_list<std::string> more) {
    auto arguments = common;
    arguments.insert(arguments.end(), more);
    return map(arguments);
  };
  EXPECT_EQ(with({"--model", ball}).status, 0) << "no --output is needed";
  expect_refused(map({"--model", ball, "--mesh", mesh, "--certificates", "--png", path("picture.png")}),
                 {"--certificates", "--output or the --report"});
}

// The host makes maps of up to 128 rows.
std::string points_above(std::size_t count) {
  std::string text;
  for (std::size_t k = 0; k < count; ++k) text += "0,0,3\n";
  return text;
}

TEST_F(CommandLine, MapsOnTheDefaultDevice) {
  const auto points = write("points.csv", points_above(129));
  const auto outcome = run({"map", "--model", ball, "--points", points, "-o", path("map.csv")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("device-verified  129\n"));
  EXPECT_EQ(rows_of(path("map.csv")).size(), 129);
}

// PoCL makes as many devices of one processor as it is asked for.
TEST_F(CommandLine, SeveralDevicesShareThePoints) {
  const EnvironmentVariable devices("POCL_DEVICES", "pthread pthread");
  std::string text;
  for (int k = 0; k < 150'000; ++k) text += fmt::format("{},{},{}\n", 1.5 + 1e-5 * k, 0.3 + 1e-6 * k, 2.0 - 1e-5 * k);
  const auto points = write("points.csv", text);
  const auto one = run({"map", "--model", ball, "--points", points, "--device", "0", "-o", path("one.csv")});
  const auto both = run({"map", "--model", ball, "--points", points, "--device", "0,1", "-o", path("both.csv")});
  EXPECT_EQ(one.status, 0) << one.err;
  EXPECT_EQ(both.status, 0) << both.err;
  EXPECT_THAT(both.out, HasSubstr(" and "));
  EXPECT_EQ(contents(path("both.csv")), contents(path("one.csv")));
}

TEST_F(CommandLine, SeveralDevicesAreOfPointsAboutConvexSolids) {
  const EnvironmentVariable devices("POCL_DEVICES", "pthread pthread");
  const auto mesh = write("mesh.off", tetrahedron);
  const auto refusal = [&](Arguments arguments) {
    arguments.insert(arguments.begin(), "map");
    arguments.insert(arguments.end(), {"-o", path("map.csv")});
    const auto outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2);
    return outcome.err;
  };
  const std::string sentence = "--device 0,1: several devices make maps of points about unions of convex solids alone";
  EXPECT_THAT(refusal({"--model", ball, "--mesh", mesh, "--on", "triangles", "--device", "0,1"}), HasSubstr(sentence));
  EXPECT_THAT(refusal({"--model", ball, "--mesh", mesh, "--certificates", "--device", "0,1"}), HasSubstr(sentence));
  EXPECT_THAT(refusal({"--model", ball, "--mesh", mesh, "--device", "1,1"}),
              HasSubstr("--device 1,1: 1 is named twice"));
  EXPECT_THAT(refusal({"--model", ball, "--mesh", mesh, "--device", "0,7"}), HasSubstr("no such device"));
}

TEST_F(CommandLine, LeavesFewRowsToTheHostUnlessADeviceIsNamed) {
  const auto points = write("points.csv", points_above(128));
  const auto outcome = run({"map", "--model", ball, "--points", points, "-o", path("map.csv")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, HasSubstr("host-verified    128\n"));
  const auto named = run({"map", "--model", ball, "--points", points, "-o", path("map.csv"), "--device", "0"});
  EXPECT_THAT(named.out, HasSubstr("device-verified  128\n"));
}

TEST_F(CommandLine, MapsOnTheHostWithoutOpenClDrivers) {
  const auto points = write("points.csv", points_above(129));
  const EnvironmentVariable drivers("OCL_ICD_VENDORS", path("no_vendors"));
  const auto outcome = run({"map", "--model", ball, "--points", points, "-o", path("map.csv")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("no OpenCL device found"));
  EXPECT_THAT(outcome.out, HasSubstr("host-verified    129\n"));
}

TEST_F(CommandLine, MapsOnTheHostWithoutAnOpenClLibrary) {
  const auto points = write("points.csv", points_above(129));
  // Found first, and no library: a program that is linked with OpenCL does not even start.
  for (const auto* name : {"libOpenCL.so.1", "libOpenCL.so"}) std::ofstream(path(name)) << "not a library";
  const EnvironmentVariable libraries("LD_LIBRARY_PATH", folder_.path().string());
  const auto outcome = run({"map", "--model", ball, "--points", points, "-o", path("map.csv")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("no OpenCL library"));
  EXPECT_THAT(outcome.err, HasSubstr("libOpenCL.so.1"));
  EXPECT_THAT(outcome.out, HasSubstr("host-verified    129\n"));
  EXPECT_EQ(run({"devices"}).status, 0);
}

TEST_F(CommandLine, WritesEveryFormat) {
  const auto mesh = write("mesh.off", tetrahedron);
  for (const std::string name : {"map.csv", "map.vtp", "map.ply", "map.json"}) {
    EXPECT_EQ(map({"--model", ball, "--mesh", mesh, "-o", path(name)}).status, 0);
    EXPECT_GT(std::filesystem::file_size(path(name)), 0);
  }
}

TEST_F(CommandLine, MapsTheTrianglesOfAMesh) {
  // Of the one triangle (0, 0, 3) is the closest point to the ball of semi-axis 1 along z; the other meets the ball.
  const auto mesh = write("mesh.off", "OFF\n5 2 0\n0 0 3\n1 0 4\n0 1 4\n9 0 0\n-9 1 0\n3 0 1 2\n3 3 4 0\n");
  for (const std::string device : {"host", "auto"}) {
    const auto outcome =
        run({"map", "--device", device, "--model", ball, "--mesh", mesh, "--on", "triangles", "-o", path("map.csv")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, StartsWith("triangles          2\n"));
    EXPECT_THAT(outcome.out, HasSubstr(" triangles/s\n"));
    EXPECT_THAT(outcome.out, Not(HasSubstr("point")));
    const auto rows = rows_of(path("map.csv"));
    ASSERT_EQ(rows.size(), 2);
    EXPECT_LE(rows[0].distance.lo, 2.0);
    EXPECT_GE(rows[0].distance.hi, 2.0);
    EXPECT_LE(rows[0].distance.width(), 2e-6);
    EXPECT_EQ(rows[1].distance.lo, 0.0);
    EXPECT_LE(rows[1].distance.hi, 2e-6);
  }
}

TEST_F(CommandLine, WritesTheTrianglesInEveryFormat) {
  const auto mesh = write("mesh.off", tetrahedron);
  for (const std::string name : {"map.csv", "map.vtp", "map.ply", "map.json"}) {
    const auto outcome = map({"--model", ball, "--mesh", mesh, "--on", "triangles", "-o", path(name)});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_GT(std::filesystem::file_size(path(name)), 0);
  }
  EXPECT_THAT(contents(path("map.vtp")), HasSubstr("<CellData"));
}

TEST_F(CommandLine, CountsTrianglesInTheJsonSummary) {
  const auto mesh = write("mesh.off", tetrahedron);
  const auto outcome =
      map({"--model", ball, "--mesh", mesh, "--on", "triangles", "--tol", "1e-9", "-o", path("map.csv"), "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary.at("triangles"), 4);
  EXPECT_EQ(summary.at("host_verified"), 4);
  EXPECT_GE(summary.at("triangles_per_second"), 0.0);
  EXPECT_FALSE(summary.contains("points"));
  EXPECT_LE(summary.at("smallest_distance").at("lo"), 2.0);
  EXPECT_GE(summary.at("smallest_distance").at("hi"), 2.0);
}

TEST_F(CommandLine, TrianglesOfAPointCloudAreRefused) {
  const auto cloud = write("cloud.off", "OFF\n2 0 0\n0 0 3\n1 0 4\n");
  expect_refused(map({"--model", ball, "--mesh", cloud, "--on", "triangles", "-o", path("map.csv")}),
                 {"cloud.off", "point cloud", "no triangles"});
  const auto points = write("points.csv", "0,0,3\n");
  expect_refused(map({"--model", ball, "--points", points, "--on", "triangles", "-o", path("map.csv")}),
                 {"--on triangles", "--mesh"});
  EXPECT_FALSE(std::filesystem::exists(path("map.csv")));
}

TEST_F(CommandLine, PrintsTheSummaryAsOneJsonObject) {
  const auto mesh = write("mesh.off", tetrahedron);
  const auto outcome = map({"--model", ball, "--mesh", mesh, "--tol", "1e-9", "-o", path("map.csv"), "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary.at("points"), 4);
  EXPECT_EQ(summary.at("device_verified"), 0);
  EXPECT_EQ(summary.at("host_verified"), 4);
  EXPECT_EQ(summary.at("wide"), 0);
  EXPECT_EQ(summary.at("device"), "host");
  EXPECT_EQ(summary.at("tolerance"), 1e-9);
  EXPECT_LE(summary.at("smallest_distance").at("lo"), 2.0);
  EXPECT_GE(summary.at("smallest_distance").at("hi"), 2.0);
  EXPECT_LE(summary.at("largest_width"), 1e-9);
  EXPECT_EQ(summary.at("interrupted"), false);
  EXPECT_EQ(summary.at("output"), path("map.csv"));
  for (const auto* key : {"seconds", "preparation_seconds", "device_seconds", "host_seconds", "points_per_second"}) {
    EXPECT_GE(summary.at(key), 0.0) << key;
  }
}

TEST_F(CommandLine, CountsWideEnclosuresInTheExitStatus) {
  // An irrational distance has no enclosure so narrow.
  const auto points = write("points.csv", "1,2,3\n");
  const auto outcome = map({"--model", ball, "--points", points, "--tol", "1e-300", "-o", path("map.csv")});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("wide             1\n"));
  EXPECT_EQ(rows_of(path("map.csv")).at(0).status, "wide");
}

TEST_F(CommandLine, WholeNumbersSayWhatTheyMayBe) {
  const std::string huge = "99999999999999999999";
  const auto expect = [&](const std::vector<std::string>& arguments, const std::string& message) {
    const auto outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err, "verisq: " + message + "\n");
  };
  expect({"fit", "--seed", huge}, "--seed: " + huge + " is not in 0 to 18446744073709551615");
  expect({"fit", "--samples", huge}, "--samples: " + huge + " is not in 1 to 1000000000");
  expect({"fit", "--samples", "1e5"}, "--samples: 1e5 is not a whole number in 1 to 1000000000");
  expect({"stance", "--cells", huge}, "--cells: " + huge + " is not in 1 to 4096");
  expect({"stance", "--monte-carlo", huge}, "--monte-carlo: " + huge + " is not in 1 to 18446744073709551615");
  expect({"stance", "--monte-carlo", "0"}, "--monte-carlo: 0 is not at least 1");
  expect({"octree", "--depth", huge}, "--depth: " + huge + " is not in 0 to 20");
}

TEST_F(CommandLine, ToleranceZeroAsksForTheTightest) {
  const auto points = write("points.csv", "1,2,3\n0.1,0.2,0.3\n-5,1e-3,7\n");
  for (const std::string device : {"auto", "host"}) {
    for (const bool certificates : {false, true}) {
      std::vector<std::string> arguments{"map", "--model", ball, "--points",      points,     "--tol",
                                         "0",   "--json",  "-o", path("map.csv"), "--device", device};
      if (certificates) arguments.emplace_back("--certificates");
      const auto outcome = run(arguments);
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      const auto summary = nlohmann::json::parse(outcome.out);
      EXPECT_EQ(summary.at("wide"), 0);
      EXPECT_EQ(summary.at("tightest"), true);
      EXPECT_LT(summary.at("largest_width"), 1e-8);
      EXPECT_THAT(folder_.contents("map.csv"), Not(HasSubstr("wide")));
    }
  }
  const auto text = map({"--model", ball, "--points", points, "--tol", "0", "-o", path("map.csv")}).out;
  EXPECT_THAT(text, HasSubstr("tolerance          0: the tightest\n"));
  const auto mesh = write("mesh.off", tetrahedron);
  EXPECT_EQ(map({"--model", ball, "--mesh", mesh, "--on", "triangles", "--tol", "0", "-o", path("map.csv")}).status, 0);
}

/// What the method did not have the time for is not its tightest.
TEST_F(CommandLine, ToleranceZeroCallsRowsWideThatTheTimeLimitLeaves) {
  const auto model = write("two.json", R"({"format": "verisq-model/1", "primitives": [
    {"name": "a", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}},
    {"name": "b", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]},
     "pose": {"translation": [0.5, 0, 0]}}]})");
  const auto points = write("points.csv", "0.25,0.1,0.1\n");
  const auto outcome =
      map({"--model", model, "--points", points, "--tol", "0", "--time-limit", "1e-9", "-o", path("map.csv")});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_EQ(rows_of(path("map.csv")).at(0).status, "wide");
}

/// Where primitives overlap, their union is deeper than each of them: covers say so, of what is exact.
TEST_F(CommandLine, SaysWhyRowsWithCertificatesAreWideInOverlaps) {
  const auto model = write("two.json", R"({"format": "verisq-model/1", "primitives": [
    {"name": "a", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}},
    {"name": "b", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]},
     "pose": {"translation": [0.5, 0, 0]}}]})");
  const auto points = write("points.csv", "0.25,0.1,0.1\n3,0,0\n");
  const std::vector<std::string> arguments{"--model", model,           "--points", points,
                                           "-o",      path("map.csv"), "--tol",    "1e-5"};
  EXPECT_EQ(map(arguments).status, 0);
  auto certified = arguments;
  certified.emplace_back("--certificates");
  for (const char* const name : {"map.csv", "map.vtp"}) {
    certified.at(5) = path(name);
    EXPECT_EQ(map(certified).status, 0);
    EXPECT_EQ(run({"check", "--model", model, "--points", points, "--map", path(name)}).status, 0);
  }
  certified.insert(certified.end(), {"--point-radius", "1e-9"});
  const auto outcome = map(certified);
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err, HasSubstr("verisq: 1 row inside the model is wide: certificates prove a depth by one "
                                     "primitive alone, and where primitives overlap their union is deeper; the map "
                                     "without --certificates is tighter there\n"));
  EXPECT_THAT(map({"--help"}).out, HasSubstr("overlap"));
}

TEST_F(CommandLine, InterruptionKeepsFinishedRows) {
  std::string text;
  for (int k = 0; k < 2'000'000; ++k) text += "1,2,3\n";
  const auto points = write("points.csv", text);
  const auto outcome = run_interrupted(
      {"map", "--device", "host", "--model", ball, "--points", points, "-o", path("map.csv"), "--json"});
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("map.csv.partial"));
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary.at("interrupted"), true);
  EXPECT_EQ(summary.at("output"), path("map.csv.partial"));
  EXPECT_FALSE(std::filesystem::exists(path("map.csv")));
  EXPECT_EQ(rows_of(path("map.csv.partial")).size(), summary.at("points"));
}

TEST_F(CommandLine, InterruptionKeepsFinishedRowsOfTriangles) {
  constexpr int count = 500'000;
  std::string text = "OFF\n3 " + std::to_string(count) + " 0\n1 2 3\n2 2 3\n1 3 3\n";
  for (int k = 0; k < count; ++k) text += "3 0 1 2\n";
  const auto mesh = write("mesh.off", text);
  const auto outcome = run_interrupted({"map", "--device", "host", "--model", ball, "--mesh", mesh, "--on", "triangles",
                                        "-o", path("map.csv"), "--json"});
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("map.csv.partial"));
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary.at("interrupted"), true);
  EXPECT_LT(summary.at("triangles"), count);
  EXPECT_EQ(rows_of(path("map.csv.partial")).size(), summary.at("triangles"));
}

TEST_F(CommandLine, InterruptionOfSlowSearchesKeepsFinishedRows) {
  const auto points = write("points.csv", points_about_the_bent_stem(200'000));
  const auto outcome = run_interrupted(
      {"map", "--device", "host", "--model", bent_stem, "--points", points, "-o", path("map.csv"), "--json"});
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_LT(summary.at("points"), 200'000);
  EXPECT_EQ(rows_of(path("map.csv.partial")).size(), summary.at("points"));
}

TEST_F(CommandLine, SigtermAndSighupKeepFinishedRowsAsCtrlCDoes) {
  const auto points = write("points.csv", points_about_the_bent_stem(200'000));
  for (const int signal : {SIGTERM, SIGHUP}) {
    const auto outcome = run_interrupted(
        {"map", "--device", "host", "--model", bent_stem, "--points", points, "-o", path("map.csv"), "--json"}, signal);
    EXPECT_EQ(outcome.status, 128 + signal) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("map.csv.partial"));
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(summary.at("interrupted"), true);
    EXPECT_EQ(rows_of(path("map.csv.partial")).size(), summary.at("points"));
    std::filesystem::remove(path("map.csv.partial"));
    EXPECT_THAT(folder_.names(), ::testing::UnorderedElementsAre("points.csv", "process.out", "process.err"));
  }
}

/// As `timeout` sends it: to the program, and to the group that it is in.
TEST_F(CommandLine, SigtermTwiceIsNoMoreThanOnce) {
  const auto points = write("points.csv", points_about_the_bent_stem(200'000));
  const Process process =
      start({"map", "--device", "host", "--model", bent_stem, "--points", points, "-o", path("map.csv")});
  process.wait_until_interruptible();
  for (int k = 0; k < 20; ++k) {
    process.send(SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // so that they are not merged
  }
  const auto outcome = process.wait();
  EXPECT_EQ(outcome.status, 143);
  EXPECT_THAT(outcome.err, HasSubstr("map.csv.partial"));
}

TEST_F(CommandLine, NohupStaysInForce) {
  const auto points = write("points.csv", points_about_the_bent_stem(2000));
  // As under `nohup`: a child inherits what is ignored.
  const auto before = std::signal(SIGHUP, SIG_IGN);
  const Process process(
      {places::program(), "map", "--device", "host", "--model", bent_stem, "--points", points, "-o", path("map.csv")},
      folder_.path(), SIGHUP);
  std::signal(SIGHUP, before);
  process.wait_until_interruptible();
  process.send(SIGHUP);
  const auto outcome = process.wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(rows_of(path("map.csv")).size(), 2000U);
}

/// What is in the folder and ends in `.partial`; empty where there is none.
std::filesystem::path partial_file_in(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".partial") return entry.path();
  }
  return {};
}

TEST_F(CommandLine, KilledRunsLeaveTheirFinishedRows) {
  const std::string stem = places::example("stem.json");
  std::string text;  // outside and inside; those inside take a while
  for (int k = 0; k < 100'000; ++k) text += k % 2 == 0 ? "90,0,0.5\n" : "0.5,1,-40\n";
  const auto points = write("points.csv", text);
  const Process process = start({"map", "--device", "host", "--model", stem, "--points", points, "--certificates",
                                 "--tol", "1e-9", "-o", path("map.csv")});
  const auto several_rows = [&] { return std::ranges::count(contents(partial_file_in(folder_.path())), '\n') > 20; };
  while (!several_rows() && !std::filesystem::exists(path("map.csv"))) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  process.send(SIGKILL);
  EXPECT_EQ(process.wait().status, 128 + SIGKILL);
  const auto left = partial_file_in(folder_.path());
  ASSERT_FALSE(left.empty());
  const auto checked = run({"check", "--model", stem, "--points", points, "--map", left.string(), "--json"});
  EXPECT_EQ(checked.status, 3) << checked.err;
  const auto summary = nlohmann::json::parse(checked.out);
  EXPECT_GE(summary.at("proved"), 20);
  EXPECT_EQ(summary.at("refuted"), 0);
  EXPECT_EQ(summary.at("unproved"), 0);
  EXPECT_EQ(summary.at("points").get<std::uint64_t>() + summary.at("missing").get<std::uint64_t>(), 100'000U);
}

// ---------------------------------------------------------------- time limits

/// Rows of two maps of the same points contain the same numbers.
void expect_compatible(const std::vector<Row>& some, const std::vector<Row>& others) {
  ASSERT_EQ(some.size(), others.size());
  for (std::size_t k = 0; k < some.size(); ++k) {
    EXPECT_EQ(some[k].index, k);
    EXPECT_LE(some[k].distance.lo, others[k].distance.hi) << k;
    EXPECT_GE(some[k].distance.hi, others[k].distance.lo) << k;
  }
}

TEST_F(CommandLine, AtTheTimeLimitAllRowsAreValid) {
  const auto points = write("points.csv", points_about_the_bent_stem(1500));
  ASSERT_EQ(map({"--model", bent_stem, "--points", points, "-o", path("all.csv")}).status, 0);
  for (const std::string device : {"host", "auto"}) {
    for (const std::string seconds : {"1e-9", "0.05"}) {
      const auto outcome = run({"map", "--device", device, "--model", bent_stem, "--points", points, "--time-limit",
                                seconds, "-o", path("map.csv"), "--json"});
      const auto summary = nlohmann::json::parse(outcome.out);
      const std::size_t wide = summary.at("wide");
      EXPECT_EQ(outcome.status, wide > 0 ? 3 : 0);
      EXPECT_EQ(summary.at("out_of_time"), wide > 0);
      EXPECT_EQ(summary.at("interrupted"), false);
      EXPECT_EQ(summary.at("points"), 1500);
      if (seconds == "1e-9") {
        EXPECT_EQ(wide, 1500);
        EXPECT_EQ(outcome.err, "verisq: the time limit is reached; 1500 of 1500 rows are valid, and wide\n");
      }
      const std::vector<Row> rows = rows_of(path("map.csv"));
      expect_compatible(rows, rows_of(path("all.csv")));
      // No wider than the model is, and a bit: what costs no search says that much.
      for (const Row& row : rows) EXPECT_LE(row.distance.width(), 0.8);
    }
  }
}

TEST_F(CommandLine, AtTheTimeLimitTrianglesAndUncertainModelsAreValid) {
  const auto mesh = write("mesh.off", tetrahedron);
  const std::string uncertain = places::example("uncertain_stem.json");
  for (const Arguments& what : {Arguments{"--model", ball, "--mesh", mesh, "--on", "triangles"},
                                {"--model", uncertain, "--mesh", mesh, "--point-radius", "0.01", "--tol", "0.1"},
                                {"--model", uncertain, "--mesh", mesh, "--on", "triangles", "--tol", "0.1"}}) {
    auto arguments = what;
    arguments.insert(arguments.end(), {"-o", path("all.csv")});
    ASSERT_EQ(map(arguments).status, 0);
    arguments.back() = path("map.csv");
    arguments.insert(arguments.end(), {"--time-limit", "1e-9"});
    EXPECT_EQ(map(arguments).status, 3);
    expect_compatible(rows_of(path("map.csv")), rows_of(path("all.csv")));
    for (const Row& row : rows_of(path("map.csv"))) EXPECT_LE(row.distance.width(), 7.0);
  }
}

TEST_F(CommandLine, AtTheTimeLimitCertificatesProveTheRows) {
  const auto mesh = write("mesh.off", "OFF\n5 2 0\n0 0 3\n1 0 4\n0 0.125 0.25\n9 0 0\n-9 1 0\n3 0 1 2\n3 0 3 4\n");
  const std::string stem = places::example("stem.json");
  for (const std::string on : {"vertices", "triangles"}) {
    for (const std::string& model : {ball, stem}) {
      EXPECT_EQ(map({"--model", model, "--mesh", mesh, "--on", on, "--certificates", "--time-limit", "1e-9", "-o",
                     path("map.csv")})
                    .status,
                3);
      const auto checked = run({"check", "--model", model, "--mesh", mesh, "--map", path("map.csv"), "--json"});
      EXPECT_EQ(checked.status, 0) << checked.out;
      EXPECT_LE(nlohmann::json::parse(checked.out).at("largest_width_proved"), 3.0);  // no infinite ends
    }
  }
}

TEST_F(CommandLine, RefusesTimesThatAreNone) {
  const auto mesh = write("mesh.off", tetrahedron);
  for (const std::string seconds : {"0", "-1", "soon", "inf", "nan"}) {
    expect_refused(map({"--model", ball, "--mesh", mesh, "-o", path("map.csv"), "--time-limit=" + seconds}),
                   {"--time-limit: " + seconds + " is not a finite number of seconds above 0"});
  }
}

TEST_F(CommandLine, SaysWhatIsWrongWithPointsAndPoses) {
  const auto mesh = write("mesh.off", tetrahedron);
  const Arguments of_mesh{"--model", ball, "--mesh", mesh, "-o", path("map.csv")};
  const auto with = [](Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  expect_refused(map(with(of_mesh, {"--points", mesh})), {"--mesh and --points are both given: leave one out"});
  expect_refused(map(with(of_mesh, {"--pose", "1 2 3 1 0 0 0"})),
                 {"--pose: '1 2 3 1 0 0 0' is not a finite number: commas without blanks separate numbers"});
  expect_refused(map({"--model", ball, "--points", mesh, "-o", path("map.csv")}),
                 {"mesh.off: line 1: 'OFF'", "the file's name is that of a mesh, which is no list of points"});
}

TEST_F(CommandLine, SaysWhichFileIsInAnothersPlace) {
  const auto mesh = write("mesh.off", tetrahedron);
  // A mesh may be the model of a map; what it cannot be is told by the other file, or the other command.
  expect_refused(map({"--model", mesh, "--mesh", ball, "-o", path("map.csv")}),
                 {"unknown mesh format '.json'", "a model goes elsewhere"});
  expect_refused(run({"insert", "--implant", mesh, "--mesh", mesh, "--along", "0,0,1", "--length", "1", "-o",
                      path("way.csv"), "--certificate-file", path("way.json")}),
                 {"--certificate-file", "ways in of meshes"});
  expect_refused(map({"--model", ball, "--mesh", ball, "-o", path("map.csv")}),
                 {"unknown mesh format '.json'", "a model goes elsewhere"});
  expect_refused(map({"--model", ball, "--model", ball, "--mesh", mesh, "-o", path("map.csv")}),
                 {"--model: give it once, not 2 times"});
  expect_refused(run({"features", "--landmarks", ball}),
                 {"format = \"verisq-model/1\": must be \"verisq-landmarks/1\""});
}

TEST_F(CommandLine, AsksWhetherUnitsAreTheSame) {
  const auto small = write("small.off", "OFF\n3 1 0\n0.001 0 0\n0 0.001 0\n0 0 0.001\n3 0 1 2\n");
  const auto told = map({"--model", ball, "--mesh", small, "-o", path("small.csv")});
  EXPECT_EQ(told.status, 0) << told.err;
  EXPECT_THAT(told.err, HasSubstr("are their units the same?"));
  const auto usual = map({"--model", ball, "--mesh", write("mesh.off", tetrahedron), "-o", path("map.csv")});
  EXPECT_THAT(usual.err, Not(HasSubstr("units")));
}

TEST_F(CommandLine, PrintsVersionAndHelp) {
  const auto version = run({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_THAT(version.out, StartsWith("verisq "));
  for (const Arguments& arguments :
       {Arguments{"--help"}, {"map", "--help"}, {"check", "--help"}, {"devices", "--help"}}) {
    const auto help = run(arguments);
    EXPECT_EQ(help.status, 0);
    EXPECT_THAT(help.out, HasSubstr("Usage: verisq"));
    EXPECT_EQ(help.err, "");
  }
}

TEST_F(CommandLine, HelpExplainsCommandsAsTheirOptionDoes) {
  EXPECT_EQ(run({"-V"}).out, run({"--version"}).out);
  for (const auto& [asked, meant] : {std::pair{Arguments{"help"}, Arguments{"--help"}},
                                     {{"help", "map"}, {"map", "--help"}},
                                     {{"help", "check"}, {"check", "--help"}}}) {
    const auto help = run(asked);
    EXPECT_EQ(help.status, 0);
    EXPECT_EQ(help.out, run(meant).out);
    EXPECT_EQ(help.err, "");
  }
  expect_refused(run({"help", "mop"}), {"help: there is no command mop; did you mean map?"});
  expect_refused(run({"help", "map", "check"}), {"help: name one command"});
}

TEST_F(CommandLine, SuggestsWhatWasMeant) {
  expect_refused(run({"mop"}), {"mop; did you mean map?"});
  expect_refused(run({"distnace", "a.json"}), {"did you mean distance?"});
  expect_refused(run({"map", "--modle", ball}), {"--modle", "did you mean --model?"});
  expect_refused(run({"map", "--tolerance=1"}), {"--tolerance=1; did you mean --tol?"});
  expect_refused(run({"octree", "--detph", "3"}), {"did you mean --depth?"});
  for (const Arguments& nothing_near : {Arguments{"xyzzy"}, {"map", "--xyzzy"}, {"map", "-x"}}) {
    const auto refused = run(nothing_near);
    EXPECT_EQ(refused.status, 2);
    EXPECT_EQ(refused.err.find("did you mean"), std::string::npos) << refused.err;
  }
}

/// Names as `verisq devices` prints them, without their quotation marks: lines that begin with an index.
std::vector<std::string> names_of_devices(const std::string& listing) {
  std::vector<std::string> names;
  std::istringstream lines(listing);
  for (std::string line; std::getline(lines, line);) {
    if (std::isdigit(static_cast<unsigned char>(line[0])) == 0) continue;
    const std::size_t name = line.find('"') + 1;
    names.push_back(line.substr(name, line.find('"', name) - name));
  }
  return names;
}

TEST_F(CommandLine, DevicesReportPrintsATableOfAccuracy) {
  const auto report = run({"devices", "--report"});
  EXPECT_EQ(report.status, 0);
  EXPECT_EQ(report.err, "");
  EXPECT_THAT(report.out, HasSubstr("| operation "));
  EXPECT_THAT(report.out, HasSubstr("| interval_div "));
  EXPECT_THAT(report.out, HasSubstr("Unsound bounds: 0."));
}

TEST_F(CommandLine, UnknownDeviceIsRefusedWithTheListOfDevices) {
  const auto devices = run({"devices"});
  EXPECT_EQ(devices.status, 0);
  auto words = names_of_devices(devices.out);
  words.emplace_back("no such device");
  const auto mesh = write("mesh.off", tetrahedron);
  const Arguments arguments{"map",      "--model",        ball, "--mesh",       mesh,
                            "--device", "no such device", "-o", path("map.csv")};
  expect_refused(run(arguments), words);
  EXPECT_FALSE(std::filesystem::exists(path("map.csv")));
}

TEST_F(CommandLine, ReportsShowWhatIsAskedFor) {
  const auto mesh = write("mesh.off", tetrahedron);
  const auto shown = [&](const Arguments& more) {
    Arguments arguments{"--model", ball, "--mesh", mesh, "--report", path("map.html")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return map(arguments);
  };
  ASSERT_EQ(shown({"--range", "0.5", "--up", "0,-2,0"}).status, 0);
  EXPECT_THAT(contents(path("map.html")), HasSubstr(R"("range":0.5,"up":[0.0,-1.0,0.0],)"));
  expect_refused(shown({"--up", "0,0,0"}), {"--up", "0,0,0"});
  expect_refused(shown({"--range", "0"}), {"--range", "0"});
  expect_refused(map({"--model", ball, "--mesh", mesh, "-o", path("map.csv"), "--range", "3"}), {"--range", "--png"});
  expect_refused(map({"--model", ball, "--mesh", mesh, "-o", path("map.csv"), "--up", "0,0,1"}), {"--up", "--png"});
}

TEST_F(CommandLine, OutputThatCannotBeWrittenFails) {
  const auto mesh = write("mesh.off", tetrahedron);
  const auto outcome = map({"--model", ball, "--mesh", mesh, "-o", path("no/such/folder/map.csv")});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("no/such/folder/map.csv"));
}

TEST_F(CommandLine, WritesThroughSymbolicLinks) {
  const auto mesh = write("mesh.off", tetrahedron);
  std::filesystem::create_directory(path("elsewhere"));
  std::filesystem::create_symlink("elsewhere/map.csv", path("link.csv"));
  ASSERT_EQ(map({"--model", ball, "--mesh", mesh, "-o", path("link.csv")}).status, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(path("link.csv")));
  EXPECT_EQ(rows_of(path("elsewhere/map.csv")).size(), 4U);
}

TEST_F(CommandLine, NeverOverwritesItsInput) {
  const auto points = write("points.csv", "0,0,3\n");
  expect_refused(map({"--model", ball, "--points", points, "-o", points}), {"points.csv", "overwrite"});
  EXPECT_EQ(contents(points), "0,0,3\n");
}

// ---------------------------------------------------------------- check

/// Four points outside and inside `ball`, in the order of the certified maps below.
const std::string points_of_check = "0,0,3\n1,2,3\n0,0,0.5\n-0.25,0.125,-0.3\n";
constexpr std::size_t count_of_check = 4;

class Check : public CommandLine {
 protected:
  [[nodiscard]] std::string certified_map(const std::string& name) const {
    const auto outcome = map({"--model", ball, "--points", points_, "--certificates", "-o", path(name)});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return path(name);
  }
  [[nodiscard]] Outcome check(const std::string& map, Arguments more = {}) const {
    more.insert(more.begin(), {"check", "--model", ball, "--points", points_, "--map", map});
    return run(more);
  }

  std::string points_ = write("points.csv", points_of_check);
};

/// A map as `.csv`: the header and rows of fields, to be falsified.
class Table {
 public:
  explicit Table(const std::string& csv) {
    std::istringstream lines(contents(csv));
    for (std::string line; std::getline(lines, line);) rows_.push_back(fields_of(line));
  }

  [[nodiscard]] std::string& at(std::size_t row, const std::string& column) {
    const auto& names = rows_.at(0);
    return rows_.at(row + 1).at(std::ranges::find(names, column) - names.begin());
  }
  [[nodiscard]] double number(std::size_t row, const std::string& column) { return std::stod(at(row, column)); }
  void set(std::size_t row, const std::string& column, double value) {
    std::ostringstream text;
    text << std::setprecision(17) << value;
    at(row, column) = text.str();
  }
  [[nodiscard]] std::string text() const {
    std::string text;
    for (const auto& row : rows_) {
      for (std::size_t k = 0; k < row.size(); ++k) text += (k == 0 ? "" : ",") + row[k];
      text += "\n";
    }
    return text;
  }

 private:
  static std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream stream(line + ",");
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
    return fields;
  }

  std::vector<std::vector<std::string>> rows_;
};

/// Finished, but not all is proved; the summary names row `row`.
void expect_not_proved(const Outcome& outcome, std::size_t row, const std::string& verdict = " point") {
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, HasSubstr(verdict + ", index " + std::to_string(row) + ","));
}

TEST_F(Check, ProvesAFinishedMap) {
  for (const std::string name : {"map.csv", "map.vtp"}) {
    const auto outcome = check(certified_map(name));
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, HasSubstr("proved             4\n"));
    EXPECT_THAT(outcome.out, HasSubstr("refuted            0\n"));
    EXPECT_THAT(outcome.out, HasSubstr("unproved           0\n"));
    EXPECT_THAT(outcome.out, Not(HasSubstr("first")));
  }
}

TEST_F(Check, ProvesAMapOfTheDefaultDevice) {
  const auto mesh = write("mesh.off", tetrahedron);
  const std::string model = places::example("stem.json");  // a union
  for (const std::string name : {"map.csv", "map.vtp"}) {
    EXPECT_EQ(run({"map", "--model", model, "--mesh", mesh, "--certificates", "-o", path(name)}).status, 0);
    const auto outcome = run({"check", "--model", model, "--mesh", mesh, "--map", path(name)});
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("proved             4\n"));
  }
}

TEST_F(Check, RefutesEndsMovedPastTheTruth) {
  const auto map = certified_map("map.csv");
  for (std::size_t row = 0; row < count_of_check; ++row) {
    for (const double direction : {-1.0, 1.0}) {
      Table table(map);
      const double lo = table.number(row, "lo");
      const double hi = table.number(row, "hi");
      const double step = 1e-12 * std::abs(lo);
      table.set(row, "lo", direction > 0.0 ? hi + step : lo - 1.0);
      table.set(row, "hi", direction > 0.0 ? hi + 1.0 : lo - step);
      expect_not_proved(check(write("moved.csv", table.text())), row);
    }
  }
}

TEST_F(Check, SaysWhichEndIsWrong) {
  Table table(certified_map("map.csv"));
  table.at(0, "lo") = "1";  // the exact distance is 2
  table.at(0, "hi") = "1.5";
  const auto above = check(write("moved.csv", table.text()));
  expect_not_proved(above, 0, "refuted point");
  EXPECT_THAT(above.out, HasSubstr("hi is wrong"));
  EXPECT_THAT(above.out, HasSubstr("refuted            1\n"));
  EXPECT_THAT(above.out, HasSubstr("claimed            [1, 1.5]\n"));

  table.at(0, "lo") = "2.5";
  table.at(0, "hi") = "3";
  EXPECT_THAT(check(write("moved.csv", table.text())).out, HasSubstr("lo is wrong"));
  table.at(0, "lo") = "3";
  table.at(0, "hi") = "1";
  EXPECT_THAT(check(write("moved.csv", table.text())).out, HasSubstr("lo is above hi"));
}

TEST_F(Check, ReportsTheFirstRefutedPointBeforeUnprovedOnes) {
  Table table(certified_map("map.csv"));
  table.at(0, "primitive") = "7";  // unproved
  table.at(1, "lo") = "100";
  table.at(1, "hi") = "101";
  table.at(2, "lo") = "1";
  table.at(2, "hi") = "0";
  const auto outcome = check(write("bad.csv", table.text()), {"--json"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary.at("points"), 4);
  EXPECT_EQ(summary.at("proved"), 1);
  EXPECT_EQ(summary.at("refuted"), 2);
  EXPECT_EQ(summary.at("unproved"), 1);
  EXPECT_EQ(summary.at("interrupted"), false);
  EXPECT_EQ(summary.at("map"), path("bad.csv"));
  EXPECT_GE(summary.at("points_per_second"), 0.0);
  const auto& first = summary.at("first");
  EXPECT_EQ(first.at("verdict"), "refuted");
  EXPECT_EQ(first.at("index"), 1);
  EXPECT_EQ(first.at("point"), (std::array{1.0, 2.0, 3.0}));
  EXPECT_EQ(first.at("claimed").at("lo"), 100.0);
  EXPECT_LT(first.at("proven").at("hi"), 3.0);
  EXPECT_THAT(std::string(first.at("reason")), HasSubstr("lo is wrong"));
}

TEST_F(Check, DoesNotProveByAFalsifiedCertificate) {
  const auto map = certified_map("map.csv");
  for (std::size_t row = 0; row < 2; ++row) {  // outside: both ends rest on the normal
    for (const std::string column : {"normal_x", "normal_y"}) {
      Table table(map);
      table.set(row, column, table.number(row, column) + 0.01);
      const auto outcome = check(write("false.csv", table.text()));
      expect_not_proved(outcome, row, "unproved point");
      EXPECT_THAT(outcome.out, HasSubstr("neither lo nor hi"));
    }
  }
}

TEST_F(Check, DoesNotProveWithoutThePrimitiveOfTheCertificate) {
  Table table(certified_map("map.csv"));
  table.at(2, "primitive") = "1";  // the model has one primitive, 0
  expect_not_proved(check(write("false.csv", table.text())), 2, "unproved point");
}

TEST_F(Check, DoesNotProveTheMapOfAnotherModel) {
  const auto map = certified_map("map.csv");
  const auto outcome = run({"check", "--model", (places::example("gem.json")), "--points", points_, "--map", map});
  EXPECT_EQ(outcome.status, 3) << outcome.out << outcome.err;
}

TEST_F(Check, RefusesAMapWithoutCertificates) {
  for (const std::string name : {"map.csv", "map.vtp"}) {
    EXPECT_EQ(map({"--model", ball, "--points", points_, "-o", path(name)}).status, 0);
    expect_refused(check(path(name)), {name, "--certificates"});
  }
}

TEST_F(Check, RefusesAMapOfOtherLength) {
  for (const std::string name : {"map.csv", "map.vtp"}) {
    const auto map = certified_map(name);
    for (const int count : {1, 3, 5, 5000}) {
      std::string text;
      for (int k = 0; k < count; ++k) text += "0,0,3\n";
      const auto points = write("other.csv", text);
      const auto outcome = run({"check", "--model", ball, "--points", points, "--map", map});
      expect_refused(outcome, {name, "other.csv", "4 rows", std::to_string(count) + " points"});
    }
  }
}

TEST_F(Check, RefusesBadMaps) {
  expect_refused(check(path("none.csv")), {"none.csv"});
  expect_refused(check(write("map.ply", "ply\n")), {"map.ply", ".csv", ".vtp"});
  Table table(certified_map("map.csv"));
  table.at(1, "lo") = "nan";
  expect_refused(check(write("nan.csv", table.text())), {"nan.csv", "line 3", "nan"});
}

TEST_F(Check, DoesNotSucceedWhereARowClaimsNothing) {
  Table table(certified_map("map.csv"));
  table.at(1, "lo") = "-inf";
  table.at(1, "hi") = "inf";
  table.at(1, "status") = "wide";
  const auto outcome = check(write("nothing.csv", table.text()));
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("proved             4\n"));
  EXPECT_THAT(outcome.out, HasSubstr("  WITHOUT AN END     1: of these nothing is claimed on one side at least\n"));
}

TEST_F(Check, ProvesThePartThatAnEndedRunLeft) {
  const std::string text = contents(certified_map("map.csv"));
  const std::size_t last_row = text.rfind('\n', text.size() - 2) + 1;
  for (const std::string name : {"map.csv.partial", "map.csv.0123abcd.partial"}) {
    for (const std::size_t size : {last_row, last_row + 1, text.size() - 1}) {
      const auto outcome = check(write(name, text.substr(0, size)));
      EXPECT_EQ(outcome.status, 3) << outcome.err;
      EXPECT_THAT(outcome.out, HasSubstr("proved             3\n"));
      EXPECT_THAT(outcome.out, HasSubstr("missing            1 (the map ends before)\n"));
    }
    EXPECT_EQ(check(write(name, text)).status, 0);
    const auto empty = check(write(name, text.substr(0, text.find('\n') + 1)), {"--json"});
    EXPECT_EQ(empty.status, 3) << empty.err;
    EXPECT_EQ(nlohmann::json::parse(empty.out).at("missing"), 4);
    expect_refused(check(write(name, text + "4" + text.substr(last_row + 1))), {name, "5 rows for the 4 points"});
  }
  expect_refused(check(write("map.vtp.0123abcd.partial", "<")), {"map.vtp.0123abcd.partial", "killed", "map again"});
}

TEST_F(Check, NamesAStatusThatNoToleranceAllows) {
  const auto map = certified_map("map.csv");
  const auto falsified = [&](Table& table) {
    const auto outcome = check(write("false.csv", table.text()), {"--json"});
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    const auto found = nlohmann::json::parse(outcome.out).at("falsified");
    EXPECT_EQ(found.at("array"), "status");
    return found;
  };
  Table infinite(map);
  infinite.at(1, "hi") = "inf";
  EXPECT_EQ(falsified(infinite), nlohmann::json::parse(R"({"array": "status", "index": 1, "shown": "host-verified",
                                      "expected": "wide, since an end is infinite"})"));
  Table wide(map);
  wide.at(2, "lo") = "-2";  // still verified, but much wider than
  wide.at(3, "status") = "wide";
  EXPECT_EQ(falsified(wide).at("index"), 3);
  EXPECT_THAT(std::string(falsified(wide).at("expected")), HasSubstr("at index 2 a width of "));
  Table point(map);
  for (std::size_t row = 1; row < count_of_check; ++row) point.at(row, "status") = "wide";
  EXPECT_EQ(check(write("wide.csv", point.text())).status, 0);  // of a tolerance of 0: row 0 is exact
  point.at(0, "status") = "wide";
  EXPECT_EQ(falsified(point).at("expected"), "verified, since lo equals hi");
}

/// A tolerance of 0 calls what is deep inside verified at widths that are wide outside.
TEST_F(Check, TakesTheStatusesOfATightestMap) {
  ASSERT_EQ(map({"--model", ball, "--points", points_, "--tol", "0", "--certificates", "-o", path("map.csv")}).status,
            0);
  Table tightest(path("map.csv"));
  for (const std::size_t outside : {0, 1}) {
    tightest.set(outside, "lo", tightest.number(outside, "lo") - 1e-11);
    tightest.at(outside, "status") = "wide";
  }
  for (const std::size_t inside : {2, 3}) {
    tightest.set(inside, "lo", std::min(tightest.number(inside, "lo"), tightest.number(inside, "hi") - 1e-9));
  }
  const auto outcome = check(write("tightest.csv", tightest.text()));
  EXPECT_EQ(outcome.status, 0) << outcome.out;
  tightest.set(2, "lo", tightest.number(2, "hi") - 1e-7);
  EXPECT_EQ(check(write("false.csv", tightest.text())).status, 3);
}

constexpr std::size_t long_count = 5000;  // more than a chunk

/// A certified map of the point (0, 0, 3), `long_count` times.
std::string long_map() {
  std::string text =
      "index,lo,hi,status,primitive,normal_x,normal_y,normal_z,further_normals,escape_x,escape_y,escape_z\n";
  for (std::size_t k = 0; k < long_count; ++k) text += std::to_string(k) + ",1.5,2.5,wide,0,0,0,2,,,,\n";
  return text;
}

TEST_F(Check, NamesAPointBeyondTheFirstChunk) {
  std::string points;
  for (std::size_t k = 0; k < long_count; ++k) points += "0,0,3\n";
  Table table(write("map.csv", long_map()));
  table.at(4500, "hi") = "1.75";
  const auto outcome =
      run({"check", "--model", ball, "--points", write("long.csv", points), "--map", write("bad.csv", table.text())});
  expect_not_proved(outcome, 4500, "refuted point");
  EXPECT_THAT(outcome.out, HasSubstr("proved             4999\n"));
}

TEST_F(Check, InterruptionNeverReportsSuccess) {
  const auto pipe = path("pipe.csv");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const auto process =
      start({"check", "--model", ball, "--points", pipe, "--map", write("map.csv", long_map()), "--json"});
  {
    std::ofstream points(pipe);  // waits until the program reads
    for (std::size_t k = 0; k < long_count; ++k) points << "0,0,3\n";
    points.flush();
    process.interrupt();  // before the end of the pipe tells that these are all points
  }
  const auto outcome = process.wait();
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary.at("interrupted"), true);
  EXPECT_LE(summary.at("points"), long_count);
  EXPECT_EQ(summary.at("proved"), summary.at("points"));
}

TEST_F(Check, LoadsNoOpenCl) {
  const auto map = certified_map("map.csv");
  const EnvironmentVariable tracing("LD_DEBUG", "files");  // the dynamic linker names every file it opens
  const auto checked = check(map);
  EXPECT_EQ(checked.status, 0);
  EXPECT_THAT(checked.err, HasSubstr("libmpfr"));
  EXPECT_THAT(checked.err, Not(HasSubstr("libOpenCL")));
  EXPECT_THAT(checked.err, Not(HasSubstr("libpocl")));
  const auto mapped = run({"map", "--model", ball, "--points", points_, "-o", path("again.csv"), "--device", "0"});
  EXPECT_THAT(mapped.err, HasSubstr("libOpenCL"));
}

// ---------------------------------------------------------------- check of triangles

/// `tetrahedron` above the ball: its triangles' distances are 2, 2, 2 and about 3.
class CheckTriangles : public CommandLine {
 protected:
  [[nodiscard]] std::string certified_map(const std::string& name, const std::string& device = "host") const {
    const auto outcome = run({"map", "--device", device, "--model", ball, "--mesh", mesh_, "--on", "triangles",
                              "--certificates", "-o", path(name)});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return path(name);
  }
  [[nodiscard]] Outcome check(const std::string& map, Arguments more = {}) const {
    more.insert(more.begin(), {"check", "--model", ball, "--mesh", mesh_, "--map", map});
    return run(more);
  }

  std::string mesh_ = write("mesh.off", tetrahedron);
};

TEST_F(CheckTriangles, ProvesAFinishedMap) {
  for (const std::string device : {"host", "auto"}) {
    for (const std::string name : {"map.csv", "map.vtp"}) {
      const auto outcome = check(certified_map(name, device));
      EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
      EXPECT_EQ(outcome.err, "");
      EXPECT_THAT(outcome.out, StartsWith("triangles            4\n  proved             4\n"));
      EXPECT_THAT(outcome.out, HasSubstr(" triangles/s\n"));
      EXPECT_THAT(outcome.out, Not(HasSubstr("point")));
    }
  }
}

TEST_F(CheckTriangles, NamesTheTriangleWhoseEnclosureIsWrong) {
  Table table(certified_map("map.csv"));
  table.at(1, "lo") = "1";  // the exact distance is 2
  table.at(1, "hi") = "1.5";
  const auto moved = write("moved.csv", table.text());
  const auto outcome = check(moved);
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("first refuted triangle, index 1, at (0, 0, 3), (0, 1, 4), (-1, -1, 4): hi is "
                                     "wrong"));
  const auto summary = nlohmann::json::parse(check(moved, {"--json"}).out);
  EXPECT_EQ(summary.at("triangles"), 4);
  EXPECT_EQ(summary.at("proved"), 3);
  EXPECT_EQ(summary.at("refuted"), 1);
  EXPECT_GE(summary.at("triangles_per_second"), 0.0);
  EXPECT_EQ(summary.at("first").at("triangle"), nlohmann::json::parse("[[0, 0, 3], [0, 1, 4], [-1, -1, 4]]"));
}

TEST_F(CheckTriangles, DoesNotProveByWeightsThatLeaveTheTriangle) {
  Table table(certified_map("map.csv"));
  table.at(0, "weight_1") = "-0.5";
  table.at(2, "weight_2") = "1e300";
  const auto outcome = check(write("false.csv", table.text()));
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("unproved           2\n"));
  EXPECT_THAT(outcome.out, HasSubstr("first unproved triangle, index 0,"));
}

TEST_F(CheckTriangles, RefusesAMapOfOtherLength) {
  const auto other = write("other.off", "OFF\n3 1 0\n0 0 3\n1 0 4\n0 1 4\n3 0 1 2\n");
  for (const std::string name : {"map.csv", "map.vtp"}) {
    const auto map = certified_map(name);
    expect_refused(run({"check", "--model", ball, "--mesh", other, "--map", map}),
                   {name, "other.off", "4 rows for the 1 triangles"});
  }
}

TEST_F(CheckTriangles, NeedsTheMesh) {
  const auto map = certified_map("map.csv");
  const auto points = write("points.csv", "0,0,3\n");
  expect_refused(run({"check", "--model", ball, "--points", points, "--map", map}), {"map.csv", "triangles", "--mesh"});
  const auto cloud = write("cloud.off", "OFF\n2 0 0\n0 0 3\n1 0 4\n");
  expect_refused(run({"check", "--model", ball, "--mesh", cloud, "--map", map}), {"cloud.off", "no triangles"});
}

// ---------------------------------------------------------------- check of pictures

/// Certified `.vtp` maps of a mesh, with one number of one array changed.
class CheckPicture : public CommandLine {
 protected:
  [[nodiscard]] std::string certified_map(const std::string& on) const {
    const auto outcome = map({"--model", ball, "--mesh", mesh_, "--on", on, "--certificates", "-o", path("map.vtp")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return contents(path("map.vtp"));
  }

  [[nodiscard]] Outcome check(const std::string& map, Arguments more = {}) const {
    more.insert(more.begin(), {"check", "--model", ball, "--mesh", mesh_, "--map", write("false.vtp", map)});
    return run(more);
  }

  /// Every row is proved, and yet the map is not.
  void expect_falsified(const std::string& map, const nlohmann::json& falsified) const {
    const auto outcome = check(map, {"--json"});
    EXPECT_EQ(outcome.status, 3) << falsified << outcome.err;
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(summary.at("proved"), 4);
    EXPECT_EQ(summary.at("falsified"), falsified);
  }

  std::string mesh_ = write("mesh.off", tetrahedron);
};

/// `map` with the number at `index` of an array changed.
template <class Number>
std::string with_number(std::string map, const std::string& name, std::size_t index, Number number) {
  const std::string key = "offset=\"";
  const std::size_t offset = std::stoul(map.substr(map.find(key, map.find("Name=\"" + name + "\"")) + key.size()));
  std::memcpy(map.data() + map.find("\n_") + 2 + offset + 8 + index * sizeof number, &number, sizeof number);
  return map;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST_F(CheckPicture, ProvesWhatIsDrawnAsGiven) {
  for (const std::string on : {"vertices", "triangles"}) {
    const auto outcome = check(certified_map(on));
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.out, Not(HasSubstr("falsified")));
  }
}

TEST_F(CheckPicture, NamesTheFirstFalsifiedNumberOfEveryArray) {
  for (const std::string on : {"vertices", "triangles"}) {
    const auto map = certified_map(on);
    expect_falsified(with_number(map, "Points", 5, 4.5),
                     {{"array", "Points"}, {"index", 1}, {"shown", "(1, 0, 4.5)"}, {"expected", "(1, 0, 4)"}});
    expect_falsified(with_number(map, "Points", 0, -0.0),
                     {{"array", "Points"}, {"index", 0}, {"shown", "(-0, 0, 3)"}, {"expected", "(0, 0, 3)"}});
    expect_falsified(with_number<std::int64_t>(map, "connectivity", 10, 2),
                     {{"array", "connectivity"}, {"index", 3}, {"shown", "(1, 2, 2)"}, {"expected", "(1, 3, 2)"}});
    expect_falsified(with_number<std::int64_t>(map, "offsets", 2, 7),
                     {{"array", "offsets"}, {"index", 2}, {"shown", "7"}, {"expected", "9"}});
    // The middle of [lo, hi], which row 0 of either map has about 2.
    const auto outcome = check(with_number(map, "dist_mid", 0, 1.0), {"--json"});
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    const auto found = nlohmann::json::parse(outcome.out).at("falsified");
    EXPECT_EQ(found.at("array"), "dist_mid");
    EXPECT_EQ(found.at("index"), 0);
    EXPECT_EQ(found.at("shown"), "1");
    EXPECT_NEAR(std::stod(std::string(found.at("expected"))), 2.0, 1e-5);
    const auto status = check(with_number<std::uint8_t>(map, "status", 0, 2), {"--json"});
    EXPECT_EQ(status.status, 3) << status.err;
    EXPECT_EQ(nlohmann::json::parse(status.out).at("falsified").at("array"), "status");
  }
}

TEST_F(CheckPicture, SaysWhatIsFalsified) {
  const auto outcome = check(with_number(certified_map("vertices"), "Points", 5, 4.5));
  EXPECT_THAT(outcome.out, EndsWith("falsified Points, index 1\n  shown              (1, 0, 4.5)\n"
                                    "  expected           (1, 0, 4)\n"));
}

TEST_F(CheckPicture, ComparesTheNumbersOfPointsAndCells) {
  const auto vertices = certified_map("vertices");
  const auto triangles = certified_map("triangles");
  mesh_ = write("mesh.off", replaced(replaced(tetrahedron, "4 4 0", "4 3 0"), "3 1 3 2\n", ""));
  expect_falsified(vertices, {{"array", "NumberOfPolys"}, {"index", nullptr}, {"shown", "4"}, {"expected", "3"}});
  mesh_ = write("mesh.off", replaced(replaced(tetrahedron, "4 4 0", "5 4 0"), "-1 -1 4\n", "-1 -1 4\n9 9 9\n"));
  expect_falsified(triangles, {{"array", "NumberOfPoints"}, {"index", nullptr}, {"shown", "4"}, {"expected", "5"}});
}

TEST_F(CheckPicture, ComparesTheDrawnPointsOfAStream) {
  const auto points = write("points.csv", "0,0,3\n1,2,3\n");
  ASSERT_EQ(map({"--model", ball, "--points", points, "--certificates", "-o", path("map.vtp")}).status, 0);
  const auto map = contents(path("map.vtp"));
  const auto falsified = [&](const std::string& text) {
    const auto outcome =
        run({"check", "--model", ball, "--points", points, "--map", write("false.vtp", text), "--json"});
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    return nlohmann::json::parse(outcome.out).at("falsified");
  };
  EXPECT_EQ(falsified(with_number(map, "Points", 3, 1.5)).at("shown"), "(1.5, 2, 3)");
  EXPECT_EQ(falsified(with_number<std::int64_t>(map, "connectivity", 1, 0)).at("array"), "connectivity");
  EXPECT_EQ(falsified(with_number<std::int64_t>(map, "offsets", 0, 2)).at("array"), "offsets");
  // A mesh that draws triangles between the same points.
  const auto mesh = write("three.off", "OFF\n3 1 0\n0 0 3\n1 2 3\n1 2 4\n3 0 1 2\n");
  const auto same = write("same.csv", "0,0,3\n1,2,3\n1,2,4\n");
  ASSERT_EQ(this->map({"--model", ball, "--mesh", mesh, "--certificates", "-o", path("mesh.vtp")}).status, 0);
  const auto outcome = run({"check", "--model", ball, "--points", same, "--map", path("mesh.vtp"), "--json"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out).at("falsified").at("array"), "NumberOfPolys");
}

// ---------------------------------------------------------------- bad usage

struct BadUsage {
  std::string name;
  Arguments arguments;  ///< after `map --model M`; MESH and OUT stand for good files
  std::vector<std::string> words;
};

void PrintTo(const BadUsage& usage, std::ostream* stream) {
  *stream << usage.name;
}

class BadUsageTest : public CommandLine, public ::testing::WithParamInterface<BadUsage> {};

TEST_P(BadUsageTest, IsRefused) {
  Arguments arguments{"map", "--model", ball};
  for (const auto& argument : GetParam().arguments) {
    if (argument == "MESH") {
      arguments.push_back(write("mesh.off", tetrahedron));
    } else {
      arguments.push_back(argument == "OUT" ? path("map.csv") : argument);
    }
  }
  expect_refused(run(arguments), GetParam().words);
  EXPECT_FALSE(std::filesystem::exists(path("map.csv")));
}

INSTANTIATE_TEST_SUITE_P(
    CommandLine, BadUsageTest,
    ::testing::Values(
        BadUsage{"NeitherMeshNorPoints", {"-o", "OUT"}, {"--mesh", "--points"}},
        BadUsage{"BothMeshAndPoints", {"--mesh", "MESH", "--points", "MESH", "-o", "OUT"}, {"--mesh", "--points"}},
        BadUsage{"NoOutput", {"--mesh", "MESH"}, {"--output"}},
        BadUsage{"UnknownOutputExtension", {"--mesh", "MESH", "-o", "map.xyz"}, {"map.xyz", ".csv"}},
        BadUsage{"NoOutputExtension", {"--mesh", "MESH", "-o", "map"}, {"map", ".csv"}},
        BadUsage{"NegativeTolerance", {"--mesh", "MESH", "--tol", "-1", "-o", "OUT"}, {"--tol", "-1"}},
        BadUsage{"NanTolerance", {"--mesh", "MESH", "--tol", "nan", "-o", "OUT"}, {"--tol", "nan"}},
        BadUsage{"InfiniteTolerance", {"--mesh", "MESH", "--tol", "inf", "-o", "OUT"}, {"--tol", "inf"}},
        BadUsage{"TextTolerance", {"--mesh", "MESH", "--tol", "1e-3mm", "-o", "OUT"}, {"--tol", "1e-3mm"}},
        BadUsage{
            "TrianglesOfPoints", {"--points", "MESH", "--on", "triangles", "-o", "OUT"}, {"--on triangles", "--mesh"}},
        BadUsage{"UnknownMethod", {"--mesh", "MESH", "--method", "simplex", "-o", "OUT"}, {"--method", "simplex"}},
        BadUsage{"OnSomethingElse", {"--mesh", "MESH", "--on", "edges", "-o", "OUT"}, {"--on", "edges"}},
        BadUsage{
            "CertificatesInPly", {"--mesh", "MESH", "--certificates", "-o", "map.ply"}, {"map.ply", ".csv", ".vtp"}},
        BadUsage{"EmptyTolerance", {"--mesh", "MESH", "--tol", "", "-o", "OUT"}, {"--tol: its value is empty"}},
        BadUsage{"EmptyDevice", {"--mesh", "MESH", "--device", "", "-o", "OUT"}, {"--device: its value is empty"}},
        BadUsage{"EmptyAssignment", {"--mesh", "MESH", "--device=", "-o", "OUT"}, {"--device: its value is empty"}},
        BadUsage{"EmptyName", {"--points", "", "--mesh", "MESH", "-o", "OUT"}, {"--points: its value is empty"}},
        BadUsage{"UnknownOption", {"--mesh", "MESH", "--tolerance", "1", "-o", "OUT"}, {"--tolerance"}},
        BadUsage{"DeviceIndexOutOfRange", {"--mesh", "MESH", "--device", "99", "-o", "OUT"}, {"99"}}),
    name_of);

TEST_F(CommandLine, RefusesBadCommands) {
  expect_refused(run({}), {"command", "--help"});
  expect_refused(run({"mop"}), {"mop", "--help"});
  expect_refused(run({"map"}), {"--model"});
  expect_refused(run({"devices", "--fast"}), {"--fast"});
  expect_refused(run({"check", "--model", ball, "--mesh", "mesh.off"}), {"--map"});
  expect_refused(run({"check", "--model", ball, "--map", "map.csv"}), {"--mesh", "--points"});
}

// ---------------------------------------------------------------- bad models

struct BadModel {
  std::string name;
  std::string text;
  std::vector<std::string> words;  ///< key and value
};

void PrintTo(const BadModel& model, std::ostream* stream) {
  *stream << model.name;
}

class BadModelTest : public CommandLine, public ::testing::WithParamInterface<BadModel> {};

TEST_P(BadModelTest, IsRefused) {
  const auto model = write("bad_model.json", GetParam().text);
  const auto outcome = map({"--model", model, "--mesh", write("mesh.off", tetrahedron), "-o", path("map.csv")});
  expect_refused(outcome, GetParam().words);
  EXPECT_THAT(outcome.err, HasSubstr("bad_model.json"));
  EXPECT_FALSE(std::filesystem::exists(path("map.csv")));
}

std::string model_of(const std::string& primitives, const std::string& rest = "") {
  return R"({"format": "verisq-model/1", "primitives": [)" + primitives + "]" + rest + "}";
}

/// One primitive "a" with one value replaced; `rest` continues the primitive, e.g. with a pose.
std::string solid(const std::string& semi_axes, const std::string& exponents, const std::string& rest = "") {
  return R"({"name": "a", "superquadric": {"semi_axes": )" + semi_axes + R"(, "exponents": )" + exponents + "}" + rest +
         "}";
}

const std::string good_axes = "[1, 2, 3]";
const std::string good_exponents = "[1, 1]";
const std::string good_solid = solid(good_axes, good_exponents);

std::string posed(const std::string& pose) {
  return model_of(solid(good_axes, good_exponents, R"(, "pose": )" + pose));
}
std::string bent(const std::string& bend) {
  return model_of(solid(good_axes, good_exponents, R"(, "bend": )" + bend));
}
std::string combined(const std::string& csg) {
  return model_of(good_solid, R"(, "csg": )" + csg);
}

INSTANTIATE_TEST_SUITE_P(
    CommandLine, BadModelTest,
    ::testing::Values(
        BadModel{"Empty", "", {"empty"}}, BadModel{"Syntax", R"({"format": )", {"line"}},
        BadModel{"NotAnObject", "[]", {"object"}}, BadModel{"NoFormat", R"({"primitives": []})", {"format"}},
        BadModel{"OtherFormat", R"({"format": "verisq-model/9", "primitives": []})", {"format", "verisq-model/9"}},
        BadModel{"NoPrimitives", R"({"format": "verisq-model/1"})", {"primitives"}},
        BadModel{"EmptyPrimitives", model_of(""), {"primitives"}},
        BadModel{"UnknownKey", model_of(good_solid, R"(, "colour": 3)"), {"colour"}},
        BadModel{"UnknownKeyOfPrimitive", model_of(solid(good_axes, good_exponents, R"(, "scale": 3)")), {"scale"}},
        BadModel{"UnknownKeyOfPose", posed(R"({"rotation": [1, 0, 0, 0]})"), {"rotation"}},
        BadModel{"RepeatedKey", model_of(good_solid, R"(, "units": "mm", "units": "m")"), {"units"}},
        BadModel{"RepeatedName", model_of(good_solid + "," + good_solid), {"name", "\"a\""}},
        BadModel{"NoName", model_of(R"({"superquadric": {"semi_axes": [1,1,1], "exponents": [1,1]}})"), {"name"}},
        BadModel{"NoSuperquadric", model_of(R"({"name": "a"})"), {"superquadric"}},
        BadModel{"ZeroSemiAxis", model_of(solid("[1, 0, 3]", good_exponents)), {"semi_axes", "0", "positive"}},
        BadModel{"NegativeSemiAxis", model_of(solid("[1, 2, -3]", good_exponents)), {"semi_axes", "-3", "positive"}},
        BadModel{"TwoSemiAxes", model_of(solid("[1, 2]", good_exponents)), {"semi_axes", "3"}},
        BadModel{"TextSemiAxis", model_of(solid(R"([1, 2, "3"])", good_exponents)), {"semi_axes", "\"3\""}},
        BadModel{"HugeSemiAxis", model_of(solid("[1, 2, 1e999]", good_exponents)), {"1e999"}},
        BadModel{"NanSemiAxis", model_of(solid("[1, 2, NaN]", good_exponents)), {"line"}},
        BadModel{"NullSemiAxis", model_of(solid("[1, 2, null]", good_exponents)), {"semi_axes", "null"}},
        BadModel{"ZeroExponent", model_of(solid(good_axes, "[0, 1]")), {"exponents", "0", "(0, 2]"}},
        BadModel{"NegativeExponent", model_of(solid(good_axes, "[1, -0.5]")), {"exponents", "-0.5", "(0, 2]"}},
        BadModel{"LargeExponent", model_of(solid(good_axes, "[1, 2.5]")), {"exponents", "2.5", "(0, 2]"}},
        BadModel{"ZeroQuaternion", posed(R"({"quaternion": [0, 0, 0, 0]})"), {"quaternion", "[0,0,0,0]", "zero"}},
        BadModel{"ShortQuaternion", posed(R"({"quaternion": [1, 0, 0]})"), {"quaternion", "4"}},
        BadModel{"HugeTranslation", posed(R"({"translation": [0, 0, -1e400]})"), {"-1e400"}},
        BadModel{"BendTooStrong", bent(R"({"curvature": 1.0, "angle_deg": 0})"), {"bend.curvature", "1.0", "below 1"}},
        BadModel{"BendTooLong",
                 model_of(solid("[0.1, 0.1, 3]", good_exponents, R"(, "bend": {"curvature": -1.1, "angle_deg": 90})")),
                 {"bend.curvature", "-1.1", "below pi"}},
        BadModel{"BendWithoutAngle", bent(R"({"curvature": 0.1})"), {"bend.angle_deg", "missing"}},
        BadModel{"BendAtAnUncertainPlace",
                 model_of(solid(good_axes, good_exponents, R"(, "bend": {"curvature": 0.1, "angle_deg": 90},
                   "pose": {"translation": [[0, 1], 0, 0]})")),
                 {"intervals of translations", "bent", "primitives[0].bend"}},
        BadModel{
            "ReversedSemiAxis", model_of(solid("[[2, 1], 2, 3]", good_exponents)), {"semi_axes", "[2,1]", "lower end"}},
        BadModel{
            "ReversedExponent", model_of(solid(good_axes, "[1, [1, 0.9]]")), {"exponents", "[1,0.9]", "lower end"}},
        BadModel{
            "ReversedTranslation", posed(R"({"translation": [0, 0, [2, 1]]})"), {"translation", "[2,1]", "lower end"}},
        BadModel{"UnknownNameInCsg", combined(R"({"union": ["a", "ghost"]})"), {"csg", "ghost"}},
        BadModel{"UnknownOperator", combined(R"({"xor": ["a"]})"), {"csg", "xor"}},
        BadModel{"EmptyIntersection", combined(R"({"intersection": []})"), {"intersection", "[]", "one operand"}},
        BadModel{"DifferenceOfOne",
                 combined(R"({"union": ["a", {"difference": ["a"]}]})"),
                 {"csg.union[1].difference", "two operands"}},
        BadModel{"DifferenceAtAnUncertainPlace",
                 model_of(solid(good_axes, good_exponents, R"(, "pose": {"translation": [[0, 1], 0, 0]})"),
                          R"(, "csg": {"difference": ["a", "a"]})"),
                 {"intervals of translations", "csg"}}),
    name_of);

// ---------------------------------------------------------------- bends and set operations

const std::string shell = model_of(R"(
    {"name": "all", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}},
    {"name": "hollow", "superquadric": {"semi_axes": [0.5, 0.5, 0.5], "exponents": [1, 1]}})",
                                   R"(, "csg": {"difference": ["all", "hollow"]})");
const std::string bow = bent(R"({"curvature": 0.1, "angle_deg": 70})");

TEST_F(CommandLine, MapsADifference) {
  const auto points = write("points.csv", "0.25,0,0\n0,0,0.75\n0,-2,0\n");
  const auto outcome =
      map({"--model", write("shell.json", shell), "--points", points, "--tol", "1e-3", "-o", path("map.csv")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto rows = rows_of(path("map.csv"));
  ASSERT_EQ(rows.size(), 3);
  const double exact[] = {0.25, -0.25, 1.0};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LE(rows[k].distance.lo, exact[k]) << k;
    EXPECT_GE(rows[k].distance.hi, exact[k]) << k;
    EXPECT_LE(rows[k].distance.width(), 1e-3) << k;
  }
}

TEST_F(CommandLine, MapsABentSolid) {
  // The pole (0, 0, 3) goes to R = 10 (1 - cos 0.3) in the direction of 70 degrees and Z = 10 sin 0.3, its normal to
  // (sin 0.3, cos 0.3) in that plane: it is the nearest point to one that lies 0.1 along that normal.
  const double r = 10.0 * (1.0 - std::cos(0.3)) + 0.1 * std::sin(0.3);
  const double z = 10.0 * std::sin(0.3) + 0.1 * std::cos(0.3);
  const double angle = 70.0 / 180.0 * std::acos(-1.0);
  std::ostringstream point;
  point << std::setprecision(17) << r * std::cos(angle) << ',' << r * std::sin(angle) << ',' << z << '\n';
  const auto outcome = map({"--model", write("bow.json", bow), "--points", write("points.csv", point.str()), "--tol",
                            "1e-3", "-o", path("map.csv")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto rows = rows_of(path("map.csv"));
  ASSERT_EQ(rows.size(), 1);
  EXPECT_LE(rows[0].distance.lo, 0.1 + 1e-12);
  EXPECT_GE(rows[0].distance.hi, 0.1 - 1e-12);
  EXPECT_LE(rows[0].distance.width(), 1e-3);
}

TEST_F(CommandLine, MapsTrianglesOfADifferenceAndOfABentSolid) {
  // In the hollow of the shell, 0.1 from its wall; through the shell; above both solids.
  const auto mesh = write("mesh.off",
                          "OFF\n9 3 0\n0.4 0 0\n0 0.1 0\n0 0 0.1\n0 0 0\n3 0 0\n0 3 0\n"
                          "-9 -9 4\n9 -9 4\n0 9 4\n3 0 1 2\n3 3 4 5\n3 6 7 8\n");
  const auto on_triangles = [&](const std::string& model) {
    const auto outcome =
        map({"--model", model, "--mesh", mesh, "--on", "triangles", "--tol", "1e-6", "-o", path("map.csv")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return rows_of(path("map.csv"));
  };
  const auto of_shell = on_triangles(write("shell.json", shell));
  ASSERT_EQ(of_shell.size(), 3);
  const double exact[] = {0.1, 0.0, 3.0};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LE(of_shell[k].distance.lo, exact[k]) << k;
    EXPECT_GE(of_shell[k].distance.hi, exact[k]) << k;
    EXPECT_LE(of_shell[k].distance.width(), 1e-6) << k;
  }
  // The height of the bow's pole, in the middle of the bend's plane, is that of its highest point or a little less.
  const auto of_bow = on_triangles(write("bow.json", bow));
  ASSERT_EQ(of_bow.size(), 3);
  EXPECT_GT(of_bow[2].distance.lo, 0.0);
  EXPECT_LE(of_bow[2].distance.hi, 4.0 - 10.0 * std::sin(0.3));
  EXPECT_EQ(of_bow[1].distance, (Enclosure{0.0, 0.0}));
}

TEST_F(CommandLine, RefusesAModelWithoutPoints) {
  const std::string apart = model_of(R"(
    {"name": "a", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}},
    {"name": "b", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}, "pose": {"translation": [5, 0, 0]}})",
                                     R"(, "csg": {"intersection": ["a", "b"]})");
  for (const char* device : {"auto", "host"}) {
    expect_refused(run({"map", "--model", write("apart.json", apart), "--mesh", write("mesh.off", tetrahedron),
                        "--device", device, "-o", path("map.csv")}),
                   {"no point"});
  }
}

TEST_F(CommandLine, RefusesTrianglesOfAModelWithoutPointsAndByThePublishedMethod) {
  const std::string apart = model_of(R"(
    {"name": "a", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}},
    {"name": "b", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}, "pose": {"translation": [5, 0, 0]}})",
                                     R"(, "csg": {"intersection": ["a", "b"]})");
  const auto mesh = write("mesh.off", tetrahedron);
  expect_refused(
      run({"map", "--model", write("apart.json", apart), "--mesh", mesh, "--on", "triangles", "-o", path("map.csv")}),
      {"no point"});
  expect_refused(run({"map", "--model", write("bow.json", bow), "--mesh", mesh, "--on", "triangles", "--method",
                      "published", "--device", "host", "-o", path("map.csv")}),
                 {"published", "bow.json"});
}

TEST_F(CommandLine, ProvesTrianglesAboutBendsAndSetOperationsAgain) {
  const auto mesh = write("mesh.off", tetrahedron);
  for (const auto& [file, text] : {std::pair{"shell.json", shell}, std::pair{"bow.json", bow}}) {
    const std::string model = write(file, text);
    for (const char* name : {"map.csv", "map.vtp"}) {
      ASSERT_EQ(map({"--model", model, "--mesh", mesh, "--on", "triangles", "--certificates", "-o", path(name)}).status,
                0);
      const auto outcome = run({"check", "--model", model, "--mesh", mesh, "--map", path(name)});
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      EXPECT_THAT(outcome.out, HasSubstr("proved             4"));
    }
  }
}

TEST_F(CommandLine, ProvesTrianglesAboutMeshesAgain) {
  const auto mesh = write("mesh.off", tetrahedron);
  const auto solid =
      write("solid.off", "OFF\n4 4 0\n9 0 0\n10 0 0\n9 1 0\n9 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
  for (const char* name : {"map.csv", "map.vtp"}) {
    for (const char* radius : {"0", "0.125"}) {
      ASSERT_EQ(map({"--model", solid, "--mesh", mesh, "--on", "triangles", "--certificates", "--point-radius", radius,
                     "--tol", "1", "-o", path(name)})
                    .status,
                0);
      const auto outcome =
          run({"check", "--model", solid, "--mesh", mesh, "--map", path(name), "--point-radius", radius});
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      EXPECT_THAT(outcome.out, HasSubstr("proved             4"));
      EXPECT_EQ(outcome.err, "") << "nothing of depths: triangles have none";
    }
  }
}

TEST_F(CommandLine, RefusesWhatNeedsConvexityForOtherSolids) {
  const auto mesh = write("mesh.off", tetrahedron);
  const auto poses = write("poses.csv", "0,0,3,1,0,0,0\n");
  for (const auto& [name, text] : {std::pair{"shell.json", shell}, std::pair{"bow.json", bow}}) {
    const std::string model = write(name, text);
    const Arguments common{"--model", model, "--mesh", mesh, "-o", path("map.csv")};
    const auto with = [&](std::initializer_list<std::string> more) {
      auto arguments = common;
      arguments.insert(arguments.end(), more);
      return map(arguments);
    };
    if (name != std::string("bow.json")) {
      expect_refused(with({"--certificates", "--point-radius", "0.1"}),
                     {"--certificates", "--point-radius", name, "not supported", "csg"});
    }
    expect_refused(with({"--certificates", "--on", "triangles", "--point-radius", "0.1"}),
                   {"--certificates with --on triangles", "--point-radius", name, "not supported", "bends"});
    expect_refused(with({"--method", "published"}), {"--method published", name, "not supported", "bends", "csg"});
    EXPECT_FALSE(std::filesystem::exists(path("map.csv")));
    expect_refused(run({"distance", model, ball, "--poses", poses, "-o", path("map.csv"), "--closest-points"}),
                   {"--closest-points", "not supported"});
  }
}

TEST_F(CommandLine, MissingModelIsRefused) {
  const auto mesh = write("mesh.off", tetrahedron);
  expect_refused(map({"--model", path("none.json"), "--mesh", mesh, "-o", path("map.csv")}), {"none.json"});
}

// ---------------------------------------------------------------- bad meshes and points

struct BadFile {
  std::string name;
  std::string file;  ///< its extension picks the reader
  std::string text;
  std::vector<std::string> words;  ///< position and value
};

void PrintTo(const BadFile& file, std::ostream* stream) {
  *stream << file.name;
}

class BadFileTest : public CommandLine, public ::testing::WithParamInterface<BadFile> {};

TEST_P(BadFileTest, IsRefused) {
  const auto& bad = GetParam();
  const auto* option = bad.file.ends_with(".csv") ? "--points" : "--mesh";
  const auto outcome = map({"--model", ball, option, write(bad.file, bad.text), "-o", path("map.csv")});
  expect_refused(outcome, bad.words);
  EXPECT_THAT(outcome.err, HasSubstr(bad.file));
  EXPECT_FALSE(std::filesystem::exists(path("map.csv")));
}

/// The bytes of a binary32 in the order of STL and of this machine.
std::string bytes(float value) {
  const auto raw = std::bit_cast<std::array<char, sizeof(float)>>(value);
  return {raw.begin(), raw.end()};
}

/// A binary STL that promises `promised` triangles and has those of `corners` (nine floats each).
std::string binary_stl(std::uint32_t promised, const std::vector<float>& corners) {
  std::string text(80, '\0');
  for (int shift = 0; shift < 32; shift += 8) text += static_cast<char>(promised >> shift & 0xff);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (k % 9 == 0) text += std::string(12, '\0');
    text += bytes(corners[k]);
    if (k % 9 == 8) text += std::string(2, '\0');
  }
  return text;
}

std::string ascii_stl(const std::string& last_vertex) {
  return "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 3\nvertex 1 0 3\nvertex " + last_vertex +
         "\nendloop\nendfacet\nendsolid s\n";
}

std::string ascii_ply(const std::string& last_vertex, const std::string& face) {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 3\n1 0 3\n" +
         last_vertex + "\n" + face + "\n";
}

const std::string binary_ply_header =
    "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 0\nproperty list uchar int vertex_indices\nend_header\n";

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

INSTANTIATE_TEST_SUITE_P(
    Mesh, BadFileTest,
    ::testing::Values(
        BadFile{"UnknownFormat", "mesh.xyz", "1 2 3\n", {".xyz", ".stl"}},
        BadFile{"EmptyOff", "mesh.off", "", {"empty"}},
        BadFile{"OffNan", "mesh.off", "OFF\n3 1 0\n0 0 3\n1 0 nan\n0 1 3\n3 0 1 2\n", {"line 4", "nan"}},
        BadFile{"OffInfinity", "mesh.off", "OFF\n3 1 0\n0 0 3\n1 0 3\n0 -inf 3\n3 0 1 2\n", {"line 5", "-inf"}},
        BadFile{"OffText", "mesh.off", "OFF\n3 1 0\n0 zero 3\n1 0 3\n0 1 3\n3 0 1 2\n", {"line 3", "zero"}},
        BadFile{"OffIndex", "mesh.off", "OFF\n3 1 0\n0 0 3\n1 0 3\n0 1 3\n3 0 1 3\n", {"line 6", "3"}},
        BadFile{"OffNegativeIndex", "mesh.off", "OFF\n3 1 0\n0 0 3\n1 0 3\n0 1 3\n3 0 1 -1\n", {"line 6", "-1"}},
        BadFile{"OffRepeatedCorner",
                "mesh.off",
                "OFF\n3 1 0\n0 0 3\n1 0 3\n0 1 3\n3 0 1 1\n",
                {"triangle 1", "vertex twice"}},
        BadFile{"OffTruncated", "mesh.off", "OFF\n3 1 0\n0 0 3\n1 0 3\n", {"truncated"}},
        BadFile{"OffWithoutVertices", "mesh.off", "OFF\n0 0 0\n", {"no vertices"}},
        BadFile{"EmptyObj", "mesh.obj", "", {"empty"}},
        BadFile{"ObjNan", "mesh.obj", "v 0 0 3\nv 1 NaN 3\nv 0 1 3\nf 1 2 3\n", {"line 2", "NaN"}},
        BadFile{"ObjIndex", "mesh.obj", "v 0 0 3\nv 1 0 3\nv 0 1 3\nf 1 2 4\n", {"line 4", "4"}},
        BadFile{"ObjZeroIndex", "mesh.obj", "v 0 0 3\nv 1 0 3\nv 0 1 3\nf 0 1 2\n", {"line 4", "0"}},
        BadFile{"EmptyStl", "mesh.stl", "", {"empty"}}, BadFile{"StlText", "mesh.stl", "hello\n", {"solid"}},
        BadFile{"StlNan", "mesh.stl", ascii_stl("0 nan 3"), {"line 6", "nan"}},
        BadFile{"StlTruncated", "mesh.stl", "solid s\nfacet normal 0 0 1\nouter loop\n", {"truncated"}},
        BadFile{"BinaryStlTruncated", "mesh.stl", binary_stl(2, {0, 0, 3, 1, 0, 3, 0, 1, 3}), {"truncated", "134"}},
        BadFile{"BinaryStlNan", "mesh.stl", binary_stl(1, {0, 0, 3, 1, nan, 3, 0, 1, 3}), {"byte 84", "nan"}},
        BadFile{"BinaryStlInfinity", "mesh.stl", binary_stl(1, {0, 0, 3, 1, 0, 3, 0, 1, infinite}), {"byte 84", "inf"}},
        BadFile{"BinaryStlWithoutTriangles", "mesh.stl", binary_stl(0, {}), {"no triangles"}},
        BadFile{"EmptyPly", "mesh.ply", "", {"empty"}},
        BadFile{"PlyWithoutEnd", "mesh.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", {"truncated"}},
        BadFile{"PlyNan", "mesh.ply", ascii_ply("nan 1 3", "3 0 1 2"), {"line 12", "nan"}},
        BadFile{"PlyIndex", "mesh.ply", ascii_ply("0 1 3", "3 0 1 7"), {"line 13", "7"}},
        BadFile{"BinaryPlyTruncated", "mesh.ply", binary_ply_header + bytes(1) + bytes(2), {"byte", "truncated"}},
        BadFile{"BinaryPlyNan",
                "mesh.ply",
                binary_ply_header + bytes(0) + bytes(0) + bytes(nan) + std::string(24, '\0'),
                {"byte", "nan"}}),
    name_of);

// ---------------------------------------------------------------- meshes as models

const std::vector<std::string> mesh_formats{".stl", ".off", ".obj", ".ply"};

Mesh scaled(Mesh mesh, double scale) {
  for (Point& vertex : mesh.vertices)
    for (double& x : vertex) x *= scale;
  return mesh;
}

Mesh turned(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  return mesh;
}

TEST_F(CommandLine, MeshesThatAreNoSolidsAreRefusedInOneLine) {
  const std::string points = write("points.csv", "0,0,3\n");
  Mesh one = verisq::testing::tetrahedron();
  one.triangles.resize(1);
  Mesh open = verisq::testing::tetrahedron();
  open.triangles.pop_back();
  Mesh one_turned = verisq::testing::tetrahedron();
  std::swap(one_turned.triangles[0][0], one_turned.triangles[0][1]);
  for (const std::string& format : mesh_formats) {
    const auto refused = [&](const std::string& name, const Mesh& mesh, const std::vector<std::string>& words) {
      write_mesh(path(name + format), mesh);
      const Outcome outcome = map({"--model", path(name + format), "--points", points, "-o", path("map.csv")});
      expect_refused(outcome, words);
      EXPECT_THAT(outcome.err, HasSubstr(name)) << format;
      EXPECT_FALSE(std::filesystem::exists(path("map.csv")));
    };
    refused("one", one, {"one" + format, "not closed", "3 of its edges"});
    refused("open", open, {"open" + format, "not closed", "3 of its edges"});
    refused("one_turned", one_turned, {"one_turned" + format, "not closed", "6 of its edges"});
    if (format == ".stl") continue;  // has binary32 numbers alone
    refused("huge", scaled(verisq::testing::tetrahedron(), 1e308), {"largest coordinate is 1e+308"});
    refused("tiny", scaled(verisq::testing::tetrahedron(), 1e-300), {"largest coordinate is 1e-300"});
  }
}

/// What BadFileTest has of meshes, as models.
class BadSolidTest : public CommandLine, public ::testing::WithParamInterface<BadFile> {};

TEST_P(BadSolidTest, IsRefused) {
  const auto& bad = GetParam();
  const std::string points = write("points.csv", "0,0,3\n");
  const Outcome outcome = map({"--model", write(bad.file, bad.text), "--points", points, "-o", path("map.csv")});
  expect_refused(outcome, bad.words);
  EXPECT_THAT(outcome.err, HasSubstr(bad.file));
}

INSTANTIATE_TEST_SUITE_P(
    Mesh, BadSolidTest,
    ::testing::Values(BadFile{"EmptyStl", "mesh.stl", "", {"empty"}},
                      BadFile{"StlNan", "mesh.stl", ascii_stl("0 nan 3"), {"nan"}},
                      BadFile{"StlInfinity", "mesh.stl", ascii_stl("0 inf 3"), {"inf"}},
                      BadFile{"StlOverflow", "mesh.stl", ascii_stl("0 1e400 3"), {"1e400"}},
                      BadFile{"StlWithoutTriangles", "mesh.stl", binary_stl(0, {}), {"no triangles"}},
                      BadFile{"StlOfZeroArea", "mesh.stl", ascii_stl("2 0 3"), {"not closed"}},
                      BadFile{"EmptyObj", "mesh.obj", "", {"empty"}},
                      BadFile{"ObjNan", "mesh.obj", "v 0 0 3\nv 1 NaN 3\nv 0 1 3\nf 1 2 3\n", {"NaN"}},
                      BadFile{"ObjIndex", "mesh.obj", "v 0 0 3\nv 1 0 3\nv 0 1 3\nf 1 2 4\n", {"4"}},
                      BadFile{"ObjOfZeroArea", "mesh.obj", "v 0 0 3\nv 1 0 3\nv 2 0 3\nf 1 2 3\n", {"not closed"}},
                      BadFile{"ObjWithoutTriangles", "mesh.obj", "v 0 0 3\nv 1 0 3\nv 2 0 3\n", {"no triangles"}},
                      BadFile{"EmptyPly", "mesh.ply", "", {"empty"}},
                      BadFile{"PlyInfinity", "mesh.ply", ascii_ply("-inf 1 3", "3 0 1 2"), {"-inf"}},
                      BadFile{"PlyIndex", "mesh.ply", ascii_ply("0 1 3", "3 0 1 7"), {"7"}},
                      BadFile{"PlyNegativeIndex", "mesh.ply", ascii_ply("0 1 3", "3 0 1 -1"), {"-1"}},
                      BadFile{"PlyOfZeroArea", "mesh.ply", ascii_ply("2 0 3", "3 0 1 2"), {"not closed"}}),
    name_of);

/// A tetrahedron of which one side is divided for one of its two faces, closed by a triangle without area; and a side
/// as a triangle that names a vertex twice.
TEST_F(CommandLine, TrianglesWithoutAreaChangeNothing) {
  const std::string plain =
      write("plain.off", "OFF\n4 4 0\n0 0 0\n2 0 0\n0 2 0\n0 0 2\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
  const std::string thin = write("thin.off",
                                 "OFF\n5 7 0\n0 0 0\n2 0 0\n0 2 0\n0 0 2\n1 0 0\n3 0 2 1\n3 0 4 3\n3 4 1 3\n3 0 1 4\n"
                                 "3 1 2 3\n3 2 0 3\n3 1 2 2\n");
  const std::string points = write("points.csv", "0.25,0.25,0.25\n3,1,1\n1,0,-2\n");
  const auto rows_about = [&](const std::string& model) {
    EXPECT_EQ(map({"--model", model, "--points", points, "--certificates", "-o", path("proof.csv")}).status, 0);
    EXPECT_EQ(run({"check", "--model", model, "--points", points, "--map", path("proof.csv")}).status, 0);
    EXPECT_EQ(map({"--model", model, "--points", points, "-o", path("map.csv")}).status, 0);
    return rows_of(path("map.csv"));
  };
  const std::vector<Row> about_plain = rows_about(plain);
  const std::vector<Row> about_thin = rows_about(thin);
  ASSERT_EQ(about_plain.size(), 3U);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_NEAR(about_plain[n].distance.lo, about_thin[n].distance.lo, 1e-14);
    EXPECT_NEAR(about_plain[n].distance.hi, about_thin[n].distance.hi, 1e-14);
  }
  const auto volume_of = [&](const std::string& model) {
    const Outcome outcome = run({"octree", "--model", model, "--depth", "5", "--json", "-o", path("octree.vtu")});
    return nlohmann::json::parse(outcome.out).at("volume");
  };
  EXPECT_EQ(volume_of(plain), volume_of(thin));
  ASSERT_EQ(map({"--model", ball, "--mesh", thin, "--on", "triangles", "-o", path("map.csv")}).status, 0);
  EXPECT_EQ(rows_of(path("map.csv")).size(), 6U);
}

/// Sheets that enclose nothing, twice the same, turned inward: all are solids, and points know their sides.
TEST_F(CommandLine, MeshesThatCoincideOrEncloseNothingAreSolids) {
  const std::string points = write("points.csv", "0.125,0.125,0.125\n0.25,0.25,2\n0.25,0.25,0\n");
  const Mesh solid = verisq::testing::tetrahedron();
  const Mesh sheet{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}, {1, 0, 2}}};
  for (const std::string& format : mesh_formats) {
    const auto expect_depth = [&](const std::string& name, const Mesh& mesh, double distance) {
      write_mesh(path(name + format), mesh);
      const Outcome outcome = map({"--model", path(name + format), "--points", points, "-o", path("map.csv")});
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      const std::vector<Row> rows = rows_of(path("map.csv"));
      ASSERT_EQ(rows.size(), 3U);
      EXPECT_NEAR(rows[0].distance.lo, distance, 1e-12) << name << format;
      EXPECT_NEAR(rows[0].distance.hi, distance, 1e-12) << name << format;
      EXPECT_GT(rows[1].distance.lo, 1.0);
      EXPECT_EQ(rows[2].distance, (Enclosure{0.0, 0.0}));
    };
    expect_depth("inward", turned(solid), -0.125);
    expect_depth("twice", verisq::testing::join(solid, solid), -0.125);
    expect_depth("opposed", verisq::testing::join(solid, turned(solid)), 0.125);
    expect_depth("sheet", sheet, 0.125);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Points, BadFileTest,
    ::testing::Values(BadFile{"Empty", "points.csv", "", {"empty"}},
                      BadFile{"OnlyAHeader", "points.csv", "x,y,z\n", {"no points"}},
                      BadFile{"Nan", "points.csv", "0,0,3\n0,nan,3\n", {"line 2", "nan"}},
                      BadFile{"Infinity", "points.csv", "x,y,z\n0,0,3\ninf,0,3\n", {"line 3", "inf"}},
                      BadFile{"Overflow", "points.csv", "0,0,1e999\n", {"line 1", "1e999"}},
                      BadFile{"Text", "points.csv", "0,0,3\n0,zero,3\n", {"line 2", "zero"}},
                      BadFile{"TwoNumbers", "points.csv", "0,0,3\n1,2\n", {"line 2", "1,2"}},
                      BadFile{"FourNumbers", "points.csv", "0,0,3\n0,0,3,4\n", {"line 2", "0,0,3,4"}},
                      BadFile{"MissingNumber", "points.csv", "0,,3\n", {"line 1", "y"}}),
    name_of);

TEST_F(CommandLine, MissingFilesAreRefused) {
  expect_refused(map({"--model", ball, "--mesh", path("none.off"), "-o", path("map.csv")}), {"none.off"});
  expect_refused(map({"--model", ball, "--points", path("none.csv"), "-o", path("map.csv")}), {"none.csv"});
  expect_refused(map({"--model", ball, "--points", folder_.path().string(), "-o", path("map.csv")}),
                 {folder_.path().string()});
}

}  // namespace
}  // namespace verisq::testing
