/// One equilibrium for each parameter of a box, by Krawczyk's operator at 127 bits, and the ranges of what it consists
/// of (docs/stance.md §7).
#pragma once

#include <optional>
#include <span>

#include "verify/equilibrium/equilibrium_ranges.hpp"
#include "verify/equilibrium/standing_body.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

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
