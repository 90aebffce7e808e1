/// Two slots of a device in turn, each with the buffers of one chunk.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/batches/batch.hpp"
#include "host/batches/busy_time.hpp"
#include "host/batches/device_model.hpp"
#include "host/batches/launch_pace.hpp"
#include "host/device/device.hpp"
#include "verisq/error.hpp"

namespace verisq::device {

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

/// A Slot holds the buffers of one chunk: start(queries), finish(enclosures) -> when kernels ran, and
/// certify(enclosures, certificates).
template <class Query, class Slot>
class ChunkPipeline final : public Batch<Query> {
 public:
  /// `capacity` is that of each of the slots; `device` names it in errors.
  ChunkPipeline(std::string device, std::size_t capacity, std::vector<Slot> slots)
      : device_(std::move(device)), pace_(capacity), slots_(std::move(slots)) {}

  /// A chunk of copies of `query` in each slot (see queries_of_warm_up). Buffers are there already: they were filled.
  void warm_up(const Query& query) {
    const std::vector<Query> queries(std::min(pace_.size(), queries_of_warm_up), query);
    for (std::size_t slot = 0; slot < slots_.size(); ++slot) submit(queries);
    discard();
    busy_ = {};
  }

  /// What a chunk is to hold now; it follows the time that chunks take.
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
