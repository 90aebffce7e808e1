/// Queries in, enclosures out, a chunk at a time, while the next chunk is prepared.
#pragma once

#include <span>
#include <vector>

#include "verisq/certificate.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::device {

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

  /// Fills `enclosures` with those of the oldest chunk in flight, in the order of its queries; an end is infinite where
  /// nothing was proven; `certificates` too, where they were asked for. Precondition: a chunk is in flight.
  virtual void collect(std::vector<Enclosure>& enclosures, std::vector<Certificate>& certificates) = 0;

  /// Waits for whatever is in flight and drops it.
  virtual void discard() = 0;

  /// The time during which kernels of the chunks collected ran; what two of them share counts once.
  [[nodiscard]] virtual double device_seconds() const = 0;
};

}  // namespace verisq::device
