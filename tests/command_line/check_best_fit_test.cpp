/// How good a fit can be at best is proved from the implants' files and the mesh, and no forgery of it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/proof_file_test.hpp"

namespace verisq::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class CheckBestFit : public ProofFileTest {
 protected:
  void SetUp() override {
    write_short_stem();
    found_ = fit({"-o", path("fitted.json"), "--bound", "40", "--bound-certificate-file", proof_, "--json"});
    ASSERT_TRUE(found_.status == 0 || found_.status == 3) << found_.err;
  }

  [[nodiscard]] Outcome fit(const Arguments& more) const {
    Arguments arguments{"fit",
                        "--implant",
                        stem_,
                        "--mesh",
                        mesh_,
                        "--any-side",
                        "--on",
                        "vertices",
                        "--completion",
                        "cemented",
                        "--translation-range",
                        "1",
                        "--rotation-range",
                        "1",
                        "--samples",
                        "16",
                        "--device",
                        "host",
                        "--no-progress"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  [[nodiscard]] Outcome check_of(const std::string& proof, const Arguments& more = {}) const {
    return checked(proof, {"--model", stem_, "--mesh", mesh_}, more);
  }

  void expect_not_proved(const std::string& pointer, const json& value) const {
    const Outcome outcome = check_of(forged(pointer, value));
    EXPECT_EQ(outcome.status, 3) << pointer << " " << value << outcome.out << outcome.err;
  }

  std::string mesh_ = places::example("cavity.off");
  std::string stem_ = path("stem.json");
  Outcome found_;
};

TEST_F(CheckBestFit, ProvesTheBoundOfTheFit) {
  const json said = json::parse(found_.out);
  EXPECT_EQ(said["bound_certificate_file"], proof_);
  const double claimed = document()["upper"];
  EXPECT_GE(claimed, said["objective"]["hi"].get<double>());
  EXPECT_LE(claimed, said["bound"]["upper"].get<double>() * (1.0 + 1e-2));
  const Outcome outcome = check_of(proof_);
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("proved               F of any pose that keeps the limit is at most "));
  EXPECT_THAT(
      outcome.out,
      HasSubstr("the range            moved by up to 1 mm along each axis, turned by a rotation vector of up to 1 "
                "degrees along each\n"));
  EXPECT_THAT(outcome.out, HasSubstr("the limit            no vertex deeper in the implant than 0 mm\n"));
  EXPECT_THAT(outcome.out,
              HasSubstr("area                 weight 1, 786 vertices, which the certificate names \"elsewhere\"\n"));
  const json object = json::parse(check_of(proof_, {"--json"}).out);
  EXPECT_EQ(object["kind"], "best_fit");
  EXPECT_EQ(object["verdict"], "proved");
  EXPECT_EQ(object["claimed"], claimed);
  EXPECT_EQ(object["no_pose_keeps_limit"], false);
  EXPECT_LE(object["proven"].get<double>(), claimed);
}

TEST_F(CheckBestFit, NeverProvesAForgery) {
  const double reached = json::parse(found_.out)["objective"]["lo"];
  expect_not_proved("/upper", reached * (1.0 - 1e-12));
  expect_not_proved("/upper", "-inf");
  expect_not_proved("/upper", 0.0);
  expect_not_proved("/areas/0/weight", 1.01 * document()["upper"].get<double>() / reached);
  expect_not_proved("/ranges/0", ".x");
  expect_not_proved("/ranges/0", "");
  expect_not_proved("/ranges/0", document()["ranges"][0].get<std::string>() + ".");
}

TEST_F(CheckBestFit, IsOfNoOtherModelMeshOrTerms) {
  const auto refused = [&](const Outcome& outcome, const std::string& words) {
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  refused(check_of(forged("/models/0/sha256", std::string(64, '0'))), "is about another model");
  refused(check_of(forged("/mesh/sha256", std::string(64, '0'))), "is about another mesh");
  refused(check_of(forged("/area_runs", {{0, 100}})), "are of 100 vertices, and the mesh has 786");
  refused(check_of(forged("/units", "cm")), "are not those of the models, \"mm\"");
  refused(check_of(forged("/range/translation", -1.0)), "must be at least 0");
  refused(check_of(forged("/upper", "inf")), "must be a number, or \"-inf\"");
  refused(check_of(proof_, {"--map", mesh_}), "not of the one of a map");
  refused(check_of(proof_, {"--model", stem_}), "is of 1 implants");
  refused(run({"check", "--model", stem_, "--certificate", proof_}), "give the --mesh");
  refused(fit({"-o", path("fitted.json"), "--bound-certificate-file", proof_}), "give the --bound that it is of");
}

}  // namespace
}  // namespace verisq::testing
