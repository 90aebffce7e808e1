/// Points in, rows out, a chunk at a time, by one device or several; and the kernels that make rows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>
#include <verisq/map.hpp>
#include <verisq/model.hpp>

#include "host/device/chunk_queue.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "host/device/query_batches.hpp"

namespace verisq::device {

// The access of kernels to the host's memory: points wherever their coordinates are, rows wherever they go.

/// A column as kernels see it: value n is buffer[offset + n * stride], in sums that wrap.
struct BoundColumn {
  cl::Buffer buffer;
  std::uint64_t offset;
  std::uint64_t stride;
};

struct BoundChunk {
  std::array<BoundColumn, 3> coordinates;
  std::array<BoundColumn, 2> ends;
  BoundColumn status;
};

/// One chunk at a time: `bind`, kernels, `fetch`, the queue's finish, `deliver`; all on one queue.
class HostMemory {
 public:
  HostMemory() = default;
  virtual ~HostMemory() = default;
  HostMemory(const HostMemory&) = delete;
  HostMemory& operator=(const HostMemory&) = delete;

  /// Precondition: as many rows as points, at least one; they stay until `deliver`.
  [[nodiscard]] virtual BoundChunk bind(ChunkQueue& queue, const PointColumns& points, const ResultColumns& rows) = 0;
  virtual void fetch(ChunkQueue& queue) = 0;
  virtual void deliver() = 0;
  /// Lets go of the caller's memory: after `deliver`, or when anything failed.
  virtual void release() = 0;
};

/// True for a device that computes in the host's memory.
[[nodiscard]] bool shares_memory(const Device& device);

/// The memory itself: of a device that computes in it, where nothing is copied.
[[nodiscard]] std::unique_ptr<HostMemory> shared_memory(const Device& device);

/// Buffers of the device and copies, for chunks of at most `capacity` points. They pass through memory of the host that
/// the device itself copies from and to, at the speed of its bus and beside its kernels. Drivers copy from other memory
/// four times slower (measured on an H100, PCIe 5: 53 and 14 GB/s), and wait meanwhile.
[[nodiscard]] std::unique_ptr<HostMemory> copied_memory(const Device& device, ChunkQueue& queue, std::size_t capacity);

// Kernels that turn a chunk's points into rows: at once, or step by step.

// A device's sums over rows: the accounting of a summary.

/// Declared as in kernels/row_verdict.clh. Open rows are in no other sum; `open_inside` counts those of them that are
/// not proven outside.
struct RowSums {
  double minimum_lo, minimum_hi, largest_width;
  std::uint32_t verified, wide, wide_inside, open, open_inside;
};
static_assert(sizeof(RowSums) == 48);

/// The requirement on a row, in model units: at most `tolerance` wide. With a tolerance of 0: as tight as the methods
/// get. That is `inside` if its lower end is below 0, else `outside` times the larger of `radius` and the point's
/// largest coordinate. A row as tight as that, but wider than the tolerance, is wide for good. All others are open.
struct RowCriterion {
  double tolerance, inside, outside, radius;
};

// The inputs and outputs of every kernel that turns a chunk's points into rows.

/// Rows of one work-group, the largest number that the host must read to look at open rows.
inline constexpr std::size_t rows_of_block = 1024;

[[nodiscard]] constexpr std::size_t blocks_of(std::size_t size) {
  return (size + rows_of_block - 1) / rows_of_block;
}

/// The division of a chunk among work-items: on a vector's device one of them takes a block, on a graphics processor a
/// group of neighbours does.
struct RowGroups {
  explicit RowGroups(const Device& device)
      : width(static_cast<std::size_t>(device.vector_width)), group_size(width > 1 ? 1 : scalar_group_size) {}

  static constexpr std::size_t scalar_group_size = 64;

  std::size_t width;       ///< points of a vector
  std::size_t group_size;  ///< work-items that share a block

  [[nodiscard]] std::size_t vectors_of_item() const { return rows_of_block / width / group_size; }
  [[nodiscard]] std::size_t vectors_of(std::size_t size) const { return (size + width - 1) / width; }
};

/// Sums of a chunk's blocks, and a flag for a refused coordinate: in the device's memory and in the host's.
class RowTotals {
 public:
  RowTotals(const Device& device, ChunkQueue& queue, std::size_t capacity);

  void bind(NamedKernel& rows, const RowGroups& groups) const;
  void bind_refusal(NamedKernel& kernel) const { kernel.set("refused", refused_); }
  /// After the kernels; this must stay until the queue has finished.
  void fetch(ChunkQueue& queue, std::size_t size);
  /// Precondition: fetched, and the queue has finished.
  [[nodiscard]] const std::vector<RowSums>& of_blocks() const { return of_blocks_; }
  [[nodiscard]] bool refused() const { return is_refused_ != 0; }
  /// Resets the flag for the next chunk. Precondition: the queue has finished.
  void forget_refusal(ChunkQueue& queue);

 private:
  // Kernels do not keep the buffers that they are given.
  cl::Buffer refused_;
  cl::Buffer sums_;
  std::vector<RowSums> of_blocks_;
  cl_uint is_refused_ = 0;
};

void bind_points(NamedKernel& kernel, const BoundChunk& chunk);
void bind_rows(NamedKernel& kernel, const BoundChunk& chunk);
void bind_criterion(NamedKernel& kernel, const Scale& scale, const RowCriterion& criterion);

// Rows of a chunk by one kernel, with nothing in between: of a single convex primitive, without depths.

/// Compiles kernels/point_map.cl. Precondition: `model` has one primitive. Throws RefusedDevice where it errs on
/// samples.
[[nodiscard]] cl::Program point_map_program(const Device& device, const DeviceModel& model);

/// The kernel point_map.
class RowsAtOnce {
 public:
  /// `program` is `point_map_program`. `totals` must outlive this.
  RowsAtOnce(const Device& device, const cl::Program& program, const DeviceModel& model, const RowCriterion& criterion,
             const RowTotals& totals);

  /// The rows of RowsInSteps without depths, bit for bit. Precondition: `size` points, as many as the chunk that is
  /// bound.
  void enqueue(ChunkQueue& queue, const BoundChunk& chunk, std::size_t size);

 private:
  RowGroups groups_;
  cl::Buffer primitives_;  // kernels do not keep the buffers that they are given
  NamedKernel point_map_;
};

// Rows of a chunk kernel by kernel, with columns in between: of any union of convex primitives, with depths.

/// The kernels point_columns, those of PointKernels, and point_rows.
class RowsInSteps {
 public:
  /// `programs` are `point_programs`. `totals` must outlive this.
  RowsInSteps(const Device& device, const PointPrograms& programs, const DeviceModel& model, ChunkQueue& queue,
              const RowCriterion& criterion, const RowTotals& totals);

  /// `searched`: with depths, too; otherwise the distances of points inside are unknown, which their rows state.
  /// Preconditions: `size` points, as many as the bound chunk has.
  void enqueue(ChunkQueue& queue, const BoundChunk& chunk, std::size_t size, bool searched);
  /// After the former without depths, and while the chunk is bound: processes all of it again with them.
  void enqueue_depths(ChunkQueue& queue, std::size_t size);

 private:
  void enqueue_rows(ChunkQueue& queue, std::size_t size);
  // A graphics processor's work-item takes one point, next to those of its neighbours.
  [[nodiscard]] std::size_t vectors_of_columns() const {
    return groups_.group_size == 1 ? groups_.vectors_of_item() : 1;
  }

  RowGroups groups_;
  Scale scale_;
  PointKernels kernels_;
  NamedKernel point_columns_;
  NamedKernel point_rows_;
};

// Points in, rows out, a chunk at a time, by one device or several.

// Points in, rows out, a chunk at a time, without work on the host for a point that the device has proven.

/// The rows `first` ... `first + count - 1` of a chunk.
struct RowBlock {
  std::size_t first, count;
  RowSums sums;
};

/// The known results of a chunk without a look at its rows.
struct ChunkOutcome {
  bool refused;                      ///< a coordinate is not finite: the rows are meaningless
  std::span<const RowBlock> blocks;  ///< in order, until the next call
};

/// Like Batch, but with another number of chunks in flight. All calls must come from one thread; they throw
/// Error(failure) with the name of a failed OpenCL call.
class PointPipe {
 public:
  PointPipe() = default;
  virtual ~PointPipe() = default;
  PointPipe(const PointPipe&) = delete;
  PointPipe& operator=(const PointPipe&) = delete;

  /// Points that the next chunk may hold, and that any may.
  [[nodiscard]] virtual std::size_t capacity() const = 0;
  [[nodiscard]] virtual std::size_t largest_chunk() const { return capacity(); }

  /// The number of chunks that may be in flight: enough to keep the whole device busy.
  [[nodiscard]] virtual std::size_t depth() const { return 2; }

  /// Precondition: at most `capacity()` points, at least one, and as many rows; both stay until the chunk is collected;
  /// fewer than `depth()` chunks in flight.
  virtual void submit(const PointColumns& points, const ResultColumns& rows) = 0;

  /// Waits for the oldest chunk in flight: its rows are written, open ones as wide. Precondition: a chunk is in flight.
  virtual ChunkOutcome collect() = 0;

  /// Waits for all chunks in flight.
  virtual void discard() = 0;

  /// Like `device_seconds` of Batch.
  [[nodiscard]] virtual double device_seconds() const = 0;
};

/// The access to the host's memory: direct for devices that compute in it, or always by copies.
enum class MemoryAccess { of_device, by_copies };

/// Precondition: `model` is a union of convex primitives within_device_range.
[[nodiscard]] std::unique_ptr<PointPipe> point_pipe(const Device& device, const Model& model,
                                                    const RowCriterion& criterion,
                                                    MemoryAccess access = MemoryAccess::of_device);

// The pipes of several devices as one: they take chunks in turn, with sizes in proportion to their speeds.

/// Rows are those of the device that got their chunk; if devices are alike, they equal those of one device.
/// Precondition: at least one pipe.
[[nodiscard]] std::unique_ptr<PointPipe> several_pipes(std::vector<std::unique_ptr<PointPipe>> pipes);

}  // namespace verisq::device
