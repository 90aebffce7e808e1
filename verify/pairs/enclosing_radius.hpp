/// How far a primitive reaches from a point: it lies in a ball about it.
#pragma once

#include <array>

#include "verify/numbers/vector.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Those of an ellipsoid that contains the solid, along its axes: the solid's, times the most that the norm of exponent
/// 2 exceeds its own by: 2^(1/2 - 1/p) for each p = 2/e > 2. Rounded up. Of a taper nothing is in it.
[[nodiscard]] std::array<double, 3> semi_axes_of_ellipsoid(const Superquadric& solid);

/// At least the largest distance from any point of the box, of the model's frame, to a point of the primitive. Of a
/// ball |x - centre| and its radius; else with the ellipsoid {Σ (xᵢ/bᵢ)² <= 1} about it, for every x in that and
/// every `multiplier` μ > max bᵢ²
///     |x - c|² <= |x - c|² + μ (1 - Σ (xᵢ/bᵢ)²) <= μ + Σ cᵢ² μ / (μ - bᵢ²),
/// coordinate by coordinate the largest value of a parabola. The least of that over μ is exact for the ellipsoid (the
/// S-lemma). Infinite where that says nothing, as for bends and tapers.
[[nodiscard]] double farthest_up(const Primitive& primitive, const PreciseVector& x, double multiplier);

[[nodiscard]] bool is_ball(const Primitive& primitive);

}  // namespace verisq::verify
