/// Queries in, enclosures out, a chunk at a time, while the next chunk is prepared.
#pragma once

#include <fmt/format.h>

#include <deque>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/device/device.hpp"
#include "verisq/enclosure.hpp"
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

/// Two chunks in flight at most, so that device memory is bounded: `submit` starts work and returns, `collect` waits
/// for the oldest. A Slot holds the buffers of one chunk: start(queries), finish(enclosures) -> kernel seconds, and
/// certify(enclosures, certificates). All calls from one thread.
template <class Query, class Slot, class Certificates>
class ChunkPipeline {
 public:
  /// `capacity` is that of each of the two slots; `device` names it in errors.
  ChunkPipeline(std::string device, std::size_t capacity, std::vector<Slot> slots)
      : device_(std::move(device)), capacity_(capacity), slots_(std::move(slots)) {}

  /// OpenCL implementations put off the end of compilation and the allocation of buffers to the first launch: a chunk
  /// of copies of `query` in each slot makes them do it now.
  void warm_up(const Query& query) {
    const std::vector<Query> queries(capacity_, query);
    for (std::size_t slot = 0; slot < slots_.size(); ++slot) submit(queries);
    discard();
    seconds_ = 0.0;
  }

  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  [[nodiscard]] double device_seconds() const { return seconds_; }

  void submit(std::span<const Query> queries) {
    reporting_failures(device_, [&] { slots_[next_].start(queries); });
    in_flight_.push_back(next_);
    next_ = (next_ + 1) % slots_.size();
  }

  void collect(std::vector<Enclosure>& enclosures, Certificates& certificates) {
    Slot& oldest = slots_[in_flight_.front()];
    in_flight_.pop_front();
    seconds_ += reporting_failures(device_, [&] { return oldest.finish(enclosures); });
    certificates.clear();
    oldest.certify(enclosures, certificates);
  }

  void discard() {
    std::vector<Enclosure> enclosures;
    Certificates certificates;
    while (!in_flight_.empty()) collect(enclosures, certificates);
  }

 private:
  std::string device_;
  std::size_t capacity_;
  std::vector<Slot> slots_;
  std::deque<std::size_t> in_flight_;
  std::size_t next_ = 0;
  double seconds_ = 0.0;
};

}  // namespace verisq::device
