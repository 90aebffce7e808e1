/// Which part of a bone each triangle of its mesh belongs to: to say where something is.
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <verisq/features.hpp>
#include <verisq/mesh.hpp>

namespace verisq::features {

/// A triangle belongs where its centroid lies; `names` in the order of the indices.
struct Regions {
  std::vector<std::string> names;
  std::vector<std::uint32_t> of_triangles;
};

/// Head (to 1.15 of its radius about its centre), neck (about its axis, from the head towards the shaft axis, to 0.9 of
/// that radius), shaft (between its two points, along it), condyles (below) and trochanters (all else above). Throws
/// Error(input) unless the landmarks have head, neck and shaft.
[[nodiscard]] Regions femur_regions(const Mesh& mesh, const FemurLandmarks& landmarks);

/// Equal parts of the extent along the direction in which the surface spreads most, whose largest coordinate is
/// positive; named by where they begin and end. Precondition: count > 0, the mesh has triangles.
[[nodiscard]] Regions parts_along(const Mesh& mesh, std::uint32_t count);

}  // namespace verisq::features
