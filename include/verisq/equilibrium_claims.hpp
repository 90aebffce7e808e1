/// What is claimed of where a body stands still on the ground.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/stance_equilibrium.hpp>

namespace verisq::stance {

/// What is claimed, as `equilibrium` finds it.
struct EquilibriumClaims {
  JointControl control;
  std::vector<std::uint32_t> uncertain;  ///< parameters of the model
  std::vector<Enclosure> ranges;         ///< of these: the box; all others are nominal
  double stands;                         ///< at least this share of the box's volume
  std::optional<Standing> standing;      ///< over all of that share; nothing: none is claimed to stand
};

/// One after the other: positions of all joints, torques, loads of the cylinders (force, penetration), the centre of
/// pressure's x and z, the least penetration.
[[nodiscard]] std::vector<Enclosure> numbers_of(const Standing& standing);

}  // namespace verisq::stance
