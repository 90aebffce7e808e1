/// Hunt-Crossley contact of a cylinder with the ground y = 0 (docs/stance.md §4), over double, Interval and Dual.
#pragma once

#include "verify/stance/contact_damping.hpp"
#include "verify/stance/spatial.hpp"

namespace verisq::stance {

/// Where a cylinder touches the ground, in world coordinates, m.
template <class T>
struct ContactGeometry {
  T penetration;     ///< of the cylinder's lowest point below the ground; negative above it
  Vector3<T> point;  ///< the lowest point; over intervals that allow several, the area of all of them
};

namespace contact_details {

/// numerator / s in [-1, 1], for 0 <= |numerator| <= s: where s may be 0, the cylinder stands and any direction is
/// lowest. A double standing cylinder gets the centre of its base.
template <class T>
[[nodiscard]] T direction_component(const T& numerator, const T& s) {
  return certainly_less(T(0), s) ? clamp(T(numerator / s), T(-1), T(1)) : either(T(-1), T(1));
}
/// Its derivatives become infinite as the cylinder comes to stand; std::domain_error where it does stand.
template <class T, std::size_t N>
[[nodiscard]] Dual<T, N> direction_component(const Dual<T, N>& numerator, const Dual<T, N>& s) {
  return numerator / s;
}

template <class T>
[[nodiscard]] T power(const T& base, double exponent) {
  return pow(base, T(exponent));
}
/// A constant exponent: differentiable at base 0.
template <class T, std::size_t N>
[[nodiscard]] Dual<T, N> power(const Dual<T, N>& base, double exponent) {
  return pow(base, T(exponent));
}

}  // namespace contact_details

/// Preconditions: `axis` of length 1, radius and half-length not negative.
template <class T>
[[nodiscard]] ContactGeometry<T> contact_geometry(const Vector3<T>& centre, const Vector3<T>& axis, const T& radius,
                                                  const T& half_length) {
  // Rounding may leave an axis a little longer than 1: of 1 - a_y^2 only the part that is not negative is possible.
  const T s = sqrt(max(T(T(1) - square(axis[1])), T(0)));
  const T towards_base = half_length * sgn(axis[1]);
  ContactGeometry<T> contact;
  contact.penetration = radius * s + half_length * abs(axis[1]) - centre[1];
  // (r/s)(y - a_y a) by components: that along y is r (1 - a_y^2)/s = r s, and sgn(a_y) a_y = |a_y|.
  contact.point[1] = -contact.penetration;
  for (const int k : {0, 2}) {
    contact.point[k] =
        centre[k] + radius * contact_details::direction_component(T(axis[1] * axis[k]), s) - towards_base * axis[k];
  }
  return contact;
}

/// The law F_n = k delta_+^n max(0, 1 + D delta'/v_N).
template <class T>
struct HuntCrossley {
  T stiffness;        ///< k, N / m^n
  double exponent;    ///< n >= 1
  T damping;          ///< D, see damping_factor()
  T impact_velocity;  ///< v_N > 0, m/s
};

/// N, never negative; 0 without penetration. `rate` is delta', m/s.
template <class T>
[[nodiscard]] T normal_force(const HuntCrossley<T>& law, const T& penetration, const T& rate) {
  const auto clear = [](const T&) { return T(0); };
  const auto pressed = [&](const T& delta) {
    const T damped = max(T(T(1) + law.damping * rate / law.impact_velocity), T(0));
    return T(law.stiffness * contact_details::power(delta, law.exponent) * damped);
  };
  return piecewise(penetration, 0.0, clear, pressed);
}

}  // namespace verisq::stance
