/// Proves how well a posed implant serves a cavity: the certified report of a fit.
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <verisq/cavity.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/fitness.hpp>
#include <verisq/map.hpp>
#include <verisq/model.hpp>

namespace verisq {

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

struct Clearance {
  MapSummary map;
  Enclosure objective;                ///< F of Eq. (4)
  Enclosure smallest_distance;        ///< signed, of all points: negative where bone lies inside the implant
  Enclosure deepest_penetration;      ///< of a point of the cavity; [0, 0] where every point is proven outside
  std::uint64_t proven_too_deep = 0;  ///< points proven deeper inside than the limit
  std::uint64_t proven_shallow = 0;   ///< points proven no deeper than the limit; the rest is undecided
  std::vector<AreaClearance> areas;   ///< as in the cavity
};

/// Maps all points of the cavity against the posed implant (any model) and sums up. The rows go to `sink` as they come.
/// Of an interrupted map the report is of the rows delivered: the first `map.points` of the cavity. Errors as
/// Mapper.
[[nodiscard]] Clearance certified_clearance(const Model& posed, const Cavity& cavity, const Fitness& fitness,
                                            double penetration_limit, const MapOptions& options,
                                            const Sink<Point>& sink);

}  // namespace verisq
