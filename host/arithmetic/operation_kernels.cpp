/// This file implements the transfers around the entry points of kernels/self_test.cl.
#include "host/arithmetic/operation_kernels.hpp"

namespace verisq::device {

OperationKernels::OperationKernels(const cl::Context& context, const cl::Device& device, const cl::Program& program,
                                   int vector_width)
    : context_(context),
      queue_(context, device),
      on_numbers_(program, "apply_operation"),
      on_intervals_(program, "apply_interval_operation"),
      vector_width_(static_cast<std::size_t>(vector_width)) {}

std::vector<double> OperationKernels::apply(unsigned operation, std::span<const Operands> operands) {
  std::vector<Column> inputs(3);
  for (const Operands& o : operands) {
    inputs[0].push_back(o.a);
    inputs[1].push_back(o.b);
    inputs[2].push_back(o.c);
  }
  Column results = run(on_numbers_, operation, std::move(inputs), 1).front();
  results.resize(operands.size());
  return results;
}

std::vector<Ends> OperationKernels::apply_to_intervals(unsigned operation, std::span<const IntervalOperands> operands) {
  std::vector<Column> inputs(4);
  for (const IntervalOperands& o : operands) {
    inputs[0].push_back(o.a.lo);
    inputs[1].push_back(o.a.hi);
    inputs[2].push_back(o.b.lo);
    inputs[3].push_back(o.b.hi);
  }
  const std::vector<Column> columns = run(on_intervals_, operation, std::move(inputs), 2);
  std::vector<Ends> results;
  for (std::size_t i = 0; i < operands.size(); ++i) results.push_back({columns[0][i], columns[1][i]});
  return results;
}

// Columns are filled up with ones to whole vectors.
std::vector<OperationKernels::Column> OperationKernels::run(cl::Kernel& kernel, unsigned operation,
                                                            std::vector<Column> inputs, std::size_t outputs) {
  const std::size_t groups = (inputs.front().size() + vector_width_ - 1) / vector_width_;
  if (groups == 0) return std::vector<Column>(outputs);
  const std::size_t bytes = groups * vector_width_ * sizeof(double);
  cl_uint argument = 0;
  kernel.setArg(argument++, static_cast<cl_uint>(operation));
  kernel.setArg(argument++, static_cast<cl_ulong>(groups));
  std::vector<cl::Buffer> buffers;  // kept alive until the kernel has run
  for (Column& input : inputs) {
    input.resize(groups * vector_width_, 1.0);
    buffers.emplace_back(context_, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, bytes, input.data());
    kernel.setArg(argument++, buffers.back());
  }
  for (std::size_t i = 0; i < outputs; ++i) {
    buffers.emplace_back(context_, CL_MEM_WRITE_ONLY, bytes);
    kernel.setArg(argument++, buffers.back());
  }
  // PoCL compiles a kernel again for each size of work-groups; for groups of one work-item that takes it least time.
  queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups),
                              vector_width_ > 1 ? cl::NDRange(1) : cl::NullRange);
  std::vector<Column> results(outputs, Column(groups * vector_width_));
  for (std::size_t i = 0; i < outputs; ++i) {
    queue_.enqueueReadBuffer(buffers[inputs.size() + i], CL_TRUE, 0, bytes, results[i].data());
  }
  return results;
}

}  // namespace verisq::device
