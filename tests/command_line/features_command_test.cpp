/// `verisq features` as its user meets it: results, messages and exit status.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;

class FeaturesCommand : public ProgramTest {
 protected:
  [[nodiscard]] Outcome features(Arguments arguments) const {
    arguments.insert(arguments.begin(), "features");
    return run(arguments);
  }
  const std::string landmarks_ = VERISQ_EXAMPLES "/femur_landmarks.json";
};

const nlohmann::json& feature(const nlohmann::json& summary, const std::string& name) {
  for (const nlohmann::json& found : summary["features"]) {
    if (found["name"] == name) return found;
  }
  throw std::runtime_error("no feature " + name);
}

TEST_F(FeaturesCommand, EnclosesWhatLandmarksSay) {
  const Outcome exact = features({"--landmarks", landmarks_, "--json"});
  const Outcome uncertain = features({"--landmarks", landmarks_, "--landmark-radius", "1", "--json"});
  EXPECT_EQ(exact.status, 0) << exact.err;
  EXPECT_EQ(uncertain.status, 0) << uncertain.err;
  const auto narrow = nlohmann::json::parse(exact.out);
  const auto wide = nlohmann::json::parse(uncertain.out);
  EXPECT_EQ(narrow["side"], "right");
  EXPECT_EQ(narrow["features"].size(), 9U);
  EXPECT_TRUE(narrow["missing"].empty());
  EXPECT_DOUBLE_EQ(feature(narrow, "head_radius")["value"]["lo"], 24.0);
  for (const char* name : {"ccd", "offset", "length", "version"}) {
    EXPECT_LT(feature(wide, name)["value"]["lo"], feature(narrow, name)["value"]["lo"]) << name;
    EXPECT_GT(feature(wide, name)["value"]["hi"], feature(narrow, name)["value"]["hi"]) << name;
  }
}

TEST_F(FeaturesCommand, SaysWhereLandmarksAreNotKnownWellEnough) {
  const Outcome outcome = features({"--landmarks", landmarks_, "--landmark-radius", "12"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.out, HasSubstr("missing: ccd: needs neck and shaft"));
}

TEST_F(FeaturesCommand, WritesLandmarksThatItReadsAgain) {
  EXPECT_EQ(features({"--landmarks", landmarks_, "-o", path("again.json"), "--axes", path("axes.json")}).status, 0);
  EXPECT_EQ(features({"--landmarks", path("again.json"), "--json"}).out,
            features({"--landmarks", landmarks_, "--json"}).out);
  EXPECT_EQ(run({"distance", path("axes.json"), VERISQ_EXAMPLES "/soap.json", "--json"}).status, 0);
}

TEST_F(FeaturesCommand, SaysWhatAnImplantChanges) {
  const std::string implant = write("implant.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
    {"name": "ball", "superquadric": {"semi_axes": [14, 14, 14], "exponents": [1, 1]},
     "pose": {"translation": [9.9, 35.1, -39.6]}}]})");
  const Outcome outcome = features({"--landmarks", landmarks_, "--implant", implant, "--head", "ball", "--json"});
  EXPECT_EQ(outcome.status, 3) << "it has no neck";
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_NEAR(summary["changes"][1]["value"]["lo"], 5.0, 1e-9);
  expect_refused(features({"--landmarks", landmarks_, "--implant", implant}), {"--head", "no primitive \"head\""});
}

TEST_F(FeaturesCommand, RefusesWhatIsNoFemur) {
  const std::string three = write("three.off", "OFF\n3 1 0\n0 0 0\n100 0 0\n0 100 0\n3 0 1 2\n");
  expect_refused(features({"--mesh", three}), {"three.off", "too few"});
  expect_refused(features({}), {"--mesh", "--landmarks"});
  expect_refused(features({"--landmarks", landmarks_, "--side", "left"}), {"--side"});
  expect_refused(features({"--landmarks", write("bad.json", R"({"format": "verisq-landmarks/1",
    "landmarks": {"head_center": [0, 0, 0]}})")}),
                 {"bad.json", "landmarks.head_center", "is no landmark"});
}

}  // namespace
}  // namespace verisq::testing
