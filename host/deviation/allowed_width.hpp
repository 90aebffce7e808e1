/// How wide the enclosures of a deviation may be.
#pragma once

#include <algorithm>

#include "verisq/deviation.hpp"

namespace verisq {

/// Of the bounding radius: no narrower enclosure is ever asked of a result.
inline constexpr double finest_share = 1e-6;
/// Of the width allowed: how wide samples may be where tight ones are searched for.
inline constexpr double share_of_samples = 0.05;

/// Of one with this size, of a model of this bounding radius.
[[nodiscard]] inline double allowed_width(double size, const DeviationOptions& options, double bounding_radius) {
  if (options.tolerance) return *options.tolerance;
  return std::max(options.relative_tolerance * size, finest_share * bounding_radius);
}

}  // namespace verisq
