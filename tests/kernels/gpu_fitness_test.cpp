/// What is read of compilers' words about kernels, and when limits count as broken. The limits themselves are a test of
/// their own, gpu_fitness.limits_are_kept.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "bench/gpu_fitness/gpu_compiler.hpp"
#include "bench/gpu_fitness/kernel_resources.hpp"
#include "bench/gpu_fitness/resource_limits.hpp"

namespace verisq::bench {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// A kernel with an array that no registers hold, one that hardly does anything, and sums that contraction would fuse.
const KernelProgram sample{"sample", R"(
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF
kernel void reads_at_random(global const uint* which, global double* x) {
  double own[64];
  for (uint i = 0; i < 64; ++i) own[which[i] & 63] = x[i];
  x[0] = own[which[64] & 63];
}
kernel void adds(global double* x) { x[0] = x[1] * x[2] + x[3]; }
)",
                           ""};

std::vector<MeasuredKernel> limits(const std::string& text) {
  std::istringstream file(text);
  return read_limits(file);
}

TEST(GpuFitness, IsReadFromTheAssemblyOfEachProcessor) {
  for (const GpuTarget& target : gpu_targets()) {
    if (target.nvidia) continue;
    const std::vector<KernelResources> kernels = compiled(sample, target);
    ASSERT_THAT(kernels, SizeIs(2)) << target.name;
    EXPECT_EQ(kernels[0].kernel, "adds");
    EXPECT_EQ(kernels[0].stack_bytes, 0U);
    EXPECT_EQ(kernels[0].occupancy, 1.0);
    EXPECT_GE(kernels[0].registers, 2U);
    EXPECT_EQ(kernels[1].kernel, "reads_at_random");
    EXPECT_GE(kernels[1].stack_bytes, 64 * sizeof(double));
    EXPECT_LE(kernels[1].stack_bytes, 64 * sizeof(double) + 64);
  }
}

TEST(GpuFitness, IsReadFromTheReportOfPtxas) {
  const std::vector<KernelResources> kernels = resources_in_ptxas_report(R"(
ptxas info    : 0 bytes gmem
ptxas info    : Compiling entry function 'pair_distance' for 'sm_90'
ptxas info    : Function properties for pair_distance
    376 bytes stack frame, 600 bytes spill stores, 1308 bytes spill loads
ptxas info    : Used 255 registers, used 0 barriers, 376 bytes cumulative stack size
ptxas info    : Compile time = 1416.262 ms
ptxas info    : Compiling entry function 'adds' for 'sm_90'
ptxas info    : Function properties for adds
    0 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads
ptxas info    : Used 126 registers, used 0 barriers
)");
  ASSERT_THAT(kernels, SizeIs(2));
  EXPECT_EQ(kernels[0].kernel, "adds");
  EXPECT_EQ(kernels[0].registers, 126U);
  EXPECT_EQ(kernels[0].occupancy, 0.25);
  EXPECT_EQ(kernels[1].registers, 255U);
  EXPECT_EQ(kernels[1].spilled_bytes, 600U);
  EXPECT_EQ(kernels[1].stack_bytes, 376U);
  EXPECT_EQ(kernels[1].occupancy, 0.125);
}

TEST(GpuFitness, FindsWhatIsNotRoundedToNearest) {
  EXPECT_THAT(unrounded_instructions("\tadd.rn.f64 \t%fd1, %fd2, %fd3;\n\tdiv.rn.f64 %fd1, %fd2, %fd3;\n"
                                     "\tneg.f64 %fd1, %fd2;\n\tadd.s32 %r1, %r2, %r3;\n"),
              IsEmpty());
  EXPECT_THAT(unrounded_instructions("\tmul.f64 %fd1, %fd2, %fd3;\n\tdiv.approx.f32 %f1, %f2, %f3;\n"
                                     "\tfma.rz.f64 %fd1, %fd2, %fd3, %fd4;\n"),
              ElementsAre("div.approx.f32", "fma.rz.f64", "mul.f64"));
}

TEST(GpuFitness, FindsContractedSums) {
  EXPECT_THAT(defects_of_arithmetic(sample), IsEmpty());
  KernelProgram contracted = sample;
  const std::string pragma = "#pragma OPENCL FP_CONTRACT OFF\n";
  contracted.source.erase(contracted.source.find(pragma), pragma.size());
  EXPECT_THAT(defects_of_arithmetic(contracted), ElementsAre(HasSubstr("1 fused operations, 0 where")));
}

TEST(GpuFitness, SaysWhatDoesNotCompile) {
  EXPECT_THROW((void)compiled({"broken", "kernel void f(global double* x) { y = 1; }", ""}, gpu_targets().front()),
               std::runtime_error);
}

TEST(GpuLimits, AreKeptByWhatIsAtThemOrLittleBelow) {
  const std::vector<MeasuredKernel> own{{"gfx90a", {"f", 100, 40, 1000, 0.5}}};
  EXPECT_THAT(contradictions(own, limits("# comment\ngfx90a,f,100,40,1000\n")), IsEmpty());
  EXPECT_THAT(contradictions(own, limits("gfx90a,f,108,104,1064\n")), IsEmpty());
}

TEST(GpuLimits, AreBrokenByMore) {
  const std::vector<MeasuredKernel> own{{"gfx90a", {"f", 100, 40, 1000, 0.5}}};
  EXPECT_THAT(contradictions(own, limits("gfx90a,f,99,39,999\n")), SizeIs(3));
  EXPECT_THAT(contradictions(own, limits("gfx90a,f,99,39,999\n")), Each(HasSubstr("are allowed")));
}

TEST(GpuLimits, AreToBeLoweredAfterAGain) {
  const std::vector<MeasuredKernel> own{{"gfx90a", {"f", 100, 40, 1000, 0.5}}};
  EXPECT_THAT(contradictions(own, limits("gfx90a,f,109,105,1065\n")), SizeIs(3));
  EXPECT_THAT(contradictions(own, limits("gfx90a,f,109,105,1065\n")), Each(HasSubstr("lower the limit")));
}

TEST(GpuLimits, AreThoseOfTheKernelsThatThereAre) {
  const std::vector<MeasuredKernel> own{{"gfx90a", {"f", 1, 0, 0, 1.0}}, {"gfx90a", {"g", 1, 0, 0, 1.0}}};
  EXPECT_THAT(contradictions(own, limits("gfx90a,f,1,0,0\ngfx90a,h,1,0,0\nsm_90,g,1,0,0\n")),
              ElementsAre("g for gfx90a has no limit", "h for gfx90a: no such kernel"));
}

TEST(GpuLimits, AreWrittenAsTheyAreRead) {
  std::ostringstream file;
  write_limits(file, limits("gfx90a,f,1,2,3\nsm_90,g,4,5,6\n"));
  EXPECT_EQ(file.str(), "gfx90a,f,1,2,3\nsm_90,g,4,5,6\n");
  EXPECT_THROW(limits("gfx90a,f,1,2\n"), std::runtime_error);
}

}  // namespace
}  // namespace verisq::bench
