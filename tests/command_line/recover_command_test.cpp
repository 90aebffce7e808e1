/// `verisq recover` as its user meets it: results, messages and exit status.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/fixtures/program_test.hpp"
#include "verisq/distance.hpp"
#include "verisq/files.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;

class RecoverCommand : public ProgramTest {
 protected:
  [[nodiscard]] Outcome recover(Arguments arguments) const {
    arguments.insert(arguments.begin(), "recover");
    return run(arguments);
  }
  [[nodiscard]] std::string model() const { return (folder_ / "model.json").string(); }
  /// On the ellipsoid of semi-axes 3, 2, 1 about (5, 0, 0).
  [[nodiscard]] std::string ellipsoid() const {
    std::string text;
    for (int i = 0; i < 400; ++i) {
      const double z = (i + 0.5) / 200.0 - 1.0;
      const double angle = 2.399963229728653 * i;  // the golden angle spreads points evenly
      const double radius = std::sqrt(1.0 - z * z);
      text += fmt::format("{},{},{}\n", 5.0 + 3.0 * radius * std::cos(angle), 2.0 * radius * std::sin(angle), z);
    }
    return folder_.file("ellipsoid.csv", text).string();
  }
  /// The last of its faces may be missing.
  [[nodiscard]] std::string tetrahedron(std::size_t faces = 4) const {
    const std::string all = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    return folder_
        .file("tetrahedron.off",
              fmt::format("OFF\n4 {} 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n", faces) + all.substr(0, 8 * faces))
        .string();
  }
  void expect_refused(const Arguments& arguments, const std::string& message) const {
    const Outcome outcome = recover(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err, "verisq: " + message + "\n");
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(std::filesystem::exists(model()));
  }
};

TEST_F(RecoverCommand, WritesTheModelOfACloud) {
  const Outcome outcome = recover({"--points", ellipsoid(), "--units", "mm", "-o", model()});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, HasSubstr("estimated from samples, in mm, not proven\n"));
  EXPECT_THAT(outcome.out, HasSubstr("points             400\n"));
  const Model found = read_model(model());
  EXPECT_EQ(found.units, "mm");
  ASSERT_EQ(found.primitives.size(), 1U);
  const auto& axes = found.primitives[0].superquadric.semi_axes;
  EXPECT_NEAR(axes[0] * axes[1] * axes[2], 6.0, 1e-6);
  EXPECT_NEAR(found.primitives[0].pose.translation[0], 5.0, 1e-6);
}

/// As that of `deviation`, of the model that was just found.
TEST_F(RecoverCommand, DrawsTheMeshColouredByItsDistance) {
  const std::string page = (folder_ / "found.html").string();
  const std::string picture = (folder_ / "found.png").string();
  const Outcome outcome =
      recover({"--mesh", tetrahedron(), "--json", "--report", page, "--png", picture, "-o", model()});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["report"], page);
  EXPECT_EQ(json["png"], picture);
  EXPECT_THAT(folder_.contents("found.html"), HasSubstr("tetrahedron.off: deviation from model.json"));
  EXPECT_GT(std::filesystem::file_size(picture), 1000U);
}

TEST_F(RecoverCommand, DrawsProvenDeviationsOfMeshesAlone) {
  const std::string page = (folder_ / "found.html").string();
  expect_refused({"--points", ellipsoid(), "--report", page, "-o", model()}, "--report: give a --mesh to draw");
  expect_refused({"--mesh", tetrahedron(), "--no-proof", "--report", page, "-o", model()},
                 "--report: shows the proven deviation; leave out --no-proof");
  expect_refused({"--mesh", tetrahedron(), "--up", "0,0,1", "-o", model()},
                 "--up: give the --report or --png that it is for");
}

TEST_F(RecoverCommand, PrintsOneJsonObject) {
  const Outcome outcome = recover({"--points", ellipsoid(), "--outliers", "0", "--json", "-o", model()});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["primitives"], 1);
  EXPECT_EQ(json["points"], 400);
  EXPECT_EQ(json["stages"].size(), 1U);
  EXPECT_LT(json["stages"][0]["estimated_to_model"]["largest"], 1e-6);
  EXPECT_TRUE(json["stages"][0]["estimated_to_mesh"].is_null());
  EXPECT_EQ(json["deviation_reached"], true);
  EXPECT_EQ(json["interrupted"], false);
  EXPECT_EQ(json["output"], model());
}

TEST_F(RecoverCommand, SaysThatADeviationIsNotReached) {
  const Outcome outcome =
      recover({"--mesh", tetrahedron(), "--primitives", "1", "--deviation", "0.0001", "-o", model()});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(outcome.err, "verisq: --deviation 0.0001: is not reached\n");
  EXPECT_EQ(read_model(model()).primitives.size(), 1U);
}

TEST_F(RecoverCommand, ProvesThatTheModelLiesOutside) {
  const Outcome outcome = recover({"--mesh", tetrahedron(), "--outside", "--no-proof", "--json", "-o", model()});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["containment"]["asked"], "outside");
  EXPECT_EQ(json["containment"]["proven"], true);
  EXPECT_EQ(json["containment"]["triangles_proven"], 4);
  EXPECT_EQ(json["stages"].back()["containment"], "outside");
  const SignedDistance distance(read_model(model()));
  for (const Point& corner : {Point{0.0, 0.0, 0.0}, Point{1.0, 0.0, 0.0}, Point{0.0, 0.0, 1.0}})
    EXPECT_LT(distance(corner, 1e-6).hi, 0.0);
}

TEST_F(RecoverCommand, KeepsWhatProvesTheSideAgain) {
  for (const char* const side : {"--inside", "--outside"}) {
    const std::string certificate = (folder_ / "containment.json").string();
    const Outcome outcome = recover({"--mesh", tetrahedron(), side, "--primitives", "2", "--no-proof", "-o", model(),
                                     "--certificate-file", certificate});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const Arguments check{"check", "--certificate", certificate, "--mesh", tetrahedron(), "--model", model()};
    const Outcome proved = run(check);
    EXPECT_EQ(proved.status, 0) << proved.err;
    EXPECT_THAT(proved.out, ::testing::StartsWith("proved "));
    // The other claim of the same files is none that they prove.
    std::string forged = contents(certificate);
    const bool within = forged.find("within") != std::string::npos;
    forged.replace(forged.find(within ? "within" : "around"), 6, within ? "around" : "within");
    const Arguments check_of_forged{"check",  "--certificate", folder_.file("forged.json", forged).string(),
                                    "--mesh", tetrahedron(),   "--model",
                                    model(),  "--json"};
    const Outcome refused = run(check_of_forged);
    EXPECT_EQ(refused.status, 3);
    EXPECT_NE(nlohmann::json::parse(refused.out)["verdict"], "proved");
  }
}

TEST_F(RecoverCommand, RefusesWhatItCannotUse) {
  const std::string three = folder_.file("three.csv", "0,0,0\n1,0,0\n0,1,0\n").string();
  expect_refused({"-o", model()}, "give either --points or --mesh");
  expect_refused({"--points", three, "-o", model()},
                 three + ": 3 points are too few for a superquadric, which takes at least 12");
  std::string grid;
  for (int i = 0; i < 100; ++i) grid += fmt::format("{},{},0\n", i % 10, i / 10);
  const std::string flat = folder_.file("flat.csv", grid).string();
  expect_refused({"--points", flat, "-o", model()}, flat + ": all points lie in a plane, or nearly so");
  const std::string nan = folder_.file("nan.csv", "0,0,0\nnan,0,0\n").string();
  expect_refused({"--points", nan, "-o", model()}, nan + ": line 2: x = 'nan': not a finite number");
  expect_refused({"--points", three, "--outliers", "1", "-o", model()}, "--outliers: 1 is not from 0 to 0.9");
  expect_refused({"--points", three, "--inside", "-o", model()}, "--inside: needs a --mesh, whose solid it is about");
  expect_refused({"--mesh", three, "--inside", "--outside", "-o", model()}, "give --inside or --outside, not both");
  expect_refused({"--mesh", three, "-o", model(), "--certificate-file", "c.json"},
                 "--certificate-file: only with --inside or --outside");
  expect_refused({"--mesh", three, "--outside", "--bend", "-o", model(), "--certificate-file", "c.json"},
                 "--certificate-file: --outside is not certified with --bend");
  expect_refused({"--mesh", three, "--outside", "--bend", "--primitives", "2", "-o", model()},
                 "--outside: that a union has no cavities is proven of unbent primitives alone; with --bend give "
                 "--primitives 1");
  const std::string open = tetrahedron(3);
  expect_refused({"--mesh", open, "--outside", "-o", model()},
                 open + ": the mesh is not closed: nothing can be within or around it");
  expect_refused({"--mesh", three, "--outliers", "0.1", "-o", model()}, "--outliers: is for --points; a mesh has none");
}

TEST_F(RecoverCommand, EndsByATimeLimitWithTheBestModelSoFar) {
  const Outcome outcome = recover({"--points", ellipsoid(), "-o", model(), "--time-limit", "1e-9"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(outcome.err, "verisq: the time limit is reached; the best model so far is kept in " + model() + "\n");
  EXPECT_TRUE(std::filesystem::exists(model()));
}

}  // namespace
}  // namespace verisq::testing
