/// Proves on samples that a device computes as the kernels' proofs assume, before anything else is believed of it.
#pragma once

#include <string>

#include "host/opencl/opencl.hpp"

namespace verisq::device {

/// Every rounding primitive, elementary function and interval operation of the kernels on adversarial and random
/// operands, against MPFR.
/// Returns an empty string, or one line with the first operation that failed, its operands and result.
/// `vector_width` must be the program's.
[[nodiscard]] std::string self_test(const cl::Context& context, const cl::Device& device, const cl::Program& program,
                                    int vector_width);

}  // namespace verisq::device
