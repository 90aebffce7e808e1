/// The self-test of a device's arithmetic, and a report of how accurate that is.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/device/opencl.hpp"
#include "host/device/sample_operations.hpp"
#include "verisq/device.hpp"

namespace verisq::device {

// Proves on samples that a device computes as the kernels' proofs assume, before anything else is believed of it.

/// The program of the self-test: the arithmetic layers as every program has them, and its kernels.
[[nodiscard]] std::string self_test_sources();

/// Every rounding primitive, elementary function and interval operation of the kernels on adversarial and random
/// operands, against MPFR.
/// Returns an empty string, or one line with the first operation that failed, its operands and result.
/// `program` is compiled from `self_test_sources`, `vector_width` is its.
[[nodiscard]] std::string self_test(const cl::Context& context, const cl::Device& device, const cl::Program& program,
                                    int vector_width);

// Measures how far the directed operations of a device lie outside the tightest bounds.

/// The rows of `device_accuracy` for kernels that need not have passed the self-test.
[[nodiscard]] std::vector<FunctionAccuracy> measure_accuracy(OperationKernels& kernels, std::size_t samples,
                                                             const std::function<void(double)>& progress);

}  // namespace verisq::device
