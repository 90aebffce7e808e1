/// Over its chord, of length c, a convex arc is a graph within the triangle of its end tangents. With the larger θ of
/// their angles the triangle is at most c tan θ / 2 high.
#include "verify/deviation/plane_arc.hpp"

#include <algorithm>

namespace verisq::verify {

namespace {

struct Tangent {
  Interval along;    ///< the chord, per length of the tangent
  Interval tangent;  ///< of the angle with it, not signed
  PlaneVector speed;
};

std::optional<Tangent> tangent_over(const PlaneVector& direction, const PlaneVector& chord, const Interval& length) {
  const auto& [x, y] = direction;
  const Interval size = sqrt(square(x) + square(y));
  const Interval forward = (x * chord[0] + y * chord[1]) / length;
  if (!(size.lower() > 0.0) || !(forward.lower() > 0.0)) return std::nullopt;
  const Interval aside = abs(x * chord[1] - y * chord[0]) / length;
  // The foot passes the chord, of this length, while u goes from 0 to 1.
  const Interval by_share = length / forward;
  return Tangent{forward / size, aside / forward, {x * by_share, y * by_share}};
}

}  // namespace

std::optional<ArcBounds> bounds_of(const PlaneArc& arc) {
  const PlaneVector chord{arc.to[0] - arc.from[0], arc.to[1] - arc.from[1]};
  const Interval length = sqrt(square(chord[0]) + square(chord[1]));
  if (!(length.lower() > 0.0)) return std::nullopt;
  const auto first = tangent_over(arc.tangent_from, chord, length);
  const auto last = tangent_over(arc.tangent_to, chord, length);
  if (!first || !last) return std::nullopt;
  // Between its ends the tangent turns from one to the other, and so its angle with the chord is no larger.
  const double steepest = std::max(first->tangent.upper(), last->tangent.upper());
  const double least_along = std::min(first->along.lower(), last->along.lower());
  if (!(least_along > 0.0)) return std::nullopt;
  const double longest = (Interval(1) / Interval(least_along)).upper();
  return ArcBounds{length,
                   {1.0, std::max(1.0, longest)},
                   {0.0, (square(length) * Interval(steepest) / Interval(4)).upper()},
                   (length * Interval(steepest) / Interval(2)).upper(),
                   {hull(first->speed[0], last->speed[0]), hull(first->speed[1], last->speed[1])}};
}

}  // namespace verisq::verify
