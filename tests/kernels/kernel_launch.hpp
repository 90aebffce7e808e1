/// Launches of single kernels, with columns that lie anywhere in memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/device/device.hpp"

namespace verisq::device {

/// As a device multiplies: a column in memory, read or written from the first of its bytes on.
struct Layout {
  std::size_t first;  // of the column's first value, in values
  std::ptrdiff_t stride;
};

[[nodiscard]] inline std::size_t extent(const Layout& layout, std::size_t size) {
  const std::ptrdiff_t last =
      static_cast<std::ptrdiff_t>(layout.first) + layout.stride * static_cast<std::ptrdiff_t>(size - 1);
  return std::max<std::size_t>(layout.first, static_cast<std::size_t>(last)) + 1;
}

[[nodiscard]] inline std::size_t place(const Layout& layout, std::size_t n) {
  return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(layout.first) +
                                  layout.stride * static_cast<std::ptrdiff_t>(n));
}

class Launcher {
 public:
  explicit Launcher(const Device& device) : context_(device.context), queue_(device.context, device.device) {}

  /// Memory lies before and behind it: a kernel that is broken on purpose may write there, and must not break the
  /// process.
  template <class Value>
  [[nodiscard]] cl::Buffer uploaded(const std::vector<Value>& values) const {
    const std::size_t bytes = values.size() * sizeof(Value);
    cl::Buffer whole(context_, CL_MEM_READ_WRITE, guard + bytes + guard);
    const cl_buffer_region region{guard, bytes};
    cl::Buffer buffer = whole.createSubBuffer(CL_MEM_READ_WRITE, CL_BUFFER_CREATE_TYPE_REGION, &region);
    queue_.enqueueWriteBuffer(buffer, CL_TRUE, 0, values.size() * sizeof(Value), values.data());
    return buffer;
  }

  template <class Value>
  void download(const cl::Buffer& buffer, std::vector<Value>& values) const {
    queue_.enqueueReadBuffer(buffer, CL_TRUE, 0, values.size() * sizeof(Value), values.data());
  }

  void launch(const NamedKernel& kernel, std::size_t groups, std::size_t local) const {
    queue_.enqueueNDRangeKernel(kernel.kernel(), cl::NullRange, cl::NDRange(groups * local), cl::NDRange(local));
    queue_.finish();
  }

 private:
  // Bytes: a multiple of every alignment, and more than a judged column has, which is 150 rows of 56 bytes at most.
  static constexpr std::size_t guard = std::size_t{1} << 16U;

  cl::Context context_;
  cl::CommandQueue queue_;
};

inline void set(NamedKernel& kernel, const std::string& name, const cl::Buffer& buffer, const Layout& layout) {
  kernel.set("memory_" + name, buffer);
  kernel.set("offset_" + name, layout.first);
  kernel.set("stride_" + name, static_cast<std::uint64_t>(layout.stride));
}

}  // namespace verisq::device
