/// The distance along a path is proved from its file alone, and no forgery of it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/proof_file_test.hpp"

namespace verisq::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// A capsule passes another one, turning; or meets it.
class CheckPath : public ProofFileTest {
 protected:
  [[nodiscard]] Outcome travel(const std::string& poses, const Arguments& more = {}) const {
    Arguments arguments{"path",         a_, b_, "--poses", write("path.csv", poses), "--certificate-file", proof_,
                        "--no-progress"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  [[nodiscard]] Outcome check(const std::string& proof, const Arguments& more = {}) const {
    Arguments arguments{places::check_program(), "--model", a_, "--model", b_, "--certificate", proof};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Process(arguments, folder_.path()).wait();
  }

  void expect_not_proved(const std::string& pointer, const json& value) const {
    const Outcome outcome = check(forged(pointer, value));
    EXPECT_EQ(outcome.status, 3) << pointer << " " << value << outcome.out << outcome.err;
  }

  const std::string passing_ = "-5,2.5,0,1,0,0,0\n5,2.5,0,0.8,0.1,0.2,0\n";
  const std::string meeting_ = "-5,1.2,0,1,0,0,0\n5,1.2,0,0.8,0.1,0.2,0\n";
  std::string a_ = places::example("capsule.json");
  std::string b_ = places::example("gem.json");
};

TEST_F(CheckPath, ProvesAFreeWay) {
  const Outcome found = travel(passing_, {"--json"});
  ASSERT_EQ(found.status, 0) << found.out << found.err;
  const json said = json::parse(found.out);
  EXPECT_EQ(said["certificate"], proof_);
  EXPECT_EQ(said["certified"]["lo"], document()["smallest"]["lo"]);
  const Outcome outcome = check(proof_);
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("  proved   smallest distance of all times: ["));
  EXPECT_THAT(outcome.out, HasSubstr("the models           apart at all times, between the poses too\n"));
  EXPECT_THAT(outcome.out, HasSubstr("the path begins at   -5,2.5,0,1,0,0,0: translation, quaternion\n"));
  EXPECT_THAT(outcome.out, HasSubstr("  is it the path that was meant? That is not proved"));
  const json object = json::parse(check(proof_, {"--json"}).out);
  EXPECT_EQ(object["kind"], "path");
  EXPECT_EQ(object["contact"], "never");
  EXPECT_EQ(object["claims"][0]["verdict"], "proved");
  EXPECT_EQ(object["claims"].size(), 1U);
  EXPECT_EQ(object["parts"], document()["parts"].size());
}

TEST_F(CheckPath, ProvesWhenTheyFirstMeet) {
  EXPECT_EQ(travel(meeting_).status, 3);
  const Outcome outcome = check(proof_);
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("  proved   smallest distance of all times: [0, 0]"));
  EXPECT_THAT(outcome.out, HasSubstr("  proved   time of the first contact: ["));
  EXPECT_THAT(outcome.out, HasSubstr("the models           meet: no common point before the first contact\n"));
  EXPECT_EQ(json::parse(check(proof_, {"--json"}).out)["contact"], "meets");
  const std::string nothing = forged("/first_contact", {{"lo", 0}, {"hi", "inf"}});
  EXPECT_EQ(json::parse(check(nothing, {"--json"}).out)["contact"], "not_claimed");
}

TEST_F(CheckPath, NeverProvesAForgery) {
  ASSERT_EQ(travel(passing_).status, 0);
  const double lo = document()["smallest"]["lo"];
  const double hi = document()["smallest"]["hi"];
  expect_not_proved("/smallest/lo", hi + 1e-12);
  expect_not_proved("/smallest/hi", lo - 1e-12);
  expect_not_proved("/smallest", {{"lo", 0}, {"hi", "inf"}});
  expect_not_proved("/parts", json::array());
  expect_not_proved("/parts/0/until", 2.5);
  expect_not_proved("/nearest/time", 0.0);
  expect_not_proved("/nearest/proof", {{"separations", json::array()}});
  expect_not_proved("/first_contact", {{"lo", 0}, {"hi", 1}});
  expect_not_proved("/path/1/translation/1", 2.4);
  expect_not_proved("/path/1/quaternion/1", 0.9);
}

TEST_F(CheckPath, NeverProvesAForgeryOfAMeeting) {
  ASSERT_EQ(travel(meeting_).status, 3);
  const double apart_before = document()["first_contact"]["lo"];
  const double meet_at = document()["first_contact"]["hi"];
  expect_not_proved("/first_contact/lo", meet_at + 1e-12);
  expect_not_proved("/first_contact/hi", apart_before - 1e-12);
  expect_not_proved("/first_contact", {{"lo", "inf"}, {"hi", "inf"}});
  expect_not_proved("/smallest", {{"lo", 0.01}, {"hi", 0.02}});
  expect_not_proved("/nearest/proof/common", {0, 0, 5});
  expect_not_proved("/parts", json::array());
}

/// Of claims that are not proved, nothing is said of how the models pass.
TEST_F(CheckPath, SaysNothingOfAContactThatIsNotProved) {
  ASSERT_EQ(travel(passing_).status, 0);
  const Outcome outcome = check(forged("/parts", json::array()));
  EXPECT_THAT(outcome.out, HasSubstr("  unproved smallest distance of all times: ["));
  EXPECT_THAT(outcome.out, HasSubstr("           proven of it: [0, "));
  EXPECT_THAT(outcome.out, Not(HasSubstr("the models ")));
}

TEST_F(CheckPath, IsOfNoOtherModelPathOrForm) {
  ASSERT_EQ(travel(passing_).status, 0);
  const auto refused = [&](const Outcome& outcome, const std::string& words) {
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  refused(check(forged("/models/0/sha256", std::string(64, '0'))), "is about another model");
  refused(check(forged("/units", "cm")), "are not those of the models");
  refused(check(forged("/path", json::array())), "path = []: must not be empty");
  refused(check(forged("/parts/0/until", -1)), "parts[0].until = -1: must be at least 0");
  refused(check(forged("/parts/0/proof", json::object())), "separations");
  refused(check(forged("/smallest", {{"lo", 0}})), "hi");
  refused(check(proof_, {"--map", "map.csv"}), "is of two models, not of a map");
  refused(run({"check", "--model", a_, "--certificate", proof_}), "is about 2 models");
  EXPECT_EQ(check(proof_, {"--poses", path("path.csv")}).status, 0);
  EXPECT_THAT(check(proof_, {"--poses", path("path.csv")}).out, HasSubstr("path.csv\", pose by pose\n"));
  refused(check(proof_, {"--poses", write("other.csv", "-5,2.5,0,1,0,0,0\n5,2.5,1,0.8,0.1,0.2,0\n")}),
          "is of other poses: pose 1 is 5,2.5,0,0.8,0.1,0.2,0, not 5,2.5,1,0.8,0.1,0.2,0");
  refused(check(proof_, {"--poses", write("fewer.csv", "-5,2.5,0,1,0,0,0\n")}), "is of 2 poses, not of 1");
}

TEST_F(CheckPath, IsOfBendsAndSetOperationsToo) {
  a_ = places::example("bent_stem.json");
  b_ = places::example("stem.json");
  const Outcome found = travel("1.5,0,0,1,0,0,0\n1,0.2,0.1,1,0,0,0.2\n", {"--clearance", "0.05"});
  ASSERT_EQ(found.status, 0) << found.out << found.err;
  EXPECT_EQ(check(proof_).status, 0);
  const double hi = document()["smallest"]["hi"];
  expect_not_proved("/smallest/lo", hi + 1e-12);
  expect_not_proved("/parts", json::array());
}

}  // namespace
}  // namespace verisq::testing
