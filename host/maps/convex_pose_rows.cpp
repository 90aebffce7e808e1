/// From below by a half-space that holds the solid, whose distance is linear in the place of the point; from above,
/// since the signed distance to a convex solid is convex, at the corners of a polyhedron that contains all places.
#include "host/maps/convex_pose_rows.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>

#include "host/maps/exact_map.hpp"
#include "host/threads/parallel.hpp"
#include "verify/placement/displaced_point.hpp"
#include "verify/proof/posed_superquadric.hpp"

namespace verisq {
namespace {

using verify::DisplacedPoint;
using verify::Interval;

/// Of one solid at its nominal pose.
struct RowsOfSolid {
  std::vector<Enclosure> distances;
  std::vector<Certificate> certificates;
};

verify::Vector3<double> outward(const verify::PreciseVector& v) {
  const auto end = [](const verify::PreciseInterval& x) {
    return Interval(x.lower().to_double(verify::Direction::down), x.upper().to_double(verify::Direction::up));
  };
  return {end(v[0]), end(v[1]), end(v[2])};
}

MapOptions without_uncertainty(MapOptions options) {
  options.pose_uncertainty.reset();
  options.point_radius = 0.0;
  options.method = Method::duality;
  options.certificates = false;
  return options;
}

MapOptions with_certificates(MapOptions options) {
  options.certificates = true;
  return options;
}

Model alone(const Primitive& primitive) {
  Model model;
  model.primitives = {primitive};
  return model;
}

}  // namespace

/// One primitive, and its maps.
struct ConvexPoseRows::Solid {
  Solid(const Primitive& primitive, const MapOptions& options)
      : posed(primitive),
        certified(point_map(alone(primitive), with_certificates(options))),
        distances(point_map(alone(primitive), options)) {}

  /// Nothing: interrupted.
  [[nodiscard]] std::optional<RowsOfSolid> at_nominal_pose(std::span<const Point> points) const {
    RowsOfSolid rows;
    const auto source = [&](std::span<Point> chunk) {
      const std::size_t count = std::min(chunk.size(), points.size());
      std::ranges::copy(points.first(count), chunk.begin());
      points = points.subspan(count);
      return count;
    };
    const auto sink = [&](std::span<const Point>, std::span<const MapResult> results,
                          std::span<const Certificate> certificates) {
      for (const MapResult& result : results) rows.distances.push_back(result.distance);
      rows.certificates.insert(rows.certificates.end(), certificates.begin(), certificates.end());
    };
    if (certified->map(source, sink).interrupted) return std::nullopt;
    return rows;
  }

  /// The solid lies in {v·x <= h(v)}, so that sd(p + y) >= (v·p − h(v) + v·y) / |v|.
  [[nodiscard]] double lower_end(const DisplacedPoint& places, const Point& point,
                                 const Certificate& certificate) const {
    double best = -infinity;
    for (const Normal& normal : certificate.normals) {
      const verify::Proposal v{normal.vector[0], normal.vector[1], normal.vector[2]};
      if (!verify::usable(v)) continue;
      const verify::Vector3<double> against = -outward(posed.motion().rotation * verify::precise(v));
      const double length_down = length(against).lower();
      if (!(length_down > 0.0)) continue;
      const Interval loss = Interval(places.support(against)) / Interval(length_down);
      best = std::max(best, (Interval(posed.lower_by_normal(point, v)) - loss).lower());
    }
    return best;
  }

  verify::PosedSuperquadric posed;
  std::unique_ptr<ExactMap<Point>> certified;  ///< proposes directions
  std::unique_ptr<ExactMap<Point>> distances;
};

ConvexPoseRows::ConvexPoseRows(const Model& model, const PoseUncertainty& bounds, const MapOptions& options)
    : bounds_(bounds) {
  for (const Primitive& primitive : model.primitives) solids_.emplace_back(primitive, without_uncertainty(options));
}

ConvexPoseRows::~ConvexPoseRows() = default;
ConvexPoseRows::ConvexPoseRows(ConvexPoseRows&&) noexcept = default;
ConvexPoseRows& ConvexPoseRows::operator=(ConvexPoseRows&&) noexcept = default;

namespace {

/// Of each point the solid whose nominal distance is smallest.
std::vector<std::size_t> nearest_solids(const std::vector<RowsOfSolid>& nominal, std::size_t count) {
  std::vector<std::size_t> nearest(count);
  for (std::size_t k = 1; k < nominal.size(); ++k) {
    for (std::size_t i = 0; i < count; ++i) {
      if (nominal[k].distances[i].hi < nominal[nearest[i]].distances[i].hi) nearest[i] = k;
    }
  }
  return nearest;
}

/// The largest upper end at the corners about each of the points; nothing: interrupted.
std::optional<std::vector<double>> upper_ends(ExactMap<Point>& distances,
                                              std::span<const DisplacedPoint* const> places) {
  std::vector<Point> corners;
  corners.reserve(places.size() * DisplacedPoint::cover_size);
  for (const DisplacedPoint* of : places) of->append_cover(corners);
  std::vector<MapResult> rows(corners.size());
  if (distances.map_in_memory(corners, rows).interrupted) return std::nullopt;
  std::vector<double> ends;
  ends.reserve(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    double largest = -infinity;
    for (const MapResult& row : std::span(rows).subspan(i * DisplacedPoint::cover_size, DisplacedPoint::cover_size)) {
      largest = std::max(largest, row.distance.hi);
    }
    // 1-Lipschitz: by no more than the hull of the corners misses.
    ends.push_back((Interval(largest) + Interval(places[i]->cover_error())).upper());
  }
  return ends;
}

}  // namespace

std::vector<Enclosure> ConvexPoseRows::operator()(std::span<const Point> points) {
  std::vector<DisplacedPoint> places;
  places.reserve(points.size());
  for (const Point& point : points) places.emplace_back(bounds_, point);
  std::vector<RowsOfSolid> nominal;
  for (Solid& solid : solids_) {
    std::optional<RowsOfSolid> rows = solid.at_nominal_pose(points);
    if (!rows) return {};
    nominal.push_back(std::move(*rows));
  }
  const std::vector<std::size_t> nearest = nearest_solids(nominal, points.size());

  std::vector<Enclosure> result(points.size(), {infinity, infinity});
  in_parallel(points.size(), [&](std::size_t i) {
    for (std::size_t k = 0; k < solids_.size(); ++k) {
      const double by_reach = (Interval(nominal[k].distances[i].lo) - Interval(places[i].reach())).lower();
      const bool too_far_to_matter = by_reach >= nominal[nearest[i]].distances[i].hi;
      const double end =
          too_far_to_matter
              ? by_reach
              : std::max(by_reach, solids_[k].lower_end(places[i], points[i], nominal[k].certificates[i]));
      result[i].lo = std::min(result[i].lo, end);
    }
    // In a union a point may lie deeper than in each of the solids.
    if (solids_.size() > 1 && result[i].lo <= 0.0) result[i].lo = -infinity;
  });

  for (std::size_t k = 0; k < solids_.size(); ++k) {
    std::vector<std::size_t> which;
    std::vector<const DisplacedPoint*> of_solid;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (nearest[i] != k) continue;
      which.push_back(i);
      of_solid.push_back(&places[i]);
    }
    if (which.empty()) continue;
    const auto ends = upper_ends(*solids_[k].distances, of_solid);
    if (!ends) return {};
    for (std::size_t j = 0; j < which.size(); ++j) result[which[j]].hi = (*ends)[j];
  }
  return result;
}

}  // namespace verisq
