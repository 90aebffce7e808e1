/// The deviation of a mesh from a model's surface, and areas in contact: distances, allowed widths, the vertices used.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "verisq/deviation.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq {

// The allowed widths of the enclosures of a deviation.

/// Share of the bounding radius: no narrower enclosure of a result is ever required.
inline constexpr double finest_share = 1e-6;
/// Share of the allowed width: the allowed width of samples, if tight ones are searched for.
inline constexpr double share_of_samples = 0.05;

/// The allowed width of an enclosure with this size, for a model of this bounding radius.
[[nodiscard]] inline double allowed_width(double size, const DeviationOptions& options, double bounding_radius) {
  if (options.tolerance) return *options.tolerance;
  return std::max(options.relative_tolerance * size, finest_share * bounding_radius);
}

// The required accuracy of distances that decide what is in contact.

/// Finer for solids whose distances need no search.
[[nodiscard]] inline double contact_tolerance(const Model& model) {
  constexpr double fine = 1e-6;  // of the bounding radius
  constexpr double coarse = 1e-3;
  const double share = is_union_of_convex(model) ? fine : coarse;
  return std::min(share * bounding_radius(model), std::numeric_limits<double>::max());
}

// Checks of a mesh and the regions of its triangles, for the searches of deviations.

/// Throws Error(input) for a mesh without vertices, coordinates that are not finite, and triangles that name missing
/// vertices.
void check_mesh(const Mesh& mesh);

/// Throws Error(input) unless each triangle has a region, below `regions`; if that is 0, there are no regions.
void check_regions(const Mesh& mesh, std::span<const std::uint32_t> region_of, std::uint32_t regions);

// Maps as the source of signed distances for the searches of deviations.

/// A mapper as a source of enclosures.
class MappedDistances {
 public:
  MappedDistances(const Model& model, const MapOptions& options)
      : mapper_(std::make_shared<PointMapper>(model, options)), out_of_time_(options.out_of_time) {}

  bool operator()(std::span<const Point> points, std::span<Enclosure> rows) const {
    return !map(points, rows).interrupted && !(out_of_time_ && out_of_time_());
  }

  [[nodiscard]] MapSummary map(std::span<const Point> points, std::span<Enclosure> rows) const {
    std::vector<Status> status(rows.size(), Status::wide);
    return map(points, rows, status);
  }

  [[nodiscard]] MapSummary map(std::span<const Point> points, std::span<Enclosure> rows,
                               std::span<Status> status) const {
    if (points.empty()) return {};
    constexpr std::ptrdiff_t stride = sizeof(Enclosure) / sizeof(double);
    return mapper_->map(points, {rows.size(), {&rows[0].lo, stride}, {&rows[0].hi, stride}, {status.data()}});
  }

 private:
  std::shared_ptr<PointMapper> mapper_;
  std::function<bool()> out_of_time_;
};

// The vertices of a mesh that bound others well enough to decide what is in contact.

/// For each vertex: the vertex whose certificate also bounds it, because |d(v) - d(w)| <= |v - w|. It is the vertex
/// itself if that bound could not prove of all of its triangles that they are farther than `distance`, or that they are
/// not. `rows` are signed distances of the vertices, which may be unbounded; the distances proven later may be off by
/// `tolerance`. This proves nothing. Precondition: finite coordinates, triangles of existing vertices.
[[nodiscard]] std::vector<std::uint32_t> tellers(const Mesh& mesh, std::span<const Enclosure> rows, double distance,
                                                 double tolerance);

}  // namespace verisq
