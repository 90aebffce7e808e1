/// `verisq fit` as its user meets it: results, files, messages and exit status.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>
#include <verisq/files.hpp>
#include <verisq/mesh.hpp>

#include "host/errors/refusal.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"
#include "tests/fixtures/sample_meshes.hpp"

namespace verisq::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr Point semi_axes{3.0, 4.0, 8.0};
constexpr Point displacement{1.0, -0.5, 2.0};  // of the cavity from where the implant's file places it
constexpr double play = 0.5;

/// A closed surface at the distance `play` around the displaced ellipsoid, in rings from pole to pole.
Mesh cavity_mesh() {
  constexpr std::uint32_t rings = 7;
  constexpr std::uint32_t around = 12;
  Mesh mesh;
  const auto add = [&](double height, double angle) {
    const double radius = std::sqrt(1.0 - height * height);
    const Point direction{radius * std::cos(angle), radius * std::sin(angle), height};
    const Point normal{direction[0] / semi_axes[0], direction[1] / semi_axes[1], direction[2] / semi_axes[2]};
    const double length = std::hypot(normal[0], normal[1], normal[2]);
    Point vertex{};
    for (std::size_t k = 0; k < 3; ++k) {
      vertex[k] = semi_axes[k] * direction[k] + play * normal[k] / length + displacement[k];
    }
    mesh.vertices.push_back(vertex);
  };
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    for (std::uint32_t k = 0; k < around; ++k) {
      add(std::cos(std::numbers::pi * (ring + 1) / (rings + 1)), 2.0 * std::numbers::pi * k / around);
    }
  }
  for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
    for (std::uint32_t k = 0; k < around; ++k) {
      const std::uint32_t next = (k + 1) % around;
      const std::uint32_t a = ring * around;
      const std::uint32_t b = a + around;
      mesh.triangles.push_back({a + k, b + k, b + next});
      mesh.triangles.push_back({a + k, b + next, a + next});
    }
  }
  return mesh;
}

std::string off(const Mesh& mesh) {
  std::string text =
      "OFF\n" + std::to_string(mesh.vertices.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n";
  for (const Point& v : mesh.vertices) {
    text += std::to_string(v[0]) + " " + std::to_string(v[1]) + " " + std::to_string(v[2]) + "\n";
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    text += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  }
  return text;
}

/// With the property `side`: 5 for x < 1, otherwise -1.
std::string labelled_ply(const Mesh& mesh) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
                     "\nproperty double x\nproperty double y\nproperty double z\nproperty int side\nelement face " +
                     std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Point& v : mesh.vertices) {
    text += std::to_string(v[0]) + " " + std::to_string(v[1]) + " " + std::to_string(v[2]) +
            (v[0] < displacement[0] - 1e-3 ? " 5\n" : " -1\n");
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    text += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  }
  return text;
}

/// A box about the origin, its faces in squares of 2 and these halved, normals outward; `half` its sides in 4.
Mesh tessellated_box(const std::array<int, 3>& half) {
  Mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> known;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [place, is_new] = known.try_emplace(at, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back({2.0 * at[0], 2.0 * at[1], 2.0 * at[2]});
    return place->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3;
    const std::size_t v = (axis + 2) % 3;
    for (const int side : {-1, 1}) {
      for (int i = -half[u]; i < half[u]; ++i) {
        for (int j = -half[v]; j < half[v]; ++j) {
          const auto corner = [&](int along_u, int along_v) {
            std::array<int, 3> at{};
            at[axis] = side * half[axis];
            at[u] = i + along_u;
            at[v] = j + along_v;
            return vertex(at);
          };
          std::array<std::uint32_t, 3> first{corner(0, 0), corner(1, 0), corner(1, 1)};
          std::array<std::uint32_t, 3> second{corner(0, 0), corner(1, 1), corner(0, 1)};
          if (side < 0) {
            std::swap(first[0], first[1]);
            std::swap(second[0], second[1]);
          }
          mesh.triangles.push_back(first);
          mesh.triangles.push_back(second);
        }
      }
    }
  }
  return mesh;
}

class FitCommand : public ProgramTest {
 protected:
  /// An ellipsoid; `axes` as in a model file, `rest` further keys of it.
  [[nodiscard]] std::string implant(const std::string& name, const std::string& axes = "[3, 4, 8]",
                                    const std::string& rest = R"(, "units": "mm")") const {
    return write(
        name, R"({"format": "verisq-model/1", "primitives": [{"name": "body", "superquadric": {"semi_axes": )" + axes +
                  R"(, "exponents": [1, 1]}}])" + rest + "}");
  }
  [[nodiscard]] std::string bone() const { return write("bone.off", off(cavity_mesh())); }
  [[nodiscard]] std::string fitted() const { return path("fitted.json"); }

  /// In a small range of poses, on any side, on the host, with a JSON summary.
  [[nodiscard]] static Arguments near(Arguments arguments) {
    const Arguments quick{"fit",  "--any-side", "--translation-range", "4", "--rotation-range", "10", "--device",
                          "host", "--json"};
    arguments.insert(arguments.begin(), quick.begin(), quick.end());
    return arguments;
  }
  [[nodiscard]] Outcome fit(Arguments arguments) const {
    arguments.insert(arguments.end(), {"--samples", "256"});
    return run(near(arguments));
  }
  [[nodiscard]] Outcome fit_one(Arguments arguments = {}) const {
    arguments.insert(arguments.begin(), {"--implant", implant("body.json"), "--mesh", bone(), "-o", fitted()});
    return fit(arguments);
  }
  /// Without any movement.
  [[nodiscard]] Outcome fit_in_place(Arguments arguments) const {
    arguments.insert(arguments.begin(),
                     {"fit", "--any-side", "--implant", implant("body.json"), "--mesh", bone(), "-o", fitted(),
                      "--translation-range", "0", "--rotation-range", "0", "--device", "host", "--samples", "16"});
    return run(arguments);
  }
};

Enclosure enclosure(const json& object) {
  return {object["lo"], object["hi"]};
}

TEST_F(FitCommand, FindsThePoseAndProvesIt) {
  const Outcome outcome = fit_one();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const json summary = json::parse(outcome.out);
  const std::size_t points = cavity_mesh().vertices.size();
  EXPECT_EQ(summary["points"], points);
  EXPECT_EQ(summary["wide"], 0);
  EXPECT_EQ(summary["proven_too_deep"], 0);
  EXPECT_EQ(summary["units"], "mm");
  EXPECT_EQ(summary["output"], fitted());
  // At the cavity's own pose every point is `play` away, where f is 1 / (1 + (play / gap)^2).
  EXPECT_EQ(summary["largest_objective"], static_cast<double>(points));
  EXPECT_GT(summary["objective"]["lo"], 0.99 * static_cast<double>(points) / (1.0 + play * play / 4.0));
  EXPECT_LE(summary["objective"]["hi"], static_cast<double>(points));
  EXPECT_LE(summary["objective"]["hi"].get<double>() - summary["objective"]["lo"].get<double>(), 1e-3);
  EXPECT_NEAR(summary["search"]["objective"], summary["objective"]["lo"], 1e-6);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(summary["pose"]["translation"][k], displacement[k], 1.2 * play) << k;
  }
  ASSERT_EQ(summary["areas"].size(), 1U);
  EXPECT_EQ(summary["areas"][0]["name"], "elsewhere");
  EXPECT_EQ(summary["areas"][0]["points"], points);
}

/// Whatever is proven by then stays so, and the rest is named.
TEST_F(FitCommand, AtTheTimeLimitTheBestPoseIsWrittenAndTheRestLeftOpen) {
  const Outcome outcome = fit_one({"--time-limit", "1e-9", "--map", path("fit.csv")});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("the time limit is reached: the search ended early"));
  EXPECT_THAT(outcome.err, HasSubstr("what is not proven yet stays open: vertices"));
  const json summary = json::parse(outcome.out);
  EXPECT_EQ(summary["search"]["out_of_time"], true);
  EXPECT_EQ(summary["interrupted"], false);
  EXPECT_THAT(summary["proof"]["unfinished"].get<std::vector<std::string>>(), ::testing::Contains("surface"));
  const std::size_t points = cavity_mesh().vertices.size();
  EXPECT_EQ(summary["points"], points);
  EXPECT_EQ(summary["wide"], points);
  EXPECT_TRUE(std::filesystem::exists(fitted()));
  const Outcome map = run({"map", "--model", fitted(), "--mesh", bone(), "--device", "host", "-o", path("map.csv")});
  EXPECT_EQ(map.status, 0);
}

TEST_F(FitCommand, WritesTheModelWhoseMapItIs) {
  ASSERT_EQ(fit_one({"--map", path("fit.csv")}).status, 0);
  const Outcome map = run({"map", "--model", fitted(), "--mesh", bone(), "--device", "host", "-o", path("map.csv")});
  EXPECT_EQ(map.status, 0) << map.err;
  EXPECT_EQ(folder_.contents("fit.csv"), folder_.contents("map.csv"));
  EXPECT_EQ(rows_of(path("fit.csv")).size(), cavity_mesh().vertices.size());
  EXPECT_EQ(read_model(fitted()).units, "mm");
}

TEST_F(FitCommand, TellsTheSmallestDistanceOfItsMap) {
  const json summary = json::parse(fit_one({"--map", path("fit.csv")}).out);
  Enclosure smallest{1e300, 1e300};
  for (const Row& row : rows_of(path("fit.csv"))) {
    smallest = {std::min(smallest.lo, row.distance.lo), std::min(smallest.hi, row.distance.hi)};
  }
  EXPECT_EQ(enclosure(summary["smallest_distance"]), smallest);
}

TEST_F(FitCommand, GivesTheSameFileForTheSameSeed) {
  ASSERT_EQ(fit_one({"--seed", "7"}).status, 0);
  const std::string first = folder_.contents("fitted.json");
  ASSERT_EQ(fit_one({"--seed", "7"}).status, 0);
  EXPECT_EQ(folder_.contents("fitted.json"), first);
}

TEST_F(FitCommand, PrintsASummaryForPeople) {
  const Outcome outcome = fit_in_place({"--pose-start", "1,-0.5,2,1,0,0,0", "--map", path("map.vtp")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* part :
       {"translation          (1, -0.5, 2) mm\n", "smallest distance    [0.49", "kept, proven of the whole surface",
        "deepest penetration  0 mm\n", "area", "elsewhere", "  84   100.0 %     0.0 %", "fitted model"}) {
    EXPECT_THAT(outcome.out, HasSubstr(part)) << outcome.out;
  }
}

TEST_F(FitCommand, SaysThatTheLimitIsExceeded) {
  const Outcome outcome = fit_in_place({"--penetration-limit", "0.1"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.out, HasSubstr("0.1 mm: EXCEEDED, proven of "));
  EXPECT_THAT(outcome.err, HasSubstr("proven deeper inside the implant than the limit"));
  EXPECT_THAT(outcome.err, Not(HasSubstr("--pose-start")));  // the user has said where to look
  EXPECT_EQ(read_model(fitted()).primitives.size(), 1U);
}

TEST_F(FitCommand, SaysHowToTellItWhereToLook) {
  const Outcome outcome = run({"fit", "--cavity", "--implant", implant("large.json", "[9, 9, 30]"), "--mesh", bone(),
                               "-o", fitted(), "--device", "host", "--samples", "4"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err, HasSubstr("say by --pose-start where to begin"));
}

TEST_F(FitCommand, ChoosesFromASeries) {
  const std::string small = implant("small.json", "[2, 3, 7]");
  const std::string right = implant("right.json", "[3.25, 4.25, 8.25]");
  const std::string large = implant("large.json", "[5, 6, 10]");
  const Outcome outcome =
      fit({"--implant", small, "--implant", right, "--implant", large, "--mesh", bone(), "-o", fitted()});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const json summary = json::parse(outcome.out);
  EXPECT_EQ(summary["implant"], right);
  EXPECT_EQ(summary["implant_index"], 1);
  EXPECT_EQ(summary["implants"], 3);
}

TEST_F(FitCommand, TellsHowDeepAnInstrumentCuts) {
  const Arguments in_place{"--pose-start", "1,-0.5,2,1,0,0,0"};
  const auto with = [&](const std::string& instrument, const Arguments& more = {}) {
    Arguments arguments = in_place;
    arguments.insert(arguments.end(), {"--instrument", instrument});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return fit_in_place(arguments);
  };
  // Its surface is a quarter of a millimetre beyond the vertices, and the faces between them are nearer to its middle.
  const std::string rasp = implant("rasp.json", "[3.75, 4.75, 8.75]");
  const Outcome cutting = with(rasp, {"--json"});
  EXPECT_EQ(cutting.status, 0) << cutting.err;  // asked of the implant, not of its rasp
  const json summary = json::parse(cutting.out)["instrument"];
  EXPECT_EQ(summary["file"], rasp);
  const Enclosure smallest = enclosure(summary["surface"]["smallest_distance"]);
  EXPECT_LE(smallest.lo, -0.25);
  EXPECT_GE(smallest.lo, -2.0);
  EXPECT_LE(smallest.hi, -0.2);
  EXPECT_EQ(summary["surface"]["proven_too_deep"], cavity_mesh().triangles.size());

  const std::string small = implant("blunt.json", "[2, 2, 2]");
  EXPECT_THAT(with(small).out, HasSubstr("instrument           " + quotation(small) + ", where the implant lies\n"));
  const json blunt = json::parse(with(small, {"--json"}).out)["instrument"];
  EXPECT_GT(blunt["surface"]["smallest_distance"]["lo"], 0.5);
  EXPECT_EQ(blunt["surface"]["proven_too_deep"], 0);
  EXPECT_TRUE(json::parse(fit_one().out)["instrument"].is_null());

  expect_refused(with(rasp, {"--instrument", rasp}),
                 {"--instrument: give one for each --implant, in the same order: 2 for 1"});
}

/// F prefers the one that leaves half a millimetre all around; larger ones fit, too, and the largest does not.
TEST_F(FitCommand, ChoosesTheLargestThatIsProven) {
  const std::string right = implant("right.json", "[3, 4, 8]");
  const std::string tight = implant("tight.json", "[3.25, 4.25, 8.25]");
  const std::string huge = implant("huge.json", "[5, 6, 10]");
  const Outcome outcome =
      fit({"--implant", tight, "--implant", huge, "--implant", right, "--mesh", bone(), "-o", fitted(), "--completion",
           "cemented", "--gap", "0.5", "--objective", "size", "--on", "vertices"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const json summary = json::parse(outcome.out);
  EXPECT_EQ(summary["implant"], tight);
  EXPECT_EQ(summary["maximised"], "size");
  EXPECT_NEAR(summary["size"], 4.0 / 3.0 * std::numbers::pi * 3.25 * 4.25 * 8.25, 1e-3);
  ASSERT_EQ(summary["finalists"].size(), 1U) << "the smaller one is not tried";
  const json& refused = summary["finalists"][0];
  EXPECT_EQ(refused["implant"], huge);
  EXPECT_EQ(refused["kept"], false);
  EXPECT_EQ(refused["not_proven"][0], "smallest distance");
  EXPECT_EQ(read_model(fitted()).primitives[0].superquadric.semi_axes[0], 3.25);
}

TEST_F(FitCommand, SaysThatNoSizeIsProven) {
  const std::string large = implant("large.json", "[4, 5, 9]");
  const std::string huge = implant("huge.json", "[5, 6, 10]");
  const Outcome outcome =
      run({"fit",       "--any-side", "--implant",   large,  "--implant",           huge,   "--mesh",           bone(),
           "-o",        fitted(),     "--objective", "size", "--translation-range", "1",    "--rotation-range", "5",
           "--samples", "64",         "--device",    "host", "--no-progress",       "--on", "vertices"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("NOT PROVEN to keep all that is asked, nor is any other"));
  EXPECT_THAT(outcome.out, HasSubstr("finalist 2"));
}

TEST_F(FitCommand, MakesSizesAsLargeAsTheyFit) {
  const Outcome outcome =
      fit({"--implant", implant("body.json", "[[2, 5], 4.2, 8.2]"), "--mesh", bone(), "-o", fitted(), "--completion",
           "cemented", "--gap", "0.5", "--objective", "size", "--on", "vertices"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const json summary = json::parse(outcome.out);
  EXPECT_GT(summary["sizes"][0]["semi_axes"][0], 3.4);
  EXPECT_LT(summary["sizes"][0]["semi_axes"][0], 3.6);
  ASSERT_EQ(summary["constraints"].size(), 1U);
  EXPECT_EQ(summary["constraints"][0]["name"], "smallest distance");
  EXPECT_EQ(summary["constraints"][0]["kept"], true);
  EXPECT_EQ(summary["constraints"][0]["binds"], "lower");
  EXPECT_EQ(summary["binding"][0], "smallest distance at 0");
}

TEST_F(FitCommand, SaysWhatASizeEndsAt) {
  const Outcome outcome = fit(
      {"--implant", implant("body.json", "[[2, 2.5], 4, 8]"), "--mesh", bone(), "-o", fitted(), "--objective", "size"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(json::parse(outcome.out)["binding"], ::testing::Contains("semi-axis 1 of body"));
}

/// Half a millimetre all around, but for what the facets cut off.
TEST_F(FitCommand, EnclosesAreasInContact) {
  const std::string boxes =
      R"(, "units": "mm", "areas": [{"name": "top", "weight": 1, "box": [[-9, -9, 2], [9, 9, 99]]}])";
  const auto shares = [&](const std::string& gap, Arguments more) {
    more.insert(more.begin(), {"--implant", implant("body.json", "[3, 4, 8]", boxes), "--mesh", bone(), "-o", fitted(),
                               "--pose-start", "1,-0.5,2,1,0,0,0", "--gap", gap, "--implant-contact"});
    return fit(more);
  };
  const json all = json::parse(shares("0.6", {}).out)["contact"];
  EXPECT_EQ(all["distance"], 0.6);
  ASSERT_EQ(all["shares"].size(), 4U);
  EXPECT_EQ(all["shares"][0]["name"], "contact");
  EXPECT_EQ(all["shares"][1]["name"], "contact:top");
  EXPECT_EQ(all["shares"][3]["name"], "implant_contact");
  EXPECT_GT(all["shares"][0]["percent"]["lo"], 98.0);
  EXPECT_LE(all["shares"][0]["percent"]["hi"], 100.0);
  EXPECT_GT(all["shares"][3]["percent"]["lo"], 80.0) << "the poles lie open";

  const Outcome kept = shares("0.6", {"--keep", "contact:top=90,100", "--keep", "implant_contact=50,100"});
  EXPECT_EQ(kept.status, 0) << kept.err;
  const Outcome broken = shares("0.6", {"--keep", "contact=0,1"});
  EXPECT_EQ(broken.status, 3);
  EXPECT_THAT(broken.err, HasSubstr("asks of \"contact\""));
  EXPECT_THAT(broken.err, HasSubstr("proven not to be within what --keep asks"));
}

TEST_F(FitCommand, ChoosesSizes) {
  const Outcome outcome = fit(
      {"--implant", implant("body.json", "[[2, 5], 4.4, 8.4]"), "--mesh", bone(), "--on", "vertices", "-o", fitted()});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const json size = json::parse(outcome.out)["sizes"][0]["semi_axes"];
  EXPECT_GT(size[0], 3.3);
  EXPECT_LT(size[0], 3.5 + 1e-6);
  EXPECT_EQ(size[1], 4.4);
  EXPECT_EQ(read_model(fitted()).primitives[0].superquadric.semi_axes[0], size[0]);
}

TEST_F(FitCommand, TellsAreasApart) {
  const std::string boxes = R"(, "units": "mm", "areas": [
      {"name": "top", "weight": 3, "box": [[-9, -9, 5], [9, 9, 99]]},
      {"name": "far", "weight": 1, "box": [[50, 50, 50], [51, 51, 51]]}])";
  const Outcome outcome = fit({"--implant", implant("body.json", "[3, 4, 8]", boxes), "--mesh", bone(), "-o", fitted(),
                               "--weight", "elsewhere=0.5"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "verisq: area \"far\": has no vertex of the mesh\n");
  const json areas = json::parse(outcome.out)["areas"];
  ASSERT_EQ(areas.size(), 3U);
  EXPECT_EQ(areas[0]["name"], "top");
  EXPECT_EQ(areas[0]["weight"], 3);
  EXPECT_EQ(areas[1]["points"], 0);
  EXPECT_TRUE(areas[1]["smallest_distance"].is_null());
  EXPECT_EQ(areas[2]["weight"], 0.5);
  for (const json& area : areas) {
    EXPECT_EQ(area["points"],
              area["proven_within"].get<int>() + area["proven_outside"].get<int>() + area["undecided"].get<int>());
  }
}

TEST_F(FitCommand, TakesAreasFromLabels) {
  const std::string mesh = write("bone.ply", labelled_ply(cavity_mesh()));
  const Outcome outcome =
      fit({"--implant", implant("body.json"), "--mesh", mesh, "-o", fitted(), "--labels", "side", "--weight", "5=2.5"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const json areas = json::parse(outcome.out)["areas"];
  ASSERT_EQ(areas.size(), 2U);
  EXPECT_EQ(areas[0]["name"], "-1");
  EXPECT_EQ(areas[0]["weight"], 1);
  EXPECT_EQ(areas[1]["name"], "5");
  EXPECT_EQ(areas[1]["weight"], 2.5);
  EXPECT_GT(areas[0]["points"], 0);
}

TEST_F(FitCommand, KnowsCementedCompletion) {
  const Outcome outcome = fit_one({"--completion", "cemented", "--gap", "0.5", "--gap-tolerance", "0.1"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const json summary = json::parse(outcome.out);
  EXPECT_EQ(summary["areas"][0]["proven_within"], summary["points"]);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(summary["pose"]["translation"][k], displacement[k], 0.01) << k;
}

TEST_F(FitCommand, WritesAReportAndAPicture) {
  const Outcome outcome = fit_one({"--report", path("fit.html"), "--png", path("fit.png")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(folder_.contents("fit.html"), HasSubstr("bone.off: fit of body.json"));
  EXPECT_THAT(folder_.contents("fit.html"), HasSubstr("deepest penetration"));
  EXPECT_EQ(folder_.contents("fit.png").substr(1, 3), "PNG");
}

TEST_F(FitCommand, KeepsTheBestPoseWhenInterrupted) {
  const Outcome outcome = run_interrupted(
      near({"--implant", implant("body.json"), "--mesh", bone(), "-o", fitted(), "--samples", "1000000000"}));
  EXPECT_EQ(outcome.status, 130);
  EXPECT_THAT(outcome.err, HasSubstr("verisq: interrupted; the best pose so far is proven, and kept in " + fitted()));
  const json summary = json::parse(outcome.out);
  EXPECT_EQ(summary["interrupted"], true);
  EXPECT_EQ(summary["points"], cavity_mesh().vertices.size());
  EXPECT_EQ(read_model(fitted()).primitives.size(), 1U);
}

TEST_F(FitCommand, SaysThatEnclosuresAreWide) {
  EXPECT_EQ(fit_one({"--tol", "0"}).status, 0) << "the tightest";
  const Outcome outcome = fit_one({"--tol", "1e-300"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_GT(json::parse(outcome.out)["wide"], 0);
}

TEST_F(FitCommand, RefusesBadUsage) {
  const std::string body = implant("body.json");
  const std::string mesh = bone();
  const Arguments files{"--implant", body, "--mesh", mesh, "-o", fitted()};
  const auto refused = [&](Arguments options, const std::string& message) {
    options.insert(options.begin(), files.begin(), files.end());
    options.insert(options.begin(), {"fit", "--any-side"});
    expect_refused(run(options), {message});
    EXPECT_FALSE(std::filesystem::exists(fitted()));
  };
  refused({"--objective", "beauty"}, "--objective: beauty is not one of fitness, size");
  refused({"--objective", "size", "--bound", "5"}, "--bound: is of F, which --objective size does not maximise");
  refused({"--keep", "contact:nose=1,2"},
          "--keep contact:nose: no area has the name \"nose\"; known are \"elsewhere\"");
  refused({"--completion", "screwed"}, "--completion: screwed is not one of cementless, cemented");
  refused({"--gap", "0"}, "--gap: 0 is not above 0");
  refused({"--gap", "-1"}, "--gap: -1 is not a finite number of at least 0");
  refused({"--gap-tolerance", "1"}, "--gap-tolerance: only for --completion cemented");
  refused({"--completion", "cemented", "--gap", "0"}, "--gap-tolerance: give one, because --gap is 0");
  refused({"--penetration-limit", "nan"}, "--penetration-limit: nan");
  refused({"--pose-start", "1,2,3"}, "--pose-start: 3 numbers where 7");
  refused({"--pose-start", "1,2,3,0,0,0,0"}, "--pose-start: 1,2,3,0,0,0,0 has a zero quaternion");
  refused({"--translation-range", "inf"}, "--translation-range: inf");
  refused({"--rotation-range", "181"}, "--rotation-range: 181 is above 180");
  refused({"--samples", "0"}, "--samples: 0 is not in 1 to 1000000000");
  refused({"--tol", "x"}, "--tol: x");
  refused({"--labels", "side"}, "bone.off: labels of vertices are read from .ply only");
  refused({"--weight", "top"}, "--weight: top is not NAME=W");
  refused({"--weight", "top=1"}, "--weight: no area has the name \"top\"");
  refused({"--weight", "elsewhere=-1"}, "--weight elsewhere=-1: -1 is not a finite number of at least 0");
  refused({"--weight", "elsewhere=0"}, "every vertex has weight 0");
  refused({"--weight", "elsewhere=1", "--weight", "elsewhere=2"}, "--weight: elsewhere has two");
  refused({"--device", "none of this name"}, "none of this name");
  refused({"--map", path("map.txt")}, "map.txt");
  refused({"--map", fitted()}, "is the name of two outputs");
  refused({"--map", mesh}, "--map " + mesh + ": would overwrite an input");
  refused({"--report", path("report.txt")}, "--report");
  expect_refused(run({"fit", "--implant", body, "--mesh", mesh, "-o", body}), {"-o " + body + ": would overwrite"});
  EXPECT_EQ(run({"fit", "--any-side", "--implant", body, "--mesh", mesh, "-o", path("none/fitted.json")}).status, 1);
}

TEST_F(FitCommand, RefusesImplantsThatDoNotServe) {
  const std::string mesh = bone();
  const auto refused = [&](const Arguments& implants, const std::string& message) {
    Arguments arguments{"fit", "--any-side", "--mesh", mesh, "-o", fitted()};
    for (const std::string& file : implants) arguments.insert(arguments.end(), {"--implant", file});
    expect_refused(run(arguments), {message});
  };
  const std::string body = implant("body.json");
  const std::string in_m = implant("m.json", "[3, 4, 8]", R"(, "units": "m")");
  refused({in_m}, "--gap: give one, because the implants' units are \"m\", not mm");
  refused({implant("no_units.json", "[3, 4, 8]", "")},
          "--gap: give one, because the implants' units are unknown, not mm");
  refused({body, in_m}, in_m + ": units \"m\" differ from \"mm\" of " + body);
  refused({body, path("none.json")}, "none.json: no such file");
  const auto with_area = [&](const std::string& name, const std::string& weight) {
    return implant(
        name, "[3, 4, 8]",
        R"(, "units": "mm", "areas": [{"name": "a", "weight": )" + weight + R"(, "box": [[0, 0, 0], [1, 1, 1]]}])");
  };
  refused({with_area("one.json", "1"), with_area("two.json", "2")}, "two.json: areas: differ from those of ");
  const std::string bent_sizes = write("sizes.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
      {"name": "body", "superquadric": {"semi_axes": [3, 4, [7, 8]], "exponents": [1, 1]},
       "bend": {"curvature": 0.02, "angle_deg": 0}}]})");
  refused({bent_sizes}, bent_sizes + ": sizes to choose from are for unions of primitives without bends");
  const std::string bent = places::example("bent_stem.json");
  expect_refused(
      run({"fit", "--any-side", "--mesh", mesh, "--gap", "2", "-o", fitted(), "--implant", bent, "--bound", "10"}),
      {"--bound: " + bent + ": is known of unions of superquadrics without bends alone"});
  const std::string uncertain = write("uncertain.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
      {"name": "body", "superquadric": {"semi_axes": [3, 4, 8], "exponents": [1, [0.5, 1]]}}]})");
  refused({uncertain}, uncertain + ": primitive \"body\": only semi-axes may be intervals");
}

TEST_F(FitCommand, ExplainsItself) {
  const Outcome outcome = run({"fit", "--help"});
  EXPECT_EQ(outcome.status, 0);
  for (const char* word :
       {"--implant", "--completion", "--penetration-limit", "--pose-start", "--labels", "Exit status"})
    EXPECT_THAT(outcome.out, HasSubstr(word));
}

/// A closed cavity, 8 x 8 x 24, and a pin with a broad head that stands out of it at the top. Beside the cavity the pin
/// has all its sides served as well.
class SidedFitCommand : public ProgramTest {
 protected:
  [[nodiscard]] std::string cavity(bool inward = false) const {
    Mesh mesh = tessellated_box({2, 2, 6});
    if (inward)
      for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
    return write(inward ? "inward.off" : "outward.off", off(mesh));
  }
  [[nodiscard]] std::string pin() const {
    return write("pin.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
        {"name": "shaft", "superquadric": {"semi_axes": [3, 3, 7], "exponents": [0.5, 0.5]},
         "pose": {"translation": [0, 0, -2]}},
        {"name": "neck", "superquadric": {"semi_axes": [2, 2, 6], "exponents": [1, 1]},
         "pose": {"translation": [0, 0, 8]}}],
        "landmarks": {"head_centre": [2, 0, 14], "neck_centre": [0, 0, 8],
                      "shaft_proximal": [0, 0, 3], "shaft_distal": [0, 0, -7]}})");
  }
  /// Of the bone that the cavity is in: the head's centre is 1 to the side of where the pin's file has its own.
  [[nodiscard]] std::string landmarks() const {
    return write("landmarks.json", R"({"format": "verisq-landmarks/1", "units": "mm", "side": "left", "landmarks": {
        "head_centre": [2, 1, 14], "neck_centre": [0, 1, 8], "shaft_proximal": [0, 0, 4], "shaft_distal": [0, 0, -9]}})");
  }
  [[nodiscard]] Outcome fit_preserving(Arguments arguments, const std::string& range = "4") const {
    arguments.insert(arguments.begin(), {"--mesh", cavity(), "--cavity", "--resection", top, "--crossing", "neck",
                                         "--landmarks", landmarks()});
    return fit(arguments, range, range);
  }
  [[nodiscard]] Outcome fit(Arguments arguments, const std::string& translation = "12",
                            const std::string& rotation = "10") const {
    const Arguments quick{"fit",
                          "--implant",
                          pin(),
                          "-o",
                          path("fitted.json"),
                          "--device",
                          "host",
                          "--json",
                          "--samples",
                          "256",
                          "--rotation-range",
                          rotation,
                          "--translation-range",
                          translation};
    arguments.insert(arguments.begin(), quick.begin(), quick.end());
    return run(arguments);
  }
  static constexpr const char* top = "0,0,8,0,0,1";  // of the cavity, cut open
};

TEST_F(SidedFitCommand, AsksWhatTheMeshIs) {
  expect_refused(fit({"--mesh", cavity()}), {"is it a cavity, which the implant lies in, or bone"});
  expect_refused(fit({"--mesh", cavity(), "--cavity", "--bone"}), {"only one of --cavity, --bone and --any-side"});
  expect_refused(fit({"--mesh", cavity(), "--cavity", "--crossing", "neck"}), {"--crossing neck: ", "is closed"});
  expect_refused(fit({"--mesh", cavity(), "--cavity", "--crossing", "nose"}),
                 {"--crossing: no primitive is named nose"});
  expect_refused(fit({"--mesh", cavity(), "--any-side", "--outside", "neck"}), {"--outside neck: not with --any-side"});
  expect_refused(fit({"--mesh", cavity(), "--cavity", "--on", "vertices"}), {"vertices alone have no sides"});
  expect_refused(fit({"--mesh", cavity(), "--cavity", "--resection", "0,0,8,0,0,0"}), {"has a zero normal"});
  expect_refused(fit({"--mesh", cavity(), "--cavity", "--resection", "0,0,-99,0,0,1"}), {"lies beyond it"});
  expect_refused(fit({"--mesh", cavity(), "--cavity", "--resection", top, "--crossing", "neck", "--outside", "neck"}),
                 {"--crossing neck: has to lie outside, by --outside"});
  expect_refused(fit({"--mesh", cavity(), "--cavity", "--resection", top, "--crossing", "neck", "--crossing", "shaft"}),
                 {"--crossing: names every primitive of an implant"});
  expect_refused(fit({"--mesh", cavity(true), "--bone"}), {"its normals point inward, as those of a cavity"});
  const std::string two = write("two.off", off(testing::join(tessellated_box({2, 2, 6}), tessellated_box({1, 1, 1}))));
  expect_refused(fit({"--mesh", two, "--cavity"}), {"2 separate surfaces"});
}

TEST_F(SidedFitCommand, PutsTheShaftInside) {
  const Outcome outcome = fit({"--mesh", cavity(), "--cavity", "--resection", top, "--crossing", "neck"});
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  const json sides = json::parse(outcome.out)["sides"];
  EXPECT_EQ(sides["of"], "cavity");
  EXPECT_EQ(sides["rims"], 1);
  EXPECT_EQ(sides["kept"], true);
  EXPECT_EQ(sides["primitives"][0], (json{{"primitive", "shaft"}, {"required", "inside"}, {"found", "proven"}}));
  EXPECT_EQ(sides["primitives"][1], (json{{"primitive", "neck"}, {"required", "any"}, {"found", nullptr}}));
}

TEST_F(SidedFitCommand, PutsATaperedShaftInside) {
  const std::string tapered = write("tapered.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
      {"name": "shaft", "superquadric": {"semi_axes": [2.2, 2.2, 7], "exponents": [0.5, 0.5], "taper": 1.8},
       "pose": {"translation": [0, 0, -2]}},
      {"name": "neck", "superquadric": {"semi_axes": [1.6, 1.6, 6], "exponents": [1, 1], "taper": 0.8},
       "pose": {"translation": [0, 0, 8]}}]})");
  const Outcome outcome =
      run({"fit", "--implant", tapered, "--mesh", cavity(), "--cavity", "--resection", top, "--crossing", "neck", "-o",
           path("fitted.json"), "--json", "--samples", "128", "--translation-range", "4", "--rotation-range", "5"});
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  const json summary = json::parse(outcome.out);
  EXPECT_EQ(summary["sides"]["kept"], true);
  EXPECT_EQ(summary["sides"]["primitives"][0],
            (json{{"primitive", "shaft"}, {"required", "inside"}, {"found", "proven"}}));
  EXPECT_EQ(read_model(path("fitted.json")).primitives[0].superquadric.taper, 1.8);
}

/// Its shaft leans over by 2 mm; a bore in it and the hole in its head have no side.
TEST_F(SidedFitCommand, PutsABentAndBoredShaftInside) {
  const std::string bent = write("bent.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
      {"name": "shaft", "superquadric": {"semi_axes": [2.2, 2.2, 8], "exponents": [0.5, 0.5]},
       "bend": {"curvature": 0.04, "angle_deg": 30}, "pose": {"translation": [0, 0, -2]}},
      {"name": "neck", "superquadric": {"semi_axes": [1.6, 1.6, 6], "exponents": [1, 1], "taper": 0.8},
       "pose": {"translation": [0, 0, 8]}},
      {"name": "bore", "superquadric": {"semi_axes": [0.6, 0.6, 6], "exponents": [0.5, 1]},
       "pose": {"translation": [0, 0, 9]}}],
      "csg": {"difference": [{"union": ["shaft", "neck"]}, "bore"]}})");
  const auto fit_bent = [&](Arguments arguments) {
    arguments.insert(arguments.begin(), {"fit", "--implant", bent, "--mesh", cavity(), "--cavity", "--resection", top,
                                         "--crossing", "neck", "-o", path("fitted.json"), "--json", "--samples", "64",
                                         "--translation-range", "3", "--rotation-range", "5"});
    return run(arguments);
  };
  const Outcome outcome = fit_bent({});
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  const json summary = json::parse(outcome.out);
  EXPECT_EQ(summary["sides"]["kept"], true);
  EXPECT_EQ(summary["sides"]["primitives"][0],
            (json{{"primitive", "shaft"}, {"required", "inside"}, {"found", "proven"}}));
  EXPECT_EQ(summary["sides"]["primitives"][2], (json{{"primitive", "bore"}, {"required", "any"}, {"found", nullptr}}));
  const Model fitted = read_model(path("fitted.json"));
  EXPECT_EQ(fitted.primitives[0].bend->curvature, 0.04);
  EXPECT_EQ(fitted.csg->operation, SetOperation::subtract);
  expect_refused(fit_bent({"--outside", "bore"}), {"--outside bore: only cuts the implant, so that it has no side"});
  const Outcome beside = fit_bent({"--pose-start", "30,0,0,1,0,0,0"});
  EXPECT_EQ(beside.status, 3);
  EXPECT_THAT(beside.err, HasSubstr("\"shaft\" is proven to lie outside the cavity, at least in part"));
}

TEST_F(SidedFitCommand, KeepsWhatIsToBePreserved) {
  const auto head_distance = [](const json& summary) {
    for (const json& change : summary["changes"])
      if (change["name"] == "head_distance") return change;
    return json();
  };
  const Outcome free = fit_preserving({});
  const Outcome kept = fit_preserving({"--keep", "head_distance=0,0.5", "--keep", "version_change=-8,8"});
  EXPECT_EQ(kept.status, 0) << kept.out << kept.err;
  EXPECT_TRUE(head_distance(json::parse(free.out))["kept"].is_null());
  EXPECT_GT(head_distance(json::parse(free.out))["value"]["lo"], 0.5) << "the test asks for nothing";
  const json found = head_distance(json::parse(kept.out));
  EXPECT_EQ(found["kept"], true);
  EXPECT_LE(found["value"]["hi"], 0.5);
  EXPECT_EQ(found["asked"][0]["hi"], 0.5);
}

TEST_F(SidedFitCommand, TakesHeadAndNeckForWhatIsCalledSo) {
  const auto fit_of = [this](const std::string& primitive) {
    const std::string implant =
        write(primitive + ".json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
        {"name": ")" + primitive + R"(", "superquadric": {"semi_axes": [3, 3, 7], "exponents": [0.5, 0.5]}}]})");
    return run({"fit", "--implant", implant, "--mesh", cavity(), "--cavity", "--device", "host", "--json", "--samples",
                "16", "--landmarks", landmarks(), "-o", path("fitted.json")});
  };
  const Outcome head = fit_of("head");
  EXPECT_THAT(head.err, HasSubstr("head.json: head_centre: the centre of its primitive \"head\""));
  const json changes = json::parse(head.out)["changes"];
  const json again = json::parse(
      run({"features", "--landmarks", landmarks(), "--implant", path("fitted.json"), "--json"}).out)["changes"];
  ASSERT_EQ(changes.size(), 3U);
  for (std::size_t k = 0; k < changes.size(); ++k) {
    EXPECT_EQ(changes[k]["name"], again[k]["name"]);
    EXPECT_EQ(changes[k]["value"], again[k]["value"]) << changes[k]["name"];
  }
  const Outcome shaft = fit_of("shaft");
  EXPECT_THAT(shaft.err, HasSubstr("shaft.json: names no landmark head_centre and has no primitive \"head\""));
  EXPECT_EQ(json::parse(shaft.out)["changes"], json::array());
}

TEST_F(SidedFitCommand, SaysWhatIsNotPreserved) {
  const Outcome outcome = fit_preserving({"--keep", "length_change=30,40"}, "0");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err, HasSubstr("asks of \"length_change\""));
  EXPECT_THAT(outcome.err, HasSubstr("proven not to be within what --keep asks"));
  const Outcome vague = fit_preserving({"--keep", "offset_change=-0.1,0.1", "--landmark-radius", "1"}, "0");
  EXPECT_EQ(vague.status, 3);
  EXPECT_THAT(vague.err, HasSubstr("asks of \"offset_change\""));
  EXPECT_THAT(vague.err, HasSubstr("not proven to be within what --keep asks"));
  expect_refused(fit_preserving({"--keep", "length=1,2"}), {"--keep length: ", "known are ", "length_change"});
  expect_refused(fit_preserving({"--keep", "length_change=2,1"}), {"--keep length_change=2,1: 2 is above 1"});
  expect_refused(fit({"--mesh", cavity(), "--cavity", "--keep", "length_change=1,2"}), {"--keep: needs --landmarks"});
}

TEST_F(SidedFitCommand, KnowsACavityByItsNormals) {
  const Outcome outcome = fit({"--mesh", cavity(true)});
  EXPECT_EQ(json::parse(outcome.out)["sides"]["of"], "cavity");
  EXPECT_THAT(outcome.err, HasSubstr("taken for a cavity, as its normals point inward"));
}

TEST_F(SidedFitCommand, NeverCallsWhatLiesBesideTheCavityDone) {
  const Outcome outcome =
      fit({"--mesh", cavity(), "--cavity", "--resection", top, "--crossing", "neck", "--pose-start", "30,0,0,1,0,0,0"},
          "2");
  EXPECT_EQ(outcome.status, 3) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("\"shaft\" is proven to lie outside the cavity, at least in part"));
  EXPECT_EQ(json::parse(outcome.out)["sides"]["primitives"][0]["found"], "other side");
}

TEST_F(SidedFitCommand, KeepsOutOfBone) {
  const Outcome outcome = fit({"--mesh", cavity(), "--bone"});
  const json summary = json::parse(outcome.out);
  EXPECT_EQ(summary["sides"]["of"], "bone");
  EXPECT_EQ(outcome.status == 0, summary["sides"]["kept"].get<bool>()) << outcome.err;
  const Outcome inside = fit({"--mesh", cavity(), "--bone", "--pose-start", "0,0,-2.5,1,0,0,0"}, "0.1", "1");
  EXPECT_EQ(inside.status, 3);
  EXPECT_THAT(inside.err, HasSubstr("\"shaft\" is proven to lie inside the bone, at least in part"));
}

/// A closed cavity of 8 x 8 x 24, and an implant of 4 x 4 x 12 that is a mesh.
class MeshFitCommand : public SidedFitCommand {
 protected:
  [[nodiscard]] std::string block() const { return write("block.off", off(tessellated_box({1, 1, 3}))); }
  [[nodiscard]] Outcome fit_block(Arguments arguments) const {
    const Arguments quick{"fit",   "--implant", block(),     "--mesh", cavity(), "--cavity", "-o", path("fitted.json"),
                          "--gap", "1",         "--samples", "64",     "--json"};
    arguments.insert(arguments.begin(), quick.begin(), quick.end());
    if (std::ranges::find(arguments, "--translation-range") == arguments.end())
      arguments.insert(arguments.end(), {"--translation-range", "3", "--rotation-range", "5"});
    return run(arguments);
  }
  [[nodiscard]] Outcome check(const std::string& certificate, const std::string& model) const {
    return run({"check", "--certificate", certificate, "--model", model, "--mesh", cavity(), "--map", path("map.csv"),
                "--json"});
  }
};

TEST_F(MeshFitCommand, ProvesThePoseThatItFinds) {
  const Outcome outcome = fit_block({"--map", path("map.csv"), "--certificate-file", path("proof.json")});
  ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  const json summary = json::parse(outcome.out);
  EXPECT_EQ(summary["sides"]["primitives"][0],
            (json{{"primitive", "block"}, {"required", "inside"}, {"found", "proven"}}));
  EXPECT_EQ(summary["sizes"], json::array());
  EXPECT_DOUBLE_EQ(summary["size"], 4.0 * 4.0 * 12.0);
  EXPECT_GE(summary["surface"]["smallest_distance"]["lo"], 0.0);
  EXPECT_LE(summary["surface"]["smallest_distance"]["hi"], 2.0 + 1e-9) << "no more than in the middle";
  const Outcome checked = check(path("proof.json"), path("fitted.json"));
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
  EXPECT_EQ(json::parse(checked.out)["sides"]["claims"],
            json::array({{{"primitive", "block"}, {"side", "inside"}, {"verdict", "proved"}}}));
}

TEST_F(MeshFitCommand, NeverProvesAForgery) {
  const auto claimed = [&](const std::string& side) {
    std::ifstream in(path("proof.json"));
    json proof = json::parse(in);
    proof["sides"] = json::array({{{"primitive", 0}, {"side", side}}});
    const Outcome checked = check(write("forged.json", proof.dump()), path("fitted.json"));
    const json verdict = json::parse(checked.out)["sides"]["claims"][0]["verdict"];
    EXPECT_EQ(checked.status, verdict == "proved" ? 0 : 3) << checked.out << checked.err;
    return verdict;
  };
  const Arguments files{"--map", path("map.csv"), "--certificate-file", path("proof.json")};
  ASSERT_EQ(fit_block(files).status, 0);
  EXPECT_EQ(claimed("outside"), "refuted");
  // At a wall, through it, outside.
  for (const char* const way : {"2", "3", "40"}) {
    Arguments arguments = files;
    arguments.insert(arguments.end(), {"--pose-start", std::string(way) + ",0.1,0.2,1,0,0,0", "--translation-range",
                                       "0", "--rotation-range", "0"});
    const Outcome outcome = fit_block(arguments);
    EXPECT_EQ(outcome.status, 3) << outcome.out << outcome.err;
    EXPECT_NE(claimed("inside"), "proved") << way;
    EXPECT_EQ(way == std::string("40"), claimed("outside") == "proved") << way;
  }
}

TEST_F(MeshFitCommand, RefusesWhatIsNotKnownOfMeshes) {
  expect_refused(fit_block({"--bound", "5"}), {"--bound: ", "known of unions of superquadrics without bends alone"});
  expect_refused(fit_block({"--implant-contact"}), {"--implant-contact: ", "block.off has a mesh", "--keep contact"});
  expect_refused(fit_block({"--keep", "implant_contact=1,100"}), {"block.off has a mesh"});
  expect_refused(fit_block({"--device", "0"}), {"--device 0: ", "only the host fits"});
  expect_refused(fit_block({"--surface-map", path("surface.csv")}), {"--surface-map: ", "give --map"});
  expect_refused(fit_block({"--contact-certificate-file", path("contact.json")}),
                 {"--contact-certificate-file: ", "has a mesh"});
}

}  // namespace
}  // namespace verisq::testing
