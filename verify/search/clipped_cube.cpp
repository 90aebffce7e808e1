/// This file implements clipped_cube.hpp.
#include "verify/search/clipped_cube.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/numbers/vector.hpp"

namespace verisq::verify {
namespace {

constexpr double error_of_tetrahedron = 0x1p-42;
/// Twice the largest section of the cube |e_i| <= 1.
constexpr double two_sections = 12.0;

double height(const Point& x, const Point& normal, double offset) {
  return normal[0] * x[0] + normal[1] * x[1] + normal[2] * x[2] - offset;
}

/// The point where the edge from a to b meets the plane. Precondition: one of the heights is positive, the other is
/// not.
Point crossing(const Point& a, double height_a, const Point& b, double height_b) {
  const double share = height_a / (height_a - height_b);
  Point x;
  for (std::size_t i = 0; i < 3; ++i) x[i] = std::clamp(a[i] + share * (b[i] - a[i]), -1.0, 1.0);
  return x;
}

double volume_of(const std::array<Point, 4>& corners) {
  std::array<Point, 3> way;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) way[k][i] = corners[k + 1][i] - corners[0][i];
  const auto& [u, v, w] = way;
  return std::abs(u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
                  u[2] * (v[0] * w[1] - v[1] * w[0])) /
         6.0;
}

/// The same half-space with a normal whose largest component lies in [1, 2); the error is rounded up.
CuttingPlane scaled(const CuttingPlane& plane) {
  const int down = -exponent_of(plane.normal);
  const double error = plane.error > 0.0 ? std::nextafter(std::ldexp(plane.error, down), infinity) : 0.0;
  return {near_one(plane.normal), std::ldexp(plane.offset, down), error};
}

/// Adds the tetrahedra of a prism between the triangles p and q.
void add_prism(std::vector<std::array<Point, 4>>& tetrahedra, const std::array<Point, 3>& p,
               const std::array<Point, 3>& q) {
  tetrahedra.push_back({p[0], p[1], p[2], q[2]});
  tetrahedra.push_back({p[0], p[1], q[1], q[2]});
  tetrahedra.push_back({p[0], q[0], q[1], q[2]});
}

}  // namespace

CuttingPlane opposite(const CuttingPlane& plane) {
  const auto& [n, offset, error] = plane;
  return {{-n[0], -n[1], -n[2]}, -offset, error};
}

double reach_up(const Point& normal, double half_width) {
  double sum = 0.0;  // rounded up: sum of nonnegative terms
  for (const double n : normal) sum = add(sum, std::abs(n), Direction::up);
  return multiply(sum, half_width, Direction::up);
}

ClippedCube::ClippedCube(double half_width) : half_width_(half_width) {
  // Tetrahedra from the corner (-1, -1, -1) to (1, 1, 1) along the axes, in each order of the axes.
  std::array<std::size_t, 3> order{0, 1, 2};
  do {
    Tetrahedron& corners = tetrahedra_.emplace_back();
    corners.fill({-1.0, -1.0, -1.0});
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t later = k + 1; later < 4; ++later) corners[later][order[k]] = 1.0;
  } while (std::ranges::next_permutation(order).found);
}

void ClippedCube::clip(const CuttingPlane& plane) {
  const auto [n, plane_offset, plane_error] = scaled(plane);
  const double largest = std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])});  // no more than |n|
  const double reach = reach_up(n, 1.0);
  const double offset = plane_offset / half_width_;  // exact, but for underflow, which is far below what is added
  const double error = divide(plane_error, half_width_, Direction::up);
  // Whatever the error, all of the cube is kept, or none.
  if (subtract(offset, error, Direction::down) >= reach) return;
  if (add(offset, error, Direction::up) <= -reach) {
    tetrahedra_.clear();
    return;
  }
  const double thickness = divide(error, largest, Direction::up);
  error_ = add(error_, multiply(two_sections, thickness, Direction::up), Direction::up);
  std::vector<Tetrahedron> kept;
  kept.reserve(tetrahedra_.size());
  for (const Tetrahedron& whole : tetrahedra_) {
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    std::array<double, 4> heights;
    for (std::size_t k = 0; k < 4; ++k) heights[k] = height(whole[k], n, offset);
    auto* const beyond = std::partition(order.begin(), order.end(), [&](std::size_t k) { return heights[k] <= 0.0; });
    const auto before = beyond - order.begin();
    const auto corner = [&](std::size_t k) { return whole[order[k]]; };
    const auto cut = [&](std::size_t from, std::size_t to) {
      return crossing(whole[order[from]], heights[order[from]], whole[order[to]], heights[order[to]]);
    };
    switch (before) {
      case 1: kept.push_back({corner(0), cut(0, 1), cut(0, 2), cut(0, 3)}); break;
      case 2: add_prism(kept, {corner(0), cut(0, 2), cut(0, 3)}, {corner(1), cut(1, 2), cut(1, 3)}); break;
      case 3: add_prism(kept, {corner(0), corner(1), corner(2)}, {cut(0, 3), cut(1, 3), cut(2, 3)}); break;
      case 4: kept.push_back(whole); break;
      default: break;
    }
  }
  error_ = add(error_, static_cast<double>(tetrahedra_.size()) * error_of_tetrahedron, Direction::up);
  tetrahedra_ = std::move(kept);
}

Enclosure ClippedCube::volume() const {
  double sum = 0.0;
  for (const Tetrahedron& corners : tetrahedra_) sum += volume_of(corners);
  const double error = add(error_, static_cast<double>(tetrahedra_.size()) * error_of_tetrahedron, Direction::up);
  const double cubed = half_width_ * half_width_ * half_width_;  // exact
  return {std::clamp(subtract(sum, error, Direction::down), 0.0, 8.0) * cubed,
          std::clamp(add(sum, error, Direction::up), 0.0, 8.0) * cubed};
}

namespace {

using Vector = Vector3<double>;

Vector way(const Point& from, const Point& to) {
  return exact_vector(to) - exact_vector(from);
}

Vector normal_of(const Triangle& triangle) {
  return cross(way(triangle[0], triangle[1]), way(triangle[0], triangle[2]));
}

/// The range of normal·(x - from) for x in the cube.
Interval range(const Vector& normal, const Cube& cube, const Point& from) {
  const Interval about(-cube.half_width, cube.half_width);
  return normal.dot(way(from, cube.centre) + Vector(about, about, about));
}

// The separating axis theorem, in floating point. Let D be the largest coordinate of a corner from the centre, rounded
// by u = 2^-53 of itself, and h the half-width. Along an axis of the cube errors are below 2 u D. Along an edge's
// product with one, projections of at most 4 D² + 4 D h are rounded by less than 32 u (D² + D h). Along the normal,
// whose components of at most 8 D² err by 40 u D², projections of at most 24 D³ + 24 D² h are rounded by less than 400
// u D² (D + h). Underflow costs less than the smallest normal number.
class SeparatingAxes {
 public:
  SeparatingAxes(const Cube& cube, const Triangle& triangle) : half_width_(cube.half_width) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < 3; ++i) {
        corners_[k][i] = triangle[k][i] - cube.centre[i];
        largest_ = std::max(largest_, std::abs(corners_[k][i]));
      }
    }
  }

  [[nodiscard]] bool separate() const { return by_axes() || by_normal() || by_edges(); }

 private:
  [[nodiscard]] bool by_axes() const {
    for (std::size_t i = 0; i < 3; ++i) {
      if (beyond({corners_[0][i], corners_[1][i], corners_[2][i]}, half_width_, 0x1p-51 * largest_)) return true;
    }
    return false;
  }

  [[nodiscard]] bool by_normal() const {
    const Point u = edge(0);
    const Point v = edge(2);
    const Point n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const Point& a = corners_[0];
    const double height = n[0] * a[0] + n[1] * a[1] + n[2] * a[2];
    const double reach = half_width_ * (std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]));
    return beyond({height, height, height}, reach, 0x1p-44 * largest_ * largest_ * (largest_ + half_width_));
  }

  [[nodiscard]] bool by_edges() const {
    for (std::size_t k = 0; k < 3; ++k) {
      const Point u = edge(k);
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const std::size_t l = (i + 2) % 3;
        const auto along = [&](const Point& x) { return u[j] * x[l] - u[l] * x[j]; };
        if (beyond({along(corners_[0]), along(corners_[1]), along(corners_[2])},
                   half_width_ * (std::abs(u[j]) + std::abs(u[l])), 0x1p-48 * largest_ * (largest_ + half_width_))) {
          return true;
        }
      }
    }
    return false;
  }

  [[nodiscard]] Point edge(std::size_t k) const {
    const Point& from = corners_[k];
    const Point& to = corners_[(k + 1) % 3];
    return {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
  }

  /// False for NaN.
  static bool beyond(const std::array<double, 3>& along, double reach, double error) {
    const auto [low, high] = std::ranges::minmax(along);
    const double clear = reach + error + 1e-300;
    return low > clear || high < -clear;
  }

  double half_width_;
  double largest_ = 0.0;
  Triangle corners_;
};

/// The cutting plane, in the cube, of a plane through `from` whose normal is known to an interval.
CuttingPlane cut(const Cube& cube, const Point& from, const Vector& normal, double extra) {
  CuttingPlane plane{{}, 0.0, 0.0};
  const Vector to_centre = way(from, cube.centre);
  Interval offset(0);
  double error = extra;
  for (std::size_t i = 0; i < 3; ++i) {
    const Interval& n = normal[i];
    plane.normal[i] = 0.5 * n.lower() + 0.5 * n.upper();
    offset -= n * to_centre[i];
    const Interval off = abs(n - Interval(plane.normal[i])) * Interval(cube.half_width);
    error = add(error, off.upper(), Direction::up);
  }
  plane.offset = 0.5 * offset.lower() + 0.5 * offset.upper();
  plane.error = add(error, abs(offset - Interval(plane.offset)).upper(), Direction::up);
  return plane;
}

bool is_usable(const CuttingPlane& plane) {
  const auto& [n, offset, error] = plane;
  return std::isfinite(n[0]) && std::isfinite(n[1]) && std::isfinite(n[2]) && std::isfinite(offset) &&
         std::isfinite(error) && n != Point{};
}

/// Returns whether all of the cube is proven to lie on the triangle's side of the plane through this edge and the
/// normal.
bool lies_within_edge(const Cube& cube, const Triangle& triangle, const Vector& normal, std::size_t k) {
  const Vector inward = cross(normal, way(triangle[k], triangle[(k + 1) % 3]));
  return range(inward, cube, triangle[k]).lower() > 0.0;
}

/// The corner k of `a` and the corner l of `b` that begin the shared edge, each in its own direction.
std::optional<std::pair<std::size_t, std::size_t>> shared_edge(const Triangle& a, const Triangle& b) {
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t l = 0; l < 3; ++l)
      if (a[k] == b[(l + 1) % 3] && a[(k + 1) % 3] == b[l]) return std::pair(k, l);
  return std::nullopt;
}

/// Viewpoints, in half-widths from the centre: if one of them lies on the surface, another may not.
constexpr std::array<Point, 4> places{{{0, 0, 0}, {0.37, -0.21, 0.43}, {-0.55, 0.31, 0.13}, {0.19, 0.67, -0.59}}};

Point place_in(const Cube& cube, const Point& at) {
  Point place;
  for (std::size_t i = 0; i < 3; ++i) place[i] = cube.centre[i] + at[i] * cube.half_width;
  return place;
}

}  // namespace

CuttingPlane plane_in(const Cube& cube, const Point& point, const Point& normal) {
  return cut(cube, point, exact_vector(normal), 0.0);
}

DividedSurface::DividedSurface(std::vector<Triangle> triangles, int orientation, Side side)
    : surface_(std::move(triangles)), orientation_(orientation), side_(side) {}

DividedSurface::Piece DividedSurface::piece(const Cube& cube) const {
  Piece all;
  for (std::uint32_t n = 0; n < surface_.triangles().size(); ++n) all.triangles.push_back(n);
  return piece(cube, all);
}

DividedSurface::Piece DividedSurface::piece(const Cube& cube, const Piece& whole) const {
  Piece piece;
  for (const std::uint32_t n : whole.triangles) {
    if (!SeparatingAxes(cube, surface_.triangles()[n]).separate()) piece.triangles.push_back(n);
  }
  for (const Point& at : places) {
    piece.place = place_in(cube, at);
    if (whole.winding) {
      // The segment stays in the larger cube, which is convex.
      if (const auto change = surface_.winding_change(whole.place, piece.place, whole.triangles)) {
        piece.winding = *whole.winding + *change;
        return piece;
      }
    }
  }
  for (const Point& at : places) {
    piece.place = place_in(cube, at);
    piece.winding = surface_.winding_number(piece.place);
    if (piece.winding) break;
  }
  return piece;
}

CubePart::Kind DividedSurface::kind_at(int winding) const {
  if (winding == 0) return side_ == Side::outside ? CubePart::Kind::all : CubePart::Kind::nothing;
  if (winding * orientation_ > 0) return side_ == Side::inside ? CubePart::Kind::all : CubePart::Kind::nothing;
  return CubePart::Kind::unknown;
}

CubePart DividedSurface::part(const Cube& cube, const Piece& piece) const {
  if (!piece.winding) return {CubePart::Kind::unknown};
  switch (piece.triangles.size()) {
    case 0: return {kind_at(*piece.winding)};
    case 1: return divided_by_one(cube, piece);
    case 2: return divided_by_two(cube, piece);
    default: return {CubePart::Kind::unknown};
  }
}

/// Crossing a triangle along its normal takes 1 from the winding number. One of the two sides lies behind all planes
/// or, unless `behind_all`, behind at least one of them.
CubePart DividedSurface::parts(int winding_behind, std::vector<CuttingPlane> planes, bool behind_all) const {
  const CubePart::Kind behind = kind_at(winding_behind);
  const CubePart::Kind before = kind_at(winding_behind - 1);
  if (behind == CubePart::Kind::unknown || before == CubePart::Kind::unknown) return {CubePart::Kind::unknown};
  if (behind == before) return {behind};
  const bool wanted_behind = behind == CubePart::Kind::all;
  if (behind_all) return {wanted_behind ? CubePart::Kind::within : CubePart::Kind::beyond, std::move(planes)};
  // Behind at least one of them: a point behind none is before all.
  for (CuttingPlane& plane : planes) plane = opposite(plane);
  return {wanted_behind ? CubePart::Kind::beyond : CubePart::Kind::within, std::move(planes)};
}

/// The triangle contains the whole part of its plane in the cube.
CubePart DividedSurface::divided_by_one(const Cube& cube, const Piece& piece) const {
  const Triangle& triangle = surface_.triangles()[piece.triangles[0]];
  const Vector normal = normal_of(triangle);
  for (std::size_t k = 0; k < 3; ++k)
    if (!lies_within_edge(cube, triangle, normal, k)) return {CubePart::Kind::unknown};
  const CuttingPlane plane = cut(cube, triangle[0], normal, 0.0);
  const Interval height = normal.dot(way(triangle[0], piece.place));
  const bool behind = height.upper() < 0.0;
  if (!is_usable(plane) || (!behind && !(height.lower() > 0.0))) return {CubePart::Kind::unknown};
  return parts(behind ? *piece.winding : *piece.winding + 1, {plane}, true);
}

/// In the cube the two triangles are the faces of a wedge, as no other edges bound them there. If the third corner of
/// one lies behind the other, the part behind both is convex; else the part before both. If the corner may lie in the
/// other's plane, and they face alike, the second triangle is no farther from that plane than this corner.
CubePart DividedSurface::divided_by_two(const Cube& cube, const Piece& piece) const {
  const Triangle& a = surface_.triangles()[piece.triangles[0]];
  const Triangle& b = surface_.triangles()[piece.triangles[1]];
  const auto shared = shared_edge(a, b);
  if (!shared) return {CubePart::Kind::unknown};
  const auto& [k, l] = *shared;
  const Vector normal_a = normal_of(a);
  const Vector normal_b = normal_of(b);
  for (const std::size_t step : {1, 2}) {
    if (!lies_within_edge(cube, a, normal_a, (k + step) % 3)) return {CubePart::Kind::unknown};
    if (!lies_within_edge(cube, b, normal_b, (l + step) % 3)) return {CubePart::Kind::unknown};
  }
  const Interval height_of_b = normal_a.dot(way(a[0], b[(l + 2) % 3]));
  const Interval place_on_a = normal_a.dot(way(a[0], piece.place));
  const Interval place_on_b = normal_b.dot(way(b[0], piece.place));
  const bool behind_a = place_on_a.upper() < 0.0;
  const bool behind_b = place_on_b.upper() < 0.0;
  if (!behind_a && !(place_on_a.lower() > 0.0)) return {CubePart::Kind::unknown};
  if (!behind_b && !(place_on_b.lower() > 0.0)) return {CubePart::Kind::unknown};
  const CuttingPlane plane_a = cut(cube, a[0], normal_a, 0.0);
  const CuttingPlane plane_b = cut(cube, b[0], normal_b, 0.0);
  if (!is_usable(plane_a) || !is_usable(plane_b)) return {CubePart::Kind::unknown};
  const bool convex = height_of_b.upper() < 0.0;
  if (!convex && !(height_of_b.lower() > 0.0)) {
    if (behind_a != behind_b || !(normal_a.dot(normal_b).lower() > 0.0)) return {CubePart::Kind::unknown};
    const double off = abs(height_of_b).upper();
    if (!(abs(place_on_a).lower() > off)) return {CubePart::Kind::unknown};
    return parts(behind_a ? *piece.winding : *piece.winding + 1, {cut(cube, a[0], normal_a, off)}, true);
  }
  const bool behind = convex ? behind_a && behind_b : behind_a || behind_b;
  return parts(behind ? *piece.winding : *piece.winding + 1, {plane_a, plane_b}, convex);
}

}  // namespace verisq::verify
