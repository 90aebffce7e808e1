/// The distances along a way in are proved from their file alone, and no forgery of it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "host/errors/refusal.hpp"
#include "tests/fixtures/hostile_texts.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/proof_file_test.hpp"

namespace verisq::testing {
namespace {

using nlohmann::json;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

class CheckInsertion : public ProofFileTest {
 protected:
  void SetUp() override {
    write_short_stem();
    const Outcome outcome = insert({"--along", "0,0,-1", "--length", "60", "--certificate-file", proof_});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("certificate          " + quotation(proof_)));
  }

  [[nodiscard]] Outcome insert(const Arguments& more) const {
    Arguments arguments{"insert", "--implant", implant_, "--mesh",   mesh_,  "-o",
                        map_,     "--tol",     "0.2",    "--device", "host", "--no-progress"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  [[nodiscard]] Outcome check(const std::string& proof, const Arguments& more = {}) const {
    return checked(proof, {"--model", implant_, "--mesh", mesh_}, more);
  }

  void expect_not_proved(const std::string& pointer, const json& value) const {
    const Outcome outcome = check(forged(pointer, value));
    EXPECT_EQ(outcome.status, 3) << pointer << " " << value << outcome.out << outcome.err;
  }

  std::string implant_ = path("stem.json");
  std::string mesh_ = places::example("cavity.off");
  std::string map_ = path("map.csv");
};

TEST_F(CheckInsertion, ProvesTheDistanceOfEveryVertex) {
  const Outcome outcome = check(proof_);
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("points               786\n  proved             786\n"));
  EXPECT_THAT(outcome.out, HasSubstr(" mm of these points along the whole way, proved\n"));
  EXPECT_THAT(outcome.out, HasSubstr("where bone must be removed\n"));
  EXPECT_THAT(outcome.out, HasSubstr("the way begins at    0,0,60,1,0,0,0"));
  EXPECT_THAT(outcome.out, HasSubstr("not claimed          what lies between the vertices"));
  const json object = json::parse(check(proof_, {"--json"}).out);
  EXPECT_EQ(object["kind"], "insertion");
  EXPECT_EQ(object["proved"], 786);
  EXPECT_EQ(object["proven_cut"].get<int>() + object["proven_untouched"].get<int>() + object["undecided"].get<int>(),
            786);
  EXPECT_GE(object["proven_cut"], 50);
}

TEST_F(CheckInsertion, IsOfTheRowsOfTheMap) {
  const json proof = document();
  const std::vector<Row> rows = rows_of(map_);
  ASSERT_EQ(rows.size(), proof["rows"].size());
  for (std::size_t n = 0; n < rows.size(); ++n) {
    EXPECT_EQ(rows[n].distance.lo, proof["rows"][n]["lo"].get<double>());
    EXPECT_EQ(rows[n].distance.hi, proof["rows"][n]["hi"].get<double>());
  }
}

TEST_F(CheckInsertion, NeverProvesAForgery) {
  const json proof = document();
  for (const std::string& row : {std::string("/rows/3"), std::string("/rows/500"), std::string("/rows/741")}) {
    const double lo = proof[json::json_pointer(row + "/lo")];
    const double hi = proof[json::json_pointer(row + "/hi")];
    expect_not_proved(row + "/lo", hi + 1e-12);
    expect_not_proved(row + "/hi", lo - 1e-12);
    expect_not_proved(row + "/parts", json::array());
    expect_not_proved(row + "/parts/0/until", 2.5);
    expect_not_proved(row + "/parts/0/segment/0/2", -1000.0);
    expect_not_proved(row + "/parts/0/normals", json::array());
    expect_not_proved(row + "/deepest/normals", json::array());
  }
  expect_not_proved("/path/0/translation/0", 9.0);
  expect_not_proved("/pose", {{"translation", {0, 0, 1}}, {"quaternion", {1, 0, 0, 0}}});
  json swapped = proof;
  std::swap(swapped["rows"][10], swapped["rows"][700]);
  EXPECT_EQ(check(write("forged.json", swapped.dump())).status, 3);
}

/// Of a refuted answer no smallest distance is told: it would be read as that of the way.
TEST_F(CheckInsertion, TellsNoSmallestDistanceOfWhatIsRefuted) {
  const Outcome outcome = check(forged("/rows/3/hi", -5.0));
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.out, HasSubstr("  refuted            1\n"));
  EXPECT_THAT(outcome.out, HasSubstr("first refuted point, index 3, at ("));
  EXPECT_THAT(outcome.out, Not(HasSubstr("smallest distance")));
}

/// What claims nothing is not called proved without a word.
TEST_F(CheckInsertion, TellsOfRowsWithoutAnEnd) {
  const Outcome outcome = check(forged("/rows/3/lo", "-inf"));
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.out, HasSubstr("  WITHOUT AN END     1: of these nothing is claimed on one side at least\n"));
  EXPECT_THAT(outcome.out, HasSubstr("  proven cut "));
}

TEST_F(CheckInsertion, IsOfNoOtherModelMeshOrForm) {
  const auto refused = [&](const Outcome& outcome, const std::string& words) {
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  refused(check(forged("/models/0/sha256", std::string(64, '0'))), "is about another model");
  refused(check(forged("/mesh/sha256", std::string(64, '0'))), "is about another mesh");
  refused(check(forged("/units", "cm")), "are not those of the model, \"mm\"");
  refused(check(forged("/path", json::array())), "path = []: must not be empty");
  refused(check(forged("/rows", json::array({document()["rows"][0]}))), "1 rows for the 786 vertices");
  refused(check(forged("/rows/7/parts/0/until", -1)), "rows[7].parts[0].until = -1: must be at least 0");
  refused(check(forged("/rows/7/parts/0/cover", "0f")), "rows[7].parts[0].cover = \"0f\": must be the hexadecimal");
  refused(check(forged("/rows/7/deepest/normals", {{0, 1, 2}})), "must be the index of a primitive and three numbers");
  const json part = document()["rows"][7]["parts"][0];
  refused(check(forged("/rows/7/parts", json(std::vector<json>(4097, part)))), "must have no more than 4096 parts");
  refused(check(forged("/path/0/quaternion", {0, 0, 0, 0})), "must not be zero");
  refused(check(proof_, {"--map", map_}), "not with --map");
  refused(check(proof_, {"--pose", "0,0,1,1,0,0,0"}), "not with --pose");
  refused(run({"check", "--model", implant_, "--certificate", proof_}), "give the --mesh");
}

TEST_F(CheckInsertion, IsOfTheModelWhereItWasMoved) {
  const std::string moved = path("moved.json");
  const Outcome outcome = insert({"--along", "0,0.1,-1", "--length", "60", "--turn", "20", "--pose",
                                  "0.1,0,2,1,0.01,0,0", "--certificate-file", moved});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const Outcome proved = check(moved);
  EXPECT_EQ(proved.status, 0) << proved.err << proved.out;
  EXPECT_THAT(proved.out, HasSubstr("model moved by       0.1"));
}

TEST_F(CheckInsertion, NeedsWhatHasCertificates) {
  const auto refused = [&](const Outcome& outcome, const std::string& words) {
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  const Arguments way{"--along", "0,0,-1", "--length", "60"};
  const auto with = [&](Arguments more) {
    more.insert(more.begin(), way.begin(), way.end());
    return insert(more);
  };
  refused(with({"--certificate-file", path("c.csv")}), "is a .json");
  refused(with({"--certificate-file", mesh_}), "is a .json");
  EXPECT_EQ(with({"--certificate-file", path("no_folder/c.json")}).status, 1);
  refused(with({"--certificate-file", implant_}), "--certificate-file");
  refused(with({"--certificate-file", path("c.json"), "--resection", "0,0,0,0,0,1"}), "not with --resection");
  std::filesystem::create_symlink(path("c.json"), path("d.json"));
  refused(run({"insert", "--implant", implant_, "--mesh", mesh_, "--along", "0,0,-1", "--length", "60", "-o",
               path("c.json"), "--certificate-file", path("d.json")}),
          "two outputs");
  const std::string bent = places::example("bent_stem.json");
  refused(run({"insert", "--implant", bent, "--mesh", mesh_, "--along", "0,0,-1", "--length", "60", "-o", map_,
               "--certificate-file", path("c.json")}),
          "ways in of meshes, of bent models");
}

/// Of the whole surface, too.
class CheckWaySurface : public CheckInsertion {
 protected:
  void SetUp() override {
    write_short_stem();
    const Outcome outcome =
        run({"insert", "--implant", implant_, "--mesh", mesh_, "-o", map_, "--tol", "0.4", "--along", "0,0,-1",
             "--length", "60", "--on", "triangles", "--json", "--no-progress", "--certificate-file", proof_});
    ASSERT_EQ(outcome.status, 0) << outcome.err << outcome.out;
    made_ = json::parse(outcome.out);
  }

  json made_;
};

TEST_F(CheckWaySurface, ProvesTheDistanceOfTheWholeSurface) {
  const json surface = document()["surface"];
  EXPECT_EQ(made_["certified_surface"]["lo"], surface["lo"]);
  EXPECT_EQ(made_["whole_surface"]["smallest_distance"]["hi"], surface["hi"]);
  EXPECT_LT(surface["hi"], made_["smallest_distance"]["lo"]);  // between the vertices it is deeper
  const Outcome outcome = check(proof_);
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("whole surface        between the vertices, too: smallest distance [-"));
  EXPECT_THAT(outcome.out, HasSubstr(" mm along the whole way, proved: it is cut nowhere deeper than "));
  EXPECT_THAT(outcome.out, HasSubstr("not claimed          how much bone is removed"));
  const json told = json::parse(check(proof_, {"--json"}).out);
  EXPECT_EQ(told["whole_surface"]["verdict"], "proved");
  EXPECT_EQ(told["whole_surface"]["claimed"]["lo"], surface["lo"]);

  const double lo = surface["lo"];
  const double hi = surface["hi"];
  expect_not_proved("/surface/lo", lo - 1e-12 * lo);
  expect_not_proved("/surface/lo", made_["smallest_distance"]["lo"]);
  expect_not_proved("/surface/lo", "-inf");
  expect_not_proved("/surface/hi", lo - 1e-12);
  expect_not_proved("/surface/triangles", json::array());
  expect_not_proved("/surface/triangles/0/cells", ".");
  expect_not_proved("/surface/triangles/0/moved", json::array());
  expect_not_proved("/surface/deepest/triangle", 0);
  expect_not_proved("/path/0/translation/0", 9.0);
  EXPECT_GT(hi, lo);
}

/// What is not proven of vertices proves nothing of triangles, whatever is claimed of them.
TEST_F(CheckWaySurface, BelievesNoVertexThatIsNotProven) {
  json proof = document();
  for (json& row : proof["rows"]) row["parts"] = json::array();
  const Outcome outcome = check(write("forged.json", proof.dump()), {"--json"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(json::parse(outcome.out)["whole_surface"]["verdict"], "unproved");
}

TEST_F(CheckWaySurface, IsOfNoOtherForm) {
  const auto refused = [&](const Outcome& outcome, const std::string& words) {
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  refused(check(forged("/surface/triangles/0/cells", "mx")), "must consist of the letters m, q, h and .");
  refused(check(forged("/surface/triangles/0/cells", std::string(2097153, '.'))),
          "must have no more than 2097152 cells");
  refused(check(forged("/surface/triangles/0/moved/0/step", {0, 1})), "must be an array of 3 numbers");
  refused(check(forged("/surface/deepest/weights", {0, 1, 2})), "must be an array of 2 numbers");
  refused(check(forged("/surface/triangles", json(2, document()["surface"]["triangles"][0]))),
          "must be above those before");
  refused(check(forged("/rows", json::array())), "must not be there without");
}

/// A box about the cavity is the bone's outer surface.
class CheckRemoval : public ProofFileTest {
 protected:
  static constexpr const char* box =
      "OFF\n8 12 0\n50 -60 -260\n170 -60 -260\n50 60 -260\n170 60 -260\n50 -60 -60\n170 -60 -60\n50 60 -60\n"
      "170 60 -60\n3 0 2 1\n3 1 2 3\n3 4 5 6\n3 5 7 6\n3 0 1 4\n3 1 5 4\n3 2 6 3\n3 3 6 7\n3 0 4 2\n3 2 4 6\n"
      "3 1 3 5\n3 3 7 5\n";

  [[nodiscard]] Outcome insert(const Arguments& more) const {
    Arguments arguments{"insert",   "--implant",    implant_, "--mesh",
                        mesh_,      "--along",      "0,0,-1", "--length",
                        "60",       "-o",           map_,     "--tol",
                        "4",        "--device",     "host",   "--no-progress",
                        "--cavity", "--volume-tol", "0.5",    "--certificate-file",
                        proof_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  [[nodiscard]] Outcome check(const std::string& proof, const Arguments& more = {}) const {
    return checked(proof, {"--model", implant_, "--mesh", mesh_}, more);
  }

  void SetUp() override { write_short_stem(); }

  std::string implant_ = path("stem.json");
  std::string mesh_ = places::example("cavity.off");
  std::string map_ = path("map.csv");
};

TEST_F(CheckRemoval, ProvesWhatIsRemovedWithinASurface) {
  const std::string outer = write("box.off", box);
  const Outcome made = insert({"--within", outer, "--json"});
  ASSERT_EQ(made.status, 0) << made.err << made.out;
  const json summary = json::parse(made.out);
  const json proof = document();
  EXPECT_EQ(summary["certified_volume"]["lo"], proof["removed"]["lo"]);
  EXPECT_EQ(summary["removed_volume"]["hi"], proof["removed"]["hi"]);
  EXPECT_EQ(proof["removed"]["bone"], "outside");

  const Arguments with{"--within", outer};
  const Outcome proved = check(proof_, with);
  EXPECT_EQ(proved.status, 0) << proved.err << proved.out;
  EXPECT_THAT(proved.out, HasSubstr("points               786\n  proved             786\n"));
  EXPECT_THAT(proved.out, HasSubstr(" mm^3, proved\n  bone is            outside of the mesh, within \"box.off\"\n"));
  EXPECT_THAT(proved.out, HasSubstr("not claimed          the distances of what lies between the vertices\n"));
  const json told = json::parse(check(proof_, {"--within", outer, "--json"}).out);
  EXPECT_EQ(told["removed_volume"]["verdict"], "proved");
  EXPECT_EQ(told["removed_volume"]["claimed"]["lo"], proof["removed"]["lo"]);

  const double hi = proof["removed"]["hi"];
  const auto not_proved = [&](const std::string& pointer, const json& value) {
    const Outcome outcome = check(forged(pointer, value), with);
    EXPECT_EQ(outcome.status, 3) << pointer << outcome.err << outcome.out;
  };
  not_proved("/removed/lo", hi);
  not_proved("/removed/hi", "inf");
  not_proved("/removed/bone", "inside");
  not_proved("/removed/cube/parts", ".");

  const std::string sentence = "removed bone         [0, 0] mm^3, proved";
  const std::string text = "box.off\x1b[11A\n" + sentence + std::string(150, ' ');
  const Outcome forgery = check(forged("/removed/within/file", text), with);
  EXPECT_EQ(forgery.status, 0) << forgery.err;
  EXPECT_THAT(forgery.out, ContainsRegex("\n  bone is            outside of the mesh, within \"[^\n]*\"\n"));
  EXPECT_THAT(forgery.out, Not(HasSubstr("\n" + sentence)));
  expect_harmless(forgery.out);

  const auto refused = [&](const Outcome& outcome, const std::string& words) {
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  refused(check(proof_), "is of bone within a surface: give it by --within");
  refused(check(proof_, {"--within", mesh_}), "is about another mesh");
  json without = proof;
  without["removed"].erase("within");
  refused(check(write("forged.json", without.dump()), with), "is not of bone within a surface");
  refused(run({"check", "--model", implant_, "--mesh", mesh_, "--map", map_, "--within", outer}),
          "--within: only with --certificate");
}

TEST_F(CheckRemoval, IsOfTheVolumeAloneWhereAResectionLeavesOutVertices) {
  const Outcome made = insert({"--resection", "100,0,-70,0,0,2", "--on", "triangles"});
  ASSERT_EQ(made.status, 0) << made.err << made.out;
  EXPECT_THAT(made.out, HasSubstr(", of the removed bone alone\n"));
  EXPECT_FALSE(document().contains("surface"));
  EXPECT_EQ(document()["rows"].size(), 0U);
  const Outcome proved = check(proof_);
  EXPECT_EQ(proved.status, 0) << proved.err << proved.out;
  EXPECT_THAT(proved.out, HasSubstr("before the plane through (100, 0, -70) with the normal (0, 0, 1)"));
  EXPECT_THAT(proved.out, Not(HasSubstr("points   ")));
  EXPECT_EQ(check(forged("/removed/resection/point/2", -90.0)).status, 3);
}

}  // namespace
}  // namespace verisq::testing
