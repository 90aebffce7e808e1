/// Poses of a model B in, enclosures of its distances to a model A out; there are no certificates.
#pragma once

#include <memory>

#include "host/batches/batch.hpp"
#include "host/device/device.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

/// Throws Error(failure) with the name of a failed OpenCL call.
[[nodiscard]] std::unique_ptr<Batch<Pose>> pose_batch(const Device& device, const Model& a, const Model& b);

}  // namespace verisq::device
