/// This file implements triangle_geometry.hpp.
#include "verify/search/triangle_geometry.hpp"

#include <algorithm>
#include <cmath>

#include "verify/numbers/real.hpp"

namespace verisq::verify {

namespace {

using Seen = SeenTriangle<double>;

Point outer(const Point& x, const Point& y) {
  return {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
}

double lower_by(const Seen& seen, const Point& n) {
  const double square = inner(n, n);
  return lower_by(seen, n, square, std::sqrt(square));
}

/// The share of the end at the point of a side nearest to the origin; NaN where the ends coincide.
double near_share(const Point& from, const Point& way) {
  return -inner(from, way) / inner(way, way);
}

/// Needles, and what lies near the plane: sides and the plane's own normal know better.
DistanceBounds with_sides_and_normal(const Seen& seen, DistanceBounds bounds) {
  const Shares<double> on_bc =
      clamped(near_share(seen.b, {seen.c[0] - seen.b[0], seen.c[1] - seen.b[1], seen.c[2] - seen.b[2]}), 0.0);
  const std::array sides{clamped(near_share(seen.a, seen.ab), 0.0), clamped(0.0, near_share(seen.a, seen.ac)),
                         Shares<double>{1.0 - on_bc.b, on_bc.b}};
  for (const Shares<double>& side : sides) {
    const DistanceBounds other = bounds_at(seen, side);
    bounds.lower = std::max(bounds.lower, other.lower);
    if (other.upper < bounds.upper) {
      bounds.upper = other.upper;
      bounds.way = other.way;
    }
  }
  const Point normal = outer(seen.ab, seen.ac);
  bounds.lower = std::max({bounds.lower, lower_by(seen, normal), lower_by(seen, {-normal[0], -normal[1], -normal[2]})});
  return bounds;
}

/// Ericson, Real-Time Collision Detection (2005), 5.1.5: which of corners, sides and face is nearest. It proposes only.
Shares<double> near_shares(const Seen& seen) {
  const double d1 = -inner(seen.ab, seen.a);
  const double d2 = -inner(seen.ac, seen.a);
  if (d1 <= 0.0 && d2 <= 0.0) return {0.0, 0.0};
  const double d3 = -inner(seen.ab, seen.b);
  const double d4 = -inner(seen.ac, seen.b);
  if (d3 >= 0.0 && d4 <= d3) return {1.0, 0.0};
  const double d5 = -inner(seen.ab, seen.c);
  const double d6 = -inner(seen.ac, seen.c);
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 1.0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {d1 / (d1 - d3), 0.0};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {0.0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    const double share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {1.0 - share, share};
  }
  const double sum = va + vb + vc;
  return {vb / sum, vc / sum};
}

}  // namespace

DistanceBounds distance_bounds(const Point& point, const Triangle& triangle) {
  const Seen seen(point, triangle);
  const Shares<double> shares = near_shares(seen);
  const DistanceBounds bounds = bounds_at(seen, clamped(shares.b, shares.c));
  return are_loose(seen, bounds) ? with_sides_and_normal(seen, bounds) : bounds;
}

namespace {

/// Sums of products of three differences of binary64 numbers are multiples of 2^-3222 below 2^3080: with so many bits
/// nothing is rounded.
using Exact = MpfrNumber<6400>;

Exact operator-(const Exact& a, const Exact& b) {
  return subtract(a, b, Direction::down);
}
Exact operator+(const Exact& a, const Exact& b) {
  return add(a, b, Direction::down);
}
Exact operator*(const Exact& a, const Exact& b) {
  return multiply(a, b, Direction::down);
}

int sign_of(const Exact& x) {
  return mpfr_sgn(x.get()) > 0 ? 1 : (mpfr_sgn(x.get()) < 0 ? -1 : 0);
}

int sign_of(double x) {
  return x > 0.0 ? 1 : (x < 0.0 ? -1 : 0);
}

Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// A cross product of rounded differences, and the sums of the magnitudes of its products: each component is off by
/// at most 4.01 u of these (u = 2^-53), as differences, products and their difference round by u.
struct Cross {
  Point value;
  Point magnitude;

  Cross(const Point& x, const Point& y) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      const std::size_t k = (i + 2) % 3;
      const double plus = x[j] * y[k];
      const double less = x[k] * y[j];
      value[i] = plus - less;
      magnitude[i] = std::abs(plus) + std::abs(less);
    }
  }
};

/// A product of vectors and the sum of magnitudes that bounds how far it is off.
struct Product {
  double value = 0.0;
  double magnitude = 0.0;

  /// Proven, of factors that are off by `rounding` of the sum of magnitudes in all.
  [[nodiscard]] int sign(double rounding, double underflow) const {
    return std::abs(value) > rounding * magnitude + underflow ? sign_of(value) : 0;  // false for NaN
  }
};

Product product(const Point& x, const Point& y) {
  Product sum;
  for (std::size_t i = 0; i < 3; ++i) {
    sum.value += x[i] * y[i];
    sum.magnitude += std::abs(x[i] * y[i]);
  }
  return sum;
}

int exact_orientation(const Triangle& triangle, const Point& point) {
  std::array<std::array<Exact, 3>, 3> row;
  for (std::size_t i = 0; i < 3; ++i) {
    const Exact from(triangle[0][i]);
    row[0][i] = Exact(triangle[1][i]) - from;
    row[1][i] = Exact(triangle[2][i]) - from;
    row[2][i] = Exact(point[i]) - from;
  }
  Exact sum;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    sum = sum + row[2][i] * (row[0][j] * row[1][k] - row[0][k] * row[1][j]);
  }
  return sign_of(sum);
}

/// The sign of the area of a, b and c in the plane of the coordinates i and j.
int planar_orientation(const Point& a, const Point& b, const Point& c, std::size_t i, std::size_t j) {
  const double plus = (b[i] - a[i]) * (c[j] - a[j]);
  const double less = (b[j] - a[j]) * (c[i] - a[i]);
  // Each product rounds by 3.01 u, the difference by u.
  const double area = plus - less;
  if (std::abs(area) > 0x1p-50 * (std::abs(plus) + std::abs(less)) + 0x1p-1000) return sign_of(area);
  const Exact exact = (Exact(b[i]) - Exact(a[i])) * (Exact(c[j]) - Exact(a[j])) -
                      (Exact(b[j]) - Exact(a[j])) * (Exact(c[i]) - Exact(a[i]));
  return sign_of(exact);
}

bool lies_on_segment(const Point& point, const Point& a, const Point& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (point[i] < std::min(a[i], b[i]) || point[i] > std::max(a[i], b[i])) return false;
    if (planar_orientation(a, b, point, i, (i + 1) % 3) != 0) return false;
  }
  return true;
}

}  // namespace

std::optional<int> near_orientation(const Triangle& triangle, const Point& point) {
  const double side = proven_side(Seen(point, triangle));
  return side != 0.0 ? std::optional(sign_of(side)) : std::nullopt;
}

int orientation(const Triangle& triangle, const Point& point) {
  const std::optional<int> near = near_orientation(triangle, point);
  return near ? *near : exact_orientation(triangle, point);
}

bool is_degenerate(const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return planar_orientation(a, b, c, 0, 1) == 0 && planar_orientation(a, b, c, 1, 2) == 0 &&
         planar_orientation(a, b, c, 2, 0) == 0;
}

bool lies_on(const Point& point, const Triangle& triangle) {
  if (orientation(triangle, point) != 0) return false;
  const auto& [a, b, c] = triangle;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const int whole = planar_orientation(a, b, c, i, j);
    if (whole == 0) continue;
    return planar_orientation(a, b, point, i, j) != -whole && planar_orientation(b, c, point, i, j) != -whole &&
           planar_orientation(c, a, point, i, j) != -whole;
  }
  return lies_on_segment(point, a, b) || lies_on_segment(point, b, c) || lies_on_segment(point, c, a);
}

namespace {

/// The sign of the area of a, b and the point moved by (e, e²) in the plane of i and j, for all small e > 0; 0 only
/// where a and b coincide there.
int moved_orientation(const Point& a, const Point& b, const Point& point, std::size_t i, std::size_t j) {
  if (const int sign = planar_orientation(a, b, point, i, j); sign != 0) return sign;
  if (a[j] != b[j]) return a[j] > b[j] ? 1 : -1;
  return sign_of(b[i] - a[i]);
}

}  // namespace

int crossing(const Point& point, std::size_t axis, bool upward, const Triangle& triangle) {
  const std::size_t i = (axis + 1) % 3;
  const std::size_t j = (axis + 2) % 3;
  const auto& [a, b, c] = triangle;
  const int turn = moved_orientation(a, b, point, i, j);
  if (turn == 0 || moved_orientation(b, c, point, i, j) != turn || moved_orientation(c, a, point, i, j) != turn)
    return 0;
  const int ahead = upward ? -turn : turn;  // where the point lies to the plane if the plane lies ahead of it
  return orientation(triangle, point) == ahead ? -ahead : 0;
}

namespace {

// Pairs of triangles: a plane that has one on either side.

/// Differences, products and two sums round by 4.01 u.
constexpr double rounding_of_product = 5 * 0x1p-53;
constexpr double underflow_of_product = 0x1p-760;

int proven_sign(const Point& normal, const Point& difference) {
  return product(normal, difference).sign(rounding_of_product, underflow_of_product);
}

/// a and b are common. The half planes beyond their line through the third corners are more than a right angle apart,
/// or in different planes: 4.01 u of either normal, the product and two sums, 11.1 u in all.
bool meet_in_side(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Point side = minus(b, a);
  const Cross first(side, minus(c, a));
  const Cross second(side, minus(d, a));
  Product angle = product(first.value, second.value);
  angle.magnitude = product(first.magnitude, second.magnitude).magnitude;
  return angle.sign(0x1p-49, 0x1p-650) < 0 || orientation({a, b, c}, d) != 0;
}

/// Strictly, but for the common corner: both b and c above, d and e below.
bool parts(const Point& normal, const std::array<Point, 4>& ways) {
  return proven_sign(normal, ways[0]) > 0 && proven_sign(normal, ways[1]) > 0 && proven_sign(normal, ways[2]) < 0 &&
         proven_sign(normal, ways[3]) < 0;
}

/// The mean of the directions, and a few steps towards those that it does not part (a perceptron); NaN parts nothing.
bool are_parted_about(const std::array<Point, 4>& ways) {
  std::array<Point, 4> towards;
  Point normal{};
  for (std::size_t k = 0; k < 4; ++k) {
    const double length = std::sqrt(product(ways[k], ways[k]).value) * (k < 2 ? 1.0 : -1.0);
    for (std::size_t i = 0; i < 3; ++i) normal[i] += towards[k][i] = ways[k][i] / length;
  }
  constexpr int steps = 6;
  for (int step = 0; step < steps; ++step) {
    if (parts(normal, ways)) return true;
    std::size_t worst = 0;
    double least = HUGE_VAL;
    for (std::size_t k = 0; k < 4; ++k) {
      const double height = product(normal, towards[k]).value;
      if (height < least) {
        least = height;
        worst = k;
      }
    }
    for (std::size_t i = 0; i < 3; ++i) normal[i] += (0.5 - least) * towards[worst][i];
  }
  return false;
}

/// v is common. Of two triangles in general position a plane through v along one side of each parts them, or the plane
/// of one of them.
bool meet_in_corner(const Point& v, const std::array<Point, 4>& others) {
  const auto& [b, c, d, e] = others;
  if (are_parted_about({minus(b, v), minus(c, v), minus(d, v), minus(e, v)})) return true;
  const auto sides = [&v](const Point& x, const Point& y, const Point& p, const Point& q) {
    return orientation({v, x, y}, p) * orientation({v, x, y}, q);
  };
  return sides(b, c, d, e) > 0 || sides(d, e, b, c) > 0 || sides(b, d, c, e) < 0 || sides(b, e, c, d) < 0 ||
         sides(c, d, b, e) < 0 || sides(c, e, b, d) < 0;
}

struct Range {
  double lower = HUGE_VAL;
  double upper = -HUGE_VAL;
};

/// The proven range of normal·(corner - from).
Range range_of(const Point& normal, const Point& from, const Triangle& triangle) {
  Range range;
  for (const Point& corner : triangle) {
    const Product height = product(normal, minus(corner, from));
    const double margin = 2.0 * rounding_of_product * height.magnitude + underflow_of_product;
    range.lower = std::min(range.lower, height.value - margin);
    range.upper = std::max(range.upper, height.value + margin);
  }
  return range;
}

bool are_apart_along(const Point& normal, const Triangle& first, const Triangle& second) {
  const Range a = range_of(normal, first[0], first);
  const Range b = range_of(normal, first[0], second);
  return a.upper < b.lower || b.upper < a.lower;  // false for NaN
}

bool boxes_are_apart(const Triangle& first, const Triangle& second) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [low, high] = std::minmax({first[0][i], first[1][i], first[2][i]});
    const auto [other_low, other_high] = std::minmax({second[0][i], second[1][i], second[2][i]});
    if (high < other_low || other_high < low) return true;
  }
  return false;
}

bool are_apart(const Triangle& first, const Triangle& second) {
  if (boxes_are_apart(first, second)) return true;
  std::array<Point, 3> sides;
  std::array<Point, 3> other_sides;
  for (std::size_t k = 0; k < 3; ++k) {
    sides[k] = minus(first[(k + 1) % 3], first[k]);
    other_sides[k] = minus(second[(k + 1) % 3], second[k]);
  }
  const Point normal = Cross(sides[0], sides[1]).value;
  const Point other_normal = Cross(other_sides[0], other_sides[1]).value;
  if (are_apart_along(normal, first, second) || are_apart_along(other_normal, first, second)) return true;
  for (std::size_t k = 0; k < 3; ++k) {
    if (are_apart_along(Cross(normal, sides[k]).value, first, second)) return true;
    if (are_apart_along(Cross(other_normal, other_sides[k]).value, first, second)) return true;
  }
  for (const Point& side : sides) {
    for (const Point& other : other_sides) {
      if (are_apart_along(Cross(side, other).value, first, second)) return true;
    }
  }
  return false;
}

}  // namespace

bool meet_in_common_corners(const Triangle& first, const Corners& of_first, const Triangle& second,
                            const Corners& of_second) {
  std::array<std::size_t, 3> in_second{};
  std::size_t common = 0;
  std::size_t shared = 0;  // the last common corner of the first triangle
  std::size_t alone = 0;   // the last that is not
  for (std::size_t k = 0; k < 3; ++k) {
    const auto* const place = std::ranges::find(of_second, of_first[k]);
    in_second[k] = static_cast<std::size_t>(place - of_second.begin());
    if (place == of_second.end()) {
      alone = k;
    } else {
      shared = k;
      ++common;
    }
  }
  if (common == 0) return are_apart(first, second);
  const std::size_t other = in_second[shared];
  if (common == 1) {
    return meet_in_corner(first[shared], {first[(shared + 1) % 3], first[(shared + 2) % 3], second[(other + 1) % 3],
                                          second[(other + 2) % 3]});
  }
  if (common > 2) return false;
  const std::size_t a = (alone + 1) % 3;
  const std::size_t b = (alone + 2) % 3;
  if (in_second[a] == in_second[b]) return false;  // a degenerate triangle
  return meet_in_side(first[a], first[b], first[alone], second[3 - in_second[a] - in_second[b]]);
}

}  // namespace verisq::verify
