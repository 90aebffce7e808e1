/// `verisq-check` answers as `verisq check` does, and loads no device, no optimiser and no graphics.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class CheckProgram : public ProgramTest {
 protected:
  [[nodiscard]] Outcome check_alone(Arguments arguments) const {
    arguments.insert(arguments.begin(), places::check_program());
    return Process(arguments, folder_.path()).wait();
  }

  [[nodiscard]] std::string map(const std::string& name, Arguments of) const {
    of.insert(of.begin(), {"map", "--device", "host", "--model", model_, "--certificates", "-o", path(name)});
    const Outcome outcome = run(of);
    EXPECT_THAT(outcome.status, AnyOf(0, 3)) << outcome.err;
    return path(name);
  }

  /// Both programs, but for their names and the time they took.
  void expect_the_same(const Arguments& arguments, int status) const {
    Arguments with_command = arguments;
    with_command.insert(with_command.begin(), "check");
    const Outcome of_verisq = run(with_command);
    const Outcome alone = check_alone(arguments);
    EXPECT_EQ(alone.status, status) << alone.out << alone.err;
    EXPECT_EQ(of_verisq.status, status);
    EXPECT_EQ(without_times(alone.out), without_times(of_verisq.out));
    EXPECT_EQ(std::regex_replace(alone.err, std::regex("verisq-check"), "verisq"), of_verisq.err);
  }

  std::string model_ = places::example("uncertain_stem.json");
  std::string points_ = write("points.csv", "0.3,0,0.1\n-0.0765,0.0407,-0.1455\n0.5,0.5,0.5\n");
  std::string mesh_ =
      write("mesh.off", "OFF\n4 4 0\n0.3 0 0\n0.4 0 0\n0.3 0.1 0\n0.3 0 0.1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");

 private:
  static std::string without_times(const std::string& summary) {
    const std::regex readable("time .*");
    const std::regex json("\"(seconds|\\w+_per_second)\":[^,]*");
    return std::regex_replace(std::regex_replace(summary, readable, ""), json, "");
  }
};

TEST_F(CheckProgram, AnswersAsTheCommandDoes) {
  const std::string of_points = map("points_map.csv", {"--points", points_});
  const std::string of_triangles = map("triangles_map.vtp", {"--mesh", mesh_, "--on", "triangles"});
  for (const Arguments& more : {Arguments{}, Arguments{"--json"}}) {
    Arguments points{"--model", model_, "--points", points_, "--map", of_points};
    points.insert(points.end(), more.begin(), more.end());
    expect_the_same(points, 0);
    Arguments triangles{"--model", model_, "--mesh", mesh_, "--map", of_triangles};
    triangles.insert(triangles.end(), more.begin(), more.end());
    expect_the_same(triangles, 0);
    Arguments moved{"--model",  model_,
                    "--points", write("moved.csv", "0.31,0,0.1\n-0.0765,0.0407,-0.1455\n0.5,0.5,0.5\n"),
                    "--map",    of_points};
    moved.insert(moved.end(), more.begin(), more.end());
    expect_the_same(moved, 3);
  }
}

/// A row whose proof would take seconds: the limit ends it, and it counts as not looked at.
TEST_F(CheckProgram, EndsByATimeLimit) {
  const std::string model = write("s.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
      {"name": "s", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1.0000001]}}]})");
  const std::string map = write("m.csv",
                                "index,lo,hi,status,primitive,normal_x,normal_y,normal_z,further_normals,escape_x,"
                                "escape_y,escape_z\n0,-inf,-.99999,wide,0,1,0,0,,,,\n");
  const Outcome outcome = check_alone(
      {"--model", model, "--points", write("p.csv", "0,0,0\n"), "--map", map, "--time-limit", "0.05", "--json"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["interrupted"], true);
  EXPECT_EQ(json["points"], 0);
  EXPECT_EQ(json["unproved"], 0);
}

TEST_F(CheckProgram, ProvesMapsOfMovedModels) {
  const std::string pose = "0.1,-0.2,0.3,1,2,3,4";
  expect_the_same({"--model", model_, "--pose", pose, "--points", points_, "--map", path("map.csv")}, 2);  // bounds
  model_ = places::example("stem.json");
  const std::string of_points = map("points_map.csv", {"--points", points_, "--pose", pose});
  expect_the_same({"--model", model_, "--pose", pose, "--points", points_, "--map", of_points}, 0);
  expect_the_same({"--model", model_, "--points", points_, "--map", of_points}, 3);
  expect_the_same({"--model", model_, "--pose", "1,2,3", "--points", points_, "--map", of_points}, 2);
}

TEST_F(CheckProgram, RefusesAsTheCommandDoes) {
  const std::string of_points = map("points_map.csv", {"--points", points_});
  expect_the_same({"--model", model_, "--points", points_, "--map", path("none.csv")}, 2);
  expect_the_same({"--model", model_, "--map", of_points}, 2);
  expect_the_same({"--model", model_, "--points", write("two.csv", "0.3,0,0.1\n0.5,0.5,0.5\n"), "--map", of_points}, 2);
  // Of another model: nothing is proved.
  expect_the_same({"--model", (places::example("bent_stem.json")), "--points", points_, "--map", of_points}, 3);
}

TEST_F(CheckProgram, ExplainsItself) {
  const Outcome help = check_alone({"--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.out, HasSubstr("verisq-check --model stem.json"));
  EXPECT_THAT(run({"check", "--help"}).out, HasSubstr("verisq check --model stem.json"));
  EXPECT_THAT(check_alone({"--version"}).out, StartsWith("verisq-check "));
  const Outcome wrong = check_alone({"--map"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, StartsWith("verisq-check: "));
  EXPECT_THAT(wrong.err, HasSubstr("(see verisq-check --help)"));
}

TEST_F(CheckProgram, LoadsWhatProvesAndWhatReadsAlone) {
  const std::string of_points = map("points_map.csv", {"--points", points_});
  setenv("LD_DEBUG", "files", 1);  // the dynamic linker names every file it opens
  const Outcome alone = check_alone({"--model", model_, "--points", points_, "--map", of_points});
  const Outcome of_verisq = run({"--version"});
  unsetenv("LD_DEBUG");
  EXPECT_EQ(alone.status, 0);
  EXPECT_THAT(alone.err, HasSubstr("libmpfr"));
  for (const char* const library : {"libOpenCL", "libpocl", "libnlopt", "libcairo"}) {
    EXPECT_THAT(alone.err, Not(HasSubstr(library)));
  }
  EXPECT_THAT(of_verisq.err, HasSubstr("libnlopt"));  // the test sees what is loaded
}

}  // namespace
}  // namespace verisq::testing
