/// The fitness function of the paper's Eq. (4): its values for searches, and its proven range over an enclosure.
#include "verisq/fitness.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "verify/numbers/interval.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq {

namespace {

using verify::Direction;
using verify::Interval;

void require(bool holds, const std::string& key, const std::string& wanted, double value) {
  if (holds) return;
  std::ostringstream message;
  message << key << ": must be " << wanted << ", not " << value;
  throw Error(ErrorKind::input, message.str());
}

/// Encloses f at one distance, which is any real number or +infinity.
Interval enclosed_at(const Fitness& fitness, double distance) {
  if (distance == infinity) return {0};  // the limit
  const Interval scale(fitness.scale);
  const Interval serving =
      Interval(1) / (Interval(1) + square((Interval(distance) - Interval(fitness.target)) / scale));
  if (distance >= 0.0) return serving;
  return serving - square(Interval(distance) / scale);
}

}  // namespace

Fitness cementless(double gap, double penetration_limit) {
  require(std::isfinite(gap) && gap > 0.0, "gap", "positive and finite", gap);
  require(std::isfinite(penetration_limit) && penetration_limit >= 0.0, "penetration limit", "finite and at least 0",
          penetration_limit);
  return {0.0, gap, {0.0 - penetration_limit, gap}};  // exact, and 0 is not -0
}

Fitness cemented(double gap, double tolerance) {
  require(std::isfinite(gap) && gap >= 0.0, "gap", "finite and at least 0", gap);
  require(std::isfinite(tolerance) && tolerance > 0.0, "tolerance", "positive and finite", tolerance);
  const double highest = verify::add(gap, tolerance, Direction::down);
  const double lowest = std::min(verify::subtract(gap, tolerance, Direction::up), highest);
  return {gap, tolerance, {lowest, highest}};
}

double value(const Fitness& fitness, double distance) {
  const double apart = (distance - fitness.target) / fitness.scale;
  const double inside = std::min(distance, 0.0) / fitness.scale;
  return 1.0 / (1.0 + apart * apart) - inside * inside;
}

double slope(const Fitness& fitness, double distance) {
  const double apart = (distance - fitness.target) / fitness.scale;
  const double serving = 1.0 / (1.0 + apart * apart);
  const double inside = std::min(distance, 0.0) / fitness.scale;
  // Far away 0 times an infinity is to be 0.
  const double of_serving = serving > 0.0 ? -2.0 * apart * serving * serving : 0.0;
  return (of_serving - 2.0 * inside) / fitness.scale;
}

// f rises up to the target and falls beyond it. With t = target >= 0: the first term of f falls as |d - t| rises; the
// second rises with d and is 0 for d >= 0, hence constant for d >= t. So both rise on d <= t, and on d >= t the first
// falls while the second stays 0. Over [lo, hi] the largest value of f is therefore at the number of the interval that
// is nearest to t, the smallest at one of the ends; the three are binary64 numbers, no rounding is needed to find them.
// f <= 1 everywhere; it falls to minus infinity as d does and to 0 as d rises to infinity.
Enclosure value(const Fitness& fitness, const Enclosure& distance) {
  const auto& [lo, hi] = distance;
  if (!(lo <= hi)) return {-infinity, 1.0};  // not an interval: nothing is known of the distance
  if (hi == -infinity) return {-infinity, -infinity};
  const double best = std::clamp(fitness.target, lo, hi);
  const double largest = std::min(enclosed_at(fitness, best).upper(), 1.0);
  if (lo == -infinity) return {-infinity, largest};
  return {std::min(enclosed_at(fitness, lo).lower(), enclosed_at(fitness, hi).lower()), largest};
}

}  // namespace verisq
