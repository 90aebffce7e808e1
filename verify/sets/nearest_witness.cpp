/// The search's nearest point, moved towards x as far as it keeps its side.
#include "verify/sets/nearest_witness.hpp"

#include "verify/analysis/distance_up.hpp"

namespace verisq::verify {

namespace {

/// The farthest of the points from `in`, which lies in the set, towards x, that is found to lie in it, too.
Point nearer(const SolidDistance& search, const Point& x, const Point& in, Side side) {
  const Colour wanted = side == Side::inside ? Colour::black : Colour::white;
  const auto at = [&](double t) {
    Point p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = in[i] + t * (x[i] - in[i]);
    return p;
  };
  double inside = 0.0;
  double outside = 1.0;
  Point best = in;
  for (int i = 0; i < 60 && outside - inside > 0x1p-54; ++i) {
    const double t = i == 0 ? 0x1p-20 : 0.5 * (inside + outside);
    const Point p = at(t);
    if (search.colour(p) == wanted) {
      inside = t;
      if (distance_up(x, p) < distance_up(x, best)) best = p;
    } else {
      outside = t;
    }
  }
  return best;
}

}  // namespace

std::optional<Point> nearest_witness(const SolidDistance& search, const Point& x, Side side, double tolerance,
                                     const std::function<bool()>& interrupted) {
  const auto found = search.nearest(x, side, tolerance, interrupted);
  return found ? std::optional(nearer(search, x, *found, side)) : std::nullopt;
}

}  // namespace verisq::verify
