/// A ray from the point passes through the surface outward once more than inward for each time that the surface winds
/// around the point (docs/mathematics.md §22). Intervals decide which triangles it passes through; where they cannot,
/// another ray is tried.
#include "verify/sides/winding_number.hpp"

#include <array>

#include "verify/numbers/vector.hpp"

namespace verisq::verify {

namespace {

using Vector = Vector3<double>;

/// Exact numbers, so that all triangles meet the same ray. In none of the planes that the axes span.
constexpr std::array<Point, 6> directions{{{0.5773, 0.3989, 0.7126},
                                           {-0.2718, 0.8284, -0.4897},
                                           {0.7213, -0.6412, 0.2609},
                                           {-0.6561, -0.3437, 0.6719},
                                           {0.1357, -0.5431, -0.8287},
                                           {-0.8731, 0.1943, -0.4471}}};

bool is_positive(const Interval& x) {
  return x.lower() > 0.0;
}

bool is_negative(const Interval& x) {
  return x.upper() < 0.0;
}

Vector exact(const Point& p) {
  return {p[0], p[1], p[2]};
}

Vector cross_product(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class Holds>
bool any(const std::array<Interval, 3>& values, const Holds& holds) {
  return holds(values[0]) || holds(values[1]) || holds(values[2]);
}

template <class Holds>
bool all(const std::array<Interval, 3>& values, const Holds& holds) {
  return holds(values[0]) && holds(values[1]) && holds(values[2]);
}

/// 1 or -1 where the ray p + t d, t > 0, passes through the triangle outward or inward, 0 where it does not; nothing
/// where that is open. With u, v, w from p to the corners, the line meets the triangle's plane where the corners'
/// weights are as det(d, v, w), det(d, w, u) and det(d, u, v), with D their sum and t = det(u, v, w) / D.
std::optional<int> passage(const Vector& p, const Vector& d, const Triangle& triangle) {
  const Vector u = exact(triangle[0]) - p;
  const Vector v = exact(triangle[1]) - p;
  const Vector w = exact(triangle[2]) - p;
  if (all({d.dot(u), d.dot(v), d.dot(w)}, is_negative)) return 0;  // behind the point
  const Vector vw = cross_product(v, w);
  const std::array<Interval, 3> weights{d.dot(vw), d.dot(cross_product(w, u)), d.dot(cross_product(u, v))};
  if (any(weights, is_positive) && any(weights, is_negative)) return 0;  // beside the triangle
  const bool outward = all(weights, is_positive);
  if (!outward && !all(weights, is_negative)) return std::nullopt;
  const Interval volume = u.dot(vw);
  if (is_positive(volume)) return outward ? 1 : 0;
  if (is_negative(volume)) return outward ? 0 : -1;
  return std::nullopt;
}

std::optional<int> passages(const Vector& p, const Vector& d, std::span<const Triangle> surface) {
  int sum = 0;
  for (const Triangle& triangle : surface) {
    const std::optional<int> of_triangle = passage(p, d, triangle);
    if (!of_triangle) return std::nullopt;
    sum += *of_triangle;
  }
  return sum;
}

}  // namespace

std::optional<int> winding_number(const Point& point, std::span<const Triangle> closed_surface) {
  for (const Point& direction : directions) {
    const std::optional<int> found = passages(exact(point), exact(direction), closed_surface);
    if (found) return found;
  }
  return std::nullopt;
}

}  // namespace verisq::verify
