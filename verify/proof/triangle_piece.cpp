/// This file implements triangle_piece.hpp.
#include "verify/proof/triangle_piece.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/interval.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/verdict.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/insertion.hpp"

namespace verisq::verify {
namespace {

Point middle(const Point& a, const Point& b) {
  return {0.5 * a[0] + 0.5 * b[0], 0.5 * a[1] + 0.5 * b[1], 0.5 * a[2] + 0.5 * b[2]};
}

/// 1/√3 from above: every point of a triangle is no farther from the nearest corner than this share of the longest
/// side.
constexpr double covering_share = 0.5773502691896258;

}  // namespace

std::array<Triangle, 4> quarters(const Triangle& piece) {
  const auto& [a, b, c] = piece;
  const Point ab = middle(a, b);
  const Point bc = middle(b, c);
  const Point ca = middle(c, a);
  return {{{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {bc, ca, ab}}};
}

/// With M the triangle's largest coordinate and u = 2^-53, a middle rounds by u M in each coordinate, on top of the
/// average error of its two ends. After k divisions a corner is off by at most √3 k u M, for k <= 20 less than 35 u M <
/// 2^-47 M. Halves that underflow are off by less than the smallest normal number.
double quartering_error(const Triangle& whole) {
  static_assert(most_quarterings <= 20);
  return 0x1p-47 * largest_coordinate(whole) + std::numeric_limits<double>::min();
}

/// Differences round by 2^-53 of themselves, their length by 2^-50 (points.hpp): together less than 2^-48.
double distance_in_binary64_up(const Point& a, const Point& b) {
  return length(a[0] - b[0], a[1] - b[1], a[2] - b[2]) * (1.0 + 0x1p-48) + std::numeric_limits<double>::min();
}

/// Every point of a triangle is no farther from the nearest corner than the longest side over √3.
double least_on(const Triangle& whole, const std::array<double, 3>& at_vertices) {
  double longest = 0.0;
  for (std::size_t i = 0; i < 3; ++i)
    longest = std::max(longest, distance_in_binary64_up(whole[i], whole[(i + 1) % 3]));
  const double farthest = multiply(covering_share, longest, Direction::up);
  const double by_nearest = subtract(std::ranges::min(at_vertices), farthest, Direction::down);
  return std::max(least_on(whole, 0.0, whole, at_vertices), by_nearest);
}

/// |x - vertex| is convex in x, hence largest at a corner.
double least_on(const Triangle& piece, double off, const Triangle& whole, const std::array<double, 3>& at_vertices) {
  double least = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    double farthest = 0.0;
    for (const Point& corner : piece) farthest = std::max(farthest, distance_in_binary64_up(corner, whole[i]));
    least = std::max(least, subtract(at_vertices[i], add(farthest, off, Direction::up), Direction::down));
  }
  return least;
}

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
/// Differences round by u; products, quotients and the last difference add less than 8u. The result, at most 1, is off
/// by less than 2^-46.
double part_below(const std::array<double, 3>& sorted, double limit) {
  const auto& [a, b, c] = sorted;
  if (!(limit >= a)) return 0.0;
  if (!(limit < c)) return 1.0;
  if (limit < b) return (limit - a) / (b - a) * ((limit - a) / (c - a));
  return 1.0 - (c - limit) / (c - a) * ((c - limit) / (c - b));
}

constexpr double error_of_part = 0x1p-46;

/// The number of times that a bracket is halved.
constexpr int halvings = 14;

/// A distance and its square, rounded either way.
struct Limit {
  double distance;
  Enclosure square;
};

Limit limit_of(double distance) {
  return {distance, {multiply(distance, distance, Direction::down), multiply(distance, distance, Direction::up)}};
}

/// If d <= v, the function is at most t(v) - below; if the function is at most t(v) - above, d <= v.
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

/// An upper bound of the sum of w (m - mean) over all cells, for the worst w in each interval. If it is at most 0, no
/// choice of weights has a greater mean. With `sign` -1 it uses the lower ends, for the least mean.
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

/// The approximate extreme mean over all choices of weights. Each step chooses the best weights for the last mean
/// (Dinkelbach's method), which climbs to the extreme.
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

/// A percentage as part/whole. Both are integers if few decimals write it: 99.9 means 999/1000, which its binary64
/// number does not equal. Hence products, quotients and ranks are exact if they are binary64 numbers.
struct Fraction {
  double part;
  double whole;

  /// This fraction of a number.
  [[nodiscard]] double of(double total, Direction direction) const {
    return divide(multiply(part, total, direction), whole, direction);
  }
};

Fraction fraction_of(double percent) {
  constexpr int most_decimals = 12;  // all powers of ten are exact
  double scale = 1.0;
  for (int decimals = 0; decimals <= most_decimals; ++decimals, scale *= 10.0) {
    const double digits = std::round(percent * scale);
    if (digits < 0x1p53 && digits / scale == percent) return {digits, 100.0 * scale};
  }
  return {percent, 100.0};
}

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

/// The mean of the cells' parts.
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

/// With distances at their lower ends and weights at their largest the least v is no larger than the exact one. With
/// distances at their upper ends and weights at their smallest it is no smaller.
Enclosure Distribution::percentile(double percent) const {
  const Fraction fraction = fraction_of(percent);
  const Enclosure wanted{fraction.of(total_.lo, Direction::down), fraction.of(total_.hi, Direction::up)};
  const Enclosure found =
      narrowed({first_at_least(lower_, wanted.lo, true), first_at_least(upper_, wanted.hi, false)}, wanted);
  constexpr double known_well = 1e-9;
  if (total_.hi - total_.lo <= known_well * total_.hi) return found;
  return balanced(found, {fraction.of(1.0, Direction::down), fraction.of(1.0, Direction::up)});
}

/// The sum of w (part up to the distance - p) over all cells, for any weights and parts. Terms round by 4u each; n
/// terms add up to within n u more of the sum of their magnitudes.
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

/// If the balance is not below 0, at least the wanted share of all weight lies up to v, whatever the weights are. If it
/// is below 0, less does.
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

/// Sums of n nonnegative numbers, to nearest: products and additions are off by less than (n + 2) u in all, u = 2^-53,
/// relative to the result.
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

/// The percentile is no less than v if less weight than wanted lies up to v, no more than v if as much does.
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

namespace {

/// More than the sum of the roundings of differences, squares, sums and roots, relative to the result.
constexpr double relative = 0x1p-48;
/// More than the error that underflow in them may cause.
constexpr double underflow = 0x1p-500;

Interval interval(const Enclosure& e) {
  return {e.lo, e.hi};
}

/// Squares and their sums are far from overflow.
constexpr double largest_size = 1e150;

bool is_bounded(const Enclosure& e) {
  return e.lo > -largest_size && e.hi < largest_size;
}

struct Values {
  std::array<Interval, 3> at_corners;
  Interval at_centre;

  [[nodiscard]] double least_lower() const {
    return std::min({at_corners[0].lower(), at_corners[1].lower(), at_corners[2].lower()});
  }
  [[nodiscard]] double greatest_upper() const {
    return std::max({at_corners[0].upper(), at_corners[1].upper(), at_corners[2].upper()});
  }
};

Interval mean_of(const std::array<Interval, 3>& values) {
  return (values[0] + values[1] + values[2]) / Interval(3);
}

/// Between the interpolation of these values minus `fall` and the interpolation plus `rise`.
AffineBounds about(const std::array<Interval, 3>& values, double fall, double rise, bool squared) {
  AffineBounds bounds{.below = -fall, .above = rise, .squared = squared};
  for (std::size_t i = 0; i < 3; ++i) {
    const double value = 0.5 * values[i].lower() + 0.5 * values[i].upper();
    bounds.values[i] = value;
    // An interpolation of numbers that are off by no more is off by no more.
    bounds.below = std::min(bounds.below, (values[i] - Interval(value) - Interval(fall)).lower());
    bounds.above = std::max(bounds.above, (values[i] - Interval(value) + Interval(rise)).upper());
  }
  std::ranges::sort(bounds.values);
  return bounds;
}

/// Bounds by the distances d alone, for any solid.
PieceDistances by_distances(const Values& d, const PieceShape& shape) {
  const auto& [corners, at_centre] = d;
  const Interval squared_at_centre = square(at_centre);
  const std::array<Interval, 3> squared{square(corners[0]), square(corners[1]), square(corners[2])};
  const Interval mean_square = mean_of(squared);
  const Interval moment(shape.moment);

  // d² - |x|² is concave, and so d² >= Σ λ d²(corner) - Σ λ |x - corner|², where the last sum is at most radius².
  const double least_squared = (square(Interval(d.least_lower())) - Interval(shape.radius_squared)).lower();
  const double least = least_squared > 0.0 ? square_root(least_squared, Direction::down) : 0.0;
  const double lower = std::max({0.0, (at_centre - Interval(shape.radius)).lower(), least});

  // A concave function rises over its interpolation at the corners nowhere by more than three times its rise at the
  // centroid.
  const Interval excess = squared_at_centre - mean_square + Interval(4) * moment;
  const Interval greatest =
      square(Interval(d.greatest_upper())) + Interval(3) * Interval(std::max(0.0, excess.upper()));
  const double upper =
      std::min({(at_centre + Interval(shape.radius)).upper(),
                (Interval(d.greatest_upper()) + Interval(covering_share) * Interval(shape.longest)).upper(),
                sqrt(greatest).upper()});

  // Means of d²: Jensen's inequality from above, the interpolation's mean from below. d² <= (A + B) d - A B where
  // A <= d <= B.
  const double mean_upper = std::min(upper, sqrt(squared_at_centre + moment).upper());
  double mean_lower = std::max(lower, (at_centre - Interval(shape.spread)).lower());
  if (upper > 0.0) {
    const Interval range_sum = Interval(lower) + Interval(upper);
    const Interval below = mean_square - Interval(3) * moment + Interval(lower) * Interval(upper);
    mean_lower = std::max(mean_lower, (below / range_sum).lower());
  }
  const double rise = (Interval(3) * Interval(std::max(0.0, excess.upper()))).upper();
  return {{lower, upper}, {mean_lower, mean_upper}, about(squared, shape.radius_squared, rise, true)};
}

/// Bounds by the signed distances if they are a convex function. It lies below its interpolation at the corners, by at
/// most three times its fall at the centroid.
PieceDistances by_convexity(const Values& s) {
  const auto& [corners, at_centre] = s;
  const Interval interpolated = mean_of(corners);
  const double fall = std::max(0.0, (interpolated - at_centre).upper());
  const double least = (Interval(s.least_lower()) - Interval(3) * Interval(fall)).lower();
  const double greatest = std::max(least, s.greatest_upper());
  const Enclosure range = magnitude({least, greatest});
  const double mean_least = at_centre.lower();
  const double mean_greatest = std::max(mean_least, interpolated.upper());
  const double thrice = (Interval(3) * Interval(fall)).upper();
  const Enclosure mean = magnitude({mean_least, mean_greatest});
  if (least >= 0.0) return {range, mean, about(corners, thrice, 0.0, false)};
  if (greatest <= 0.0) return {range, mean, about({-corners[0], -corners[1], -corners[2]}, 0.0, thrice, false)};
  // For values of both signs: |interpolation - fall|.
  const Interval magnitudes = mean_of({abs(corners[0]), abs(corners[1]), abs(corners[2])});
  const double upper = (magnitudes + Interval(fall)).upper();
  return {range, {std::max({0.0, mean_least, -mean_greatest}), std::min(upper, range.hi)}};
}

Enclosure common(const Enclosure& a, const Enclosure& b) {
  return intersection(a, b, [] { return "distances on a piece of a triangle"; });
}

double distance_between(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

}  // namespace

/// With M the triangle's largest coordinate (pieces near the origin inherit the roundings of far ones) and u = 2^-53, a
/// midpoint rounds by u M in each coordinate, on top of the average error of its two ends. After k halvings a corner is
/// off by at most √3 k u M, the centre, of three corners, by √3 4 u M more. For k <= 60 that is less than 111 u M <
/// 2^-46 M. Underflow costs less than the smallest normal number.
double displacement(const Triangle& whole) {
  return 0x1p-46 * largest_coordinate(whole) + std::numeric_limits<double>::min();
}

Point centre(const Triangle& corners) {
  Point sum;
  for (std::size_t i = 0; i < 3; ++i) sum[i] = corners[0][i] / 3 + corners[1][i] / 3 + corners[2][i] / 3;
  return sum;
}

LongestSide longest_side(const Triangle& corners) {
  LongestSide longest{0, 1, {}};
  double length = -1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double side = distance_between(corners[i], corners[(i + 1) % 3]);
    if (side > length) {
      length = side;
      longest.from = i;
      longest.to = (i + 1) % 3;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    longest.middle[i] = 0.5 * corners[longest.from][i] + 0.5 * corners[longest.to][i];
  }
  return longest;
}

std::array<TrianglePiece, 2> halves(const TrianglePiece& piece, const LongestSide& side, const Enclosure& at_middle) {
  std::array<TrianglePiece, 2> halves{piece, piece};
  halves[0].corners[side.to] = side.middle;
  halves[0].at_corners[side.to] = at_middle;
  halves[1].corners[side.from] = side.middle;
  halves[1].at_corners[side.from] = at_middle;
  for (TrianglePiece& half : halves) ++half.halvings;
  return halves;
}

Enclosure area_of(const Triangle& triangle) {
  const auto exact = [](const Point& p) { return Vector3<double>(p[0], p[1], p[2]); };
  const Vector3<double> u = exact(triangle[1]) - exact(triangle[0]);
  const Vector3<double> v = exact(triangle[2]) - exact(triangle[0]);
  const Interval area = length(cross(u, v)) / Interval(2);
  return {std::max(0.0, area.lower()), area.upper()};
}

/// |corner - centroid|² = (2 b² + 2 c² - a²)/9 where a is the side against the corner.
PieceShape shape_of(const Triangle& corners, double displacement) {
  const double off = 2.0 * displacement + underflow;  // of both ends
  std::array<double, 3> squared{};                    // sides from above, against each corner
  std::array<double, 3> squared_below{};
  double longest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Point& a = corners[(i + 1) % 3];
    const Point& b = corners[(i + 2) % 3];
    double squares = 0.0;
    for (std::size_t k = 0; k < 3; ++k) squares += (a[k] - b[k]) * (a[k] - b[k]);
    const double side = std::sqrt(squares);
    const double upper = side * (1.0 + relative) + off;
    const double lower = std::max(0.0, side * (1.0 - relative) - off);
    longest = std::max(longest, upper);
    squared[i] = upper * upper * (1.0 + relative) + underflow;
    squared_below[i] = lower * lower * (1.0 - relative);
  }
  if (!(longest < largest_size)) return {infinity, infinity, infinity, infinity, infinity};
  double radius_squared = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double others = 2.0 * (squared[(i + 1) % 3] + squared[(i + 2) % 3]);
    // The difference is of sizes up to `others`.
    radius_squared = std::max(radius_squared, (others - squared_below[i] + relative * others) / 9.0);
  }
  radius_squared = radius_squared * (1.0 + relative) + underflow;
  const double moment = (squared[0] + squared[1] + squared[2]) / 36.0 * (1.0 + relative);
  return {longest, std::sqrt(radius_squared) * (1.0 + relative), radius_squared, moment,
          std::sqrt(moment) * (1.0 + relative)};
}

PieceDistances distances_on(const TrianglePiece& piece, const PieceShape& shape) {
  bool bounded = shape.longest < largest_size && is_bounded(piece.at_centre);
  for (const Enclosure& e : piece.at_corners) bounded = bounded && is_bounded(e);
  if (!bounded) return {{0.0, infinity}, {0.0, infinity}};

  const Values given{{interval(piece.at_corners[0]), interval(piece.at_corners[1]), interval(piece.at_corners[2])},
                     interval(piece.at_centre)};
  const Values distances{{abs(given.at_corners[0]), abs(given.at_corners[1]), abs(given.at_corners[2])},
                         abs(given.at_centre)};
  PieceDistances result = by_distances(distances, shape);
  if (piece.convex) {
    const PieceDistances convex = by_convexity(given);
    result = {common(result.range, convex.range), common(result.mean, convex.mean),
              convex.affine.above < infinity ? convex.affine : result.affine};
  }
  result.mean = common(result.mean, result.range);
  return result;
}

Enclosure widened(const Enclosure& distance, double displacement) {
  return {subtract(distance.lo, displacement, Direction::down), add(distance.hi, displacement, Direction::up)};
}

Enclosure magnitude(const Enclosure& signed_distance) {
  const auto& [lo, hi] = signed_distance;
  if (lo >= 0.0) return {lo, hi};
  if (hi <= 0.0) return {-hi, -lo};
  return {0.0, std::max(-lo, hi)};
}

namespace {

constexpr Enclosure anything{-infinity, infinity};

/// One triangle's proof as it is followed.
class Walk {
 public:
  Walk(const Triangle& triangle, const TriangleProof& proof, const SampleProofs& proofs)
      : proof_(proof), proofs_(proofs), area_(area_of(triangle)), off_(displacement(triangle)) {}

  /// False if the proof ends before it covers all of the triangle.
  [[nodiscard]] bool follow(const TrianglePiece& whole) {
    std::vector<TrianglePiece> open{whole};
    for (const PieceProof step : proof_.pieces) {
      if (open.empty()) return false;
      const TrianglePiece piece = open.back();
      open.pop_back();
      if (step == PieceProof::halved) {
        if (piece.halvings == most_halvings_of_piece || used_ == proof_.samples.size()) return false;
        const LongestSide side = longest_side(piece.corners);
        const auto parts = halves(piece, side, next(side.middle));
        open.insert(open.end(), {parts[1], parts[0]});
      } else if (!settle(piece, step == PieceProof::centre)) {
        return false;
      }
    }
    return open.empty();
  }

  [[nodiscard]] TriangleDistances found() const { return {largest_, cells_}; }

 private:
  /// The distance at the exact point of the triangle, from the point x rounded to nearest.
  [[nodiscard]] Enclosure next(const Point& x) {
    const Enclosure proven = widened(proofs_.distance(x, proof_.samples[used_++]), off_);
    largest_ = std::max(largest_, magnitude(proven).lo);
    return proven;
  }

  [[nodiscard]] bool settle(TrianglePiece piece, bool with_centre) {
    const PieceShape shape = shape_of(piece.corners, off_);
    piece.convex = proofs_.convex;
    piece.at_centre = at_centre_by_corners(piece, shape);
    if (with_centre) {
      if (used_ == proof_.samples.size()) return false;
      const Point x = centre(piece.corners);
      const Certificate& certificate = proof_.samples[used_].certificate;
      piece.at_centre = intersection(piece.at_centre, next(x), [&] { return "the signed distance at " + text_of(x); });
      piece.convex = piece.convex || proofs_.is_one_convex(x, reach_of(piece.at_centre, shape, off_), certificate);
    }
    const PieceDistances distances = distances_on(piece, shape);
    const double share = std::ldexp(1.0, -piece.halvings);
    cells_.push_back({{multiply(area_.lo, share, Direction::down), multiply(area_.hi, share, Direction::up)},
                      distances.range,
                      distances.mean,
                      distances.affine});
    return true;
  }

  const TriangleProof& proof_;
  const SampleProofs& proofs_;
  Enclosure area_;
  double off_;
  std::size_t used_ = 0;  ///< samples
  double largest_ = 0.0;
  std::vector<WeightedCell> cells_;
};

}  // namespace

bool is_one_convex_primitive(const Model& model) {
  return model.primitives.size() == 1 && is_union_of_convex(model);
}

Enclosure at_centre_by_corners(const TrianglePiece& piece, const PieceShape& shape) {
  Enclosure result = anything;
  for (const Enclosure& at_corner : piece.at_corners) {
    const Enclosure reached = widened(at_corner, shape.radius);
    result = intersection(result, reached, [] { return "the signed distance at a triangle's centre"; });
  }
  return result;
}

/// A ball about any point x of the piece that reaches as far as the surface ends within d(c) + 2 radius of c.
double reach_of(const Enclosure& at_centre, const PieceShape& shape, double displacement) {
  const double radii = multiply(2.0, shape.radius, Direction::up);
  return add(add(magnitude(at_centre).hi, radii, Direction::up), displacement, Direction::up);
}

TriangleDistances distances_on(const Triangle& triangle, const std::array<Enclosure, 3>& at_corners,
                               const TriangleProof& proof, const SampleProofs& proofs) {
  Walk walk(triangle, proof, proofs);
  if (walk.follow({.corners = triangle, .triangle = 0, .at_corners = at_corners})) return walk.found();
  return {walk.found().largest, {{area_of(triangle), {0.0, infinity}, {0.0, infinity}}}};
}

}  // namespace verisq::verify
