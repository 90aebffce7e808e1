/// `verisq features` as its user meets it: results, messages and exit status.
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

class FeaturesCommand : public ProgramTest {
 protected:
  [[nodiscard]] Outcome features(Arguments arguments) const {
    arguments.insert(arguments.begin(), "features");
    return run(arguments);
  }
  const std::string landmarks_ = places::example("femur_landmarks.json");
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
  EXPECT_EQ(run({"distance", path("axes.json"), places::example("soap.json"), "--json"}).status, 0);
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
  expect_refused(features({"--landmarks", landmarks_, "--implant", implant, "--head", "cap"}),
                 {"--head", "no primitive \"cap\""});
}

TEST_F(FeaturesCommand, TakesThePointsThatAnImplantNames) {
  const std::string implant = write("implant.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
    {"name": "head", "superquadric": {"semi_axes": [14, 14, 14], "exponents": [1, 1]}}],
    "landmarks": {"head_centre": [9.9, 38.1, -39.6], "neck_centre": [5.7, 25.4, -22.9],
                  "shaft_proximal": [0, -70, 0], "shaft_distal": [0, -200, 0]}})");
  const Outcome outcome = features({"--landmarks", landmarks_, "--landmark-radius", "0.5", "--implant", implant});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("head_centre: as its file names it"));
  EXPECT_THAT(outcome.out, HasSubstr("leg longer"));
  EXPECT_THAT(outcome.out, HasSubstr("more or less: not decided"));
  EXPECT_THAT(outcome.out, HasSubstr("implant_tilt"));
  // A primitive that is asked for comes before the file's point.
  EXPECT_THAT(features({"--landmarks", landmarks_, "--implant", implant, "--head", "head"}).out,
              HasSubstr("head_centre: the centre of its primitive \"head\""));
}

TEST_F(FeaturesCommand, MeshesAModel) {
  // The points that a file names come before those of its mesh.
  const std::string femur = write("femur.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
    {"name": "head", "superquadric": {"semi_axes": [22, 22, 22], "exponents": [1, 1]},
     "pose": {"translation": [40, 0, 20]}},
    {"name": "neck", "superquadric": {"semi_axes": [13, 13, 40], "exponents": [0.5, 1]},
     "pose": {"translation": [20, 0, 0], "quaternion": [0.92388, 0, 0.38268, 0]}},
    {"name": "shaft", "superquadric": {"semi_axes": [14, 14, 110], "exponents": [0.3, 1]},
     "pose": {"translation": [0, 0, -110]}}], "landmarks": {"head_centre": [40, 0, 20.5]}})");
  const Outcome outcome = features({"--model", femur, "--deviation", "1", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_THAT(summary["notes"][0], HasSubstr("the model's, meshed to"));
  EXPECT_NEAR(summary["head_radius"], 22.0, 0.5);
  EXPECT_EQ(summary["landmarks"]["head_centre"], nlohmann::json::parse("[40, 0, 20.5]"));
  const std::string ball = write("ball.json", R"({"format": "verisq-model/1", "primitives": [
    {"name": "ball", "superquadric": {"semi_axes": [60, 60, 60], "exponents": [1, 1]}}]})");
  expect_refused(features({"--model", ball, "--deviation", "1"}), {"ball.json: mesh: has no long axis"});
  expect_refused(features({"--model", femur, "--mesh", "a.stl"}), {"--mesh and --model"});
}

TEST_F(FeaturesCommand, RefusesWhatIsNoFemur) {
  const std::string three = write("three.off", "OFF\n3 1 0\n0 0 0\n100 0 0\n0 100 0\n3 0 1 2\n");
  expect_refused(features({"--mesh", three}), {"three.off", "too few"});
  expect_refused(features({"--model", places::example("stem_mm.json"), "--deviation", "1"}),
                 {"stem_mm.json: mesh: its shaft is", "no femur"});
  expect_refused(features({"--mesh", places::source() + "/tests/features/coarse_bone.off"}),
                 {"coarse_bone.off: mesh: what was found is no femur's", "131 %"});
  expect_refused(features({}), {"--mesh", "--landmarks"});
  expect_refused(features({"--landmarks", landmarks_, "--side", "left"}), {"--side"});
  expect_refused(features({"--landmarks", write("bad.json", R"({"format": "verisq-landmarks/1",
    "landmarks": {"head_center": [0, 0, 0]}})")}),
                 {"bad.json", "landmarks.head_center", "is no landmark"});
}

}  // namespace
}  // namespace verisq::testing
