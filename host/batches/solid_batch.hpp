/// Points in, signed distances to a model with bends or set operations out.
#pragma once

#include <memory>
#include <vector>

#include "host/batches/batch.hpp"
#include "host/device/device.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

/// Branch and bound over cubes (kernels/solid_distance.cl) with the tolerance, absolute in model units, as its stop.
/// Compiles the model's own tree. Precondition: within_device_range(model). Throws Error(failure) with the name of a
/// failed OpenCL call.
[[nodiscard]] std::unique_ptr<Batch<Point>> solid_batch(const Device& device, const Model& model, double tolerance);

/// The same, and of the points of the chunk that was collected last about the gradients of their signed distances, in
/// the model's frame, of any length: zero where the kernels did not look for them. They prove nothing.
struct DirectedBatch {
  std::unique_ptr<Batch<Point>> points;
  std::shared_ptr<const std::vector<Point>> directions;
};
[[nodiscard]] DirectedBatch directed_solid_batch(const Device& device, const Model& model, double tolerance);

}  // namespace verisq::device
