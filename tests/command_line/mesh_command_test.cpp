/// `verisq mesh` as its user meets it: results, messages and exit status.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <verisq/files.hpp>
#include <verisq/mesh_topology.hpp>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class MeshCommand : public ProgramTest {
 protected:
  [[nodiscard]] Outcome mesh(Arguments arguments) const {
    arguments.insert(arguments.begin(), "mesh");
    return run(arguments);
  }
  [[nodiscard]] std::string ball() const {
    return folder_
        .file("ball.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [{"name": "ball",
        "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}}]})")
        .string();
  }
  void expect_refused(const Arguments& arguments, const std::string& message) const {
    const Outcome outcome = mesh(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_EQ(outcome.out, "");
  }
};

TEST_F(MeshCommand, WritesEachFormatThatOtherProgramsRead) {
  for (const std::string name : {"ball.stl", "ball.ply", "ball.off", "ball.obj"}) {
    SCOPED_TRACE(name);
    const Outcome outcome = mesh({"--model", ball(), "--deviation", "0.01", "-o", path(name)});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, StartsWith("deviation          [0.0"));
    EXPECT_THAT(outcome.out, HasSubstr("mm, proven both ways; wanted 0.01 mm\n"));
    EXPECT_THAT(outcome.out, HasSubstr("surface            closed, manifold, outward; one component of genus 0\n"));
    const Mesh read = read_mesh(path(name));
    EXPECT_TRUE(mesh_topology(read).bounds_solid());
    EXPECT_NEAR(signed_volume(read), 4.0 / 3.0 * std::numbers::pi, 0.01 * 4.0 * std::numbers::pi);
  }
}

TEST_F(MeshCommand, PrintsOneJsonObject) {
  const Outcome outcome = mesh({"--model", ball(), "--deviation", "0.01", "-o", path("ball.ply"), "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_LE(json["proven_deviation"]["hi"], 0.01);
  EXPECT_GT(json["proven_deviation"]["lo"], 0.001);
  EXPECT_EQ(json["deviation"], 0.01);
  EXPECT_EQ(json["triangles"], read_mesh(path("ball.ply")).triangles.size());
  EXPECT_EQ(json["components"], 1);
  EXPECT_EQ(json["genus"], 0);
  EXPECT_EQ(json["closed"], true);
  EXPECT_EQ(json["units"], "mm");
  EXPECT_EQ(json["output"], path("ball.ply"));
}

TEST_F(MeshCommand, TellsNoVolumeThatIsNoNumber) {
  const std::string tiny = folder_
                               .file("tiny.json", R"({"format": "verisq-model/1", "primitives": [{"name": "ball",
        "superquadric": {"semi_axes": [1e-200, 1e-200, 1e-200], "exponents": [1, 1]}}]})")
                               .string();
  const Arguments arguments{"--model", tiny, "--deviation", "1e-201", "-o", path("tiny.ply")};
  const Outcome outcome = mesh(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("volume             not told: no binary64 number is that large or small\n"));
  Arguments as_json = arguments;
  as_json.emplace_back("--json");
  const auto json = nlohmann::json::parse(mesh(as_json).out);
  EXPECT_LE(json["proven_deviation"]["hi"], 1e-201);
  EXPECT_TRUE(json["volume"].is_null());
}

TEST_F(MeshCommand, SaysWhatIsNotProven) {
  const Outcome outcome = mesh({"--model", ball(), "--deviation", "0.01", "-o", path("ball.stl"), "--no-proof"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("estimated at"));
  EXPECT_THAT(outcome.out, HasSubstr("not proven; wanted 0.01 mm"));
}

TEST_F(MeshCommand, WritesNothingWhenInterrupted) {
  const Outcome outcome = run_interrupted(
      {"mesh", "--model", places::example("stem_mm.json"), "--deviation", "0.001", "-o", path("a.stl")});
  EXPECT_EQ(outcome.status, 130);
  EXPECT_EQ(outcome.err, "verisq: interrupted; " + path("a.stl") + " is not written\n");
  EXPECT_EQ(outcome.out, "");
  EXPECT_FALSE(std::filesystem::exists(path("a.stl")));
}

/// At 1e6 two binary32 numbers are 0.0625 apart: vertices move by up to 0.054.
TEST_F(MeshCommand, SaysWhereBinary32IsTooCoarse) {
  const std::string far = write("far.json", R"({"format": "verisq-model/1", "primitives": [{"name": "ball",
        "superquadric": {"semi_axes": [10, 10, 10], "exponents": [1, 1]},
        "pose": {"translation": [1e6, 1e6, 1e6]}}]})");
  expect_refused({"--model", far, "--deviation", "0.02", "-o", path("far.stl"), "--no-proof"},
                 "far.stl: STL's binary32 numbers would move vertices by up to 0.05");
  EXPECT_FALSE(std::filesystem::exists(path("far.stl")));
  EXPECT_EQ(mesh({"--model", far, "--deviation", "0.02", "-o", path("far.ply"), "--no-proof"}).status, 0);
  // An estimate holds that of rounding.
  const auto estimated = [&](const std::string& name) {
    const Outcome outcome = mesh({"--model", far, "--deviation", "0.2", "-o", path(name), "--no-proof"});
    return std::stod(outcome.out.substr(outcome.out.find("deviation") + std::string("deviation").size()));
  };
  EXPECT_GT(estimated("far.stl"), estimated("far.ply") + 0.03);
}

TEST_F(MeshCommand, RefusesBadUsage) {
  expect_refused({"--model", ball(), "-o", path("a.stl")}, "--deviation is required");
  expect_refused({"--model", ball(), "--deviation", "0", "-o", path("a.stl")}, "--deviation: 0");
  expect_refused({"--model", ball(), "--deviation", "x", "-o", path("a.stl")}, "--deviation: ");
  expect_refused({"--model", ball(), "--deviation", "0.1", "-o", path("a.vtp")}, "unknown mesh format '.vtp'");
  expect_refused({"--model", path("none.json"), "--deviation", "0.1", "-o", path("a.stl")}, "none.json");
  EXPECT_FALSE(std::filesystem::exists(path("a.stl")));
}

TEST_F(MeshCommand, EndsByATimeLimit) {
  const std::string file = path("ball.ply");
  const Outcome outcome = mesh({"--model", ball(), "--deviation", "0.01", "-o", file, "--time-limit", "1e-9"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(outcome.err, "verisq: the time limit is reached; " + file + " is not written\n");
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace verisq::testing
