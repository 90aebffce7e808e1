/// What an equilibrium consists of, by name, and what is known of many of them together: for any type of interval.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "verify/equilibrium/standing_model.hpp"
#include "verify/numbers/interval.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// Over a box of parameters.
template <class Interval>
struct EquilibriumRanges {
  std::vector<Interval> unknowns;      ///< the reference point's height, then the joints sought
  std::vector<Interval> penetrations;  ///< of all points
  std::vector<Interval> forces;        ///< of all cylinders
  Interval pressure_x, pressure_z;     ///< the centre of pressure
  Interval height_of_root;             ///< its translation along y
  std::vector<Interval> torques;       ///< of all joints, 0 of the root's
};

/// Of a list of these numbers, one after the other.
template <class Interval>
[[nodiscard]] EquilibriumRanges<Interval> named(std::span<const Interval> list, std::size_t unknowns,
                                                const stance::Model& model) {
  std::size_t next = 0;
  const auto take = [&](std::size_t count) {
    const std::span<const Interval> part = list.subspan(next, count);
    next += count;
    return std::vector<Interval>(part.begin(), part.end());
  };
  EquilibriumRanges<Interval> result;
  result.unknowns = take(unknowns);
  result.penetrations = take(stance::points_of_cylinder * model.cylinders.size());
  result.forces = take(model.cylinders.size());
  result.pressure_x = list[next++];
  result.pressure_z = list[next++];
  result.height_of_root = list[next++];
  result.torques = take(model.degrees_of_freedom());
  return result;
}

constexpr Enclosure nothing_yet{infinity, -infinity};    ///< of no numbers
constexpr Enclosure nothing_known{-infinity, infinity};  ///< of any

/// `number` wherever an equilibrium leaves something open; all joints but those sought are where the file has them.
[[nodiscard]] stance::Standing uniform(const stance::Model& model, std::span<const std::size_t> sought,
                                       const Enclosure& number);

[[nodiscard]] inline Enclosure outward(const Interval& a) {
  return {a.lower(), a.upper()};
}
[[nodiscard]] inline Enclosure outward(const PreciseInterval& a) {
  return {a.lower().to_double(Direction::down), a.upper().to_double(Direction::up)};
}

/// join(what is known of others, what is found), number by number.
template <class AnyInterval, class Join>
void add(stance::Standing& sum, const stance::Model& model, std::span<const std::size_t> sought,
         const EquilibriumRanges<AnyInterval>& ranges, const Join& join) {
  const auto to = [&](Enclosure& number, const AnyInterval& range) { number = join(number, outward(range)); };
  for (std::size_t i = 0; i < sought.size(); ++i) to(sum.positions[sought[i]], ranges.unknowns[i + 1]);
  to(sum.positions[height_of_root(model)], ranges.height_of_root);
  for (std::size_t i = 0; i < ranges.torques.size(); ++i) to(sum.torques[i], ranges.torques[i]);
  AnyInterval least = ranges.penetrations.front();
  for (std::size_t i = 0; i < ranges.penetrations.size(); ++i) {
    const AnyInterval& penetration = ranges.penetrations[i];
    to(sum.loads[i / stance::points_of_cylinder].penetration, penetration);
    least = {std::min(least.lower(), penetration.lower()), std::min(least.upper(), penetration.upper())};
  }
  for (std::size_t c = 0; c < ranges.forces.size(); ++c) to(sum.loads[c].force, ranges.forces[c]);
  to(sum.least_penetration, least);
  to(sum.centre_of_pressure_x, ranges.pressure_x);
  to(sum.centre_of_pressure_z, ranges.pressure_z);
}

}  // namespace verisq::verify
