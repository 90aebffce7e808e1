/// Walks from a point of a set to one that is as near to a query as a random search finds.
#pragma once

#include <algorithm>

#include "tests/oracle/mixed_norm.hpp"
#include "tests/oracle/random_cases.hpp"

namespace verisq::oracle {

/// a + t (b - a).
[[nodiscard]] inline Point between(const Point& a, const Point& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

/// The point of the set that is reached from `point`, which lies in it, straight towards q: by steps that double from
/// `first` (a part of the way) as long as they stay in the set, then halve.
template <class InSet>
[[nodiscard]] Point drawn_towards(const Point& q, const Point& point, double first, int halvings, const InSet& in_set) {
  double rest = 1.0;
  double step = first;
  while (step < rest && in_set(between(q, point, rest - step))) {
    rest -= step;
    step *= 2;
  }
  for (int i = 0; i < halvings; ++i) {
    step /= 2;
    if (step < rest && in_set(between(q, point, rest - step))) rest -= step;
  }
  return between(q, point, rest);
}

/// Evolution strategy of Rechenberg's one-fifth rule on the spheres about q: a random neighbour, put onto a slightly
/// smaller sphere, is accepted where it lies in the set. Precondition: `start` lies in the set, q does not.
template <class InSet>
[[nodiscard]] Point approach(const Point& q, const Point& start, int trials, RandomCases& random, const InSet& in_set) {
  Point best = drawn_towards(q, start, 1e-3, 30, in_set);
  double distance = length(difference(best, q));
  double step = distance / 4;
  for (int i = 0; i < trials && step > 1e-10 * distance; ++i) {
    const Point direction = random.direction();
    const double stride = step * random.uniform(0, 1);
    Point candidate = best;
    for (std::size_t k = 0; k < 3; ++k) candidate[k] += stride * direction[k];
    const double relative = step / distance;
    const double wanted = distance * (1 - std::min(0.01, 0.02 * relative * relative));
    const double away = length(difference(candidate, q));
    if (away > wanted) candidate = between(q, candidate, wanted / away);
    if (in_set(candidate)) {
      best = drawn_towards(q, candidate, std::min(0.1, 0.01 * relative * relative) + 1e-15, 4, in_set);
      distance = length(difference(best, q));
      step *= 1.5;
    } else {
      step *= 0.9;
    }
  }
  return drawn_towards(q, best, 1e-9, 20, in_set);
}

}  // namespace verisq::oracle
