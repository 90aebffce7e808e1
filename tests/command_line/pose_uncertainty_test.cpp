/// `--translation-error` and `--rotation-error` as their user meets them: rows that contain what places do to
/// distances, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>

#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;

class PoseUncertaintyOptions : public ProgramTest {
 protected:
  /// A ball of radius 1 about the origin, and two points 5 and 9 from there.
  [[nodiscard]] Outcome map(const Arguments& options) const {
    const nlohmann::json superquadric{{"semi_axes", {1, 1, 1}}, {"exponents", {1, 1}}};
    const nlohmann::json ball{{"name", "ball"}, {"superquadric", superquadric}};
    const nlohmann::json model{{"format", "verisq-model/1"}, {"units", "mm"}, {"primitives", {ball}}};
    Arguments arguments{"map",
                        "--model",
                        folder_.file("ball.json", model.dump()).string(),
                        "--points",
                        write("points.csv", "0,5,0\n9,0,0\n"),
                        "-o",
                        path("map.npy"),
                        "--tol",
                        "3",
                        "--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run(arguments);
  }

  [[nodiscard]] static nlohmann::json summary(const Outcome& outcome) {
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  }
};

/// The least distance, which 5 − 1 − `error` is at some place.
void expect_least(const nlohmann::json& summary, double error) {
  const nlohmann::json& least = summary.at("smallest_distance");
  EXPECT_LE(least.at("lo").get<double>(), 4.0 - error);
  EXPECT_GE(least.at("lo").get<double>(), 4.0 - 1.05 * error);
  EXPECT_GE(least.at("hi").get<double>(), 4.0 + 0.9 * error);
}

TEST_F(PoseUncertaintyOptions, WidenRowsByWhatPlacesDo) {
  expect_least(summary(map({"--translation-error", "0,0.5,0"})), 0.5);
  // A ball does not see turns about its centre, but those about another point.
  const double turn = 2.0 * 10.0 * std::sin(0.5 / 2.0 * std::acos(-1.0) / 180.0);
  const nlohmann::json turned = summary(map({"--rotation-error", "0.5", "--rotation-centre", "10,0,0"}));
  expect_least(turned, turn);
  EXPECT_THAT(turned.at("model_place").get<std::string>(), HasSubstr("0.5 degrees about (10, 0, 0)"));
}

TEST_F(PoseUncertaintyOptions, TurnAboutWhereThePosePutsTheCentre) {
  // The ball itself is where the points see it at 4; its centre of turns moves with it.
  const std::string pose = "--pose=0,0,0,0,0,0,1";
  const nlohmann::json turned = summary(map({pose, "--rotation-error", "0.5", "--rotation-centre", "10,0,0"}));
  EXPECT_THAT(turned.at("model_place").get<std::string>(), HasSubstr("about (-10, "));
}

TEST_F(PoseUncertaintyOptions, AreRefusedWhereTheyMeanNothing) {
  expect_refused(map({"--pose-divisions", "4"}), {"--pose-divisions: give the --translation-error"});
  expect_refused(map({"--rotation-centre", "1,2,3"}), {"--rotation-centre: give the --rotation-error"});
  expect_refused(map({"--translation-error", "-1"}), {"--translation-error", "-1"});
  expect_refused(map({"--translation-error", "1,-1,1"}), {"--translation-error: 1,-1,1 has a negative length"});
  expect_refused(map({"--translation-error", "1,1"}), {"--translation-error", "1,1"});
  expect_refused(map({"--rotation-error", "181"}), {"--rotation-error: 181 is more than 180 degrees"});
  expect_refused(map({"--rotation-error", "nan"}), {"--rotation-error", "nan"});
  expect_refused(map({"--translation-error", "1", "--closest-points"}), {"--closest-points: of exact places only"});
  expect_refused(map({"--translation-error", "1", "--tol", "0"}), {"--tol"});
}

TEST_F(PoseUncertaintyOptions, AreNotProvenByCertificates) {
  expect_refused(map({"--translation-error", "1", "--certificates"}), {"--certificates: of exact places only"});
}

}  // namespace
}  // namespace verisq::testing
