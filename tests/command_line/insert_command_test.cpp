/// `verisq insert` as its user meets it: maps, summaries, messages and exit status.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
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
  EXPECT_THAT(outcome.out, HasSubstr("removal.vtp\"\n"));
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

TEST_F(InsertCommand, ShowsTheWayOnAPage) {
  const Outcome outcome = insert_along(
      {"-o", path("removal.csv"), "--report", path("way.html"), "--png", path("way.png"), "--turn", "2", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["report"], path("way.html"));
  EXPECT_TRUE(std::filesystem::exists(path("way.png")));
  std::stringstream page;
  page << std::ifstream(path("way.html")).rdbuf();
  const std::string begin = R"(<script type="application/json" id="verisq-report">)";
  const auto at = page.str().find(begin) + begin.size();
  const auto data = nlohmann::json::parse(page.str().substr(at, page.str().find("</script>", at) - at));
  ASSERT_EQ(data["path"].size(), 3U);  // a degree apart
  EXPECT_EQ(data["path"][0]["translation"], nlohmann::json::array({0.0, 0.0, 10.0}));
  EXPECT_EQ(data["path"][2]["quaternion"], nlohmann::json::array({1.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(data["summary"][0]["label"], "deepest penetration, vertices");
  const std::string points = write("points.off", "OFF\n1 0 0\n0 0 0\n");
  expect_refused(run({"insert", "--implant", ball(), "--mesh", points, "--along", "0,0,1", "--length", "1", "-o",
                      path("removal.csv"), "--report", path("way.html")}),
                 {"--report", "points.off", "has no triangles to draw"});
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

/// A closed box that faces outward, up to the height z.
std::string box_up_to(double z) {
  const std::string top = std::to_string(z);
  return "OFF\n8 12 0\n-5 -5 -9\n5 -5 -9\n-5 5 -9\n5 5 -9\n-5 -5 " + top + "\n5 -5 " + top + "\n-5 5 " + top +
         "\n5 5 " + top +
         "\n3 0 2 1\n3 1 2 3\n3 4 5 6\n3 5 7 6\n3 0 1 4\n3 1 5 4\n3 2 6 3\n3 3 6 7\n3 0 4 2\n3 2 4 6\n3 1 3 5\n"
         "3 3 7 5\n";
}

class RemovedBone : public InsertCommand {
 protected:
  [[nodiscard]] Outcome insert_into(const std::string& mesh, Arguments arguments) const {
    arguments.insert(arguments.begin(), {"insert", "--implant", ball(), "--mesh", mesh, "--device", "host", "--along",
                                         "0,0,-2", "--length", "10", "--tol", "0.1", "-o", path("removal.csv")});
    return run(arguments);
  }
  /// Of the ball's way up to z = 3: a half ball below z = 1 and a cylinder of height 2.
  static constexpr double below_3 = 2.0 / 3.0 * 3.14159265358979 * 8.0 + 3.14159265358979 * 4.0 * 2.0;
};

TEST_F(RemovedBone, IsToldOfABone) {
  const std::string bone = write("box.off", box_up_to(3.0));
  const Outcome outcome = insert_into(bone, {"--bone", "--on", "triangles", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto object = nlohmann::json::parse(outcome.out);
  const double lo = object["removed_volume"]["lo"].get<double>();
  const double hi = object["removed_volume"]["hi"].get<double>();
  EXPECT_LE(lo, below_3);
  EXPECT_GE(hi, below_3);
  EXPECT_LE(hi - lo, 0.02 * lo);
  EXPECT_EQ(object["removed_volume_proof"]["within_tolerance"], true);
  // All corners lie far from the ball, which passes through the upper face.
  EXPECT_EQ(object["proven_cut"], 0);
  const auto surface = object["whole_surface"];
  EXPECT_LE(surface["deepest_penetration"]["lo"].get<double>(), 2.0);
  EXPECT_GE(surface["deepest_penetration"]["hi"].get<double>(), 2.0);
  EXPECT_EQ(surface["proven_cut"], 2);
  EXPECT_EQ(surface["proven_untouched"], 10);
}

TEST_F(RemovedBone, IsToldOfACavityUpToAResectionOrAnOuterSurface) {
  const std::string cavity = write("cavity.off", box_up_to(0.0));
  const double beyond = below_3 - 3.14159265358979 * (2.0 - 1.0 / 3.0);  // the cap below z = 0, of height 1
  for (const Arguments& end :
       {Arguments{"--resection", "0,0,3,0,0,7"}, Arguments{"--within", write("outer.off", box_up_to(3.0))}}) {
    Arguments arguments{"--cavity", "--volume-tol", "0.01"};
    arguments.insert(arguments.end(), end.begin(), end.end());
    const Outcome outcome = insert_into(cavity, arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const auto at = outcome.out.find("removed bone         [");
    ASSERT_NE(at, std::string::npos) << outcome.out;
    double lo = 0.0;
    double hi = 0.0;
    ASSERT_EQ(std::sscanf(outcome.out.c_str() + at, "removed bone         [%lf, %lf] mm^3", &lo, &hi), 2);
    EXPECT_LE(lo, beyond);
    EXPECT_GE(hi, beyond);
    EXPECT_LE(hi - lo, 0.01 * lo);
    EXPECT_THAT(outcome.out, HasSubstr("closed over        0 rims\n"));
  }
}

TEST_F(RemovedBone, IsToldToBeElsewhere) {
  const Outcome outcome = insert_into(write("below.off", box_up_to(-3.0)), {"--bone"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("removed bone         0 mm^3\n  no bone lies in the implant's way"));
}

/// Beside the box the ball takes nothing away of it.
TEST_F(RemovedBone, IsLessOnTheBestOfManyWays) {
  const std::string wall = write("box.off", box_up_to(3.0));
  const Arguments here{"--bone", "--resection", "-1.5,0,0,1,0,0", "--volume-tol", "0.1", "--json"};
  Arguments searched = here;
  searched.insert(searched.end(), {"--search-cone", "30"});
  const Outcome straight = insert_into(wall, here);
  const Outcome best = insert_into(wall, searched);
  EXPECT_EQ(best.status, 0) << best.err;
  const auto given = nlohmann::json::parse(straight.out);
  const auto object = nlohmann::json::parse(best.out);
  EXPECT_EQ(given["way_search"], nullptr);
  EXPECT_EQ(given["way"]["turn_degrees"], 0.0);
  EXPECT_LT(object["removed_volume"]["hi"].get<double>(), given["removed_volume"]["lo"].get<double>());
  EXPECT_LE(object["way_search"]["removed_volume_of_given"]["lo"].get<double>(),
            given["removed_volume"]["hi"].get<double>());
  EXPECT_GT(object["way_search"]["proven_worse"].get<int>(), 0);
  EXPECT_GT(object["way_search"]["degrees_off_given"].get<double>(), 5.0);
  // Away from the bone, which lies towards -x.
  const auto direction = object["way"]["direction"].get<std::vector<double>>();
  EXPECT_LT(direction[0], 0.0);
  // The same way again, told by its numbers.
  const Outcome again = run(
      {"insert",       "--implant",   ball(),
       "--mesh",       wall,          "--device",
       "host",         "--along",     fmt::format("{:.17g},{:.17g},{:.17g}", direction[0], direction[1], direction[2]),
       "--length",     "10",          "--tol",
       "0.1",          "-o",          path("again.csv"),
       "--bone",       "--resection", "-1.5,0,0,1,0,0",
       "--volume-tol", "0.1",         "--json"});
  EXPECT_EQ(nlohmann::json::parse(again.out)["removed_volume"], object["removed_volume"]);
}

TEST_F(RemovedBone, RefusesWhatHasNoMeaning) {
  const std::string bone = write("bone.off", box_up_to(3.0));
  expect_refused(insert_into(bone, {"--search-cone", "9"}), {"--search-cone", "nothing says where bone is"});
  expect_refused(insert_into(bone, {"--bone", "--search-cone", "81"}), {"--search-cone: 81 is above 80"});
  expect_refused(insert_into(bone, {"--bone", "--turn", "361"}), {"--turn: 361 is not a number between"});
  expect_refused(insert({"--poses", "p.csv", "--turn", "3", "-o", path("removal.csv")}),
                 {"--turn", "only for --along"});
  const std::string box = write("box.off", box_up_to(3.0));
  expect_refused(insert_into(box, {"--bone", "--cavity"}), {"give only one of --cavity and --bone"});
  expect_refused(insert_into(box, {"--cavity"}), {"nothing says where the bone around it ends"});
  expect_refused(insert_into(box, {"--bone", "--within", box}), {"--within: only with --cavity"});
  const std::string beside = write("beside.off",
                                   "OFF\n4 4 0\n90 0 0\n99 0 0\n90 9 0\n90 0 9\n3 0 2 1\n3 0 1 3\n3 0 3 2\n"
                                   "3 1 2 3\n");
  expect_refused(insert_into(box, {"--cavity", "--within", beside}),
                 {"--within", "beside.off", "nothing of the cavity's surface is inside"});
  expect_refused(insert_into(box, {"--volume-tol", "0.1"}), {"--volume-tol: nothing says where bone is"});
  expect_refused(insert_into(box, {"--bone", "--resection", "0,0,1,0,0,0"}), {"--resection: 0,0,1,0,0,0 has a zero"});
  expect_refused(insert_into(box, {"--bone", "--resection", "0,0,-20,0,0,1"}), {"all of", "lies beyond it"});
  const std::string points = write("points.off", "OFF\n1 0 0\n0 0 0\n");
  expect_refused(insert_into(points, {"--bone"}), {"--bone", "points.off", "has no triangles"});
  expect_refused(insert_into(points, {"--on", "triangles"}), {"--on triangles", "points.off", "has none"});
  const std::string inward = write("inward.off",
                                   "OFF\n4 4 0\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 1 2\n3 0 3 1\n3 0 2 3\n"
                                   "3 1 3 2\n");
  expect_refused(insert_into(inward, {"--bone"}), {"--bone", "inward.off", "its normals point inward"});
}

TEST_F(InsertCommand, TakesAMesh) {
  const std::string block = write("block.off",
                                  "OFF\n4 4 0\n-4 -4 0\n4 -4 0\n0 4 0\n0 0 3\n3 0 2 1\n3 0 1 3\n3 1 2 3\n"
                                  "3 2 0 3\n");
  const Arguments along{"insert",   "--implant", block, "--mesh",           bone(), "--along", "0,0,-1",
                        "--length", "10",        "-o",  path("removal.csv")};
  const auto with = [&](const Arguments& more) {
    Arguments arguments = along;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  };
  const Outcome outcome = with({"--on", "triangles"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("  proven cut         1\n"));
  const std::vector<Row> rows = rows_of(path("removal.csv"));
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_NEAR(rows[3].distance.lo, 1.5, 0.01);  // the base stays so far above
  expect_refused(with({"--certificate-file", path("proof.json")}), {"--certificate-file: ", "ways in of meshes"});
  expect_refused(with({"--bone"}), {"--bone: ", "has a mesh, whose removed bone is not enclosed"});
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

TEST_F(InsertCommand, EndsByATimeLimitWithValidRows) {
  const Outcome outcome = insert_along({"-o", path("removal.csv"), "--time-limit", "1e-9"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err, StartsWith("verisq: the time limit is reached; rows as tight as they were by then"));
  for (const Row& row : rows_of(path("removal.csv.partial"))) {
    EXPECT_LE(row.distance.lo, exact[row.index]);
    EXPECT_GE(row.distance.hi, exact[row.index]);
  }
}

}  // namespace
}  // namespace verisq::testing
