/// Enclosures of trigonometric functions by MPFR: sin, cos, atan and the even quotients that stay accurate at 0.
#pragma once

#include "verify/numbers/interval.hpp"

namespace verisq::verify {

// Templates over the type of the ends: double or Real. Nothing here throws.

/// The extrema within the interval are counted, not assumed; beyond 2^60, or where the interval is wide, [-1, 1].
template <class T>
[[nodiscard]] BasicInterval<T> sin(const BasicInterval<T>& angle);
template <class T>
[[nodiscard]] BasicInterval<T> cos(const BasicInterval<T>& angle);

template <class T>
[[nodiscard]] BasicInterval<T> atan(const BasicInterval<T>& a);

/// sin(a)/a, 1 at a = 0: without cancellation or division by 0.
template <class T>
[[nodiscard]] BasicInterval<T> sine_quotient(const BasicInterval<T>& a);

/// atan(a)/a, 1 at a = 0: even, between 0 and 1, falling with |a|.
template <class T>
[[nodiscard]] BasicInterval<T> arctangent_quotient(const BasicInterval<T>& a);

/// The angles in (-pi, pi] of all points (x, y) of two intervals, from the positive x axis: [-pi, pi] where they meet
/// the cut, the negative x axis, from below; within [0, pi] for y >= 0. The origin has none; of it alone, [0, pi].
template <class T>
[[nodiscard]] BasicInterval<T> polar_angle(const BasicInterval<T>& x, const BasicInterval<T>& y);

template <class T>
[[nodiscard]] BasicInterval<T> pi();

/// Of an exact angle in degrees: exact at multiples of 90. Precondition: finite.
template <class T>
[[nodiscard]] BasicInterval<T> sin_of_degrees(double degrees);
template <class T>
[[nodiscard]] BasicInterval<T> cos_of_degrees(double degrees);

}  // namespace verisq::verify
