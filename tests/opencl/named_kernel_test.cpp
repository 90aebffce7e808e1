/// Arguments of kernels by their names: what the source declares is set, anything else refused.
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>
#include <verisq/error.hpp>

#include "host/device/device.hpp"

namespace verisq::device {
namespace {

constexpr std::string_view source = R"(
kernel void unrelated(global double* other) { other[0] = 0.0; }
kernel void combine(uint count, ulong begin, double factor,
                    global const double*  inputs, local double* scratch, global double* results) {
  const ulong i = get_global_id(0);
  if (i >= count) return;
  scratch[0] = inputs[begin + i];
  results[i] = factor * scratch[0];
}
)";

class NamedKernelTest : public testing::Test {
 protected:
  void SetUp() override {
    device_ = select_device("auto").device;
    ASSERT_TRUE(device_) << "no OpenCL device";
    program_ = build_program(device_->context, device_->device, 1, source);
  }

  std::optional<Device> device_;
  cl::Program program_;
};

TEST_F(NamedKernelTest, SetsWhatTheSourceDeclares) {
  NamedKernel combine(program_, source, "combine");
  std::vector<double> inputs{1.0, 2.0, 3.0};
  const cl::Buffer in(device_->context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, 3 * sizeof(double), inputs.data());
  const cl::Buffer out(device_->context, CL_MEM_WRITE_ONLY, 2 * sizeof(double));
  combine.set("results", out);
  combine.set("inputs", in);
  combine.set("factor", 10.0);
  combine.set("begin", std::uint8_t{1});
  combine.set("count", std::size_t{2});
  combine.set("scratch", cl::Local(sizeof(double)));
  const cl::CommandQueue queue(device_->context, device_->device);
  queue.enqueueNDRangeKernel(combine.kernel(), cl::NullRange, cl::NDRange(2), cl::NDRange(1));
  std::vector<double> results(2);
  queue.enqueueReadBuffer(out, CL_TRUE, 0, 2 * sizeof(double), results.data());
  EXPECT_EQ(results, (std::vector{20.0, 30.0}));
}

TEST_F(NamedKernelTest, RefusesOtherNamesAndTypes) {
  NamedKernel combine(program_, source, "combine");
  const cl::Buffer buffer(device_->context, CL_MEM_READ_WRITE, sizeof(double));
  EXPECT_THROW(combine.set("other", buffer), Error);
  EXPECT_THROW(combine.set("input", buffer), Error);
  EXPECT_THROW(combine.set("factor", std::uint32_t{1}), Error);
  EXPECT_THROW(combine.set("count", 1.0), Error);
  EXPECT_THROW(combine.set("inputs", 1.0), Error);
  EXPECT_THROW(combine.set("scratch", buffer), Error);
  EXPECT_THROW(combine.set("count", std::uint64_t{1} << 32U), Error);
}

TEST_F(NamedKernelTest, RefusesTheSourceOfAnotherProgram) {
  EXPECT_THROW(NamedKernel(program_, "kernel void combine(uint count) {}", "combine"), Error);
}

}  // namespace
}  // namespace verisq::device
