/// Checks of where a body stands.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>
#include <verisq/stance_equilibrium.hpp>

#include "verify/numbers/interval.hpp"
#include "verify/proof/body_at_rest.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::stance {

// What a model of human stance must be to stand on the ground, and which of its joints an equilibrium leaves open.

/// Of Gauss's rule on a cylinder's axis, which presses with half of its stiffness at each.
constexpr std::size_t points_of_cylinder = 2;

/// Throws Error(input): without cylinders, without a root that first is translated and then turned about x and z, with
/// a horizontal applied force, with a controller of the root.
void require_standing_model(const Model& model);

/// Whose positions are sought: the root's rotations about x and z, then, with proportional control, those of all other
/// bodies. Precondition: a standing model.
[[nodiscard]] std::vector<std::size_t> sought_joints(const Model& model, JointControl control);

/// Along y: an equilibrium leaves it open, too. Precondition: a standing model.
[[nodiscard]] std::size_t height_of_root(const Model& model);

/// Of all joints, as their controllers turn them; 0 where none acts.
[[nodiscard]] std::vector<double> stiffness_of_joints(const Model& model);

/// Of a body's joint among all.
[[nodiscard]] std::size_t joint_index(const Model& model, std::size_t body, std::size_t joint);

}  // namespace verisq::stance

namespace verisq::verify {

// What an equilibrium consists of, by name, and what is known of many of them together: for any type of interval.

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

// One equilibrium for each parameter of a box, by Krawczyk's operator at 127 bits, and the ranges of what it consists
// of (docs/stance.md §7).

struct ProvenBox {
  EquilibriumRanges<PreciseInterval> ranges;  ///< over the box
  EquilibriumRanges<PreciseInterval> some;    ///< of one parameter of it, its middle
};

/// Where it is proven that for all uncertain parameters in these ranges, all others being nominal, exactly one posture
/// of `postures` is an equilibrium, and that in it all points press. Preconditions: finite ranges, one of each
/// uncertain parameter; postures of each unknown.
[[nodiscard]] std::optional<ProvenBox> equilibrium_on(const StandingBody& body, std::span<const Enclosure> parameters,
                                                      std::span<const Enclosure> postures);

}  // namespace verisq::verify
