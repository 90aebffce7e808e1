/// What a fit claims of the distances of a bone's vertices, number by number, and what proven distances prove of it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/clearance_report.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/fitness.hpp>

namespace verisq {

/// What the numbers are of: which distances serve, how deep points may lie, and which area each of them is of.
struct ClearanceTerms {
  Fitness fitness;
  double penetration_limit;
  std::vector<Area> areas;
  std::vector<std::uint32_t> area_of;  ///< one a point, an index of `areas`
};

/// `what` is of all points "objective", "smallest_distance", "deepest_penetration", or "points_within_limit" (how many
/// lie no deeper than the limit), or "surface_distance", the smallest distance of all points of the triangles between
/// them, 0 where the surface meets the model; of the points of an area "points_within_band" (how many distances serve),
/// "smallest_distance", "mean_distance", "median_distance", "distance_of_95", as in `AreaClearance`.
struct ClearanceClaim {
  std::string what;
  std::string area;  ///< empty: all points
  Enclosure value;   ///< contains the exact number
};

/// All of them, in this order; none of an area without points, of the surface where `surface` is given.
[[nodiscard]] std::vector<ClearanceClaim> claims_of(const Clearance& clearance,
                                                    const std::optional<Enclosure>& surface = {});

/// What distances that enclose those of the points say together; its `map` is empty. Precondition: as many as `area_of`
/// has points.
[[nodiscard]] Clearance clearance_of(const ClearanceTerms& terms, std::span<const Enclosure> distances);

/// What is proven of each claim by `proven`, the clearance of proven distances, and by `surface`, which encloses that
/// of all points of triangles. Claims of another name or area are unproved, by [-infinity, infinity].
[[nodiscard]] std::vector<Finding> check(std::span<const ClearanceClaim> claims, const Clearance& proven,
                                         const std::optional<Enclosure>& surface = {});

}  // namespace verisq
