/// Compares the kernels of a program with the host on samples, once per program and device.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "host/device/query_batches.hpp"
#include "host/threads/parallel.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

// Queries that kernels are sampled on, and the host's own answers: the same at every call.

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

// The kernels of triangles and of poses on samples, in the batches that maps send them through.

/// The first fault in the enclosures of sampled triangles' distances to one convex solid and to two; empty where there
/// is none. `program` is of triangles, compiled for the device's vector width.
[[nodiscard]] std::string first_fault_of_triangles(const Device& device, const cl::Program& program);

/// The first fault of the distances of two unions at sampled poses; `program` is for pairs, `of_host` is
/// pose_distances_by_host.
[[nodiscard]] std::string first_fault_of_poses(const Device& device, const cl::Program& program,
                                               PoseDistances& of_host);

// The kernels of points about convex primitives, on samples, launched like those of a map.

/// The first fault in the rows, or in the sums of their verdicts, that `programs` compute for sampled points in steps,
/// depths included; empty if there is none. With a tapered program only tapered solids are sampled. Preconditions:
/// compiled for the device's vector width.
[[nodiscard]] std::string first_fault_in_steps(const Device& device, const PointPrograms& programs);

/// The first fault of the rows that the kernel point_map computes at once. `program` is for `tapered` solids, or for
/// others.
[[nodiscard]] std::string first_fault_at_once(const Device& device, const cl::Program& program, bool tapered);

// The kernels of a model with bends or set operations, on samples, in the batch through which maps send points.

/// The first fault in the enclosures of sampled points' signed distances to `model`, whose own programs these are;
/// empty where there is none.
[[nodiscard]] std::string first_fault_of_solid(const Device& device, const SolidPrograms& programs, const Model& model);

/// Identifies the samples: models of one program may differ in whether primitives are bent or tapered.
[[nodiscard]] std::string samples_of_solid(const Model& model);

/// Returns if `first_fault`, which tries the kernels of `program` on samples, returns an empty text; otherwise throws
/// RefusedDevice with its text. The cache keeps the outcome by the device, its driver, the program and `samples`, which
/// identifies the tried kernels and samples. If the outcome is known there already, nothing is tried.
void require_sound(const Device& device, const cl::Program& program, std::string_view samples,
                   const std::function<std::string()>& first_fault);

/// The first of the device's enclosures that has nothing in common with the host's of the same query, or a message that
/// too few are narrow to call the kernels working. Empty if neither is found. Both enclose one number: without a common
/// number the device's is false, because the host's is proven. `wanted` of the enclosures must be at most `narrow`
/// wide.
[[nodiscard]] std::string contradiction(std::span<const Enclosure> of_device, std::span<const Enclosure> of_host,
                                        double narrow, std::size_t wanted);

}  // namespace verisq::device
