/// `verisq distance` as its user meets it: results, messages and exit status.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/process.hpp"
#include "tests/temporary_folder.hpp"

namespace verisq::testing {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Arguments = std::vector<std::string>;

class DistanceCommand : public ::testing::Test {
 protected:
  [[nodiscard]] std::string ball(const std::string& name, const std::string& units, double x,
                                 double radius = 1.0) const {
    const nlohmann::json superquadric{{"semi_axes", {radius, radius, radius}}, {"exponents", {1, 1}}};
    const nlohmann::json primitive{
        {"name", "ball"}, {"superquadric", superquadric}, {"pose", {{"translation", {x, 0, 0}}}}};
    nlohmann::json model{{"format", "verisq-model/1"}, {"primitives", {primitive}}};
    if (!units.empty()) model["units"] = units;
    return folder_.file(name, model.dump()).string();
  }

  [[nodiscard]] Outcome distance(Arguments arguments) const {
    arguments.insert(arguments.begin(), {VERISQ_PROGRAM, "distance"});
    return Process(arguments, folder_.path()).wait();
  }

  TemporaryFolder folder_;
};

void expect_refused(const Outcome& outcome, const std::string& words) {
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, StartsWith("verisq: "));
  EXPECT_THAT(outcome.err, HasSubstr(words));
  EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
}

TEST_F(DistanceCommand, PrintsTheEnclosureInWords) {
  const Outcome outcome = distance({ball("a.json", "mm", 0.0), ball("b.json", "mm", 5.0)});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("distance           ["));
  EXPECT_THAT(outcome.out, HasSubstr("] mm\n"));
  EXPECT_THAT(outcome.out, HasSubstr("separated (proven: no common point)"));
  EXPECT_THAT(outcome.out, HasSubstr("closest point of A x ["));
  EXPECT_THAT(outcome.out, HasSubstr("uniqueness         proven: exactly one pair"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("certificate")));
}

TEST_F(DistanceCommand, PrintsJson) {
  const Outcome outcome = distance({ball("a.json", "mm", 0.0), ball("b.json", "", 5.0), "--json", "--certificate"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto object = nlohmann::json::parse(outcome.out);
  EXPECT_LE(object["lo"].get<double>(), 3.0);
  EXPECT_GE(object["hi"].get<double>(), 3.0);
  EXPECT_LE(object["hi"].get<double>() - object["lo"].get<double>(), 1e-14);
  EXPECT_EQ(object["proximity"], "separated");
  EXPECT_EQ(object["unique"], true);
  EXPECT_EQ(object["units"], "mm");
  EXPECT_TRUE(object["witness"].is_null());
  const auto side = object["closest_points"]["on_b"][0];
  EXPECT_LE(side[0].get<double>(), 4.0);
  EXPECT_GE(side[1].get<double>(), 4.0);
  ASSERT_EQ(object["certificate"].size(), 1U);
  EXPECT_EQ(object["certificate"][0]["vector"].size(), 3U);
}

TEST_F(DistanceCommand, MovesTheSecondModelByThePose) {
  const auto a = ball("a.json", "", 0.0);
  const auto b = ball("b.json", "", 5.0);
  // Half a turn about z takes x = 5 to x = -5, the translation from there to x = -10; the quaternion has length 2.
  const auto object = nlohmann::json::parse(distance({a, b, "--json", "--pose", "-5,0,0,0,0,0,2"}).out);
  EXPECT_LE(object["lo"].get<double>(), 8.0);
  EXPECT_GE(object["hi"].get<double>(), 8.0);
  EXPECT_LE(object["hi"].get<double>() - object["lo"].get<double>(), 1e-14);
}

TEST_F(DistanceCommand, ShowsTheCommonPointOfOverlappingModels) {
  const auto a = ball("a.json", "", 0.0);
  const auto b = ball("b.json", "", 1.5);
  const Outcome outcome = distance({a, b});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("distance           [0, 0]\n"));
  EXPECT_THAT(outcome.out, HasSubstr("overlapping (proven: a common point)\ncommon point       ("));
  EXPECT_THAT(outcome.out, Not(HasSubstr("closest")));
  const auto object = nlohmann::json::parse(distance({a, b, "--json"}).out);
  EXPECT_EQ(object["proximity"], "overlapping");
  EXPECT_EQ(object["witness"].size(), 3U);
  EXPECT_TRUE(object["closest_points"].is_null());
}

TEST_F(DistanceCommand, SaysThatTouchingIsUndecided) {
  const auto object = nlohmann::json::parse(distance({ball("a.json", "", 0.0), ball("b.json", "", 2.0), "--json"}).out);
  EXPECT_EQ(object["lo"], 0.0);
  EXPECT_LE(object["hi"].get<double>(), 1e-14);
  EXPECT_NE(object["proximity"], "separated");
}

TEST_F(DistanceCommand, ExitsWithThreeWhereTheEnclosureIsWiderThanTheTolerance) {
  const auto a = ball("a.json", "", 0.1);
  const auto b = ball("b.json", "", 5.0, 0.7);
  EXPECT_EQ(distance({a, b}).status, 0);
  EXPECT_EQ(distance({a, b, "--tol", "1e-12"}).status, 0);
  EXPECT_EQ(distance({a, b, "--tol", "1e-20"}).status, 3);
}

TEST_F(DistanceCommand, RefusesBadUsage) {
  const auto a = ball("a.json", "mm", 0.0);
  const auto b = ball("b.json", "mm", 5.0);
  expect_refused(distance({a}), "B");
  expect_refused(distance({a, (folder_.path() / "none.json").string()}), "none.json");
  expect_refused(distance({a, ball("m.json", "m", 5.0)}), "units m differ from mm");
  expect_refused(distance({a, b, "--tol", "-1"}), "--tol: -1");
  expect_refused(distance({a, b, "--tol", "nan"}), "--tol: nan");
  expect_refused(distance({a, b, "--pose", "1,2,3"}), "--pose: 3 numbers where 7");
  expect_refused(distance({a, b, "--pose", "1,2,3,1,0,0,0,"}), "--pose: '' is not");
  expect_refused(distance({a, b, "--pose", "1,2,inf,1,0,0,0"}), "--pose: 'inf' is not");
  expect_refused(distance({a, b, "--pose", "1,2,3,0,0,0,0"}), "zero quaternion");
}

}  // namespace
}  // namespace verisq::testing
