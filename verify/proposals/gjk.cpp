/// This file implements gjk.hpp.
#include "verify/proposals/gjk.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "verify/proposals/multipliers.hpp"

namespace verisq::verify {

namespace {

template <class Float>
using Vertices = std::array<GjkVertex<Float>, 4>;

/// Some vertices of a simplex, by index, and the point of their hull closest to the origin as a convex combination.
template <class Float>
struct Face {
  std::array<std::uint8_t, 4> index{};
  std::array<Float, 4> weight{};
  std::size_t size = 0;
  Float squared_distance = 0;
};

template <class Float>
Face<Float> face(const Vertices<Float>& vertices, std::span<const std::uint8_t> index, std::span<const Float> share) {
  Face<Float> result;
  Float sum = 0;
  for (const Float s : share) sum += s;
  Coordinates<Float> point{};
  for (std::size_t i = 0; i < index.size(); ++i) {
    result.index[i] = index[i];
    result.weight[i] = share[i] / sum;
    point = along(point, vertices[index[i]].difference, result.weight[i]);
  }
  result.size = index.size();
  result.squared_distance = dot(point, point);
  return result;
}

template <class Float>
const Face<Float>& closer(const Face<Float>& a, const Face<Float>& b) {
  return b.squared_distance < a.squared_distance ? b : a;
}

template <class Float>
Face<Float> closest_on_segment(const Vertices<Float>& vertices, std::uint8_t i, std::uint8_t j) {
  const auto& p = vertices[i].difference;
  const auto& q = vertices[j].difference;
  const auto edge = difference(q, p);
  const std::array share{dot(q, edge), -dot(p, edge)};  // their sum is the squared length
  if (share[0] > 0 && share[1] > 0) return face<Float>(vertices, std::array{i, j}, share);
  return closer(face<Float>(vertices, std::array{i}, std::array{Float(1)}),
                face<Float>(vertices, std::array{j}, std::array{Float(1)}));
}

/// The signed areas of the triangles that the origin's projection forms with the edges decide. If the projection lies
/// beyond an edge, that edge itself is searched. In a triangle without area every sign is noise: all edges are
/// searched.
template <class Float>
Face<Float> closest_on_triangle(const Vertices<Float>& vertices, const std::array<std::uint8_t, 3>& index) {
  std::array<Coordinates<Float>, 3> edge;  // the edge opposite to each vertex
  const auto corner = [&](std::size_t i) -> const Coordinates<Float>& { return vertices[index[i % 3]].difference; };
  for (std::size_t i = 0; i < 3; ++i) edge[i] = difference(corner(i + 2), corner(i + 1));
  const auto normal = cross(edge[0], edge[1]);
  const Float squared_area = dot(normal, normal);
  // By how much the share of vertex i in the origin's projection exceeds its share in a point p of the triangle's
  // plane.
  const auto excess = [&](std::size_t i, const Coordinates<Float>& p) {
    return dot(p, cross(edge[i], normal)) / squared_area;
  };
  std::array<Float, 3> share;
  Coordinates<Float> projection{};
  for (std::size_t i = 0; i < 3; ++i) {
    share[i] = excess(i, corner(i + 1));
    projection = along(projection, corner(i), share[i]);
  }
  // One step of iterative refinement. In a sliver the error of the shares is the rounding of the corners' coordinates
  // over the sliver's angle. After the step it is that of the projection's coordinates, which are small where precision
  // is needed.
  for (std::size_t i = 0; i < 3; ++i) share[i] += excess(i, projection);
  constexpr Float epsilon = std::numeric_limits<Float>::epsilon();
  const bool flat = !(squared_area > epsilon * epsilon * dot(edge[0], edge[0]) * dot(edge[1], edge[1]));
  const auto beyond = [&](std::size_t i) { return flat || !(share[i] > 0); };
  if (!beyond(0) && !beyond(1) && !beyond(2)) return face<Float>(vertices, index, share);
  Face<Float> best{.squared_distance = std::numeric_limits<Float>::infinity()};
  for (std::size_t i = 0; i < 3; ++i) {
    if (beyond(i)) best = closer(best, closest_on_segment(vertices, index[(i + 1) % 3], index[(i + 2) % 3]));
  }
  return best;
}

template <class Float>
bool vanishes(const Face<Float>& found, Float scale) {
  return found.squared_distance <= std::pow(16 * std::numeric_limits<Float>::epsilon() * scale, Float(2));
}

/// Like the triangle, with signed volumes; a tetrahedron without volume is searched face by face. Rounding errors can
/// give all four volumes of a flat tetrahedron the same sign. So the origin counts as inside only if the combination of
/// the vertices agrees.
template <class Float>
Face<Float> closest_on_tetrahedron(const Vertices<Float>& vertices, Float scale) {
  static constexpr std::array<std::array<std::uint8_t, 3>, 4> kOpposite{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  std::array<Float, 4> share;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& p = vertices[kOpposite[i][0]].difference;
    const auto normal =
        cross(difference(vertices[kOpposite[i][1]].difference, p), difference(vertices[kOpposite[i][2]].difference, p));
    // How far the origin lies on the vertex's side of the face; the vertex itself is at 1.
    share[i] = -dot(normal, p) / dot(normal, difference(vertices[i].difference, p));
  }
  const bool volume = std::ranges::all_of(share, [](Float s) { return std::isfinite(s); });
  const bool inside = volume && std::ranges::all_of(share, [](Float s) { return s > 0; });
  if (inside) {
    const Face<Float> whole = face<Float>(vertices, std::array<std::uint8_t, 4>{0, 1, 2, 3}, share);
    if (vanishes(whole, scale)) return whole;
  }
  Face<Float> best{.squared_distance = std::numeric_limits<Float>::infinity()};
  for (std::size_t i = 0; i < 4; ++i) {
    if (inside || !volume || !(share[i] > 0)) best = closer(best, closest_on_triangle(vertices, kOpposite[i]));
  }
  return best;
}

}  // namespace

template <class Float>
GjkSimplex<Float>::GjkSimplex(const GjkVertex<Float>& vertex) : vertices_{vertex} {
  measure(vertex);
}

template <class Float>
void GjkSimplex<Float>::measure(const GjkVertex<Float>& vertex) {
  for (std::size_t i = 0; i < 3; ++i) {
    scale_ = std::max({scale_, std::fabs(vertex.on_a[i]), std::fabs(vertex.on_b[i])});
  }
}

template <class Float>
bool GjkSimplex<Float>::contains(const Coordinates<Float>& difference) const {
  return std::any_of(vertices_.begin(), vertices_.begin() + static_cast<std::ptrdiff_t>(size_),
                     [&](const GjkVertex<Float>& vertex) { return vertex.difference == difference; });
}

template <class Float>
void GjkSimplex<Float>::add(const GjkVertex<Float>& vertex) {
  measure(vertex);
  vertices_[size_++] = vertex;
  const Vertices<Float> all = vertices_;
  Face<Float> kept;
  switch (size_) {
    case 2: kept = closest_on_segment(all, 0, 1); break;
    case 3: kept = closest_on_triangle(all, {0, 1, 2}); break;
    default: kept = closest_on_tetrahedron(all, scale_); break;
  }
  for (std::size_t i = 0; i < kept.size; ++i) vertices_[i] = all[kept.index[i]];
  weights_ = kept.weight;
  size_ = kept.size;
}

template <class Float>
GjkVertex<Float> GjkSimplex<Float>::closest() const {
  GjkVertex<Float> point{};
  for (std::size_t i = 0; i < size_; ++i) {
    point.on_a = along(point.on_a, vertices_[i].on_a, weights_[i]);
    point.on_b = along(point.on_b, vertices_[i].on_b, weights_[i]);
    point.difference = along(point.difference, vertices_[i].difference, weights_[i]);
  }
  return point;
}

template class GjkSimplex<double>;
template class GjkSimplex<long double>;

namespace {

using Vector = Coordinates<double>;

constexpr InnerWalkLimits enough_walks{.steady_direction = 1e-4, .most_walks = 20};
constexpr GjkTolerance<double> near_enough{.relative = 1e-6, .absolute = 0.0, .most_steps = 60};

}  // namespace

NearestNormal::NearestNormal(const Superquadric& solid) : set_(solid), boundary_(solid), tapered_(is_tapered(solid)) {}

NearestNormal::Found NearestNormal::operator()(const Vector& q) const {
  // Boundary covers the octant of nonnegative coordinates; for a tapered solid it covers the octant below it, too.
  const Vector folded{std::fabs(q[0]), std::fabs(q[1]), tapered_ ? q[2] : std::fabs(q[2])};
  if (boundary_.gauge(folded) >= 1.0) return from_outside(q);
  auto [normal, length] = shortest_walk(boundary_, tapered_, folded, enough_walks);
  for (std::size_t i = 0; i < 3; ++i) {
    if (i < 2 || !tapered_) normal[i] = std::copysign(normal[i], q[i]);
  }
  return {normal, -length};
}

NearestNormal::Found NearestNormal::from_outside(const Vector& q) const {
  const GjkResult<double> found = gjk<double>(set_, PointSet<double>{q}, q, near_enough);
  const double length = std::sqrt(dot(found.separation, found.separation));
  if (!(length > 0.0) || !(found.lower > 0.0)) return {{}, 0.0};
  return {{found.separation[0] / length, found.separation[1] / length, found.separation[2] / length}, found.lower};
}

}  // namespace verisq::verify
