/// Calls functions of the kernels one by one, on operands of which it is known what results are true.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "host/device/primitive_parameters.hpp"
#include "tests/mutation/compiled_kernels.hpp"

namespace verisq::mutation {

using Operands = std::array<double, 8>;
using Results = std::array<double, 5>;

/// Operands of one function, and whether its results are true.
struct Sample {
  Operands operands;
  std::function<bool(const Results&)> holds;
};

/// Calls the entry point `examination` for all samples of the function of this number: its arguments are the number,
/// how many vectors of samples there are, columns of operands, their length, the primitive, and columns of results.
[[nodiscard]] std::vector<Results> called(const CompiledKernels& kernels, const char* examination, cl_uint function,
                                          const std::vector<Sample>& samples, device::PrimitiveParameters parameters);

[[nodiscard]] std::string described(const Operands& operands, const Results& results);

}  // namespace verisq::mutation
