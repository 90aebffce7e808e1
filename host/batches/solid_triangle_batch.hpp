/// Triangles in, distances to a model with bends or set operations out.
#pragma once

#include <functional>
#include <memory>

#include "host/batches/batch.hpp"
#include "host/device/device.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

/// Branch and bound over parts of each triangle (verify/sets/triangle_branch_and_bound.hpp): the device answers the
/// points that all triangles of a chunk ask for at a time. Stops at the tolerance, absolute in model units, and when
/// `out_of_time`, unless empty, says so. Preconditions and errors as those of solid_batch.
[[nodiscard]] std::unique_ptr<Batch<Triangle>> solid_triangle_batch(const Device& device, const Model& model,
                                                                    double tolerance,
                                                                    const std::function<bool()>& out_of_time);

}  // namespace verisq::device
