/// What --tol is where none is given: in proportion to the radius of a bounding sphere.
#pragma once

#include <string_view>

namespace verisq::command_line {

/// What the help writes, and the number that it is.
struct RelativeTolerance {
  std::string_view text;
  double value;
};

/// Of the distances of `map`, `fit` and `distance`.
inline constexpr RelativeTolerance tolerance_of_distances{"1e-6", 1e-6};
/// Of `path` where models are bent or built by set operations: halving it takes 1.4 times the moments.
inline constexpr RelativeTolerance tolerance_of_searched_paths{"1e-4", 1e-4};
/// Of `insert`, whose every distance is searched along a whole way.
inline constexpr RelativeTolerance tolerance_along_ways{"1e-3", 1e-3};

/// Throws Error(input) that asks for a --tol where the radius is too large for a finite one. `owner`: what has this
/// radius, "the model".
[[nodiscard]] double default_tolerance(const RelativeTolerance& relative, double radius, std::string_view owner);

}  // namespace verisq::command_line
