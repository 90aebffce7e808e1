/// Proves how much of the area of a mesh and of a model's surface lies close to the other: contact, by area.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>
#include <verisq/area_within.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

struct ContactAreaOptions {
  double distance;            ///< no farther is contact; model units, >= 0
  double share_width = 0.01;  ///< how wide the enclosure of a share may be, > 0
  /// A region of each triangle, below `regions`. Empty: none are asked for.
  std::vector<std::uint32_t> region_of = {};
  std::uint32_t regions = 0;
  bool of_model = false;                   ///< the model's surface, too
  std::vector<bool> counted = {};          ///< whose surface that is, one a primitive; empty: all
  std::uint64_t most_samples = 1U << 22U;  ///< of the mesh's and of the model's surface, each; what is left is wide
  std::string device = "auto";             ///< as MapOptions
  std::function<bool()> interrupted = [] { return false; };
};

struct ContactAreas {
  AreaWithin of_mesh;                  ///< of all triangles
  std::vector<AreaWithin> by_region;   ///< of each region's triangles
  std::optional<AreaWithin> of_model;  ///< of the boundary of the solid that is the model
  std::uint64_t samples = 0;           ///< distances asked for
  bool interrupted = false;            ///< what is told is proven all the same
};

/// Distances are Euclidean and not signed: a point of the mesh counts by its distance from the model's boundary, from
/// inside as from outside; a point of the model's boundary by its distance from the triangles (docs/mathematics.md
/// §20). Any model. Throws Error(input) for a mesh without triangles, regions that are not one a triangle, options out
/// of range, and as Mapper.
[[nodiscard]] ContactAreas contact_areas(const Model& model, const Mesh& mesh, const ContactAreaOptions& options);

}  // namespace verisq
