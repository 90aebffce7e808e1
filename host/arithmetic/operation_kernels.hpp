/// Single operations of the kernels on arrays of operands: how the self-test and the accuracy report see a device.
#pragma once

#include <span>
#include <vector>

#include "host/arithmetic/sample_operands.hpp"
#include "host/opencl/opencl.hpp"

namespace verisq::device {

/// The entry points of kernels/self_test.cl, which number the operations. Any number of operands, one result each.
class OperationKernels {
 public:
  /// `vector_width` must be the program's. Throws cl::Error, as all members do.
  OperationKernels(const cl::Context& context, const cl::Device& device, const cl::Program& program, int vector_width);

  [[nodiscard]] std::vector<double> apply(unsigned operation, std::span<const Operands> operands);
  [[nodiscard]] std::vector<Ends> apply_to_intervals(unsigned operation, std::span<const IntervalOperands> operands);

 private:
  using Column = std::vector<double>;
  std::vector<Column> run(cl::Kernel& kernel, unsigned operation, std::vector<Column> inputs, std::size_t outputs);

  cl::Context context_;
  cl::CommandQueue queue_;
  cl::Kernel on_numbers_;
  cl::Kernel on_intervals_;
  std::size_t vector_width_;
};

}  // namespace verisq::device
