/// How much of a fit's mesh is in contact is proved from a file alone, and no forgery of it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <verisq/files.hpp>

#include "tests/fixtures/hostile_texts.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/proof_file_test.hpp"
#include "tests/fixtures/sample_meshes.hpp"

namespace verisq::testing {
namespace {

using nlohmann::json;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

class CheckContact : public ProofFileTest {
 protected:
  void SetUp() override {
    Mesh mesh = sphere_mesh(2);
    for (Point& vertex : mesh.vertices)
      for (double& x : vertex) x *= 6.0;
    write_mesh(mesh_, mesh);
    (void)write("egg.json", R"({"format": "verisq-model/1", "units": "mm",
      "areas": [{"name": "upper", "weight": 3, "box": [[-9, -9, 0], [9, 9, 9]]}],
      "primitives": [{"name": "egg", "superquadric": {"semi_axes": [4, 5, 4.5], "exponents": [1, 0.8]}}]})");
    const Outcome outcome = fit({"-o", fitted_, "--contact-certificate-file", proof_, "--json"});
    ASSERT_TRUE(outcome.status == 0 || outcome.status == 3) << outcome.err;
    said_ = json::parse(outcome.out);
  }

  [[nodiscard]] Outcome fit(const Arguments& more) const {
    Arguments arguments{"fit",
                        "--implant",
                        path("egg.json"),
                        "--mesh",
                        mesh_,
                        "--any-side",
                        "--on",
                        "vertices",
                        "--gap",
                        "1",
                        "--translation-range",
                        "0.5",
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

  [[nodiscard]] Outcome check(const std::string& proof, const Arguments& more = {}) const {
    return checked(proof, {"--model", fitted_, "--mesh", mesh_}, more);
  }

  void expect_not_proved(const std::string& pointer, const json& value) const {
    const Outcome outcome = check(forged(pointer, value));
    EXPECT_EQ(outcome.status, 3) << pointer << " " << value << outcome.out << outcome.err;
  }

  std::string mesh_ = path("sphere.off");
  std::string fitted_ = path("fitted.json");
  json said_;
};

/// What the fit prints, number by number.
TEST_F(CheckContact, ProvesWhatTheFitSays) {
  EXPECT_EQ(said_["contact_certificate_file"], proof_);
  const Outcome outcome = check(proof_);
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("claims               9\n  proved             9\n"));
  EXPECT_THAT(outcome.out, ContainsRegex("  proved   \\[[^]]+\\] %: share, contact:\"upper\"\n"));
  EXPECT_THAT(outcome.out, HasSubstr("no farther than 1 mm from the model's surface"));
  EXPECT_THAT(outcome.out, HasSubstr(" triangles, which the certificate names \"upper\"\n"));
  EXPECT_THAT(outcome.out, HasSubstr("is not proved, but for you to see\n"));
  EXPECT_THAT(outcome.out, HasSubstr("not claimed          how much of the model's own surface is in contact\n"));
  const json object = json::parse(check(proof_, {"--json"}).out);
  EXPECT_EQ(object["kind"], "contact");
  EXPECT_EQ(object["distance"], 1.0);
  EXPECT_EQ(object["unproved_samples"], 0);
  EXPECT_EQ(object["areas"][0]["name"], "upper");
  ASSERT_EQ(object["claims"].size(), 9U);
  for (std::size_t i = 0; i < 9; ++i) {
    const json& claim = object["claims"][i];
    const json& of_fit = said_["contact"]["shares"][i / 3];
    EXPECT_EQ(claim["verdict"], "proved") << claim;
    EXPECT_EQ(claim["name"], of_fit["name"]);
    for (const char* const end : {"lo", "hi"}) {
      const double value = of_fit[claim["what"].get<std::string>()][end];
      EXPECT_NEAR(claim["claimed"][end].get<double>(), value, 1e-12 * std::abs(value)) << claim;
    }
  }
}

/// A number that a name states is none that is proved.
TEST_F(CheckContact, ShowsNamesBehindNumbers) {
  const std::string name = "upper, share: [0, 0.1] %";
  const Outcome outcome = check(forged("/regions/0", name));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              ContainsRegex("  proved   \\[[^]]+\\] %: share, contact:\"upper, share: \\[0, 0.1\\] %\"\n"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("proved   contact")));
  for (const std::string& text : {name + std::string(150, ' ') + "a", "upper\u200b" + std::string(forged_sentence)})
    expect_harmless(check(forged("/regions/0", text)).out);
  EXPECT_EQ(check(forged("/regions/0", "a\n  proved")).status, 2);
  EXPECT_EQ(check(forged("/regions/0", "a\u200fb")).status, 2);
}

TEST_F(CheckContact, NeverProvesAForgery) {
  const json proven = json::parse(check(proof_, {"--json"}).out)["claims"];
  const std::array<std::string, 2> claims{"/of_mesh/", "/by_region/0/"};
  for (std::size_t i = 0; i < 6; ++i) {
    const std::string claim = claims[i / 3] + proven[i]["what"].get<std::string>();
    const double lo = proven[i]["proven"]["lo"];
    const double hi = proven[i]["proven"]["hi"];
    expect_not_proved(claim + "/lo", hi + 1e-12 * std::max(1.0, std::abs(hi)));
    expect_not_proved(claim + "/hi", lo - 1e-12 * std::max(1.0, std::abs(lo)));
  }
  expect_not_proved("/of_mesh/within/hi", "inf");
  expect_not_proved("/distance", 0.9);
  expect_not_proved("/distance", 1.1);
  const std::size_t triangles = 128;
  expect_not_proved("/region_runs", {{1, triangles}});
  expect_not_proved("/triangles", json::array());
  expect_not_proved("/triangles/0", {{"triangle", document()["triangles"][0]["triangle"]}, {"pieces", ""}});
}

TEST_F(CheckContact, ProvesTheImplantsOwnContact) {
  const Outcome made = fit({"-o", fitted_, "--implant-contact", "--contact-certificate-file", proof_, "--json"});
  ASSERT_TRUE(made.status == 0 || made.status == 3) << made.err;
  const Outcome outcome = check(proof_);
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("claims               12\n  proved             12\n"));
  EXPECT_THAT(outcome.out, ContainsRegex("  proved   \\[[^]]+\\] %: share, implant_contact\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\nimplant_contact      of the surface of \"egg\""));
  EXPECT_THAT(outcome.out, Not(HasSubstr("not claimed")));
  const json summary = json::parse(check(proof_, {"--json"}).out);
  EXPECT_EQ(summary["implant_contact_of"], (json{"egg"}));
  const json of_fit = json::parse(made.out)["contact"]["shares"][3];
  EXPECT_EQ(of_fit["name"], "implant_contact");
  for (const std::size_t i : {9U, 10U, 11U}) {
    const json& claim = summary["claims"][i];
    EXPECT_EQ(claim["name"], "implant_contact");
    EXPECT_LE(claim["claimed"]["lo"], of_fit[claim["what"].get<std::string>()]["lo"]);
    const std::string pointer = "/of_model/" + claim["what"].get<std::string>();
    expect_not_proved(pointer + "/lo", claim["proven"]["hi"].get<double>() * (1.0 + 1e-12));
    expect_not_proved(pointer + "/hi", claim["proven"]["lo"].get<double>() * (1.0 - 1e-12));
  }
  expect_not_proved("/of_model/area/hi", "inf");
  expect_not_proved("/surface/patches/0", "");
  const Outcome other = check(forged("/surface/patches/1", ""));
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("has patches of 2 primitives, and the model has 1"));
}

TEST_F(CheckContact, IsOfNoOtherModelMeshOrForm) {
  const auto refused = [&](const Outcome& outcome, const std::string& words) {
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  refused(check(forged("/models/0/sha256", std::string(64, '0'))), "is about another model");
  refused(check(forged("/mesh/sha256", std::string(64, '0'))), "is about another mesh");
  refused(check(forged("/units", "cm")), "units = \"cm\"");
  refused(check(forged("/region_runs", {{0, 100}})), "region_runs: are of 100 triangles, and the mesh has 128");
  refused(check(forged("/vertices/66", {{"lo", 0}, {"hi", 1}, {"normals", json::array()}})),
          "is of 67 vertices, and the mesh has 66");
  refused(check(forged("/triangles/0/triangle", 99999)), "triangle");
  refused(check(proof_, {"--map", path("m.csv")}), "not with --map");
  refused(check(proof_, {"--pose", "0,0,1,1,0,0,0"}), "not with --points, --pose");
  refused(check(proof_, {"--model", fitted_}), "give one --model");
  refused(run({"check", "--model", fitted_, "--certificate", proof_}), "give the --mesh");
}

TEST_F(CheckContact, NothingIsLostWhereAFileCannotBe) {
  const auto refused = [&](const Outcome& outcome, const std::string& words) {
    EXPECT_EQ(outcome.status, 2) << words;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  const std::string other = path("f.json");
  refused(fit({"-o", other, "--contact-certificate-file", "c.txt"}), "--contact-certificate-file c.txt: is a .json");
  refused(fit({"-o", other, "--contact-certificate-file", path("egg.json")}), "--contact-certificate-file");
  refused(fit({"-o", other, "--contact-certificate-file", other}), "two outputs");
  refused(fit({"-o", other, "--contact-certificate-file", proof_, "--resection", "0,0,0,0,0,1"}),
          "not with --resection");
  (void)write("sphere.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n");
  refused(fit({"-o", other, "--contact-certificate-file", proof_}), "has no triangles");
}

}  // namespace
}  // namespace verisq::testing
