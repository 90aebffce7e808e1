/// Fills the field of distances: normals by the search's projections, depths by a map.
#include "host/fit/bounded_implant.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "host/fit/superquadric_projection.hpp"
#include "host/fit/tapered_projection.hpp"
#include "host/mesh/eigen_points.hpp"
#include "host/threads/parallel.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"

namespace verisq::fit_search {

namespace {

/// How close depths in the implant are asked for, of a primitive's smallest semi-axis.
constexpr double kDepthTolerance = 1e-2;
constexpr std::size_t kSlabsBetweenPolls = 8;

/// In the frame of a primitive.
using ProposedNormal = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

ProposedNormal normal_of(const Superquadric& solid) {
  if (is_tapered(solid)) return [projection = TaperedProjection(solid)](const auto& q) { return projection(q).normal; };
  return [projection = SuperquadricProjection(solid)](const auto& q) { return projection(q).normal; };
}

}  // namespace

BoundedImplant::BoundedImplant(const UncertainModel& implant, std::span<const verify::WeightedPoint> points,
                               const FitBoundOptions& options)
    : candidates_(implant, options.range),
      model_(candidates_.sized(candidates_.start())),
      space_(candidates_.pose_space()),
      size_(size_of(points)),
      field_(model_, size_ / 4.0, size_),
      bound_(space_, field_, points, options.fitness, options.penetration_limit, size_) {
  std::vector<ProposedNormal> normals;
  for (const Primitive& primitive : model_.primitives) normals.push_back(normal_of(primitive.superquadric));
  for (std::size_t first = 0; first < field_.slabs(); first += kSlabsBetweenPolls) {
    if (options.interrupted() || options.out_of_time()) return;
    in_parallel(std::min(kSlabsBetweenPolls, field_.slabs() - first), [&](std::size_t slab) {
      field_.find_slab(first + slab, [&](std::size_t k, const Eigen::Vector3d& q) { return normals[k](q); });
    });
  }
  field_.find_balls([&](std::span<const Point> queries) { return depths(queries, options); });
  ready_ = true;
}

verify::PoseBox BoundedImplant::box(const RangeCell& cell) const {
  verify::PoseBox result;
  for (std::size_t i = 0; i < 6; ++i) {
    const double reach = candidates_.upper()[i];
    const double half = std::ldexp(reach, -cell.level[i]);
    const auto k = static_cast<Eigen::Index>(i);
    result.centre[k] = (2.0 * cell.index[i] + 1.0) * half - reach;
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
  for (const Primitive& primitive : model_.primitives) {
    const double smallest = std::ranges::min(primitive.superquadric.semi_axes);
    std::span<const Point> rest = queries;
    std::size_t delivered = 0;
    const Source<Point> source = [&rest](std::span<Point> chunk) {
      const std::size_t count = std::min(chunk.size(), rest.size());
      std::ranges::copy(rest.first(count), chunk.begin());
      rest = rest.subspan(count);
      return count;
    };
    const Sink<Point> sink = [&](std::span<const Point>, std::span<const MapResult> found,
                                 std::span<const Certificate>) {
      for (const MapResult& row : found) {
        upper[delivered] = std::min(upper[delivered], row.distance.hi);
        ++delivered;
      }
    };
    const Model alone{model_.units, {primitive}, {}};
    device_ = PointMapper(alone, {.tolerance = kDepthTolerance * smallest,
                                  .device = options.device,
                                  .interrupted = options.interrupted,
                                  .out_of_time = options.out_of_time})
                  .map(source, sink)
                  .device;
  }
  return upper;
}

}  // namespace verisq::fit_search
