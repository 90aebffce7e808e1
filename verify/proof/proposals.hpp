/// What proofs are tried with, found in plain floating point by verify/proposals, which need not be trusted: whatever
/// it returns, NaN too, nothing wrong is proven with it.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "verisq/model.hpp"

namespace verisq::verify {

/// A direction or point found in floating point. It need not be accurate: a poor one proves a poor bound.
using Proposal = std::array<long double, 3>;

namespace proposed {

/// About the s >= 0 where the ray q + s w leaves {g <= level}; q and w in the octant of nonnegative coordinates, of a
/// tapered solid also below it.
[[nodiscard]] long double exit(const Superquadric& solid, const Proposal& q, const Proposal& w, long double level);

/// About the gradient of g at x.
[[nodiscard]] Proposal gradient(const Superquadric& solid, const Proposal& x);

/// About the point of the triangle, which may be degenerate, that is closest to the origin.
[[nodiscard]] Proposal closest_to_origin(const std::array<Proposal, 3>& corners);

/// About the root τ of ‖(r, Z + k τ)‖_q = τ, r >= 0, q the exponent of the outer dual norm, which may be infinite.
[[nodiscard]] long double support_root(long double section, long double height, long double k, long double q);

/// {e : normal·e <= offset}
struct HalfSpace {
  std::array<double, 3> normal;
  double offset;
};

/// Multipliers m >= 0, one for each half-space, for which the least of 2 N·c - |N|² - 2 Σ m offset over the corners c,
/// with N = Σ m normal, is about to be above `value`; nothing where there are none.
[[nodiscard]] std::optional<std::vector<double>> multipliers(std::span<const std::array<double, 3>> corners,
                                                             std::span<const HalfSpace> half_spaces, double value);

/// Of a convex body: about its farthest point in a direction of any length.
using FarthestPoint = std::function<std::array<double, 3>(const std::array<double, 3>&)>;

/// The same with the least over a convex body, of which `inside` is a point.
[[nodiscard]] std::optional<std::vector<double>> multipliers(const FarthestPoint& body,
                                                             const std::array<double, 3>& inside,
                                                             std::span<const HalfSpace> half_spaces, double value);

}  // namespace proposed

}  // namespace verisq::verify
