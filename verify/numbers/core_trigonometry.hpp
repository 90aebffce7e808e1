/// Sine, cosine and arc tangent of thin intervals, by MPFR.
#pragma once

#include "verify/numbers/interval.hpp"

namespace verisq::verify {

/// For thin intervals: the result is the value at the angle's lower end, widened by the width of the angle.
[[nodiscard]] PreciseInterval sine_of(const PreciseInterval& angle);
[[nodiscard]] PreciseInterval cosine_of(const PreciseInterval& angle);

[[nodiscard]] PreciseInterval arctangent_of(const PreciseInterval& a);

/// sin(a)/a and atan(a)/a, 1 at a = 0: without cancellation.
[[nodiscard]] PreciseInterval quotient_of_sine(const PreciseInterval& a);
[[nodiscard]] PreciseInterval quotient_of_arctangent(const PreciseInterval& a);

/// Exact at multiples of 90. Precondition: finite.
[[nodiscard]] PreciseInterval sine_of_degrees(double degrees);
[[nodiscard]] PreciseInterval cosine_of_degrees(double degrees);

[[nodiscard]] PreciseInterval half_turn();  ///< pi

}  // namespace verisq::verify
