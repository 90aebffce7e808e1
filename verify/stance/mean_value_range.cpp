/// Mean-value forms with a centre of its own for each end, and bisection where signs are not proven.
#include "verify/stance/mean_value_range.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <stdexcept>
#include <utility>

#include "verisq/enclosure.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

struct Cell {
  Box box;
  double bound;          ///< of the function's values over the box, from above
  bool final;            ///< whether bisection would win no more than rounding errors
  std::uint32_t widest;  ///< the variable whose halving promises most

  [[nodiscard]] bool operator<(const Cell& other) const { return bound < other.bound; }
};

/// The point x that makes the upper end of f(c) + d (x - c) over x in `range` least, for an increasing f with the upper
/// end, for a decreasing one the lower end, and between them in proportion (Baumann 1988). Any point is sound.
double best_centre(const Interval& range, const Interval& derivative) {
  if (derivative.lower() >= 0.0) return range.upper();
  if (derivative.upper() <= 0.0) return range.lower();
  const double share = derivative.upper() / (derivative.upper() - derivative.lower());
  if (!std::isfinite(share)) return range.lower();
  return std::clamp(range.lower() + share * (range.upper() - range.lower()), range.lower(), range.upper());
}

/// Bisection for the greatest value of a function over a box.
class Maximum {
 public:
  Maximum(const DifferentiableFunction& function, std::span<const std::uint32_t> variables)
      : function_(function), variables_(variables) {}

  [[nodiscard]] double above(const Box& box) {
    constexpr int most_bisections = 2000;
    constexpr double tolerance = 1e-12;
    std::priority_queue<Cell> cells;
    cells.push(bounded(box));
    for (int i = 0; i < most_bisections; ++i) {
      const Cell worst = cells.top();
      if (worst.final || worst.bound - reached_ <= tolerance * std::fabs(worst.bound)) break;
      const Interval side = worst.box[worst.widest];
      const double middle = 0.5 * side.lower() + 0.5 * side.upper();
      if (!(side.lower() < middle && middle < side.upper())) break;
      cells.pop();
      for (const Interval& half : {Interval(side.lower(), middle), Interval(middle, side.upper())}) {
        Box part = worst.box;
        part[worst.widest] = half;
        Cell cell = bounded(part);
        // Both bounds hold for the part.
        cell.bound = std::fmin(cell.bound, worst.bound);
        cells.push(std::move(cell));
      }
    }
    return cells.top().bound;
  }

 private:
  /// f(x) = f(c) + sum of d_i (x_i - c_i) with derivatives d_i between c and x: for c in the box, in its gradient.
  [[nodiscard]] Cell bounded(const Box& box) {
    Box centre = box;
    Interval slope = 0;
    Cell cell{box, function_.value(box).upper(), true, 0};
    double most = 0.0;
    for (const std::uint32_t i : variables_) {
      const Interval derivative = function_.partial(box, i);
      centre[i] = best_centre(box[i], derivative);
      slope += derivative * (box[i] - centre[i]);
      const double gain = (derivative * (box[i] - centre[i])).upper();
      if (gain > most) {
        most = gain;
        cell.widest = i;
      }
    }
    const Interval at_centre = function_.value(centre);
    reached_ = std::fmax(reached_, at_centre.lower());
    cell.final = slope.upper() <= at_centre.upper() - at_centre.lower();
    cell.bound = std::fmin(cell.bound, (at_centre + slope).upper());
    return cell;
  }

  const DifferentiableFunction& function_;
  std::span<const std::uint32_t> variables_;
  double reached_ = -infinity;
};

}  // namespace

Enclosure range(const DifferentiableFunction& function, const Box& box, std::span<const std::uint32_t> variables) {
  const DifferentiableFunction negative{
      [&](std::span<const Interval> x) { return -function.value(x); },
      [&](std::span<const Interval> x, std::uint32_t i) { return -function.partial(x, i); }};
  try {
    // Plus 0: no negative zeros in tables.
    return {0.0 - Maximum(negative, variables).above(box), 0.0 + Maximum(function, variables).above(box)};
  } catch (const std::domain_error&) {
    // Numbers beyond binary64: nothing is proven.
    return {-infinity, infinity};
  }
}

}  // namespace verisq::stance
