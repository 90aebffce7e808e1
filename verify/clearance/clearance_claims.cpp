/// The same sums over proven distances, compared with what is claimed.
#include <algorithm>

#include "verify/clearance/clearance_sum.hpp"
#include "verify/proof/judgement.hpp"
#include "verisq/clearance_claim.hpp"

namespace verisq {
namespace {

/// Of `points`, as many as are proven to be of a kind at least, and but for those that are proven not to be at most.
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

}  // namespace verisq
