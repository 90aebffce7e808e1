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

// Which memory of a device kernels read a model from.

/// The compiler option of programs that read a model of so many bytes: nothing where it fits into the device's constant
/// memory, for which the kernels are written; else that of global memory. A kernel has one such argument at most, and
/// CL_DEVICE_MAX_CONSTANT_ARGS is at least 4 on every device. Global memory for all would cost PoCL 4 % of the time of
/// points and 3 % of a fit's (measured), and graphics processors a cache.
[[nodiscard]] inline std::string model_memory_option(const Device& device, std::size_t bytes) {
  return bytes <= device.constant_memory ? "" : "-DMODEL_IN_GLOBAL_MEMORY";
}

// Queries of a chunk that a processor's device may work on side by side, so that what one needs the others get, too.

/// Chunks begin at multiples of it. rows_per_block in include/verisq/map.hpp is the same.
inline constexpr std::size_t rows_side_by_side = 2048;

// A model in the memory of a device, and how large its chunks are.

/// Why only the host can make maps and octrees of it; empty where devices can.
[[nodiscard]] std::string why_not_on_devices(const Model& model);
/// Likewise, for triangles and pairs.
[[nodiscard]] std::string why_not_as_triangles_or_pairs(const Model& model);

/// Largest magnitudes, in units of the model's largest semi-axis, that the kernels' arithmetic is made for; a model
/// beyond is the host's.
[[nodiscard]] bool within_device_range(const Model& model);

/// The primitives of both models, those of `a` first: a device holds them under one scale.
[[nodiscard]] Model joined(const Model& a, const Model& b);

/// What a processor's chunk holds of a small model. Long against a launch, short against a mesh, so that work overlaps.
inline constexpr std::size_t usual_processor_chunk = std::size_t{1} << 14U;

struct DeviceModel {
  DeviceModel(const Device& device, const Model& model, std::size_t processor_chunk = usual_processor_chunk);

  int scale_exponent;         ///< numbers of the device are model units times 2^scale_exponent
  cl::Buffer primitives;      ///< PrimitiveParameters of each
  std::size_t count;          ///< of primitives
  std::vector<bool> tapered;  ///< which of them
  std::string memory;         ///< option of programs that read them (model_memory.hpp)
  std::size_t chunk_size;     ///< queries a chunk may hold: memory stays bounded however large the model

  [[nodiscard]] bool has_tapered() const { return std::ranges::find(tapered, true) != tapered.end(); }
};

/// OpenCL implementations put off the end of compilation to the first launch: a chunk of so many queries makes them do
/// it before the first one of a map.
inline constexpr std::size_t queries_of_warm_up = 256;

/// A coordinate far from every model, in model units: what that chunk is filled with.
[[nodiscard]] double far_away(const DeviceModel& model);

// A chunk of points against one convex primitive on a device: distances outside, depths inside.

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
/// primitives lie (DeviceModel). Throws RefusedDevice where their kernels err on samples.
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
