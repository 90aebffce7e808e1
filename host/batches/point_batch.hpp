/// Points in, enclosures of their signed distances to a model out.
#pragma once

#include <memory>

#include "host/batches/batch.hpp"
#include "host/device/device.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

/// `tolerance` and `certificates` as in MapOptions. Throws Error(failure) with the name of a failed OpenCL call.
[[nodiscard]] std::unique_ptr<Batch<Point>> point_batch(const Device& device, const Model& model, double tolerance,
                                                        bool certificates);

/// With kernels of one's own, for tests. Precondition: compiled for the memory that the device's models of this size
/// lie in, and for the device's vector width.
[[nodiscard]] std::unique_ptr<Batch<Point>> point_batch(const Device& device, const cl::Program& program,
                                                        const Model& model, double tolerance, bool certificates);

}  // namespace verisq::device
