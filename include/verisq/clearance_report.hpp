/// What proven distances of a bone's points say together: of all of them, and of each area.
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/map_summary.hpp>

namespace verisq {

struct Area {
  std::string name;
  double weight;  ///< of each of its points in the objective; finite, >= 0
  [[nodiscard]] bool operator==(const Area&) const = default;
};

/// Of one area: for how many of its points it is proven that the distance lies in `Fitness::serves`, that it does not,
/// and neither.
struct AreaClearance {
  Area area;
  std::uint64_t points = 0;
  std::uint64_t proven_within = 0;
  std::uint64_t proven_outside = 0;
  std::uint64_t undecided = 0;
  Enclosure smallest_distance;  ///< of its points
  // Of the signed distances of its points, each point counting once; undefined for an area without points.
  Enclosure mean_distance{};
  Enclosure median_distance{};  ///< no more than half of them are farther, no more than half nearer
  Enclosure distance_of_95{};   ///< so near are at least 95 % of them, by the nearest rank
};

/// Of all points; `map` is of the map that found their distances.
struct Clearance {
  MapSummary map;
  Enclosure objective;                ///< F of Eq. (4)
  Enclosure smallest_distance;        ///< signed, of all points: negative where bone lies inside the implant
  Enclosure deepest_penetration;      ///< of a point of the cavity; [0, 0] where every point is proven outside
  std::uint64_t proven_too_deep = 0;  ///< points proven deeper inside than the limit
  std::uint64_t proven_shallow = 0;   ///< points proven no deeper than the limit; the rest is undecided
  std::vector<AreaClearance> areas;   ///< as in the cavity
};

}  // namespace verisq
