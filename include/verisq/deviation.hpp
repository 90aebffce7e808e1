/// Proves how far a mesh and the surface of a model lie apart, both ways: the two-sided Hausdorff distance.
///
/// Of the model its boundary counts, of the mesh the triangles as their binary64 corners state them (of a cloud its
/// points); distances are Euclidean and not signed. The mesh need not be closed, oriented or manifold.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/map.hpp>
#include <verisq/map_result.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

struct DeviationOptions {
  /// How wide an enclosure of the result may be: this share of its upper end, but never less than 1e-6 of the model's
  /// bounding radius. Above 0.
  double relative_tolerance = 0.05;
  /// Instead, in model units. Above 0.
  std::optional<double> tolerance = {};
  std::vector<double> percentiles{50.0, 95.0};  ///< each above 0, at most 100
  bool statistics_of_surface = true;  ///< mean and percentiles of the mesh's surface, not of its vertices alone
  bool from_model = true;             ///< the model's surface to the mesh; of a cloud to its points
  bool statistics_of_model = false;   ///< mean and percentiles of the model's surface, too: takes much longer
  /// A region of each triangle, to say where it deviates, too: below `regions`. Empty: none are asked for.
  std::vector<std::uint32_t> region_of = {};
  std::uint32_t regions = 0;
  std::uint64_t most_samples = 1U << 24U;  ///< of the model's surface and of the mesh's, each; what is left is wide
  std::string device = "auto";             ///< as MapOptions
  std::function<bool()> interrupted = [] { return false; };  ///< polled; true ends early, with what is proven by then
  std::function<bool()> out_of_time = {};                    ///< a time limit, likewise; once true, it must stay true
  /// Called now and then with what is worked at, and how much of it is done, from 0 to 1, about.
  std::function<void(std::string_view stage, double done)> progress = [](std::string_view, double) {};
};

/// Of the distances of a set of points: all vertices, each of the same weight, or a whole surface, by area.
struct DistanceStatistics {
  Enclosure largest{0.0, infinity};  ///< the supremum
  Point farthest{};                  ///< about where: a point of the set within rounding of it is `largest.lo` away
  std::optional<Enclosure> mean = {};
  /// As asked for: of `p` the least distance that p % of the set do not exceed. Empty where there is none.
  std::vector<Enclosure> percentiles = {};
};

struct Deviation {
  std::vector<MapResult> vertices;               ///< signed distance of each vertex to the solid: negative inside
  MapSummary map;                                ///< of them
  DistanceStatistics of_vertices;                ///< of their distances to the model's surface
  std::optional<DistanceStatistics> from_mesh;   ///< of all points of all triangles; nothing for a cloud
  std::optional<DistanceStatistics> from_model;  ///< of all points of the model's surface
  std::vector<DistanceStatistics> by_region;     ///< of the mesh's triangles: `largest`, `farthest` and `mean`
  /// The larger of both largest distances: the two-sided Hausdorff distance. Nothing unless both are known.
  std::optional<Enclosure> hausdorff;
  std::uint64_t samples = 0;  ///< distances to the model that were asked for, but for those of `vertices`
  std::uint64_t patches = 0;  ///< parts of the model's surface whose distance to the mesh was bounded
  bool to_tolerance = false;  ///< every enclosure of the statistics is as narrow as asked for
  bool interrupted = false;
  bool out_of_time = false;  ///< the limit came, or `most_samples`, before all was narrow
};

/// Whether the enclosure is as narrow as the options ask for, of a model of this bounding radius.
[[nodiscard]] bool to_tolerance(const Enclosure& distance, const DeviationOptions& options, double bounding_radius);

/// Encloses the deviation of any model from any mesh (docs/mathematics.md §20). A mesh without triangles is a cloud.
/// Throws Error(input) for a mesh without vertices, coordinates that are not finite, triangles that name vertices which
/// are not there, options out of range, regions that are not one a triangle, and as Mapper.
[[nodiscard]] Deviation deviation(const Model& model, const Mesh& mesh, const DeviationOptions& options);

}  // namespace verisq
