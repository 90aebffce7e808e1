/// Something made of each of the models that bracket an uncertain one.
#pragma once

#include <algorithm>
#include <optional>
#include <type_traits>

#include "verisq/uncertain_model.hpp"

namespace verisq::verify {

/// Whether `largest` is `smallest`: at most the translations are uncertain.
[[nodiscard]] inline bool same_solids(const Bracket& models) {
  return std::ranges::equal(models.smallest.primitives, models.largest.primitives,
                            [](const Primitive& x, const Primitive& y) {
                              return x.superquadric.semi_axes == y.superquadric.semi_axes &&
                                     x.superquadric.exponents == y.superquadric.exponents;
                            });
}

/// As verisq::bracket, but that what a tree removes is as small in `smallest` as the rest: right of unions.
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

}  // namespace verisq::verify
