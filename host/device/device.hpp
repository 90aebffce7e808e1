/// An OpenCL device that passed its self-test.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/opencl/opencl.hpp"

namespace verisq::device {

/// Copies share the OpenCL objects, which release themselves.
struct Device {
  std::string name;
  cl::Device device;
  cl::Context context;
  int vector_width;             ///< points a work-item
  std::size_t constant_memory;  ///< bytes that a buffer in constant memory may have: 64 KiB on many graphics processors
};

/// The device that `request` asks for ("auto", an index or a part of a name; see `test_devices`), or nothing when
/// "auto" finds none that passes; `notice` then says why. Throws Error(input) when a request matches no device, or one
/// that failed its self-test.
struct Selection {
  std::optional<Device> device;
  std::string notice;
};
[[nodiscard]] Selection select_device(std::string_view request);

/// What asks for one device each, of a request for several, indices or parts of names with commas between: at least
/// one. Names may have commas, too. Throws Error(input) where one asks for no device, or for one that another asks for.
[[nodiscard]] std::vector<std::string> requests_in(std::string_view request);

}  // namespace verisq::device
