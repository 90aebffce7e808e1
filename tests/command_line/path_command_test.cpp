/// `verisq path` as its user meets it: results, messages and exit status.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;

class PathCommand : public ProgramTest {
 protected:
  [[nodiscard]] std::string moving_ball(const std::string& name, double radius, const std::string& units) const {
    const nlohmann::json superquadric{{"semi_axes", {radius, radius, radius}}, {"exponents", {1, 1}}};
    const nlohmann::json primitive{{"name", "ball"}, {"superquadric", superquadric}};
    const nlohmann::json model{{"format", "verisq-model/1"}, {"units", units}, {"primitives", {primitive}}};
    return folder_.file(name, model.dump()).string();
  }

  /// A ball of radius 1/2 passes another of radius 1 at the height y, from x = -5 to 5.
  [[nodiscard]] Outcome passing(const std::string& y, Arguments more = {}) const {
    Arguments arguments{"path", moving_ball("a.json", 1.0, "mm"), moving_ball("b.json", 0.5, "mm"), "--poses",
                        folder_.file("path.csv", "-5," + y + ",0,1,0,0,0\n5," + y + ",0,1,0,0,0\n").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
};

TEST_F(PathCommand, ProvesAFreeWay) {
  const Outcome outcome = passing("2");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("apart (proven: no common point at any time"));
  EXPECT_THAT(outcome.out, HasSubstr("the way            proven free\n"));
}

TEST_F(PathCommand, ProvesAMeetingBetweenPosesThatAreApart) {
  const Outcome outcome = passing("1.2", {"--json"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["proximity"], "meeting");
  EXPECT_EQ(json["free"], false);
  EXPECT_LE(json["apart_before"].get<double>(), 0.41);
  EXPECT_GE(json["meet_at"].get<double>(), 0.41);
  EXPECT_LE(json["meet_at"].get<double>() - json["apart_before"].get<double>(), 1e-6);
}

TEST_F(PathCommand, IsNotFreeWhereTheClearanceIsNotKept) {
  EXPECT_EQ(passing("2", {"--clearance", "0.49"}).status, 0);
  const Outcome outcome = passing("2", {"--clearance", "0.51"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("clearance          0.51000000000000001 mm: proven NOT to be kept\n"));
  EXPECT_THAT(outcome.out, HasSubstr("the way            NOT proven free\n"));
}

TEST_F(PathCommand, FollowsBendsAndSetOperations) {
  const std::string stem = places::example("bent_stem.json");
  const std::string ball = moving_ball("ball.json", 0.1, "bone lengths");
  const std::string past = folder_.file("past.csv", "-0.5,0.3,-0.1,1,0,0,0\n0.5,0.3,-0.1,1,0,0,0\n").string();
  const Outcome free = run({"path", stem, ball, "--poses", past, "--clearance", "0.05"});
  EXPECT_EQ(free.status, 0) << free.out << free.err;
  EXPECT_THAT(free.out, HasSubstr("the way            proven free\n"));
  const std::string through = folder_.file("through.csv", "-0.5,0,-0.1,1,0,0,0\n0.5,0,-0.1,1,0,0,0\n").string();
  const Outcome meeting = run({"path", stem, ball, "--poses", through, "--json"});
  EXPECT_EQ(meeting.status, 3) << meeting.err;
  EXPECT_EQ(nlohmann::json::parse(meeting.out)["proximity"], "meeting");
}

TEST_F(PathCommand, RefusesBadInput) {
  const std::string a = moving_ball("a.json", 1.0, "mm");
  const std::string poses = folder_.file("path.csv", "0,0,0,1,0,0,0\n").string();
  testing::expect_refused(run({"path", a, moving_ball("inches.json", 1.0, "in"), "--poses", poses}),
                          {"inches.json", "units \"in\" differ from \"mm\""});
  testing::expect_refused(run({"path", a, a, "--poses", folder_.file("empty.csv", "").string()}), {"empty.csv"});
  testing::expect_refused(run({"path", a, a, "--poses", poses, "--clearance", "-1"}), {"--clearance"});
}

TEST_F(PathCommand, EndsByATimeLimit) {
  const std::string proof = path("proof.json");
  const Outcome outcome = passing("2", {"--time-limit", "1e-9", "--certificate-file", proof});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(outcome.err, "verisq: the time limit is reached; " + proof + " is not written\n");
  EXPECT_THAT(outcome.out, HasSubstr("undecided (the time limit is reached: neither a gap"));
  EXPECT_FALSE(std::filesystem::exists(proof));
  EXPECT_EQ(passing("2", {"--time-limit", "600"}).status, 0);
}

}  // namespace
}  // namespace verisq::testing
