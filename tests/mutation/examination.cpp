/// This file implements the launches of single functions.
#include "tests/mutation/examination.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <tuple>

#include "tests/mutation/launch.hpp"

namespace verisq::mutation {
namespace {

constexpr std::size_t operand_count = std::tuple_size_v<Operands>;
constexpr std::size_t result_count = std::tuple_size_v<Results>;

}  // namespace

std::vector<Results> called(const CompiledKernels& kernels, const char* examination, cl_uint function,
                            const std::vector<Sample>& samples, device::PrimitiveParameters parameters) {
  Columns columns(operand_count);
  for (const Sample& sample : samples)
    for (std::size_t i = 0; i < operand_count; ++i) columns[i].push_back(sample.operands[i]);
  const cl::Buffer operands = uploaded(kernels, columns);
  const cl::Buffer primitive(kernels.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, sizeof parameters, &parameters);
  const std::size_t stride = samples.size();
  const cl::Buffer output = zeros(kernels, result_count * stride);
  const cl_ulong groups = stride / static_cast<std::size_t>(kernels.vector_width);
  cl::Kernel kernel(kernels.program, examination);
  kernel.setArg(0, function);
  kernel.setArg(1, groups);
  kernel.setArg(2, operands);
  kernel.setArg(3, cl_ulong{stride});
  kernel.setArg(4, primitive);
  kernel.setArg(5, output);
  const cl::CommandQueue queue(kernels.context, kernels.device);
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups));
  const std::vector<double> numbers = read(queue, output, result_count * stride);
  std::vector<Results> results(stride);
  for (std::size_t n = 0; n < stride; ++n)
    for (std::size_t i = 0; i < result_count; ++i) results[n][i] = numbers[i * stride + n];
  return results;
}

std::string described(const Operands& o, const Results& r) {
  return fmt::format(
      "of ({:.17g}, {:.17g}, {:.17g}), {:.17g}, ... claims [{:.17g}, {:.17g}] by ({:.17g}, {:.17g}, {:.17g})", o[0],
      o[1], o[2], o[3], r[0], r[1], r[2], r[3], r[4]);
}

}  // namespace verisq::mutation
