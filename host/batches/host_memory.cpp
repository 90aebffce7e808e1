/// This file implements both ways of kernels to the host's memory.
#include "host/batches/host_memory.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace verisq::device {
namespace {

// Where a column's values lie.
struct Extent {
  std::uintptr_t first;
  std::uintptr_t end;
};

template <class Value>
Extent extent_of(const Column<Value>& column, std::size_t size) {
  const Value* const one = &column[0];
  const Value* const other = &column[size - 1];
  return {reinterpret_cast<std::uintptr_t>(std::min(one, other)),
          reinterpret_cast<std::uintptr_t>(std::max(one, other) + 1)};
}

// Whole numbers, so that offsets of numbers are.
Extent aligned(const Extent& extent) {
  constexpr std::uintptr_t alignment = sizeof(double);
  return {extent.first / alignment * alignment, (extent.end + alignment - 1) / alignment * alignment};
}

std::size_t bytes(const Extent& extent) {
  return extent.end - extent.first;
}

// Those that overlap in one: buffers must not share memory.
std::vector<Extent> united(std::vector<Extent> all) {
  std::ranges::sort(all, {}, &Extent::first);
  std::vector<Extent> apart;
  for (const Extent& next : all) {
    if (!apart.empty() && next.first < apart.back().end)
      apart.back().end = std::max(apart.back().end, next.end);
    else
      apart.push_back(next);
  }
  return apart;
}

class SharedMemory final : public HostMemory {
 public:
  explicit SharedMemory(const Device& device) : context_(device.context) {}

  BoundChunk bind(ChunkQueue& /*queue*/, const PointColumns& points, const ResultColumns& rows) override {
    const std::size_t size = points.size();
    const auto& [x, y, z] = points.coordinates();
    extents_ = united({aligned(extent_of(x, size)), aligned(extent_of(y, size)), aligned(extent_of(z, size)),
                       aligned(extent_of(rows.lo(), size)), aligned(extent_of(rows.hi(), size)),
                       aligned(extent_of(rows.status(), size))});
    results_ = {index_of(rows.lo().first), index_of(rows.hi().first), index_of(rows.status().first)};
    buffers_.clear();
    for (std::size_t i = 0; i < extents_.size(); ++i) {
      const cl_mem_flags access =
          std::ranges::find(results_, i) == results_.end() ? CL_MEM_READ_ONLY : CL_MEM_READ_WRITE;
      buffers_.emplace_back(context_, access | CL_MEM_USE_HOST_PTR, bytes(extents_[i]),
                            reinterpret_cast<void*>(extents_[i].first));
    }
    return {{bound(x), bound(y), bound(z)}, {bound(rows.lo()), bound(rows.hi())}, bound(rows.status())};
  }

  void fetch(ChunkQueue& queue) override {
    std::ranges::sort(results_);
    const auto end = std::ranges::unique(results_).begin();
    for (auto index = results_.begin(); index != end; ++index) queue.show(buffers_[*index], bytes(extents_[*index]));
  }

  void deliver() override {}

 private:
  [[nodiscard]] std::size_t index_of(const void* value) const {
    const auto at = reinterpret_cast<std::uintptr_t>(value);
    const auto beyond = std::ranges::upper_bound(extents_, at, {}, &Extent::first);
    return static_cast<std::size_t>(beyond - extents_.begin()) - 1;
  }

  template <class Value>
  [[nodiscard]] BoundColumn bound(const Column<Value>& column) const {
    const std::size_t index = index_of(column.first);
    const std::uintptr_t offset = reinterpret_cast<std::uintptr_t>(column.first) - extents_[index].first;
    return {buffers_[index], offset / sizeof(Value), static_cast<std::uint64_t>(column.stride)};
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

// A column of results on its way: directly where the caller's values follow each other.
template <class Value>
class CopiedColumn {
 public:
  CopiedColumn(const Device& device, std::size_t capacity)
      : buffer_(device.context, CL_MEM_READ_WRITE, capacity * sizeof(Value)), pinned_(device, capacity) {}

  [[nodiscard]] BoundColumn bind(const Column<Value>& column, std::size_t size) {
    column_ = column;
    size_ = size;
    return {buffer_, 0, 1};
  }
  void fetch(ChunkQueue& queue) {
    Value* const to = column_.stride == 1 ? column_.first : pinned_.values();
    queue.read_bytes(buffer_, std::as_writable_bytes(std::span(to, size_)));
  }
  void deliver() const {
    if (column_.stride == 1) return;
    for (std::size_t n = 0; n < size_; ++n) column_[n] = pinned_.values()[n];
  }

 private:
  cl::Buffer buffer_;
  PinnedColumn<Value> pinned_;
  Column<Value> column_;
  std::size_t size_ = 0;
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
    const std::size_t size = points.size();
    return {upload(queue, points),
            {lo_.bind(rows.lo(), size), hi_.bind(rows.hi(), size)},
            status_.bind(rows.status(), size)};
  }

  void fetch(ChunkQueue& queue) override {
    lo_.fetch(queue);
    hi_.fetch(queue);
    status_.fetch(queue);
  }

  void deliver() override {
    lo_.deliver();
    hi_.deliver();
    status_.deliver();
  }

 private:
  [[nodiscard]] std::array<BoundColumn, 3> upload(ChunkQueue& queue, const PointColumns& points) const {
    const auto& [x, y, z] = points.coordinates();
    if (x.stride == 1 && y.stride == 1 && z.stride == 1) {
      std::uint64_t offset = 0;
      for (const Column<const double>& column : points.coordinates()) {
        queue.write(points_, {column.first, points.size()}, offset);
        offset += capacity_;
      }
      return {{{points_, 0, 1}, {points_, capacity_, 1}, {points_, 2 * capacity_, 1}}};
    }
    const bool as_they_are =
        x.stride == 3 && y.stride == 3 && z.stride == 3 && y.first == x.first + 1 && z.first == x.first + 2;
    if (!as_they_are) {
      double* to = pinned_.values();
      for (std::size_t n = 0; n < points.size(); ++n) to = std::ranges::copy(points[n], to).out;
    }
    queue.write(points_, {as_they_are ? x.first : pinned_.values(), 3 * points.size()});
    return {{{points_, 0, 3}, {points_, 1, 3}, {points_, 2, 3}}};
  }

  std::size_t capacity_;
  cl::Buffer points_;
  PinnedColumn<double> pinned_;
  CopiedColumn<double> lo_;
  CopiedColumn<double> hi_;
  CopiedColumn<Status> status_;
};

}  // namespace

std::unique_ptr<HostMemory> shared_memory(const Device& device) {
  return std::make_unique<SharedMemory>(device);
}

std::unique_ptr<HostMemory> copied_memory(const Device& device, ChunkQueue& queue, std::size_t capacity) {
  return std::make_unique<CopiedMemory>(device, queue, capacity);
}

}  // namespace verisq::device
