/// Measures how far the directed operations of a device lie outside the tightest bounds.
#pragma once

#include <functional>
#include <vector>

#include "host/arithmetic/operation_kernels.hpp"
#include "verisq/device.hpp"

namespace verisq::device {

/// The rows of `device_accuracy` for kernels that need not have passed the self-test.
[[nodiscard]] std::vector<FunctionAccuracy> measure_accuracy(OperationKernels& kernels, std::size_t samples,
                                                             const std::function<void(double)>& progress);

}  // namespace verisq::device
