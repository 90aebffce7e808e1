/// This file implements clearance_claims.hpp.
#include "verify/proof/clearance_claims.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "verify/numbers/interval.hpp"
#include "verify/proof/verdict.hpp"
#include "verisq/clearance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

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

/// The least number that at least `percent` of the numbers do not exceed: the nearest rank. Precondition: not empty.
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

/// Ranks rise with each of their numbers: the rank of the lower ends is no more than that of the distances.
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

namespace {

/// The number of `points` of a kind: at least those proven to be of it, at most all but those proven not to be of it.
Enclosure number_of(std::uint64_t points, std::uint64_t proven, std::uint64_t proven_not) {
  return {static_cast<double>(proven), static_cast<double>(points - proven_not)};
}

}  // namespace

std::vector<ClearanceClaim> claims_of(const Clearance& clearance, const std::optional<Enclosure>& surface) {
  std::uint64_t points = 0;
  for (const AreaClearance& area : clearance.areas) points += area.points;
  std::vector<ClearanceClaim> claims{
      {"objective", "", clearance.objective},
      {"smallest_distance", "", clearance.smallest_distance},
      {"deepest_penetration", "", clearance.deepest_penetration},
      {"points_within_limit", "", number_of(points, clearance.proven_shallow, clearance.proven_too_deep)}};
  if (surface) claims.push_back({"surface_distance", "", *surface});
  for (const AreaClearance& area : clearance.areas) {
    if (area.points == 0) continue;
    const std::string& name = area.area.name;
    claims.insert(claims.end(),
                  {{"points_within_band", name, number_of(area.points, area.proven_within, area.proven_outside)},
                   {"smallest_distance", name, area.smallest_distance},
                   {"mean_distance", name, area.mean_distance},
                   {"median_distance", name, area.median_distance},
                   {"distance_of_95", name, area.distance_of_95}});
  }
  return claims;
}

Clearance clearance_of(const ClearanceTerms& terms, std::span<const Enclosure> distances) {
  ClearanceSum sum(terms.areas, terms.area_of, terms.fitness, terms.penetration_limit);
  for (const Enclosure& distance : distances) sum.add(distance);
  return sum.report();
}

std::vector<Finding> check(std::span<const ClearanceClaim> claims, const Clearance& proven,
                           const std::optional<Enclosure>& surface) {
  const std::vector<ClearanceClaim> known = claims_of(proven, surface);
  std::vector<Finding> findings;
  for (const ClearanceClaim& claim : claims) {
    const auto same =
        std::ranges::find_if(known, [&](const auto& k) { return k.what == claim.what && k.area == claim.area; });
    if (same == known.end()) {
      findings.push_back({Verdict::unproved, {-infinity, infinity}});  // whatever its ends are: nobody knows of what
    } else {
      findings.push_back(verify::judged(claim.value, same->value, same->value));
    }
  }
  return findings;
}

namespace {

using verify::Direction;
using verify::Interval;

void require(bool holds, const std::string& key, const std::string& wanted, double value) {
  if (holds) return;
  std::ostringstream message;
  message << key << ": must be " << wanted << ", not " << value;
  throw Error(ErrorKind::input, message.str());
}

/// Encloses f at one distance, which is any real number or +infinity.
Interval enclosed_at(const Fitness& fitness, double distance) {
  if (distance == infinity) return {0};  // the limit
  const Interval scale(fitness.scale);
  const Interval serving =
      Interval(1) / (Interval(1) + square((Interval(distance) - Interval(fitness.target)) / scale));
  if (distance >= 0.0) return serving;
  return serving - square(Interval(distance) / scale);
}

}  // namespace

Fitness cementless(double gap, double penetration_limit) {
  require(std::isfinite(gap) && gap > 0.0, "gap", "positive and finite", gap);
  require(std::isfinite(penetration_limit) && penetration_limit >= 0.0, "penetration limit", "finite and at least 0",
          penetration_limit);
  return {0.0, gap, {0.0 - penetration_limit, gap}};  // exact, and 0 is not -0
}

Fitness cemented(double gap, double tolerance) {
  require(std::isfinite(gap) && gap >= 0.0, "gap", "finite and at least 0", gap);
  require(std::isfinite(tolerance) && tolerance > 0.0, "tolerance", "positive and finite", tolerance);
  const double highest = verify::add(gap, tolerance, Direction::down);
  const double lowest = std::min(verify::subtract(gap, tolerance, Direction::up), highest);
  return {gap, tolerance, {lowest, highest}};
}

double value(const Fitness& fitness, double distance) {
  const double apart = (distance - fitness.target) / fitness.scale;
  const double inside = std::min(distance, 0.0) / fitness.scale;
  return 1.0 / (1.0 + apart * apart) - inside * inside;
}

double slope(const Fitness& fitness, double distance) {
  const double apart = (distance - fitness.target) / fitness.scale;
  const double serving = 1.0 / (1.0 + apart * apart);
  const double inside = std::min(distance, 0.0) / fitness.scale;
  // Far away 0 times an infinity is to be 0.
  const double of_serving = serving > 0.0 ? -2.0 * apart * serving * serving : 0.0;
  return (of_serving - 2.0 * inside) / fitness.scale;
}

// f rises up to the target and falls beyond it. With t = target >= 0: the first term of f falls as |d - t| rises. The
// second rises with d and is 0 for d >= 0, hence constant for d >= t. So both rise on d <= t; on d >= t the first falls
// while the second stays 0. Over [lo, hi] the largest value of f is therefore at the number of the interval that is
// nearest to t, the smallest at one of the ends. The three are binary64 numbers, no rounding is needed to find them. f
// <= 1 everywhere; it falls to minus infinity as d does and to 0 as d rises to infinity.
Enclosure value(const Fitness& fitness, const Enclosure& distance) {
  const auto& [lo, hi] = distance;
  if (!(lo <= hi)) return {-infinity, 1.0};  // not an interval: nothing is known of the distance
  if (hi == -infinity) return {-infinity, -infinity};
  const double best = std::clamp(fitness.target, lo, hi);
  const double largest = std::min(enclosed_at(fitness, best).upper(), 1.0);
  if (lo == -infinity) return {-infinity, largest};
  return {std::min(enclosed_at(fitness, lo).lower(), enclosed_at(fitness, hi).lower()), largest};
}

}  // namespace verisq
