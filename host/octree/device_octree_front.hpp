/// The undecided cubes of an octree in the memory of a device.
#pragma once

#include <memory>
#include <string>

#include "host/device/device.hpp"
#include "host/octree/octree_front.hpp"

namespace verisq::device {

/// Compiles kernels/octree.cl for the model. `extra_options` are further compiler options (the benchmark uses them:
/// -DNO_SIMPLIFICATION, -DNO_SIBLINGS). Members throw Error(failure) for errors of the device. Precondition: the model
/// is within the device's range.
[[nodiscard]] std::unique_ptr<OctreeFront> octree_front(const Device& device, const Model& model,
                                                        const OctreeRoot& root, const std::string& extra_options = {});

}  // namespace verisq::device
