/// Proves on samples that a device computes as the kernels' proofs assume, before anything else is believed of it.
#pragma once

#include <string>

#include "host/opencl/opencl.hpp"

namespace verisq::device {

/// The program of the self-test: the arithmetic layers as every program has them, and its kernels.
[[nodiscard]] std::string self_test_sources();

/// Every rounding primitive, elementary function and interval operation of the kernels on adversarial and random
/// operands, against MPFR.
/// Returns an empty string, or one line with the first operation that failed, its operands and result.
/// `program` is compiled from `self_test_sources`, `vector_width` is its.
[[nodiscard]] std::string self_test(const cl::Context& context, const cl::Device& device, const cl::Program& program,
                                    int vector_width);

}  // namespace verisq::device
