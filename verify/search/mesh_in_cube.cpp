/// This file implements what closed_mesh.hpp says of cubes.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "verify/numbers/interval.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/closed_mesh.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

constexpr HalfSpace kNothing{{0.0, 0.0, 0.0}, infinity};

Point opposite(const Point& v) {
  return {-v[0], -v[1], -v[2]};
}

double sum_of_magnitudes(const Point& v) {
  return std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]);
}

/// The radius of a ball about the centre that holds the cube.
double radius_of(const Cube& cube) {
  return multiply(square_root(3.0, Direction::up), cube.half_width, Direction::up);
}

/// The part of a mesh's surface in a cube, |e_i| <= h about its centre (docs/mathematics.md §29).
///
/// With u = 2^-53 and the size M of the mesh about the centre, computed coordinates are off by 8 u M. No coordinate is
/// larger than M. So a·q, for a corner q, is off by (8 + 3.1) u M |a|_1: a bound of 16 u M |a|_1 leaves room for the
/// rounding of what it is added to.
class SurfaceInCube {
 public:
  /// Keeps a reference to the mesh.
  SurfaceInCube(const PosedMesh& mesh, const Cube& cube)
      : mesh_(mesh), cube_(cube), half_width_(cube.half_width), size_(mesh.size_about(cube.centre)) {}

  /// True proves that no triangle meets the cube. The one that is nearest to the centre is asked first.
  [[nodiscard]] bool is_free(const PosedMesh::OwnPoint& own, std::uint32_t nearest) const {
    if (is_too_large() || !misses(mesh_.triangle_about(cube_.centre, nearest))) return false;
    return std::ranges::all_of(triangles_about(own),
                               [&](std::uint32_t n) { return misses(mesh_.triangle_about(cube_.centre, n)); });
  }

  /// Collects all triangles that may meet the cube. False where these are too many.
  [[nodiscard]] bool collect(const PosedMesh::OwnPoint& own) {
    if (is_too_large()) return false;
    const auto keep = [this](std::uint32_t n) {
      const Triangle triangle = mesh_.triangle_about(cube_.centre, n);
      if (misses(triangle)) return true;
      if (triangles_.size() == most_triangles) return false;
      triangles_.push_back(triangle);
      return true;
    };
    return std::ranges::all_of(triangles_about(own), keep);
  }

  // Preconditions of these: `collect` returned true.

  [[nodiscard]] bool is_empty() const { return triangles_.empty(); }

  /// The mean of the normals, by the sizes that triangles may have in the cube. Its length is 1, to rounding, or it is
  /// no number.
  [[nodiscard]] Point mean_normal() const {
    Point sum{};
    for (const Triangle& triangle : triangles_) {
      const Point normal = cross(difference(triangle[1], triangle[0]), difference(triangle[2], triangle[0]));
      const double doubled_area = length(normal[0], normal[1], normal[2]);
      const double weight = std::min(1.0, half_width_ * half_width_ / doubled_area);
      if (!(doubled_area > 0.0)) continue;
      for (std::size_t i = 0; i < 3; ++i) sum[i] += normal[i] * weight;
    }
    const double all = length(sum[0], sum[1], sum[2]);
    return {sum[0] / all, sum[1] / all, sum[2] / all};
  }

  /// At least the largest n·e over the surface in the cube.
  [[nodiscard]] double support(const Point& n) const {
    double largest = -infinity;
    for (const Triangle& triangle : triangles_) largest = std::max(largest, support(triangle, n));
    return largest;
  }

 private:
  static constexpr double largest_size = 0x1p300;
  static constexpr std::size_t most_triangles = 256;

  /// All that may be no farther than the cube's corners, in the mesh's own frame.
  [[nodiscard]] std::vector<std::uint32_t> triangles_about(const PosedMesh::OwnPoint& own) const {
    std::vector<std::uint32_t> found;
    mesh_.mesh().tree().within(own.point, add(radius_of(cube_), own.displacement, Direction::up), found);
    return found;
  }

  /// Products might overflow, or so many triangles would meet the cube that there is no use in looking: a surface has
  /// no more than a few times the squared extent of its box.
  [[nodiscard]] bool is_too_large() const {
    if (!(size_ <= largest_size && half_width_ <= largest_size)) return true;
    const WideTree& tree = mesh_.mesh().tree();
    const double share = half_width_ / largest_coordinate(difference(tree.upper(), tree.lower()));
    return share * share * static_cast<double>(tree.size()) > static_cast<double>(most_triangles);
  }

  /// A plane with the normal a parts the triangle from the cube.
  [[nodiscard]] bool parts(const Point& a, const Triangle& triangle) const {
    const double magnitude = sum_of_magnitudes(a);
    const double reach = half_width_ * magnitude * (1.0 + 0x1p-50) + 0x1p-49 * size_ * magnitude;
    const std::array along{dot(a, triangle[0]), dot(a, triangle[1]), dot(a, triangle[2])};
    const auto [least, largest] = std::ranges::minmax(along);
    return least > reach || largest < -reach;
  }

  /// Normals of the faces, of the triangle, and across sides and edges: of a triangle and a cube that do not meet, one
  /// of these planes parts them. No proof needs that they are all.
  [[nodiscard]] bool misses(const Triangle& triangle) const {
    constexpr std::array<Point, 3> axes{Point{1.0, 0.0, 0.0}, Point{0.0, 1.0, 0.0}, Point{0.0, 0.0, 1.0}};
    if (std::ranges::any_of(axes, [&](const Point& axis) { return parts(axis, triangle); })) return true;
    const std::array sides{difference(triangle[1], triangle[0]), difference(triangle[2], triangle[1]),
                           difference(triangle[0], triangle[2])};
    if (parts(cross(sides[0], sides[1]), triangle)) return true;
    return std::ranges::any_of(sides, [&](const Point& side) {
      return std::ranges::any_of(axes, [&](const Point& axis) { return parts(cross(side, axis), triangle); });
    });
  }

  /// Over the cube n·e is at most w·e + h |n - w|_1, for any w, and w·e is largest at a corner. Beside the error of
  /// w·q, the second term rounds by 4.1 u of itself, and their sum by u: 32 u of both magnitudes is more.
  [[nodiscard]] double support_by(const Triangle& triangle, const Point& n, const Point& w) const {
    const double of_triangle = size_ * sum_of_magnitudes(w);
    const double of_cube = half_width_ * sum_of_magnitudes(difference(n, w));
    if (!(of_triangle < 0x1p1000 && of_cube < 0x1p1000)) return infinity;
    const double largest = std::max({dot(w, triangle[0]), dot(w, triangle[1]), dot(w, triangle[2])});
    constexpr double underflow = 0x1p-1000;
    return largest + of_cube + 0x1p-48 * (of_triangle + of_cube) + underflow;
  }

  /// By linear programming, the best w is n where up to two components are replaced such that w is at a right angle to
  /// a side, or to the triangle: it is the best multiplier of a corner, of a side's point in a face, of a point in an
  /// edge.
  [[nodiscard]] double support(const Triangle& triangle, const Point& n) const {
    double least = support_by(triangle, n, n);
    const std::array sides{difference(triangle[1], triangle[0]), difference(triangle[2], triangle[1]),
                           difference(triangle[0], triangle[2])};
    const Point normal = cross(sides[0], sides[1]);
    for (std::size_t i = 0; i < 3; ++i) {
      for (const Point& side : sides) {
        Point w = n;
        w[i] -= dot(n, side) / side[i];
        least = std::min(least, support_by(triangle, n, w));
      }
      const double share = n[i] / normal[i];
      Point w{normal[0] * share, normal[1] * share, normal[2] * share};
      w[i] = n[i];
      least = std::min(least, support_by(triangle, n, w));
    }
    return least;
  }

  const PosedMesh& mesh_;
  Cube cube_;
  double half_width_;
  double size_;
  std::vector<Triangle> triangles_;  ///< about the centre; all that may meet the cube
};

/// Proven to lie beyond a face of the mesh's box, with all that is no farther than `reach`.
bool is_beyond_box(const WideTree& tree, const PosedMesh::OwnPoint& own, double reach) {
  const double far = add(reach, own.displacement, Direction::up);
  for (std::size_t i = 0; i < 3; ++i) {
    if (subtract(own.point[i], far, Direction::down) > tree.upper()[i]) return true;
    if (add(own.point[i], far, Direction::up) < tree.lower()[i]) return true;
  }
  return false;
}

/// A cube without triangles has the side of its centre: the winding number is constant in it.
Colour colour_of_side(const Enclosure& of_centre) {
  if (of_centre.lo > 0.0) return Colour::white;
  return of_centre.hi < 0.0 ? Colour::black : Colour::gray;
}

/// The colour of the ball about the centre.
Colour colour_of_ball(const Enclosure& of_centre, double radius) {
  if (of_centre.lo > radius) return Colour::white;
  return of_centre.hi < -radius ? Colour::black : Colour::gray;
}

/// A point of the cube that is proven to lie beyond the plane n·e = offset, if the plane leaves a part worth cutting.
std::optional<Point> point_beyond(const Cube& cube, const HalfSpace& half_space) {
  constexpr double nearly_all = 1.0 - 0x1p-12;
  Point corner;
  Interval along(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    corner[i] = cube.centre[i] + std::copysign(cube.half_width * nearly_all, half_space.normal[i]);
    const Interval from_centre = Interval(corner[i]) - Interval(cube.centre[i]);
    if (!(abs(from_centre).upper() <= cube.half_width)) return std::nullopt;
    along = along + Interval(half_space.normal[i]) * from_centre;
  }
  if (!(along.lower() > half_space.offset)) return std::nullopt;
  return corner;
}

/// The half-space with the surface in the cube, if no point beyond it belongs to the set. The part that the plane cuts
/// off the cube is convex and free of triangles. So the winding number is constant there, and one point speaks for all:
/// they lie off the solid, or in its interior.
std::optional<HalfSpace> without_cap(const PosedMesh& mesh, const Cube& cube, const SurfaceInCube& surface,
                                     const Point& normal, Side side) {
  if (!is_finite(normal)) return std::nullopt;
  const HalfSpace result{normal, surface.support(normal)};
  const std::optional<Point> beyond = point_beyond(cube, result);
  if (!beyond) return std::nullopt;
  const Enclosure there = mesh.signed_distance(*beyond).signed_distance;
  if (colour_of_side(there) != (side == Side::inside ? Colour::white : Colour::black)) return std::nullopt;
  return result;
}

/// For a cube without a point of the set: any half-space holds that. This one tells where the set lies.
HalfSpace towards_set(const ClosedMesh::Distance& of_centre, Side side) {
  const Point& n = of_centre.normal;
  if (!(sum_of_magnitudes(n) > 0.0)) return kNothing;
  if (side == Side::inside) return {n, -of_centre.signed_distance.hi};
  return {opposite(n), of_centre.signed_distance.lo};
}

}  // namespace

Colour colour(const PosedMesh& mesh, const Cube& cube) {
  const PosedMesh::OwnPoint own = mesh.own_point(cube.centre);
  if (!is_finite(own.point) || !std::isfinite(own.displacement)) return Colour::gray;
  const double radius = radius_of(cube);
  if (is_beyond_box(mesh.mesh().tree(), own, radius)) return Colour::white;
  const ClosedMesh::Distance at_centre = mesh.signed_distance(cube.centre);
  const Enclosure& of_centre = at_centre.signed_distance;
  const Colour of_ball = colour_of_ball(of_centre, radius);
  if (of_ball != Colour::gray || !(cube.half_width > 0.0)) return of_ball;
  const Colour of_side = colour_of_side(of_centre);
  if (of_side == Colour::gray) return of_side;
  return SurfaceInCube(mesh, cube).is_free(own, at_centre.triangle) ? of_side : Colour::gray;
}

HalfSpace half_space(const PosedMesh& mesh, const Cube& cube, Side side) {
  const PosedMesh::OwnPoint own = mesh.own_point(cube.centre);
  if (!is_finite(own.point) || !std::isfinite(own.displacement)) return kNothing;
  const Colour free_of_set = side == Side::inside ? Colour::white : Colour::black;
  const ClosedMesh::Distance at_centre = mesh.signed_distance(cube.centre);
  const Colour of_ball = colour_of_ball(at_centre.signed_distance, radius_of(cube));
  if (of_ball != Colour::gray) return of_ball == free_of_set ? towards_set(at_centre, side) : kNothing;
  SurfaceInCube surface(mesh, cube);
  if (!surface.collect(own)) return kNothing;
  if (surface.is_empty()) {
    return colour_of_side(at_centre.signed_distance) == free_of_set ? towards_set(at_centre, side) : kNothing;
  }
  const Point mean = surface.mean_normal();
  const Point& away = at_centre.normal;
  for (const Point& outward : {mean, away, opposite(mean)}) {
    const Point normal = side == Side::inside ? outward : opposite(outward);
    if (const auto found = without_cap(mesh, cube, surface, normal, side)) return *found;
  }
  return kNothing;
}

}  // namespace verisq::verify
