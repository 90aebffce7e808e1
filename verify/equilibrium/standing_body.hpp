/// The body that is to stand, and by what numbers its postures are told.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "verisq/model.hpp"
#include "verisq/stance_equilibrium.hpp"

namespace verisq::verify {

/// A posture is the reference point's height, and then the positions of the joints sought.
struct StandingBody {
  const stance::Model& model;
  stance::JointControl control;
  std::vector<std::uint32_t> uncertain;  ///< parameters of the model
  Point reference;                       ///< in the root's frame; any will do, ranges are narrow next to the ground
  std::vector<std::size_t> joints;       ///< sought
  std::vector<double> stiffness;         ///< of all joints

  [[nodiscard]] std::size_t unknowns() const { return joints.size() + 1; }
};

/// Throws Error(input) as require_standing_model.
[[nodiscard]] StandingBody standing_body(const stance::Model& model, stance::JointControl control,
                                         stance::UncertainSet uncertain, const Point& reference);

}  // namespace verisq::verify
