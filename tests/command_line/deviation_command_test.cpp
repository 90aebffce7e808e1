/// `verisq deviation` as its user meets it: summary, rows, refusals and exit status.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <verisq/files.hpp>

#include "tests/fixtures/program_test.hpp"
#include "tests/fixtures/sample_meshes.hpp"

namespace verisq::testing {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::json;

class DeviationCommand : public ProgramTest {
 protected:
  [[nodiscard]] std::string ball() const {
    return write("ball.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
      {"name": "ball", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}}]})");
  }
  [[nodiscard]] std::string sphere() const {
    write_mesh(path("sphere.off"), sphere_mesh(1));
    return path("sphere.off");
  }
  [[nodiscard]] Outcome deviation(Arguments arguments) const {
    arguments.insert(arguments.begin(), {"deviation", "--model", ball(), "--device", "host"});
    return run(arguments);
  }
};

TEST_F(DeviationCommand, SaysHowFarBothSurfacesLieApart) {
  const Outcome outcome = deviation({"--mesh", sphere(), "-o", path("rows.csv")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, StartsWith("vertices               18\n"
                                      "triangles              32\n"
                                      "both ways (Hausdorff)  [0."));
  for (const char* line :
       {"mesh to model\n  largest              [0.", "  95 %                 [0.",
        "model to mesh\n  largest              [0.", "vertices to model\n", "tolerance              5 %, reached\n"}) {
    EXPECT_THAT(outcome.out, HasSubstr(line));
  }
  EXPECT_THAT(outcome.out, HasSubstr("the model's boundary and the triangles as their binary64 corners state them\n"));
  const std::vector<Row> rows = rows_of(path("rows.csv"));
  ASSERT_EQ(rows.size(), 18U);
  for (const Row& row : rows) {
    EXPECT_LE(row.distance.lo, 1e-15);
    EXPECT_GE(row.distance.hi, -1e-15);
  }
}

TEST_F(DeviationCommand, SaysWhereAndOfTheModelsSurfaceWhatItIsAskedFor) {
  const Outcome outcome = deviation({"--mesh", sphere(), "--json", "--tol", "50%", "--parts", "4"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const Json summary = Json::parse(outcome.out);
  ASSERT_EQ(summary["mesh_to_model_by_region"].size(), 4U);
  std::size_t triangles = 0;
  double largest = 0.0;
  for (const Json& part : summary["mesh_to_model_by_region"]) {
    triangles += part["triangles"].get<std::size_t>();
    largest = std::max(largest, part["largest"]["hi"].get<double>());
  }
  EXPECT_EQ(triangles, 32U);
  EXPECT_EQ(largest, summary["mesh_to_model"]["largest"]["hi"]);
  EXPECT_FALSE(summary["model_to_mesh"].contains("mean")) << "not asked for";
  const Outcome both = deviation({"--mesh", sphere(), "--statistics-of-model", "--tol", "0.2", "--parts", "2"});
  EXPECT_THAT(both.out, ContainsRegex("mesh to model by region\n  region               largest .*, mean .*: \"0 to "));
  EXPECT_THAT(both.out.substr(both.out.find("model to mesh\n")), HasSubstr("  mean  "));
  expect_refused(deviation({"--mesh", sphere(), "--parts", "2", "--landmarks", "l.json"}), {"--parts and --landmarks"});
  const std::string headless = write("l.json", R"({"format": "verisq-landmarks/1", "landmarks": {}})");
  expect_refused(deviation({"--mesh", sphere(), "--landmarks", headless}), {"l.json: landmarks: regions need"});
}

TEST_F(DeviationCommand, PrintsJson) {
  const Outcome outcome =
      deviation({"--mesh", sphere(), "--json", "--tol", "0.01", "--percentile", "90", "--png", path("sphere.png")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(json["vertices"], 18);
  EXPECT_EQ(json["units"], "mm");
  EXPECT_EQ(json["tolerance"], 0.01);
  EXPECT_TRUE(json["relative_tolerance"].is_null());
  EXPECT_TRUE(json["to_tolerance"]);
  for (const char* direction : {"mesh_to_model", "model_to_mesh"}) {
    EXPECT_LE(json[direction]["largest"]["lo"], json["hausdorff"]["lo"]);
    EXPECT_LE(json["hausdorff"]["hi"].get<double>() - json["hausdorff"]["lo"].get<double>(), 0.01);
  }
  EXPECT_EQ(json["mesh_to_model"]["percentiles"][0]["percent"], 90);
  EXPECT_TRUE(std::filesystem::exists(path("sphere.png")));
}

TEST_F(DeviationCommand, MeasuresPointsOneWayUnlessAskedForBoth) {
  const std::string points = write("points.csv", "2,0,0\n0,0.5,0\n");
  const Outcome one_way = deviation({"--points", points});
  EXPECT_EQ(one_way.status, 0) << one_way.err;
  EXPECT_THAT(one_way.out, HasSubstr("points to model\n"));
  EXPECT_THAT(one_way.out, HasSubstr("model to points        not asked for: --both-ways\n"));
  const Outcome both = deviation({"--points", points, "--both-ways", "--json"});
  EXPECT_EQ(both.status, 0) << both.err;
  EXPECT_GT(Json::parse(both.out)["model_to_points"]["largest"]["lo"], 1.4);
}

TEST_F(DeviationCommand, EndsAtATimeLimitWithWhatIsProven) {
  const Outcome outcome = deviation({"--mesh", sphere(), "--time-limit", "1e-9"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(outcome.err, "verisq: the limit is reached; enclosures are valid, and some are wide\n");
  EXPECT_THAT(outcome.out, HasSubstr("not reached by all\n"));
}

TEST_F(DeviationCommand, RefusesWhatItCannotMeasure) {
  const std::string empty = write("empty.off", "");
  const std::string faceless = write("faceless.off", "OFF\n1 0 0\n0 0 0\n");
  const std::string broken = write("broken.off", "OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n");
  expect_refused(deviation({"--mesh", empty}), {"empty.off"});
  expect_refused(deviation({"--mesh", faceless}), {"faceless.off"});
  expect_refused(deviation({"--mesh", broken}), {"broken.off", "nan"});
  expect_refused(deviation({}), {"give either --mesh or --points"});
  expect_refused(deviation({"--mesh", faceless, "--tol", "0"}), {"--tol", "0"});
  expect_refused(deviation({"--mesh", faceless, "--tol", "5 mm"}), {"--tol", "5 mm"});
  expect_refused(deviation({"--mesh", faceless, "--percentile", "101"}), {"--percentile", "101"});
  expect_refused(deviation({"--mesh", faceless, "--both-ways"}), {"--both-ways", "--points"});
  expect_refused(deviation({"--points", faceless, "--png", path("a.png")}), {"--png", "--mesh"});
  expect_refused(deviation({"--mesh", faceless, "-o", faceless}), {"-o", "overwrite"});
  const std::string uncertain = write("uncertain.json", R"({"format": "verisq-model/1", "primitives": [
      {"name": "ball", "superquadric": {"semi_axes": [[1, 2], 1, 1], "exponents": [1, 1]}}]})");
  expect_refused(run({"deviation", "--model", uncertain, "--mesh", faceless}), {"uncertain.json", "semi_axes"});
}

}  // namespace
}  // namespace verisq::testing
