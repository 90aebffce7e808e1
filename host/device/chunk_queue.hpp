/// Chunks of queries in turn: how much a device is given at a time, how long it was busy, and the queues.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/device/device.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::device {

// The amount of work given to a device at a time, and the time during which it was busy.

// The time during which a device was busy with kernels that may overlap.

/// The time when a kernel ran, in nanoseconds of the device's clock.
struct Running {
  std::uint64_t start, end;
};

/// The total time of kernels that ran one after the other.
[[nodiscard]] double seconds_of(std::span<const Running> kernels);

/// The time during which at least one kernel ran. Queues of one device work at the same time, and time that they share
/// counts once. Never more than the time by the clock.
class BusyTime {
 public:
  /// Adds the kernels of one more chunk, in any order. Precondition: they started after all kernels of the chunk before
  /// the last one had ended, as with two chunks in flight. So memory stays bounded.
  void add(std::span<const Running> chunk);

  [[nodiscard]] double seconds() const;

 private:
  std::uint64_t settled_ = 0;   // nanoseconds: no later chunk overlaps with them
  std::vector<Running> open_;   // apart from each other, in order
  std::uint64_t last_end_ = 0;  // of the last chunk
};

// The amount of work given to a device at a time: no more than it does within a tenth of a second.

/// A graphics processor cannot be interrupted, and one that drives a display is reset when a launch takes seconds. The
/// fastest and the slowest are a thousand times apart. So work begins with little and grows as long as chunks finish
/// soon. Sizes are whole vectors of queries, and so many that a device has work for all its processors.
class LaunchPace {
 public:
  /// `largest` is the capacity of the buffers.
  explicit LaunchPace(std::size_t largest, std::size_t first = usual_first)
      : largest_(largest), size_(std::min(largest, first)) {}

  [[nodiscard]] std::size_t size() const { return size_; }

  /// Must be called with the time that the kernels of each chunk ran.
  void took(std::size_t queries, double seconds) {
    if (seconds > longest_seconds) size_ = std::min(size_, std::max(whole(queries / 2), std::min(largest_, smallest)));
    if (seconds < shortest_seconds && queries >= size_) size_ = std::min(2 * size_, largest_);
  }

 private:
  static constexpr std::size_t usual_first = std::size_t{1} << 14U;
  static constexpr std::size_t smallest = std::size_t{1} << 10U;
  static constexpr double shortest_seconds = 0.04;
  static constexpr double longest_seconds = 0.1;

  static std::size_t whole(std::size_t queries) { return queries - queries % smallest; }

  std::size_t largest_;
  std::size_t size_;
};

// One chunk's way through a device: uploads, kernels, downloads, in order, beside those of other chunks.

/// Work-items of a work-group: every kernel's group size unless it states another. On graphics processors it is a
/// multiple of the number that executes together: 64 work-items on AMD's, 32 on others.
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
  [[nodiscard]] double to_model(double x) const { return x / factor_; }  ///< for numbers that prove nothing
  /// Rounded outward where it underflows or overflows.
  [[nodiscard]] Enclosure to_model(const Enclosure& e) const;
  /// The same for all of them: by one multiplication for each end if that is exact, as it is but for extremes.
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
  /// After `finish`, the host's memory contains everything that kernels wrote into a buffer of `bytes` bytes there
  /// (CL_MEM_USE_HOST_PTR).
  void show(const cl::Buffer& buffer, std::size_t bytes);
  /// Launches enough work-groups of `local`, or of the usual size, for `work_items`.
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
