/// The distances to models of uncertain pose of uncertain_map.hpp.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "host/maps/map_run.hpp"
#include "host/maps/uncertain_map.hpp"
#include "host/threads/parallel.hpp"
#include "verify/numbers/interval.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/search/displaced_point.hpp"

namespace verisq {
namespace {

using verify::DisplacedPoint;
using verify::Interval;

/// The rows of one solid at its nominal pose.
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

  /// Nothing if interrupted.
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
      if (!verify::usable({normal.vector[0], normal.vector[1], normal.vector[2]})) continue;
      const Point direction = verify::near_one(normal.vector);  // of short ones squares would vanish
      const verify::Proposal v{direction[0], direction[1], direction[2]};
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

/// For each point, the solid whose nominal distance is smallest.
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

namespace {

using verify::DisplacedPoint;
using verify::Interval;

/// A box of places of one point.
struct PlaceBox {
  std::uint32_t point;
  Point centre;
  std::array<double, 3> half;
};

double half_diagonal(const PlaceBox& box) {
  return length(verify::Vector3<double>(box.half[0], box.half[1], box.half[2])).upper();
}

/// One of eight that cover the box: the half edge grows by the rounding of the centre.
PlaceBox octant(const PlaceBox& box, unsigned which) {
  PlaceBox part = box;
  for (std::size_t i = 0; i < 3; ++i) {
    const Interval quarter = Interval(box.half[i]) / Interval(2);
    const Interval centre = Interval(box.centre[i]) + ((which >> i & 1U) != 0 ? quarter : -quarter);
    part.centre[i] = centre.lower();
    part.half[i] = (quarter + (Interval(centre.upper()) - Interval(centre.lower()))).upper();
  }
  return part;
}

/// The known bounds of one point's distances.
struct Extremes {
  Enclosure settled{infinity, -infinity};  ///< bounds over the boxes that are divided no further
  double low_seen = infinity;              ///< the smallest distance is hardly larger
  double high_seen = -infinity;            ///< the largest distance is hardly smaller
  bool by_device = true;
};

class Subdivision {
 public:
  Subdivision(const PoseUncertainty& bounds, std::span<const Point> points) : extremes_(points.size()) {
    places_.reserve(points.size());
    for (const Point& point : points) places_.emplace_back(bounds, point);
    for (std::size_t i = 0; i < points.size(); ++i) {
      boxes_.push_back({static_cast<std::uint32_t>(i), points[i], places_[i].half_extent()});
    }
  }

  /// False: interrupted.
  [[nodiscard]] bool evaluate(const NominalRows& rows) {
    std::vector<Point> centres;
    centres.reserve(boxes_.size());
    for (const PlaceBox& box : boxes_) centres.push_back(box.centre);
    rows_.resize(boxes_.size());
    if (!rows(centres, rows_)) return false;
    for (std::size_t k = 0; k < boxes_.size(); ++k) look_at(boxes_[k], rows_[k]);
    return true;
  }

  /// Settles the boxes that hold neither end; halves the others.
  void divide() {
    std::vector<PlaceBox> parts;
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      Extremes& known = extremes_[boxes_[k].point];
      const Enclosure distances = distances_in(k);
      if (distances.lo >= known.low_seen && distances.hi <= known.high_seen) {
        settle(known, distances);
        continue;
      }
      for (unsigned which = 0; which < 8; ++which) {
        const PlaceBox part = octant(boxes_[k], which);
        if (!places_[part.point].avoids(part.centre, half_diagonal(part))) parts.push_back(part);
      }
    }
    boxes_ = std::move(parts);
  }

  [[nodiscard]] std::vector<MapResult> results() {
    for (std::size_t k = 0; k < boxes_.size(); ++k) settle(extremes_[boxes_[k].point], distances_in(k));
    std::vector<MapResult> results;
    results.reserve(extremes_.size());
    for (const Extremes& known : extremes_) {
      results.push_back({known.settled, known.by_device ? Status::device_verified : Status::host_verified});
    }
    return results;
  }

 private:
  /// Centres need not be places themselves: their distances only guide the search.
  void look_at(const PlaceBox& box, const MapResult& row) {
    Extremes& known = extremes_[box.point];
    known.by_device = known.by_device && row.status == Status::device_verified;
    if (places_[box.point].avoids(box.centre, 0.0)) return;
    known.low_seen = std::min(known.low_seen, row.distance.hi);
    known.high_seen = std::max(known.high_seen, row.distance.lo);
  }

  /// Distances are 1-Lipschitz.
  [[nodiscard]] Enclosure distances_in(std::size_t k) const {
    const Interval reach(half_diagonal(boxes_[k]));
    const Enclosure& at_centre = rows_[k].distance;
    return {(Interval(at_centre.lo) - reach).lower(), (Interval(at_centre.hi) + reach).upper()};
  }

  static void settle(Extremes& known, const Enclosure& distances) {
    known.settled = {std::min(known.settled.lo, distances.lo), std::max(known.settled.hi, distances.hi)};
  }

  std::vector<DisplacedPoint> places_;
  std::vector<Extremes> extremes_;
  std::vector<PlaceBox> boxes_;
  std::vector<MapResult> rows_;
};

}  // namespace

std::vector<MapResult> subdivided(const PoseUncertainty& bounds, unsigned divisions, std::span<const Point> points,
                                  const NominalRows& rows, const std::function<bool()>& enough) {
  Subdivision subdivision(bounds, points);
  if (!subdivision.evaluate(rows)) return {};
  for (unsigned parts = 2; parts <= divisions && !enough(); parts *= 2) {
    subdivision.divide();
    if (!subdivision.evaluate(rows)) return {};
  }
  return subdivision.results();
}

}  // namespace verisq
