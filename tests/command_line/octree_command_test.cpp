/// `verisq octree` as its user meets it: results, messages and exit status.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class OctreeCommand : public ProgramTest {
 protected:
  [[nodiscard]] Outcome octree(Arguments arguments) const {
    arguments.insert(arguments.begin(), "octree");
    return run(arguments);
  }
  /// With the ball of radius 1 and the output cubes.vtu.
  [[nodiscard]] Outcome octree_of_ball(Arguments arguments) const {
    arguments.insert(arguments.begin(), {"--model", ball(), "-o", cubes()});
    return octree(arguments);
  }
  [[nodiscard]] std::string ball() const {
    return folder_
        .file("ball.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [{"name": "ball",
        "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}}]})")
        .string();
  }
  [[nodiscard]] std::string cubes() const { return (folder_ / "cubes.vtu").string(); }
  void expect_refused(const Arguments& arguments, const std::string& message) const {
    const Outcome outcome = octree(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err, "verisq: " + message + "\n");
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(std::filesystem::exists(cubes()));
  }
};

constexpr double ball_volume = 4.0 / 3.0 * std::numbers::pi;

TEST_F(OctreeCommand, PrintsTheVolumeAndWritesTheCubes) {
  const Outcome outcome = octree_of_ball({"--depth", "5"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, StartsWith("level             edge        inside     undecided       outside\n0 "));
  const std::size_t begin = outcome.out.find("volume             [");
  ASSERT_NE(begin, std::string::npos);
  double lo = 0.0;
  double hi = 0.0;
  ASSERT_EQ(std::sscanf(outcome.out.c_str() + begin, "volume [%lf, %lf] mm^3", &lo, &hi), 2);
  EXPECT_LT(lo, ball_volume);
  EXPECT_GT(hi, ball_volume);
  pugi::xml_document xml;
  const std::string file = folder_.contents("cubes.vtu");
  EXPECT_TRUE(xml.load_string(
      (file.substr(0, file.find('_', file.find("<AppendedData"))) + "</AppendedData></VTKFile>").c_str()));
}

TEST_F(OctreeCommand, PrintsOneJsonObject) {
  const Outcome outcome = octree_of_ball({"--tol", "0.5", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_LT(json["volume"]["lo"], ball_volume);
  EXPECT_GT(json["volume"]["hi"], ball_volume);
  EXPECT_LE(json["volume"]["hi"].get<double>() - json["volume"]["lo"].get<double>(), 0.5);
  EXPECT_EQ(json["tolerance"], 0.5);
  EXPECT_EQ(json["units"], "mm");
  EXPECT_EQ(json["levels"].size(), json["depth"].get<std::size_t>() + 1);
  EXPECT_EQ(json["root"]["half_width"], 1.0);
  EXPECT_EQ(json["budget_hit"], false);
  EXPECT_EQ(json["output"], cubes());
}

TEST_F(OctreeCommand, GivesTheSameFileEachTime) {
  EXPECT_EQ(octree_of_ball({"--depth", "5"}).status, 0);
  const std::string first = folder_.contents("cubes.vtu");
  EXPECT_EQ(octree_of_ball({"--depth", "5"}).status, 0);
  EXPECT_TRUE(folder_.contents("cubes.vtu") == first);
}

TEST_F(OctreeCommand, MovesTheModelWhereAsked) {
  EXPECT_EQ(octree_of_ball({"--depth", "3", "--pose", "16,-8,32,1,0,0,0"}).status, 0);
  const std::string moved = folder_.contents("cubes.vtu");
  const std::string elsewhere = R"({"format": "verisq-model/1", "units": "mm", "primitives": [{"name": "ball",
      "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]},
      "pose": {"translation": [16, -8, 32], "quaternion": [1, 0, 0, 0]}}]})";
  const std::string model = folder_.file("elsewhere.json", elsewhere).string();
  EXPECT_EQ(octree({"--model", model, "-o", cubes(), "--depth", "3"}).status, 0);
  EXPECT_TRUE(folder_.contents("cubes.vtu") == moved);
}

TEST_F(OctreeCommand, WritesWhiteCubesWhereAsked) {
  EXPECT_EQ(octree_of_ball({"--depth", "4"}).status, 0);
  const auto without = std::filesystem::file_size(cubes());
  EXPECT_EQ(octree_of_ball({"--depth", "4", "--white"}).status, 0);
  EXPECT_GT(std::filesystem::file_size(cubes()), without);
}

TEST_F(OctreeCommand, RunsOnTheHostAlone) {
  const Outcome outcome = octree_of_ball({"--depth", "3", "--device", "host", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["device"], "host");
}

TEST_F(OctreeCommand, SaysThatTheBudgetIsHit) {
  const Outcome outcome = octree_of_ball({"--depth", "8", "--budget", "500", "--json"});
  EXPECT_EQ(outcome.status, 3);
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["budget_hit"], true);
  EXPECT_LT(json["volume"]["lo"], ball_volume);
  EXPECT_GT(json["volume"]["hi"], ball_volume);
  EXPECT_EQ(outcome.err, "verisq: the budget is hit at level " + json["depth"].dump() +
                             ": the octree is valid, but coarser; give a larger --budget\n");
  EXPECT_TRUE(std::filesystem::exists(cubes()));
}

TEST_F(OctreeCommand, LeavesNothingBehindWhenInterrupted) {
  const Outcome outcome = run_interrupted({"octree", "--model", ball(), "-o", cubes(), "--depth", "20", "--budget",
                                           "100000000", "--device", "host", "--json"});
  EXPECT_EQ(outcome.status, 130);
  EXPECT_EQ(outcome.err, "verisq: interrupted; " + cubes() + " is not written\n");
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["interrupted"], true);
  EXPECT_LT(json["volume"]["lo"], ball_volume);
  EXPECT_GT(json["volume"]["hi"], ball_volume);
  EXPECT_THAT(folder_.names(), ::testing::UnorderedElementsAre("ball.json", "process.err", "process.out"));
}

TEST_F(OctreeCommand, RefusesBadUsage) {
  const std::string model = ball();
  expect_refused({"--model", model, "-o", cubes(), "--depth", "21"}, "--depth: 21 is not in 0 to 20");
  expect_refused({"--model", model, "-o", cubes(), "--depth", "-1"}, "--depth: -1 is not in 0 to 20");
  expect_refused({"--model", model, "-o", cubes(), "--depth", "3", "--tol", "1"}, "give either --depth or --tol");
  expect_refused({"--model", model, "-o", cubes(), "--tol", "nan"}, "--tol: nan is not a finite number of at least 0");
  expect_refused({"--model", model, "-o", cubes(), "--budget", "0"}, "--budget: 0 is not at least 1");
  expect_refused({"--model", model, "-o", model}, "-o " + model + ": would overwrite an input");
  expect_refused({"--model", model, "-o", cubes() + "x"}, cubes() + "x: octrees are written as .vtu");
  expect_refused({"--model", model + "x", "-o", cubes()}, model + "x: no such file");
  EXPECT_EQ(octree({"--model", model, "-o", (folder_ / "none/cubes.vtu").string()}).status, 1);
  EXPECT_EQ(octree({"--model", model}).status, 2);
}

TEST_F(OctreeCommand, WritesNoLargerFileThanAllowed) {
  const Outcome allowed = octree_of_ball({"--depth", "5", "--json"});
  EXPECT_EQ(allowed.status, 0) << allowed.err;
  const auto bytes = nlohmann::json::parse(allowed.out)["output_bytes"].get<std::uint64_t>();
  EXPECT_EQ(std::filesystem::file_size(cubes()), bytes) << "known before it is written";
  EXPECT_EQ(octree_of_ball({"--depth", "5", "--max-output", std::to_string(bytes)}).status, 0);
  std::filesystem::remove(cubes());

  const Outcome refused = octree_of_ball({"--depth", "5", "--max-output", "0.1MB"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, StartsWith("verisq: --max-output: " + cubes() + " is not written: its "));
  EXPECT_THAT(refused.err,
              HasSubstr(" kB are more than 0.1MB; give a larger one, or a smaller --depth or larger --tol"));
  EXPECT_THAT(refused.out, HasSubstr("\nvolume             [")) << "which took the time, and is proven";
  EXPECT_THAT(refused.out, HasSubstr("\noctree             not written ("));
  EXPECT_THAT(folder_.names(), ::testing::UnorderedElementsAre("ball.json", "process.err", "process.out"));

  const auto json = nlohmann::json::parse(octree_of_ball({"--depth", "5", "--max-output", "1B", "--json"}).out);
  EXPECT_EQ(json["output"], "");
  EXPECT_EQ(json["output_bytes"], bytes);
}

TEST_F(OctreeCommand, RefusesSizesThatAreNone) {
  const std::string model = ball();
  for (const std::string size : {"x", "1 XB", "-1", "1e400GiB", "nan", "1e30", "GiB"}) {
    expect_refused({"--model", model, "-o", cubes(), "--max-output=" + size},
                   "--max-output: " + size + " is not a size like 500MB or 4GiB");
  }
  for (const std::string size : {"2000000", "2000000B", "2MB", "1.5 MiB", "1TiB", "2mb", "2MIB", "1 gib", "2000KB"})
    EXPECT_EQ(octree_of_ball({"--depth", "2", "--max-output", size}).status, 0) << size;
}

TEST_F(OctreeCommand, RefusesWholeNumbersOutOfRangeInOneLine) {
  const std::string model = ball();
  const std::string huge = "99999999999999999999999";
  const auto expect = [&](const std::string& option, const std::string& value, const std::string& what) {
    expect_refused({"--model", model, "-o", cubes(), option, value}, option + ": " + value + " is not " + what);
  };
  expect("--depth", huge, "in 0 to 20");
  expect("--depth", "3.5", "a whole number in 0 to 20");
  expect("--depth", "1e3", "a whole number in 0 to 20");
  expect("--depth", "0x10", "a whole number in 0 to 20");
  expect("--depth", "-" + huge, "in 0 to 20");
  expect("--budget", huge, "in 1 to 18446744073709551615");
  expect("--budget", "-5", "at least 1");
  expect("--budget", "many", "a whole number in 1 to 18446744073709551615");
  const Outcome decimal = octree_of_ball({"--depth", "008", "--json"});
  EXPECT_EQ(nlohmann::json::parse(decimal.out)["depth"], 8) << "not octal";
}

TEST_F(OctreeCommand, ExplainsItself) {
  const Outcome outcome = octree({"--help"});
  EXPECT_EQ(outcome.status, 0);
  for (const char* word : {"--depth", "--tol", "--budget", "--device", "--white", "--max-output", "1GiB",
                           "cubic model units", "Exit status"})
    EXPECT_THAT(outcome.out, HasSubstr(word));
}

TEST_F(OctreeCommand, IsProvedAgain) {
  ASSERT_EQ(octree_of_ball({"--depth", "4"}).status, 0);
  const Outcome all = run({"check", "--model", ball(), "--octree", cubes()});
  EXPECT_EQ(all.status, 0) << all.err;
  EXPECT_THAT(all.out, HasSubstr("unproved           0\nvolume proved        ["));
  const Outcome some = run({"check", "--model", ball(), "--octree", cubes(), "--sample", "10"});
  EXPECT_EQ(some.status, 0) << some.err;
  EXPECT_THAT(some.out, HasSubstr("chosen at random   10\n  proved             10\n"));
  EXPECT_THAT(some.out, HasSubstr("only all cubes together prove it"));
  const Outcome of_json = run({"check", "--model", ball(), "--octree", cubes(), "--json"});
  const auto object = nlohmann::json::parse(of_json.out);
  EXPECT_TRUE(object.at("volume_proved"));
  EXPECT_LT(object.at("volume").at("lo"), ball_volume);
  EXPECT_GT(object.at("volume").at("hi"), ball_volume);

  const std::string larger =
      folder_
          .file("larger.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [{"name": "ball",
          "superquadric": {"semi_axes": [1.1, 1, 1], "exponents": [1, 1]}}]})")
          .string();
  const Outcome other = run({"check", "--model", larger, "--octree", cubes()});
  EXPECT_EQ(other.status, 3);
  EXPECT_THAT(other.out, HasSubstr("volume not proved"));
  EXPECT_THAT(other.out, HasSubstr("first unproved       the cube about ("));
  const auto refused = [&](const Arguments& arguments, const std::string& message) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr(message));
  };
  refused({"check", "--model", ball(), "--octree", ball()}, "not an octree of `verisq octree`");
  refused({"check", "--model", ball(), "--octree", cubes(), "--map", "map.csv"}, "--octree: not with --map");
  refused({"check", "--model", ball(), "--map", "map.csv", "--sample", "3"}, "--sample: only with --octree");
  refused({"check", "--model", ball(), "--octree", cubes(), "--mesh", "bone.off"}, "--mesh: only with --map");
}

TEST_F(OctreeCommand, EndsByATimeLimit) {
  const Outcome outcome = octree_of_ball({"--device", "host", "--depth", "5", "--time-limit", "1e-9", "--json"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(outcome.err, "verisq: the time limit is reached; " + cubes() + " is not written\n");
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["interrupted"], true);
  EXPECT_LE(json["volume"]["lo"], ball_volume);
  EXPECT_GE(json["volume"]["hi"], ball_volume);
  EXPECT_FALSE(std::filesystem::exists(cubes()));
}

}  // namespace
}  // namespace verisq::testing
