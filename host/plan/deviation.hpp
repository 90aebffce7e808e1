/// How far a mesh and a model's surface lie apart, and areas in contact: distances, how tight, of which vertices.
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

// How wide the enclosures of a deviation may be.

/// Of the bounding radius: no narrower enclosure is ever asked of a result.
inline constexpr double finest_share = 1e-6;
/// Of the width allowed: how wide samples may be where tight ones are searched for.
inline constexpr double share_of_samples = 0.05;

/// Of one with this size, of a model of this bounding radius.
[[nodiscard]] inline double allowed_width(double size, const DeviationOptions& options, double bounding_radius) {
  if (options.tolerance) return *options.tolerance;
  return std::max(options.relative_tolerance * size, finest_share * bounding_radius);
}

// How well distances have to be known that say what is in contact.

/// Finer for solids that are told at once.
[[nodiscard]] inline double contact_tolerance(const Model& model) {
  constexpr double fine = 1e-6;  // of the bounding radius
  constexpr double coarse = 1e-3;
  const double share = is_union_of_convex(model) ? fine : coarse;
  return std::min(share * bounding_radius(model), std::numeric_limits<double>::max());
}

// Whether a mesh and the regions of its triangles are what the searches of deviations ask for.

/// Throws Error(input) for a mesh without vertices, coordinates that are not finite, and triangles that name vertices
/// which are not there.
void check_mesh(const Mesh& mesh);

/// Throws Error(input) unless there is a region of each triangle, below their number; where that is 0 none are asked
/// for.
void check_regions(const Mesh& mesh, std::span<const std::uint32_t> region_of, std::uint32_t regions);

// Maps as the source of signed distances that the searches of deviations ask.

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

// Which vertices of a mesh tell enough of others to say what is in contact.

/// Of each vertex the one by which it is told: whatever its distance is, |d(v) - d(w)| <= |v - w|. Itself where that
/// would not be enough to say of all of its triangles that they are farther than `distance`, or that they are not.
/// `rows`: signed distances of the vertices, which may be unbounded; those that prove it later may be off by
/// `tolerance`. Nothing is proven by this. Precondition: finite coordinates, triangles of vertices that are there.
[[nodiscard]] std::vector<std::uint32_t> tellers(const Mesh& mesh, std::span<const Enclosure> rows, double distance,
                                                 double tolerance);

}  // namespace verisq
