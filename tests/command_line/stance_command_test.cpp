/// `verisq stance` as its user meets it: results, the verdict on every cell of the paper, messages and exit status.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>
#include <verisq/stance.hpp>

#include "host/stance/stance_results.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/process.hpp"
#include "tests/fixtures/stance_example.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Arguments = std::vector<std::string>;
using Json = nlohmann::json;

class StanceCommand : public ::testing::Test {
 protected:
  [[nodiscard]] Process start(Arguments arguments) const {
    arguments.insert(arguments.begin(), {places::program(), "stance"});
    return {arguments, folder_.path()};
  }
  [[nodiscard]] Outcome stance(Arguments arguments) const { return start(std::move(arguments)).wait(); }
  [[nodiscard]] Outcome stance_of_example(Arguments arguments) const {
    arguments.insert(arguments.begin(), example());
    return stance(arguments);
  }
  [[nodiscard]] Json json_of_example(Arguments arguments) const {
    arguments.emplace_back("--json");
    const Outcome outcome = stance_of_example(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return Json::parse(outcome.out);
  }
  /// A copy of the file in which each first text, which must be there, is replaced once by the second.
  [[nodiscard]] std::string with(const std::string& file,
                                 const std::vector<std::pair<std::string, std::string>>& replacements) const {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    std::string xml = text.str();
    for (const auto& [from, to] : replacements) {
      const std::size_t at = xml.find(from);
      EXPECT_NE(at, std::string::npos) << from;
      if (at != std::string::npos) xml.replace(at, from.size(), to);
    }
    return folder_.file("changed.xml", xml).string();
  }
  [[nodiscard]] static std::string example() { return places::example("stance.xml"); }
  [[nodiscard]] static std::string standing() { return places::example("standing.xml"); }
  void expect_refused(const Arguments& arguments, const std::string& message) const {
    const Outcome outcome = stance(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err, "verisq: " + message + "\n");
    EXPECT_EQ(outcome.out, "");
  }

  TemporaryFolder folder_;
};

/// The ends contain the exact ones, at a distance of rounding errors.
void expect_ends(const Json& enclosure, double lo, double hi) {
  EXPECT_LE(enclosure["lo"], lo);
  EXPECT_GE(enclosure["hi"], hi);
  EXPECT_NEAR(enclosure["lo"], lo, 1e-9);
  EXPECT_NEAR(enclosure["hi"], hi, 1e-9);
}

// g (mp + 30.82), and so on, of docs/stance.md §1 in the decimals of the model, a little rounded towards the inside.
TEST_F(StanceCommand, EnclosesTheWrenchTightly) {
  const Json json = json_of_example({});
  EXPECT_EQ(json["mode"], "tight");
  EXPECT_EQ(json["uncertain"].size(), 13U);
  expect_ends(json["wrench"]["w1"], 0.0, 200.0);
  expect_ends(json["wrench"]["w2"], -939.99419999999, -595.69420000001);
  expect_ends(json["wrench"]["w4"], -31.88249999999, 31.88249999999);
  EXPECT_GE(json["wrench"]["w6"]["lo"], -18.2826);
  EXPECT_LE(json["wrench"]["w6"]["hi"], 13.6001);
}

TEST_F(StanceCommand, PaperModeHasThePapersDependency) {
  const Json json = json_of_example({"--mode", "paper", "--uncertain", "px,mp,Fx"});
  EXPECT_EQ(json["mode"], "paper");
  EXPECT_EQ(json["uncertain"], Json({"Fx", "mp", "px"}));
  EXPECT_NEAR(json["wrench"]["w6"]["lo"], -50.165, 1e-3);
  EXPECT_NEAR(json["wrench"]["w6"]["hi"], 45.4826, 1e-3);
}

TEST_F(StanceCommand, NothingUncertainGivesTheNominalWrench) {
  const Json json = json_of_example({"--uncertain", "none"});
  EXPECT_EQ(json["uncertain"].size(), 0U);
  expect_ends(json["wrench"]["w2"], -767.8442, -767.8442);
}

TEST_F(StanceCommand, SamplesStayInsideAndFillTheEnclosures) {
  const Json json = json_of_example({"--monte-carlo", "20000"});
  EXPECT_EQ(json["samples"], 20000);
  for (const char* component : {"w1", "w2", "w4", "w6"}) {
    const Json& enclosure = json["wrench"][component];
    EXPECT_GT(enclosure["filled"], 0.9) << component;
    EXPECT_LE(enclosure["filled"], 1.0) << component;
    EXPECT_LE(enclosure["lo"], enclosure["sampled"]["lo"]);
    EXPECT_GE(enclosure["hi"], enclosure["sampled"]["hi"]);
  }
}

TEST_F(StanceCommand, TakesTheSameSamplesEachTime) {
  const Arguments arguments{"--monte-carlo", "5000"};
  EXPECT_EQ(json_of_example(arguments)["wrench"], json_of_example(arguments)["wrench"]);
}

TEST_F(StanceCommand, EnclosesSensitivitiesByEveryParameter) {
  const Json json = json_of_example({"--uncertain", "none", "--sensitivities"});
  EXPECT_EQ(json["sensitivities"].size(), 14U);
  expect_ends(json["sensitivities"]["mp"]["w2"], -9.81, -9.81);
  expect_ends(json["sensitivities"]["mf"]["w4"], 9.81 * 0.0795, 9.81 * 0.0795);
  expect_ends(json["sensitivities"]["omega"]["w1"], 0.0, 0.0);
  EXPECT_EQ(json["reference_uncertainty"]["by_radius"]["w6"], 0.0);  // nothing is uncertain
}

TEST_F(StanceCommand, TheReferenceUncertaintyIsOfTheUncertainParameters) {
  const Json json = json_of_example({"--uncertain", "Fx", "--sensitivities"});
  expect_ends(json["reference_uncertainty"]["by_value"]["w1"], 0.0, 200.0);
  EXPECT_NEAR(json["reference_uncertainty"]["by_radius"]["w1"], 100.0, 1e-9);
}

TEST_F(StanceCommand, EnclosesAccelerations) {
  const Json json = json_of_example({"--uncertain", "mp,px", "--accelerations", "--monte-carlo", "200"});
  EXPECT_EQ(json["accelerations"].size(), 26U);
  const Json& rise = json["accelerations"]["pelvis ty"];
  EXPECT_LT(rise["lo"], rise["sampled"]["lo"]);
  EXPECT_GT(rise["hi"], rise["sampled"]["hi"]);
  EXPECT_GT(rise["filled"], 0.8);
}

TEST_F(StanceCommand, EnclosesAccelerationsOverAllParameters) {
  const Json json = json_of_example({"--accelerations", "--cells", "2", "--monte-carlo", "200"});
  EXPECT_EQ(json["uncertain"].size(), 13U);
  for (const Json& enclosure : json["accelerations"]) EXPECT_TRUE(enclosure["hi"].is_number());
}

/// Words of a list.
std::vector<std::string> words(const Json& list) {
  return list.get<std::vector<std::string>>();
}

TEST_F(StanceCommand, EnclosesAccelerationsOnTheGround) {
  const std::string standing = places::example("standing.xml");
  const auto json_at = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{standing, "--json", "--uncertain", "mp,k", "--monte-carlo", "500"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = stance(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return Json::parse(outcome.out);
  };
  const Json in_contact = json_at({"--accelerations", "contact"});
  EXPECT_EQ(in_contact["accelerations_case"], "contact");
  EXPECT_EQ(in_contact["accelerations_joints"], Json::object());
  EXPECT_EQ(in_contact["acceleration_samples"], 500);
  EXPECT_THAT(words(in_contact["accelerations_scope"]["acts"]),
              ::testing::Contains("elastic force of all cylinders that touch the ground"));
  EXPECT_EQ(in_contact["accelerations_scope"]["parameters_without_effect"], Json::array());

  const Json still = json_at({"--accelerations", "standing"});
  EXPECT_LT(still["accelerations"]["pelvis ty"]["lo"], 0.0);
  EXPECT_GT(still["accelerations"]["pelvis ty"]["hi"], 0.0);
  EXPECT_GT(still["accelerations"]["pelvis ty"]["filled"], 0.8);

  const Json deeper = json_at({"--accelerations", "contact", "--joint", "pelvis ty=0.97"});
  EXPECT_EQ(deeper["accelerations_joints"], Json({{"pelvis ty", 0.97}}));
  EXPECT_GT(deeper["accelerations"]["pelvis ty"]["lo"], in_contact["accelerations"]["pelvis ty"]["hi"]);
  const Json above = json_at({"--accelerations", "--joint", "pelvis ty=3"});
  EXPECT_EQ(above["accelerations_case"], "fall");
  expect_ends(above["accelerations"]["pelvis ty"], -9.81, -9.81);

  const Outcome readable =
      stance({standing, "--uncertain", "mp", "--accelerations", "contact", "--joint", "right tibia rz=-0.1"});
  EXPECT_THAT(readable.out, HasSubstr("\njoint accelerations in contact with the ground\n  at -0.1 rad: \"right "
                                      "tibia rz\"\n"));
  EXPECT_THAT(readable.out, HasSubstr("does NOT act: friction, whose bristles are not stretched yet"));
  expect_refused({standing, "--accelerations", "flying"},
                 "--accelerations: flying is not one of fall, contact, standing");
  expect_refused({standing, "--joint", "pelvis ty=1"}, "--joint: give --accelerations, too");
  expect_refused({standing, "--accelerations", "--joint", "pelvis ty"}, "--joint: pelvis ty is not NAME=NUMBER");
  expect_refused({standing, "--accelerations", "--joint", "pelvis ty=high"},
                 "--joint pelvis ty=high: 'high' is not a finite number");
  EXPECT_THAT(stance({standing, "--accelerations", "--joint", "tail rz=1"}).err,
              HasSubstr("--joint: 'tail rz' is not one of pelvis tx, pelvis ty, "));
  expect_refused({standing, "--accelerations", "standing", "--joint", "pelvis rx=0.1"},
                 "accelerations: pelvis rx is what the equilibrium says, and not to be given");
}

TEST_F(StanceCommand, SaysThatAccelerationsStayUnproven) {
  // The hip may lie anywhere within 10 m: no one cell proves that all of these mass matrices are regular.
  const std::string model =
      with(example(), {{R"(<offset x="0" y="0" z="0.0795"/>)",
                        R"(<offset x="0" y="0"><z parameter="hip" lower="-10" upper="10"/></offset>)"}});
  const Outcome outcome = stance({model, "--uncertain", "hip", "--accelerations", "--cells", "1", "--json"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_TRUE(Json::parse(outcome.out)["accelerations"]["pelvis ty"]["lo"].is_null());
}

TEST_F(StanceCommand, DropsACylinder) {
  const Json json = json_of_example({"--uncertain", "none", "--bounce", "left hindfoot", "--drop-height", "0.02"});
  const Json& bounce = json["bounce"];
  EXPECT_EQ(bounce["proven"], true);
  EXPECT_EQ(bounce["mass"], Json({{"lo", 0.84}, {"hi", 0.84}}));
  EXPECT_EQ(bounce["impact_velocity"], Json({{"lo", 1.0}, {"hi", 1.0}}));
  EXPECT_EQ(bounce["radius"]["lo"], std::midpoint(0.02, 0.15));
  EXPECT_EQ(bounce["radius"]["lo"], bounce["radius"]["hi"]);
  const double speed = std::sqrt(2.0 * 9.81 * 0.02);
  EXPECT_LE(bounce["touch_down_speed"]["lo"], speed * (1.0 + 1e-15));
  EXPECT_GE(bounce["touch_down_speed"]["hi"], speed * (1.0 - 1e-15));
  EXPECT_GT(bounce["rebound_speed"]["lo"], 0.0);
  EXPECT_LT(bounce["rebound_speed"]["hi"], speed);
}

/// Expects the bounce's end to contain the value, within one per cent.
void expect_lower_end(const Json& enclosure, double value) {
  EXPECT_LE(enclosure["lo"], value);
  EXPECT_NEAR(enclosure["lo"], value, 0.01 * value);
}

void expect_upper_end(const Json& enclosure, double value) {
  EXPECT_GE(enclosure["hi"], value);
  EXPECT_NEAR(enclosure["hi"], value, 0.01 * value);
}

// In long double, by Runge-Kutta steps of 10^-7 s, for the least and the greatest mass; the digits that are cut make
// the ranges smaller.
TEST_F(StanceCommand, DropsAFootOfUncertainMass) {
  const std::string model = with(
      example(), {{R"(<mass value="0.36"/>)", R"(<mass parameter="mff" unit="kg" nominal="0.36" deviation="0.18"/>)"}});
  const Outcome outcome = stance({model, "--uncertain", "mff", "--bounce", "right forefoot", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const Json bounce = Json::parse(outcome.out)["bounce"];
  EXPECT_EQ(bounce["mass"]["lo"], 0.18);
  EXPECT_NEAR(bounce["mass"]["hi"], 0.54, 1e-15);
  EXPECT_EQ(bounce["proven"], true);
  expect_lower_end(bounce["deepest_penetration"], 3.2406836098e-4);
  expect_upper_end(bounce["deepest_penetration"], 5.6757165057e-4);
  expect_lower_end(bounce["rebound_speed"], 0.0704137218);
  expect_upper_end(bounce["rebound_speed"], 0.0849221328);
  expect_lower_end(bounce["lift_off_time"], 0.0506552717);
  expect_upper_end(bounce["lift_off_time"], 0.0552724288);
}

// At the touch-down speed, with the masses of the same file: 0.54 kg stay on the ground.
TEST_F(StanceCommand, DropsAFootOfUncertainMassThatMayStay) {
  const std::string model = with(
      example(), {{R"(<mass value="0.36"/>)", R"(<mass parameter="mff" unit="kg" nominal="0.36" deviation="0.18"/>)"},
                  {R"(<cylinder name="right forefoot" body="right forefoot" half_length="0.04"
            stiffness="1e5" exponent="1" impact_velocity="1")",
                   R"(<cylinder name="right forefoot" body="right forefoot" half_length="0.04"
            stiffness="1e5" exponent="1" impact_velocity="0.442944691807002")"}});
  const Outcome outcome = stance({model, "--uncertain", "mff", "--bounce", "right forefoot", "--json"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;  // no end of the time on the ground
  const Json bounce = Json::parse(outcome.out)["bounce"];
  EXPECT_EQ(bounce["proven"], true);
  EXPECT_NEAR(bounce["deepest_penetration"]["lo"], 2.391e-4, 1e-7);
  EXPECT_NEAR(bounce["deepest_penetration"]["hi"], 4.178e-4, 1e-7);
  EXPECT_EQ(bounce["rebound_speed"]["lo"], 0.0);
  EXPECT_TRUE(bounce["lift_off_time"]["hi"].is_null());
}

TEST_F(StanceCommand, TheImpactVelocityActs) {
  const Json forefoot = json_of_example({"--uncertain", "none", "--bounce", "right forefoot"})["bounce"];
  EXPECT_NEAR(forefoot["rebound_speed"]["lo"], 0.07699, 1e-5);
  const Json hindfoot = json_of_example({"--uncertain", "none", "--bounce", "right hindfoot"})["bounce"];
  EXPECT_NEAR(hindfoot["rebound_speed"]["lo"], 0.0606, 1e-4);
}

TEST_F(StanceCommand, AnImpactVelocityOfTheFileIsARange) {
  const std::string model =
      with(example(), {{R"(<cylinder name="right forefoot" body="right forefoot" half_length="0.04"
            stiffness="1e5" exponent="1" impact_velocity="1" stribeck_velocity="0.01">)",
                        R"(<cylinder name="right forefoot" body="right forefoot" half_length="0.04"
            stiffness="1e5" exponent="1" stribeck_velocity="0.01">
            <impact_velocity parameter="vN" unit="m/s" lower="0.5" upper="1"/>)"}});
  const auto bounce = [&](const char* uncertain) {
    const Outcome outcome = stance({model, "--uncertain", uncertain, "--bounce", "right forefoot", "--json"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return Json::parse(outcome.out)["bounce"];
  };
  const Json range = bounce("vN");
  EXPECT_EQ(range["impact_velocity"], Json({{"lo", 0.5}, {"hi", 1.0}}));
  EXPECT_NEAR(range["rebound_speed"]["hi"], 0.07699, 1e-5);
  EXPECT_LT(range["rebound_speed"]["lo"], 0.04);
  EXPECT_EQ(bounce("none")["impact_velocity"], Json({{"lo", 0.75}, {"hi", 0.75}}));
}

using ::testing::Contains;
using ::testing::Not;

TEST_F(StanceCommand, SaysWhatDoesNotActBesideEachResult) {
  const Json json =
      json_of_example({"--uncertain", "mp", "--accelerations", "--sensitivities", "--bounce", "right forefoot"});
  for (const char* key : {"wrench_scope", "accelerations_scope"}) {
    const Json& scope = json[key];
    EXPECT_THAT(words(scope["does_not_act"]),
                ::testing::IsSupersetOf({"ground contact (cylinders: 4)", "friction", "controller (joints: 20)"}));
    EXPECT_THAT(scope["meaning"].get<std::string>(), HasSubstr("the feet stand on nothing"));
    EXPECT_THAT(words(scope["parameters_without_effect"]),
                ::testing::IsSupersetOf({"omega", "rff", "rhf", "eN", "eT", "mu_st", "mu_d"}));
    EXPECT_THAT(words(scope["parameters_without_effect"]), Not(Contains("mp")));
  }
  EXPECT_THAT(words(json["wrench_scope"]["parameters_without_effect"]), Contains("py"));
  EXPECT_THAT(words(json["accelerations_scope"]["parameters_without_effect"]), Not(Contains("py")));
  EXPECT_EQ(json["bounce"]["scope"]["parameters_without_effect"],
            Json({"omega", "Fx", "Fy", "mp", "px", "py", "pz", "mf", "rhf", "eT", "mu_st", "mu_d", "rff"}));
  EXPECT_THAT(words(json["bounce"]["scope"]["does_not_act"]), Contains("all other bodies and cylinders"));

  const Outcome outcome = stance_of_example({"--uncertain", "mp", "--accelerations", "--bounce", "right forefoot"});
  EXPECT_THAT(outcome.out, HasSubstr("\n  does NOT act: ground contact (cylinders: 4), friction, controller (joints: "
                                     "20)\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\n  parameters without effect here: omega, rhf, eN, eT, mu_st, mu_d, rff\n"));
  EXPECT_THAT(outcome.out,
              HasSubstr("one cylinder falls alone, lying flat, with the mass of the body \"right forefoot\""));
  EXPECT_THAT(stance({"--help"}).out, HasSubstr("in the accelerations the body falls freely,\nlegs hanging"));
}

/// What has no effect has none: neither on the enclosures of the wrench nor on those of the accelerations.
TEST(StanceScope, ParametersWithoutEffectHaveNone) {
  const stance::Model model = stance::nine_segments();
  const auto uncertain = std::array{0U + stance::mp};
  const auto check = [&](const stance::Scope& scope, const auto& evaluate) {
    const auto before = evaluate(model);
    for (std::uint32_t i = 0; i < model.parameters.size(); ++i) {
      stance::Model changed = model;
      changed.parameters[i].nominal += 0.01 * (1.0 + changed.parameters[i].range.width());
      const bool without_effect = std::ranges::find(scope.parameters_without_effect, model.parameters[i].name) !=
                                  scope.parameters_without_effect.end();
      if (i == stance::mp) continue;
      EXPECT_EQ(evaluate(changed) == before, without_effect) << model.parameters[i].name;
    }
  };
  std::vector<stance::WrenchEnclosure> sensitivities;
  for (std::uint32_t i = 0; i < model.parameters.size(); ++i)
    sensitivities.push_back(stance::sensitivity(model, uncertain, i, stance::Mode::tight));
  check(stance::wrench_scope(model, sensitivities),
        [&](const stance::Model& m) { return stance::wrench(m, uncertain, stance::Mode::tight); });
  check(stance::acceleration_scope(model, stance::AccelerationCase::fall),
        [&](const stance::Model& m) { return stance::accelerations(m, {}, {.cells = 1}); });
  // So low that all cylinders touch the ground.
  const auto at =
      instant(model, stance::AccelerationCase::contact, std::array{stance::joint_position(model, "pelvis ty", 0.9)});
  check(stance::acceleration_scope(model, stance::AccelerationCase::contact),
        [&](const stance::Model& m) { return stance::accelerations(m, {}, at, {.cells = 1}); });
}

TEST_F(StanceCommand, PrintsATable) {
  const Outcome outcome = stance_of_example({"--uncertain", "mp", "--monte-carlo", "10", "--sensitivities"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out,
              StartsWith("uncertain\n  mp      [35, 65]        kg    \"pelvis mass\"\n\nwrench on the root, "
                         "tight mode\n  w1  force along x   N   100"));
  EXPECT_THAT(outcome.out, HasSubstr("\n  10 samples, none escapes\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\n  dw1/dFx      1\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\nnote: dynamic friction may exceed static friction on all cylinders\n"));
}

TEST_F(StanceCommand, PrintsNoDigitThatIsNotProven) {
  const Outcome outcome = stance_of_example({"--uncertain", "mp"});
  const std::size_t begin = outcome.out.find("w2  force along y   N   [");
  ASSERT_NE(begin, std::string::npos);
  double lo = 0.0;
  double hi = 0.0;
  ASSERT_EQ(std::sscanf(outcome.out.c_str() + begin, "w2 force along y N [%lf, %lf]", &lo, &hi), 2);
  const Json json = json_of_example({"--uncertain", "mp"});
  EXPECT_LE(lo, json["wrench"]["w2"]["lo"]);
  EXPECT_GE(hi, json["wrench"]["w2"]["hi"]);
}

TEST_F(StanceCommand, StopsAtTheFirstInterruption) {
  const Process process = start({example(), "--monte-carlo", "100000000000", "--json"});
  std::this_thread::sleep_for(std::chrono::milliseconds(2000));
  process.interrupt();
  const Outcome outcome = process.wait();
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(json["interrupted"], true);
  EXPECT_LT(json["samples"], 100000000000);
}

TEST_F(StanceCommand, TellsHowTheBodyStands) {
  const Arguments arguments{standing(), "--uncertain", "mp,px", "--within", "1", "--equilibrium", "held"};
  const Outcome readable = stance(arguments);
  EXPECT_EQ(readable.status, 0) << readable.err;
  EXPECT_THAT(readable.out, testing::HasSubstr("proven to have an equilibrium on all cylinders: 100 % of the box\n"));
  EXPECT_THAT(readable.out, testing::HasSubstr("does NOT act: friction, which carries nothing"));
  EXPECT_THAT(readable.out,
              testing::HasSubstr("whether it stays there or topples is NOT said here (--stability does)"));
  Arguments as_json = arguments;
  as_json.push_back("--json");
  const Json json = Json::parse(stance(as_json).out)["equilibrium"];
  EXPECT_EQ(json["stands"], 1.0);
  EXPECT_NEAR(json["standing"]["positions"]["pelvis ty"]["lo"], 0.97697, 1e-4);
  EXPECT_GT(json["standing"]["cylinders"]["left forefoot"]["force"]["lo"], 95.0);
  EXPECT_EQ(json["cells"][0]["verdict"], "stands");
}

// At some of these the person stands on the hindfeet alone.
TEST_F(StanceCommand, DoesNotSucceedWhereNotAllOfTheBoxStands) {
  const Outcome outcome = stance({standing(), "--uncertain", "mp,px,py", "--range", "mp=64,65", "--range",
                                  "px=0.05,0.051", "--range", "py=0.49,0.5", "--cells", "2", "--equilibrium", "held"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.out, testing::HasSubstr("proven to have an equilibrium on all cylinders: 0 % of the box\n"));
}

TEST_F(StanceCommand, TellsWhetherTheBodyStaysThere) {
  const Arguments arguments{standing(), "--uncertain", "none", "--stability", "held"};
  const Outcome readable = stance(arguments);
  EXPECT_EQ(readable.status, 0) << readable.err;
  EXPECT_THAT(readable.out, testing::HasSubstr("proven stable, small disturbances die out: 100 % of the box\n"));
  EXPECT_THAT(readable.out, testing::HasSubstr("how large a disturbance may be: NOT said"));
  Arguments as_json = arguments;
  as_json.push_back("--json");
  const Json json = Json::parse(stance(as_json).out)["stability"];
  EXPECT_EQ(json["stable"], 1.0);
  EXPECT_LT(json["growth"]["hi"], 0.0);
  EXPECT_EQ(json["eigenvalues"].size(), 72U);
  EXPECT_EQ(json["cells"][0]["verdict"], "stable");
}

TEST_F(StanceCommand, WhatStandsCanBeProvedAgain) {
  const std::string proof = (folder_ / "proof.json").string();
  const Outcome made = stance(
      {standing(), "--uncertain", "mp,px", "--within", "1", "--equilibrium", "held", "--certificate-file", proof});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("  certificate: proves 100 % of the box; "));
  const auto check = [&](const std::string& certificate, const Arguments& more = {}) {
    Arguments arguments{places::check_program(), "--certificate", certificate, "--no-progress"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Process(arguments, folder_.path()).wait();
  };
  const Outcome proved = check(proof, {"--model", standing()});
  EXPECT_EQ(proved.status, 0) << proved.err;
  EXPECT_THAT(proved.out, StartsWith("claims               64\n  proved             64\n  refuted            0\n"));
  EXPECT_THAT(proved.out, HasSubstr("whether the body stays there or topples"));
  EXPECT_THAT(proved.out, HasSubstr("of                   all values of these parameters, together\n"));
  const Json json = Json::parse(check(proof, {"--model", standing(), "--json"}).out);
  EXPECT_EQ(json["joints"], "held");
  EXPECT_EQ(json["uncertain"].size(), 2U);
  EXPECT_EQ(json["unproved_cells"], 0);
  EXPECT_EQ(json["claims"][0]["proven"]["lo"], 1.0);

  std::ostringstream text;
  text << std::ifstream(proof).rdbuf();
  const Json honest = Json::parse(text.str());
  const auto status_with = [&](const std::string& pointer, const Json& value) {
    Json forged = honest;
    forged[Json::json_pointer(pointer)] = value;
    return check(folder_.file("forged.json", forged.dump()).string(), {"--model", standing()}).status;
  };
  EXPECT_EQ(status_with("/standing/least_penetration/lo", 0.002), 3);
  EXPECT_EQ(status_with("/uncertain/0/hi", 60.0), 3);
  EXPECT_EQ(status_with("/uncertain/0/hi", 70.0), 2);  // beyond the model's range
  EXPECT_EQ(status_with("/parts", Json::array({Json::object()})), 3);
  EXPECT_EQ(status_with("/joints", "proportional"), 3);
  EXPECT_EQ(status_with("/uncertain/0/parameter", "mass"), 2);
  EXPECT_EQ(status_with("/standing/cylinders/0/cylinder", "hand"), 2);
  EXPECT_THAT(check(proof, {"--model", example()}).err, HasSubstr("is about another model"));
  EXPECT_THAT(check(proof).err, HasSubstr("give that --model (.xml), and no other"));
}

TEST_F(StanceCommand, CertificatesAreOfEquilibriaAlone) {
  const std::string model = standing();
  expect_refused({model, "--certificate-file", "p.json"},
                 "--certificate-file: is of the equilibrium: give --equilibrium, too");
  expect_refused({model, "--equilibrium", "held", "--certificate-file", "p.xml"},
                 "--certificate-file p.xml: is a .json");
  expect_refused(
      {model, "--uncertain", "none", "--range", "mp=60,65", "--equilibrium", "held", "--certificate-file", "p.json"},
      "--certificate-file: mp has a --range, but is not --uncertain");
}

// Feet too soft: it would topple from its equilibrium.
TEST_F(StanceCommand, DoesNotSucceedWhereTheBodyTopples) {
  const std::string soft = with(standing(), {{R"(lower="90000" upper="110000")", R"(lower="14000" upper="16000")"}});
  const Outcome outcome = stance({soft, "--uncertain", "none", "--equilibrium", "held", "--stability", "held"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.out, testing::HasSubstr("proven to have an equilibrium on all cylinders: 100 % of the box\n"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("proven unstable, some grow however small they are: 100 % of the box"));
}

TEST_F(StanceCommand, DrawsWhatIsProvenOverTwoParameters) {
  const Outcome outcome = stance({standing(), "--uncertain", "mp,px", "--within", "1", "--equilibrium", "held",
                                  "--parameter-map", (folder_.path() / "map.svg").string()});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  std::ostringstream picture;
  picture << std::ifstream(folder_.path() / "map.svg").rdbuf();
  EXPECT_THAT(picture.str(), testing::StartsWith("<svg "));
  EXPECT_THAT(picture.str(), testing::HasSubstr(">mp, kg</text>"));
  EXPECT_THAT(picture.str(), testing::HasSubstr("proven: in equilibrium on all cylinders"));
}

TEST_F(StanceCommand, FollowsAMotion) {
  const Outcome outcome =
      stance({standing(), "--uncertain", "none", "--simulate", "0.1", "--push", "50,0.02,0.05", "--csv",
              (folder_.path() / "motion.csv").string(), "--plot", (folder_.path() / "motion.svg").string(), "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const Json json = Json::parse(outcome.out)["motion"];
  EXPECT_EQ(json["proven"], true);
  std::ifstream table(folder_.path() / "motion.csv");
  std::string header;
  std::getline(table, header);
  EXPECT_THAT(header, testing::StartsWith("from,to,pelvis_tx_position_lo,pelvis_tx_position_hi"));
  std::ostringstream picture;
  picture << std::ifstream(folder_.path() / "motion.svg").rdbuf();
  EXPECT_THAT(picture.str(), testing::HasSubstr("0 to 0.1 s: proven enclosures</text>"));
}

TEST_F(StanceCommand, ShowsStandingAndMotionOnAPage) {
  const std::string page = (folder_.path() / "standing.html").string();
  const Outcome outcome = stance(
      {standing(), "--uncertain", "none", "--equilibrium", "held", "--simulate", "0.01", "--report", page, "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  std::ostringstream text;
  text << std::ifstream(page).rdbuf();
  const std::string opening = "<script type=\"application/json\" id=\"verisq-report\">";
  const std::size_t begin = text.str().find(opening) + opening.size();
  const Json data = Json::parse(text.str().substr(begin, text.str().find("</script>", begin) - begin));
  EXPECT_EQ(data["format"], "verisq-stance/1");
  const Json printed = Json::parse(outcome.out);
  EXPECT_EQ(data["result"]["equilibrium"], printed["equilibrium"]);
  EXPECT_EQ(data["result"]["motion"], printed["motion"]);
  EXPECT_TRUE(printed["motion"]["steps"].is_number_integer());
  EXPECT_EQ(data["joints"][1]["name"], "pelvis ty");
  EXPECT_EQ(data["joints"][1]["is_translation"], true);
  EXPECT_EQ(data["joints"][3]["is_translation"], false);
  EXPECT_EQ(data["motion"]["slabs"].size(), printed["motion"]["steps"]);
  // The hip is where the root is, 0.05 m behind its translations; the ankle stands 0.13 m above the cylinder's lowest
  // point.
  const Json& hip = data["standing"]["points"]["bodies"][0];
  EXPECT_NEAR(hip[0].get<double>(), -0.05, 1e-9);
  EXPECT_LE(hip[2], printed["equilibrium"]["standing"]["positions"]["pelvis ty"]["lo"]);
  EXPECT_GE(hip[3], printed["equilibrium"]["standing"]["positions"]["pelvis ty"]["hi"]);
  const double penetration = printed["equilibrium"]["standing"]["cylinders"]["right hindfoot"]["penetration"]["lo"];
  EXPECT_NEAR(data["standing"]["points"]["cylinders"][0][2].get<double>(), 0.085 - penetration, 1e-9);
}

TEST_F(StanceCommand, SaysBeforeTheWorkWhatCannotBeWritten) {
  const std::string model = standing();
  const std::string nowhere = (folder_.path() / "missing" / "file").string();
  for (const char* option : {"--csv", "--plot", "--parameter-map", "--report"}) {
    // A motion of a day would take longer than anybody waits.
    const Outcome outcome = stance(
        {model, "--uncertain", "mp,px", "--equilibrium", "held", "--simulate", "86400", option, nowhere + ".html"});
    EXPECT_EQ(outcome.status, 1) << option;
    EXPECT_THAT(outcome.err, testing::HasSubstr(nowhere + ".html: cannot be written")) << option;
  }
  expect_refused({model, "--equilibrium", "held", "--report", "page.htm"},
                 "--report page.htm: its name must end in .html");
  expect_refused({model, "--report", "page.html"},
                 "--report page.html: give --equilibrium, --stability or --simulate, which the page shows");
  const std::string twice = (folder_.path() / "twice.html").string();
  expect_refused({model, "--simulate", "86400", "--csv", twice, "--report", twice},
                 "--report " + twice + ": the same file twice");
}

TEST_F(StanceCommand, RefusesBadUsage) {
  expect_refused({example(), "--uncertain", "mp,px", "--parameter-map", "map.svg"},
                 "--parameter-map: give either --equilibrium or --stability, too");
  expect_refused({standing(), "--uncertain", "mp", "--stability", "held", "--parameter-map", "m.svg"},
                 "--parameter-map: is of two uncertain parameters, not of 1: name them by --uncertain");
  expect_refused({example(), "--push", "50,0,1"}, "--push: give --simulate, too");
  const std::string model = example();
  expect_refused(
      {model, "--uncertain", "mp,xy"},
      "--uncertain: xy is not one of all, none, omega, Fx, Fy, mp, px, py, pz, mf, rhf, eN, eT, mu_st, mu_d, "
      "rff");
  expect_refused({model, "--uncertain", "mp,mp"}, "--uncertain: mp twice");
  expect_refused({model, "--mode", "loose"}, "--mode: loose is not one of paper, tight");
  expect_refused({model, "--monte-carlo", "0"}, "--monte-carlo: 0 is not at least 1");
  expect_refused({model, "--cells", "8"}, "--cells: give --accelerations, --equilibrium or --stability, too");
  expect_refused({model, "--accelerations", "--cells", "0"}, "--cells: 0 is not in 1 to 4096");
  expect_refused({model, "--report", "--mode", "paper"},
                 "--report: chooses parameters and mode itself; give --json at most");
  expect_refused({model, "--bounce", "hand"},
                 "--bounce: 'hand' is not one of the cylinders \"right hindfoot\", \"right forefoot\", \"left "
                 "hindfoot\", \"left forefoot\"");
  expect_refused({model, "--drop-height", "1"}, "--drop-height: give --bounce, too");
  expect_refused({model, "--range", "mp=30,50"}, "--range: mp=30,50 is not within the file's range [35, 65]");
  expect_refused({model, "--range", "mp=50,40"}, "--range mp=50,40: 50 is above 40");
  expect_refused({model, "--range", "mp"}, "--range: mp is not NAME=LO,HI");
  expect_refused({model, "--uncertain", "pz", "--within", "1"},
                 "--within: pz is 0 nominally, and no part of that is a range: give it one by --range, or leave it out "
                 "of --uncertain");
  expect_refused({model, "--equilibrium", "held"},
                 "equilibrium: the applied force has a part along x, which friction alone could hold: it must be 0");
  expect_refused(
      {standing(), "--bounce", "left forefoot"},
      "--bounce: the stiffness of 'left forefoot' is uncertain, and the bounce has an exact one: leave k out "
      "of --uncertain");
  expect_refused({model, "--bounce", "left hindfoot", "--drop-height", "0"}, "--drop-height: 0 is not above 0");
  expect_refused({model + "x"}, model + "x: no such file");
  const std::string broken = folder_.file("broken.xml", "<stance>\n</stand>").string();
  expect_refused({broken}, broken + ": line 2: not XML: Start-end tags mismatch");
  EXPECT_EQ(stance({}).status, 2);
}

TEST_F(StanceCommand, TheReportNeedsThePapersParameters) {
  const std::string model = folder_
                                .file("m.xml",
                                      "<stance gravity='9.81'><applied_force><frequency value='1'/><force x='0' y='0' "
                                      "z='0'/></applied_force><body name='a'><rotation name='r' axis='z'/><mass "
                                      "value='1'/><centre_of_mass x='1' y='0' z='0'/><inertia x='1' y='1' z='1'/>"
                                      "</body></stance>")
                                .string();
  expect_refused({model, "--report"},
                 "--report: " + model + ": the tables of the paper need a parameter 'mp', which the model lacks");
  const Outcome outcome = stance({model, "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(Json::parse(outcome.out)["notes"], Json::array());
}

TEST_F(StanceCommand, ExplainsItself) {
  const Outcome outcome = stance({"--help"});
  EXPECT_EQ(outcome.status, 0);
  for (const char* word : {"MODEL.xml", "--uncertain", "--mode", "--sensitivities", "--accelerations", "--cells",
                           "--monte-carlo", "--report", "--bounce", "--drop-height", "--json", "Exit status"}) {
    EXPECT_THAT(outcome.out, HasSubstr(word));
  }
}

TEST_F(StanceCommand, ReportsTheTablesOfThePaper) {
  const Outcome outcome = stance_of_example({"--report"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr("  w6  all         [-50.17, 45.49]         [-50.17, 45.49]         match (reconstructed: "
                        "gravity, mass of the legs, place of the feet, place of the pelvis's frame)\n"));
  EXPECT_THAT(outcome.out, HasSubstr("  w1  all         [0.00, 200.00]          [0.00, 200.00]          match\n"));
  EXPECT_THAT(outcome.out, HasSubstr("That such a cell matches is no evidence for these constants.\n"));
  EXPECT_THAT(outcome.out, HasSubstr("ground contact, friction and controller do NOT act"));
  EXPECT_THAT(outcome.out, HasSubstr("[-9.82, 0.50]           misprint in the paper: the lower end is a misprint of "
                                     "-0.982 (reconstructed: gravity, place of the pelvis's frame)\n"));
  EXPECT_THAT(outcome.out, HasSubstr("  w6              [38.18, 70.07]          15.94125"));
}

TEST_F(StanceCommand, ReportsTheTablesAsJson) {
  const Json json = json_of_example({"--report"});
  EXPECT_EQ(json["paper"]["all_explained"], true);
  ASSERT_EQ(json["paper"]["tables"].size(), 3U);
  EXPECT_EQ(json["paper"]["tables"][1]["cells"][9]["verdict"], "misprint in the paper");
  EXPECT_EQ(json["paper"]["tables"][1]["cells"][9]["reconstructed"], Json({"gravity", "place of the pelvis's frame"}));
  EXPECT_EQ(json["paper"]["tables"][0]["cells"][0]["reconstructed"], Json::array());
  EXPECT_EQ(json["paper"]["reconstructed_constants"].size(), 6U);
}

using stance::Cell;
using stance::CellVerdict;
using stance::PaperReport;

using CellName = std::pair<std::string, std::string>;

std::map<CellName, const Cell*> cells(const stance::PaperTable& table) {
  std::map<CellName, const Cell*> result;
  for (const Cell& cell : table.cells) result[{std::string(cell.row), std::string(cell.column)}] = &cell;
  return result;
}

/// Expects `verdicts` where they are given, and a match everywhere else.
void expect_verdicts(const stance::PaperTable& table, std::size_t count, std::map<CellName, CellVerdict> verdicts) {
  const auto found = cells(table);
  EXPECT_EQ(found.size(), count);
  for (const auto& [name, cell] : found) {
    const auto expected = verdicts.contains(name) ? verdicts[name] : CellVerdict::match;
    EXPECT_EQ(cell->verdict, expected) << name.first << " " << name.second;
    EXPECT_EQ(cell->reason.empty(), expected != CellVerdict::misprint) << name.first << " " << name.second;
    verdicts.erase(name);
  }
  EXPECT_TRUE(verdicts.empty());
}

TEST(StanceReport, EveryCellHasTheVerdictOfTheAudit) {
  const auto& [tables, unrounded] = stance::compare_with_paper(stance::nine_segments());
  expect_verdicts(tables[0], 12, {});
  expect_verdicts(tables[1], 12, {{{"w6", "d/dmp"}, CellVerdict::misprint}, {{"w2", "d/dpx"}, CellVerdict::unprinted}});
  expect_verdicts(tables[2], 16,
                  {{{"w1", "d/dFx"}, CellVerdict::misprint},
                   {{"w2", "d/dFx"}, CellVerdict::misprint},
                   {{"w4", "d/dFx"}, CellVerdict::misprint},
                   {{"w6", "d/dFx"}, CellVerdict::misprint},
                   {{"w2", "r"}, CellVerdict::misprint}});
}

TEST(StanceReport, PrintsThePapersCells) {
  const PaperReport report = stance::compare_with_paper(stance::nine_segments());
  const auto table_2 = cells(report.tables[0]);
  EXPECT_EQ(table_2.at({"w1", "nominal"})->printed, "[99.99, 100.00]");
  EXPECT_EQ(table_2.at({"w2", "all"})->printed, "[-940.00, -595.69]");
  EXPECT_EQ(table_2.at({"w6", "all"})->printed, "[-50.17, 45.49]");
  const auto table_3 = cells(report.tables[1]);
  EXPECT_EQ(table_3.at({"w6", "d/dmp"})->printed, "[-9.82, 0.50]");
  EXPECT_EQ(table_3.at({"w6", "d/dpx"})->printed, "[-637.66, -343.34]");
  const auto table_4 = cells(report.tables[2]);
  EXPECT_EQ(table_4.at({"w4", "d/dFx"})->printed, "0.78");
  EXPECT_EQ(table_4.at({"w2", "r"})->printed, "[444.43, 738.44]");
  EXPECT_EQ(table_4.at({"w2", "r"})->ours, (stance::Hundredths{44478, 73909}));
  EXPECT_EQ(table_4.at({"w6", "r"})->printed, "[38.44, 70.47]");
}

TEST(StanceReport, TheRadiusFormIsHalfTheWidthOfTheTrueRange) {
  const PaperReport report = stance::compare_with_paper(stance::nine_segments());
  EXPECT_NEAR(report.unrounded.by_radius[5], 15.94125, 1e-9);
  EXPECT_GE(report.unrounded.by_radius[5], 15.94125 * (1.0 - 1e-15));
}

TEST(StanceReport, AnotherModelDiffers) {
  stance::Model model = stance::nine_segments();
  model.gravity = 9.82;
  const PaperReport report = stance::compare_with_paper(model);
  EXPECT_FALSE(report.all_explained());
  EXPECT_EQ(cells(report.tables[0]).at({"w2", "nominal"})->verdict, CellVerdict::differs);
  // Not even where the paper is wrong anyway.
  EXPECT_EQ(cells(report.tables[2]).at({"w2", "r"})->verdict, CellVerdict::differs);
}

/// The model with one reconstructed constant a tenth greater, all others as they are.
stance::Model with_other(const std::string& constant) {
  stance::Model model = stance::nine_segments();
  const auto scale = [](stance::Quantity& quantity, double factor) {
    quantity = stance::example::number(factor * quantity.nominal);
  };
  const auto each = [&](const std::string& ending, const auto& change) {
    for (stance::Body& body : model.bodies) {
      if (body.name.ends_with(ending)) change(body);
    }
  };
  if (constant == "gravity") model.gravity *= 1.1;
  if (constant == "mass of the legs") each("tibia", [&](stance::Body& tibia) { scale(tibia.mass, 1.1); });
  if (constant == "place of the feet")
    each("hindfoot", [&](stance::Body& foot) { scale(foot.centre_of_mass[0], 2.0); });
  if (constant == "mass of the femur") {  // the leg's remains
    const double more = 1.0;
    model.parameters[stance::mf].nominal += more;
    model.parameters[stance::mf].range = {10.34 + more, 10.34 + more};
    model.bodies[1].mass = stance::example::quantity(model, stance::mf);
    model.bodies[5].mass = stance::example::number(10.34 + more);
    each("tibia", [&](stance::Body& tibia) { tibia.mass = stance::example::number(tibia.mass.nominal - more); });
  }
  if (constant == "place of the hips") each("femur", [&](stance::Body& femur) { scale(femur.offset[2], 1.1); });
  if (constant == "place of the pelvis's frame")
    each("pelvis", [&](stance::Body& pelvis) { scale(pelvis.offset[0], 1.1); });
  return model;
}

TEST(StanceReport, NamesTheReconstructedConstantsThatEnterACell) {
  const PaperReport before = stance::compare_with_paper(stance::nine_segments());
  for (const std::string_view constant : stance::reconstructed_constants()) {
    const PaperReport after = stance::compare_with_paper(with_other(std::string(constant)));
    for (std::size_t t = 0; t < before.tables.size(); ++t) {
      for (std::size_t i = 0; i < before.tables[t].cells.size(); ++i) {
        const Cell& cell = before.tables[t].cells[i];
        const bool enters = cell.ours != after.tables[t].cells[i].ours;
        EXPECT_EQ(std::ranges::find(cell.reconstructed, constant) != cell.reconstructed.end(), enters)
            << constant << ": " << before.tables[t].title << " " << cell.row << " " << cell.column;
      }
    }
  }
}

TEST(StanceReport, RoundsToHundredthsOutward) {
  EXPECT_EQ(stance::rounded_outward({-50.165, 45.4826}), (stance::Hundredths{-5017, 4549}));
  EXPECT_EQ(stance::rounded_outward({0.5, 0.5}), (stance::Hundredths{50, 50}));
  EXPECT_EQ(stance::rounded_outward({0.1, 0.1}), (stance::Hundredths{10, 11}));  // binary64 0.1 is above 0.1
  EXPECT_EQ(stance::rounded_outward({-1e-300, 1e-300}), (stance::Hundredths{-1, 1}));
  EXPECT_EQ(stance::text({-5017, 4549}), "[-50.17, 45.49]");
  EXPECT_EQ(stance::text({50, 50}), "0.50");
  EXPECT_EQ(stance::text({-0.0, 0.0}), "0.00");
}

/// The identity on the first parameter, claimed to lie in `claimed`.
stance::Sampled first_parameter(const Enclosure& claimed) {
  return {{claimed},
          [](std::span<const double> parameters) { return std::vector<double>{parameters[0]}; },
          [](std::span<const double> parameters) {
            return std::vector<Enclosure>{{parameters[0], parameters[0]}};
          }};
}

stance::Model one_parameter() {
  stance::Model model{};
  model.parameters.push_back({"p", "", "", 1.0, {0.0, 2.0}});
  return model;
}

constexpr std::array<std::uint32_t, 1> first{0};

TEST(StanceSamples, FillTheRange) {
  const auto samples = stance::take_samples(one_parameter(), first, first_parameter({-1.0, 3.0}), {.count = 10000});
  EXPECT_EQ(samples.count, 10000U);
  EXPECT_FALSE(samples.escape);
  EXPECT_NEAR(samples.hull[0].lo, 0.0, 0.01);
  EXPECT_NEAR(samples.hull[0].hi, 2.0, 0.01);
  EXPECT_NEAR(stance::filled_part(samples.hull[0], {-1.0, 3.0}), 0.5, 0.01);
}

TEST(StanceSamples, FindWhatEscapes) {
  const auto samples = stance::take_samples(one_parameter(), first, first_parameter({0.0, 1.99}), {.count = 100000});
  ASSERT_TRUE(samples.escape);
  EXPECT_EQ(samples.escape->component, 0U);
  EXPECT_GT(samples.escape->parameters[0], 1.99);
  EXPECT_EQ(samples.escape->exact.lo, samples.escape->parameters[0]);
}

TEST(StanceSamples, FindWhatEscapesFromTheWrench) {
  const stance::Model model = stance::nine_segments();
  const auto wrench = stance::wrench(model, std::array{0U + stance::mp}, stance::Mode::tight);
  std::vector<Enclosure> claimed(wrench.begin(), wrench.end());
  claimed[1].hi -= 10.0;
  const auto samples = stance::take_samples(model, std::array{0U + stance::mp},
                                            stance::sampled_wrench_of(model, claimed), {.count = 1000});
  ASSERT_TRUE(samples.escape);
  EXPECT_EQ(samples.escape->component, 1U);
  EXPECT_LT(samples.escape->parameters[stance::mp], 37.0);
}

TEST(StanceSamples, RoundingErrorsOfASampleAreNoEscape) {
  stance::Sampled sampled = first_parameter({0.0, 2.0});
  sampled.evaluate = [](std::span<const double> parameters) { return std::vector<double>{parameters[0] - 1e-3}; };
  const auto samples = stance::take_samples(one_parameter(), first, sampled, {.count = 10000});
  EXPECT_FALSE(samples.escape);
  EXPECT_GE(samples.hull[0].lo, 0.0);
}

TEST(StanceSamples, EndWhereverTheyAreInterrupted) {
  std::uint64_t polled = 0;
  const auto samples = stance::take_samples(
      one_parameter(), first, first_parameter({-1.0, 3.0}),
      {.count = std::numeric_limits<std::uint64_t>::max(), .interrupted = [&] { return ++polled > 10; }});
  EXPECT_GT(samples.count, 0U);
  EXPECT_LT(polled, 10'000U);  // not once for each of the samples that are left
}

TEST(StanceSamples, WhatIsNotUncertainIsNominal) {
  const auto samples = stance::take_samples(one_parameter(), {}, first_parameter({1.0, 1.0}), {.count = 10});
  EXPECT_EQ(samples.hull[0], (Enclosure{1.0, 1.0}));
  EXPECT_EQ(stance::filled_part(samples.hull[0], {1.0, 1.0}), 1.0);
}

}  // namespace
}  // namespace verisq::testing
