/// Triangles in, enclosures of their distances out, a chunk at a time, while the next chunk is prepared.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "host/device/device.hpp"
#include "verisq/certificate.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"

namespace verisq::device {

/// Two chunks in flight at most: `submit` starts work and returns, `collect` waits for the oldest. Device memory is
/// bounded by two chunks. All calls from one thread.
class TriangleBatch {
 public:
  using Query = Triangle;

  /// `certificates` as in MapOptions. Throws Error(failure) with the name of a failed OpenCL call.
  TriangleBatch(const Device& device, const Model& model, bool certificates);
  ~TriangleBatch();
  TriangleBatch(const TriangleBatch&) = delete;
  TriangleBatch& operator=(const TriangleBatch&) = delete;

  /// Triangles a chunk may hold.
  [[nodiscard]] std::size_t capacity() const;

  /// Precondition: at most `capacity()` triangles with finite corners; fewer than two chunks in flight.
  void submit(std::span<const Triangle> triangles);

  /// Fills `enclosures` with those of the oldest chunk in flight, in the order of its triangles; an end is infinite
  /// where nothing was proven; `certificates` too, where they were asked for. Precondition: a chunk is in flight.
  void collect(std::vector<Enclosure>& enclosures, std::vector<Certificate>& certificates);

  /// Waits for whatever is in flight and drops it.
  void discard();

  /// Kernel time of all chunks collected.
  [[nodiscard]] double device_seconds() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq::device
