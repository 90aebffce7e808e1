/// Boxes that contain every pair of closest points of two models.
#pragma once

#include <functional>
#include <optional>

#include "verify/proof/pair_checker.hpp"
#include "verisq/distance.hpp"

namespace verisq::verify {

/// Two methods for each pair of primitives (A, B) that `found` does not prove to be farther than the nearest:
///
/// By Krawczyk's operator. The support functions are differentiable if both exponents are below 2, and
///     ψ(v) = |v|^2/2 - v·c + h_A(v) + h_B(-v)
/// is strictly convex: its gradient F(v) = v - c + s_A(v) - s_B(-v) has at most one zero v* other than 0. There
/// v* = b - a for the points a = s_A(v*) and b = c + s_B(-v*), which are therefore the closest points. For a maximises
/// v*·x over A, b minimises it over B, so no two points are closer than |v*|. Krawczyk's operator proves that a box V
/// contains a zero of F; then s_A(V) and c + s_B(-V) contain the closest points, the only ones. If (a', b') were a
/// second pair, a strictly convex A would contain a ball about (a + a')/2, a point of which is closer to (b + b')/2.
///
/// By caps. For d* <= hi, every pair of closest points has v·(b - a) <= |v| hi and, with v·b >= v·c - h_B(-v),
/// v·a >= h_A(v) - η where η = |v| hi - (v·c - h_A(v) - h_B(-v)); alike for b. Over that cap of A, for every direction
/// e and every t >= 0, e·x <= h_A(e + t v) - t (h_A(v) - η). It contains every pair, whether there is one or many.
///
/// `unique` is proven if one pair of primitives remains and one of its two solids is strictly convex (both exponents
/// below 2), by the same argument, which needs no computation. Precondition: `found` is the answer for these pairs,
/// separated and complete. Nothing is returned if no pair of `found` remains, or once `interrupted` returns true.
[[nodiscard]] std::optional<ClosestPoints> closest_points(const PosedPairs& pairs, const ModelDistance& found,
                                                          const std::function<bool()>& interrupted);

}  // namespace verisq::verify
