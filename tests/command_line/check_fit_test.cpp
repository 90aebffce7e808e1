/// What a fit claims of its distances is proved from its files alone, and no forgery of them is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/fixtures/hostile_texts.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/proof_file_test.hpp"

namespace verisq::testing {
namespace {

using nlohmann::json;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

class CheckFit : public ProofFileTest {
 protected:
  void SetUp() override {
    const json upper{{"name", "upper"}, {"weight", 3}, {"box", {{-999, -999, -150}, {999, 999, 999}}}};
    write_short_stem({{"areas", json::array({upper})}});
    const Outcome outcome =
        fit({"-o", fitted_, "--map", map_, "--surface-map", surface_, "--certificate-file", proof_});
    ASSERT_TRUE(outcome.status == 0 || outcome.status == 3) << outcome.err;
  }

  [[nodiscard]] Outcome fit(const Arguments& more) const {
    Arguments arguments{"fit",
                        "--implant",
                        path("stem.json"),
                        "--mesh",
                        mesh_,
                        "--any-side",
                        "--on",
                        "vertices",
                        "--translation-range",
                        "0.5",
                        "--rotation-range",
                        "1",
                        "--samples",
                        "16",
                        "--device",
                        "host",
                        "--penetration-limit",
                        "0.01",
                        "--no-progress"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  [[nodiscard]] Outcome check_with(const std::string& map, const std::string& surface, const std::string& proof,
                                   const Arguments& more = {}) const {
    return checked(proof, {"--model", fitted_, "--mesh", mesh_, "--map", map, "--surface-map", surface}, more);
  }

  void expect_not_proved(const std::string& pointer, const json& value) const {
    const Outcome outcome = check_with(map_, surface_, forged(pointer, value));
    EXPECT_EQ(outcome.status, 3) << pointer << " " << value << outcome.out << outcome.err;
  }

  std::string mesh_ = places::example("cavity.off");
  std::string fitted_ = path("fitted.json");
  std::string map_ = path("map.csv");
  std::string surface_ = path("surface.vtp");
};

TEST_F(CheckFit, ProvesEveryDistanceAndWhatTheySayTogether) {
  const Outcome outcome = check_with(map_, surface_, proof_);
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("points               786\n  proved             786\n"));
  EXPECT_THAT(outcome.out, HasSubstr("triangles            1568\n  proved             1568\n"));
  EXPECT_THAT(outcome.out, HasSubstr("claims of the fit    15\n  proved             15\n"));
  EXPECT_THAT(outcome.out, ContainsRegex("  proved   \\[[^]]+\\]: F of the vertices\n"));
  EXPECT_THAT(
      outcome.out,
      ContainsRegex(
          "  proved   \\[[^]]+\\] mm: distance of the whole surface, 0 where it meets or enters the implant\n"));
  EXPECT_THAT(outcome.out, ContainsRegex("  proved   \\[[^]]+\\] mm: mean distance of the vertices, area \"upper\"\n"));
  EXPECT_THAT(outcome.out, HasSubstr("limit                0.01 mm: kept, proven of all 786 vertices\n"));
  EXPECT_THAT(outcome.out,
              ContainsRegex("area                 weight 3, [0-9]+ vertices, which the certificate names \"upper\"\n"));
  EXPECT_THAT(outcome.out, HasSubstr("not claimed          whether the implant lies inside, outside or beside the "
                                     "mesh, areas in contact"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("sides of the mesh")));
  const Outcome as_json = check_with(map_, surface_, proof_, {"--json"});
  const json object = json::parse(as_json.out);
  EXPECT_EQ(object["kind"], "fit");
  EXPECT_EQ(object["vertices"]["proved"], 786);
  EXPECT_EQ(object["surface"]["proved"], 1568);
  ASSERT_EQ(object["claims"].size(), 15U);
  for (const json& claim : object["claims"]) EXPECT_EQ(claim["verdict"], "proved") << claim;
}

TEST_F(CheckFit, NeverProvesAForgery) {
  const json proven = json::parse(check_with(map_, surface_, proof_, {"--json"}).out)["claims"];
  for (std::size_t i = 0; i < proven.size(); ++i) {
    const std::string claim = "/claims/" + std::to_string(i);
    const double lo = proven[i]["proven"]["lo"];
    const double hi = proven[i]["proven"]["hi"];
    expect_not_proved(claim + "/lo", hi + 1e-12 * std::max(1.0, std::abs(hi)));
    expect_not_proved(claim + "/hi", lo - 1e-12 * std::max(1.0, std::abs(lo)));
    expect_not_proved(claim + "/what", "clearance");
  }
  const json everything{{"lo", "-inf"}, {"hi", "inf"}};
  for (const json& name : {json{{"what", "inside the cavity"}}, json{{"what", "mean_distance"}, {"area", "all"}},
                           json{{"what", "surface_distance"}, {"area", "upper"}}}) {
    json claim = name;
    claim.update(everything);
    expect_not_proved("/claims", json::array({claim}));
  }
  expect_not_proved("/areas/0/weight", 3.5);
  expect_not_proved("/areas/0/name", "lower");
  expect_not_proved("/criterion/scale", 1.99);
  expect_not_proved("/criterion/serves/hi", proven[6]["proven"]["lo"].get<double>());
  expect_not_proved("/area_runs", {{1, 786}});
}

TEST_F(CheckFit, IsOfNoOtherModelMeshOrMap) {
  const auto refused = [&](const Outcome& outcome, const std::string& words) {
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  refused(check_with(map_, surface_, forged("/models/0/sha256", std::string(64, '0'))), "is about another model");
  refused(check_with(map_, surface_, forged("/mesh/sha256", std::string(64, '0'))), "is about another mesh");
  refused(check_with(map_, surface_, forged("/area_runs", {{0, 100}})), "are of 100 vertices, and the mesh has 786");
  refused(check_with(map_, surface_, forged("/units", "cm")), "are not those of the model, \"mm\"");
  refused(check_with(map_, surface_, forged("/areas/0/name", "")), "must not be empty");
  refused(check_with(map_, surface_, forged("/areas/0/name", "a\n  proved   sides")), "no control characters");
  refused(check_with(map_, surface_, forged("/claims/0/what", "a\u001b[2K")), "no control characters");
  refused(check_with(surface_, surface_, proof_), "is no map of vertices");
  refused(check_with(map_, map_, proof_), "is no map of triangles");
  refused(run({"check", "--model", fitted_, "--mesh", mesh_, "--map", map_, "--certificate", proof_}),
          "give the --surface-map");
  refused(run({"check", "--model", fitted_, "--mesh", mesh_, "--certificate", proof_}),
          "give the --mesh, and the --map");
  refused(run({"check", "--model", fitted_, "--model", fitted_, "--certificate", proof_}), "give one --model");
  // Of another place of the implant everything is false.
  std::ifstream in(fitted_);
  json other = json::parse(in);
  other["primitives"][0]["pose"]["translation"][0] = 30.0;
  (void)write("fitted.json", other.dump());
  refused(check_with(map_, surface_, proof_), "is about another model");
}

/// A number that a name states is none that is proved.
TEST_F(CheckFit, ShowsNamesBehindNumbers) {
  json document = this->document();
  const std::string name = "all of the bone: [0.001, 0.002] mm\u2003\u2003";
  document["areas"][0]["name"] = name;
  for (json& claim : document["claims"]) {
    if (claim.contains("area") && claim["area"] == "upper") claim["area"] = name;
  }
  const Outcome outcome = check_with(map_, surface_, write("forged.json", document.dump()));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, ContainsRegex("  proved   \\[[^]]+\\] mm: mean distance of the vertices, area "
                                         "\"all of the bone: \\[0.001, 0.002\\] mm"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("proved   mean")));
  expect_harmless(outcome.out);
}

/// Of a bowl with one rim, in which a ball lies, and another one beside it.
class CheckSidesOfFit : public ProofFileTest {
 protected:
  void SetUp() override {
    (void)write("balls.json", R"({"format": "verisq-model/1", "units": "mm", "primitives": [
      {"name": "ball", "superquadric": {"semi_axes": [2, 2, 2], "exponents": [1, 1]}},
      {"name": "neck", "superquadric": {"semi_axes": [1, 1, 4], "exponents": [1, 1]},
       "pose": {"translation": [0, 0, 4]}}]})");
    std::string off = "OFF\n17 24 0\n0 0 -4\n";
    for (const int height : {-2, 3})
      for (const char* const corner : {"4 0", "3 3", "0 4", "-3 3", "-4 0", "-3 -3", "0 -4", "3 -3"})
        off += std::string(corner) + " " + std::to_string(height) + "\n";
    const auto triangle = [&](int a, int b, int c) {
      off += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
    };
    for (int i = 0; i < 8; ++i) {
      const int next = (i + 1) % 8;
      triangle(0, 1 + next, 1 + i);
      triangle(1 + i, 1 + next, 9 + next);
      triangle(1 + i, 9 + next, 9 + i);
    }
    (void)write("bowl.off", off);
    const Outcome outcome = fit({});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }

  [[nodiscard]] Outcome fit(const Arguments& more) const {
    Arguments arguments{"fit",
                        "--implant",
                        path("balls.json"),
                        "--mesh",
                        path("bowl.off"),
                        "--cavity",
                        "--gap",
                        "2",
                        "--crossing",
                        "neck",
                        "-o",
                        path("f.json"),
                        "--map",
                        path("m.csv"),
                        "--certificate-file",
                        proof_,
                        "--samples",
                        "16",
                        "--device",
                        "host",
                        "--rotation-range",
                        "5",
                        "--translation-range",
                        "1",
                        "--penetration-limit",
                        "0.001",
                        "--no-progress"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  [[nodiscard]] Outcome check_with(const std::string& proof, const Arguments& more = {}) const {
    return checked(proof, {"--model", path("f.json"), "--mesh", path("bowl.off"), "--map", path("m.csv")}, more);
  }
};

TEST_F(CheckSidesOfFit, ProvesThemOfModelAndMeshAlone) {
  const Outcome outcome = check_with(proof_);
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("sides of the mesh    1\n  proved             1\n"));
  EXPECT_THAT(outcome.out, HasSubstr("  proved   all of it that is deeper in it than 0.001 mm lies inside of the "
                                     "mesh, whose normals point outward, closed over its rim by fans: \"ball\"\n"));
  EXPECT_THAT(outcome.out, HasSubstr("  nothing is claimed, may lie on any side: \"neck\"\n"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("beside the mesh")));
  const json object = json::parse(check_with(proof_, {"--json"}).out);
  EXPECT_EQ(object["sides"]["rims"], 1);
  EXPECT_EQ(object["sides"]["faces_outward"], true);
  EXPECT_EQ(object["sides"]["not_claimed"], json::array({"neck"}));
  EXPECT_EQ(object["sides"]["claims"],
            json::array({{{"primitive", "ball"}, {"side", "inside"}, {"verdict", "proved"}}}));
}

TEST_F(CheckSidesOfFit, NeverProvesAForgery) {
  const auto check_of = [&](const json& sides) { return check_with(forged("/sides", sides)); };
  const Outcome other = check_of({{{"primitive", 0}, {"side", "outside"}}});
  EXPECT_EQ(other.status, 3) << other.err;
  EXPECT_THAT(other.out, ContainsRegex("  refuted  all of it.*\"ball\""));
  const Outcome through = check_of({{{"primitive", 0}, {"side", "inside"}}, {{"primitive", 1}, {"side", "inside"}}});
  EXPECT_EQ(through.status, 3) << through.err;
  EXPECT_THAT(through.out, ContainsRegex("  unproved all of it.*\"neck\""));
  const auto refused = [&](const json& sides, const std::string& words) {
    const Outcome outcome = check_of(sides);
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  refused({{{"primitive", 2}, {"side", "inside"}}}, "sides: primitive 2 of");
  refused({{{"primitive", 0}, {"side", "any"}}}, "must be inside or outside");
  refused({{{"primitive", 0}, {"side", "inside"}}, {{"primitive", 0}, {"side", "inside"}}}, "is of a primitive before");
}

TEST_F(CheckFit, SaysThatTheLimitIsExceeded) {
  const Outcome fitted = fit({"-o", fitted_, "--map", map_, "--surface-map", surface_, "--certificate-file", proof_,
                              "--pose-start", "8,0,0,1,0,0,0"});
  EXPECT_EQ(fitted.status, 3) << fitted.err;
  const Outcome outcome = check_with(map_, surface_, proof_);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("limit                0.01 mm: EXCEEDED, proven of "));
  EXPECT_THAT(outcome.out,
              HasSubstr("[0, 0] mm: distance of the whole surface, 0 where it meets or enters the implant\n"));
}

TEST_F(CheckFit, LeavesOpenWhatAnEndedMapDoesNotShow) {
  std::ifstream in(map_);
  std::string line;
  std::string part;
  for (int i = 0; i < 400 && std::getline(in, line); ++i) part += line + "\n";
  const Outcome outcome = check_with(write("map.csv.partial", part), surface_, proof_);
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("missing "));
  EXPECT_THAT(outcome.out, ContainsRegex("  unproved \\[.*\\]: F of the vertices"));
  EXPECT_THAT(
      outcome.out,
      ContainsRegex(
          "  proved   \\[[^]]+\\] mm: distance of the whole surface, 0 where it meets or enters the implant\n"));
}

TEST_F(CheckFit, OfVerticesAloneSaysSo) {
  const std::string alone = path("alone.json");
  const Outcome fitted = fit({"-o", fitted_, "--map", path("map.vtp"), "--certificate-file", alone});
  EXPECT_TRUE(fitted.status == 0 || fitted.status == 3) << fitted.err;
  const Outcome outcome = run({"check", "--model", fitted_, "--mesh", mesh_, "--map", path("map.vtp"), "--certificate",
                               alone, "--no-progress"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("not claimed          whether the implant lies inside, outside or beside the "
                                     "mesh, what lies between the vertices, areas in contact"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("distance of the whole surface")));
}

TEST_F(CheckFit, CertificatesNeedWhatKeepsThem) {
  const auto refused = [&](const Arguments& more, const std::string& words) {
    const Outcome outcome = fit(more);
    EXPECT_EQ(outcome.status, 2) << words;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  refused({"-o", path("f.json"), "--certificate-file", path("c.json")}, "give the --map");
  refused({"-o", path("f.json"), "--certificates"}, "give the --map or the --report");
  refused({"-o", path("f.json"), "--certificates", "--map", path("m.npy")}, ".csv");
  refused({"-o", path("f.json"), "--map", path("m.csv"), "--certificate-file", path("c.csv")}, "is a .json");
  std::filesystem::create_directory_symlink(folder_.path(), folder_.path() / "link");
  refused({"-o", path("f.json"), "--map", path("m.csv"), "--certificate-file", path("link/f.json")}, "two outputs");
  std::filesystem::create_symlink(path("f.json"), path("g.json"));
  refused({"-o", path("f.json"), "--map", path("m.csv"), "--certificate-file", path("g.json")}, "two outputs");
}

}  // namespace
}  // namespace verisq::testing
