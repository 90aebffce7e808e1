/// This file implements mesh_solid.hpp.
#include "verify/proof/mesh_solid.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numeric>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/real.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/solids/model.hpp"
#include "verisq/error.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

std::vector<Corners> corners_by_place(const Mesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return mesh.vertices[a] < mesh.vertices[b]; });
  std::vector<std::uint32_t> number(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && mesh.vertices[order[i]] == mesh.vertices[order[i - 1]];
    number[order[i]] = same ? number[order[i - 1]] : order[i];
  }
  std::vector<Corners> corners;
  corners.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) corners.push_back({number[a], number[b], number[c]});
  return corners;
}

std::vector<SidedEdge> closed_edges(std::span<const Corners> triangles) {
  std::vector<SidedEdge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t n = 0; n < triangles.size(); ++n) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t from = triangles[n][k];
      const std::uint64_t to = triangles[n][(k + 1) % 3];
      if (from < to) edges.push_back({from << 32U | to, n, 1});
      if (to < from) edges.push_back({to << 32U | from, n, -1});
    }
  }
  std::ranges::sort(edges, {}, &SidedEdge::ends);
  std::size_t open = 0;
  for (auto edge = edges.begin(); edge != edges.end();) {
    const std::uint64_t ends = edge->ends;
    int sum = 0;
    for (; edge != edges.end() && edge->ends == ends; ++edge) sum += edge->direction;
    open += static_cast<std::size_t>(std::abs(sum));
  }
  if (open > 0) {
    throw Error(ErrorKind::input, "the mesh is not closed: " + std::to_string(open) +
                                      " of its edges are open, or run through the same way by both triangles");
  }
  return edges;
}

namespace {

// Numbers of two precisions: of 127 bits, and of so many that nothing is rounded in the signs below, where points are
// of binary64.

/// Sums of products of three differences of binary64 numbers are multiples of 2^-3222 below 2^3080. No proof relies on
/// that: an interval tells by itself whether it has a sign.
using Wide = MpfrNumber<6400>;

template <class T>
T widened(const Real& x) {
  static_assert(std::is_same_v<T, Real> || std::is_same_v<T, Wide>);
  T result;
  mpfr_set(result.get(), x.get(), MPFR_RNDN);  // exact: T has no fewer bits
  return result;
}

template <class T>
Vector3<T> widened(const PreciseVector& v) {
  const auto component = [&](std::size_t i) {
    return BasicInterval<T>(widened<T>(v[i].lower()), widened<T>(v[i].upper()));
  };
  return {component(0), component(1), component(2)};
}

bool is_one_point(const PreciseVector& v) {
  return v[0].lower() == v[0].upper() && v[1].lower() == v[1].upper() && v[2].lower() == v[2].upper();
}

// The distance of a point from a triangle. The point is any of its enclosure.

/// Both are at least 0.
template <class T>
struct Bounds {
  T lower;
  T upper;

  /// Far beyond what binary64 tells.
  [[nodiscard]] bool are_tight() const {
    return subtract(upper, lower, Direction::up) <= multiply(upper, T(0x1p-64), Direction::down);
  }
  [[nodiscard]] Enclosure in_binary64() const {
    return {lower.to_double(Direction::down), upper.to_double(Direction::up)};
  }
};

/// The ways from the corners to the point, and two sides.
template <class T>
struct Seen {
  std::array<Vector3<T>, 3> ways;
  Vector3<T> ab, ac;

  Seen(const Vector3<T>& point, const PreciseTriangle& triangle) {
    std::array<Vector3<T>, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = widened<T>(triangle[k]);
      ways[k] = point - corners[k];
    }
    ab = corners[1] - corners[0];
    ac = corners[2] - corners[0];
  }
};

/// The enclosed normal holds the plane's own, so that one corner tells how far the plane is.
template <class T>
std::optional<Bounds<T>> bounds_by_face(const Seen<T>& seen) {
  const Vector3<T> normal = cross(seen.ab, seen.ac);
  const std::optional<Vector3<T>> way = way_from_face(seen.ways[0], seen.ab, seen.ac, normal);
  if (!way) return std::nullopt;
  const BasicInterval<T> to_plane = abs(normal.dot(seen.ways[0])) / length<T>(normal);
  return Bounds<T>{to_plane.lower(), length<T>(*way).upper()};
}

/// With n the shortest of the ways from the three sides: the triangle is at least the least n·(q - v)/|n| away, v its
/// corners, whatever n is (docs/mathematics.md §29).
template <class T>
Bounds<T> bounds_by_sides(const Seen<T>& seen) {
  const std::array<Vector3<T>, 3> from_sides{way_from_side(seen.ways[0], seen.ab), way_from_side(seen.ways[0], seen.ac),
                                             way_from_side(seen.ways[1], Vector3<T>(seen.ac - seen.ab))};
  std::size_t nearest = 0;
  std::array<T, 3> lengths;
  for (std::size_t k = 0; k < 3; ++k) {
    lengths[k] = length<T>(from_sides[k]).upper();
    if (lengths[k] < lengths[nearest]) nearest = k;
  }
  const auto along = [&](std::size_t corner) { return from_sides[nearest].dot(seen.ways[corner]).lower(); };
  const T least = std::min({along(0), along(1), along(2)});
  const bool parts = least > T(0);  // then n is not 0
  return {parts ? divide(least, lengths[nearest], Direction::down) : T(0), lengths[nearest]};
}

/// Bounds the distance of the nearest of these triangles. Precondition: at least one.
template <class T>
Bounds<T> least_distance(const PreciseVector& point, std::span<const PreciseTriangle> triangles) {
  const Vector3<T> from = widened<T>(point);
  std::optional<Bounds<T>> least;
  for (const PreciseTriangle& triangle : triangles) {
    const Seen<T> seen(from, triangle);
    const std::optional<Bounds<T>> by_face = bounds_by_face(seen);
    const Bounds<T> bounds = by_face ? *by_face : bounds_by_sides(seen);
    least = least ? Bounds<T>{std::min(least->lower, bounds.lower), std::min(least->upper, bounds.upper)} : bounds;
  }
  return *least;
}

// Signs: nothing where an enclosed point leaves them open.

template <class T>
std::optional<int> sign_of(const BasicInterval<T>& x) {
  if (x.lower() > T(0)) return 1;
  if (x.upper() < T(0)) return -1;
  return x.lower() == x.upper() ? std::optional(0) : std::nullopt;
}

/// `evaluate` encloses one number at the precision of a number that it is given.
template <class Evaluate>
std::optional<int> sign_of(const Evaluate& evaluate) {
  const std::optional<int> sign = sign_of(evaluate(Real()));
  return sign ? sign : sign_of(evaluate(Wide()));
}

/// Twice the area of a, b and c in the plane of the coordinates i and j: positive where they turn from i to j.
std::optional<int> planar_orientation(const PreciseVector& a, const PreciseVector& b, const PreciseVector& c,
                                      std::size_t i, std::size_t j) {
  return sign_of([&]<class T>(const T& /*precision*/) {
    const Vector3<T> from = widened<T>(a);
    const Vector3<T> first = widened<T>(b) - from;
    const Vector3<T> second = widened<T>(c) - from;
    return BasicInterval<T>(first[i] * second[j] - first[j] * second[i]);
  });
}

/// 1 where the point lies before the triangle, from where its corners turn to the left.
std::optional<int> orientation(const PreciseTriangle& triangle, const PreciseVector& point) {
  return sign_of([&]<class T>(const T& /*precision*/) {
    const Seen<T> seen(widened<T>(point), triangle);
    return cross(seen.ab, seen.ac).dot(seen.ways[0]);
  });
}

/// For corners on a line, or in one place. On their line and in their box is between them: on a line each coordinate
/// rises, falls or stays.
std::optional<bool> lies_between(const PreciseVector& point, const PreciseTriangle& triangle) {
  const auto& [a, b, c] = triangle;
  for (std::size_t i = 0; i < 3; ++i) {
    const Real least = std::min({a[i].lower(), b[i].lower(), c[i].lower()});
    const Real greatest = std::max({a[i].lower(), b[i].lower(), c[i].lower()});
    if (point[i].upper() < least || point[i].lower() > greatest) return false;
    if (point[i].lower() < least || point[i].upper() > greatest) return std::nullopt;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::optional<int> turn = planar_orientation(triangle[k], triangle[(k + 1) % 3], point, i, (i + 1) % 3);
      if (!turn) return std::nullopt;
      if (*turn != 0) return false;
    }
  }
  return true;
}

/// In the plane, and in the image along a coordinate in which the triangle has an inside.
std::optional<bool> lies_on(const PreciseVector& point, const PreciseTriangle& triangle) {
  const std::optional<int> height = orientation(triangle, point);
  if (!height) return std::nullopt;
  if (*height != 0) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const int whole = planar_orientation(triangle[0], triangle[1], triangle[2], i, j).value();
    if (whole == 0) continue;
    bool decided = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::optional<int> turn = planar_orientation(triangle[k], triangle[(k + 1) % 3], point, i, j);
      if (turn && *turn == -whole) return false;
      decided = decided && turn.has_value();
    }
    return decided ? std::optional(true) : std::nullopt;
  }
  return lies_between(point, triangle);
}

/// The sign of the area of a, b and the point moved by (e, e²) in the plane of i and j, for all small e > 0. The area
/// is a polynomial in e, whose coefficients are this area, a_j - b_j and b_i - a_i. 0 only where a and b have one
/// image.
std::optional<int> moved_orientation(const PreciseVector& a, const PreciseVector& b, const PreciseVector& point,
                                     std::size_t i, std::size_t j) {
  const std::optional<int> sign = planar_orientation(a, b, point, i, j);
  if (!sign || *sign != 0) return sign;
  if (a[j].lower() > b[j].lower()) return 1;
  if (a[j].lower() < b[j].lower()) return -1;
  return a[i].lower() < b[i].lower() ? 1 : (a[i].lower() > b[i].lower() ? -1 : 0);
}

/// Returns how much the triangle adds to the winding number of a point off the surface. The ray begins at the moved
/// point. A ray
/// that leaves the triangle on its front came from behind, where the number is larger by one.
std::optional<int> crossing(const PreciseVector& point, std::size_t axis, bool upward,
                            const PreciseTriangle& triangle) {
  const std::size_t i = (axis + 1) % 3;
  const std::size_t j = (axis + 2) % 3;
  const int whole = planar_orientation(triangle[0], triangle[1], triangle[2], i, j).value();
  if (whole == 0) return 0;  // an image without inside: the moved point is not in it
  bool decided = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::optional<int> turn = moved_orientation(triangle[k], triangle[(k + 1) % 3], point, i, j);
    if (turn && *turn != whole) return 0;
    decided = decided && turn.has_value();
  }
  const int leaving = upward ? whole : -whole;  // 1 where the ray leaves on the front
  const std::optional<int> height = orientation(triangle, point);
  if (height && *height == leaving) return 0;  // the triangle is not ahead
  // In the plane and in the image is on the triangle: no such point is asked for, and none is answered.
  return decided && height && *height == -leaving ? std::optional(leaving) : std::nullopt;
}

/// The triangles of a closed mesh.
std::vector<Triangle> closed_triangles(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw Error(ErrorKind::input, "the mesh has no triangles");
  static_cast<void>(closed_edges(corners_by_place(mesh)));
  return triangles_of(mesh);
}

/// A box of binary64 numbers about the point.
struct Box {
  Point lower;
  Point upper;

  explicit Box(const PreciseVector& point) {
    for (std::size_t i = 0; i < 3; ++i) {
      lower[i] = point[i].lower().to_double(Direction::down);
      upper[i] = point[i].upper().to_double(Direction::up);
    }
  }
};

}  // namespace

MeshSolid::MeshSolid(const Primitive& primitive)
    : motion_(primitive.pose), tree_(closed_triangles(*primitive.mesh)), on_parts_(one_on_each_part(*primitive.mesh)) {}

std::optional<int> MeshSolid::winding_number(const PreciseVector& own, std::size_t axis, bool upward) const {
  Box ray(own);
  (upward ? ray.upper : ray.lower)[axis] = upward ? infinity : -infinity;
  int sum = 0;
  for (const std::uint32_t n : tree_.overlapping(ray.lower, ray.upper)) {
    const std::optional<int> crossed = crossing(own, axis, upward, corners_of(tree_.triangle(n)));
    if (!crossed) return std::nullopt;
    sum += *crossed;
  }
  return sum;
}

/// Every way is right that decides: first those on which the mesh ends soon. A point of binary64 is always decided.
std::optional<int> MeshSolid::winding_number(const PreciseVector& own) const {
  struct Ray {
    double way;
    std::size_t axis;
    bool upward;
  };
  const Box box(own);
  std::array<Ray, 6> rays;
  for (std::size_t i = 0; i < 3; ++i) {
    rays[2 * i] = {tree_.upper()[i] - box.lower[i], i, true};
    rays[2 * i + 1] = {box.upper[i] - tree_.lower()[i], i, false};
  }
  std::ranges::sort(rays, {}, &Ray::way);
  for (const Ray& ray : rays) {
    if (const std::optional<int> winding = winding_number(own, ray.axis, ray.upward)) return winding;
  }
  return std::nullopt;
}

std::optional<bool> MeshSolid::lies_on_one_of(std::span<const std::uint32_t> triangles,
                                              const PreciseVector& own) const {
  bool decided = true;
  for (const std::uint32_t n : triangles) {
    const std::optional<bool> lies = lies_on(own, corners_of(tree_.triangle(n)));
    if (lies && *lies) return true;
    decided = decided && lies.has_value();
  }
  return decided ? std::optional(false) : std::nullopt;
}

/// From a binary64 point that is no farther than `displacement`, the nearest triangle is at most `reach` away, and so
/// is the one nearest to the point itself.
Enclosure MeshSolid::signed_distance_of(const PreciseVector& own) const {
  const Point near = Box(own).lower;
  if (!is_finite(near)) return {-infinity, infinity};
  const double displacement = length<Real>(PreciseVector(own - precise(near))).upper().to_double(Direction::up);
  const double reach = add(tree_.nearest(near).distance.hi, 2.0 * displacement, Direction::up);
  const std::vector<std::uint32_t> candidates = tree_.within(near, reach);
  std::vector<PreciseTriangle> triangles;
  triangles.reserve(candidates.size());
  for (const std::uint32_t n : candidates) triangles.push_back(corners_of(tree_.triangle(n)));

  const auto bounds = least_distance<Real>(own, triangles);
  const bool is_off = bounds.lower > Real(0);
  const std::optional<bool> is_on = is_off ? std::optional(false) : lies_on_one_of(candidates, own);
  if (is_on && *is_on) return {0.0, 0.0};
  const bool is_done = bounds.are_tight() || !is_one_point(own);  // more bits do not narrow an enclosed point
  const Enclosure distance = is_done ? bounds.in_binary64() : least_distance<Wide>(own, triangles).in_binary64();
  // No triangle is nearer than `bounds.lower`: a point less far away has the same winding number.
  const bool winds_alike = Real(displacement) < bounds.lower;
  const std::optional<int> winding = is_on ? winding_number(winds_alike ? precise(near) : own) : std::nullopt;
  if (!winding) return {-distance.hi, distance.hi};
  return *winding == 0 ? distance : Enclosure{-distance.hi, -distance.lo};
}

namespace {

/// A cube in a mesh's own frame: {centre + e1 axis_1 + e2 axis_2 + e3 axis_3 : |e_i| <= 1}.
struct TurnedCube {
  PreciseVector centre;
  std::array<PreciseVector, 3> axes;

  TurnedCube(const RigidMotion& motion, const PreciseVector& in_model, const Real& half_width) {
    const PreciseMatrix back = motion.rotation.transpose();
    centre = back * PreciseVector(in_model - motion.translation);
    for (std::size_t i = 0; i < 3; ++i) axes[i] = back.column(i) * PreciseInterval(half_width);
  }

  /// No smaller than n·(x - centre) of any point x of the cube.
  [[nodiscard]] Real reach(const PreciseVector& n) const {
    return (abs(n.dot(axes[0])) + abs(n.dot(axes[1])) + abs(n.dot(axes[2]))).upper();
  }
};

/// True proves that no point of the triangle lies in the cube: a direction separates them. The directions are those of
/// the separating axis theorem, by which one of them separates any that do not meet.
bool keeps_off(const PreciseTriangle& triangle, const TurnedCube& cube) {
  std::array<PreciseVector, 3> ways;
  std::array<PreciseVector, 3> sides;
  for (std::size_t k = 0; k < 3; ++k) {
    ways[k] = triangle[k] - cube.centre;
    sides[k] = triangle[(k + 1) % 3] - triangle[k];
  }
  const auto separates = [&](const PreciseVector& n) {
    const std::array along{n.dot(ways[0]), n.dot(ways[1]), n.dot(ways[2])};
    const Real reach = cube.reach(n);
    return std::ranges::all_of(along, [&](const PreciseInterval& x) { return x.lower() > reach; }) ||
           std::ranges::all_of(along, [&](const PreciseInterval& x) { return x.upper() < -reach; });
  };
  if (std::ranges::any_of(cube.axes, separates) || separates(cross(sides[0], sides[1]))) return true;
  return std::ranges::any_of(cube.axes, [&](const PreciseVector& axis) {
    return std::ranges::any_of(sides, [&](const PreciseVector& side) { return separates(cross(axis, side)); });
  });
}

}  // namespace

/// Where no triangle comes into the cube, all of its points have the winding number of its centre.
Place MeshSolid::place_of_cube(const PreciseVector& centre, const Real& half_width) const {
  const TurnedCube cube(motion_, centre, half_width);
  const Enclosure at_centre = signed_distance_of(cube.centre);
  if (at_centre.lo <= 0.0 && at_centre.hi >= 0.0) return Place::undecided;
  const Place place = at_centre.lo > 0.0 ? Place::outside : Place::inside;
  const PreciseInterval half_diagonal = PreciseInterval(half_width) * sqrt(PreciseInterval(3));
  if (Real(std::max(at_centre.lo, -at_centre.hi)) > half_diagonal.upper()) return place;
  Point lower;
  Point upper;
  for (std::size_t i = 0; i < 3; ++i) {
    PreciseVector along;
    along[i] = 1;
    const PreciseInterval reach(cube.reach(along));
    lower[i] = (cube.centre[i] - reach).lower().to_double(Direction::down);
    upper[i] = (cube.centre[i] + reach).upper().to_double(Direction::up);
  }
  const auto is_off = [&](std::uint32_t n) { return keeps_off(corners_of(tree_.triangle(n)), cube); };
  return std::ranges::all_of(tree_.overlapping(lower, upper), is_off) ? place : Place::undecided;
}

EnclosingSphere MeshSolid::sphere() const {
  const PreciseVector lower = precise(tree_.lower());
  const PreciseVector upper = precise(tree_.upper());
  const PreciseInterval half(Real(0.5));
  return {(lower + upper) * half, length<Real>(PreciseVector(upper - lower)) * half};
}

PlacedMesh placed(const Mesh& mesh, const RigidMotion& motion) {
  PlacedMesh result{mesh};
  for (Point& vertex : result.mesh.vertices) {
    const PreciseVector exact = motion(precise(vertex));
    vertex = Box(exact).lower;
    const Real off = length<Real>(PreciseVector(exact - precise(vertex))).upper();
    result.displacement = std::max(result.displacement, off.to_double(Direction::up));
  }
  return result;
}

SeenTriangles::SeenTriangles(const Mesh& mesh, const Pose& of_primitive) {
  const PlacedMesh seen = placed(mesh, RigidMotion(of_primitive).inverse());
  displacement_ = seen.displacement;
  if (displacement_ < infinity) tree_.emplace(triangles_of(seen.mesh));
}

Enclosure SeenTriangles::distance(const Point& own) const {
  if (!tree_) return {0.0, infinity};
  const Enclosure distance = tree_->nearest(own).distance;
  return {std::max(0.0, subtract(distance.lo, displacement_, Direction::down)),
          add(distance.hi, displacement_, Direction::up)};
}

}  // namespace verisq::verify

verisq::Primitive verisq::mesh_primitive(std::string name, Mesh mesh, const Pose& pose) {
  if (mesh.triangles.empty()) throw Error(ErrorKind::input, "the mesh has no triangles");
  Primitive primitive{std::move(name), {}, pose, {}, std::make_shared<const Mesh>(std::move(mesh))};
  verify::require_valid_with_meshes(Model{"", {primitive}});
  static_cast<void>(verify::closed_edges(verify::corners_by_place(*primitive.mesh)));
  return primitive;
}
