/// A kernel whose arguments are set by the names that its source gives them.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/opencl/opencl.hpp"

namespace verisq::device {

/// Positions would go wrong in silence when a parameter is added; names and types that the source does not have throw
/// Error(failure). Like OpenCL's kernels it does not keep the buffers that it is given.
class NamedKernel {
 public:
  /// `source`: the text that `program` was compiled from, or the part of it that declares `kernel void NAME(...)`.
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

}  // namespace verisq::device
