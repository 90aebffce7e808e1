/// OpenCL: its bindings, programs and kernels, the cache between runs, and devices that passed their self-test.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/threads/background_work.hpp"
#include "verisq/error.hpp"

// The OpenCL C++ bindings, configured once: exceptions on, nothing newer than OpenCL 1.2 needed.

#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"
#pragma GCC diagnostic ignored "-Wpedantic"
#endif
#include <CL/opencl.hpp>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

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

// Small files that save work between runs: device programs and self-test outcomes. Losing them loses only time.

/// The whole content stored under `key`, or nothing. A damaged file is removed. The directory is $XDG_CACHE_HOME/verisq
/// or ~/.cache/verisq.
[[nodiscard]] std::optional<std::string> cached(std::string_view key);

/// Stores `content` under `key`; failing to is not an error. Other processes may do the same at the same time.
void store_in_cache(std::string_view key, std::string_view content);

// Checksums that reveal damaged files, and distinguish device programs.

/// CRC-64/XZ (the polynomial of ECMA-182), the same in every build. Finds every damage within 64 consecutive bits, and
/// all other damage but for one case in 2^64. It does not protect against forgery.
[[nodiscard]] std::uint64_t checksum(std::string_view bytes);

// Outcomes of self-tests in the cache: each is tried once, and believed only where the cache states it in full.

/// The first failure of a self-test, or an empty string: the result in the cache under `key`, else the result of
/// `tried`, which the cache keeps from then on. With an empty key nothing is remembered.
[[nodiscard]] std::string remembered_failure(const std::string& key, const std::function<std::string()>& tried);

// An OpenCL device that passed its self-test.

/// Copies share the OpenCL objects, which release themselves.
struct Device {
  std::string name;
  cl::Device device;
  cl::Context context;
  int vector_width;             ///< points a work-item
  std::size_t constant_memory;  ///< bytes that a buffer in constant memory may have: 64 KiB on many graphics processors
};

/// A device, whose arithmetic passed, erred on samples of a program (host/device/program_self_test.hpp): nothing that
/// it computes is to be used. The message is that of a notice.
class RefusedDevice : public Error {
 public:
  RefusedDevice(const std::string& name, const std::string& failure);
};

/// The requested device ("auto", an index or a part of a name; see `test_devices`). Nothing if "auto" finds none that
/// passes; `notice` then gives the reason. Throws Error(input) if a request matches no device, or one that failed its
/// self-test.
struct Selection {
  std::optional<Device> device;
  std::string notice;
};
[[nodiscard]] Selection select_device(std::string_view request);

/// The same, but no device, with a notice, once `ended` returns true: the kernels of a self-test compile for seconds.
[[nodiscard]] Selection select_device(std::string_view request, const std::function<bool()>& ended);

/// Adds the refusal to the notice; the host steps in. Throws Error(input) if `request` named the device.
void note_refusal(std::string& notice, std::string_view request, const RefusedDevice& refused);
/// Adds that the work ended before the kernels were compiled.
void note_early_end(std::string& notice);

/// Makes the selected device ready by `make`, which must own all that it uses: it may be given up. Returns nothing if
/// there is no device. If the device errs on samples, or `ended` returns true first: returns nothing, clears the device
/// and gives the reason in the notice. Throws like note_refusal.
template <class Make>
[[nodiscard]] auto made_ready(Selection& selection, std::string_view request, const std::function<bool()>& ended,
                              const Make& make) -> decltype(make(*selection.device)) {
  if (!selection.device) return nullptr;
  try {
    using Ready = decltype(make(*selection.device));
    WorkThatMayBeGivenUp<Ready> work([make, device = *selection.device] { return make(device); });
    if (std::optional<Ready> ready = work.result(ended)) return *std::move(ready);
    note_early_end(selection.notice);
  } catch (const RefusedDevice& refused) {
    note_refusal(selection.notice, request, refused);
  }
  selection.device.reset();
  return nullptr;
}

/// The requests for one device each, from a request for several: indices or parts of names with commas between, at
/// least one. Names may contain commas, too. Throws Error(input) if one of them requests no device, or a device that
/// another one requests.
[[nodiscard]] std::vector<std::string> requests_in(std::string_view request);

}  // namespace verisq::device
