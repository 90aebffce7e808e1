/// The kernels, compiled for one device, and how their arguments are set by name.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/device/opencl.hpp"

namespace verisq::device {

// The kernels, compiled for one device.

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

/// The same without the binary. The process keeps the programs that it compiled last: a second call with the same
/// context returns the same program. If the driver keeps binaries of its own, no other is made. PoCL would compile
/// every kernel for groups of any size, which takes as long again as the compilation for the used sizes.
[[nodiscard]] cl::Program build_program(const cl::Context& context, const cl::Device& device, int vector_width,
                                        std::string_view sources, const std::string& extra_options = {});

/// Identifies everything that a program's results depend on beside the driver. This is its sources and options if the
/// driver keeps binaries of its own, else its binary's size and checksum; empty if there is none.
[[nodiscard]] std::string program_identity(const cl::Device& device, const cl::Program& program);

// A kernel whose arguments are set by their names in its source.

/// Positions would go wrong in silence when a parameter is added; names and types that the source does not have throw
/// Error(failure). Like OpenCL's kernels it does not keep the buffers that it is given.
class NamedKernel {
 public:
  /// `source` is the text from which `program` was compiled, or the part of it that declares `kernel void NAME(...)`.
  NamedKernel(const cl::Program& program, std::string_view source, const std::string& name);

  void set(std::string_view argument, const cl::Buffer& buffer);
  void set(std::string_view argument, const cl::LocalSpaceArg& size);
  /// A number of the type that the source declares: double, or uint or ulong that hold it.
  void set(std::string_view argument, std::floating_point auto number) { set_real(argument, number); }
  void set(std::string_view argument, std::unsigned_integral auto count) { set_count(argument, count); }

  template <std::size_t N>
  void set(const std::array<std::string_view, N>& arguments, const std::array<cl::Buffer, N>& buffers) {
    for (std::size_t i = 0; i < N; ++i) set(arguments[i], buffers[i]);
  }

  [[nodiscard]] const cl::Kernel& kernel() const { return kernel_; }

 private:
  enum class Type { buffer, local_space, real, count32, count64, other };

  struct Argument {
    std::string name;
    Type type;
  };

  static Argument parsed(std::string_view parameter);
  [[nodiscard]] cl_uint position(std::string_view argument, std::initializer_list<Type> types) const;
  void set_real(std::string_view argument, double number);
  void set_count(std::string_view argument, std::uint64_t count);

  std::string name_;
  cl::Kernel kernel_;
  std::vector<Argument> arguments_;
};

// Names of arguments that several kernels have, in the order of the buffers that belong to them.

inline constexpr std::array<std::string_view, 3> coordinate_arguments{"xs", "ys", "zs"};
inline constexpr std::array<std::string_view, 2> enclosure_arguments{"los", "his"};
inline constexpr std::array<std::string_view, 2> union_arguments{"union_los", "union_his"};

/// The arguments of EvidenceBuffers.
inline constexpr std::array<std::string_view, 5> evidence_arguments{"los", "his", "normal_xs", "normal_ys",
                                                                    "normal_zs"};

}  // namespace verisq::device
