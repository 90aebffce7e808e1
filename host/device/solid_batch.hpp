/// Points and triangles in, distances to a model with bends or set operations out.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "host/device/chunk_pipeline.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

// Points in, signed distances to a model with bends or set operations out.

/// Branch and bound over cubes (kernels/solid_distance.cl) with the tolerance, absolute in model units, as its stop.
/// Compiles the model's own tree. Precondition: within_device_range(model). Throws Error(failure) with the name of a
/// failed OpenCL call, and RefusedDevice where the kernels err on samples.
[[nodiscard]] std::unique_ptr<Batch<Point>> solid_batch(const Device& device, const Model& model, double tolerance);

/// The programs that a model needs.
struct SolidPrograms {
  cl::Program own;                      ///< of solid_source(model), for solid_vector_width
  std::optional<PointPrograms> convex;  ///< nothing where all primitives are bent
};

/// With kernels of the model that are not tried before.
[[nodiscard]] std::unique_ptr<Batch<Point>> solid_batch(const Device& device, const SolidPrograms& programs,
                                                        const Model& model, double tolerance);

/// The same, and of the points of the chunk that was collected last about the gradients of their signed distances, in
/// the model's frame, of any length: zero where the kernels did not look for them. They prove nothing.
struct DirectedBatch {
  std::unique_ptr<Batch<Point>> points;
  std::shared_ptr<const std::vector<Point>> directions;
};
[[nodiscard]] DirectedBatch directed_solid_batch(const Device& device, const Model& model, double tolerance);

// Triangles in, distances to a model with bends or set operations out.

/// Branch and bound over parts of each triangle (verify/search/solid_triangle_distance.hpp): the device evaluates the
/// points that all triangles of a chunk request at a time. Stops at the tolerance, absolute in model units, and once
/// `stop`, unless empty, returns true. Preconditions and errors as those of solid_batch.
[[nodiscard]] std::unique_ptr<Batch<Triangle>> solid_triangle_batch(const Device& device, const Model& model,
                                                                    double tolerance,
                                                                    const std::function<bool()>& stop);

}  // namespace verisq::device
