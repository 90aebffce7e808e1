/// Sums rounded outward.
#include "verify/deviation/weighted_cells.hpp"

#include <algorithm>

#include "verify/numbers/rounding.hpp"

namespace verisq::verify {

namespace {

Enclosure hull_of_ranges(std::span<const WeightedCell> cells) {
  Enclosure hull = cells.front().range;
  for (const WeightedCell& cell : cells) {
    hull = {std::min(hull.lo, cell.range.lo), std::max(hull.hi, cell.range.hi)};
  }
  return hull;
}

double sum(double a, double b, Direction direction) {
  return add(a, b, direction);
}

}  // namespace

Enclosure mean_of(std::span<const WeightedCell> cells) {
  double weight_down = 0.0;
  double weight_up = 0.0;
  double lower = 0.0;
  double upper = 0.0;
  for (const auto& [weight, range, mean] : cells) {
    weight_down = sum(weight_down, weight.lo, Direction::down);
    weight_up = sum(weight_up, weight.hi, Direction::up);
    lower = sum(lower, multiply(weight.lo, mean.lo, Direction::down), Direction::down);
    upper = sum(upper, multiply(weight.hi, mean.hi, Direction::up), Direction::up);
  }
  const Enclosure hull = hull_of_ranges(cells);
  if (!(weight_down > 0.0)) return hull;
  return {std::max(hull.lo, divide(lower, weight_up, Direction::down)),
          std::min(hull.hi, divide(upper, weight_down, Direction::up))};
}

Distribution::Distribution(std::span<const WeightedCell> cells) {
  lower_.reserve(cells.size());
  upper_.reserve(cells.size());
  for (const auto& [weight, range, mean] : cells) {
    lower_.push_back({range.lo, weight.hi});
    upper_.push_back({range.hi, weight.lo});
    total_ = {sum(total_.lo, weight.lo, Direction::down), sum(total_.hi, weight.hi, Direction::up)};
  }
  const auto by_distance = [](const End& a, const End& b) { return a.distance < b.distance; };
  std::ranges::sort(lower_, by_distance);
  std::ranges::sort(upper_, by_distance);
}

/// The first end up to which the weights add up to as much; the last where rounding leaves less.
double Distribution::first_at_least(std::span<const End> ends, double weight, bool up) {
  const Direction direction = up ? Direction::up : Direction::down;
  double reached = 0.0;
  for (const End& end : ends) {
    reached = sum(reached, end.weight, direction);
    if (reached >= weight) return end.distance;
  }
  return ends.back().distance;
}

/// With distances at their lower ends and weights at their largest the least v is no larger, with distances at their
/// upper ends and weights at their smallest no smaller.
Enclosure Distribution::percentile(double percent) const {
  const auto part = [percent](double total, Direction direction) {
    return multiply(divide(percent, 100.0, direction), total, direction);
  };
  return {first_at_least(lower_, part(total_.lo, Direction::down), true),
          first_at_least(upper_, part(total_.hi, Direction::up), false)};
}

}  // namespace verisq::verify
