/// What one more row adds to a report.
#include "host/clearance/clearance_sum.hpp"

#include <algorithm>

#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

using verify::Direction;
using verify::PreciseInterval;
using verify::Real;

/// The smallest distance of no points.
constexpr Enclosure nothing{infinity, infinity};

Enclosure minimum(const Enclosure& a, const Enclosure& b) {
  return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
}

void count(AreaClearance& area, const Enclosure& distance, const Enclosure& serves) {
  ++area.points;
  area.smallest_distance = minimum(area.smallest_distance, distance);
  if (serves.lo <= distance.lo && distance.hi <= serves.hi)
    ++area.proven_within;
  else if (distance.hi < serves.lo || distance.lo > serves.hi)
    ++area.proven_outside;
  else
    ++area.undecided;
}

}  // namespace

ClearanceSum::ClearanceSum(const Cavity& cavity, const Fitness& fitness, double penetration_limit)
    : cavity_(cavity), fitness_(fitness), penetration_limit_(penetration_limit) {
  clearance_.smallest_distance = nothing;
  for (const Area& area : cavity.areas) clearance_.areas.push_back({.area = area, .smallest_distance = nothing});
}

void ClearanceSum::add(std::span<const MapResult> rows) {
  for (const MapResult& row : rows) add(row);
}

void ClearanceSum::add(const MapResult& row) {
  AreaClearance& area = clearance_.areas[cavity_.area_of[rows_++]];
  // A weight of 0 keeps even an unbounded value out of the sum: 0 times an infinite bound is 0 (rounding.hpp).
  const Enclosure served = value(fitness_, row.distance);
  objective_ += PreciseInterval(Real(area.area.weight)) * PreciseInterval(Real(served.lo), Real(served.hi));
  count(area, row.distance, fitness_.serves);
  clearance_.smallest_distance = minimum(clearance_.smallest_distance, row.distance);
  if (row.distance.hi < -penetration_limit_) ++clearance_.proven_too_deep;
  if (row.distance.lo >= -penetration_limit_) ++clearance_.proven_shallow;
}

Clearance ClearanceSum::report() const {
  Clearance report = clearance_;
  report.objective = {objective_.lower().to_double(Direction::down), objective_.upper().to_double(Direction::up)};
  report.deepest_penetration = {std::max(0.0, -report.smallest_distance.hi),
                                std::max(0.0, -report.smallest_distance.lo)};
  return report;
}

}  // namespace verisq
