/// This file implements both ways of kernels to the host's memory.
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "host/device/point_pipe.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::device {
namespace {

static_assert(sizeof(MapResult) % sizeof(double) == 0, "the stride of its ends is a whole one");

// The memory of a column's values.
struct Extent {
  const std::byte* first;
  std::size_t bytes;
  bool has_numbers;

  [[nodiscard]] const std::byte* end() const { return first + bytes; }
};

template <class Value>
Extent extent_of(const Column<Value>& column, std::size_t size) {
  const Value* const one = &column[0];
  const Value* const other = &column[size - 1];
  const auto* const first = reinterpret_cast<const std::byte*>(std::min(one, other));
  const auto* const end = reinterpret_cast<const std::byte*>(std::max(one, other) + 1);
  return {first, static_cast<std::size_t>(end - first), std::same_as<std::remove_const_t<Value>, double>};
}

// If there are numbers, the extent starts at a whole number, so that their offsets are whole.
Extent aligned(const Extent& extent) {
  const std::size_t beyond = extent.has_numbers ? reinterpret_cast<std::uintptr_t>(extent.first) % sizeof(double) : 0;
  return {extent.first - beyond, extent.bytes + beyond, extent.has_numbers};
}

// Unites overlapping extents: buffers must not share memory.
std::vector<Extent> united(std::vector<Extent> all) {
  std::ranges::sort(all, {}, &Extent::first);
  std::vector<Extent> apart;
  for (const Extent& next : all) {
    if (apart.empty() || next.first >= apart.back().end()) {
      apart.push_back(next);
      continue;
    }
    Extent& last = apart.back();
    last.bytes = static_cast<std::size_t>(std::max(last.end(), next.end()) - last.first);
    last.has_numbers = last.has_numbers || next.has_numbers;
  }
  std::ranges::transform(apart, apart.begin(), aligned);
  return apart;
}

class SharedMemory final : public HostMemory {
 public:
  explicit SharedMemory(const Device& device) : context_(device.context) {}

  BoundChunk bind(ChunkQueue& /*queue*/, const PointColumns& points, const ResultColumns& rows) override {
    const std::size_t size = points.size();
    const auto& [x, y, z] = points.coordinates();
    extents_ = united({extent_of(x, size), extent_of(y, size), extent_of(z, size), extent_of(rows.lo(), size),
                       extent_of(rows.hi(), size), extent_of(rows.status(), size)});
    results_ = {index_of(rows.lo().first), index_of(rows.hi().first), index_of(rows.status().first)};
    buffers_.clear();
    for (std::size_t i = 0; i < extents_.size(); ++i) {
      const cl_mem_flags access = takes_results(i) ? CL_MEM_READ_WRITE : CL_MEM_READ_ONLY;
      // OpenCL requires a pointer that may write also for memory that is only read.
      auto* const memory = const_cast<std::byte*>(extents_[i].first);  // NOLINT(cppcoreguidelines-pro-type-const-cast)
      buffers_.emplace_back(context_, access | CL_MEM_USE_HOST_PTR, extents_[i].bytes, memory);
    }
    return {{bound(x), bound(y), bound(z)}, {bound(rows.lo()), bound(rows.hi())}, bound(rows.status())};
  }

  void fetch(ChunkQueue& queue) override {
    for (std::size_t i = 0; i < buffers_.size(); ++i)
      if (takes_results(i)) queue.show(buffers_[i], extents_[i].bytes);
  }

  void deliver() override {}

  void release() override {
    buffers_.clear();
    extents_.clear();
  }

 private:
  [[nodiscard]] std::size_t index_of(const void* value) const {
    const auto beyond =
        std::ranges::upper_bound(extents_, static_cast<const std::byte*>(value), std::ranges::less(), &Extent::first);
    return static_cast<std::size_t>(beyond - extents_.begin()) - 1;
  }

  [[nodiscard]] bool takes_results(std::size_t index) const {
    return std::ranges::find(results_, index) != results_.end();
  }

  template <class Value>
  [[nodiscard]] BoundColumn bound(const Column<Value>& column) const {
    const std::size_t index = index_of(column.first);
    const auto offset = reinterpret_cast<const std::byte*>(column.first) - extents_[index].first;
    return {buffers_[index], static_cast<std::size_t>(offset) / sizeof(Value),
            static_cast<std::uint64_t>(column.stride)};
  }

  cl::Context context_;
  std::vector<Extent> extents_;  // of the chunk, in order
  std::vector<cl::Buffer> buffers_;
  std::array<std::size_t, 3> results_{};  // buffers that rows go to
};

// Memory of the host that a device reads and writes by itself.
template <class Value>
class PinnedColumn {
 public:
  PinnedColumn(const Device& device, std::size_t size)
      : queue_(device.context, device.device),
        buffer_(device.context, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, size * sizeof(Value)),
        values_(static_cast<Value*>(
            queue_.enqueueMapBuffer(buffer_, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, size * sizeof(Value)))) {}
  ~PinnedColumn() { clEnqueueUnmapMemObject(queue_(), buffer_(), values_, 0, nullptr, nullptr); }
  PinnedColumn(const PinnedColumn&) = delete;
  PinnedColumn& operator=(const PinnedColumn&) = delete;

  [[nodiscard]] Value* values() const { return values_; }

 private:
  cl::CommandQueue queue_;
  cl::Buffer buffer_;
  Value* values_;
};

// A piece of a chunk is long enough to be worth a thread of its own.
constexpr std::size_t smallest_piece = std::size_t{1} << 15U;

/// work(first, count) of pieces of the chunk's `size` points, on all processors: one alone copies several times slower
/// than a graphics processor is fed.
template <class Work>
void in_pieces(std::size_t size, const Work& work) {
  const std::vector<Piece> pieces = pieces_of(size, smallest_piece);
  in_parallel(pieces.size(), [&](std::size_t k) { work(pieces[k].first, pieces[k].count); });
}

// A column of results on its way.
template <class Value>
class CopiedColumn {
 public:
  CopiedColumn(const Device& device, std::size_t capacity)
      : buffer_(device.context, CL_MEM_READ_WRITE, capacity * sizeof(Value)), pinned_(device, capacity) {}

  [[nodiscard]] BoundColumn bind(const Column<Value>& column) {
    column_ = column;
    return {buffer_, 0, 1};
  }
  void fetch(ChunkQueue& queue, std::size_t size) {
    queue.read_bytes(buffer_, std::as_writable_bytes(std::span(pinned_.values(), size)));
  }
  void deliver(std::size_t first, std::size_t count) const {
    const Value* const from = pinned_.values() + first;
    const Column<Value> to = column_.from(first);
    if (to.stride == 1)
      std::copy_n(from, count, to.first);
    else
      for (std::size_t n = 0; n < count; ++n) to[n] = from[n];
  }

 private:
  cl::Buffer buffer_;
  PinnedColumn<Value> pinned_;
  Column<Value> column_;
};

class CopiedMemory final : public HostMemory {
 public:
  CopiedMemory(const Device& device, ChunkQueue& queue, std::size_t capacity)
      : capacity_(capacity),
        points_(queue.numbers(3 * capacity)),
        pinned_(device, 3 * capacity),
        lo_(device, capacity),
        hi_(device, capacity),
        status_(device, capacity) {}

  BoundChunk bind(ChunkQueue& queue, const PointColumns& points, const ResultColumns& rows) override {
    size_ = points.size();
    return {upload(queue, points), {lo_.bind(rows.lo()), hi_.bind(rows.hi())}, status_.bind(rows.status())};
  }

  void fetch(ChunkQueue& queue) override {
    lo_.fetch(queue, size_);
    hi_.fetch(queue, size_);
    status_.fetch(queue, size_);
  }

  void deliver() override {
    in_pieces(size_, [&](std::size_t first, std::size_t count) {
      lo_.deliver(first, count);
      hi_.deliver(first, count);
      status_.deliver(first, count);
    });
  }

  void release() override { size_ = 0; }

 private:
  [[nodiscard]] std::array<BoundColumn, 3> upload(ChunkQueue& queue, const PointColumns& points) const {
    in_pieces(size_, [&](std::size_t first, std::size_t count) {
      for (std::size_t axis = 0; axis < 3; ++axis) gather(points.coordinates()[axis].from(first), count, axis, first);
    });
    for (std::size_t axis = 0; axis < 3; ++axis)
      queue.write(points_, {pinned_.values() + axis * capacity_, size_}, axis * capacity_);
    return {{{points_, 0, 1}, {points_, capacity_, 1}, {points_, 2 * capacity_, 1}}};
  }

  void gather(const Column<const double>& from, std::size_t count, std::size_t axis, std::size_t first) const {
    double* const to = pinned_.values() + axis * capacity_ + first;
    for (std::size_t n = 0; n < count; ++n) to[n] = from[n];
  }

  std::size_t capacity_;
  cl::Buffer points_;
  PinnedColumn<double> pinned_;  // as `points_`: all x, all y, all z
  CopiedColumn<double> lo_;
  CopiedColumn<double> hi_;
  CopiedColumn<Status> status_;
  std::size_t size_ = 0;  // of the chunk
};

}  // namespace

bool shares_memory(const Device& device) {
  return (device.device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0;
}

std::unique_ptr<HostMemory> shared_memory(const Device& device) {
  return std::make_unique<SharedMemory>(device);
}

std::unique_ptr<HostMemory> copied_memory(const Device& device, ChunkQueue& queue, std::size_t capacity) {
  return std::make_unique<CopiedMemory>(device, queue, capacity);
}

}  // namespace verisq::device
