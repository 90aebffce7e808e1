/// This file implements exact_mesh.hpp.
#include "tests/oracle/exact_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

namespace verisq::oracle {

namespace {

using Vector = std::array<Integer, 3>;
using Plain = std::array<long double, 3>;

constexpr int places = 300;

/// In units of 2^-places.
Integer integer_of(double x, int at = places) {
  int exponent = 0;
  const double mantissa = std::frexp(x, &exponent);
  const auto whole = static_cast<std::int64_t>(std::ldexp(mantissa, 53));
  const int shift = exponent - 53 + at;
  if (shift >= 0) return Integer(whole) << shift;
  if (whole % (std::int64_t{1} << std::min(62, -shift)) != 0) throw std::range_error("too small for the oracle");
  return Integer(whole) / (Integer(1) << -shift);
}

Vector vector_of(const Point& x) {
  return {integer_of(x[0]), integer_of(x[1]), integer_of(x[2])};
}

template <class V>
V minus(const V& a, const V& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class V>
auto inner(const V& a, const V& b) {
  return typename V::value_type(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}
template <class V>
V outer(const V& a, const V& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

bool less(const Fraction& a, const Fraction& b) {
  return a.numerator * b.denominator < b.numerator * a.denominator;
}

Fraction to_segment(const Vector& p, const Vector& a, const Vector& b) {
  const Vector ab = minus(b, a);
  const Vector ap = minus(p, a);
  const Integer along = inner(ab, ap);
  const Integer whole = inner(ab, ab);
  if (along <= 0) return {inner(ap, ap), 1};
  if (along >= whole) return {inner(minus(p, b), minus(p, b)), 1};
  return {inner(ap, ap) * whole - along * along, whole};
}

/// The face where the foot lies in it, or else the nearest side.
Fraction to_triangle(const Vector& p, const std::array<Vector, 3>& t) {
  const Vector normal = outer(minus(t[1], t[0]), minus(t[2], t[0]));
  const Integer square = inner(normal, normal);
  if (square > 0) {
    bool within = true;
    for (std::size_t k = 0; k < 3 && within; ++k) {
      const Vector inward = outer(normal, minus(t[(k + 1) % 3], t[k]));
      within = inner(inward, minus(p, t[k])) >= 0;
    }
    const Integer height = inner(normal, minus(p, t[0]));
    if (within) return {height * height, square};
  }
  Fraction least = to_segment(p, t[0], t[1]);
  for (const Fraction& other : {to_segment(p, t[1], t[2]), to_segment(p, t[2], t[0])}) {
    if (less(other, least)) least = other;
  }
  return least;
}

Plain plain(const Point& x) {
  return {x[0], x[1], x[2]};
}

/// From any point of the triangle that is near: no less than the distance, but for rounding; from its middle and size
/// no more than it.
struct Rough {
  long double lower;
  long double upper;
};

long double to_segment(const Plain& a, const Plain& b) {
  const Plain ab = minus(b, a);
  const long double whole = inner(ab, ab);
  const long double share = whole > 0 ? std::clamp(-inner(a, ab) / whole, 0.0L, 1.0L) : 0.0L;
  const Plain at{a[0] + share * ab[0], a[1] + share * ab[1], a[2] + share * ab[2]};
  return std::sqrt(inner(at, at));
}

/// A ball about the mean of the corners holds the triangle: from outside of twice its radius nothing more is asked.
Rough rough(const Point& point, const Triangle& triangle) {
  std::array<Plain, 3> t;
  Plain middle{};
  for (std::size_t k = 0; k < 3; ++k) {
    t[k] = minus(plain(triangle[k]), plain(point));
    for (std::size_t i = 0; i < 3; ++i) middle[i] += t[k][i] / 3;
  }
  long double radius = 0;
  for (const Plain& corner : t) radius = std::max(radius, inner(minus(corner, middle), minus(corner, middle)));
  radius = std::sqrt(radius);
  const long double to_middle = std::sqrt(inner(middle, middle));
  const long double upper =
      std::min({to_segment(t[0], t[1]), to_segment(t[1], t[2]), to_segment(t[2], t[0]), to_middle});
  return {(to_middle - radius) * (1 - 1e-9L), upper * (1 + 1e-9L)};
}

/// The plane bounds the distance from below, and where the foot lies in the triangle, about, from above.
Rough less_rough(const Point& point, const Triangle& triangle) {
  const Plain q = plain(point);
  const Plain a = plain(triangle[0]), b = plain(triangle[1]), c = plain(triangle[2]);
  Rough found = rough(point, triangle);
  const Plain normal = outer(minus(b, a), minus(c, a));
  const long double size = std::sqrt(inner(normal, normal));
  const long double reach =
      std::sqrt(inner(minus(q, a), minus(q, a)) + inner(minus(b, a), minus(b, a)) + inner(minus(c, a), minus(c, a)));
  if (size > 1e-9L * reach * reach) {
    found.lower = std::max(found.lower, std::abs(inner(normal, minus(q, a)) / size) - 1e-7L * reach);
  }
  return found;
}

}  // namespace

ExactMesh::ExactMesh(std::span<const Triangle> triangles) : triangles_(triangles.begin(), triangles.end()) {}

Fraction ExactMesh::squared_distance(const Point& point) const {
  long double reach = HUGE_VALL;
  for (const Triangle& triangle : triangles_) reach = std::min(reach, rough(point, triangle).upper);
  const Vector p = vector_of(point);
  std::vector<std::pair<long double, const Triangle*>> near;
  for (const Triangle& triangle : triangles_) {
    const Rough found = less_rough(point, triangle);
    if (found.lower <= reach) near.emplace_back(found.lower, &triangle);
  }
  std::ranges::sort(near);
  std::optional<Fraction> least;
  long double least_root = HUGE_VALL;
  for (const auto& [lower, triangle] : near) {
    if (lower > least_root) break;
    const Fraction found =
        to_triangle(p, {vector_of((*triangle)[0]), vector_of((*triangle)[1]), vector_of((*triangle)[2])});
    if (least && !less(found, *least)) continue;
    least = found;
    least_root =
        std::ldexp(std::sqrt(static_cast<long double>(found.numerator) / static_cast<long double>(found.denominator)),
                   -places) *
        (1 + 1e-9L);
    if (!std::isfinite(least_root)) least_root = HUGE_VALL;
  }
  // In units of 2^-2·places.
  return {least->numerator, least->denominator << 2 * places};
}

namespace {

/// The sign of the determinant of three differences from `o`: in long double where that is plain, else exact.
int orientation(const Point& a, const Point& b, const Point& c, const Point& o) {
  const Plain x = minus(plain(a), plain(o)), y = minus(plain(b), plain(o)), z = minus(plain(c), plain(o));
  const long double volume = inner(outer(x, y), z);
  const long double size = std::sqrt(inner(x, x)) * std::sqrt(inner(y, y)) * std::sqrt(inner(z, z));
  if (std::abs(volume) > 1e-12L * size) return volume > 0 ? 1 : -1;
  const Vector from = vector_of(o);
  const Integer exact = inner(outer(minus(vector_of(a), from), minus(vector_of(b), from)), minus(vector_of(c), from));
  return exact.sign();
}

bool is_degenerate(const Triangle& t) {
  const Vector a = vector_of(t[0]);
  const Vector normal = outer(minus(vector_of(t[1]), a), minus(vector_of(t[2]), a));
  return inner(normal, normal) == 0;
}

/// The segment's crossings of triangles, outward less inward; nothing where it meets a side.
std::optional<int> crossings(std::span<const Triangle> triangles, const Point& from, const Point& to) {
  int sum = 0;
  for (const auto& [a, b, c] : triangles) {
    bool apart = false;
    for (std::size_t i = 0; i < 3; ++i) {
      apart = apart || std::max({a[i], b[i], c[i]}) < std::min(from[i], to[i]) ||
              std::min({a[i], b[i], c[i]}) > std::max(from[i], to[i]);
    }
    if (apart) continue;
    const int first = orientation(a, b, to, from);
    const int second = orientation(b, c, to, from);
    const int third = orientation(c, a, to, from);
    if (std::min({first, second, third}) < 0 && std::max({first, second, third}) > 0) continue;
    const int before = orientation(a, b, c, from);
    const int beyond = orientation(a, b, c, to);
    if (before * beyond > 0) continue;
    if (is_degenerate({a, b, c})) continue;  // in every plane, crossed by nothing
    if (first * second * third * before * beyond == 0) return std::nullopt;
    sum += before > 0 ? 1 : -1;
  }
  return sum;
}

}  // namespace

int ExactMesh::winding_number(const Point& point) const {
  double size = 0.0;
  for (const Triangle& triangle : triangles_) {
    for (const Point& corner : triangle) {
      for (std::size_t i = 0; i < 3; ++i) size = std::max(size, std::abs(corner[i] - point[i]));
    }
  }
  for (int attempt = 0; attempt < 100; ++attempt) {
    const Point to{point[0] + size * (1.5 + 0.0137 * attempt), point[1] + size * (0.3172 - 0.0219 * attempt),
                   point[2] + size * (0.1731 + 0.0071 * attempt)};
    if (const std::optional<int> found = crossings(triangles_, point, to)) return *found;
  }
  throw std::runtime_error("every segment meets a side");
}

bool holds_root(const Enclosure& distance, const Fraction& squared) {
  constexpr int fine = 600;
  const Integer scaled = squared.numerator << 2 * fine;
  const Integer lo = integer_of(distance.lo, fine);
  const Integer hi = integer_of(distance.hi, fine);
  return lo * lo * squared.denominator <= scaled && scaled <= hi * hi * squared.denominator;
}

}  // namespace verisq::oracle
