/// `verisq batch`: a cohort of known answers, with broken cases, interrupted and resumed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;

/// A case whose smallest distance is known: a ball, or a box with round edges, above a mesh of which one vertex is the
/// nearest.
struct KnownCase {
  std::string name;
  double truth;
  bool broken = false;
};

class BatchCommand : public ProgramTest {
 protected:
  /// `count` cases in a manifest; every fortieth, five of 200, is broken, each in another way.
  [[nodiscard]] std::vector<KnownCase> cohort(std::size_t count) const {
    std::mt19937_64 generator(11);
    std::uniform_real_distribution<double> size(1.0, 20.0);
    std::uniform_real_distribution<double> gap(-0.5, 30.0);
    std::vector<KnownCase> cases;
    std::string manifest = "case,command,model,mesh,tol,pose,a,b\n";
    for (std::size_t i = 0; i < count; ++i) {
      KnownCase known{.name = "bone_" + std::to_string(i), .truth = 0.0};
      const double radius = size(generator);
      const bool pair = i % 4 == 3;
      // Along z a superquadric of any exponents is as high as its semi-axis, and its top is the nearest point there.
      const double exponent = i % 2 == 0 ? 1.0 : 0.4 + 0.1 * static_cast<double>(i % 7);
      const nlohmann::json solid{{"semi_axes", {radius, radius, radius}}, {"exponents", {exponent, exponent}}};
      (void)write(known.name + ".json", nlohmann::json{{"format", "verisq-model/1"},
                                                       {"units", "mm"},
                                                       {"primitives", {{{"name", "solid"}, {"superquadric", solid}}}}}
                                            .dump());
      known.truth = std::max(gap(generator), i % 2 == 0 ? -0.5 : 0.25);  // depths are known of balls
      if (pair) {
        manifest += known.name + ",distance,,,,\"0,0," + number(2 * radius + known.truth) + ",1,0,0,0\"," + known.name +
                    ".json," + known.name + ".json\n";
        known.truth = (2 * radius + known.truth) - 2 * radius;
      } else {
        known.truth = mesh_above(known.name + ".off", radius, known.truth);
        manifest += known.name + ",," + known.name + ".json," + known.name + ".off,1e-6,,,\n";
      }
      known.broken = i % 40 == 17;
      if (known.broken) break_case(known.name, (i / 40) % 5);
      cases.push_back(known);
    }
    (void)write("cohort.csv", manifest);
    return cases;
  }

  [[nodiscard]] static std::string number(double value) {
    std::ostringstream text;
    text.precision(17);
    text << value;
    return text.str();
  }

  /// A tent below the solid whose top is the nearest; returns the distance of the top.
  [[nodiscard]] double mesh_above(const std::string& name, double radius, double distance) const {
    const double top = -(radius + distance);
    std::string off = "OFF\n7 6 0\n0 0 " + number(top) + "\n";
    for (int k = 0; k < 6; ++k) {
      off += number(2.0 * std::cos(k)) + " " + number(2.0 * std::sin(k)) + " " + number(-3.0 * radius - 40.0) + "\n";
    }
    for (int k = 0; k < 6; ++k) off += "3 0 " + std::to_string(1 + k) + " " + std::to_string(1 + (k + 1) % 6) + "\n";
    (void)write(name, off);
    return -top - radius;
  }

  void break_case(const std::string& name, std::size_t way) const {
    switch (way) {
      case 0: std::filesystem::remove(path(name + ".json")); break;
      case 1: (void)write(name + ".json", "{ \"format\": \"verisq-model/1\" "); break;
      case 2: (void)write(name + ".json", R"({"format": "verisq-model/1", "primitives": []})"); break;
      case 3: (void)write(name + ".off", "OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n"); break;
      default: (void)write(name + ".off", ""); break;
    }
  }

  [[nodiscard]] Outcome batch(const std::string& output, const Arguments& more = {}) const {
    Arguments arguments{"batch", path("cohort.csv"), "-o", path(output), "--jobs", "2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  [[nodiscard]] std::string table(const std::string& output) const { return contents(path(output) + "/summary.csv"); }
};

TEST_F(BatchCommand, EveryAnswerContainsTheTruthAndBrokenCasesAreReported) {
  const std::vector<KnownCase> cases = cohort(200);
  const Outcome outcome = batch("whole", {"--json"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json.at("cases"), 200);
  EXPECT_EQ(json.at("failed"), 5);
  EXPECT_EQ(json.at("not_run"), 0);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto& result = json.at("results").at(i);
    EXPECT_EQ(result.at("case"), cases[i].name);
    EXPECT_EQ(result.at("outcome") == "failed", cases[i].broken) << result;
    if (cases[i].broken) {
      EXPECT_THAT(result.at("message").get<std::string>(), HasSubstr(cases[i].name));
      continue;
    }
    // Of balls and tops that are balls' the truth is what the binary64 inputs state, to rounding of the numbers above.
    const auto& distance = result.at("smallest_distance");
    EXPECT_LE(distance.at("lo").get<double>(), cases[i].truth + 1e-12) << result;
    EXPECT_GE(distance.at("hi").get<double>(), cases[i].truth - 1e-12) << result;
    EXPECT_LE(distance.at("hi").get<double>() - distance.at("lo").get<double>(), 1e-4);
  }
  const std::string page = contents(path("whole/overview.html"));
  EXPECT_THAT(page, HasSubstr("200 cases: 195 verified, 0 wide, 5 failed"));
  EXPECT_THAT(page, ::testing::Not(HasSubstr("http://")));

  // Interrupted by Ctrl-C, then killed, then to the end: the same table.
  const Outcome interrupted = run_interrupted({"batch", path("cohort.csv"), "-o", path("resumed")});
  EXPECT_THAT(interrupted.err, interrupted.status == 130 ? HasSubstr("the same command goes on") : HasSubstr(""));
  const Process killed = start({"batch", path("cohort.csv"), "-o", path("resumed")});
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  killed.send(SIGKILL);
  EXPECT_EQ(killed.wait().status, 128 + SIGKILL);
  const Outcome resumed = batch("resumed");
  EXPECT_EQ(resumed.status, 3) << resumed.err;
  EXPECT_THAT(resumed.out, HasSubstr("of an earlier run"));
  EXPECT_EQ(table("resumed"), table("whole"));
}

TEST_F(BatchCommand, RunsAgainWhatHasChanged) {
  (void)cohort(3);
  EXPECT_EQ(batch("out").status, 0);
  EXPECT_THAT(batch("out").out, HasSubstr("taken over         3 of an earlier run\n"));
  (void)write("bone_1.json", contents(path("bone_1.json")) + "\n");
  EXPECT_THAT(batch("out").out, HasSubstr("taken over         2 of an earlier run\n"));
  (void)write("out/cases/bone_0.json", "{\"format\"");
  EXPECT_THAT(batch("out").out, HasSubstr("taken over         2 of an earlier run\n"));
}

TEST_F(BatchCommand, TakesCommandsWithoutSummaryForFailuresAndComparesOneUnitAlone) {
  (void)cohort(3);
  (void)write("metres.json", R"({"format": "verisq-model/1", "units": "m", "primitives": [{"name": "ball",
      "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}}]})");
  (void)write("cohort.csv",
              "case,command,model,mesh\none,map,bone_0.json,bone_0.off\nother,,metres.json,bone_0.off\n"
              "help,help,,\nnone,nonsense,,\n");
  const Outcome outcome = batch("out", {"--json"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json.at("failed"), 2);
  EXPECT_FALSE(json.contains("nearest"));
  EXPECT_THAT(contents(path("out/overview.html")), HasSubstr("several units"));
}

/// Each takes --json and --no-progress, which batches give; the byte order mark is a spreadsheet's.
TEST_F(BatchCommand, RunsFeatures) {
  (void)write("cohort.csv",
              "\xEF\xBB\xBF"
              "case,command,landmarks,landmark-radius\nbone,features," +
                  places::example("femur_landmarks.json") + ",1\n");
  const Outcome outcome = batch("out", {"--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out).at("failed"), 0);
}

TEST_F(BatchCommand, ReadsQuotesAndFlags) {
  (void)cohort(1);
  (void)write("cohort.csv",
              "case,command,model,mesh,closest-points,translation-error,tol,output\n"
              "near,map,bone_0.json,bone_0.off,yes,,1e-6,\n"
              "uncertain,,bone_0.json,bone_0.off,no,\"0.5,0.5,0.25\",9,rows.csv\n");
  const Outcome outcome = batch("out");
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(path("out/maps/near.npy")));
  EXPECT_TRUE(std::filesystem::exists(path("rows.csv")));
}

TEST_F(BatchCommand, RefusesBadManifests) {
  const auto refused = [&](const std::string& manifest, const std::vector<std::string>& words) {
    (void)write("cohort.csv", manifest);
    expect_refused(batch("out"), words);
  };
  refused("", {"cohort.csv", "empty"});
  refused("model,mesh\na,b\n", {"cohort.csv: line 1", "no column case"});
  refused("case,model,model\nx,a,b\n", {"cohort.csv: line 1", "'model' twice"});
  refused("case,json\nx,yes\n", {"cohort.csv: line 1", "'json'"});
  refused("case,model\n", {"cohort.csv", "no cases"});
  refused("case,model\nx,a\nx,b\n", {"cohort.csv: line 3", "case x is that of line 2"});
  refused("case,model\n../x,a\n", {"cohort.csv: line 2", "'../x'"});
  refused("case,model\nx\n", {"cohort.csv: line 2", "1 fields, and 2 columns"});
  refused("case,model\nx,\"a\n", {"cohort.csv: line 2", "a quote that does not end"});
  expect_refused(run({"batch", path("none.csv"), "-o", path("out")}), {"none.csv: no such file"});
}

}  // namespace
}  // namespace verisq::testing
