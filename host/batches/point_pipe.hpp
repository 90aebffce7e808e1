/// Points in, rows out, a chunk at a time, without work on the host for a point that the device has proven.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <verisq/columns.hpp>
#include <verisq/model.hpp>

#include "host/batches/row_sums.hpp"
#include "host/device/device.hpp"

namespace verisq::device {

/// The rows `first` ... `first + count - 1` of a chunk.
struct RowBlock {
  std::size_t first, count;
  RowSums sums;
};

/// What is known of a chunk without a look at its rows.
struct ChunkOutcome {
  bool refused;                      ///< a coordinate is not finite: the rows mean nothing
  std::span<const RowBlock> blocks;  ///< in order, until the next call
};

/// As Batch, but for how many chunks may be in flight: all calls from one thread; they throw Error(failure) with the
/// name of a failed OpenCL call.
class PointPipe {
 public:
  PointPipe() = default;
  virtual ~PointPipe() = default;
  PointPipe(const PointPipe&) = delete;
  PointPipe& operator=(const PointPipe&) = delete;

  /// Points that the next chunk may hold, and that any may.
  [[nodiscard]] virtual std::size_t capacity() const = 0;
  [[nodiscard]] virtual std::size_t largest_chunk() const { return capacity(); }

  /// Chunks that may be in flight: enough to keep all of it busy.
  [[nodiscard]] virtual std::size_t depth() const { return 2; }

  /// Precondition: at most `capacity()` points, at least one, and as many rows; both stay until the chunk is collected;
  /// fewer than `depth()` chunks in flight.
  virtual void submit(const PointColumns& points, const ResultColumns& rows) = 0;

  /// Waits for the oldest chunk in flight: its rows are written, those that are open as wide. Precondition: a chunk is
  /// in flight.
  virtual ChunkOutcome collect() = 0;

  /// Waits for whatever is in flight.
  virtual void discard() = 0;

  /// As that of Batch.
  [[nodiscard]] virtual double device_seconds() const = 0;
};

/// How the host's memory is reached: directly by devices that compute in it, or always by copies.
enum class MemoryAccess { of_device, by_copies };

/// Precondition: `model` is a union of convex primitives within_device_range.
[[nodiscard]] std::unique_ptr<PointPipe> point_pipe(const Device& device, const Model& model,
                                                    const RowCriterion& criterion,
                                                    MemoryAccess access = MemoryAccess::of_device);

}  // namespace verisq::device
