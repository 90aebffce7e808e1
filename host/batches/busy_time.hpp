/// How long a device was busy with kernels that may overlap.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace verisq::device {

/// When a kernel ran, in nanoseconds of the device's clock.
struct Running {
  std::uint64_t start, end;
};

/// How long kernels that ran one after the other took.
[[nodiscard]] double seconds_of(std::span<const Running> kernels);

/// The time during which at least one kernel ran: queues of one device work at the same time, and moments that they
/// share count once. Never more than the time by the clock.
class BusyTime {
 public:
  /// The kernels of one more chunk, in any order. Precondition: they started after all of the chunk before the last one
  /// had ended, as with two chunks in flight; memory stays bounded.
  void add(std::span<const Running> chunk);

  [[nodiscard]] double seconds() const;

 private:
  std::uint64_t settled_ = 0;   // nanoseconds: no later chunk overlaps with them
  std::vector<Running> open_;   // apart from each other, in order
  std::uint64_t last_end_ = 0;  // of the last chunk
};

}  // namespace verisq::device
