/// Queries in, enclosures out, a chunk at a time: two slots of a device in turn.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <deque>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/device/chunk_queue.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "verisq/checker.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq::device {

// Queries in, enclosures out, a chunk at a time, while the next chunk is prepared.

/// Two chunks in flight at most: `submit` starts work and returns, `collect` waits for the oldest. Device memory is
/// bounded by two chunks. All calls from one thread; they throw Error(failure) with the name of a failed OpenCL call.
template <class Query>
class Batch {
 public:
  Batch() = default;
  virtual ~Batch() = default;
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;

  /// Queries a chunk may hold.
  [[nodiscard]] virtual std::size_t capacity() const = 0;

  /// Precondition: at most `capacity()` queries of finite numbers; fewer than two chunks in flight.
  virtual void submit(std::span<const Query> queries) = 0;

  /// Fills `enclosures` with those of the oldest chunk in flight, in the order of its queries; an end is infinite if
  /// nothing was proven. Fills `certificates`, too, if they were requested. Precondition: a chunk is in flight.
  virtual void collect(std::vector<Enclosure>& enclosures, std::vector<Certificate>& certificates) = 0;

  /// Waits for all chunks in flight and drops them.
  virtual void discard() = 0;

  /// The time during which kernels of the collected chunks ran; time shared by two of them counts once.
  [[nodiscard]] virtual double device_seconds() const = 0;
};

// The common part of all kinds of queries' chunks on their way through a device.

/// The base of the slots of a ChunkPipeline: a queue of its own, so that its transfers overlap with the other slot's
/// kernels; queries in whole vectors; their enclosures.
class ChunkSlot {
 public:
  /// Waits for the chunk; returns the times when kernels ran.
  std::vector<Running> finish(std::vector<Enclosure>& enclosures) {
    std::vector<Running> times = queue_.finish();
    enclosures_.deliver(scale_, enclosures);
    return times;
  }

  /// Does nothing: slots with certificates hide it.
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

// Two slots of a device in turn, each with the buffers of one chunk.

/// Runs `work` and turns an error of OpenCL into Error(failure) that names the device and the call.
template <class Work>
auto reporting_failures(const std::string& device, const Work& work) {
  try {
    return work();
  } catch (const cl::Error& error) {
    throw Error(ErrorKind::failure,
                fmt::format("{}: {} failed with OpenCL error {}", device, error.what(), error.err()));
  }
}

/// A Slot has the buffers of one chunk: start(queries), finish(enclosures) -> the times when kernels ran, and
/// certify(enclosures, certificates).
template <class Query, class Slot>
class ChunkPipeline final : public Batch<Query> {
 public:
  /// `capacity` is that of each slot; `device` names the device in errors.
  ChunkPipeline(std::string device, std::size_t capacity, std::vector<Slot> slots)
      : device_(std::move(device)), pace_(capacity), slots_(std::move(slots)) {}

  /// A chunk of copies of `query` in each slot (see queries_of_warm_up). Buffers are there already: they were filled.
  void warm_up(const Query& query) {
    const std::vector<Query> queries(std::min(pace_.size(), queries_of_warm_up), query);
    for (std::size_t slot = 0; slot < slots_.size(); ++slot) submit(queries);
    discard();
    busy_ = {};
  }

  /// The present capacity of a chunk; it follows the time that chunks take.
  [[nodiscard]] std::size_t capacity() const override { return pace_.size(); }
  [[nodiscard]] double device_seconds() const override { return busy_.seconds(); }

  void submit(std::span<const Query> queries) override {
    reporting_failures(device_, [&] { slots_[next_].start(queries); });
    in_flight_.push_back(next_);
    next_ = (next_ + 1) % slots_.size();
  }

  void collect(std::vector<Enclosure>& enclosures, std::vector<Certificate>& certificates) override {
    Slot& oldest = slots_[in_flight_.front()];
    in_flight_.pop_front();
    const std::vector<Running> kernels = reporting_failures(device_, [&] { return oldest.finish(enclosures); });
    busy_.add(kernels);
    pace_.took(enclosures.size(), seconds_of(kernels));
    certificates.clear();
    oldest.certify(enclosures, certificates);
  }

  void discard() override {
    std::vector<Enclosure> enclosures;
    std::vector<Certificate> certificates;
    while (!in_flight_.empty()) collect(enclosures, certificates);
  }

 private:
  std::string device_;
  LaunchPace pace_;
  std::vector<Slot> slots_;
  std::deque<std::size_t> in_flight_;
  std::size_t next_ = 0;
  BusyTime busy_;
};

}  // namespace verisq::device
