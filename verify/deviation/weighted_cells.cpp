/// Sums rounded outward.
#include "verify/deviation/weighted_cells.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

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

/// The part of a triangle where the affine function of these sorted values at its corners is at most `limit`.
/// Differences round by u, products, quotients and the last difference add less than 8u: the result, at most 1, is off
/// by less than 2^-46.
double part_below(const std::array<double, 3>& sorted, double limit) {
  const auto& [a, b, c] = sorted;
  if (!(limit >= a)) return 0.0;
  if (!(limit < c)) return 1.0;
  if (limit < b) return (limit - a) / (b - a) * ((limit - a) / (c - a));
  return 1.0 - (c - limit) / (c - a) * ((c - limit) / (c - b));
}

constexpr double error_of_part = 0x1p-46;

/// How often a bracket is halved.
constexpr int halvings = 14;

/// A distance and its square, rounded either way.
struct Limit {
  double distance;
  Enclosure square;
};

Limit limit_of(double distance) {
  return {distance, {multiply(distance, distance, Direction::down), multiply(distance, distance, Direction::up)}};
}

/// Where d <= v the function is at most t(v) - below, and where it is at most t(v) - above, d <= v.
Enclosure part_up_to(const WeightedCell& cell, const Limit& limit) {
  if (limit.distance >= cell.range.hi) return {1.0, 1.0};
  if (limit.distance < cell.range.lo) return {0.0, 0.0};
  const auto& [values, below, above, squared] = cell.affine;
  const Enclosure reached = squared ? limit.square : Enclosure{limit.distance, limit.distance};
  const double upper =
      below > -infinity ? part_below(values, subtract(reached.hi, below, Direction::up)) + error_of_part : 1.0;
  const double lower =
      above < infinity ? part_below(values, subtract(reached.lo, above, Direction::down)) - error_of_part : 0.0;
  return {std::max(0.0, lower), std::min(1.0, upper)};
}

/// Of the sum of w (m - mean) over all cells, each w in its interval the largest: where that is at most 0, no choice of
/// weights has a greater mean. `sign` -1: of the lower ends, for the least mean.
double greatest_excess(std::span<const WeightedCell> cells, double mean, double sign) {
  double sum_up = 0.0;
  for (const WeightedCell& cell : cells) {
    const double excess =
        sign > 0.0 ? subtract(cell.mean.hi, mean, Direction::up) : subtract(mean, cell.mean.lo, Direction::up);
    const double weight = excess > 0.0 ? cell.weight.hi : cell.weight.lo;
    sum_up = sum(sum_up, multiply(weight, excess, Direction::up), Direction::up);
  }
  return sum_up;
}

/// The extreme mean over all choices of weights, about: each step chooses the weights that the last mean asks for
/// (Dinkelbach's method), which climbs to it.
double extreme_mean(std::span<const WeightedCell> cells, double mean, double sign) {
  constexpr int steps = 8;
  for (int i = 0; i < steps; ++i) {
    double weights = 0.0;
    double moments = 0.0;
    for (const WeightedCell& cell : cells) {
      const double end = sign > 0.0 ? cell.mean.hi : cell.mean.lo;
      const double weight = sign * (end - mean) > 0.0 ? cell.weight.hi : cell.weight.lo;
      weights += weight;
      moments += weight * end;
    }
    mean = moments / weights;
  }
  return mean;
}

constexpr double step_beyond = 0x1p-40;  // more than sums of many millions of terms round

}  // namespace

void choose_widest(std::vector<std::pair<double, std::size_t>>& widths, double allowed, std::vector<bool>& chosen) {
  constexpr double share_of_the_others = 0.5;
  double excess = 0.0;
  for (const auto& [width, i] : widths) excess += width;
  std::ranges::sort(widths, std::greater<>());
  for (const auto& [width, i] : widths) {
    if (excess <= share_of_the_others * allowed) return;
    excess -= width;
    chosen[i] = true;
  }
}

Enclosure part_up_to(const WeightedCell& cell, double distance) {
  return part_up_to(cell, limit_of(distance));
}

Enclosure mean_of(std::span<const WeightedCell> cells) {
  double weight_down = 0.0;
  double weight_up = 0.0;
  double lower = 0.0;
  double upper = 0.0;
  for (const auto& [weight, range, mean, affine] : cells) {
    weight_down = sum(weight_down, weight.lo, Direction::down);
    weight_up = sum(weight_up, weight.hi, Direction::up);
    lower = sum(lower, multiply(weight.lo, mean.lo, Direction::down), Direction::down);
    upper = sum(upper, multiply(weight.hi, mean.hi, Direction::up), Direction::up);
  }
  const Enclosure hull = hull_of_ranges(cells);
  if (!(weight_down > 0.0)) return hull;
  Enclosure mean{std::max(hull.lo, divide(lower, weight_up, Direction::down)),
                 std::min(hull.hi, divide(upper, weight_down, Direction::up))};
  if (!(mean.hi < infinity)) return mean;
  const double most = extreme_mean(cells, mean.hi, 1.0) + step_beyond * mean.hi;
  if (most < mean.hi && greatest_excess(cells, most, 1.0) <= 0.0) mean.hi = most;
  const double least = extreme_mean(cells, mean.lo, -1.0) - step_beyond * mean.hi;
  if (least > mean.lo && greatest_excess(cells, least, -1.0) <= 0.0) mean.lo = least;
  return mean;
}

/// The mean of what the parts are.
Enclosure share_up_to(std::span<const WeightedCell> cells, double distance) {
  const Limit limit = limit_of(distance);
  std::vector<WeightedCell> parts;
  parts.reserve(cells.size());
  for (const WeightedCell& cell : cells) parts.push_back({cell.weight, {0.0, 1.0}, part_up_to(cell, limit)});
  return mean_of(parts);
}

Enclosure weight_up_to(std::span<const WeightedCell> cells, double distance) {
  const Limit limit = limit_of(distance);
  Enclosure weight{0.0, 0.0};
  for (const WeightedCell& cell : cells) {
    const Enclosure part = part_up_to(cell, limit);
    weight.lo = sum(weight.lo, multiply(cell.weight.lo, part.lo, Direction::down), Direction::down);
    weight.hi = sum(weight.hi, multiply(cell.weight.hi, part.hi, Direction::up), Direction::up);
  }
  return weight;
}

AreaWithin area_within(std::span<const WeightedCell> cells, double distance) {
  if (cells.empty()) return {};
  AreaWithin found{.area = {0.0, 0.0}, .within = weight_up_to(cells, distance), .share = share_up_to(cells, distance)};
  for (const WeightedCell& cell : cells) {
    found.area.lo = sum(found.area.lo, cell.weight.lo, Direction::down);
    found.area.hi = sum(found.area.hi, cell.weight.hi, Direction::up);
  }
  return found;
}

Distribution::Distribution(std::span<const WeightedCell> cells) : cells_(cells) {
  lower_.reserve(cells.size());
  upper_.reserve(cells.size());
  for (const auto& [weight, range, mean, affine] : cells) {
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
  const Enclosure wanted{part(total_.lo, Direction::down), part(total_.hi, Direction::up)};
  const Enclosure found =
      narrowed({first_at_least(lower_, wanted.lo, true), first_at_least(upper_, wanted.hi, false)}, wanted);
  constexpr double known_well = 1e-9;
  if (total_.hi - total_.lo <= known_well * total_.hi) return found;
  return balanced(found, {divide(percent, 100.0, Direction::down), divide(percent, 100.0, Direction::up)});
}

/// Of the sum of w (part up to the distance - p) over all cells, whichever weights and parts they have. Terms round by
/// 4u each, n terms add up to within n u more of the sum of their magnitudes.
Enclosure Distribution::balance(double distance, const Enclosure& part) const {
  const Limit limit = limit_of(distance);
  Enclosure balance{0.0, 0.0};
  double magnitudes = 0.0;
  for (const WeightedCell& cell : cells_) {
    const Enclosure reached = part_up_to(cell, limit);
    const double least = reached.lo - part.hi;
    const double most = reached.hi - part.lo;
    balance.lo += (least > 0.0 ? cell.weight.lo : cell.weight.hi) * least;
    balance.hi += (most > 0.0 ? cell.weight.hi : cell.weight.lo) * most;
    magnitudes += cell.weight.hi;
  }
  const double error = 0x1p-51 * static_cast<double>(cells_.size() + 4) * magnitudes + 0x1p-1000;
  return {balance.lo - error, balance.hi + error};
}

/// As much as wanted of all weight lies up to v where the balance is not below 0, whatever the weights are; less where
/// it is.
Enclosure Distribution::balanced(const Enclosure& percentile, const Enclosure& part) const {
  if (!(percentile.hi < infinity)) return percentile;
  Enclosure result = percentile;
  double above = result.hi;
  double below = result.lo;
  for (int i = 0; i < halvings && result.lo < result.hi; ++i) {
    const double lower = 0.5 * result.lo + 0.5 * above;
    (balance(lower, part).hi < 0.0 ? result.lo : above) = lower;
    const double upper = 0.5 * below + 0.5 * result.hi;
    (balance(upper, part).lo >= 0.0 ? result.hi : below) = upper;
  }
  return result;
}

Distribution::Near Distribution::near(const Enclosure& bracket) const {
  Near near;
  for (const WeightedCell& cell : cells_) {
    if (cell.range.lo > bracket.hi) continue;
    if (cell.range.hi < bracket.lo) {
      near.before = {sum(near.before.lo, cell.weight.lo, Direction::down),
                     sum(near.before.hi, cell.weight.hi, Direction::up)};
    } else {
      near.cells.push_back(&cell);
    }
  }
  return near;
}

/// Sums of n numbers, none of them negative, to nearest: products and additions are off by less than (n + 2) u in all,
/// u = 2^-53, relative to the result.
Enclosure Distribution::weight_up_to(const Near& near, double distance) {
  const Limit limit = limit_of(distance);
  double lower = 0.0;
  double upper = 0.0;
  for (const WeightedCell* cell : near.cells) {
    const Enclosure part = part_up_to(*cell, limit);
    lower += part.lo * cell->weight.lo;
    upper += part.hi * cell->weight.hi;
  }
  const double error = 0x1p-52 * static_cast<double>(near.cells.size() + 4);
  constexpr double underflow = 0x1p-1000;
  return {sum(near.before.lo, std::max(0.0, lower * (1.0 - error) - underflow), Direction::down),
          sum(near.before.hi, upper * (1.0 + error) + underflow, Direction::up)};
}

/// No less than v where less weight than wanted lies up to v, no more than v where as much does.
Enclosure Distribution::narrowed(const Enclosure& percentile, const Enclosure& wanted) const {
  if (!(percentile.lo < percentile.hi) || percentile.hi == infinity) return percentile;
  Enclosure result = percentile;
  Near cells = near(result);
  const auto middle_of = [](double a, double b) { return 0.5 * a + 0.5 * b; };
  for (int i = 0; i < halvings; ++i) {
    const double middle = middle_of(result.lo, result.hi);
    const Enclosure weight = weight_up_to(cells, middle);
    if (weight.hi < wanted.lo) {
      result.lo = middle;
    } else if (weight.lo >= wanted.hi) {
      result.hi = middle;
    } else {
      break;
    }
  }
  cells = near(result);
  double above = result.hi;
  double below = result.lo;
  for (int i = 0; i < halvings; ++i) {
    const double lower = middle_of(result.lo, above);
    (weight_up_to(cells, lower).hi < wanted.lo ? result.lo : above) = lower;
    const double upper = middle_of(below, result.hi);
    (weight_up_to(cells, upper).lo >= wanted.hi ? result.hi : below) = upper;
  }
  return result;
}

}  // namespace verisq::verify
