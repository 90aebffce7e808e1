/// Proves how close a whole mesh, between its vertices too, comes to a model, and how deep it enters it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

struct MeshClearanceOptions {
  double penetration_limit = 0.0;              ///< model units, >= 0
  double tolerance;                            ///< of the smallest distance, in model units, > 0
  std::optional<double> limit_tolerance = {};  ///< how close to the limit a triangle is still decided; else the same
  std::uint64_t most_samples = 1U << 23U;      ///< distances asked for, about: then what is open stays undecided
  std::string device = "auto";                 ///< as MapOptions
  std::function<bool()> interrupted = [] { return false; };
};

struct PointOnTriangle {
  Point point;             ///< to nearest
  std::uint32_t triangle;  ///< index in the mesh
};

/// Every triangle is counted once.
struct MeshClearance {
  Enclosure smallest_distance;  ///< signed, over all points of all triangles; its lower end proves the whole surface
  std::uint64_t proven_within = 0;    ///< no point of the triangle lies deeper than the limit
  std::uint64_t proven_too_deep = 0;  ///< some point of it does
  std::uint64_t undecided = 0;
  std::vector<PointOnTriangle> too_deep;  ///< of each triangle proven too deep the deepest point looked at
  PointOnTriangle deepest = {};           ///< along a path: but for rounding of a distance no more than the upper end
  std::uint64_t samples = 0;              ///< distances asked for
  bool interrupted = false;               ///< what is told is proven all the same
};

/// Branch and bound over the triangles, for any model. Throws Error(input) for a mesh without triangles, and as
/// Mapper.
[[nodiscard]] MeshClearance mesh_clearance(const Model& model, const Mesh& mesh, const MeshClearanceOptions& options);

/// The same of the smallest signed distances along a path, at the poses and between them (insertion.hpp): they, too,
/// change by no more than the place moves. Of a triangle that is cut the point is any that proves it. Throws likewise,
/// and for a path as there.
[[nodiscard]] MeshClearance mesh_clearance_along(std::span<const Pose> path, const Model& model, const Mesh& mesh,
                                                 const MeshClearanceOptions& options);

}  // namespace verisq
