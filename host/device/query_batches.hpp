/// Queries in, enclosures of distances out: points, triangles and poses, for unions of convex solids and for any model.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/device/chunk_pipeline.hpp"
#include "host/device/chunk_queue.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "verisq/checker.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

// Points in, enclosures of their signed distances to a union of convex primitives, and their certificates, out.

// The results of kernels for a chunk of points in columns: enclosures of their distances to a union of convex
// primitives.

/// The kernels of single primitives and the kernel of their union, with the buffers of one chunk.
class PointKernels {
 public:
  /// `programs` are `point_programs`; `tolerance` in the device's numbers.
  PointKernels(const Device& device, const PointPrograms& programs, const DeviceModel& model, ChunkQueue& queue,
               double tolerance);

  /// x, y, z, in the device's numbers: to be written before `enqueue`, in whole vectors.
  [[nodiscard]] const std::array<cl::Buffer, 3>& coordinates() const { return points_.coordinates; }
  /// Lower and upper ends, in the device's numbers.
  [[nodiscard]] const std::array<cl::Buffer, 2>& ends() const { return ends_; }
  /// The evidence for each primitive, and for each point a point outside of all primitives; not for a single primitive.
  [[nodiscard]] const std::vector<EvidenceBuffers>& evidence() const { return views_; }
  [[nodiscard]] const std::array<cl::Buffer, 3>& escapes() const { return escapes_; }

  /// Enqueues the distances of the first `groups` vectors of points.
  void enqueue(ChunkQueue& queue, std::size_t groups);
  /// The same; a result is final if its lower end is above 0, or if it is not wider than the tolerance. Others are
  /// valid: their upper ends are trivial for points inside.
  void enqueue_outside(ChunkQueue& queue, std::size_t groups);
  /// After that: completes the other results, too.
  void enqueue_inside(ChunkQueue& queue, std::size_t groups);

 private:
  void enqueue_distances(ChunkQueue& queue, std::size_t groups);
  void enqueue_depths(ChunkQueue& queue, std::size_t groups);
  void enqueue_union(ChunkQueue& queue, std::size_t groups);

  std::size_t count_;  // of primitives
  // Kernels do not keep the buffers that they are given.
  cl::Buffer primitives_;
  std::vector<bool> tapered_;  // which primitives are
  ConvexDistance::Points points_;
  ConvexDistance convex_distance_;
  NamedKernel union_distance_;
  EvidenceBuffers per_primitive_;  // primitive by primitive
  std::array<cl::Buffer, 2> ends_;
  std::array<cl::Buffer, 3> escapes_;
  std::vector<EvidenceBuffers> views_;  // windows of those, one for each primitive
};

// Turns the kernels' results for a point into the certificate of its enclosure.

/// In model units. Nothing here needs to be true: certificates are proposals until they are checked.
struct Evidence {
  struct OfPrimitive {
    double hi;     ///< upper end for this primitive alone; infinite if the primitive was skipped
    Point normal;  ///< normal of the lower end, of any length
  };
  std::vector<OfPrimitive> primitives;
  Point escape;  ///< meaningful where the union's lower end is finite and not positive
};

/// For each primitive the same about a triangle, and the weights of the upper end's point on it.
struct TriangleEvidenceOfPrimitive {
  Evidence::OfPrimitive bounds;
  std::array<double, 2> weights;
};
using TriangleEvidence = std::vector<TriangleEvidenceOfPrimitive>;

/// Contains every normal that a kernel found: a primitive without one is far by its bounding sphere.
[[nodiscard]] Certificate certificate_of(const TriangleEvidence& evidence);

class CertificateAssembly {
 public:
  explicit CertificateAssembly(const Model& model);

  /// Contains as few normals as prove the enclosure. Outside these are the normals of the primitives whose bounding
  /// sphere is too near; inside, the normal of the primitive that decides the upper end.
  [[nodiscard]] Certificate operator()(const Point& point, const Enclosure& distance, const Evidence& evidence) const;

 private:
  struct Sphere {
    Point centre;
    double radius;
  };

  [[nodiscard]] static bool clear_of_sphere(const Point& point, double distance, const Sphere& sphere);

  std::vector<Sphere> spheres_;  ///< about each primitive
};

// Points in, enclosures of their signed distances to a model out.

/// `tolerance` and `certificates` as in MapOptions. Throws Error(failure) with the name of a failed OpenCL call.
[[nodiscard]] std::unique_ptr<Batch<Point>> point_batch(const Device& device, const Model& model, double tolerance,
                                                        bool certificates);

/// With given kernels, for tests. Precondition: compiled for the memory in which the device's models of this size lie,
/// and for the device's vector width.
[[nodiscard]] std::unique_ptr<Batch<Point>> point_batch(const Device& device, const cl::Program& program,
                                                        const Model& model, double tolerance, bool certificates);

// Triangles in, enclosures of their distances to a model out.

/// `certificates` as in MapOptions. Throws Error(failure) with the name of a failed OpenCL call, and RefusedDevice
/// where the kernels err on samples.
[[nodiscard]] std::unique_ptr<Batch<Triangle>> triangle_batch(const Device& device, const Model& model,
                                                              bool certificates);

/// With kernels that are not tested before. Precondition: compiled for the device's vector width.
[[nodiscard]] std::unique_ptr<Batch<Triangle>> triangle_batch(const Device& device, const cl::Program& program,
                                                              const Model& model, bool certificates);

// Poses of a model B in, enclosures of its distances to a model A out; there are no certificates.

/// Enclosures of the distance of B to A at each pose of B.
using PoseDistances = std::vector<Enclosure>(const Model& a, const Model& b, std::span<const Pose> poses);

/// Throws Error(failure) with the name of a failed OpenCL call, and RefusedDevice where the kernels err on samples:
/// where they contradict `of_host`, which is pose_distances_by_host.
[[nodiscard]] std::unique_ptr<Batch<Pose>> pose_batch(const Device& device, const Model& a, const Model& b,
                                                      PoseDistances& of_host);

/// With kernels that are not tested before. Precondition: compiled for the device's vector width.
[[nodiscard]] std::unique_ptr<Batch<Pose>> pose_batch(const Device& device, const cl::Program& program, const Model& a,
                                                      const Model& b);

// Points in, signed distances to a model with bends or set operations out.

/// Branch and bound over cubes (kernels/solid_distance.cl) with the tolerance, absolute in model units, as its stop.
/// Compiles the model's own tree. Precondition: within_device_range(model). Throws Error(failure) with the name of a
/// failed OpenCL call, and RefusedDevice where the kernels err on samples.
[[nodiscard]] std::unique_ptr<Batch<Point>> solid_batch(const Device& device, const Model& model, double tolerance);

/// The programs that a model needs.
struct SolidPrograms {
  cl::Program own;                      ///< of solid_source(model), for solid_vector_width
  std::optional<PointPrograms> convex;  ///< nothing where all primitives are bent
};

/// With kernels of the model that are not tried before.
[[nodiscard]] std::unique_ptr<Batch<Point>> solid_batch(const Device& device, const SolidPrograms& programs,
                                                        const Model& model, double tolerance);

/// The same, and of the points of the chunk that was collected last about the gradients of their signed distances, in
/// the model's frame, of any length: zero where the kernels did not look for them. They prove nothing.
struct DirectedBatch {
  std::unique_ptr<Batch<Point>> points;
  std::shared_ptr<const std::vector<Point>> directions;
};

// Triangles in, distances to a model with bends or set operations out.

/// Branch and bound over parts of each triangle (verify/search/solid_triangle_distance.hpp): the device evaluates the
/// points that all triangles of a chunk request at a time. Stops at the tolerance, absolute in model units, and once
/// `stop`, unless empty, returns true. Preconditions and errors as those of solid_batch.
[[nodiscard]] std::unique_ptr<Batch<Triangle>> solid_triangle_batch(const Device& device, const Model& model,
                                                                    double tolerance,
                                                                    const std::function<bool()>& stop);

}  // namespace verisq::device
