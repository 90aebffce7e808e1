/// `verisq insert` as its user meets it: maps, summaries, messages and exit status.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class InsertCommand : public ProgramTest {
 protected:
  /// A ball of radius 2 at (0, 0, 1).
  [[nodiscard]] std::string ball() const {
    return write("ball.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
      {"name": "ball", "superquadric": {"semi_axes": [2, 2, 2], "exponents": [1, 1]},
       "pose": {"translation": [0, 0, 1]}}]})");
  }
  /// Points beside, behind, in and beyond the way of the ball from z = 11 down to 1.
  [[nodiscard]] std::string bone() const {
    return write("bone.off", "OFF\n4 2 0\n5 0 6\n0 0 14\n1 0 4\n0 0 -1.5\n3 0 1 2\n3 1 2 3\n");
  }
  static constexpr std::array exact{3.0, 1.0, -1.0, 0.5};

  [[nodiscard]] Outcome insert(Arguments arguments) const {
    arguments.insert(arguments.begin(), {"insert", "--implant", ball(), "--mesh", bone(), "--device", "host"});
    return run(arguments);
  }
  [[nodiscard]] Outcome insert_along(Arguments arguments) const {
    arguments.insert(arguments.begin(), {"--along", "0,0,-2", "--length", "10"});
    return insert(arguments);
  }
};

TEST_F(InsertCommand, WritesTheSmallestDistanceOfEachVertex) {
  const Outcome outcome = insert_along({"-o", path("removal.csv")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const std::vector<Row> rows = rows_of(path("removal.csv"));
  ASSERT_EQ(rows.size(), 4U);
  for (std::size_t n = 0; n < 4; ++n) {
    EXPECT_EQ(rows[n].index, n);
    EXPECT_LE(rows[n].distance.lo, exact[n] + 1e-12);
    EXPECT_GE(rows[n].distance.hi, exact[n] - 1e-12);
    EXPECT_LE(rows[n].distance.width(), 4e-3);  // the default: 1e-3 of the radius of the ball's box
    EXPECT_EQ(rows[n].status, "host-verified");
  }
}

TEST_F(InsertCommand, SaysWhatIsCut) {
  const Outcome outcome = insert_along({"-o", path("removal.vtp"), "--tol", "0.01"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("points               4\n"
                                      "  proven cut         1\n"
                                      "  proven untouched   3\n"
                                      "  undecided          0\n"
                                      "deepest penetration  ["));
  EXPECT_THAT(outcome.out, HasSubstr("poses of the path    2, and all between them\n"));
  EXPECT_THAT(outcome.out, HasSubstr("removal.vtp\n"));
  std::stringstream vtp;
  vtp << std::ifstream(path("removal.vtp")).rdbuf();
  EXPECT_THAT(vtp.str(), HasSubstr("dist_lo"));
}

TEST_F(InsertCommand, PrintsJson) {
  const Outcome outcome = insert_along({"-o", path("removal.ply"), "--tol", "1e-3", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto object = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(object["points"], 4);
  EXPECT_EQ(object["proven_cut"], 1);
  EXPECT_EQ(object["proven_untouched"], 3);
  EXPECT_EQ(object["undecided"], 0);
  EXPECT_LE(object["deepest_penetration"]["lo"].get<double>(), 1.0 + 1e-12);
  EXPECT_GE(object["deepest_penetration"]["hi"].get<double>(), 1.0 - 1e-12);
  EXPECT_LE(object["largest_width"].get<double>(), 1e-3);
  EXPECT_EQ(object["units"], "mm");
  EXPECT_EQ(object["poses"], 2);
  EXPECT_EQ(object["interrupted"], false);
  EXPECT_TRUE(std::filesystem::exists(path("removal.ply")));
}

TEST_F(InsertCommand, FollowsTheFileOfPoses) {
  // The same way, with a rest in between; quaternions of any length.
  const std::string poses = write("path.csv", "tx,ty,tz,qw,qx,qy,qz\n0,0,10,1,0,0,0\n0,0,3,2,0,0,0\n0,0,0,-5,0,0,0\n");
  const Outcome outcome = insert({"--poses", poses, "-o", path("removal.json"), "--tol", "0.01", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["poses"], 3);
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["proven_cut"], 1);
  EXPECT_TRUE(std::filesystem::exists(path("removal.json")));
}

TEST_F(InsertCommand, ExitsWithThreeWhereAnEnclosureIsWider) {
  const Outcome outcome = insert_along({"-o", path("removal.csv"), "--tol", "1e-18"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  for (const Row& row : rows_of(path("removal.csv"))) {
    EXPECT_LE(row.distance.lo, exact[row.index] + 1e-12);
    EXPECT_GE(row.distance.hi, exact[row.index] - 1e-12);
  }
}

TEST_F(InsertCommand, RefusesUsageThatIsNone) {
  const std::string out = path("removal.csv");
  expect_refused(insert({"-o", out}), {"give either --poses or --along"});
  expect_refused(insert_along({"--poses", "p.csv", "-o", out}), {"give either --poses or --along"});
  expect_refused(insert({"--along", "0,0,1", "-o", out}), {"--along: give the --length of the way"});
  expect_refused(insert({"--poses", "p.csv", "--length", "3", "-o", out}), {"--length: only for --along"});
  expect_refused(insert({"--along", "0,0", "--length", "3", "-o", out}), {"--along: 2 numbers where 3 are needed"});
  expect_refused(insert({"--along", "0,0,x", "--length", "3", "-o", out}), {"--along: 'x' is not a finite number"});
  expect_refused(insert({"--along", "0,0,0", "--length", "3", "-o", out}), {"--along: 0,0,0 is no direction"});
  expect_refused(insert({"--along", "0,0,1", "--length", "0", "-o", out}), {"--length: 0 is not above 0"});
  expect_refused(insert_along({"--tol", "0", "-o", out}), {"--tol: 0 is not above 0"});
  expect_refused(insert_along({"--tol", "-1", "-o", out}), {"--tol: -1 is not a finite number of at least 0"});
  expect_refused(insert_along({"-o", path("bone.off")}), {"would overwrite an input"});
  expect_refused(insert_along({"-o", path("removal.txt")}), {"removal.txt"});
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(InsertCommand, NamesFileAndLineOfABadPose) {
  const std::string poses = write("path.csv", "0,0,10,1,0,0,0\n0,0,3,0,0,0,0\n");
  expect_refused(insert({"--poses", poses, "-o", path("removal.csv")}), {"path.csv", "2"});
}

TEST_F(InsertCommand, KeepsValidRowsWhenInterrupted) {
  // So many points, and so fine a tolerance, take much longer than the test waits.
  constexpr int points = 50'000;
  std::string off = "OFF\n" + std::to_string(points) + " 0 0\n";
  for (int n = 0; n < points; ++n) off += std::to_string(n * 1e-3) + " 0 " + std::to_string(n % 10) + "\n";
  const Outcome outcome =
      run_interrupted({"insert", "--implant", ball(), "--mesh", write("cloud.off", off), "--device", "host", "--along",
                       "0,0,-2", "--length", "10", "--tol", "1e-9", "-o", path("removal.csv")});
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("removal.csv.partial"));
  EXPECT_FALSE(std::filesystem::exists(path("removal.csv")));
  const std::vector<Row> rows = rows_of(path("removal.csv.partial"));
  ASSERT_EQ(rows.size(), static_cast<std::size_t>(points));
  for (const Row& row : rows) {
    const auto z = static_cast<double>(row.index % 10);
    const double nearest = std::hypot(static_cast<double>(row.index) * 1e-3, std::min(z - 1.0, 0.0)) - 2.0;
    EXPECT_LE(row.distance.lo, nearest + 1e-9);
    EXPECT_GE(row.distance.hi, nearest - 1e-9);
  }
  EXPECT_EQ(rows.back().status, "wide");
}

TEST_F(InsertCommand, ExplainsItself) {
  const Outcome outcome = run({"insert", "--help"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, HasSubstr("--implant"));
  EXPECT_THAT(outcome.out, HasSubstr("Exit status"));
}

}  // namespace
}  // namespace verisq::testing
