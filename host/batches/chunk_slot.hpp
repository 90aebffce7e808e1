/// What chunks of all kinds of queries have in common on their way through a device.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "host/batches/chunk_queue.hpp"
#include "host/batches/device_model.hpp"
#include "verisq/certificate.hpp"

namespace verisq::device {

/// The base of the slots of a ChunkPipeline: a queue of its own, so that its transfers overlap with the other slot's
/// kernels; queries in whole vectors; their enclosures.
class ChunkSlot {
 public:
  /// Waits for the chunk; returns when kernels ran.
  std::vector<Running> finish(std::vector<Enclosure>& enclosures) {
    std::vector<Running> times = queue_.finish();
    enclosures_.deliver(scale_, enclosures);
    return times;
  }

  /// Nothing: slots with certificates hide it.
  void certify(std::span<const Enclosure> /*enclosures*/, std::vector<Certificate>& /*certificates*/) const {}

 protected:
  ChunkSlot(const Device& device, const DeviceModel& model)
      : width_(static_cast<std::size_t>(device.vector_width)),
        capacity_(model.chunk_size),
        count_(model.count),
        scale_(model.scale_exponent),
        queue_(device),
        enclosures_(capacity_) {}

  /// Vectors of `width` queries that hold all of the chunk.
  [[nodiscard]] std::size_t groups(std::size_t width) const { return (size_ + width - 1) / width; }
  [[nodiscard]] std::size_t groups() const { return groups(width_); }
  [[nodiscard]] std::size_t padded() const { return groups() * width_; }

  /// Sets column[n] = number(n) for each query; lanes beyond the last one repeat it.
  template <class Number>
  void fill(std::span<double> column, const Number& number) const {
    for (std::size_t n = 0; n < size_; ++n) column[n] = number(n);
    std::ranges::fill(column.subspan(size_, padded() - size_), column[size_ - 1]);
  }

  std::size_t width_;
  std::size_t capacity_;
  std::size_t count_;  // of primitives
  Scale scale_;
  ChunkQueue queue_;
  EnclosureColumns enclosures_;
  std::size_t size_ = 0;  // queries of the chunk
};

}  // namespace verisq::device
