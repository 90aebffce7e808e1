/// `map` from and to streams and arrays: `-`, .npy, --format, --columns.
#include <gmock/gmock.h>

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string stem = places::example("stem.json");

class MapStreams : public ProgramTest {
 protected:
  /// As a shell runs it; in `command`, `map` is the program's, with the model, on the host.
  [[nodiscard]] Outcome shell(const std::string& command) const {
    const std::string program = places::program();
    const std::string definition = "map() { '" + program + "' map --device host --model '" + stem + "' \"$@\"; }\n";
    return Process({"/bin/sh", "-c", "cd '" + folder_.path().string() + "'\n" + definition + command}, folder_.path())
        .wait();
  }
  [[nodiscard]] Outcome map(Arguments arguments) const {
    arguments.insert(arguments.begin(), {"map", "--device", "host", "--model", stem});
    return run(arguments);
  }

  std::string points_ = write("points.csv", "x,y,z\n90,0,0.5\n0.5,1,-40\n0,0,0\n");
};

TEST_F(MapStreams, ReadsTheStandardInput) {
  EXPECT_EQ(shell("map --points points.csv -o file.csv").status, 0);
  const auto from_pipe = shell("cat points.csv | map --points - -o pipe.csv");
  EXPECT_EQ(from_pipe.status, 0) << from_pipe.err;
  EXPECT_EQ(contents(path("pipe.csv")), contents(path("file.csv")));
  EXPECT_EQ(shell("map --points - -o redirected.csv < points.csv").status, 0);
  EXPECT_EQ(contents(path("redirected.csv")), contents(path("file.csv")));
  // Whoever read before has read it.
  EXPECT_EQ(shell("{ read header; map --points - -o rest.csv; } < points.csv").status, 0);
  EXPECT_EQ(contents(path("rest.csv")), contents(path("file.csv")));
}

TEST_F(MapStreams, SaysWhatIsWrongWithTheStandardInput) {
  expect_refused(shell("map --points - -o map.csv < /dev/null"), {"standard input: the file is empty"});
  expect_refused(shell("printf '1,2,3\\n1,two,3\\n' | map --points - -o map.csv"),
                 {"standard input: line 2: y = 'two': not a number"});
  expect_refused(shell("map --points - -o map.csv <&-"), {"standard input: cannot be read"});
  EXPECT_FALSE(std::filesystem::exists(path("map.csv")));
}

TEST_F(MapStreams, WritesRowsToTheStandardOutputAndTheSummaryToTheOther) {
  EXPECT_EQ(map({"--points", points_, "-o", path("map.csv")}).status, 0);
  const auto outcome = map({"--points", points_, "-o", "-", "--json"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.out, contents(path("map.csv")));
  const auto summary = nlohmann::json::parse(outcome.err);
  EXPECT_EQ(summary.at("points"), 3);
  EXPECT_EQ(summary.at("output"), "-");
  EXPECT_THAT(map({"--points", points_, "-o", "-"}).err, StartsWith("points "));
  EXPECT_FALSE(std::filesystem::exists(path("-")));
}

TEST_F(MapStreams, AppendsToWhatAShellRedirects) {
  const auto outcome =
      shell("echo before > all; map --points points.csv -o - --columns index >> all; echo after >> all");
  EXPECT_EQ(contents(path("all")), "before\nindex\n0\n1\n2\nafter\n") << outcome.err;
}

TEST_F(MapStreams, TakesTheFormatByName) {
  EXPECT_EQ(map({"--points", points_, "-o", path("map.json")}).status, 0);
  EXPECT_EQ(map({"--points", points_, "-o", "-", "--format", "json"}).out, contents(path("map.json")));
  EXPECT_EQ(map({"--points", points_, "-o", path("no_extension"), "--format", "json"}).status, 0);
  EXPECT_EQ(contents(path("no_extension")), contents(path("map.json")));
}

/// From arrays to arrays, and what they hold is what text holds.
TEST_F(MapStreams, ArraysAreAsGoodAsText) {
  ASSERT_EQ(map({"--points", points_, "-o", path("map.npy")}).status, 0);
  ASSERT_EQ(map({"--points", points_, "-o", path("map.csv")}).status, 0);
  const std::string array = contents(path("map.npy"));
  EXPECT_THAT(array, HasSubstr("'shape': (3,), }"));
  const auto rows = rows_of(path("map.csv"));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Enclosure stored{};
    std::memcpy(&stored, array.data() + array.size() - 17 * (rows.size() - k), sizeof stored);
    EXPECT_EQ(stored, rows[k].distance);
  }
}

TEST_F(MapStreams, AnArrayOnAStreamNeedsTheNumberOfItsRows) {
  expect_refused(shell("cat points.csv | map --points - -o - --format npy"),
                 {"-: a .npy begins with the number of its rows, which is not known of such an input"});
  EXPECT_EQ(map({"--mesh", places::example("cavity.off"), "-o", path("map.npy"), "--tol", "1"}).status, 0);
  const auto outcome = map({"--mesh", places::example("cavity.off"), "-o", "-", "--format", "npy", "--tol", "1"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out, contents(path("map.npy")));
}

TEST_F(MapStreams, WritesTheColumnsAskedFor) {
  const auto outcome = map({"--points", points_, "-o", "-", "--columns", "z,status,index"});
  EXPECT_EQ(outcome.out, "z,status,index\n0.5,host-verified,0\n-40,host-verified,1\n0,host-verified,2\n");
  EXPECT_EQ(map({"--points", points_, "-o", "-", "--columns", "index,lo,hi,status"}).out,
            map({"--points", points_, "-o", "-"}).out);
}

TEST_F(MapStreams, WritesClosestPoints) {
  const std::string ball = write("ball.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
    {"name": "near", "superquadric": {"semi_axes": [4, 4, 4], "exponents": [1, 1]}},
    {"name": "far", "superquadric": {"semi_axes": [4, 4, 4], "exponents": [1, 1]}, "pose": {"translation": [0, 32, 0]}}]})");
  const std::string points = write("above.csv", "8,0,0\n0,40,0\n0,16,0\n");
  const auto outcome = run({"map", "--device", "host", "--model", ball, "--points", points, "-o", "-", "--columns",
                            "lo,closest,normal,primitive,unique", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out,
            "lo,closest_x_lo,closest_x_hi,closest_y_lo,closest_y_hi,closest_z_lo,closest_z_hi,normal_x_lo,normal_x_hi,"
            "normal_y_lo,normal_y_hi,normal_z_lo,normal_z_hi,primitive,unique\n"
            "4,4,4,0,0,0,0,1,1,0,0,0,0,0,1\n"
            "4,0,0,36,36,0,0,0,0,1,1,0,0,1,1\n"
            "12,0,0,4,28,0,0,0,0,-1,1,0,0,-1,0\n");
  const auto summary = nlohmann::json::parse(outcome.err);
  EXPECT_EQ(summary["unique_closest_points"], 2);
  EXPECT_EQ(summary["widest_closest_point"], 0.0);
}

TEST_F(MapStreams, RefusesClosestPointsOfWhatHasNone) {
  const auto refused = [&](const Arguments& more, const std::vector<std::string>& words) {
    Arguments arguments{"--points", points_, "--closest-points"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_refused(map(arguments), words);
  };
  refused({"-o", path("map.ply")}, {"map.ply: closest points are written to .csv, .npy and .vtp only"});
  refused({"-o", path("map.csv"), "--certificates"}, {"--closest-points: not with --certificates"});
  refused({"-o", path("map.csv"), "--point-radius", "1"}, {"--closest-points: of exact points only"});
  refused({}, {"give at least one of --output"});
  expect_refused(run({"map", "--model", places::example("uncertain_stem.json"), "--points", points_, "--closest-points",
                      "-o", path("map.csv")}),
                 {"--closest-points: ", "uncertain_stem.json: not supported for intervals"});
}

TEST_F(MapStreams, RefusesColumnsAndFormatsThatThereAreNot) {
  const auto refused = [&](const Arguments& more, const std::vector<std::string>& words) {
    Arguments arguments{"--points", points_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_refused(map(arguments), words);
  };
  refused({"-o", path("map.csv"), "--columns", "lo,high"}, {"--columns: 'high' is not one of index, x, y, z, lo"});
  refused({"-o", path("map.csv"), "--columns", "lo,lo"}, {"--columns: lo is there twice"});
  refused({"-o", path("map.csv"), "--columns", "lo,"}, {"--columns: '' is not one of"});
  refused({"-o", path("map.vtp"), "--columns", "lo"}, {"map.vtp: columns are chosen of .csv and .npy only"});
  refused({"-o", path("map.csv"), "--columns", "lo", "--certificates"}, {"the columns of certificates"});
  refused({"-o", path("map.npy"), "--certificates"}, {"certificates are written to .csv and .vtp only"});
  refused({"-o", path("map.csv"), "--format", "xlsx"}, {"--format: xlsx is not one of csv, npy, vtp, ply, json"});
  refused({"-o", path("map")}, {"unknown map format ''"});
  EXPECT_THAT(folder_.names(), ::testing::UnorderedElementsAre("points.csv", "process.out", "process.err"));
}

TEST_F(MapStreams, RefusesColumnsAndFormatsOfNoOutput) {
  const std::string mesh = places::example("cavity.off");
  for (const std::string option : {"--format", "--columns"}) {
    expect_refused(map({"--mesh", mesh, "--png", path("p.png"), option, option == "--format" ? "csv" : "lo"}),
                   {option + ": give the --output"});
  }
}

TEST_F(MapStreams, InterruptionKeepsThePartOfAnArray) {
  std::string text;
  for (int k = 0; k < 500'000; ++k) text += "90,0,0.5\n";
  const auto many = write("many.csv", text);
  const auto outcome =
      run_interrupted({"map", "--device", "host", "--model", stem, "--points", many, "-o", path("map.npy"), "--json"});
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  const std::string part = contents(path("map.npy.partial"));
  EXPECT_THAT(part, HasSubstr("'shape': (" + std::to_string(summary.at("points").get<int>()) + ",)"));
  EXPECT_FALSE(std::filesystem::exists(path("map.npy")));
}

/// As full as a disk can be.
TEST_F(MapStreams, SaysWhenTheStandardOutputIsFull) {
  const auto outcome = shell("map --points points.csv -o - > /dev/full");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("standard output: cannot be written"));
}

/// Rows that could not be written are older than the line that cannot be read.
TEST_F(MapStreams, SaysFirstWhatFailedFirst) {
  std::string text;
  for (int k = 0; k < 200'000; ++k) text += "90,0,0.5\n";
  (void)write("bad.csv", text + "1,2,three\n");
  const auto outcome = shell("map --points bad.csv -o - > /dev/full");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, EndsWith("standard output: cannot be written: No space left on device\n"));
}

}  // namespace
}  // namespace verisq::testing
