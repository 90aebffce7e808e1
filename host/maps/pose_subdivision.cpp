/// All points' boxes are halved together, so that a device gets the centres of thousands at once.
#include "host/maps/pose_subdivision.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "verify/numbers/interval.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/placement/displaced_point.hpp"

namespace verisq {
namespace {

using verify::DisplacedPoint;
using verify::Interval;

/// A box of places, of one point.
struct PlaceBox {
  std::uint32_t point;
  Point centre;
  std::array<double, 3> half;
};

double half_diagonal(const PlaceBox& box) {
  return length(verify::Vector3<double>(box.half[0], box.half[1], box.half[2])).upper();
}

/// One of eight that cover the box: the half edge grows by what the centre is rounded by.
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

/// What is known of one point's distances.
struct Extremes {
  Enclosure settled{infinity, -infinity};  ///< of boxes that are divided no further
  double low_seen = infinity;              ///< the smallest distance is hardly more
  double high_seen = -infinity;            ///< the largest is hardly less
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
  /// Centres need not be places themselves: what is seen there says only where to look.
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
