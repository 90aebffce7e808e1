/// Triangles in, enclosures of their distances to a model out.
#pragma once

#include <memory>

#include "host/batches/batch.hpp"
#include "host/device/device.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

/// `certificates` as in MapOptions. Throws Error(failure) with the name of a failed OpenCL call.
[[nodiscard]] std::unique_ptr<Batch<Triangle>> triangle_batch(const Device& device, const Model& model,
                                                              bool certificates);

}  // namespace verisq::device
