/// The self-test accepts the kernels as they are and refuses kernels whose rounding is broken in one place.
#include "host/device/self_test.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "host/device/device.hpp"
#include "kernels/embedded_sources.hpp"

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
  std::string sources(kernels::embedded_sources());
  const auto at = sources.find(GetParam().text);
  ASSERT_NE(at, std::string::npos) << "the kernels no longer contain " << GetParam().text;
  sources.replace(at, GetParam().text.size(), GetParam().replacement);
  EXPECT_THAT(outcome_of(*selection.device, sources), testing::StartsWith(GetParam().caught_by));
}

TEST_F(SelfTest, AcceptsTheKernels) {
  EXPECT_EQ(outcome_of(*selection.device, std::string(kernels::embedded_sources())), "");
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
                    Mutant{"WrongDigitInLog", "0x1.99999999952d9p-2", "0x1.99999999a52d9p-2", "log_"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace verisq::device
