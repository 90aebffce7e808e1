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

// The requirements on a model of human stance, so that it can stand on the ground, and the joints that an equilibrium
// leaves open.

/// The number of points of Gauss's rule on a cylinder's axis; the cylinder presses with half of its stiffness at each.
constexpr std::size_t points_of_cylinder = 2;

/// Throws Error(input) for a model without cylinders, with a horizontal applied force, or with a controller of the
/// root. Also throws unless the root is first translated and then turned about x and z.
void require_standing_model(const Model& model);

/// The joints whose positions are sought: the root's rotations about x and z, then, with proportional control, the
/// joints of all other bodies. Precondition: a standing model.
[[nodiscard]] std::vector<std::size_t> sought_joints(const Model& model, JointControl control);

/// The index of the root's translation along y: an equilibrium leaves it open, too. Precondition: a standing model.
[[nodiscard]] std::size_t height_of_root(const Model& model);

/// The stiffness with which controllers turn each joint; 0 for a joint without a controller.
[[nodiscard]] std::vector<double> stiffness_of_joints(const Model& model);

/// The index, among all joints, of a body's joint.
[[nodiscard]] std::size_t joint_index(const Model& model, std::size_t body, std::size_t joint);

}  // namespace verisq::stance

namespace verisq::verify {

// The parts of an equilibrium, by name, and the joint ranges of many equilibria: for any type of interval.

/// The ranges of an equilibrium's parts over a box of parameters.
template <class Interval>
struct EquilibriumRanges {
  std::vector<Interval> unknowns;      ///< the reference point's height, then the joints sought
  std::vector<Interval> penetrations;  ///< of all points
  std::vector<Interval> forces;        ///< of all cylinders
  Interval pressure_x, pressure_z;     ///< the centre of pressure
  Interval height_of_root;             ///< its translation along y
  std::vector<Interval> torques;       ///< of all joints, 0 for the root's joints
};

/// The named ranges from a list of these numbers, one after the other.
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

constexpr Enclosure nothing_yet{infinity, -infinity};    ///< an enclosure of no numbers
constexpr Enclosure nothing_known{-infinity, infinity};  ///< an enclosure of any numbers

/// `number` wherever an equilibrium leaves something open; all joints but those sought are where the file has them.
[[nodiscard]] stance::Standing uniform(const stance::Model& model, std::span<const std::size_t> sought,
                                       const Enclosure& number);

[[nodiscard]] inline Enclosure outward(const Interval& a) {
  return {a.lower(), a.upper()};
}
[[nodiscard]] inline Enclosure outward(const PreciseInterval& a) {
  return {a.lower().to_double(Direction::down), a.upper().to_double(Direction::up)};
}

/// Sets each number to join(the number so far, the found range).
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

// Proves one equilibrium for each parameter of a box, by Krawczyk's operator at 127 bits, and the ranges of the
// equilibrium's parts (docs/stance.md §7).

struct ProvenBox {
  EquilibriumRanges<PreciseInterval> ranges;  ///< over the box
  EquilibriumRanges<PreciseInterval> some;    ///< for one parameter of the box, its middle
};

/// The result if the following is proven, else nothing. For all uncertain parameters in these ranges, all others being
/// nominal, exactly one posture of `postures` is an equilibrium, and in it all points press. Preconditions: finite
/// ranges, one for each uncertain parameter; `postures` has one range for each unknown.
[[nodiscard]] std::optional<ProvenBox> equilibrium_on(const StandingBody& body, std::span<const Enclosure> parameters,
                                                      std::span<const Enclosure> postures);

}  // namespace verisq::verify
