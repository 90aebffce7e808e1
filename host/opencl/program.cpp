/// This file implements the compilation of the kernels and the cache of their binaries.
#include "host/opencl/program.hpp"

#include <fmt/format.h>

#include "host/opencl/cache.hpp"
#include "verisq/error.hpp"

namespace verisq::device {
namespace {

std::optional<cl::Program> from_binary(const cl::Context& context, const cl::Device& device, const std::string& binary,
                                       const std::string& options) {
  try {
    const cl::Program::Binaries binaries{std::vector<unsigned char>(binary.begin(), binary.end())};
    cl::Program program(context, {device}, binaries);
    program.build({device}, options.c_str());
    return program;
  } catch (const cl::Error&) {
    return std::nullopt;  // a binary that the driver takes no more: compile again
  }
}

cl::Program from_sources(const cl::Context& context, const cl::Device& device, std::string_view sources,
                         const std::string& options) {
  cl::Program program(context, std::string(sources));
  try {
    program.build({device}, options.c_str());
  } catch (const cl::Error& error) {
    throw Error(ErrorKind::failure,
                fmt::format("{}: kernels do not compile ({}, {}): {}", identity(device), error.what(), error.err(),
                            program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device)));
  }
  return program;
}

std::string options_of(int vector_width, const std::string& extra_options) {
  // Never -cl-unsafe-math-optimizations, -cl-mad-enable, -cl-denorms-are-zero: docs/rounding.md §1.
  const std::string options = fmt::format("-cl-std=CL1.2 -DVECTOR_WIDTH={}", vector_width);
  return extra_options.empty() ? options : options + " " + extra_options;
}

bool driver_keeps_binaries(const cl::Device& device) {
  const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
  return platform.getInfo<CL_PLATFORM_NAME>() == "Portable Computing Language";
}

}  // namespace

std::string identity(const cl::Device& device) {
  const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
  return fmt::format("{} / {} / {}", device.getInfo<CL_DEVICE_NAME>(), platform.getInfo<CL_PLATFORM_VERSION>(),
                     device.getInfo<CL_DRIVER_VERSION>());
}

LoadedProgram load_program(const cl::Context& context, const cl::Device& device, int vector_width,
                           std::string_view sources, const std::string& extra_options) {
  const std::string options = options_of(vector_width, extra_options);
  const std::string key = fmt::format("program\n{}\n{}\n{}", identity(device), options, sources);
  if (auto binary = cached(key))
    if (auto program = from_binary(context, device, *binary, options)) return {*program, std::move(*binary)};
  const cl::Program program = from_sources(context, device, sources, options);
  const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
  if (binaries.empty() || binaries.front().empty()) return {program, {}};
  std::string binary(binaries.front().begin(), binaries.front().end());
  store_in_cache(key, binary);
  return {program, std::move(binary)};
}

cl::Program build_program(const cl::Context& context, const cl::Device& device, int vector_width,
                          std::string_view sources, const std::string& extra_options) {
  if (driver_keeps_binaries(device))
    return from_sources(context, device, sources, options_of(vector_width, extra_options));
  return load_program(context, device, vector_width, sources, extra_options).program;
}

}  // namespace verisq::device
