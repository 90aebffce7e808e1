/// The kernels, compiled for one device.
#pragma once

#include <string>
#include <string_view>

#include "host/opencl/opencl.hpp"

namespace verisq::device {

/// Identifies a device with its driver, for caches and messages.
[[nodiscard]] std::string identity(const cl::Device& device);

/// A program with the binary that it was loaded from, or that the next run will load; empty where the driver has none.
struct LoadedProgram {
  cl::Program program;
  std::string binary;
};

/// Compiles `sources` (kernels/embedded_sources.hpp) for `vector_width` queries a work-item (16, 8, 4 or 1), or takes
/// the binary of an earlier run. `extra_options` are further compiler options (the benchmarks use them). Throws
/// Error(failure) with the compiler's log.
[[nodiscard]] LoadedProgram load_program(const cl::Context& context, const cl::Device& device, int vector_width,
                                         std::string_view sources, const std::string& extra_options = {});

/// Likewise, for who does not ask for the binary. Where the driver keeps binaries of its own no other is made: PoCL
/// would compile every kernel for groups of any size, which takes as long again as the compilation for those that are
/// used.
[[nodiscard]] cl::Program build_program(const cl::Context& context, const cl::Device& device, int vector_width,
                                        std::string_view sources, const std::string& extra_options = {});

}  // namespace verisq::device
