/// `verisq distance` as its user meets it: results, messages and exit status.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>
#include <verisq/enclosure.hpp>

#include "host/errors/refusal.hpp"
#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class DistanceCommand : public ProgramTest {
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
    arguments.insert(arguments.begin(), "distance");
    return run(arguments);
  }
};

void expect_refused(const Outcome& outcome, const std::string& words) {
  testing::expect_refused(outcome, {words});
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

// Solids are closed: a distance of 0 is a common point, and what is said agrees with the numbers.
TEST_F(DistanceCommand, TouchingSolidsHaveACommonPoint) {
  const std::string a = ball("a.json", "mm", 0.0);
  const Outcome touching = distance({a, a, "--pose", "2,0,0,1,0,0,0"});
  EXPECT_EQ(touching.status, 0) << touching.err;
  EXPECT_THAT(touching.out, StartsWith("distance           [0, 0] mm\n"));
  EXPECT_THAT(touching.out, HasSubstr("overlapping (proven: a common point)\ncommon point       (1, 0, 0)\n"));
  const Outcome turned = distance({a, a, "--pose", "2,0,0,1,2,3,4"});
  EXPECT_THAT(turned.out, HasSubstr("undecided (neither a gap nor a common point is proven, at most "));
  EXPECT_THAT(touching.out, HasSubstr("penetration depth  [0, 0] mm (proven: they touch, and do not overlap)\n"));
  EXPECT_THAT(turned.out, HasSubstr("(proven: they do not overlap"));
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

TEST_F(DistanceCommand, SaysHowDeepOverlappingModelsReachIntoEachOther) {
  const auto a = ball("a.json", "mm", 0.0);
  const auto b = ball("b.json", "mm", 1.5);
  const std::string file = path("proof.json");
  const Outcome outcome = distance({a, b, "--certificate-file", file});
  EXPECT_THAT(outcome.out, HasSubstr("(proven: they overlap; moving B by 0.5 mm, the right way, ends that)\n"));
  const auto depth = nlohmann::json::parse(distance({a, b, "--json"}).out)["penetration_depth"];
  EXPECT_GE(depth["lo"].get<double>(), 0.49999);
  EXPECT_EQ(depth["hi"], 0.5);
  EXPECT_TRUE(
      nlohmann::json::parse(distance({a, a, "--pose", "9,0,0,1,0,0,0", "--json"}).out)["penetration_depth"].is_null());
  const auto check = [&](const std::string& of) {
    return run({"check", "--certificate", of, "--model", a, "--model", b});
  };
  const Outcome proved = check(file);
  EXPECT_EQ(proved.status, 0) << proved.err;
  EXPECT_THAT(proved.out, HasSubstr("penetration depth  proved\n"));
  auto forged = nlohmann::json::parse(contents(file));
  forged["penetration"]["depth"]["lo"] = 0.6;
  forged["penetration"]["depth"]["hi"] = 0.7;
  const Outcome refuted = check(write("forged.json", forged.dump()));
  EXPECT_EQ(refuted.status, 3);
  EXPECT_THAT(refuted.out, HasSubstr("penetration depth  refuted\n"));
  forged["penetration"]["proof"]["surface"]["on_a"].erase(0);
  EXPECT_THAT(check(write("short.json", forged.dump())).err, HasSubstr("on_a"));
}

TEST_F(DistanceCommand, SaysThatTouchingIsUndecided) {
  const auto object = nlohmann::json::parse(distance({ball("a.json", "", 0.0), ball("b.json", "", 2.0), "--json"}).out);
  EXPECT_EQ(object["lo"], 0.0);
  EXPECT_LE(object["hi"].get<double>(), 1e-14);
  EXPECT_NE(object["proximity"], "separated");
}

TEST_F(DistanceCommand, ToleranceZeroAsksForTheTightest) {
  const auto a = ball("a.json", "", 0.1);
  const auto b = ball("b.json", "", 5.0, 0.7);
  const Outcome outcome = distance({a, b, "--tol", "0"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("tolerance 0: the tightest\n"));
  EXPECT_EQ(nlohmann::json::parse(distance({a, b, "--tol", "0", "--json"}).out)["status"], "tightest");
  EXPECT_EQ(nlohmann::json::parse(distance({a, b, "--tol", "1e-12", "--json"}).out)["status"], "verified");
  EXPECT_EQ(nlohmann::json::parse(distance({a, b, "--tol", "1e-20", "--json"}).out)["status"], "wide");
  const auto poses = write("poses.csv", "0,0,0,1,0,0,0\n1,2,3,1,0,0.5,0\n");
  EXPECT_EQ(distance({a, b, "--poses", poses, "--tol", "0", "-o", write("out.csv", "")}).status, 0);
}

TEST_F(DistanceCommand, PrintsNearPointsInBothForms) {
  const auto a = ball("a.json", "mm", 0.0);
  const auto b = write("bent.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
    {"name": "ball", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]},
     "bend": {"curvature": 1e-300, "angle_deg": 30}, "pose": {"translation": [0, 5, 0]}}]})");
  EXPECT_THAT(distance({a, b}).out, HasSubstr("near point of A    ("));
  const auto object = nlohmann::json::parse(distance({a, b, "--json"}).out);
  ASSERT_FALSE(object["near_points"].is_null());
  const auto on_a = object["near_points"]["on_a"].get<std::vector<double>>();
  const auto on_b = object["near_points"]["on_b"].get<std::vector<double>>();
  ASSERT_EQ(on_a.size(), 3U);
  EXPECT_LE(std::hypot(on_a[0] - on_b[0], on_a[1] - on_b[1], on_a[2] - on_b[2]), object["hi"].get<double>());
  EXPECT_EQ(object["searched"], true);
  const auto convex = nlohmann::json::parse(distance({a, ball("c.json", "mm", 5.0), "--json"}).out);
  EXPECT_TRUE(convex["near_points"].is_null());
  EXPECT_EQ(convex["searched"], false);
}

/// Two rows of balls, all of them about as far apart as the nearest.
TEST_F(DistanceCommand, EndsConvexPairsAtTheTimeLimit) {
  const auto row = [&](const std::string& name, double y) {
    std::string text = R"({"format": "verisq-model/1", "primitives": [)";
    for (int i = 0; i < 300; ++i) {
      text += fmt::format(R"({}{{"name": "{}", "superquadric": {{"semi_axes": [1, 0.9, 100], "exponents": [0.5, 1.1]}},
        "pose": {{"translation": [{}, {}, 0]}}}})",
                          i == 0 ? "" : ",", i, 2.5 * i, y);
    }
    return write(name, text + "]}");
  };
  const auto a = row("a.json", 0.0);
  const auto b = row("b.json", 5.0);
  const Outcome limited = distance({a, b, "--time-limit", "1e-9", "--json"});
  EXPECT_THAT(limited.err, HasSubstr("verisq: the time limit is reached; the enclosure is valid, and wide\n"));
  EXPECT_EQ(limited.status, 3);
  const auto wide = nlohmann::json::parse(limited.out);
  EXPECT_LE(wide["lo"].get<double>(), 3.2);
  EXPECT_GE(wide["hi"].get<double>(), 3.2 - 1e-12);
  EXPECT_EQ(wide["status"], "wide");
  EXPECT_TRUE(wide["closest_points"].is_null());
}

TEST_F(DistanceCommand, ExitsWithThreeWhereTheEnclosureIsWiderThanTheTolerance) {
  const auto a = ball("a.json", "", 0.1);
  const auto b = ball("b.json", "", 5.0, 0.7);
  EXPECT_EQ(distance({a, b}).status, 0);
  EXPECT_EQ(distance({a, b, "--tol", "1e-12"}).status, 0);
  EXPECT_EQ(distance({a, b, "--tol", "1e-20"}).status, 3);
}

/// A ball, bent by nothing that counts, 3 from a unit ball at the origin.
const std::string bent_ball = R"({"format": "verisq-model/1", "units": "mm", "primitives": [
  {"name": "ball", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]},
   "bend": {"curvature": 1e-300, "angle_deg": 30}, "pose": {"translation": [0, 5, 0]}}]})";

const std::string bored_ball = R"({"format": "verisq-model/1", "primitives": [
  {"name": "ball", "superquadric": {"semi_axes": [2, 2, 2], "exponents": [1, 1]}},
  {"name": "bore", "superquadric": {"semi_axes": [1, 1, 10], "exponents": [0.1, 1]}}],
  "csg": {"difference": ["ball", "bore"]}})";

TEST_F(DistanceCommand, SearchesBentModels) {
  const auto a = ball("a.json", "mm", 0.0);
  const auto b = write("b.json", bent_ball);
  const Outcome outcome = distance({a, b});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, HasSubstr("separated (proven: no common point)\nnear point of A    ("));
  EXPECT_THAT(outcome.out, HasSubstr("not enclosed, because a model is bent, a mesh, or built by set operations\n"));
  const auto object = nlohmann::json::parse(distance({a, b, "--json", "--tol", "1e-8"}).out);
  EXPECT_LE(object["lo"].get<double>(), 3.0);
  EXPECT_GE(object["hi"].get<double>(), 3.0);
  EXPECT_LE(object["hi"].get<double>() - object["lo"].get<double>(), 1e-8);
  EXPECT_TRUE(object["closest_points"].is_null());
  EXPECT_EQ(object["unique"], false);
}

TEST_F(DistanceCommand, SearchesModelsBuiltBySetOperations) {
  const auto bored = write("bored.json", bored_ball);
  const auto object =
      nlohmann::json::parse(distance({bored, ball("b.json", "", 0.25, 0.25), "--json", "--time-limit", "60"}).out);
  EXPECT_LE(object["lo"].get<double>(), 0.5);
  EXPECT_GE(object["hi"].get<double>(), 0.5);
  EXPECT_EQ(object["proximity"], "separated");
  const auto meeting = nlohmann::json::parse(distance({bored, ball("b.json", "", 0.9, 0.25), "--json"}).out);
  EXPECT_EQ(meeting["hi"], 0.0);
  EXPECT_EQ(meeting["proximity"], "overlapping");
  EXPECT_EQ(meeting["witness"].size(), 3U);
}

TEST_F(DistanceCommand, EndsASearchAtTheTimeLimit) {
  const auto a = write("a.json", bent_ball);
  // Nearly a ball: the distance of a ball takes no search of pairs.
  const auto b = write("b.json", R"({"format": "verisq-model/1", "primitives": [{"name": "nearly a ball",
    "superquadric": {"semi_axes": [1, 1, 0.999], "exponents": [1, 1]}, "pose": {"translation": [9, 0, 0]}}]})");
  const Outcome outcome = distance({a, b, "--json", "--tol", "1e-12", "--time-limit", "1e-9"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err, HasSubstr("the time limit is reached; the enclosure is valid, and wide\n"));
  const auto object = nlohmann::json::parse(outcome.out);
  const double exact = std::hypot(9.0, 5.0) - 2.0;
  EXPECT_LE(object["lo"].get<double>(), exact);
  EXPECT_GE(object["hi"].get<double>(), exact);
}

/// Two nearly boxes 1e-3 apart within each other: a search that takes a minute.
TEST_F(DistanceCommand, EndsSearchesOfManyPosesAtTheTimeLimit) {
  const auto a = write("a.json", bent_ball);
  const auto poses = write("poses.csv", "9,0,0,1,0,0,0\n0,9,0,1,0,0,0\n0,0,30,1,0,0,0\n");
  const Outcome outcome = distance({a, a, "--poses", poses, "-o", path("o.csv"), "--device", "host", "--tol", "1e-12",
                                    "--time-limit", "1e-9", "--json"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err, HasSubstr("the time limit is reached; 3 of 3 rows are valid, and wide\n"));
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary["out_of_time"], true);
  EXPECT_EQ(summary["poses"], 3);
}

TEST_F(DistanceCommand, InterruptionLeavesAValidEnclosure) {
  const auto bored = write("bored.json", bored_ball);
  const auto peg = write("peg.json", R"({"format": "verisq-model/1", "primitives": [
    {"name": "peg", "superquadric": {"semi_axes": [0.999, 0.999, 10], "exponents": [0.1, 1]}}]})");
  const Outcome outcome = run_interrupted({"distance", bored, peg, "--tol", "1e-15", "--json"});
  EXPECT_EQ(outcome.status, 130);
  EXPECT_EQ(outcome.err, "verisq: interrupted; the enclosure is valid, and wide\n");
  const auto object = nlohmann::json::parse(outcome.out);
  EXPECT_LE(object["lo"].get<double>(), 1e-3 + 1e-15);
  if (!object["hi"].is_null()) {
    EXPECT_GE(object["hi"].get<double>(), 1e-3 - 1e-15);
  }
}

TEST_F(DistanceCommand, WhatIsNotBoundedIsNull) {
  // Balls that hardly miss each other: what they have in common takes long to prove empty, and has no point.
  const auto a = write("a.json", R"({"format": "verisq-model/1", "primitives": [
    {"name": "left", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}},
    {"name": "right", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]},
     "pose": {"translation": [1.6, 1.2000001, 0]}}], "csg": {"intersection": ["left", "right"]}})");
  const Outcome outcome = distance({a, ball("b.json", "", 9.0), "--json", "--time-limit", "1e-9"});
  EXPECT_EQ(outcome.status, 3);
  const auto object = nlohmann::json::parse(outcome.out);
  EXPECT_TRUE(object.at("hi").is_null());
  EXPECT_GT(object.at("lo").get<double>(), 0.0);
}

TEST_F(DistanceCommand, RefusesWhatSearchesLack) {
  const auto a = ball("a.json", "", 0.0);
  const auto b = write("b.json", bent_ball);
  const auto poses = write("poses.csv", "0,0,0,1,0,0,0\n");
  expect_refused(distance({b, a, "--poses", poses, "-o", path("o.csv"), "--closest-points"}),
                 "--closest-points: " + b + ": not supported");
  expect_refused(distance({a, a, "--poses", poses, "-o", path("o.csv"), "--time-limit", "1", "--part", "1/2"}),
                 "--part");
  expect_refused(distance({a, a, "--poses", poses, "-o", path("o.csv"), "--time-limit", "1", "--certificate-file",
                           path("c.json")}),
                 "--certificate-file");
  for (const std::string seconds : {"0", "-1", "soon", "inf", ""}) {
    expect_refused(distance({a, b, "--time-limit=" + seconds}), "--time-limit");
  }
}

/// Two posed primitives, so that a wrong order of motions shows.
const std::string two_primitives = R"({"format": "verisq-model/1", "units": "mm", "primitives": [
  {"name": "gem", "superquadric": {"semi_axes": [0.43, 0.6, 1.9], "exponents": [1.5, 0.4]},
   "pose": {"translation": [1, 2, -0.5], "quaternion": [1, 2, -1, 0.5]}},
  {"name": "soap", "superquadric": {"semi_axes": [0.34, 0.43, 0.17], "exponents": [0.1, 0.1]},
   "pose": {"translation": [-1, 0.3, 0.7], "quaternion": [0.2, 0, 1, 0]}}]})";

const std::string capsule = R"({"format": "verisq-model/1", "primitives": [
  {"name": "capsule", "superquadric": {"semi_axes": [0.75, 0.75, 1.0], "exponents": [1.0, 0.8]},
   "pose": {"translation": [0.1, -0.2, 0.3], "quaternion": [3, 1, 0, 0]}}]})";

const std::vector<std::string> poses{"5,0,0,1,0,0,0",        "-5,0.5,0,0,0,0,2",        "1,2,8,0.3,-0.4,0.5,0.6",
                                     "0,-7,1,1e-5,0,2e-5,0", "3,3,3,100,-200,300,-400", "-2,-2,4,0.7,0.1,0.1,0.1",
                                     "0,0,0,1,0,0,0",        "20,30,-40,1,1,1,1",       "1e6,0,0,0.5,0.5,0.5,0.51"};

std::string file_of(const std::vector<std::string>& lines_of_file) {
  std::string text = "tx,ty,tz,qw,qx,qy,qz\n";
  for (const std::string& line : lines_of_file) text += line + "\n";
  return text;
}

/// Bends and set operations: rows are those of single searches.
TEST_F(DistanceCommand, MapsPosesOfBendsAndSetOperations) {
  const auto bored = write("bored.json", bored_ball);
  const auto bent = write("bent.json", bent_ball);
  const auto file = write("poses.csv", file_of({poses[0], poses[1], poses[2]}));
  const Outcome outcome =
      distance({bored, bent, "--poses", file, "-o", path("map.csv"), "--tol", "1e-4", "--json", "--no-progress"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary["poses"], 3);
  EXPECT_EQ(summary["device"], "host");
  EXPECT_EQ(summary["host_verified"], 3);
  const std::vector<Row> rows = rows_of(path("map.csv"));
  ASSERT_EQ(rows.size(), 3U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto one = nlohmann::json::parse(distance({bored, bent, "--pose", poses[i], "--json", "--tol", "1e-6"}).out);
    EXPECT_LE(rows[i].distance.lo, one["hi"].get<double>()) << i;
    EXPECT_GE(rows[i].distance.hi, one["lo"].get<double>()) << i;
    EXPECT_LE(rows[i].distance.width(), 1e-4);
  }
}

/// With every row at a tolerance that only the tightest reach: rows and single poses differ by less than any error of
/// a pose would make.
TEST_F(DistanceCommand, ManyPosesMoveTheSecondModelAsOnePoseDoes) {
  const auto a = write("a.json", capsule);
  const auto b = write("b.json", two_primitives);
  const auto file = write("poses.csv", file_of(poses));
  for (const std::string device : {"auto", "host"}) {
    const Outcome outcome =
        distance({a, b, "--poses", file, "-o", path("map.csv"), "--device", device, "--tol", "1e-11"});
    EXPECT_NE(outcome.status, 2) << outcome.err;
    const std::vector<Row> rows = rows_of(path("map.csv"));
    ASSERT_EQ(rows.size(), poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const auto one = nlohmann::json::parse(distance({a, b, "--pose", poses[i], "--json"}).out);
      EXPECT_EQ(rows[i].index, i);
      EXPECT_LE(rows[i].distance.lo, one["hi"].get<double>()) << poses[i];
      EXPECT_GE(rows[i].distance.hi, one["lo"].get<double>()) << poses[i];
      EXPECT_LE(rows[i].distance.width(), i + 1 == poses.size() ? 1e-6 : 1e-11) << poses[i];
    }
  }
}

/// The boxes of each pose are those of that pose alone.
TEST_F(DistanceCommand, ManyPosesHaveClosestPoints) {
  const auto a = write("a.json", capsule);
  const auto b = write("b.json", capsule);
  const auto file = write("poses.csv", file_of({poses[0], poses[2], poses[6]}));  // the last one leaves B in A
  const Outcome outcome = distance({a, b, "--poses", file, "--closest-points", "-o", path("map.csv"), "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary["unique_closest_points"], 2);
  EXPECT_GT(summary["widest_closest_point"].get<double>(), 0.0);
  EXPECT_FALSE(summary.contains("widest_normal"));
  std::istringstream file_of_rows(contents(path("map.csv")));
  std::vector<std::string> rows;
  for (std::string row; std::getline(file_of_rows, row);) rows.push_back(row);
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_THAT(rows[0], StartsWith("index,lo,hi,status,unique,on_a_x_lo,on_a_x_hi,on_a_y_lo"));
  EXPECT_THAT(rows[0], EndsWith(",on_b_z_lo,on_b_z_hi"));
  for (std::size_t i = 0; i < 2; ++i) {
    const auto one = nlohmann::json::parse(distance({a, b, "--pose", poses[2 * i], "--json"}).out);
    std::string expected = ",1";
    for (const std::string side : {"on_a", "on_b"}) {
      for (const auto& coordinate : one["closest_points"][side])
        expected += fmt::format(",{},{}", coordinate[0].get<double>(), coordinate[1].get<double>());
    }
    EXPECT_THAT(rows[1 + i], EndsWith(expected));
  }
  EXPECT_THAT(rows[3], EndsWith(",0,-inf,inf,-inf,inf,-inf,inf,-inf,inf,-inf,inf,-inf,inf"));
  EXPECT_THAT(distance({a, b, "--poses", file, "--closest-points", "-o", path("map.npy")}).out,
              HasSubstr("closest points     2 unique, to "));
  expect_refused(distance({a, b, "--closest-points"}), "--closest-points: of one pose they are printed");
  expect_refused(distance({a, b, "--poses", file, "--closest-points", "-o", path("map.json")}),
                 "closest points are written to .csv, .npy and .vtp only");
}

TEST_F(DistanceCommand, SumsUpManyPoses) {
  const auto a = write("a.json", capsule);
  const auto b = write("b.json", two_primitives);
  const auto file = write("poses.csv", file_of(poses));
  const Outcome words = distance({a, b, "--poses", file, "-o", path("map.csv")});
  EXPECT_EQ(words.status, 0) << words.err;
  EXPECT_EQ(words.err, "") << "a bar is for terminals";
  EXPECT_THAT(words.out, StartsWith("poses              9\n"));
  EXPECT_THAT(words.out, HasSubstr(" mm\n"));
  EXPECT_THAT(words.out, HasSubstr(" poses/s\n"));
  EXPECT_THAT(words.out, EndsWith("map                " + quotation(path("map.csv")) + "\n"));
  EXPECT_THAT(words.out, Not(HasSubstr("point")));
  const Outcome outcome = distance({a, b, "--poses", file, "-o", path("map.json"), "--device", "host", "--json"});
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary["poses"], 9);
  EXPECT_EQ(summary["device_verified"], 0);
  EXPECT_EQ(summary["host_verified"], 9);
  EXPECT_EQ(summary["wide"], 0);
  EXPECT_EQ(summary["device"], "host");
  EXPECT_GT(summary["poses_per_second"].get<double>(), 0.0);
  const auto map = nlohmann::json::parse(contents(path("map.json")));
  EXPECT_EQ(map["elements"], "poses");
  EXPECT_EQ(map["results"].size(), 9U);
  EXPECT_LE(map["results"][0]["lo"], map["results"][0]["hi"]);
}

TEST_F(DistanceCommand, ExitsWithThreeWhereTheEnclosureOfAPoseIsWide) {
  const auto a = ball("a.json", "", 0.1);
  const auto b = ball("b.json", "", 5.0, 0.7);
  const auto file = write("poses.csv", "1,2,3,1,0,0,0\n");
  const Outcome outcome =
      distance({a, b, "--poses", file, "-o", path("map.csv"), "--device", "host", "--tol", "1e-20"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_EQ(rows_of(path("map.csv")).at(0).status, "wide");
}

TEST_F(DistanceCommand, InterruptionKeepsFinishedPoses) {
  constexpr std::size_t count = 200'000;
  std::string text;
  for (std::size_t k = 0; k < count; ++k) text += "5,0,0,1,0,0,0\n";
  const auto file = write("poses.csv", text);
  for (const std::string name : {"map.csv", "map.json"}) {
    const Outcome outcome = run_interrupted({"distance", ball("a.json", "", 0.0), ball("b.json", "", 0.0), "--poses",
                                             file, "--device", "host", "-o", path(name), "--json"});
    EXPECT_EQ(outcome.status, 130) << outcome.err;
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(summary["interrupted"], true);
    EXPECT_LT(summary["poses"].get<std::size_t>(), count);
    EXPECT_FALSE(std::filesystem::exists(path(name)));
    if (name == "map.json") {
      EXPECT_THAT(outcome.err, HasSubstr("only .csv and .npy files can hold a part of a map"));
      EXPECT_EQ(summary["output"], "");
    } else {
      EXPECT_EQ(rows_of(path("map.csv.partial")).size(), summary["poses"]);
      EXPECT_EQ(summary["output"], path("map.csv.partial"));
    }
  }
}

TEST_F(DistanceCommand, RefusesBadUsageOfManyPoses) {
  const auto a = ball("a.json", "", 0.0);
  const auto b = ball("b.json", "", 5.0);
  const auto file = write("poses.csv", "1,2,3,1,0,0,0\n");
  const auto out = path("map.csv");
  expect_refused(distance({a, b, "-o", out}), "-o: only for many poses: give their --poses");
  expect_refused(distance({a, b, "--device", "host"}), "--device: only for many poses");
  expect_refused(distance({a, b, "--poses", file}), "--poses: give the file for their distances: -o");
  expect_refused(distance({a, b, "--poses", file, "-o", out, "--pose", "1,2,3,1,0,0,0"}),
                 "give either --pose or --poses");
  expect_refused(distance({a, b, "--poses", file, "-o", out, "--certificate"}), "--certificate: ");
  expect_refused(distance({a, b, "--poses", file, "-o", file}), "would overwrite an input");
  expect_refused(distance({a, b, "--poses", file, "-o", b}), "would overwrite an input");
  expect_refused(distance({a, b, "--poses", file, "-o", out, "--device", "no such device"}), "no such device");
  expect_refused(distance({a, b, "--poses", file, "-o", path("map.vtp")}),
                 path("map.vtp") + ": maps of poses are written to .csv, .npy and .json only");
  expect_refused(distance({a, b, "--poses", file, "-o", path("map.ply")}), ".csv, .npy and .json only");
  expect_refused(distance({a, b, "--poses", file, "-o", path("map.txt")}), "unknown map format");
  expect_refused(distance({a, b, "--poses", path("none.csv"), "-o", out}), "none.csv");
  for (const auto& [text, words] : std::vector<std::pair<std::string, std::string>>{
           {"1,2,3,1,0,0,0\n1,2,3,1,0,0\n", "line 2"}, {"1,2,nan,1,0,0,0\n", "nan"}, {"1,2,3,0,0,0,0\n", "zero"}}) {
    const auto bad = write("bad.csv", text);
    expect_refused(distance({a, b, "--poses", bad, "-o", out, "--device", "host"}), bad);
    expect_refused(distance({a, b, "--poses", bad, "-o", out, "--device", "host"}), words);
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

const std::string uncertain_ball = R"({"format": "verisq-model/1", "units": "mm", "primitives": [
  {"name": "ball", "superquadric": {"semi_axes": [[1.0, 1.25], [1.0, 1.25], [1.0, 1.25]], "exponents": [1, 1]},
   "pose": {"translation": [[4.75, 5.25], 0, 0]}}]})";

TEST_F(DistanceCommand, EnclosesTheDistancesOfUncertainModels) {
  const auto a = ball("a.json", "mm", 0.0);
  const auto b = write("b.json", uncertain_ball);  // 2.5 to 3.25 away
  for (const auto& both : {Arguments{a, b}, Arguments{b, a}}) {
    const Outcome outcome = distance({both[0], both[1], "--json", "--tol", "0.8"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const auto object = nlohmann::json::parse(outcome.out);
    EXPECT_LE(object["lo"].get<double>(), 2.5);
    EXPECT_GE(object["hi"].get<double>(), 3.25);
    EXPECT_LE(object["hi"].get<double>() - object["lo"].get<double>(), 0.75 + 1e-14);
    EXPECT_EQ(object["uncertain"], true);
    EXPECT_EQ(object["proximity"], "separated");
    EXPECT_TRUE(object["closest_points"].is_null());
  }
  const Outcome words = distance({a, b, "--pose", "-3.5,0,0,1,0,0,0"});
  EXPECT_EQ(words.status, 3) << "wider than the default tolerance";
  EXPECT_THAT(words.out, HasSubstr("undecided (neither is proven of all that the uncertain numbers allow)\n"));
  EXPECT_THAT(words.out, EndsWith("closest points     not enclosed, because the models are uncertain\n"));
}

TEST_F(DistanceCommand, RefusesWhatUncertainModelsLack) {
  const auto a = ball("a.json", "mm", 0.0);
  const auto b = write("b.json", uncertain_ball);
  const auto file = write("poses.csv", "1,2,3,1,0,0,0\n");
  expect_refused(distance({a, b, "--poses", file, "-o", path("map.csv")}), "--poses: not for models with intervals");
  expect_refused(distance({b, a, "--certificate"}), "--certificate: not for models with intervals");
}

/// A search takes every number as exact: it would answer for one member.
TEST_F(DistanceCommand, RefusesIntervalsBesideBendsAndSetOperations) {
  const auto uncertain = write("uncertain.json", uncertain_ball);
  for (const auto& other : {write("bent.json", bent_ball), write("bored.json", bored_ball)}) {
    const std::string refusal = fmt::format(
        "{}: intervals are only for pairs of models that are both unions of primitives without bends, "
        "which {} is not",
        uncertain, other);
    expect_refused(distance({other, uncertain, "--tol", "1"}), refusal);
    expect_refused(distance({uncertain, other, "--tol", "1"}), refusal);
  }
}

TEST_F(DistanceCommand, RefusesBadUsage) {
  const auto a = ball("a.json", "mm", 0.0);
  const auto b = ball("b.json", "mm", 5.0);
  expect_refused(distance({a}), "B");
  expect_refused(distance({a, (folder_.path() / "none.json").string()}), "none.json");
  expect_refused(distance({a, ball("m.json", "m", 5.0)}), "units \"m\" differ from \"mm\"");
  expect_refused(distance({a, b, "--tol", "-1"}), "--tol: -1");
  expect_refused(distance({a, b, "--tol", "nan"}), "--tol: nan");
  expect_refused(distance({a, b, "--pose", "1,2,3"}), "--pose: 3 numbers where 7");
  expect_refused(distance({a, b, "--pose", "1,2,3,1,0,0,0,"}), "--pose: '' is not");
  expect_refused(distance({a, b, "--pose", "1,2,inf,1,0,0,0"}), "--pose: 'inf' is not");
  expect_refused(distance({a, b, "--pose", "1,2,3,0,0,0,0"}), "zero quaternion");
}

}  // namespace
}  // namespace verisq::testing
