/// Fills the field of distances: normals by the search's projections, depths by a map.
#include "host/fit/bounded_implant.hpp"

#include <algorithm>
#include <cmath>

#include "host/fit/primitive_projection.hpp"
#include "host/mesh/eigen_points.hpp"
#include "host/threads/parallel.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"

namespace verisq::fit_search {

namespace {

/// How close depths in the implant are asked for, of a primitive's smallest semi-axis.
constexpr double kDepthTolerance = 1e-2;
constexpr std::size_t kSlabsBetweenPolls = 8;

}  // namespace

BoundedImplant::BoundedImplant(const UncertainModel& implant, std::span<const verify::WeightedPoint> points,
                               const FitBoundOptions& options)
    : candidates_(implant, options.range),
      model_(candidates_.sized(candidates_.start())),
      space_(candidates_.pose_space()),
      size_(size_of(points)),
      field_(model_, size_ / 4.0, size_),
      bound_(space_, field_, points, options.fitness, options.penetration_limit, size_) {
  std::vector<PrimitiveProjection> projections;
  for (const Primitive& primitive : model_.primitives) projections.emplace_back(primitive);
  for (std::size_t first = 0; first < field_.slabs(); first += kSlabsBetweenPolls) {
    if (options.interrupted() || options.out_of_time()) return;
    in_parallel(std::min(kSlabsBetweenPolls, field_.slabs() - first), [&](std::size_t slab) {
      field_.find_slab(first + slab, [&](std::size_t k, const Eigen::Vector3d& q) { return projections[k](q).normal; });
    });
  }
  field_.find_balls([&](std::span<const Point> queries) { return depths(queries, options); });
  ready_ = true;
}

verify::PoseBox BoundedImplant::box(const RangeCell& cell) const {
  verify::PoseBox result;
  for (std::size_t i = 0; i < 6; ++i) {
    const double reach = candidates_.upper()[i];
    const double half = std::ldexp(reach, -cell.poses.level[i]);
    const auto k = static_cast<Eigen::Index>(i);
    result.centre[k] = (2.0 * cell.poses.index[i] + 1.0) * half - reach;
    result.half[k] = half + 0x1p-50 * reach;  // the centre is rounded
  }
  return result;
}

double BoundedImplant::model_radius() const {
  double radius = space_.centre.norm();
  for (const Primitive& primitive : model_.primitives) {
    const auto& [a, b, c] = primitive.superquadric.semi_axes;
    radius = std::max(radius, vector_of(primitive.pose.translation).norm() + 2.0 * (a + b) + c);
  }
  return radius;
}

/// Four times the largest coordinates of points, poses and implant together, which no sum of them on the way from the
/// cavity to the implant exceeds. No point is farther from the implant than a quarter of it.
double BoundedImplant::size_of(std::span<const verify::WeightedPoint> points) const {
  double farthest = 0.0;
  for (const verify::WeightedPoint& point : points) farthest = std::max(farthest, point.place.norm());
  return 4.0 * (farthest + space_.start_centre.norm() + 2.0 * candidates_.upper()[0] + 2.0 * model_radius());
}

/// To one primitive at a time: the union's overlaps are deeper, but cost a search.
std::vector<double> BoundedImplant::depths(std::span<const Point> queries, const FitBoundOptions& options) {
  std::vector<double> upper(queries.size(), infinity);
  std::vector<MapResult> rows(queries.size());
  for (const Primitive& primitive : model_.primitives) {
    const double smallest = std::ranges::min(primitive.superquadric.semi_axes);
    const Model alone{model_.units, {primitive}, {}};
    const MapSummary map = PointMapper(alone, {.tolerance = kDepthTolerance * smallest,
                                               .device = options.device,
                                               .interrupted = options.interrupted,
                                               .out_of_time = options.out_of_time})
                               .map(queries, rows);
    for (std::size_t i = 0; i < map.points; ++i) upper[i] = std::min(upper[i], rows[i].distance.hi);
    device_ = map.device;
  }
  return upper;
}

}  // namespace verisq::fit_search
