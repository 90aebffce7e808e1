/// The access of kernels to the host's memory: points wherever their coordinates are, rows wherever they go.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <verisq/map.hpp>

#include "host/device/chunk_queue.hpp"
#include "host/device/device.hpp"

namespace verisq::device {

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

}  // namespace verisq::device
