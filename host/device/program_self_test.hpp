/// Compares the kernels of a program with the host on samples, once per program and device.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "host/device/query_batches.hpp"
#include "host/device/solid_batch.hpp"
#include "host/threads/parallel.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

// Queries that kernels are sampled on, and the host's own answers: the same at every call.

/// Points on, near, inside, around and far from the model's primitives, which take turns.
[[nodiscard]] std::vector<Point> sample_points(const Model& model, std::size_t count);

/// The host's enclosure of each point's signed distance, searched to the tolerance in model units.
[[nodiscard]] std::vector<Enclosure> distances_by_host(const Model& model, std::span<const Point> points,
                                                       double tolerance);

/// The host's enclosure of the distance of two unions of convex primitives at each pose of the second. Inline, so that
/// a program that maps no poses is linked without what finds their distances.
[[nodiscard]] inline std::vector<Enclosure> pose_distances_by_host(const Model& a, const Model& b,
                                                                   std::span<const Pose> poses) {
  const PairDistance distance(a, b);
  std::vector<Enclosure> found(poses.size());
  in_parallel(poses.size(), [&](std::size_t n) { found[n] = distance(poses[n]).distance; });
  return found;
}

/// A convex solid of general shape and place, and another that overlaps it, in units of `unit`.
[[nodiscard]] Primitive sample_solid(double unit);
[[nodiscard]] Primitive other_sample_solid(double unit);

/// The union of the primitives.
[[nodiscard]] Model sample_model(std::vector<Primitive> primitives);

// The kernels of triangles and of poses on samples, in the batches that maps send them through.

/// The first fault in the enclosures of sampled triangles' distances to one convex solid and to two; empty where there
/// is none. `program` is of triangles, compiled for the device's vector width.
[[nodiscard]] std::string first_fault_of_triangles(const Device& device, const cl::Program& program);

/// Likewise of the distances of two unions at sampled poses; `program` is of pairs, `of_host` pose_distances_by_host.
[[nodiscard]] std::string first_fault_of_poses(const Device& device, const cl::Program& program,
                                               PoseDistances& of_host);

// The kernels of points about convex primitives on samples, launched as a map launches them.

/// The first fault in the rows, or in the sums of their verdicts, that `programs` make of sampled points in steps,
/// depths included; empty where there is none. With a tapered program of tapered solids alone.
/// Preconditions: compiled for the device's vector width.
[[nodiscard]] std::string first_fault_in_steps(const Device& device, const PointPrograms& programs);

/// Likewise of those that the kernel point_map makes at once. `program` is of `tapered` solids, or of others.
[[nodiscard]] std::string first_fault_at_once(const Device& device, const cl::Program& program, bool tapered);

// The kernels of a model with bends or set operations on samples, in the batch that maps send points through.

/// The first fault in the enclosures of sampled points' signed distances to `model`, whose own programs these are;
/// empty where there is none.
[[nodiscard]] std::string first_fault_of_solid(const Device& device, const SolidPrograms& programs, const Model& model);

/// Which samples those are: models of one program may differ in whether primitives are bent or tapered.
[[nodiscard]] std::string samples_of_solid(const Model& model);

// Compares the kernels of a program with the host on samples, once per program and device.

/// Returns if `first_fault`, which tries the kernels of `program` on samples, says nothing; otherwise throws
/// RefusedDevice with what it says. The outcome is kept in the cache, by the device, its driver, the program and
/// `samples`, which says which kernels are tried on what: where it is known there already, nothing is tried.
void require_sound(const Device& device, const cl::Program& program, std::string_view samples,
                   const std::function<std::string()>& first_fault);

/// The first of the device's enclosures that has nothing in common with the host's of the same query, or that there
/// are too few narrow ones to call the kernels working; empty where all is well. Both enclose one number: without a
/// common one the device's is false, for the host's is proven.
/// `wanted` of the enclosures must be at most `narrow` wide.
[[nodiscard]] std::string contradiction(std::span<const Enclosure> of_device, std::span<const Enclosure> of_host,
                                        double narrow, std::size_t wanted);

}  // namespace verisq::device
