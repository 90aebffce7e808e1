/// Which memory of a device kernels read a model from.
#pragma once

#include <string>

#include "host/device/device.hpp"

namespace verisq::device {

/// The compiler option of programs that read a model of so many bytes: nothing where it fits into the device's constant
/// memory, for which the kernels are written; else that of global memory. A kernel has one such argument at most, and
/// CL_DEVICE_MAX_CONSTANT_ARGS is at least 4 on every device. Global memory for all would cost PoCL 4 % of the time of
/// points and 3 % of a fit's (measured), and graphics processors a cache.
[[nodiscard]] inline std::string model_memory_option(const Device& device, std::size_t bytes) {
  return bytes <= device.constant_memory ? "" : "-DMODEL_IN_GLOBAL_MEMORY";
}

}  // namespace verisq::device
