/// Finds an OpenCL device by name, for benchmarks that launch kernels past the library.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "host/device/device.hpp"

namespace verisq::bench {

/// Throws std::runtime_error when there is no device of exactly this name.
[[nodiscard]] inline cl::Device device_named(std::string_view name) {
  std::vector<cl::Platform> platforms;
  cl::Platform::get(&platforms);
  for (const cl::Platform& platform : platforms) {
    std::vector<cl::Device> devices;
    platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
    for (const cl::Device& device : devices)
      if (device.getInfo<CL_DEVICE_NAME>() == name) return device;
  }
  throw std::runtime_error("no OpenCL device is called " + std::string(name));
}

}  // namespace verisq::bench
