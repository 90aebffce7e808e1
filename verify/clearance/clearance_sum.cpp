/// What one more row adds to a report.
#include "verify/clearance/clearance_sum.hpp"

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

/// Of the numbers, the least that at least `percent` of them do not exceed: the nearest rank. Precondition: not empty.
double percentile(std::vector<double> numbers, std::size_t percent) {
  const std::size_t rank = (numbers.size() * percent + 99) / 100;
  const auto place = numbers.begin() + static_cast<std::ptrdiff_t>(rank) - 1;
  std::ranges::nth_element(numbers, place);
  return *place;
}

Enclosure rounded_outward(const PreciseInterval& value) {
  return {value.lower().to_double(Direction::down), value.upper().to_double(Direction::up)};
}

}  // namespace

void ClearanceSum::Distances::add(const Enclosure& distance) {
  sum += PreciseInterval(Real(distance.lo), Real(distance.hi));
  lower.push_back(distance.lo);
  upper.push_back(distance.hi);
}

/// Ranks rise with every number that they are of: that of the lower ends is no more than that of the distances.
void ClearanceSum::Distances::tell(AreaClearance& area) const {
  if (lower.empty()) return;
  area.mean_distance = rounded_outward(sum / PreciseInterval(Real(static_cast<double>(lower.size()))));
  area.median_distance = {percentile(lower, 50), percentile(upper, 50)};
  area.distance_of_95 = {percentile(lower, 95), percentile(upper, 95)};
}

ClearanceSum::ClearanceSum(std::span<const Area> areas, std::span<const std::uint32_t> area_of, const Fitness& fitness,
                           double penetration_limit)
    : area_of_(area_of), fitness_(fitness), penetration_limit_(penetration_limit), distances_(areas.size()) {
  clearance_.smallest_distance = nothing;
  for (const Area& area : areas) clearance_.areas.push_back({.area = area, .smallest_distance = nothing});
}

void ClearanceSum::add(std::span<const MapResult> rows) {
  for (const MapResult& row : rows) add(row.distance);
}

void ClearanceSum::add(const Enclosure& distance) {
  const std::uint32_t index = area_of_[points_++];
  AreaClearance& area = clearance_.areas[index];
  distances_[index].add(distance);
  // A weight of 0 keeps even an unbounded value out of the sum: 0 times an infinite bound is 0 (rounding.hpp).
  const Enclosure served = value(fitness_, distance);
  objective_ += PreciseInterval(Real(area.area.weight)) * PreciseInterval(Real(served.lo), Real(served.hi));
  count(area, distance, fitness_.serves);
  clearance_.smallest_distance = minimum(clearance_.smallest_distance, distance);
  if (distance.hi < -penetration_limit_) ++clearance_.proven_too_deep;
  if (distance.lo >= -penetration_limit_) ++clearance_.proven_shallow;
}

Clearance ClearanceSum::report() const {
  Clearance report = clearance_;
  for (std::size_t index = 0; index < report.areas.size(); ++index) distances_[index].tell(report.areas[index]);
  report.objective = rounded_outward(objective_);
  report.deepest_penetration = {std::max(0.0, -report.smallest_distance.hi),
                                std::max(0.0, -report.smallest_distance.lo)};
  return report;
}

}  // namespace verisq
