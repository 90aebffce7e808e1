/// One equilibrium for each parameter of a box, by Krawczyk's operator at 127 bits, and the ranges of what it consists
/// of (docs/stance.md §7).
#pragma once

#include <optional>
#include <span>

#include "verify/equilibrium/precise_box.hpp"
#include "verify/equilibrium/standing_body.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// Ranges over all parameters of a box.
struct EquilibriumRanges {
  PreciseBox unknowns;
  PreciseBox penetrations;  ///< of all points, two a cylinder
  PreciseBox forces;        ///< of all cylinders
  PreciseInterval pressure_x, pressure_z;
  PreciseInterval height_of_root;
  PreciseBox torques;  ///< of all joints
};

struct ProvenBox {
  EquilibriumRanges ranges;  ///< over the box
  EquilibriumRanges some;    ///< of one parameter of it, its middle
};

/// Where it is proven that for all uncertain parameters in these ranges, all others being nominal, exactly one posture
/// of `postures` is an equilibrium, and that in it all points press. Preconditions: finite ranges, one of each
/// uncertain parameter; postures of each unknown.
[[nodiscard]] std::optional<ProvenBox> equilibrium_on(const StandingBody& body, std::span<const Enclosure> parameters,
                                                      std::span<const Enclosure> postures);

}  // namespace verisq::verify
