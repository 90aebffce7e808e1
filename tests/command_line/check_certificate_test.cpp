/// `verisq distance --certificate-file` and `verisq check --certificate` as their users meet them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class CheckCertificate : public ProgramTest {
 protected:
  CheckCertificate() {
    const Outcome outcome = run({"distance", a_, b_, "--pose", "3,0,0.1,1,0.1,0,0", "--certificate-file", proof_});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }

  [[nodiscard]] Outcome check(const std::string& certificate, Arguments more = {}) const {
    Arguments arguments{"check", "--certificate", certificate, "--model", a_, "--model", b_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  /// The certificate with another value at `pointer`.
  [[nodiscard]] std::string forged(const std::string& pointer, const nlohmann::json& value) const {
    std::ifstream in(proof_);
    nlohmann::json document = nlohmann::json::parse(in);
    document[nlohmann::json::json_pointer(pointer)] = value;
    return write("forged.json", document.dump());
  }

  std::string a_ = VERISQ_EXAMPLES "/stem.json";
  std::string b_ = VERISQ_EXAMPLES "/gem.json";
  std::string proof_ = path("proof.json");
};

TEST_F(CheckCertificate, ProvesTheAnswer) {
  const Outcome outcome = check(proof_);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("verdict            proved\n"));
  const Outcome alone =
      Process({VERISQ_CHECK_PROGRAM, "--certificate", proof_, "--model", a_, "--model", b_, "--json"}, folder_.path())
          .wait();
  EXPECT_EQ(alone.status, 0) << alone.err;
  const auto object = nlohmann::json::parse(alone.out);
  EXPECT_EQ(object["kind"], "pair");
  EXPECT_EQ(object["verdict"], "proved");
  EXPECT_TRUE(object["reason"].is_null());
  EXPECT_GE(object["proven"]["lo"], object["claimed"]["lo"]);
  EXPECT_LE(object["proven"]["hi"], object["claimed"]["hi"]);
}

TEST_F(CheckCertificate, RefutesWhatIsFalse) {
  const Outcome outcome = check(forged("/distance", {{"lo", 0.0}, {"hi", 1e-3}}), {"--json"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  const auto object = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(object["verdict"], "refuted");
  EXPECT_THAT(object["reason"].get<std::string>(), HasSubstr("hi is wrong"));
}

TEST_F(CheckCertificate, LeavesOpenWhatIsNotProved) {
  const Outcome outcome = check(forged("/proof/separations", nlohmann::json::array()));
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("verdict            unproved\n  reason           the certificate "));
}

TEST_F(CheckCertificate, IsOfNoOtherModel) {
  expect_refused(run({"check", "--certificate", proof_, "--model", b_, "--model", a_}),
                 {"gem.json: ", "is about another model: its SHA-256 is "});
  expect_refused(run({"check", "--certificate", proof_, "--model", a_}), {"is about 2 models"});
  expect_refused(check(forged("/units", "km")), {"units = \"km\"", "not those of the models"});
  expect_refused(check(forged("/models/1/sha256", std::string(64, '0'))), {"gem.json: ", "another model"});
}

TEST_F(CheckCertificate, NamesOptionsThatDoNotFit) {
  expect_refused(check(proof_, {"--map", "map.csv"}), {"give either --map or --certificate"});
  expect_refused(check(proof_, {"--mesh", "bone.off"}), {"--mesh: only with --map"});
  expect_refused(run({"check", "--model", a_, "--model", b_, "--map", "map.csv", "--points", "p.csv"}),
                 {"--model: give one"});
  expect_refused(run({"distance", a_, b_, "--poses", "p.csv", "-o", "d.csv", "--certificate-file", "c.json"}),
                 {"--certificate-file: distances for --poses have no certificates"});
  expect_refused(run({"distance", a_, b_, "--certificate-file", a_}), {"--certificate-file", "stem.json"});
  const std::string bent = VERISQ_EXAMPLES "/bent_stem.json";
  expect_refused(run({"distance", a_, bent, "--certificate-file", "c.json"}),
                 {"--certificate-file: ", "bent_stem.json"});
}

}  // namespace
}  // namespace verisq::testing
