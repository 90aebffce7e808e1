/// A model in the memory of a device: how large its chunks are, and the kernels of unions of convex primitives.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/device/chunk_queue.hpp"
#include "host/device/device.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

// A model in the memory of a device, and how large its chunks are.

// The memory of a device from which kernels read a model.

/// The compiler option of programs that read a model of so many bytes. It is empty if the model fits into the device's
/// constant memory, for which the kernels are written; else it selects global memory. A kernel has at most one such
/// argument, and CL_DEVICE_MAX_CONSTANT_ARGS is at least 4 on every device. Global memory for all would cost PoCL 4 %
/// of the time of points and 3 % of a fit's (measured), and graphics processors a cache.
[[nodiscard]] inline std::string model_memory_option(const Device& device, std::size_t bytes) {
  return bytes <= device.constant_memory ? "" : "-DMODEL_IN_GLOBAL_MEMORY";
}

// Queries of a chunk that a processor's device may process side by side, so that all of them get the treatment that one
// of them needs.

/// Chunks begin at multiples of this number. rows_per_block in include/verisq/map.hpp is the same.
inline constexpr std::size_t rows_side_by_side = 2048;

// A model in the memory of a device, and the size of its chunks.

/// The reason why only the host can make maps and octrees of the model; empty if devices can.
[[nodiscard]] std::string why_not_on_devices(const Model& model);
/// The same for triangles and pairs.
[[nodiscard]] std::string why_not_as_triangles_or_pairs(const Model& model);

/// Largest magnitudes, in units of the model's largest semi-axis, that the kernels' arithmetic is made for; a model
/// beyond is the host's.
[[nodiscard]] bool within_device_range(const Model& model);

/// The primitives of both models, those of `a` first: a device holds them under one scale.
[[nodiscard]] Model joined(const Model& a, const Model& b);

/// The size of a processor's chunk for a small model. Long against a launch, short against a mesh, so that work
/// overlaps.
inline constexpr std::size_t usual_processor_chunk = std::size_t{1} << 14U;

struct DeviceModel {
  DeviceModel(const Device& device, const Model& model, std::size_t processor_chunk = usual_processor_chunk);

  int scale_exponent;         ///< numbers of the device are model units times 2^scale_exponent
  cl::Buffer primitives;      ///< PrimitiveParameters of each
  std::size_t count;          ///< number of primitives
  std::vector<bool> tapered;  ///< for each primitive
  std::string memory;         ///< option of programs that read them
  std::size_t chunk_size;     ///< queries a chunk may hold: memory stays bounded however large the model

  [[nodiscard]] bool has_tapered() const { return std::ranges::find(tapered, true) != tapered.end(); }
};

/// OpenCL implementations postpone the end of compilation to the first launch: a chunk of so many queries makes them do
/// it before the first chunk of a map.
inline constexpr std::size_t queries_of_warm_up = 256;

/// A coordinate far from every model, in model units: that chunk is filled with it.
[[nodiscard]] double far_away(const DeviceModel& model);

// A chunk of points against one convex primitive on a device: distances outside, depths inside.

/// The evidence for each point of a chunk: lower ends, upper ends, and normals x, y, z in the primitive's own frame.
using EvidenceBuffers = std::array<cl::Buffer, 5>;

/// The windows of each of `count` primitives into buffers that hold all of them, `capacity` numbers each.
[[nodiscard]] std::vector<EvidenceBuffers> views_of_primitives(const EvidenceBuffers& all, std::size_t count,
                                                               std::size_t capacity);

/// The programs for single convex primitives.
struct PointPrograms {
  PointPrograms(cl::Program of_untapered) : untapered(std::move(of_untapered)) {}

  cl::Program untapered;
  std::optional<cl::Program> tapered;  ///< set if a primitive has a taper
};

/// The programs of kernels/embedded_point_sources and, for a `tapered` primitive, embedded_tapered_sources. `memory`
/// gives the memory of the primitives (DeviceModel). Throws RefusedDevice if their kernels err on samples.
[[nodiscard]] PointPrograms point_programs(const Device& device, const std::string& memory, bool tapered);

/// The kernels point_distance and interior_depth, for untapered and tapered primitives, with the other buffers that
/// they need.
class ConvexDistance {
 public:
  /// `programs` are for the memory that contains the primitives. `tolerance` is in the device's numbers: depths are
  /// searched to it, and not far beyond the limit of branch and bound.
  ConvexDistance(const Device& device, const PointPrograms& programs, ChunkQueue& queue, std::size_t capacity,
                 double tolerance);

  /// The points, and the known bounds of their distances: a column each.
  struct Points {
    std::array<cl::Buffer, 3> coordinates;
    cl::Buffer nearest;  ///< smallest upper end so far
  };

  /// The primitive with this index in `primitives`.
  struct Primitive {
    cl::Buffer primitives;
    std::size_t index;
    bool tapered;
  };

  /// Enqueues the distances of the first `groups` vectors of points. With index 0 nothing is known yet about the
  /// points. A later primitive is skipped if a sphere or a box about it is farther than the distance found so far.
  void enqueue_distances(ChunkQueue& queue, const Points& points, const Primitive& primitive, std::size_t groups,
                         const EvidenceBuffers& evidence);
  /// Enqueues the depths of points inside, after the distances: without it their upper ends are trivial. Its kernel is
  /// compiled, and its memory is taken, when it is first enqueued.
  void enqueue_depths(ChunkQueue& queue, const Points& points, const Primitive& primitive, std::size_t groups,
                      const EvidenceBuffers& evidence);

 private:
  /// The kernels of one program.
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
