/// From distances to the bracketing models to bounds that hold for every member of an uncertain model.
#pragma once

#include <optional>

#include "verisq/uncertain_model.hpp"

namespace verisq::verify {

/// Bounds of the distances of every point within `point_radius` of the one asked for (of every triangle whose corners
/// are) to every member, rounded outward; why they hold is said at Bracket. Distances are 1-Lipschitz: each bound is
/// widened by the radius last.
class MemberBounds {
 public:
  /// Precondition: `point_radius` is finite and at least 0.
  MemberBounds(const Bracket& bracket, double point_radius);

  /// From an upper end, proven by one primitive, of the distance to `smallest`.
  [[nodiscard]] double upper(double of_smallest) const;

  /// The largest upper end from which `upper` is sure to make at most `claimed`.
  [[nodiscard]] double upper_asked_for(double claimed) const;

  /// From lower ends of the signed distances to `largest` and to `inflated`. Precondition: the latter is given where
  /// the bracket has such a model.
  [[nodiscard]] double signed_lower(double of_largest, std::optional<double> of_inflated) const;

  /// From a lower end of a triangle's distance to `largest`. The distance of a union is the least of its primitives',
  /// overlapping or not.
  [[nodiscard]] double triangle_lower(double of_largest) const;

 private:
  double shift_;
  double point_radius_;
};

}  // namespace verisq::verify
