/// The damping of Hunt-Crossley contact that gives a restitution: D in F = k delta^n (1 + D delta'/v_N)
/// (docs/stance.md §4).
#pragma once

#include "verify/stance/dual.hpp"

namespace verisq::stance {

/// The positive root D of ln((1 + D)/(1 - D e)) = D (1 + e), for all e of `restitution`: without gravity, a body that
/// touches down at v_N rebounds at e v_N, for every exponent n. 0 for e = 1. Tight: adjacent numbers for one e.
/// Throws std::domain_error unless 0 < e <= 1.
[[nodiscard]] Interval damping_factor(const Interval& restitution);

/// The same to nearest, or next to it.
[[nodiscard]] double damping_factor(double restitution);

/// dD/de for a pair of the relation, by the implicit function theorem: -D e (1 + D) / ((1 + e) (e (1 + D) - 1)).
/// Infinite over intervals that reach e = 1.
template <class T>
[[nodiscard]] T damping_slope(const T& restitution, const T& damping) {
  const T one(1);
  return -(damping * restitution * (one + damping)) / ((one + restitution) * (restitution * (one + damping) - one));
}

template <class T, std::size_t N>
[[nodiscard]] Dual<T, N> damping_factor(const Dual<T, N>& restitution) {
  const T damping = damping_factor(restitution.value);
  const T slope = damping_slope(restitution.value, damping);
  Dual<T, N> result(damping);
  for (std::size_t k = 0; k < N; ++k) result.partial[k] = slope * restitution.partial[k];
  return result;
}

}  // namespace verisq::stance
