/// Triangles that a direction separates from a cube do not meet it. If one or two triangles do, and cut the cube from
/// side to side, their planes bound the part of the bone (docs/mathematics.md §23).
#include <algorithm>
#include <array>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/proof/volume_in_cube.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {
namespace {

using Vector = Vector3<double>;

enum class SignOf : std::uint8_t { negative, positive, unknown };

SignOf sign(const Interval& x) {
  if (x.lower() > 0.0) return SignOf::positive;
  return x.upper() < 0.0 ? SignOf::negative : SignOf::unknown;
}

Vector way(const Point& from, const Point& to) {
  return exact_vector(to) - exact_vector(from);
}

Vector outward_normal(const Triangle& triangle) {
  return cross(way(triangle[0], triangle[1]), way(triangle[0], triangle[2]));
}

/// The largest value of direction·e over the cube, e from its centre.
Interval reach(const Cube& cube, const Vector& direction) {
  return (abs(direction[0]) + abs(direction[1]) + abs(direction[2])) * Interval(cube.half_width);
}

/// Returns whether all of the triangle is proven to lie farther along the direction, or against it, than the cube.
bool separates(const Vector& direction, const Cube& cube, const Triangle& triangle) {
  const double beyond = reach(cube, direction).upper();
  bool above = true;
  bool below = true;
  for (const Point& corner : triangle) {
    const Interval along = direction.dot(way(cube.centre, corner));
    above = above && along.lower() > beyond;
    below = below && along.upper() < -beyond;
  }
  return above || below;
}

/// Compares coordinates: exact but for the cube's sides, which are rounded outward.
bool boxes_are_apart(const Cube& cube, const Triangle& triangle) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [low, high] = std::minmax({triangle[0][i], triangle[1][i], triangle[2][i]});
    if (low > add(cube.centre[i], cube.half_width, Direction::up)) return true;
    if (high < subtract(cube.centre[i], cube.half_width, Direction::down)) return true;
  }
  return false;
}

/// Tries planes along a face of either polyhedron, or along an edge of each: if none separates two convex polyhedra,
/// they meet. A meeting is neither proven here nor needed.
bool may_meet(const Cube& cube, const Triangle& triangle) {
  if (boxes_are_apart(cube, triangle)) return false;
  if (separates(outward_normal(triangle), cube, triangle)) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector edge = way(triangle[k], triangle[(k + 1) % 3]);
    for (std::size_t i = 0; i < 3; ++i) {
      Vector axis;
      axis[i] = Interval(1);
      if (separates(cross(axis, edge), cube, triangle)) return false;
    }
  }
  return true;
}

/// Returns whether all of the cube is proven to lie on the triangle's side of the plane through this edge and the
/// normal.
bool lies_within_edge(const Cube& cube, const Triangle& triangle, const Vector& normal, std::size_t k) {
  const Vector inward = cross(normal, way(triangle[k], triangle[(k + 1) % 3]));
  const Interval at_centre = inward.dot(way(triangle[k], cube.centre));
  return (at_centre - reach(cube, inward)).lower() > 0.0;
}

struct SharedEdge {
  std::size_t of_a;  ///< the corner that begins it
  std::size_t of_b;  ///< the corner that begins the edge, in the other direction
};

std::optional<SharedEdge> shared_edge_of(const Triangle& a, const Triangle& b) {
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t l = 0; l < 3; ++l)
      if (a[k] == b[(l + 1) % 3] && a[(k + 1) % 3] == b[l]) return SharedEdge{k, l};
  return std::nullopt;
}

/// Viewpoints, in half-widths from the centre: if one of them lies on the surface, another may not.
constexpr std::array<Point, 4> places_to_look_from{
    {{0, 0, 0}, {0.37, -0.21, 0.43}, {-0.55, 0.31, 0.13}, {0.19, 0.67, -0.59}}};

/// Nothing if rounding may move the point out of the cube.
std::optional<Point> place_at(const Cube& cube, const Point& at) {
  Point place;
  for (std::size_t i = 0; i < 3; ++i) {
    place[i] = cube.centre[i] + at[i] * cube.half_width;
    const Interval off = abs(Interval(place[i]) - Interval(cube.centre[i]));
    if (!(off.upper() <= cube.half_width)) return std::nullopt;
  }
  return place;
}

std::vector<Triangle> checked_triangles(const Mesh& mesh, const Closing& closing) {
  std::vector<Triangle> triangles = closed_triangles(mesh, closing);
  if (triangles.empty()) throw Error(ErrorKind::input, "removed volume: a surface without triangles");
  for (const Triangle& triangle : triangles)
    if (!std::ranges::all_of(triangle, is_finite))
      throw Error(ErrorKind::input, "removed volume: a surface that is not finite");
  if (!is_closed(triangles)) throw Error(ErrorKind::input, "removed volume: a surface that its rims do not close");
  return triangles;
}

int checked_orientation(const std::vector<Triangle>& triangles) {
  const std::optional<int> orientation = orientation_of(triangles);
  if (!orientation)
    throw Error(ErrorKind::input, "removed volume: a surface that encloses nothing, as far as can be proven");
  return *orientation;
}

}  // namespace

CornerHeights heights_above(const Cube& cube, const Point& point, const Vector& normal) {
  return linear_heights(normal.dot(way(point, cube.centre)), normal * Interval(cube.half_width));
}

/// The region behind one triangle, or behind two with a common edge. It lies behind both triangles if they are convex,
/// behind at least one of them if they are reflex. If that is undecided, it is between those two regions.
struct BoundingSurface::Wedge {
  enum class Shape : std::uint8_t { convex, reflex, undecided };
  std::vector<CornerHeights> heights;
  Shape shape;
};

BoundingSurface::BoundingSurface(const BoneSurface& surface, const Closing& closing)
    : rims_(closing.rims),
      surface_(checked_triangles(surface.mesh, closing)),
      side_(surface.bone),
      orientation_(checked_orientation(surface_.triangles())) {}

BoundingSurface::Piece BoundingSurface::piece(const Cube& cube) const {
  std::vector<std::uint32_t> all(surface_.triangles().size());
  for (std::uint32_t n = 0; n < all.size(); ++n) all[n] = n;
  return piece(cube, all, nullptr);
}

BoundingSurface::Piece BoundingSurface::piece(const Cube& cube, const Piece& whole) const {
  return piece(cube, whole.triangles, &whole);
}

BoundingSurface::Piece BoundingSurface::piece(const Cube& cube, const std::vector<std::uint32_t>& of,
                                              const Piece* whole) const {
  Piece piece;
  for (const std::uint32_t n : of)
    if (may_meet(cube, surface_.triangles()[n])) piece.triangles.push_back(n);
  for (const Point& at : places_to_look_from) {
    const std::optional<Point> place = place_at(cube, at);
    if (!place) continue;
    piece.place = *place;
    if (whole != nullptr && whole->winding) {
      // The segment stays in the larger cube, which is convex, and no other triangles meet that.
      const std::optional<int> change = surface_.winding_change(whole->place, piece.place, whole->triangles);
      if (change) piece.winding = *whole->winding + *change;
    } else {
      piece.winding = surface_.winding_number(piece.place);
    }
    if (piece.winding) break;
  }
  return piece;
}

/// If the surface winds in the sense opposite to its orientation, its meaning is undefined.
BoundingSurface::Answer BoundingSurface::is_bone(int winding) const {
  const bool bone_is_inside = side_ == BoneSide::inside;
  if (winding == 0) return bone_is_inside ? Answer::no : Answer::yes;
  if (winding * orientation_ > 0) return bone_is_inside ? Answer::yes : Answer::no;
  return Answer::unknown;
}

bool BoundingSurface::leaves_nothing(const Piece& piece) const {
  return piece.winding && piece.triangles.empty() && is_bone(*piece.winding) == Answer::no;
}

void BoundingSurface::restrict(BracketedPart& part, const Cube& cube, const Piece& piece) const {
  if (!piece.winding || piece.triangles.size() > 2) return leave_unknown(part);
  if (piece.triangles.size() == 1) return restrict_by_one(part, cube, piece);
  if (piece.triangles.size() == 2) return restrict_by_two(part, cube, piece);
  switch (is_bone(*piece.winding)) {
    case Answer::no: return leave_nothing(part);
    case Answer::yes: return;
    case Answer::unknown: return leave_unknown(part);
  }
}

/// Crossing a triangle along its normal takes 1 from the winding number.
void BoundingSurface::restrict_to_side(BracketedPart& part, int winding_behind, const Wedge& wedge) const {
  const Answer behind = is_bone(winding_behind);
  const Answer before = is_bone(winding_behind - 1);
  if (behind == Answer::unknown || before == Answer::unknown) return leave_unknown(part);
  if (behind == before) return behind == Answer::no ? leave_nothing(part) : void();
  std::vector<CornerHeights> heights = wedge.heights;
  bool is_both = wedge.shape == Wedge::Shape::convex;
  if (before == Answer::yes) {  // what is behind both leaves what is before one of them at least
    std::ranges::transform(heights, heights.begin(), negative);
    is_both = !is_both;
  }
  const bool decided = wedge.shape != Wedge::Shape::undecided;
  const auto both = [&heights](PartOfCube& in) {
    for (const CornerHeights& one : heights) in.push_back({one});
  };
  const auto one_at_least = [&heights](PartOfCube& in) { in.push_back(heights); };
  if (is_both || !decided) {
    both(part.inner);
  } else {
    one_at_least(part.inner);
  }
  if (is_both && decided) {
    both(part.outer);
  } else {
    one_at_least(part.outer);
  }
}

/// All of its plane in the cube is the triangle's: no other edge or triangle is there.
void BoundingSurface::restrict_by_one(BracketedPart& part, const Cube& cube, const Piece& piece) const {
  const Triangle& triangle = surface_.triangles()[piece.triangles[0]];
  const Vector normal = outward_normal(triangle);
  for (std::size_t k = 0; k < 3; ++k)
    if (!lies_within_edge(cube, triangle, normal, k)) return leave_unknown(part);
  const SignOf place = sign(normal.dot(way(triangle[0], piece.place)));
  if (place == SignOf::unknown) return leave_unknown(part);
  const int winding_behind = place == SignOf::negative ? *piece.winding : *piece.winding + 1;
  restrict_to_side(part, winding_behind, {{heights_above(cube, triangle[0], normal)}, Wedge::Shape::convex});
}

/// In the cube the two triangles are the half-planes of a wedge, as no other edges bound them there. The wedge is
/// convex if the third corner of one lies behind the other. Convex or not, it contains every point behind both, and no
/// point behind neither.
void BoundingSurface::restrict_by_two(BracketedPart& part, const Cube& cube, const Piece& piece) const {
  const Triangle& a = surface_.triangles()[piece.triangles[0]];
  const Triangle& b = surface_.triangles()[piece.triangles[1]];
  const std::optional<SharedEdge> shared = shared_edge_of(a, b);
  if (!shared) return leave_unknown(part);
  const Vector normal_a = outward_normal(a);
  const Vector normal_b = outward_normal(b);
  for (const std::size_t step : {1, 2}) {
    if (!lies_within_edge(cube, a, normal_a, (shared->of_a + step) % 3)) return leave_unknown(part);
    if (!lies_within_edge(cube, b, normal_b, (shared->of_b + step) % 3)) return leave_unknown(part);
  }
  Wedge wedge{{heights_above(cube, a[0], normal_a), heights_above(cube, b[0], normal_b)}, Wedge::Shape::undecided};
  const SignOf third_corner = sign(normal_a.dot(way(a[0], b[(shared->of_b + 2) % 3])));
  if (third_corner == SignOf::negative) wedge.shape = Wedge::Shape::convex;
  if (third_corner == SignOf::positive) wedge.shape = Wedge::Shape::reflex;

  const std::array<SignOf, 2> signs{sign(normal_a.dot(way(a[0], piece.place))),
                                    sign(normal_b.dot(way(b[0], piece.place)))};
  const auto is_behind = std::ranges::count(signs, SignOf::negative);
  const auto is_before = std::ranges::count(signs, SignOf::positive);
  const bool behind = wedge.shape == Wedge::Shape::reflex ? is_behind > 0 : is_behind == 2;
  const bool before = wedge.shape == Wedge::Shape::convex ? is_before > 0 : is_before == 2;
  if (!behind && !before) return leave_unknown(part);
  restrict_to_side(part, behind ? *piece.winding : *piece.winding + 1, wedge);
}

}  // namespace verisq::verify
