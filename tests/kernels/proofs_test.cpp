/// The proofs of kernels/proofs re-run: Sollya computes the constants of the kernels, Gappa proves the bounds, and both
/// speak of the very operations that stand in the kernels.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <ostream>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/fixtures/process.hpp"
#include "tests/fixtures/temporary_folder.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using verisq::testing::contents;
using verisq::testing::Outcome;
using verisq::testing::Process;
using verisq::testing::TemporaryFolder;

using Constants = std::map<std::string, double>;

const std::filesystem::path kernels(VERISQ_KERNELS);
const std::filesystem::path proofs = kernels / "proofs";

// ---- programs

std::string path_of(const std::string& program) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (const auto candidate = std::filesystem::path(folder) / program; std::filesystem::exists(candidate))
      return candidate.string();
  throw std::runtime_error(fmt::format("{0} is not installed: apt-get install {0}", program));
}

Outcome run(const std::string& program, const std::string& text) {
  const TemporaryFolder folder;
  return Process({path_of(program), folder.file("proof", text).string()}, folder.path()).wait();
}

/// What a Sollya script prints.
std::string sollya(const std::string& script) {
  const Outcome outcome = run("sollya", script);
  if (outcome.status != 0) throw std::runtime_error("sollya failed: " + outcome.out + outcome.err);
  return outcome.out;
}

enum class Verdict { proven, unproven, trusts_a_hint, malformed };

/// Gappa takes hints that it cannot verify, with a warning: what it concludes from them is not proven.
Verdict gappa(const std::string& text) {
  const Outcome outcome = run("gappa", text);
  const auto says = [&](std::string_view words) { return outcome.err.find(words) != std::string::npos; };
  if (says("not trivially equal") || says("assumed")) return Verdict::trusts_a_hint;
  if (outcome.status == 0) return Verdict::proven;
  return says("some properties were not satisfied") ? Verdict::unproven : Verdict::malformed;
}

std::vector<std::string> proof_texts(std::string_view extension) {
  std::vector<std::string> texts;
  for (const auto& entry : std::filesystem::directory_iterator(proofs))
    if (entry.path().extension() == extension) texts.push_back(contents(entry.path()));
  return texts;
}

std::string proof(std::string_view name) {
  const std::string text = contents(proofs / name);
  if (text.empty()) throw std::runtime_error(fmt::format("no proof {}", name));
  return text;
}

// ---- text

std::vector<std::smatch> matches(const std::string& text, const std::regex& pattern) {
  return {std::sregex_iterator(text.begin(), text.end(), pattern), {}};
}

double number(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0') throw std::runtime_error("not a number: " + text);
  return value;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("no such text: " + from);
  return text.replace(at, from.size(), to);
}

std::string without_comments(const std::string& kernel) {
  return std::regex_replace(kernel, std::regex("//[^\n]*"), "");
}

/// NAME = NUMBER, as Sollya prints and Gappa defines constants.
Constants defined_constants(const std::string& text) {
  static const std::regex pattern(R"((?:^|\n)([A-Z][A-Z0-9_]*) = ([-+.0-9a-fxp]+);?(?=\n))");
  Constants found;
  for (const auto& match : matches(text, pattern)) found[match[1]] = number(match[2]);
  return found;
}

Constants kernel_constants(const std::string& kernel) {
  static const std::regex pattern(R"(#define (\w+) ([-+]?[0-9][-+.0-9a-fxp]*))");
  Constants found;
  for (const auto& match : matches(kernel, pattern)) found[match[1]] = number(match[2]);
  return found;
}

/// Constants of `proven` that the kernels lack or hold with another value.
std::vector<std::string> mismatches(const Constants& proven, const Constants& in_kernel) {
  std::vector<std::string> result;
  for (const auto& [name, value] : proven) {
    const auto at = in_kernel.find(name);
    if (at == in_kernel.end() || at->second != value) result.push_back(name);
  }
  return result;
}

// ---- bounds that one proof hands to another

struct Bound {
  std::string name;
  double value;
};

struct Bounds {
  std::vector<Bound> assumed;
  std::vector<Bound> proven;
};

void add(Bounds& bounds, const std::string& kind, const std::string& names, double value) {
  static const std::regex name(R"(\w+)");
  for (const auto& match : matches(names, name))
    (kind == "proves" ? bounds.proven : bounds.assumed).push_back({match.str(), value});
}

/// Lines "proves NAME NUMBER" and "assumes NAME NUMBER".
Bounds sollya_bounds(const std::string& output) {
  static const std::regex pattern(R"((proves|assumes) (\w+) ([-+.0-9a-fxp]+))");
  Bounds bounds;
  for (const auto& match : matches(output, pattern)) add(bounds, match[1], match[2], number(match[3]));
  return bounds;
}

/// Lines whose comment says "proves NAMES" or "assumes NAMES"; the value is the largest number of the line.
Bounds gappa_bounds(const std::string& text) {
  static const std::regex pattern(R"(([^\n]*)# (proves|assumes) ([^\n]*))");
  static const std::regex limit(R"((?:<= |in \[|, )(-?[0-9][-+.0-9a-fxp]*))");
  Bounds bounds;
  for (const auto& match : matches(text, pattern)) {
    const std::string statement = match[1];
    double largest = -1.0;
    for (const auto& value : matches(statement, limit)) largest = std::max(largest, std::abs(number(value[1])));
    if (largest < 0.0) throw std::runtime_error("no bound in " + statement);
    add(bounds, match[2], match[3], largest);
  }
  return bounds;
}

void append(Bounds& all, const Bounds& some) {
  all.assumed.insert(all.assumed.end(), some.assumed.begin(), some.assumed.end());
  all.proven.insert(all.proven.end(), some.proven.begin(), some.proven.end());
}

Bounds all_bounds() {
  Bounds bounds;
  for (const auto& script : proof_texts(".sollya")) append(bounds, sollya_bounds(sollya(script)));
  for (const auto& text : proof_texts(".gappa")) append(bounds, gappa_bounds(text));
  return bounds;
}

/// Assumptions that nothing proves, or that a proof leaves larger.
std::vector<std::string> unproven(const Bounds& bounds) {
  std::vector<std::string> result;
  for (const auto& assumption : bounds.assumed) {
    bool proven = false;
    for (const auto& conclusion : bounds.proven) {
      if (conclusion.name != assumption.name) continue;
      proven = true;
      if (!(conclusion.value <= assumption.value)) result.push_back(assumption.name);
    }
    if (!proven) result.push_back(assumption.name);
  }
  return result;
}

double proven_bound(const Bounds& bounds, std::string_view name) {
  double largest = -1.0;
  for (const auto& bound : bounds.proven)
    if (bound.name == name) largest = std::max(largest, bound.value);
  return largest < 0.0 ? infinity : largest;
}

// ---- operations

/// The rounded operations of a kernel function as Gappa writes them: "const real p = fma(a, REAL(B), c);" becomes
/// "p = rnd(a * B + c)", a returned operation that of `result`. Bit operations are left out: they are exact.
std::vector<std::string> kernel_operations(const std::string& kernel, const std::string& function,
                                           const std::string& result) {
  static const std::regex statement(R"((?:const real (\w+) =|(return)) ([^;]*);)");
  static const std::regex constant(R"(REAL\(([^()]*)\))");
  static const std::regex fused(R"(fma\(([^,()]+), ([^,()]+), ([^,()]+)\))");
  static const std::regex whole(R"(\b([0-9]+)\.0\b)");
  const auto start = kernel.find("real " + function + "(real");
  if (start == std::string::npos) throw std::runtime_error("no function " + function);
  const std::string body = without_comments(kernel.substr(start, kernel.find("\n}", start) - start));
  std::vector<std::string> operations;
  for (const auto& match : matches(body, statement)) {
    std::string value = std::regex_replace(match[3].str(), constant, "$1");
    if (value.find("FROM_BITS") != std::string::npos) continue;
    value = std::regex_replace(std::regex_replace(value, fused, "$1 * $2 + $3"), whole, "$1");
    operations.push_back(fmt::format("{} = rnd({})", match[2].matched ? result : match[1].str(), value));
  }
  return operations;
}

std::vector<std::string> gappa_operations(const std::string& text) {
  static const std::regex operation(R"(\n(\w+ = rnd\(.*\));)");
  std::vector<std::string> operations;
  for (const auto& match : matches(text, operation))
    if (match[1].str().find("rnd(any") == std::string::npos) operations.push_back(match[1]);
  return operations;
}

// ---- tests

/// The part of a file that begins with "// This layer" and `does`.
std::string layer(const char* file, const std::string& does) {
  const std::string text = contents(kernels / file);
  const std::string opening = "// This layer ";
  const std::size_t begin = text.find(opening + does);
  if (begin == std::string::npos) throw std::runtime_error(fmt::format("no layer of {} {}", file, does));
  return text.substr(begin, text.find("\n" + opening, begin) - begin);
}

std::string elementary() {
  return layer("arithmetic.clh", "implements exp and log");
}
std::string inverse_tangent() {
  return layer("arithmetic.clh", "implements the even function A(t)");
}
std::string rounding() {
  return layer("arithmetic.clh", "implements vectors of binary64 numbers");
}
std::string contact() {
  return layer("proposal.clh", "evaluates a superquadric once") + layer("proposal.clh", "holds what is proven");
}

/// Of the layers whose constants Sollya computes.
Constants computed_kernel_constants() {
  Constants constants = kernel_constants(elementary());
  constants.merge(kernel_constants(inverse_tangent()));
  for (const auto& [name, value] : kernel_constants(contact()))
    if (name.starts_with("CHANGE_P")) constants.emplace(name, value);
  return constants;
}

Constants all_kernel_constants() {
  Constants constants = computed_kernel_constants();
  constants.merge(kernel_constants(rounding()));
  constants.merge(kernel_constants(contact()));
  return constants;
}

Constants sollya_constants() {
  Constants constants;
  for (const char* const script : {"exp.sollya", "log.sollya", "atan.sollya", "contact.sollya"})
    constants.merge(defined_constants(sollya(proof(script))));
  return constants;
}

TEST(Proofs, SollyaComputesEveryConstantOfTheKernels) {
  const Constants computed = sollya_constants();
  const Constants in_kernel = computed_kernel_constants();
  EXPECT_THAT(mismatches(computed, in_kernel), IsEmpty());
  // Chosen, not computed; exact.
  const std::set<std::string> chosen = {"ROUND_TO_INTEGER",    "EXP_LOWEST",   "EXP_HIGHEST",  "SMALLEST_NORMAL",
                                        "ELEMENTARY_WIDENING", "ATAN_HIGHEST", "ATAN_WIDENING"};
  for (const auto& [name, value] : in_kernel)
    EXPECT_TRUE(computed.contains(name) || chosen.contains(name)) << name << " is in the kernel only";
}

TEST(Proofs, NoConstantOfTheKernelIsNameless) {
  for (const std::string& kernel : {elementary(), inverse_tangent()}) {
    const std::string code = std::regex_replace(without_comments(kernel), std::regex("#define [^\n]*"), "");
    EXPECT_THAT(matches(code, std::regex(R"(\b0x[0-9a-f.]+p[-+0-9]+|\b[0-9]+\.[0-9]{2,})")), IsEmpty());
  }
}

TEST(Proofs, SollyaComputesTheCoefficientsThatProposalsUse) {
  for (const auto& [kernel, script] :
       {std::pair(layer("primitive.clh", "implements sums of exponentials"), "projection.sollya"),
        std::pair(contents(kernels / "binary32.clh"), "binary32.sollya")}) {
    std::set<double> computed;
    std::set<double> in_kernel;
    for (const auto& [name, value] : defined_constants(sollya(proof(script)))) computed.insert(value);
    const std::string code = std::regex_replace(without_comments(kernel), std::regex("#define [^\n]*"), "");
    for (const auto& match : matches(code, std::regex(R"(0x[0-9a-f.]+p[-+0-9]+)")))
      in_kernel.insert(number(match.str()));
    EXPECT_FALSE(computed.empty()) << script;
    EXPECT_EQ(in_kernel, computed) << script;
  }
}

TEST(Proofs, GappaUsesTheConstantsOfTheKernels) {
  const Constants in_kernel = all_kernel_constants();
  Constants used;
  for (const auto& text : proof_texts(".gappa")) {
    const Constants constants = defined_constants(text);
    EXPECT_THAT(mismatches(constants, in_kernel), IsEmpty());
    used.insert(constants.begin(), constants.end());
  }
  for (const auto& [name, value] : sollya_constants())
    EXPECT_TRUE(used.contains(name) || name == "SQRT_HALF") << name << " is in no proof of Gappa";
}

TEST(Proofs, GappaSpeaksOfTheRangesOfTheKernels) {
  const Constants in_kernel = all_kernel_constants();
  const auto range = [](const std::string& text, const std::string& variable) {
    std::smatch match;
    const std::regex pattern(variable + R"( in \[([-+.0-9a-fxp]+), ([-+.0-9a-fxp]+)\])");
    if (!std::regex_search(text, match, pattern)) throw std::runtime_error("no range of " + variable);
    return std::pair(number(match[1]), number(match[2]));
  };
  EXPECT_EQ(range(proof("exp_reduction.gappa"), R"(\{ y)"),
            std::pair(in_kernel.at("EXP_LOWEST"), in_kernel.at("EXP_HIGHEST")));
  const double sqrt_half = in_kernel.at("SQRT_HALF");
  for (const char* const name : {"log.gappa", "log_near_one.gappa"})
    EXPECT_EQ(range(proof(name), R"(\{ m)"), std::pair(sqrt_half, 2.0 * sqrt_half)) << name;
  EXPECT_EQ(range(proof("atan_beyond_one.gappa"), R"(\{ size)"), std::pair(1.0, in_kernel.at("ATAN_HIGHEST")));
  EXPECT_EQ(range(proof("atan_widening.gappa"), R"(\{ Exact)"), std::pair(1.0 / in_kernel.at("ATAN_HIGHEST"), 1.0));
  // of widening.gappa, and of the absolute term in the bound of powers
  EXPECT_GT(std::exp(in_kernel.at("EXP_LOWEST")), 0x1.71p-1022);
  EXPECT_LT(std::exp(in_kernel.at("EXP_LOWEST")), 0x1.7dp-1022);
}

TEST(Proofs, GappaSpeaksOfTheOperationsOfExp) {
  std::vector<std::string> proven = gappa_operations(proof("exp_reduction.gappa"));
  for (const auto& operation : gappa_operations(proof("exp.gappa"))) proven.push_back(operation);
  EXPECT_EQ(kernel_operations(elementary(), "exp_nearest", "exp"), proven);
}

TEST(Proofs, GappaSpeaksOfTheOperationsOfLog) {
  std::vector<std::string> operations = kernel_operations(elementary(), "log_nearest", "l");
  EXPECT_EQ(operations, gappa_operations(proof("log.gappa")));

  // k = 0: k_low = 0, adding it is exact, and so is the last operation
  ASSERT_THAT(operations, IsSupersetOf({"k_low = rnd(k * LN2_LOW)", "l = rnd(k * LN2_HIGH + low)"}));
  std::erase(operations, "k_low = rnd(k * LN2_LOW)");
  std::erase(operations, "l = rnd(k * LN2_HIGH + low)");
  for (auto& operation : operations) {
    operation = std::regex_replace(operation, std::regex(R"( \+ k_low)"), "");
    operation = std::regex_replace(operation, std::regex("^low ="), "l =");
  }
  EXPECT_EQ(operations, gappa_operations(proof("log_near_one.gappa")));
}

TEST(Proofs, GappaSpeaksOfTheOperationsOfAtan) {
  EXPECT_EQ(kernel_operations(inverse_tangent(), "atan_ratio_in_unit", "ratio"), gappa_operations(proof("atan.gappa")));

  // What is exact, or the subject of atan.gappa: `near` in [0, 1] is its result, and beyond one that of the reciprocal.
  const std::vector<std::string> others = {"size = rnd(fabs(t))",
                                           "near = rnd(atan_ratio_in_unit(lesser(size, reciprocal)))",
                                           "A = rnd(select(near, far, MASK(size > 1)))"};
  std::vector<std::string> operations = kernel_operations(inverse_tangent(), "atan_ratio_nearest", "A");
  ASSERT_THAT(operations, IsSupersetOf(others));
  for (const std::string& other : others) std::erase(operations, other);
  EXPECT_EQ(operations, gappa_operations(proof("atan_beyond_one.gappa")));
}

TEST(Proofs, GappaSpeaksOfTheOperationsOfContacts) {
  EXPECT_EQ(kernel_operations(contact(), "moved", "m"), gappa_operations(proof("contact_change.gappa")));
  std::vector<std::string> operations = kernel_operations(contact(), "excess_up", "selected");
  const std::string selected = "selected = rnd(select(INFINITY, up, MASK(fabs(excess) <= LARGEST_EXCESS)))";
  ASSERT_THAT(operations, IsSupersetOf({selected}));
  std::erase(operations, selected);
  EXPECT_EQ(operations, gappa_operations(proof("contact_excess.gappa")));
}

TEST(Proofs, GappaSpeaksOfTheRangesOfContacts) {
  const Constants in_kernel = kernel_constants(contact());
  const Bounds bounds = all_bounds();
  EXPECT_EQ(in_kernel.at("LARGEST_EXCESS"), 0x1p-6);
  EXPECT_THAT(proof("contact_excess.gappa"), HasSubstr("|excess| <= 0x1p-6 ->"));
  EXPECT_EQ(in_kernel.at("LARGEST_CHANGE"), 0x1p-8);
  EXPECT_THAT(proof("contact.sollya"), HasSubstr("b = 2^-8;"));
  EXPECT_GE(in_kernel.at("POINT_MARGIN"), 1.25 * proven_bound(bounds, "POINT_ERROR"));
  EXPECT_GE(in_kernel.at("NORMAL_MARGIN"), proven_bound(bounds, "CHANGED_ERROR") + 2.03 * 0x1p-53);
  EXPECT_GT(in_kernel.at("NORMAL_UNDERFLOW"), 0x1p-1020);
  // a semi-axis is at least 2^-300 (host/device/device_model.cpp)
  EXPECT_GT(std::ldexp(std::exp(-in_kernel.at("LARGEST_LOG")), -300), 0x1p-900);
}

TEST(Proofs, GappaSpeaksOfTheStepsOutward) {
  EXPECT_THAT(rounding(), HasSubstr("step_down(real c) { return c - fma(REAL(ROUNDING_PHI), fabs(c), "
                                    "REAL(ROUNDING_ETA)); }"));
  EXPECT_THAT(rounding(),
              HasSubstr("step_up(real c) { return c + fma(REAL(ROUNDING_PHI), fabs(c), REAL(ROUNDING_ETA)); }"));
  for (const char* const widening :
       {"fma(e, REAL(ELEMENTARY_WIDENING), e)", "fma(e, REAL(-ELEMENTARY_WIDENING), e)",
        "fma(fabs(l), REAL(ELEMENTARY_WIDENING), l)", "fma(fabs(l), REAL(-ELEMENTARY_WIDENING), l)",
        "exp_up(mul_up(y, log_up(x)))", "exp_down(mul_down(y, log_down(x)))"})
    EXPECT_THAT(elementary(), HasSubstr(widening));
  for (const char* const widening :
       {"fma(ratio, REAL(ATAN_WIDENING), ratio)", "fma(ratio, REAL(-ATAN_WIDENING), ratio)",
        "atan_ratio_nearest(lesser(REAL(ATAN_HIGHEST), fabs(t)))", "MASK(fabs(t) <= ATAN_HIGHEST)"})
    EXPECT_THAT(inverse_tangent(), HasSubstr(widening));
}

TEST(Proofs, WhatOneAssumesAnotherProves) {
  const Bounds bounds = all_bounds();
  EXPECT_GE(bounds.assumed.size(), 12U);
  EXPECT_THAT(unproven(bounds), IsEmpty());
  EXPECT_LE(proven_bound(bounds, "EXP_ERROR"), 0x1p-51);
  EXPECT_LE(proven_bound(bounds, "LOG_ERROR"), 0x1p-51);
  EXPECT_LE(proven_bound(bounds, "POW_LOOSENESS"), 0x1p-40);
  EXPECT_LE(proven_bound(bounds, "ATAN_UNIT_ERROR"), 1.875 * 0x1p-53);
  EXPECT_LE(proven_bound(bounds, "ATAN_ERROR"), 5.25 * 0x1p-53);
  EXPECT_LE(proven_bound(bounds, "ATAN_LOOSENESS"), 12.8 * 0x1p-53);
}

class Gappa : public ::testing::TestWithParam<std::string> {};

TEST_P(Gappa, Proves) {
  EXPECT_EQ(gappa(proof(GetParam() + ".gappa")), Verdict::proven);
}

std::vector<std::string> gappa_files() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(proofs))
    if (entry.path().extension() == ".gappa") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(Files, Gappa, ::testing::ValuesIn(gappa_files()), [](const auto& test) { return test.param; });

// ---- the tests can fail

struct Falsification {
  std::string name, file, from, to;
};

void PrintTo(const Falsification& falsification, std::ostream* out) {
  *out << falsification.name;
}

class FalsifiedProof : public ::testing::TestWithParam<Falsification> {};

TEST_P(FalsifiedProof, IsNotProven) {
  const auto& [name, file, from, to] = GetParam();
  EXPECT_EQ(gappa(replaced(proof(file), from, to)), Verdict::unproven);
}

INSTANTIATE_TEST_SUITE_P(
    Proofs, FalsifiedProof,
    ::testing::Values(
        Falsification{"DigitOfExp", "exp.gappa", "rnd(EXP_P3 * r + EXP_P2)", "rnd(EXP_P3 * r + 0x1.5555555563cd9p-5)"},
        Falsification{"BoundOfExp", "exp.gappa", "<= 0x1.ep-53", "<= 0x1.4p-53"},
        Falsification{"ApproximationOfExp", "exp.gappa", "<= 0x1.3ep-56", "<= 0x1.3ep-54"},
        Falsification{"DigitOfReduction", "exp_reduction.gappa", "0x1.71547652b82fep0", "0x1.71557652b82fep0"},
        Falsification{"DigitOfLowPart", "exp_reduction.gappa", "rnd(n * -LN2_LOW + r_high)",
                      "rnd(n * -0x1.ef45793c7673p-45 + r_high)"},
        Falsification{"BoundOfReduction", "exp_reduction.gappa", "<= 0x1.001p-55", "<= 0x1.001p-56"},
        Falsification{"DigitOfLog", "log.gappa", "rnd(LOG_Q1 * z + LOG_Q0)", "rnd(0x1.99999999a52d9p-2 * z + LOG_Q0)"},
        Falsification{"BoundOfLog", "log.gappa", "<= 0x1.8p-53", "<= 0x1.2p-53"},
        Falsification{"DigitOfLogNearOne", "log_near_one.gappa", "rnd(LOG_Q1 * z + LOG_Q0)",
                      "rnd(LOG_Q1 * z + 0x1.5555556555558p-1)"},
        Falsification{"StepOfHalfAPlace", "rounding.gappa", "0x1.0000000000001p-53", "0x1p-53"},
        Falsification{"WideningTooSmall", "widening.gappa", "0x1p-51", "0x1p-52"},
        Falsification{"BoundOfPow", "pow.gappa", "<= 0x1.ap-41  # proves", "<= 0x1p-41  # proves"},
        Falsification{"DigitOfAtan", "atan.gappa", "rnd(ATAN_R4 * z + ATAN_R3)",
                      "rnd(ATAN_R4 * z + 0x1.c71c71bd7d43ap-4)"},
        Falsification{"HalfOfPi", "atan_beyond_one.gappa", "near + PI_HALF);", "near + 0x1.921fb54442d1ap0);"},
        Falsification{"BoundOfAtanBeyondOne", "atan_beyond_one.gappa", "<= 0x1.5p-51", "<= 0x1.4p-51"},
        Falsification{"DigitOfChange", "contact_change.gappa", "rnd(CHANGE_P3 * t + CHANGE_P2)",
                      "rnd(CHANGE_P3 * t + 0x1.0000001p-1)"},
        Falsification{"BoundOfChange", "contact_change.gappa", "<= 0x1.78p-52", "<= 0x1.7p-52"},
        Falsification{"BoundOfPoint", "contact_change.gappa", "<= 0x1p-51 ", "<= 0x1.fp-52 "},
        Falsification{"ErrorOfSumsTooSmall", "contact_excess.gappa", "0x1.8p-51", "0x1.4p-51"},
        Falsification{"RangeOfSumsTooLarge", "contact_excess.gappa", "<= 0x1p-6 ", "<= 0x1p-1 "},
        Falsification{"WideningOfAtanTooSmall", "atan_widening.gappa", "0x1.ap-51", "0x1.8p-51"}),
    [](const auto& test) { return test.param.name; });

TEST(Falsified, HintIsFound) {
  const std::string text = proof("widening.gappa");
  EXPECT_EQ(gappa(replaced(text, "(1 + (up - wide) / wide)", "(1 + (up - wide) / up)")), Verdict::trusts_a_hint);
}

TEST(Falsified, ConstantOfTheKernelIsFound) {
  const std::string kernel = replaced(elementary(), "0x1.5555555553cd9p-5", "0x1.5555555563cd9p-5");
  const Constants computed = defined_constants(sollya(proof("exp.sollya")));
  EXPECT_THAT(mismatches(computed, kernel_constants(kernel)), ::testing::ElementsAre("EXP_P2"));
}

TEST(Falsified, ConstantOfTheScriptIsFound) {
  const std::string script = replaced(proof("exp.sollya"), "for i from", "P = P + 0x1p-44 * x^2;\nfor i from");
  const std::string output = sollya(script);
  EXPECT_THAT(mismatches(defined_constants(output), kernel_constants(elementary())), ::testing::ElementsAre("EXP_P2"));
  Bounds bounds = sollya_bounds(output);
  append(bounds, gappa_bounds(proof("exp.gappa")));
  EXPECT_THAT(unproven(bounds), ::testing::Contains("EXP_APPROXIMATION"));
}

TEST(Falsified, OperationOfTheKernelIsFound) {
  const std::string kernel = replaced(elementary(), "fma(p49, r4, p03)", "fma(p49, r2, p03)");
  EXPECT_NE(kernel_operations(kernel, "exp_nearest", "exp"), kernel_operations(elementary(), "exp_nearest", "exp"));
}

}  // namespace
}  // namespace verisq
