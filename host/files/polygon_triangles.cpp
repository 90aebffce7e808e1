/// The triangles of polygons of mesh_file.hpp.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <numeric>
#include <optional>
#include <verisq/enclosure.hpp>

#include "host/files/mesh_file.hpp"

namespace verisq {
namespace {

using Integer = boost::multiprecision::cpp_int;

constexpr std::array<CoordinatePlane, 3> planes{{{0, 1}, {1, 2}, {2, 0}}};

int sign_of(double x) {
  return (x > 0.0) - (x < 0.0);
}

/// Shewchuk's filter for orient2d (Discrete & Computational Geometry 18, 1997). If the rounded determinant exceeds (3 +
/// 16u)u times the sum of its rounded products, u = 2^-53, its sign is right. Here 8u, and far more than underflow can
/// cost. Overflow gives infinity > infinity or NaN, which is false: left to the exact test.
std::optional<int> filtered_turn(double left, double right) {
  constexpr double relative = 4.0 * std::numeric_limits<double>::epsilon();
  constexpr double underflow = 1e-300;
  const double difference = left - right;
  if (std::abs(difference) > relative * (std::abs(left) + std::abs(right)) + underflow) return sign_of(difference);
  return std::nullopt;
}

/// A difference that binary64 holds exactly, by Knuth's error term; nothing for others, and where it overflows.
std::optional<double> exact_difference(double a, double b) {
  const double difference = a - b;
  const double part_of_b = a - difference;
  const double error = (a - (difference + part_of_b)) + (part_of_b - b);
  if (error == 0.0) return difference;  // not of NaN
  return std::nullopt;
}

/// The sign of a b - c d for numbers whose products are exact in two binary64 parts. Nothing if their parts may
/// underflow, or if the sum of the small parts is not exact: both are rare.
std::optional<int> sign_of_products(double a, double b, double c, double d) {
  constexpr double large_enough = 1e-280;  // the last bit of such a product is above the least subnormal
  const double left = a * b;
  const double right = c * d;
  const auto is_exact = [](double x, double y, double product) {
    return x == 0.0 || y == 0.0 || (std::abs(product) > large_enough && std::isfinite(product));
  };
  if (!is_exact(a, b, left) || !is_exact(c, d, right)) return std::nullopt;
  const std::optional<double> large = exact_difference(left, right);
  const std::optional<double> small = exact_difference(std::fma(c, d, -right), std::fma(a, b, -left));
  if (!large || !small) return std::nullopt;
  return (*large > *small) - (*large < *small);
}

/// `x` in units of 2^unit, which divides it: a finite binary64 number is a mantissa of 53 bits times 2^(e - 53).
Integer in_units(double x, int unit) {
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 53));
  return mantissa == 0 ? Integer(0) : Integer(mantissa) << (exponent - 53 - unit);
}

/// The largest unit of which all are multiples, except for zeros at the end of the mantissas.
int common_unit(const std::array<double, 6>& numbers) {
  int least = std::numeric_limits<int>::max();
  for (const double x : numbers) {
    int exponent = 0;
    if (std::frexp(x, &exponent) != 0.0) least = std::min(least, exponent - 53);
  }
  return least;
}

/// Integers, since rationals spend all their time on common divisors. The sign does not depend on the unit.
int turn_by_integers(const Point& a, const Point& b, const Point& c, const CoordinatePlane& plane) {
  const auto [i, j] = plane;
  const int unit = common_unit({a[i], a[j], b[i], b[j], c[i], c[j]});
  const Integer x = in_units(a[i], unit);
  const Integer y = in_units(a[j], unit);
  const Integer left = (in_units(b[i], unit) - x) * (in_units(c[j], unit) - y);
  const Integer right = (in_units(b[j], unit) - y) * (in_units(c[i], unit) - x);
  return left.compare(right);
}

}  // namespace

int turn(const Point& a, const Point& b, const Point& c, const CoordinatePlane& plane) {
  const auto [i, j] = plane;
  if (const auto sign = filtered_turn((b[i] - a[i]) * (c[j] - a[j]), (b[j] - a[j]) * (c[i] - a[i]))) return *sign;
  const auto bi = exact_difference(b[i], a[i]);
  const auto bj = exact_difference(b[j], a[j]);
  const auto ci = exact_difference(c[i], a[i]);
  const auto cj = exact_difference(c[j], a[j]);
  if (bi && bj && ci && cj) {
    if (const auto sign = sign_of_products(*bi, *cj, *bj, *ci)) return *sign;
  }
  return sign_of(turn_by_integers(a, b, c, plane));
}

bool has_zero_area(const Point& a, const Point& b, const Point& c) {
  return std::ranges::all_of(planes, [&](const CoordinatePlane& plane) { return turn(a, b, c, plane) == 0; });
}

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// Ears and crossings are sought among all pairs of corners: more would take seconds.
constexpr std::size_t most_corners = 4096;

/// A polygon seen along an axis.
class View {
 public:
  View(std::span<const Point> corners, const CoordinatePlane& plane) : corners_(corners), plane_(plane) {}

  [[nodiscard]] std::size_t size() const { return corners_.size(); }
  [[nodiscard]] std::size_t next(std::size_t k) const { return k + 1 == size() ? 0 : k + 1; }
  [[nodiscard]] std::size_t before(std::size_t k) const { return k == 0 ? size() - 1 : k - 1; }
  [[nodiscard]] double across(std::size_t k) const { return corners_[k][plane_[0]]; }
  [[nodiscard]] double along(std::size_t k) const { return corners_[k][plane_[1]]; }
  [[nodiscard]] std::array<double, 2> at(std::size_t k) const { return {across(k), along(k)}; }
  [[nodiscard]] int turn(std::size_t a, std::size_t b, std::size_t c) const {
    return verisq::turn(corners_[a], corners_[b], corners_[c], plane_);
  }

 private:
  std::span<const Point> corners_;
  CoordinatePlane plane_;
};

/// Returns whether all corners turn one way, or go straight on, and the outline goes around once. This is decided by
/// how often its edges change between leading forward, in the order of their ends, and leading back. False if two
/// neighbours are one point, or if an edge leads back into the one before.
bool is_convex(const View& view) {
  int sense = 0;
  int changes = 0;
  for (std::size_t k = 0; k < view.size(); ++k) {
    const std::size_t next = view.next(k);
    if (view.at(k) == view.at(next)) return false;
    const int turn = view.turn(view.before(k), k, next);
    const bool change = (view.at(view.before(k)) < view.at(k)) != (view.at(k) < view.at(next));
    if (turn == 0 ? change : turn == -sense) return false;
    if (turn != 0) sense = turn;
    changes += change ? 1 : 0;
  }
  return sense != 0 && changes == 2;
}

/// Nothing if one of its triangles has no area. Precondition: a convex polygon.
std::optional<Triangles> fan(const View& view) {
  Triangles triangles;
  triangles.reserve(view.size() - 2);
  for (std::size_t k = 2; k < view.size(); ++k) {
    if (view.turn(0, k - 1, k) == 0) return std::nullopt;
    triangles.push_back({0, static_cast<std::uint32_t>(k - 1), static_cast<std::uint32_t>(k)});
  }
  return triangles;
}

/// Precondition: c lies on the line through a and b.
bool is_between(const View& view, std::size_t a, std::size_t b, std::size_t c) {
  const auto [low, high] = std::minmax({view.at(a), view.at(b)});
  return low <= view.at(c) && view.at(c) <= high;
}

/// Returns whether the edges that begin at corners `a` and `b` have a common point, except for the corner that
/// neighbours share.
bool touch(const View& view, std::size_t a, std::size_t b) {
  const std::size_t a_end = view.next(a);
  const std::size_t b_end = view.next(b);
  if (a_end == b) return view.turn(a, b, b_end) == 0 && (view.at(a) < view.at(b)) != (view.at(b) < view.at(b_end));
  if (b_end == a) return touch(view, b, a);
  const int first = view.turn(a, a_end, b);
  const int last = view.turn(a, a_end, b_end);
  if (first == 0 && is_between(view, a, a_end, b)) return true;
  if (last == 0 && is_between(view, a, a_end, b_end)) return true;
  const int other_first = view.turn(b, b_end, a);
  const int other_last = view.turn(b, b_end, a_end);
  if (other_first == 0 && is_between(view, b, b_end, a)) return true;
  if (other_last == 0 && is_between(view, b, b_end, a_end)) return true;
  return first * last < 0 && other_first * other_last < 0;
}

/// Describes where an outline crosses or touches itself; empty if it does not. Edges are compared with those that
/// begin, from one side to the other, before they end.
std::string crossing(const View& view) {
  struct Edge {
    std::size_t corner;
    double low, high;
    double lowest, highest;
  };
  std::vector<Edge> edges;
  edges.reserve(view.size());
  for (std::size_t k = 0; k < view.size(); ++k) {
    const std::size_t next = view.next(k);
    if (view.at(k) == view.at(next)) return fmt::format("its corners {} and {} are one point", k + 1, next + 1);
    const auto [low, high] = std::minmax({view.across(k), view.across(next)});
    const auto [lowest, highest] = std::minmax({view.along(k), view.along(next)});
    edges.push_back({k, low, high, lowest, highest});
  }
  std::ranges::sort(edges, {}, &Edge::low);
  for (auto edge = edges.begin(); edge != edges.end(); ++edge) {
    for (auto other = edge + 1; other != edges.end() && other->low <= edge->high; ++other) {
      if (other->lowest > edge->highest || other->highest < edge->lowest) continue;
      if (!touch(view, edge->corner, other->corner)) continue;
      const auto [first, last] = std::minmax(edge->corner, other->corner);
      return fmt::format("its outline crosses or touches itself, at the edges from corners {} and {}", first + 1,
                         last + 1);
    }
  }
  return {};
}

/// Cuts ears off. An ear is a corner where the outline turns inward, and whose triangle with its neighbours contains no
/// other corner, also not on its border. Such a triangle lies in the polygon, because an edge within it would have an
/// end there. The rest is a simple polygon again, of which the diagonal is an edge. There are always two ears
/// (Meisters, American Mathematical Monthly 82 (1975), 648), also for corners in a line. A corner that turns and the
/// corner nearest to it within its triangle, or else its neighbours, are the ends of a diagonal that touches no corner
/// and separates areas.
class Ears {
 public:
  /// Precondition: the polygon is simple.
  explicit Ears(const View& view) : view_(view), next_(view.size()), before_(view.size()), is_left_(view.size(), 1) {
    for (std::size_t k = 0; k < view.size(); ++k) {
      next_[k] = view.next(k);
      before_[k] = view.before(k);
    }
    std::vector<std::size_t> corners(view.size());
    std::iota(corners.begin(), corners.end(), std::size_t{0});
    // The outermost corner is never reflex, nor straight: neighbours on one line beyond it would lie on each other.
    const std::size_t outermost = *std::ranges::min_element(corners, {}, [&](std::size_t k) { return view.at(k); });
    sense_ = view.turn(view.before(outermost), outermost, view.next(outermost));
  }

  /// Only the neighbours of a removed ear can become ears. For others the triangle stays, and it did not lose a corner
  /// that it contained, since the removed corner lies outside of the rest. So 3 n tests are enough.
  [[nodiscard]] Triangles cut() {
    Triangles triangles;
    std::deque<std::size_t> asked(view_.size());
    std::iota(asked.begin(), asked.end(), std::size_t{0});
    while (!asked.empty() && triangles.size() + 2 < view_.size()) {
      const std::size_t corner = asked.front();
      asked.pop_front();
      if (is_left_[corner] == 0 || !is_ear(corner)) continue;
      const std::size_t before = before_[corner];
      const std::size_t next = next_[corner];
      triangles.push_back(
          {static_cast<std::uint32_t>(before), static_cast<std::uint32_t>(corner), static_cast<std::uint32_t>(next)});
      is_left_[corner] = 0;
      next_[before] = next;
      before_[next] = before;
      asked.push_back(before);
      asked.push_back(next);
    }
    return triangles;
  }

 private:
  [[nodiscard]] bool is_ear(std::size_t corner) const {
    const std::size_t a = before_[corner];
    const std::size_t c = next_[corner];
    if (sense_ * view_.turn(a, corner, c) <= 0) return false;
    for (std::size_t k = next_[c]; k != a; k = next_[k]) {
      if (is_within(a, corner, c, k)) return false;
    }
    return true;
  }

  [[nodiscard]] bool is_within(std::size_t a, std::size_t b, std::size_t c, std::size_t k) const {
    const double x = view_.across(k);
    if (x < std::min({view_.across(a), view_.across(b), view_.across(c)})) return false;
    if (x > std::max({view_.across(a), view_.across(b), view_.across(c)})) return false;
    return sense_ * view_.turn(a, b, k) >= 0 && sense_ * view_.turn(b, c, k) >= 0 && sense_ * view_.turn(c, a, k) >= 0;
  }

  const View& view_;
  std::vector<std::size_t> next_;
  std::vector<std::size_t> before_;
  std::vector<char> is_left_;
  int sense_ = 0;
};

/// Approximate numbers, which choose an axis and are compared with a tolerance. In units of 2^`exponent`, in which
/// corners are at most 1 from the first one: no square overflows, and underflow is negligible beside them.
class Shape {
 public:
  explicit Shape(std::span<const Point> corners) : corners_(corners) {
    double largest = 0.0;
    double farthest = 0.0;
    for (const Point& p : corners) {
      for (std::size_t i = 0; i < 3; ++i) {
        largest = std::max(largest, std::abs(p[i]));
        extent_[i] = std::max(extent_[i], std::abs(half_way(p, i)));
        farthest = std::max(farthest, extent_[i]);
      }
    }
    constexpr int least = -1000;  // so that the scale is finite
    const int exponent = farthest > 0.0 ? std::max(std::ilogb(farthest) + 1, least) : 0;
    scale_ = std::ldexp(1.0, -exponent);
    exponent_ = exponent + 1;  // of whole ways
    largest_ = std::ldexp(largest, -exponent_);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Point a = place(k);
      const Point b = place(k + 1 == corners.size() ? 0 : k + 1);
      for (std::size_t i = 0; i < 3; ++i)
        normal_[i] += a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
      outline_ += std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    }
    area_ = 0.5 * std::hypot(normal_[0], normal_[1], normal_[2]);
  }

  /// The projection along the axis to which Newell's normal is nearest; if outlines cancel and there is none, along the
  /// axis of the least extent.
  [[nodiscard]] CoordinatePlane plane() const {
    const auto size_along = [&](std::size_t axis) { return area_ > 0.0 ? std::abs(normal_[axis]) : -extent_[axis]; };
    constexpr std::array<std::size_t, 3> axes{2, 1, 0};
    const std::size_t axis = *std::ranges::max_element(axes, {}, size_along);
    return {(axis + 1) % 3, (axis + 2) % 3};
  }
  [[nodiscard]] double in_its_units(double length) const { return std::ldexp(length, exponent_); }

  /// The thickness across the plane of the normal.
  [[nodiscard]] double thickness() const {
    double low = infinity;
    double high = -infinity;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const Point x = place(k);
      const double height = x[0] * normal_[0] + x[1] * normal_[1] + x[2] * normal_[2];
      low = std::min(low, height);
      high = std::max(high, height);
    }
    return (high - low) / (2.0 * area_);
  }

  /// For a convex polygon: a polygon that is bent by more than its size has no side that faces anywhere.
  [[nodiscard]] double most_bend() const { return std::sqrt(area_); }

  /// The apparent thickness that a plane polygon may have. Six digits move a coordinate by at most e = 5e-6 of the
  /// largest one, and binary32 by less. So a corner moves by sqrt(3) e, to both sides of the plane. The vector of the
  /// area moves by that times the outline U, because it is half the sum of cross products of corners and the ways
  /// between their neighbours. So Newell's normal turns by an angle of at most sqrt(3) e U / A; no two corners, at most
  /// U / 2 apart, see this as more than that times U / 2. A hundredth of the polygon's size is always more than that:
  /// else it would hardly have a shape.
  [[nodiscard]] double most_thickness() const {
    constexpr double digits = 5e-6;
    constexpr double share = 0.01;
    const double off = std::sqrt(3.0) * digits * largest_;
    return std::min(off * (2.0 + 0.5 * outline_ * outline_ / area_), share * std::sqrt(area_));
  }

 private:
  /// Half of the way from the first corner, which never overflows.
  [[nodiscard]] double half_way(const Point& p, std::size_t axis) const {
    return 0.5 * p[axis] - 0.5 * corners_[0][axis];
  }
  [[nodiscard]] Point place(std::size_t k) const {
    const Point& p = corners_[k];
    return {half_way(p, 0) * scale_, half_way(p, 1) * scale_, half_way(p, 2) * scale_};
  }

  std::span<const Point> corners_;
  int exponent_ = 0;
  double scale_ = 1.0;
  double largest_ = 0.0;  // coordinate
  double outline_ = 0.0;
  double area_ = 0.0;
  Point normal_{};  // of the length of twice the area
  Point extent_{};  // from the first corner, of halves; unscaled
};

PolygonTriangles defect(std::string words) {
  return {{}, std::move(words)};
}

}  // namespace

PolygonTriangles triangles_of_polygon(std::span<const Point> corners) {
  const Shape shape(corners);
  const View view(corners, shape.plane());
  const bool convex = is_convex(view);
  if (convex && shape.thickness() <= shape.most_bend()) {
    if (std::optional<Triangles> triangles = fan(view)) return {*std::move(triangles)};
  }
  if (corners.size() > most_corners) {
    return defect(fmt::format("{} corners that make no fan: at most {} are cut into triangles; split it",
                              corners.size(), most_corners));
  }
  if (!convex) {
    if (std::string words = crossing(view); !words.empty()) return defect(words + "; split it into triangles");
  }
  const double thickness = shape.thickness();
  const double most = shape.most_thickness();
  if (!(thickness <= most)) {  // or there is no area
    return defect(
        fmt::format("no fan covers it, and it is not plane: its corners lie up to {:.3g} apart across it, more "
                    "than the {:.3g} of roundings; split it into triangles",
                    shape.in_its_units(thickness), shape.in_its_units(most)));
  }
  PolygonTriangles result{Ears(view).cut()};
  if (result.triangles.size() + 2 != corners.size()) return defect("it cannot be cut into triangles; split it");
  return result;
}

}  // namespace verisq
