/// Floating point proposes the nearest point; that point bounds the distance from above, the plane through it from
/// below. u = 2^-53 throughout.
#include "verify/deviation/triangle_distance_bounds.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "verify/analysis/largest_coordinate.hpp"
#include "verify/proposals/triangle.hpp"

namespace verisq::verify {

namespace {

/// More than what underflows in any of the sums here may hide: roots of less than 2^-1000.
constexpr double underflow = 0x1p-500;

/// Shares of the second and the third corner.
struct Weights {
  double b;
  double c;
};

/// Ericson, Real-Time Collision Detection (2005), 5.1.5: which of the corners, edges and the face is nearest. Whatever
/// it says, NaN included, is clamped into the triangle.
Weights near_weights(const Point& p, const Triangle& triangle) {
  const Point ab = difference(triangle[1], triangle[0]);
  const Point ac = difference(triangle[2], triangle[0]);
  const Point ap = difference(p, triangle[0]);
  const double d1 = dot(ab, ap);
  const double d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {0.0, 0.0};
  const Point bp = difference(p, triangle[1]);
  const double d3 = dot(ab, bp);
  const double d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return {1.0, 0.0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {d1 / (d1 - d3), 0.0};
  const Point cp = difference(p, triangle[2]);
  const double d5 = dot(ab, cp);
  const double d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 1.0};
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

/// The share of `to` at the point of a segment nearest to p; 0 for NaN.
double near_share(const Point& p, const Point& from, const Point& to) {
  const Point way = difference(to, from);
  const double share = dot(difference(p, from), way) / dot(way, way);
  return share > 0.0 ? std::min(share, 1.0) : 0.0;
}

Weights clamped(const Weights& weights) {
  const double b = weights.b > 0.0 ? std::min(weights.b, 1.0) : 0.0;
  const double c = weights.c > 0.0 ? std::min(weights.c, 1.0 - b) : 0.0;
  return {b, c};
}

/// Off the exact point of these weights, which are exactly in [0, 1] with a sum of at most 1 + u, by less than 2^-48 M,
/// M the triangle's largest coordinate: the two differences and products of at most 2M round by u each, the sums, of
/// which one is at most 3M large, by u each, and beyond the sum of 1 lie 2uM: less than 16uM a coordinate.
Point point_at(const Triangle& triangle, const Weights& weights) {
  Point point;
  for (std::size_t i = 0; i < 3; ++i) {
    const double a = triangle[0][i];
    point[i] = a + weights.b * (triangle[1][i] - a) + weights.c * (triangle[2][i] - a);
  }
  return point;
}

/// Differences of binary64 numbers, squares, sums and the root round by at most 8u in all, relative to the result.
double length_up(const Point& v) {
  return std::sqrt(dot(v, v)) * (1.0 + 0x1p-49) + underflow;
}

/// The triangle lies in {x : v·(point - x) >= least v·(point - corner)}, for any v. Each product is of two rounded
/// numbers, with their sum off by at most 5u of the sum of magnitudes; |v| from above and the quotient by 10u more.
double lower_by(const Point& point, const Point& v, const Triangle& triangle) {
  double least = infinity;
  for (const Point& corner : triangle) {
    double sum = 0.0;
    double magnitude = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double product = v[i] * (point[i] - corner[i]);
      sum += product;
      magnitude += std::abs(product);
    }
    const double bound = sum - 0x1p-49 * magnitude;
    if (std::isnan(bound)) return 0.0;  // products beyond binary64: of this corner nothing is known
    least = std::min(least, bound);
  }
  const double lower = least / length_up(v) * (1.0 - 0x1p-49) - underflow;
  return lower > 0.0 && lower < infinity ? lower : 0.0;
}

struct Bounds {
  Enclosure distance;
  Point way;  ///< from the proposed point to the query
};

double upper_of(const Point& way, double displacement) {
  const double length = (length_up(way) + displacement) * (1.0 + 0x1p-52);
  return length >= 0.0 ? length : infinity;  // NaN is no bound
}

Bounds bounds_at(const Point& point, const Triangle& triangle, const Weights& weights, double displacement) {
  const Point way = difference(point, point_at(triangle, clamped(weights)));
  return {{lower_by(point, way, triangle), upper_of(way, displacement)}, way};
}

/// Where the determinants of a needle cancel the face is nowhere: its sides know better.
Enclosure with_sides(const Point& point, const Triangle& triangle, Enclosure distance, double displacement) {
  const auto& [a, b, c] = triangle;
  const double on_bc = near_share(point, b, c);
  const std::array sides{Weights{near_share(point, a, b), 0.0}, Weights{0.0, near_share(point, a, c)},
                         Weights{1.0 - on_bc, on_bc}};
  for (const Weights& side : sides) {
    const Enclosure at_side = bounds_at(point, triangle, side, displacement).distance;
    distance = {std::max(distance.lo, at_side.lo), std::min(distance.hi, at_side.hi)};
  }
  return distance;
}

double displacement_of(const Triangle& triangle) {
  return 0x1p-48 * largest_coordinate(triangle) + underflow;
}

}  // namespace

Enclosure distance_from_triangle(const Point& point, const Triangle& triangle) {
  const double displacement = displacement_of(triangle);
  const Enclosure distance = bounds_at(point, triangle, near_weights(point, triangle), displacement).distance;
  if (distance.hi - distance.lo <= 0x1p-20 * distance.hi + 4.0 * displacement) return distance;
  return with_sides(point, triangle, distance, displacement);
}

double distance_from_triangle_up(const Point& point, const Triangle& triangle) {
  return distance_from_triangle(point, triangle).hi;
}

}  // namespace verisq::verify
