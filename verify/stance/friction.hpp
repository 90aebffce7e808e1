/// Friction with a bristle: an elastic force that a velocity-dependent coefficient limits (docs/stance.md §4).
#pragma once

#include "verify/analysis/exponential.hpp"
#include "verify/stance/dual.hpp"

namespace verisq::stance {

/// Coefficients of one contact; none negative. Dynamic friction may exceed static friction (paper, Table 1).
template <class T>
struct FrictionLaw {
  T static_coefficient;      ///< mu_st
  T dynamic_coefficient;     ///< mu_d
  double stribeck_velocity;  ///< v_s > 0, m/s
};

namespace friction_details {

/// at_zero + (at_one - at_zero) weight, for a weight in [0, 1].
template <class T>
[[nodiscard]] T mixed(const T& at_zero, const T& at_one, const T& weight) {
  return at_zero + (at_one - at_zero) * weight;
}
/// Linear in the weight, monotone in the rest: the ends of the weight give the exact range.
[[nodiscard]] inline Interval mixed(const Interval& at_zero, const Interval& at_one, const Interval& weight) {
  const auto at = [&](const Interval& w) { return at_zero * (Interval(1) - w) + at_one * w; };
  return hull(at(weight.lower()), at(weight.upper()));
}

}  // namespace friction_details

/// mu(v) = mu_d + (mu_st - mu_d) exp(-(v/v_s)^2), for the sliding velocity v.
template <class T>
[[nodiscard]] T friction_coefficient(const FrictionLaw<T>& law, const T& velocity) {
  const T weight = exp(-square(T(velocity / T(law.stribeck_velocity))));
  return friction_details::mixed(law.dynamic_coefficient, law.static_coefficient, weight);
}

/// The force of the stretched bristle on the body, N, limited to mu(v) F_n in both directions.
template <class T>
[[nodiscard]] T friction_force(const FrictionLaw<T>& law, const T& normal_force, const T& velocity,
                               const T& bristle_force) {
  const T limit = friction_coefficient(law, velocity) * normal_force;
  return clamp(bristle_force, T(-limit), limit);
}

}  // namespace verisq::stance
