/// The self-test accepts the kernels as they are and refuses kernels whose rounding is broken in one place.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "host/device/device.hpp"
#include "host/device/sample_operations.hpp"

namespace verisq::device {
namespace {

constexpr int width = 4;

/// One change to the kernels' text, and the operation that the self-test must name.
struct Mutant {
  std::string name;
  std::string text;
  std::string replacement;
  std::string caught_by;
};

std::string outcome_of(const Device& device, const std::string& sources) {
  cl::Program program(device.context, sources);
  program.build({device.device}, fmt::format("-cl-std=CL1.2 -DVECTOR_WIDTH={}", width).c_str());
  return self_test(device.context, device.device, program, width);
}

class SelfTest : public testing::TestWithParam<Mutant> {
 protected:
  void SetUp() override {
    if (!selection.device) GTEST_SKIP() << "no OpenCL device: " << selection.notice;
  }

  const Selection selection = select_device("auto");
};

TEST_P(SelfTest, RefusesBrokenRounding) {
  std::string sources = device::self_test_sources();
  const auto at = sources.find(GetParam().text);
  ASSERT_NE(at, std::string::npos) << "the kernels no longer contain " << GetParam().text;
  sources.replace(at, GetParam().text.size(), GetParam().replacement);
  EXPECT_THAT(outcome_of(*selection.device, sources), testing::StartsWith(GetParam().caught_by));
}

TEST_F(SelfTest, AcceptsTheKernels) {
  EXPECT_EQ(outcome_of(*selection.device, device::self_test_sources()), "");
}

INSTANTIATE_TEST_SUITE_P(
    Mutants, SelfTest,
    testing::Values(Mutant{"NoOutwardStep", "return c - fma(REAL(ROUNDING_PHI), fabs(c), REAL(ROUNDING_ETA));",
                           "return c;", "add_down"},
                    Mutant{"StepTooSmall", "0x1.0000000000001p-53 //", "0x1p-56 //", "add_down"},
                    Mutant{"FlippedBound", "mul_up(real a, real b) { return step_up",
                           "mul_up(real a, real b) { return step_down", "mul_up"},
                    Mutant{"Contraction", "FP_CONTRACT OFF", "FP_CONTRACT ON", "a * b + c without contraction"},
                    Mutant{"NoWideningOfExp", "ELEMENTARY_WIDENING 0x1p-51", "ELEMENTARY_WIDENING 0x0p0", "exp_down"},
                    Mutant{"WrongDigitInExp", "0x1.5555555553cd9p-5", "0x1.5555555563cd9p-5", "exp_"},
                    Mutant{"WrongDigitInLog", "0x1.99999999952d9p-2", "0x1.99999999a52d9p-2", "log_"},
                    Mutant{"NoWideningOfAtan", "ATAN_WIDENING 0x1.ap-51", "ATAN_WIDENING 0x0p0", "atan_ratio_"},
                    Mutant{"WrongDigitInAtan", "0x1.c71c71bd6d43ap-4", "0x1.c71c71bd7d43ap-4", "atan_ratio_"},
                    Mutant{"AtanBeyondOne", "select(near, far, MASK(size > 1.0))", "near", "atan_ratio_"}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    IntervalMutants, SelfTest,
    testing::Values(
        Mutant{"NegSwapsEnds", "interval_of(-a.hi, -a.lo)", "interval_of(-a.lo, -a.hi)", "interval_neg"},
        Mutant{"AbsMissesZero", "greater(REAL(0.0), greater(a.lo, -a.hi))", "fmin(fabs(a.lo), fabs(a.hi))",
               "interval_abs"},
        Mutant{"SquareForgetsTheSign", "const interval size = interval_abs(a);", "const interval size = a;",
               "interval_square"},
        Mutant{"OverflowGivesEmpty", "step_down(lesser(REAL(LARGEST_FINITE), lo))", "step_down(lo)", "interval_square"},
        Mutant{"SqrtOfNegativeLowerEnd", "sqrt_down(fmax(a.lo, REAL(0.0)))", "sqrt_down(fabs(a.lo))", "interval_sqrt"},
        Mutant{"ExpOfEmpty", "return empty_unless(MASK(a.lo <= a.hi), interval_of(exp_down(a.lo), exp_up(a.hi)));",
               "return interval_of(exp_down(a.lo), exp_up(a.hi));", "interval_exp"},
        Mutant{"LogOfZeroAlone", "MASK(a.hi > 0.0), interval_of(log_down", "MASK(a.hi >= 0.0), interval_of(log_down",
               "interval_log"},
        Mutant{"AddRoundsInwards", "outward(a.lo + b.lo, a.hi + b.hi)", "interval_of(a.lo + b.lo, a.hi + b.hi)",
               "interval_add"},
        Mutant{"SubPairsWrongEnds", "outward(a.lo - b.hi, a.hi - b.lo)", "outward(a.lo - b.lo, a.hi - b.hi)",
               "interval_sub"},
        Mutant{"MulDropsAProduct", "outward(lesser(lesser(p, q), lesser(r, s))", "outward(lesser(lesser(p, q), r)",
               "interval_mul"},
        Mutant{"ZeroTimesInfinity", "select(REAL(0.0), product, MASK(product == product))", "product", "interval_mul"},
        Mutant{"MulOfEmpty", "empty_unless(defined, outward(lesser(lesser",
               "empty_unless(defined | -1, outward(lesser(lesser", "interval_mul"},
        Mutant{"DivByTheWrongZero", "fabs(select(b.lo, b.hi, flip))", "select(b.lo, b.hi, flip)", "interval_div"},
        Mutant{"DivForgetsZeroAtAnEnd", "select(largest, least, MASK(hi > 0.0))",
               "select(largest, least, MASK(hi >= 0.0))", "interval_div"},
        Mutant{"DivForgetsZeroInside", "interval_select(quotient, interval_entire(), unbounded)", "quotient",
               "interval_div"},
        Mutant{"DivByZero", "MASK(largest == 0.0)", "MASK(largest < 0.0)", "interval_div"},
        Mutant{"PowOfZero", "MASK(a.hi == 0.0) & MASK(b.hi > 0.0)", "MASK(a.hi == 0.0) & MASK(b.lo > 0.0)",
               "interval_pow"},
        Mutant{"ScaledAddForgetsTheSign", "const integer negative = MASK(s < 0.0);",
               "const integer negative = MASK(s != s);", "interval_scaled_add"},
        Mutant{"MinOfEmpty", "return empty_unless(defined, interval_of(lesser(a.lo, b.lo), lesser(a.hi, b.hi)));",
               "return interval_of(lesser(a.lo, b.lo), lesser(a.hi, b.hi));", "interval_min"},
        Mutant{"MaxTakesTheLesser", "interval_of(greater(a.lo, b.lo), greater(a.hi, b.hi))",
               "interval_of(lesser(a.lo, b.lo), greater(a.hi, b.hi))", "interval_max"},
        Mutant{"HullOfOne", "fmax(a.hi, b.hi)", "a.hi", "interval_hull"},
        Mutant{"IntersectionOfDisjoint", "MASK(a.lo <= b.hi) & MASK(b.lo <= a.hi)", "MASK(a.lo <= b.hi)",
               "interval_intersection"},
        Mutant{"AtanOfTheWrongEnd", "atan_ratio_up(magnitude.lo)", "atan_ratio_up(magnitude.hi)",
               "interval_atan_ratio"},
        Mutant{"AtanForgetsTheSign", "const interval magnitude = interval_abs(a);", "const interval magnitude = a;",
               "interval_atan_ratio"},
        Mutant{"AtanOfEmpty",
               "return empty_unless(MASK(a.lo <= a.hi), interval_of(atan_ratio_down(magnitude.hi), "
               "atan_ratio_up(magnitude.lo)));",
               "return interval_of(atan_ratio_down(magnitude.hi), atan_ratio_up(magnitude.lo));",
               "interval_atan_ratio"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace verisq::device
