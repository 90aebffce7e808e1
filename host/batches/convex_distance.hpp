/// A chunk of points against one convex primitive on a device: distances outside, depths inside.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/batches/chunk_queue.hpp"
#include "host/device/device.hpp"

namespace verisq::device {

/// What is found for each point of a chunk: lower ends, upper ends, and normals x, y, z in the primitive's own frame.
using EvidenceBuffers = std::array<cl::Buffer, 5>;

/// The windows of each of `count` primitives into buffers that hold all of them, `capacity` numbers each.
[[nodiscard]] std::vector<EvidenceBuffers> views_of_primitives(const EvidenceBuffers& all, std::size_t count,
                                                               std::size_t capacity);

/// What single convex primitives take.
struct PointPrograms {
  PointPrograms(cl::Program of_untapered) : untapered(std::move(of_untapered)) {}

  cl::Program untapered;
  std::optional<cl::Program> tapered;  ///< where a primitive has a taper
};

/// Of kernels/embedded_point_sources and, for a `tapered` primitive, embedded_tapered_sources; `memory` says where the
/// primitives lie (DeviceModel).
[[nodiscard]] PointPrograms point_programs(const Device& device, const std::string& memory, bool tapered);

/// The kernels point_distance and interior_depth, of untapered and of tapered primitives, with the buffers that they
/// need besides.
class ConvexDistance {
 public:
  /// `programs` are for the memory that the primitives lie in. `tolerance` in the device's numbers:
  /// depths are searched to it, and not far beyond what branch and bound can do.
  ConvexDistance(const Device& device, const PointPrograms& programs, ChunkQueue& queue, std::size_t capacity,
                 double tolerance);

  /// Where points lie, and what is known of them: a column each.
  struct Points {
    std::array<cl::Buffer, 3> coordinates;
    cl::Buffer nearest;  ///< smallest upper end so far
  };

  /// Of `primitives` the one of that index.
  struct Primitive {
    cl::Buffer primitives;
    std::size_t index;
    bool tapered;
  };

  /// Enqueues the distances of the first `groups` vectors of points. With index 0 nothing is known yet about the
  /// points; a later primitive is passed over where a sphere or a box about it is farther than what was found.
  void enqueue_distances(ChunkQueue& queue, const Points& points, const Primitive& primitive, std::size_t groups,
                         const EvidenceBuffers& evidence);
  /// After these, for points inside: without it their upper ends are those of any. Its kernel is compiled, and its
  /// memory is taken, when it is first enqueued.
  void enqueue_depths(ChunkQueue& queue, const Points& points, const Primitive& primitive, std::size_t groups,
                      const EvidenceBuffers& evidence);

 private:
  /// Of one program.
  struct Kernels {
    NamedKernel distance, depth;
  };

  [[nodiscard]] Kernels kernels_of(const cl::Program& program, std::string_view sources, double tolerance) const;
  Kernels& of(const Primitive& primitive) { return primitive.tapered ? *tapered_ : untapered_; }
  void enqueue(ChunkQueue& queue, NamedKernel& kernel, const Points& points, const Primitive& primitive,
               std::size_t groups, const EvidenceBuffers& evidence);

  std::size_t capacity_;
  std::size_t groups_per_block_;
  // Kernels do not keep the buffers that they are given.
  Points points_;
  cl::Buffer primitives_;
  cl::Buffer listed_;
  cl::Buffer scratch_;  // nothing until depths are enqueued
  Kernels untapered_;
  std::optional<Kernels> tapered_;
};

}  // namespace verisq::device
