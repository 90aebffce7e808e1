/// Kernels of sources that may be broken, compiled for a device.
#pragma once

#include <string>

#include "host/device/device.hpp"

namespace verisq::mutation {

struct CompiledKernels : device::Device {
  cl::Program program;
};

/// The kernels of `sources`, compiled for `width` points a work-item; few compile fast.
[[nodiscard]] CompiledKernels compiled(const device::Device& device, const std::string& sources, int width = 4);

}  // namespace verisq::mutation
