/// Whatever texts files hold and are called, the programs' own sentences stay theirs: on the standard output, on the
/// standard error, in JSON and in tables.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fixtures/hostile_texts.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using nlohmann::json;
using ::testing::AnyOf;
using ::testing::HasSubstr;

/// One of each kind: starting the programs with all would take a minute.
std::vector<std::string> some_texts() {
  const std::string forged(forged_sentence);
  std::string wide;
  for (int i = 0; i < 150; ++i) wide += "\u2003";
  return {"\n" + forged,           "\x1b[11A" + forged, "\u202e" + forged,
          "\u2028" + forged,       "\u009b" + forged,   forged + wide,
          "\u200b\u00a0" + forged, "\"" + forged,       std::string(150, 'a') + forged,
          "mm, " + forged};
}

class ForeignText : public ProgramTest {
 protected:
  void expect_own_sentences(const Outcome& outcome) const {
    EXPECT_THAT(outcome.status, AnyOf(0, 2, 3)) << outcome.err;
    expect_no_forged_sentence(outcome.out);
    expect_no_forged_sentence(outcome.err);
    if (outcome.status == 2) {
      EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    }
    EXPECT_EQ(outcome.status == 2, outcome.out.empty()) << outcome.out << outcome.err;
  }

  /// In words and in JSON, whose texts are those of the file.
  void expect_own_sentences_of(const Arguments& arguments) const {
    expect_own_sentences(run(arguments));
    Arguments with_json = arguments;
    with_json.emplace_back("--json");
    const Outcome outcome = run(with_json);
    expect_own_sentences(outcome);
    if (outcome.status != 2) {
      EXPECT_TRUE(json::accept(outcome.out)) << outcome.out;
    }
    EXPECT_TRUE(std::ranges::all_of(outcome.out, [](char c) { return c == '\n' || (' ' <= c && c <= '~'); }))
        << outcome.out;
  }

  [[nodiscard]] std::string ball(const std::string& file, const std::string& name, const std::string& units) const {
    const json primitive{{"name", name}, {"superquadric", {{"semi_axes", {1, 1, 1}}, {"exponents", {1, 1}}}}};
    return write(file, json{{"format", "verisq-model/1"}, {"units", units}, {"primitives", {primitive}}}.dump());
  }

  [[nodiscard]] static json read(const std::string& file) {
    std::ifstream in(file);
    return json::parse(in);
  }

  std::string mesh_ = write("mesh.off", "OFF\n4 4 0\n2 0 0\n4 0 0\n2 1 0\n2 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  std::string poses_ = write("poses.csv", "3,0,0,1,0,0,0\n4,0,0,1,0,0,0\n");
};

TEST_F(ForeignText, OfModelsIsNoSentence) {
  for (const std::string& text : some_texts()) {
    const std::string model = ball("model.json", text, text);
    const std::string other = ball("other.json", "b", text);
    expect_own_sentences_of({"map", "--model", model, "--mesh", mesh_, "--device", "host", "-o", path("m.csv")});
    expect_own_sentences_of({"distance", model, other, "--pose", "3,0,0,1,0,0,0"});
    expect_own_sentences_of({"path", model, other, "--poses", poses_});
    expect_own_sentences_of({"octree", "--model", model, "--depth", "1", "--device", "host", "-o", path("o.vtu")});
    expect_own_sentences(run({"distance", model, ball("mm.json", "b", "mm"), "--pose", "3,0,0,1,0,0,0"}));
  }
}

TEST_F(ForeignText, OfCertificatesOfFeaturesIsNoSentence) {
  const std::string landmarks = places::example("femur_landmarks.json");
  const std::string proof = path("proof.json");
  ASSERT_EQ(run({"features", "--landmarks", landmarks, "--certificate-file", proof}).status, 0);
  const json document = read(proof);
  for (const std::string& text : some_texts()) {
    json forged = document;
    forged["features"][0]["name"] = text;
    forged["features"][1]["method"] = text;
    const Arguments check{"check", "--certificate", write("forged.json", forged.dump())};
    expect_own_sentences_of(check);
    expect_numbers_before_names(run(check).out);
    json renamed = read(landmarks);
    renamed["landmarks"][text] = {1, 2, 3};
    expect_own_sentences(run({"features", "--landmarks", write("landmarks.json", renamed.dump())}));
  }
}

/// A file may be called anything.
TEST_F(ForeignText, OfFileNamesIsNoSentence) {
  const std::string a = ball("a.json", "a", "mm");
  std::vector<std::string> texts = some_texts();
  texts.insert(texts.end(), {"\xff", "\xc0\x8a" + std::string(forged_sentence)});
  for (const std::string& text : texts) {
    if (text.size() > 200) continue;
    const std::string name = path(text + ".json");
    Outcome outcome = run({"distance", a, a, "--pose", "3,0,0,1,0,0,0", "--certificate-file", name});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    expect_own_sentences(outcome);
    outcome =
        Process({places::check_program(), "--certificate", name, "--model", a, "--model", a}, folder_.path()).wait();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    expect_own_sentences(outcome);
    expect_own_sentences(run({"distance", a, path(text)}));
    std::filesystem::remove(name);
  }
}

TEST_F(ForeignText, OfModelsOfStanceIsRefused) {
  std::ifstream in(places::example("standing.xml"));
  const std::string xml{std::istreambuf_iterator<char>(in), {}};
  const auto with = [&](std::string_view name, const std::string& text) {
    std::string changed = xml;
    for (std::size_t at = 0; (at = changed.find(name, at)) != std::string::npos; at += text.size())
      changed.replace(at, name.size(), text);
    return write("stance.xml", changed);
  };
  EXPECT_EQ(run({"stance", with("pelvis", "Becken")}).status, 0);
  for (const char* const name : {"pelvis", "right hindfoot"}) {
    for (const char* const text : {"&#10;proved", "&#27;[1A", "a  b", "&#x202e;", "&#160;a", "&quot;a"}) {
      const Outcome outcome = run({"stance", with(name, text)});
      expect_own_sentences(outcome);
      if (std::string_view(text) != "&quot;a") {
        EXPECT_EQ(outcome.status, 2) << text;
      }
    }
  }
}

/// What begins like a formula is none to a spreadsheet.
TEST_F(ForeignText, OfManifestsIsNeitherSentenceNorFormula) {
  const std::string good = ball("good.json", "a", "=1+1");
  const std::string manifest = write("manifest.csv", "case,model,mesh,device\ngood," + good + "," + mesh_ +
                                                         ",host\nbad,\"\x1b[2J=1+1.json\"," + mesh_ + ",host\n");
  const Outcome outcome = run({"batch", manifest, "-o", path("out")});
  expect_own_sentences(outcome);
  std::ifstream in(path("out") + "/summary.csv");
  const std::string table{std::istreambuf_iterator<char>(in), {}};
  expect_harmless(table);
  EXPECT_THAT(table, HasSubstr(",'=1+1,"));
  std::ifstream page(path("out") + "/overview.html");
  expect_harmless(std::string{std::istreambuf_iterator<char>(page), {}});
  expect_own_sentences(run({"batch", write("m.csv", "case,model\n=\x1b[2J,a\n"), "-o", path("none")}));
  expect_own_sentences(run({"batch", write("m.csv", "case,\u202emodel\na,a\n"), "-o", path("none")}));
}

}  // namespace
}  // namespace verisq::testing
