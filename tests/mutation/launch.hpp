/// Launches of the kernels of triangles and of pairs on all queries of a scene at once.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "host/device/primitive_parameters.hpp"
#include "tests/mutation/compiled_kernels.hpp"

namespace verisq::mutation {

using Columns = std::vector<std::vector<double>>;

/// Of kernels whose work-items own blocks of points.
inline constexpr cl_uint groups_per_block = 4;

/// The least multiple of the vector width that is not below `queries`.
[[nodiscard]] inline std::size_t padded(std::size_t queries, const CompiledKernels& kernels) {
  const auto width = static_cast<std::size_t>(kernels.vector_width);
  return (queries + width - 1) / width * width;
}

/// The model's primitives as the kernels want them. Precondition: the frame of the device is the model's.
[[nodiscard]] inline cl::Buffer uploaded(const CompiledKernels& kernels, std::span<const Primitive> primitives) {
  std::vector<device::PrimitiveParameters> parameters;
  for (const Primitive& primitive : primitives) parameters.push_back(device::primitive_parameters(primitive, 0));
  return {kernels.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
          parameters.size() * sizeof(device::PrimitiveParameters), parameters.data()};
}

/// Columns of equal length, one after the other.
[[nodiscard]] inline cl::Buffer uploaded(const CompiledKernels& kernels, const Columns& columns) {
  std::vector<double> numbers;
  for (const std::vector<double>& column : columns) numbers.insert(numbers.end(), column.begin(), column.end());
  return {kernels.context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, numbers.size() * sizeof(double), numbers.data()};
}

/// `count` numbers, zero at first.
[[nodiscard]] inline cl::Buffer zeros(const CompiledKernels& kernels, std::size_t count) {
  std::vector<double> numbers(count, 0.0);
  return {kernels.context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, count * sizeof(double), numbers.data()};
}

[[nodiscard]] inline std::vector<double> read(const cl::CommandQueue& queue, const cl::Buffer& buffer,
                                              std::size_t count) {
  std::vector<double> numbers(count);
  queue.enqueueReadBuffer(buffer, CL_TRUE, 0, count * sizeof(double), numbers.data());
  return numbers;
}

}  // namespace verisq::mutation
