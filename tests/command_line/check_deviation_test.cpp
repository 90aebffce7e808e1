/// How far a mesh lies from a model is proved from a file alone, and no forgery of it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <verisq/files.hpp>

#include "host/errors/refusal.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/proof_file_test.hpp"
#include "tests/fixtures/sample_meshes.hpp"

namespace verisq::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

class CheckDeviation : public ProofFileTest {
 protected:
  void SetUp() override {
    write_mesh(mesh_, sphere_mesh(1));
    (void)write("ball.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
      {"name": "ball", "superquadric": {"semi_axes": [0.8, 0.9, 1], "exponents": [1, 1]}}]})");
    const Outcome outcome = deviation({"--mesh", mesh_, "--certificate-file", proof_});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("certificate            " + quotation(proof_) + "\n  proves, largest"));
  }

  [[nodiscard]] Outcome deviation(Arguments arguments) const {
    arguments.insert(arguments.begin(), {"deviation", "--model", model_, "--device", "host", "--no-progress"});
    return run(arguments);
  }

  [[nodiscard]] Outcome check(const std::string& proof, const Arguments& more = {}) const {
    return checked(proof, {"--model", model_}, more);
  }

  void expect_not_proved(const std::string& pointer, const json& value) const {
    const Outcome outcome = check(forged(pointer, value), {"--mesh", mesh_});
    EXPECT_EQ(outcome.status, 3) << pointer << " " << value << outcome.out << outcome.err;
  }

  std::string model_ = path("ball.json");
  std::string mesh_ = path("sphere.off");
};

TEST_F(CheckDeviation, ProvesEveryClaim) {
  const Outcome outcome = check(proof_, {"--mesh", mesh_});
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("claims               10\n  proved             10\n"));
  EXPECT_THAT(outcome.out, HasSubstr("proved   model to mesh, largest: ["));
  EXPECT_THAT(outcome.out, HasSubstr("proved   both ways (Hausdorff), largest: ["));
  EXPECT_THAT(
      outcome.out,
      HasSubstr("not claimed          mean and percentiles of how far the model's surface lies from the mesh\n"));
  const json summary = json::parse(check(proof_, {"--mesh", mesh_, "--json"}).out);
  EXPECT_EQ(summary["kind"], "deviation");
  EXPECT_EQ(summary["claims"][0]["of"], "mesh");
  EXPECT_EQ(summary["unproved_samples"], 0);
  EXPECT_EQ(summary["claims"][8]["of"], "model");
  EXPECT_EQ(summary["claims"][8]["verdict"], "proved");
  EXPECT_EQ(summary["claims"][9]["of"], "both");
}

/// Two balls that overlap: what lies on the boundary is said of the others' patches.
TEST_F(CheckDeviation, ProvesMeanAndPercentilesOfTheModelsSurface) {
  (void)write("ball.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
    {"name": "ball", "superquadric": {"semi_axes": [0.8, 0.9, 1], "exponents": [1, 1]}},
    {"name": "cap", "superquadric": {"semi_axes": [0.7, 0.7, 0.7], "exponents": [1, 1]},
     "pose": {"translation": [0, 0, 0.6]}}]})");
  const Outcome made =
      deviation({"--mesh", mesh_, "--statistics-of-model", "--tol", "50%", "--certificate-file", proof_});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("\n  model, mean "));
  const Outcome outcome = check(proof_, {"--mesh", mesh_});
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("claims               13\n  proved             13\n"));
  EXPECT_THAT(outcome.out, HasSubstr("proved   model to mesh, mean: ["));
  EXPECT_THAT(outcome.out, HasSubstr("proved   model to mesh, 95 %: ["));
  EXPECT_THAT(outcome.out, Not(HasSubstr("not claimed")));
  const json proven = json::parse(check(proof_, {"--mesh", mesh_, "--json"}).out)["claims"];
  EXPECT_EQ(proven[9]["what"], "mean");
  const std::array<std::string, 3> claims{"mean", "percentiles/0", "percentiles/1"};
  for (std::size_t i = 0; i < claims.size(); ++i) {
    const json& of = proven[9 + i]["proven"];
    expect_not_proved("/from_model/" + claims[i] + "/lo", of["hi"].get<double>() * (1.0 + 1e-12));
    expect_not_proved("/from_model/" + claims[i] + "/hi", of["lo"].get<double>() * (1.0 - 1e-12));
  }
  ASSERT_THAT(document()["surface"]["patches"][0].get<std::string>(), HasSubstr("w"));
  json untold = document();
  for (json& patches : untold["surface"]["patches"]) {
    std::string letters = patches;
    std::erase(letters, 'w');
    patches = letters;
  }
  untold["surface"].erase("on");
  EXPECT_EQ(check(write("untold.json", untold.dump()), {"--mesh", mesh_}).status, 3);
}

/// Files of before the other way had certificates.
TEST_F(CheckDeviation, NeedNotTellTheOtherWay) {
  json without = document();
  for (const char* const key : {"from_model", "hausdorff", "surface"}) without.erase(key);
  const std::string file = write("without.json", without.dump());
  const Outcome outcome = check(file, {"--mesh", mesh_});
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("claims               8\n  proved             8\n"));
  EXPECT_THAT(outcome.out, HasSubstr("not claimed          how far the model's surface lies from the mesh\n"));
}

TEST_F(CheckDeviation, NeverProvesAForgery) {
  const double largest = document()["from_mesh"]["largest"]["hi"];
  expect_not_proved("/from_mesh/largest/hi", 0.9 * largest);
  expect_not_proved("/from_mesh/mean/lo", largest);
  expect_not_proved("/from_mesh/percentiles/1/hi", 0.0);
  expect_not_proved("/of_vertices/largest/lo", 2.0 * largest);
  expect_not_proved("/from_mesh/largest/hi", "inf");
  expect_not_proved("/triangles/0", {{"pieces", ""}});
  expect_not_proved("/vertices/0/normals", json::array());
  const double of_model = document()["from_model"]["largest"]["hi"];
  expect_not_proved("/from_model/largest/hi", 0.5 * of_model);
  expect_not_proved("/from_model/largest/lo", 1.5 * of_model);
  expect_not_proved("/from_model/largest/hi", "inf");
  expect_not_proved("/hausdorff/hi", 0.5 * largest);
  expect_not_proved("/hausdorff/lo", 2.0 * std::max(largest, of_model));
  expect_not_proved("/surface/within", 2.0 * of_model);
  expect_not_proved("/surface/patches/0", "");
  expect_not_proved("/surface/patches/0", "........");
  expect_not_proved("/surface/patches", json::array());
  expect_not_proved("/surface/farthest/point/0", 0.0);
}

TEST_F(CheckDeviation, IsOfNoOtherModelMeshOrForm) {
  const auto check = [&](const std::string& proof, const Arguments& more = {}) {
    Arguments arguments{"check", "--model", model_, "--certificate", proof};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  };
  expect_refused(check(proof_), {"is of a deviation: give the --mesh"});
  expect_refused(check(proof_, {"--points", mesh_}), {"is of a deviation: give the --mesh"});
  expect_refused(check(proof_, {"--mesh", places::example("cavity.off")}), {"is about another mesh"});
  expect_refused(check(proof_, {"--mesh", mesh_, "--map", "m.csv"}), {"holds its distances itself"});
  expect_refused(check(proof_, {"--mesh", mesh_, "--pose", "0,0,1,1,0,0,0"}), {"not with --pose"});
  expect_refused(check(forged("/units", "cm"), {"--mesh", mesh_}), {"units = \"cm\""});
  json fewer = document();
  fewer["vertices"].erase(0);
  expect_refused(check(write("fewer.json", fewer.dump()), {"--mesh", mesh_}), {"is of 17 vertices and 32 triangles"});
  expect_refused(check(forged("/triangles/0/pieces", "x"), {"--mesh", mesh_}),
                 {"triangles[0].pieces", "letters c, h and ."});
  expect_refused(check(forged("/triangles/0/pieces", "hcc"), {"--mesh", mesh_}), {"triangles[0]", "samples"});
  expect_refused(check(forged("/percentiles/0", 0), {"--mesh", mesh_}), {"percentiles[0] = 0: must be above 0"});
  expect_refused(check(forged("/surface/patches/0", "h"), {"--mesh", mesh_}),
                 {"surface.patches[0]", "letters a, r, o, w and ."});
  expect_refused(check(forged("/surface/patches/0", "o"), {"--mesh", mesh_}), {"surface.off", "must be 1 points"});
  expect_refused(check(forged("/surface/farthest/point/0", "inf"), {"--mesh", mesh_}), {"surface.farthest.point[0]"});
  expect_refused(check(forged("/from_model/mean", {{"lo", 0}, {"hi", 1}}), {"--mesh", mesh_}),
                 {"from_model", "percentiles"});
  expect_refused(check(forged("/from_model/percentiles", json::array()), {"--mesh", mesh_}),
                 {"from_model.percentiles", "must not be there without \"mean\""});
  expect_refused(check(forged("/surface/patches/0", "w........"), {"--mesh", mesh_}),
                 {"surface.patches", "must not have a w without \"on\""});
  json claim_alone = document();
  claim_alone.erase("surface");
  expect_refused(check(write("alone.json", claim_alone.dump()), {"--mesh", mesh_}),
                 {"from_model", "must not be there without \"surface\""});
}

TEST_F(CheckDeviation, OfACloudAndAModelThatWasMoved) {
  const std::string points = write("points.csv", "2,0,0\n0,3,0\n");
  const Outcome made = deviation({"--points", points, "--pose", "0,0,1,1,0,0,0", "--certificate-file", proof_});
  EXPECT_EQ(made.status, 0) << made.err;
  const Outcome outcome = check(proof_, {"--points", points});
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("claims               4\n  proved             4\n"));
  EXPECT_THAT(outcome.out, HasSubstr("model moved by       0,0,1,1,0,0,0"));
  EXPECT_THAT(outcome.out, HasSubstr("not claimed          how far the model's surface lies from the points\n"));
  const Outcome both = deviation(
      {"--points", points, "--both-ways", "--pose", "0,0,1,1,0,0,0", "--certificate-file", proof_, "--tol", "1%"});
  EXPECT_EQ(both.status, 0) << both.err;
  EXPECT_THAT(both.out, HasSubstr("\n  both ways "));
  const Outcome checked = check(proof_, {"--points", points});
  EXPECT_EQ(checked.status, 0) << checked.err << checked.out;
  EXPECT_THAT(checked.out, HasSubstr("claims               6\n  proved             6\n"));
  EXPECT_THAT(checked.out, HasSubstr("proved   model to points, largest: ["));
}

TEST_F(CheckDeviation, NothingIsLostWhereAFileCannotBe) {
  expect_refused(deviation({"--mesh", mesh_, "--certificate-file", "c.txt"}), {"is a .json"});
  expect_refused(deviation({"--mesh", mesh_, "--certificate-file", model_}), {"--certificate-file", "ball.json"});
  expect_refused(deviation({"--mesh", mesh_, "--certificate-file", "c.json", "--time-limit", "9"}), {"--time-limit"});
}

/// Landmarks are all that features need.
TEST_F(CheckDeviation, FeaturesAreProvedByTheirLandmarks) {
  const Outcome made = run({"features", "--landmarks", places::example("femur_landmarks.json"), "--landmark-radius",
                            "1", "--certificate-file", proof_});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto checked = [&](const std::string& proof) { return run({"check", "--certificate", proof}); };
  const Outcome outcome = checked(proof_);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("claims               12\n  proved             12\n"));
  EXPECT_THAT(outcome.out, HasSubstr("is not proved, but for you to see\n"));
  EXPECT_EQ(checked(forged("/features/1/hi", 100.0)).status, 3);
  EXPECT_EQ(checked(forged("/landmarks/head_centre/0", 1.0)).status, 3);
  EXPECT_EQ(checked(forged("/frame/y/tilt_degrees", 0.0)).status, 3);
  EXPECT_EQ(checked(forged("/features/0/lo", "-inf")).status, 3);
  expect_refused(checked(forged("/units", "cm")), {"units = \"cm\": must be \"mm\""});
  expect_refused(checked(forged("/side", "both")), {"side = \"both\""});
  expect_refused(checked(forged("/implant", json::object())), {"models = []: must be one model"});
  expect_refused(run({"check", "--certificate", proof_, "--model", model_}), {"is of no implant, and of no model"});
}

}  // namespace
}  // namespace verisq::testing
