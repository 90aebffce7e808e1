/// Lipschitz continuity, the concavity of d² - |x|², and where it is there the convexity of the signed distance. The
/// derivations stand in docs/mathematics.md §20.
#include "verify/deviation/triangle_piece.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "verify/analysis/cross_product.hpp"
#include "verify/analysis/largest_coordinate.hpp"
#include "verify/numbers/interval.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/intersection.hpp"

namespace verisq::verify {

namespace {

/// More than what the roundings of differences, squares, sums and roots add up to, relative to the result.
constexpr double relative = 0x1p-48;
/// More than what underflows in them may hide.
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

/// Between the interpolation of these values less `fall` and that plus `rise`.
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

/// Every point of a triangle is no farther from the nearest corner than the longest side over √3.
constexpr double covering_share = 0.5773502691896258;  // 1/√3 from above

/// By the distances d alone, whatever the solid is.
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

  // Over its interpolation at the corners a concave function rises nowhere by more than thrice what it does at the
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

/// By the signed distances where they are a convex function: between its interpolation, from above, and thrice what
/// falls below that at the centroid.
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
  // Of both signs: |interpolation - fall|.
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
/// midpoint rounds by u M in each coordinate, on top of what its two ends are off on average: after k halvings a corner
/// is off by at most √3 k u M, the centre, of three corners, by √3 4 u M more. For k <= 60 that is less than 111 u M <
/// 2^-46 M; what underflows is less than the smallest normal number.
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

}  // namespace verisq::verify
