/// How well the distance of one point of the bone to an implant serves: the function f of the paper's Eq. (4).
#pragma once

#include <verisq/enclosure.hpp>

namespace verisq {

/// f(d) = 1 / (1 + ((d - target) / scale)^2) - (min(d, 0) / scale)^2: 1 at the wanted distance, 1/2 at `scale` from it,
/// towards 0 for points that the implant does not reach, and falling without bound for those deeper and deeper inside
/// it. Continuously differentiable; rises up to the target and falls beyond it. In model units. `serves` is the band of
/// distances that meet the criterion. Preconditions: finite; target >= 0, scale > 0.
struct Fitness {
  double target;
  double scale;
  Enclosure serves;
};

/// Bone grows onto the implant: the closer the better, at most `gap` apart (2 mm in the paper), and pressed in by no
/// more than `penetration_limit`. Throws Error(input) unless gap > 0, penetration_limit >= 0, both finite.
[[nodiscard]] Fitness cementless(double gap, double penetration_limit);

/// A layer of cement `gap` thick all around, to within `tolerance`. The ends of the band, gap -+ tolerance, are rounded
/// inward: what lies in `serves` lies in the exact band. Throws Error(input) unless finite, gap >= 0, tolerance > 0.
[[nodiscard]] Fitness cemented(double gap, double tolerance);

/// f and f' to nearest, for searches.
[[nodiscard]] double value(const Fitness& fitness, double distance);
[[nodiscard]] double slope(const Fitness& fitness, double distance);

/// All values of f over the enclosure, rounded outward: proven. Minus infinity from a lower end that is, 0 (the limit)
/// from an upper end that is infinite; [-infinity, 1] for what is no interval (NaN).
[[nodiscard]] Enclosure value(const Fitness& fitness, const Enclosure& distance);

}  // namespace verisq
