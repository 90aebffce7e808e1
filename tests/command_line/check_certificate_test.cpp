/// `verisq distance --certificate-file` and `verisq check --certificate` as their users meet them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <thread>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::AnyOf;
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

  std::string a_ = places::example("stem.json");
  std::string b_ = places::example("gem.json");
  std::string proof_ = path("proof.json");
};

TEST_F(CheckCertificate, ProvesTheAnswer) {
  const Outcome outcome = check(proof_);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("verdict            proved\n"));
  const Outcome alone =
      Process({places::check_program(), "--certificate", proof_, "--model", a_, "--model", b_, "--json"},
              folder_.path())
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

TEST_F(CheckCertificate, DoesNotJudgeOnceOutOfTime) {
  const Outcome outcome = check(proof_, {"--time-limit", "1e-9", "--json"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_TRUE(json["verdict"].is_null());
  EXPECT_EQ(json["interrupted"], true);
  EXPECT_THAT(check(proof_, {"--time-limit", "1e-9"}).out, HasSubstr("verdict            not judged\n"));
}

TEST_F(CheckCertificate, IsOfNoOtherModel) {
  expect_refused(run({"check", "--certificate", proof_, "--model", b_, "--model", a_}),
                 {"gem.json: ", "is about another model: its SHA-256 is "});
  expect_refused(run({"check", "--certificate", proof_, "--model", a_}), {"is about 2 models"});
  expect_refused(check(forged("/units", "km")), {"units = \"km\"", "not those of the models"});
  expect_refused(check(forged("/models/1/sha256", std::string(64, '0'))), {"gem.json: ", "another model"});
}

TEST_F(CheckCertificate, NamesOptionsThatDoNotFit) {
  expect_refused(check(proof_, {"--map", "map.csv"}), {"is of two models, not of a map"});
  expect_refused(check(proof_, {"--surface-map", "map.csv"}), {"is of two models, not of a map"});
  expect_refused(check(proof_, {"--octree", "o.vtu"}), {"--octree: not with --map or --certificate"});
  expect_refused(check(proof_, {"--mesh", "bone.off"}), {"--mesh: only with --map"});
  expect_refused(run({"check", "--model", a_, "--model", b_, "--map", "map.csv", "--points", "p.csv"}),
                 {"--model: give one"});
  const auto refused_of_many = [&](const Arguments& more, const std::string& words) {
    Arguments arguments{"distance", a_, b_, "--poses", "p.csv", "-o", "d.csv", "--certificate-file", "c.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_refused(run(arguments), {words});
  };
  refused_of_many({"--device", "0"}, "the host's distances alone have certificates, not those of --device 0");
  refused_of_many({"--part", "1/2"}, "--certificate-file: not with --part");
  refused_of_many({"--rotation-error", "1"}, "--certificate-file: of exact places only");
  expect_refused(run({"distance", a_, b_, "--poses", "p.csv", "-o", "d.json", "--certificate-file", "d.json"}),
                 {"is the name of two outputs"});
  expect_refused(run({"distance", a_, b_, "--poses", "/dev/null", "-o", "d.csv", "--certificate-file", "c.json"}),
                 {"--certificate-file: /dev/null: is read twice: give a regular file"});
  const std::string poses = write("p.csv", "0,0,5,1,0,0,0\n");
  expect_refused(run({"distance", a_, b_, "--poses", poses, "-o", "d.csv", "--certificate-file", poses}),
                 {"--certificate-file", "p.csv"});
  expect_refused(run({"distance", a_, b_, "--certificate-file", a_}), {"--certificate-file", "stem.json"});
}

/// Bends and a difference: planes between sections decide.
TEST_F(CheckCertificate, ProvesDistancesOfBentModels) {
  const std::string bent = places::example("bent_stem.json");
  const Outcome made = run(
      {"distance", bent, bent, "--pose", "0.085,0.02,0,1,0.2,0.1,0.05", "--certificate", "--certificate-file", proof_});
  EXPECT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("\ncertified          [0.0191257"));
  EXPECT_THAT(made.out, HasSubstr("certificate        primitives 0 and 0: "));
  const Outcome proved = run({"check", "--certificate", proof_, "--model", bent, "--model", bent});
  EXPECT_EQ(proved.status, 0) << proved.err;
  EXPECT_THAT(proved.out, StartsWith("verdict            proved\n"));
  const Outcome nearer =
      run({"check", "--certificate", forged("/distance/hi", 0.0191257), "--model", bent, "--model", bent});
  EXPECT_EQ(nearer.status, 3);
  EXPECT_THAT(nearer.out, StartsWith("verdict            refuted\n"));
}

/// A neck beside the rim of a bored ball: cubes decide, and what they find has no certificate.
TEST_F(CheckCertificate, ClaimsNoMoreThanItProves) {
  const std::string cup = write("cup.json", R"({"format": "verisq-model/1", "primitives": [
    {"name": "ball", "superquadric": {"semi_axes": [28, 28, 28], "exponents": [1, 1]}},
    {"name": "bore", "superquadric": {"semi_axes": [16, 16, 40], "exponents": [0.1, 1]}}],
    "csg": {"difference": ["ball", "bore"]}})");
  const std::string neck = write("neck.json", R"({"format": "verisq-model/1", "primitives": [
    {"name": "neck", "superquadric": {"semi_axes": [6, 6, 40], "exponents": [0.3, 1]},
     "bend": {"curvature": 0.001, "angle_deg": 0}}]})");
  const Outcome made = run({"distance", cup, neck, "--tol", "0.1", "--certificate-file", proof_});
  EXPECT_EQ(made.status, 3) << made.err;
  EXPECT_THAT(made.err, HasSubstr("the certificate proves less than was found, [0, "));
  const Outcome proved = run({"check", "--certificate", proof_, "--model", cup, "--model", neck});
  EXPECT_EQ(proved.status, 0) << proved.err;
  EXPECT_THAT(proved.out, HasSubstr("\n  claimed          [0, "));
}

/// Random poses, of which some let the models meet.
class CheckManyPoses : public CheckCertificate {
 protected:
  static constexpr int poses = 60;

  CheckManyPoses() {
    std::mt19937_64 generator(11);
    std::uniform_real_distribution<double> coordinate(-3.0, 3.0);
    std::string text;
    for (int i = 0; i < poses; ++i) {
      const double nearness = i % 5 == 0 ? 0.1 : 1.0;  // a fifth meets
      for (int k = 0; k < 7; ++k) text += fmt::format("{}{}", k == 0 ? "" : ",", nearness * coordinate(generator));
      text += "\n";
    }
    const Outcome outcome =
        run({"distance", a_, b_, "--poses", write("poses.csv", text), "-o", rows_, "--certificate-file", many_});
    EXPECT_THAT(outcome.status, AnyOf(0, 3)) << outcome.err;  // 3: some touch
  }

  [[nodiscard]] nlohmann::json document() const {
    std::ifstream in(many_);
    return nlohmann::json::parse(in);
  }

  /// Of what a document says of how many answers are proved.
  [[nodiscard]] int proved(const nlohmann::json& forged) const {
    const Outcome outcome = check(write("forged.json", forged.dump()), {"--json"});
    EXPECT_THAT(outcome.status, AnyOf(0, 3)) << outcome.err;
    const auto object = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(outcome.status == 0, object["proved"] == forged["answers"].size());
    EXPECT_EQ(object["first"].is_null(), outcome.status == 0);
    return object["proved"].get<int>();
  }

  std::string rows_ = path("rows.csv");
  std::string many_ = path("many.json");
};

TEST_F(CheckManyPoses, ProvesTheRowsOfTheMap) {
  const Outcome outcome = check(many_);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith(fmt::format("poses              {}\n  proved           {}\n", poses, poses)));
  const Outcome alone =
      Process({places::check_program(), "--certificate", many_, "--model", a_, "--model", b_, "--json"}, folder_.path())
          .wait();
  EXPECT_EQ(alone.status, 0) << alone.err;
  EXPECT_EQ(nlohmann::json::parse(alone.out)["proved"], poses);

  std::istringstream rows(contents(rows_));
  std::string line;
  std::getline(rows, line);
  const nlohmann::json answers = document()["answers"];
  int meeting = 0;
  for (std::size_t i = 0; i < poses; ++i) {
    ASSERT_TRUE(std::getline(rows, line));
    const auto& distance = answers[i]["distance"];
    EXPECT_THAT(line,
                StartsWith(fmt::format("{},{},{},", i, distance["lo"].get<double>(), distance["hi"].get<double>())));
    meeting += distance["hi"] == 0.0 ? 1 : 0;
  }
  EXPECT_GT(meeting, 0);
  EXPECT_LT(meeting, poses / 2);
}

TEST_F(CheckManyPoses, NeverProvesAForgery) {
  const nlohmann::json truth = document();
  int tried = 0;
  for (std::size_t i = 0; i < poses; ++i) {
    const double lo = truth["answers"][i]["distance"]["lo"];
    const double hi = truth["answers"][i]["distance"]["hi"];
    const bool apart = lo > 0.0;
    nlohmann::json all = truth;
    all["answers"].clear();
    const auto forge = [&](const std::string& pointer, const nlohmann::json& value) {
      nlohmann::json answer = truth["answers"][i];
      answer[nlohmann::json::json_pointer(pointer)] = value;
      all["answers"].push_back(answer);
    };
    const double past = 1e-12 * std::max(1.0, hi);
    forge("/distance/hi", lo - past);
    forge("/distance/lo", hi + past);
    forge("/distance", {{"lo", hi + past}, {"hi", hi + 2.0 * past}});
    if (apart) {
      forge("/distance", {{"lo", lo - 2.0 * past}, {"hi", lo - past}});
      forge("/distance", {{"lo", 0.0}, {"hi", 0.0}});
      forge("/proof/separations", nlohmann::json::array());
      forge("/proof/separations/0/vector", {0.0, 0.0, 0.0});
      forge("/proof/common", truth["answers"][i]["proof"]["separations"][0]["on_a"]);
      all["answers"].back()["distance"] = {{"lo", 0.0}, {"hi", 0.0}};
    }
    // Another place: farther by more than the claim is wide, along whatever leads away.
    for (int k = 0; k < 3; ++k) {
      const double t = truth["answers"][i]["pose"]["translation"][k];
      forge(fmt::format("/pose/translation/{}", k), t + (t > 0.0 ? 40.0 : -40.0));
    }
    tried += static_cast<int>(all["answers"].size());
    EXPECT_EQ(proved(all), 0) << i << all.dump(1);
  }
  EXPECT_GT(tried, 400);
}

TEST_F(CheckManyPoses, SaysWhichIsFirst) {
  nlohmann::json forged = document();
  forged["answers"][3]["proof"] = {{"separations", nlohmann::json::array()}};
  forged["answers"][7]["distance"] = {{"lo", 100.0}, {"hi", 101.0}};
  const Outcome outcome = check(write("forged.json", forged.dump()));
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr(fmt::format("  proved           {}\n  refuted          1\n  unproved         1\n", poses - 2)));
  EXPECT_THAT(outcome.out, HasSubstr("first refuted pose, index 7, "));
  EXPECT_THAT(outcome.out, HasSubstr(": lo is wrong: "));
}

TEST_F(CheckManyPoses, IsOfNoOtherModel) {
  expect_refused(run({"check", "--certificate", many_, "--model", b_, "--model", a_}), {"is about another model"});
}

/// A pipe gives other bytes to each reading: the digest must be that of the bytes that are parsed.
TEST_F(CheckCertificate, ReadsAModelOnce) {
  const std::string pipe = path("pipe.json");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::ifstream model(a_);
  const std::string honest{std::istreambuf_iterator<char>(model), {}};
  std::jthread writer([&] { std::ofstream(pipe) << honest; });
  const Outcome outcome = run({"check", "--certificate", proof_, "--model", pipe, "--model", b_});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("verdict            proved\n"));
}

}  // namespace
}  // namespace verisq::testing
