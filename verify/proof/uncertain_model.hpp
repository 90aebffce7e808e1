/// Uncertain models: the two bracketing models between which every member lies, and bounds of the members' distances.
#pragma once

#include <algorithm>
#include <optional>
#include <type_traits>

#include "verisq/model.hpp"

namespace verisq::verify {

// Something made of each of the models that bracket an uncertain one.

/// Returns whether `largest` has the solids of `smallest`: at most the translations are uncertain.
[[nodiscard]] inline bool same_solids(const Bracket& models) {
  return std::ranges::equal(models.smallest.primitives, models.largest.primitives,
                            [](const Primitive& x, const Primitive& y) {
                              return x.superquadric.semi_axes == y.superquadric.semi_axes &&
                                     x.superquadric.exponents == y.superquadric.exponents;
                            });
}

/// Like verisq::bracket, but in `smallest` a removed part of the set tree is as small as the rest: valid for unions.
[[nodiscard]] Bracket bracket_of_primitives(const UncertainModel& model);

template <class T>
struct Bracketed {
  T smallest;
  std::optional<T> largest;   ///< nothing: the solids are those of `smallest`, which serves for both
  std::optional<T> inflated;  ///< only where the bracket has one

  [[nodiscard]] const T& of_largest() const { return largest ? *largest : smallest; }
};

/// The first of `smallest`, which upper ends are proven by, the others of the other models.
template <class MakeUpper, class MakeLower>
[[nodiscard]] auto bracketed(const Bracket& models, const MakeUpper& make_upper, const MakeLower& make_lower) {
  using T = std::invoke_result_t<const MakeUpper&, const Model&>;
  Bracketed<T> result{make_upper(models.smallest), std::nullopt, std::nullopt};
  if (!same_solids(models)) result.largest.emplace(make_lower(models.largest));
  if (models.inflated) result.inflated.emplace(make_lower(*models.inflated));
  return result;
}

template <class Make>
[[nodiscard]] auto bracketed(const Bracket& models, const Make& make) {
  return bracketed(models, make, make);
}

// From distances to the bracketing models to bounds that are valid for every member of an uncertain model.

/// Bounds of the distances of every point within `point_radius` of the given one (of every triangle whose corners are)
/// to every member, rounded outward. Bracket states why they are valid. Distances are 1-Lipschitz: each bound is
/// widened by the radius last.
///
/// Or bounds of the distances of every member of A to every member of B; the bracketing models are then pairs of
/// `smallest` and of `largest`. The distance of unions is the least of their primitives' distances, overlapping or not,
/// and a rigid motion of B moves its primitives' shifts along. Let K be a primitive of A, L one of B. Smaller ones are
/// at least as far apart, larger ones at most. Moving K by at most shift_a and L by at most shift_b changes their
/// distance by at most the sum.
class MemberBounds {
 public:
  /// Precondition: `point_radius` is finite and at least 0.
  MemberBounds(const Bracket& bracket, double point_radius);
  MemberBounds(const Bracket& a, const Bracket& b);

  /// Returns whether there is a single member and points are exact: then distances to `smallest` are the answer.
  [[nodiscard]] bool exact() const { return exact_; }

  /// The upper end for all members, from an upper end, proven by one primitive, of the distance to `smallest`.
  [[nodiscard]] double upper(double of_smallest) const;

  /// The largest upper end that `upper` is sure to turn into at most `claimed`.
  [[nodiscard]] double upper_asked_for(double claimed) const;

  /// The lower end for all members, from lower ends of the signed distances to `largest` and to `inflated`.
  /// Precondition: the latter is given if the bracket has such a model.
  [[nodiscard]] double signed_lower(double of_largest, std::optional<double> of_inflated) const;

  /// The lower end for all members, from a lower end of a triangle's distance to `largest`, or of the distance of two
  /// models. The distance of a union is the least of its primitives' distances, overlapping or not.
  [[nodiscard]] double unsigned_lower(double of_largest) const;

 private:
  double shift_;
  double other_shift_;  ///< the shift of points, or of the other model
  bool exact_;
};

}  // namespace verisq::verify
