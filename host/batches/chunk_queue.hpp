/// One chunk's way through a device: uploads, kernels, downloads, in order, beside those of other chunks.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "host/batches/busy_time.hpp"
#include "host/device/device.hpp"
#include "host/opencl/named_kernel.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::device {

/// Work-items of a work-group: what every kernel is launched with unless it says otherwise. On graphics processors a
/// multiple of what executes together: 64 work-items on AMD's, 32 on others.
[[nodiscard]] inline std::size_t usual_group_size(const Device& device) {
  return device.vector_width > 1 ? 32 : 64;
}

/// Numbers of the device are model units times 2^scale. Exact but for underflow, which the kernels' bounds allow for.
class Scale {
 public:
  explicit Scale(int exponent) : factor_(std::ldexp(1.0, exponent)), inverse_(std::ldexp(1.0, -exponent)) {}

  [[nodiscard]] double factor() const { return factor_; }    ///< 2^scale
  [[nodiscard]] double inverse() const { return inverse_; }  ///< 2^-scale
  [[nodiscard]] double to_device(double x) const { return x * factor_; }
  [[nodiscard]] double to_model(double x) const { return x / factor_; }  ///< for what proves nothing
  /// Rounded outward where it underflows or overflows.
  [[nodiscard]] Enclosure to_model(const Enclosure& e) const;
  /// Likewise, all of them: by one multiplication an end wherever that is exact, as it is but for extremes.
  void to_model(std::span<const double> los, std::span<const double> his, std::span<Enclosure> enclosures) const;

 private:
  double factor_;
  double inverse_;  // exact: exponents of scales are small
};

class ChunkQueue {
 public:
  explicit ChunkQueue(const Device& device);

  /// A buffer of `count` numbers, zero: filled at once, otherwise the first launches would wait for memory.
  [[nodiscard]] cl::Buffer numbers(std::size_t count);

  /// Uploads `column`, which must stay until `finish`, to the buffer's number `offset` and those after it.
  void write(const cl::Buffer& buffer, std::span<const double> column, std::size_t offset = 0);
  /// Downloads into `column`, which must stay until `finish`.
  void read(const cl::Buffer& buffer, std::span<double> column);
  void read_bytes(const cl::Buffer& buffer, std::span<std::byte> bytes);
  /// Fills the first `bytes` of the buffer with zeros.
  void clear(const cl::Buffer& buffer, std::size_t bytes);
  /// What kernels write into a buffer of so many `bytes` of the host's memory (CL_MEM_USE_HOST_PTR) is there after
  /// `finish`.
  void show(const cl::Buffer& buffer, std::size_t bytes);
  /// Enough work-groups of `local`, or of the usual size, for `work_items`.
  void launch(const NamedKernel& kernel, std::size_t work_items, std::size_t local);
  void launch(const NamedKernel& kernel, std::size_t work_items) { launch(kernel, work_items, usual_group_size_); }
  void flush() { queue_.flush(); }

  /// Waits for everything; returns when the kernels since the last call ran.
  std::vector<Running> finish();

 private:
  cl::Context context_;
  cl::CommandQueue queue_;
  std::size_t usual_group_size_;
  std::vector<cl::Event> kernels_;
};

/// Both ends of a chunk's enclosures on their way to the host.
class EnclosureColumns {
 public:
  explicit EnclosureColumns(std::size_t capacity) : los_(capacity), his_(capacity) {}

  /// Downloads `size` enclosures; this must stay until the queue has finished.
  void read(ChunkQueue& queue, const std::array<cl::Buffer, 2>& ends, std::size_t size);
  /// Precondition: the queue has finished.
  void deliver(const Scale& scale, std::vector<Enclosure>& enclosures) const;

 private:
  std::vector<double> los_;
  std::vector<double> his_;
  std::size_t size_ = 0;
};

/// `buffer` cut into `count` windows of `length` numbers each. Precondition: `length` keeps them aligned for any
/// device.
[[nodiscard]] std::vector<cl::Buffer> windows(const cl::Buffer& buffer, std::size_t count, std::size_t length);

}  // namespace verisq::device
