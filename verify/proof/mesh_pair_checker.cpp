/// This file implements mesh_pair_checker.hpp.
#include "verify/proof/mesh_pair_checker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/solids/model.hpp"

namespace verisq::verify {

namespace {

// Of 127 bits, and of binary64: the latter shows quickly that most triangles are not the nearest.

template <class T>
using Corners3 = std::array<Vector3<T>, 3>;

/// From a point of the triangle, about the nearest.
template <class T>
Vector3<T> way_from_triangle(const Corners3<T>& t, const Vector3<T>& x) {
  const Vector3<T> ab = t[1] - t[0];
  const Vector3<T> ac = t[2] - t[0];
  const Vector3<T> way = x - t[0];
  if (const auto from_face = way_from_face(way, ab, ac, Vector3<T>(cross(ab, ac)))) return *from_face;
  const std::array sides{way_from_side(way, ab), way_from_side(way, ac),
                         way_from_side(Vector3<T>(x - t[1]), Vector3<T>(t[2] - t[1]))};
  return *std::ranges::min_element(sides, {}, [](const Vector3<T>& v) { return length<T>(v).upper(); });
}

/// From a point of one side to a point of the other, about the nearest (Ericson, Real-Time Collision Detection, 5.1.9).
template <class T>
Vector3<T> way_between_sides(const Vector3<T>& from_a, const Vector3<T>& to_a, const Vector3<T>& from_b,
                             const Vector3<T>& to_b) {
  const Vector3<T> along_a = to_a - from_a;
  const Vector3<T> along_b = to_b - from_b;
  const Vector3<T> apart = from_a - from_b;
  const BasicInterval<T> a = along_a.dot(along_a);
  const BasicInterval<T> b = along_a.dot(along_b);
  const BasicInterval<T> c = along_a.dot(apart);
  const BasicInterval<T> e = along_b.dot(along_b);
  const BasicInterval<T> f = along_b.dot(apart);
  BasicInterval<T> s = share(BasicInterval<T>(b * f - c * e), BasicInterval<T>(a * e - b * b));
  const BasicInterval<T> t = share(BasicInterval<T>(b * s + f), e);
  s = share(BasicInterval<T>(b * t - c), a);
  return (from_b + along_b * t) - (from_a + along_a * s);
}

/// The distance of two closed sets: between both ends, which are at least 0.
template <class T>
struct BoundsOf {
  T lower;
  T upper;
};
using Bounds = BoundsOf<Real>;

/// For any n: A lies in {n·x <= most}, B in {n·x >= least}, so that they are at least (least - most)/|n| apart. Both
/// are seen from a corner of A, so that nothing is lost where the triangles are far from the origin.
template <class T>
T lower_by_normal(const Corners3<T>& a, const Corners3<T>& b, const Vector3<T>& n) {
  const BasicInterval<T> norm = length<T>(n);
  if (!(norm.lower() > T(0))) return T(0);
  const auto along = [&](const Vector3<T>& x) { return n.dot(Vector3<T>(x - a[0])); };
  const T most = std::max({along(a[0]).upper(), along(a[1]).upper(), along(a[2]).upper()});
  const T least = std::min({along(b[0]).lower(), along(b[1]).lower(), along(b[2]).lower()});
  const BasicInterval<T> gap = BasicInterval<T>(least) - BasicInterval<T>(most);
  return gap.lower() > T(0) ? BasicInterval<T>(gap / norm).lower() : T(0);
}

/// 1 where the point is proven to lie before the triangle, -1 behind it, 0 in its plane; nothing where none is proven.
std::optional<int> side_of(const PreciseTriangle& t, const PreciseVector& x) {
  const PreciseInterval height = cross(PreciseVector(t[1] - t[0]), PreciseVector(t[2] - t[0])).dot(x - t[0]);
  if (height.lower() > Real(0)) return 1;
  if (height.upper() < Real(0)) return -1;
  return height.lower() == height.upper() ? std::optional(0) : std::nullopt;
}

/// True proves that the side passes through the triangle: its ends lie on both sides of the plane, and its line leaves
/// the three sides on one hand, or meets them.
bool passes_through(const PreciseVector& from, const PreciseVector& to, const PreciseTriangle& t) {
  if (side_of(t, from).value_or(0) * side_of(t, to).value_or(0) >= 0) return false;
  int least = 0;
  int most = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::optional<int> hand = side_of({from, to, t[k]}, t[(k + 1) % 3]);
    if (!hand) return false;
    least = std::min(least, *hand);
    most = std::max(most, *hand);
  }
  return least == 0 || most == 0;
}

bool cross_each_other(const PreciseTriangle& a, const PreciseTriangle& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (passes_through(a[k], a[(k + 1) % 3], b) || passes_through(b[k], b[(k + 1) % 3], a)) return true;
  }
  return false;
}

/// Triangles that do not meet are nearest where a corner of one is nearest to the other triangle, or where two sides
/// are: then the way between them is the normal that proves the lower end.
template <class T>
BoundsOf<T> bounds_by_ways(const Corners3<T>& a, const Corners3<T>& b) {
  Vector3<T> nearest;
  T upper = infinity;
  const auto offer = [&](const Vector3<T>& way) {
    const T length_of_way = length<T>(way).upper();
    if (!(length_of_way < upper)) return;
    upper = length_of_way;
    nearest = way;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    offer(way_from_triangle<T>(a, b[k]));
    offer(-way_from_triangle<T>(b, a[k]));
    for (std::size_t j = 0; j < 3; ++j) offer(way_between_sides<T>(a[k], a[(k + 1) % 3], b[j], b[(j + 1) % 3]));
  }
  return {lower_by_normal<T>(a, b, nearest), upper};
}

Bounds distance_of(const PreciseTriangle& a, const PreciseTriangle& b) {
  const Bounds bounds = bounds_by_ways<Real>(a, b);
  return bounds.lower > Real(0) || !cross_each_other(a, b) ? bounds : Bounds{0, 0};
}

/// Enclosures of binary64.
using RoundedTriangle = Corners3<double>;

RoundedTriangle rounded(const PreciseTriangle& triangle) {
  return {in_binary64(triangle[0]), in_binary64(triangle[1]), in_binary64(triangle[2])};
}

RoundedTriangle exactly(const Triangle& triangle) {
  const auto corner = [&](std::size_t k) -> Vector3<double> {
    return {triangle[k][0], triangle[k][1], triangle[k][2]};
  };
  return {corner(0), corner(1), corner(2)};
}

// Places in binary64, for the searches in trees.

/// A ball about a binary64 point. Infinite where that overflows.
struct Ball {
  Point centre;
  double radius;
};

/// The ball of that radius about any point of the enclosure. Precondition: radius >= 0.
Ball rounded_ball(const PreciseVector& centre, double radius) {
  Ball ball{};
  for (std::size_t i = 0; i < 3; ++i) ball.centre[i] = centre[i].lower().to_double(Direction::down);
  if (!is_finite(ball.centre)) return {{}, infinity};
  const Real off = length<Real>(PreciseVector(centre - precise(ball.centre))).upper();
  ball.radius = add(radius, off.to_double(Direction::up), Direction::up);
  return ball;
}

PreciseTriangle moved(const Triangle& triangle, const RigidMotion& motion) {
  return {motion(precise(triangle[0])), motion(precise(triangle[1])), motion(precise(triangle[2]))};
}

/// A ball about a binary64 point that holds the triangle.
Ball ball_about(const Triangle& triangle) {
  Ball ball{{}, 0.0};
  for (std::size_t i = 0; i < 3; ++i) ball.centre[i] = triangle[0][i] / 3 + triangle[1][i] / 3 + triangle[2][i] / 3;
  for (const Point& corner : triangle) ball.radius = std::max(ball.radius, distance_up(corner, ball.centre));
  return ball;
}

// Pairs of primitives.

constexpr Enclosure unknown{0.0, infinity};
constexpr Enclosure they_meet{0.0, 0.0};

Enclosure least_of(const Enclosure& a, const Enclosure& b) {
  return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
}

Enclosure in_binary64(const Bounds& bounds) {
  return {std::max(0.0, bounds.lower.to_double(Direction::down)), bounds.upper.to_double(Direction::up)};
}

/// A triangle that may be near, by its lower end.
struct Candidate {
  double lower;
  std::uint32_t triangle;
};

/// Asks `distance` for the candidates, the nearest first. All others are farther than what is found.
template <class Distance>
Enclosure least_distance(std::vector<Candidate>& candidates, double upper, const Hook& interrupted,
                         const Distance& distance) {
  std::ranges::sort(candidates, {}, &Candidate::lower);
  Enclosure found{infinity, upper};
  for (const auto& [lower, triangle] : candidates) {
    if (!(lower < found.hi)) break;
    if (interrupted && interrupted()) return {0.0, found.hi};
    found = least_of(found, distance(triangle, found.hi));
    if (found.hi == 0.0) return they_meet;
  }
  return {std::min(found.lo, found.hi), found.hi};
}

/// A triangle in a mesh's frame. No point of it lies outside of the ball.
struct SeenTriangle {
  SeenTriangle(const Triangle& triangle, const RigidMotion& motion)
      : corners(moved(triangle, motion)), about(rounded(corners)) {
    const Ball own = ball_about(triangle);
    ball = rounded_ball(motion(precise(own.centre)), own.radius);
  }

  PreciseTriangle corners;
  RoundedTriangle about;
  Ball ball{};
};

/// The distance to the tree's triangles if that is less than `asked`; what is farther is not looked at. Precondition:
/// the ball is finite.
Enclosure distance_of(const TriangleTree& tree, const SeenTriangle& seen, double asked, const Hook& interrupted) {
  std::vector<Candidate> candidates;
  double upper = asked;
  for (const std::uint32_t n : tree.within(seen.ball.centre, add(asked, seen.ball.radius, Direction::up))) {
    const BoundsOf<double> bounds = bounds_by_ways<double>(exactly(tree.triangle(n)), seen.about);
    candidates.push_back({std::max(0.0, bounds.lower), n});  // 0 for NaN
    upper = std::min(upper, bounds.upper);
  }
  return least_distance(candidates, upper, interrupted, [&](std::uint32_t n, double /*asked*/) {
    return in_binary64(distance_of(corners_of(tree.triangle(n)), seen.corners));
  });
}

/// A mesh and a mesh in whose frame it stands by a motion.
class Meshes {
 public:
  Meshes(const MeshSolid& a, const MeshSolid& b, const RigidMotion& b_to_a) : a_(a), b_(b), b_to_a_(b_to_a) {}

  /// Two solids whose surfaces keep off each other meet only if one holds a connected part of the other's surface:
  /// their common part would have a boundary, which lies in one surface and in the other solid.
  [[nodiscard]] Enclosure distance(const Hook& interrupted) const {
    const RigidMotion a_to_b = b_to_a_.inverse();
    bool is_apart = true;
    const auto look = [&](const MeshSolid& from, const MeshSolid& to, const RigidMotion& motion) {
      return std::ranges::any_of(from.on_parts(), [&](const Point& x) {
        const Enclosure place = to.signed_distance_of(motion(precise(x)));
        is_apart = is_apart && place.lo > 0.0;
        return place.hi <= 0.0;
      });
    };
    if (look(a_, b_, a_to_b) || look(b_, a_, b_to_a_)) return they_meet;
    const Enclosure of_surfaces = distance_of_surfaces(interrupted);
    return is_apart ? of_surfaces : Enclosure{0.0, of_surfaces.hi};
  }

 private:
  [[nodiscard]] Enclosure distance_of_surfaces(const Hook& interrupted) const {
    const TriangleTree& tree = a_.tree();
    std::vector<Candidate> candidates;
    double upper = infinity;
    for (std::uint32_t n = 0; n < b_.tree().size(); ++n) {
      if (interrupted && interrupted()) return {0.0, upper};
      const Ball own = ball_about(b_.tree().triangle(n));
      const Ball ball = rounded_ball(b_to_a_(precise(own.centre)), own.radius);
      if (!(ball.radius < infinity)) return unknown;
      const Enclosure to_centre = tree.nearest(ball.centre).distance;
      candidates.push_back({subtract(to_centre.lo, ball.radius, Direction::down), n});
      upper = std::min(upper, add(to_centre.hi, ball.radius, Direction::up));
    }
    return least_distance(candidates, upper, interrupted, [&](std::uint32_t n, double asked) {
      return distance_of(tree, {b_.tree().triangle(n), b_to_a_}, asked, interrupted);
    });
  }

  const MeshSolid& a_;
  const MeshSolid& b_;
  RigidMotion b_to_a_;
};

/// True proves that all of b lies farther along n than all of a: for whatever vector n encloses.
bool lies_beyond(const RoundedTriangle& b, const RoundedTriangle& a, const Vector3<double>& n) {
  const auto along = [&](const Vector3<double>& x) { return n.dot(Vector3<double>(x - a[0])); };
  const double most = std::max({along(a[0]).upper(), along(a[1]).upper(), along(a[2]).upper()});
  return along(b[0]).lower() > most && along(b[1]).lower() > most && along(b[2]).lower() > most;
}

/// True proves that a plane of one of the two, or one across the way between them, parts them.
bool are_parted(const RoundedTriangle& a, const RoundedTriangle& b) {
  const auto normal = [](const RoundedTriangle& t) {
    return cross(Vector3<double>(t[1] - t[0]), Vector3<double>(t[2] - t[0]));
  };
  const auto sum = [](const RoundedTriangle& t) { return Vector3<double>(t[0] + t[1] + t[2]); };
  const std::array normals{Vector3<double>(sum(b) - sum(a)), Vector3<double>(normal(a)), Vector3<double>(normal(b))};
  return std::ranges::any_of(normals,
                             [&](const Vector3<double>& n) { return lies_beyond(b, a, n) || lies_beyond(a, b, n); });
}

}  // namespace

Enclosure distance_of(const Triangle& triangle, const MeshSolid& mesh, const Hook& interrupted) {
  const SeenTriangle seen(triangle, mesh.motion().inverse());
  bool is_outside = false;
  for (const PreciseVector& corner : seen.corners) {
    const Enclosure place = mesh.signed_distance_of(corner);
    if (place.hi <= 0.0) return they_meet;
    is_outside = is_outside || place.lo > 0.0;
  }
  if (!(seen.ball.radius < infinity)) return unknown;
  const double to_centre = mesh.tree().nearest(seen.ball.centre).distance.hi;
  const double asked = add(to_centre, seen.ball.radius, Direction::up);
  const Enclosure of_surface = distance_of(mesh.tree(), seen, asked, interrupted);
  return is_outside ? of_surface : Enclosure{0.0, of_surface.hi};
}

bool keep_off_surface(std::span<const Triangle> triangles, const MeshSolid& mesh, const Hook& interrupted) {
  const RigidMotion to_mesh = mesh.motion().inverse();
  return std::ranges::all_of(triangles, [&](const Triangle& triangle) {
    if (interrupted && interrupted()) return false;
    const SeenTriangle seen(triangle, to_mesh);
    if (!(seen.ball.radius < infinity)) return false;
    return std::ranges::all_of(mesh.tree().within(seen.ball.centre, seen.ball.radius), [&](std::uint32_t n) {
      const Triangle other = mesh.tree().triangle(n);
      return are_parted(exactly(other), seen.about) || distance_of(corners_of(other), seen.corners).lower > Real(0);
    });
  });
}

namespace {

using LongPoint = Coordinates<long double>;

PreciseVector exactly(const LongPoint& x) {
  return {Real(x[0]), Real(x[1]), Real(x[2])};
}

LongPoint in_long_double(const PreciseVector& x) {
  return {x[0].lower().to_long_double(), x[1].lower().to_long_double(), x[2].lower().to_long_double()};
}

bool has_ends(const LongPoint& x) {
  return std::ranges::all_of(x, [](long double c) { return std::isfinite(c); });
}

/// A mesh and an unbent superquadric, in whose own frame the mesh stands by a motion.
class MeshAndSuperquadric {
 public:
  MeshAndSuperquadric(const MeshSolid& mesh, const PosedSuperquadric& solid, const RigidMotion& to_solid)
      : mesh_(mesh), solid_(solid), set_(solid.superquadric()), to_solid_(to_solid) {}

  /// A convex solid that keeps off the surface lies on one side of it, as the origin of its own frame does.
  [[nodiscard]] Enclosure distance(const Hook& interrupted) const {
    const Enclosure of_origin = mesh_.signed_distance_of(to_solid_.inverse()(PreciseVector()));
    if (of_origin.hi <= 0.0) return they_meet;
    std::vector<Candidate> candidates;
    for (std::uint32_t n = 0; n < mesh_.tree().size(); ++n) {
      const Ball ball = ball_about(mesh_.tree().triangle(n));
      const PreciseInterval apart = length<Real>(to_solid_(precise(ball.centre))) - solid_.radius();
      const Real lower = (apart - PreciseInterval(Real(ball.radius))).lower();
      candidates.push_back({lower.to_double(Direction::down), n});
    }
    const RigidMotion to_mesh = to_solid_.inverse();
    const Enclosure found = least_distance(candidates, infinity, interrupted, [&](std::uint32_t n, double /*asked*/) {
      return distance_of_triangle(PosedTriangle(mesh_.tree().triangle(n), to_mesh));
    });
    return of_origin.lo > 0.0 ? found : Enclosure{0.0, found.hi};
  }

 private:
  /// A direction and a point of the superquadric, as proposed, prove the ends.
  [[nodiscard]] Enclosure distance_of_triangle(const PosedTriangle& posed) const {
    const PreciseTriangle& triangle = posed.corners();
    const auto holds = [&](const PreciseVector& x) { return solid_.bounds().gauge_up(x) <= Real(1); };
    if (std::ranges::any_of(triangle, holds)) return they_meet;
    const TriangleSet<long double> corners{
        {in_long_double(triangle[0]), in_long_double(triangle[1]), in_long_double(triangle[2])}};
    if (!std::ranges::all_of(corners.corners, has_ends)) return unknown;
    const GjkResult<long double> proposed = gjk<long double>(set_, corners, LongPoint{});
    if (!has_ends(proposed.separation) || !has_ends(proposed.on_a)) return unknown;
    const PreciseVector on_solid = moved_into(solid_.bounds(), exactly(proposed.on_a));
    return {std::max(0.0, lower_by_normal(solid_, posed, proposed.separation)),
            length<Real>(way_from_triangle<Real>(triangle, on_solid)).upper().to_double(Direction::up)};
  }

  const MeshSolid& mesh_;
  const PosedSuperquadric& solid_;
  SuperquadricSet<long double> set_;
  RigidMotion to_solid_;
};

/// For proposals.
ApproximateMotion<long double> approximate(const RigidMotion& motion) {
  return {{in_long_double(motion.rotation.row(0)), in_long_double(motion.rotation.row(1)),
           in_long_double(motion.rotation.row(2))},
          in_long_double(motion.translation)};
}

Enclosure distance_of(const PairBounds& pair) {
  const SuperquadricSet<long double> a(pair.a().superquadric());
  const PosedSet<long double, SuperquadricSet<long double>> b(SuperquadricSet<long double>(pair.b().superquadric()),
                                                              approximate(pair.relative()));
  const GjkResult<long double> proposed = gjk<long double>(a, b, LongPoint{});
  if (!has_ends(proposed.separation) || !has_ends(proposed.on_a) || !has_ends(proposed.on_b)) return unknown;
  const PreciseVector on_b = pair.relative().inverse()(exactly(proposed.on_b));
  const bool parts = proposed.end != GjkEnd::common;
  return in_binary64({parts ? pair.lower_by_vector(exactly(proposed.separation)) : Real(0),
                      pair.upper_by_points(exactly(proposed.on_a), on_b)});
}

/// Returns whether the point is proven to lie in the model. `x` is enclosed in the model's frame.
bool holds(const MeshModel& model, const PreciseVector& x) {
  const auto in_mesh = [&](const MeshSolid& mesh) {
    return mesh.signed_distance_of(mesh.motion().inverse()(x)).hi <= 0.0;
  };
  if (std::ranges::any_of(model.meshes, in_mesh)) return true;
  for (std::size_t i = 0; i < model.others.primitives.size(); ++i) {
    const PreciseVector own = model.others.inverse_motions[i](x);
    if (model.others.primitives[i].bounds().gauge_up(own) <= Real(1)) return true;
  }
  return false;
}

/// Checks the whole model, too.
Model superquadrics_of(const Model& model) {
  require_valid_with_meshes(model);
  require_union(model, "distances to meshes");
  Model others{model.units, {}};
  for (const Primitive& primitive : model.primitives)
    if (!primitive.mesh) others.primitives.push_back(primitive);
  if (!others.primitives.empty()) require_union_of_convex(others, "distances to meshes");
  return others;
}

}  // namespace

MeshModel::MeshModel(const Model& model) : others(superquadrics_of(model)) {
  for (const Primitive& primitive : model.primitives)
    if (primitive.mesh) meshes.emplace_back(primitive);
}

Enclosure MeshPairChecker::distance(const ShortMotion& motion, const std::optional<Point>& common,
                                    const Hook& interrupted) const {
  const RigidMotion& pose = motion.pose();
  if (common && is_finite(*common) && holds(a_, precise(*common)) && holds(b_, pose.local_point(*common)))
    return they_meet;
  Enclosure found{infinity, infinity};
  for (const MeshSolid& b : b_.meshes) {
    const RigidMotion b_to_a = pose.after(b.motion());
    const auto [centre, radius] = b.sphere();
    found = least_of(found, moving(from_a(b, b_to_a, interrupted), motion.way_of({b_to_a(centre), radius})));
  }
  for (std::size_t j = 0; j < b_.others.primitives.size(); ++j) {
    const PosedSuperquadric& b = b_.others.primitives[j];
    const RigidMotion b_to_a = pose.after(b_.others.motions[j]);
    found = least_of(found, moving(from_a(b, b_to_a, interrupted), motion.way_of({b_to_a.translation, b.radius()})));
  }
  return found;
}

/// No point of a part of B comes nearer than the longest way in the part.
Enclosure MeshPairChecker::moving(const Enclosure& at_moment, const PreciseInterval& way) {
  const double longest = way.upper().to_double(Direction::up);
  return {std::max(0.0, subtract(at_moment.lo, longest, Direction::down)), at_moment.hi};
}

Enclosure MeshPairChecker::from_a(const MeshSolid& b, const RigidMotion& b_to_a, const Hook& interrupted) const {
  Enclosure found{infinity, infinity};
  for (const MeshSolid& a : a_.meshes)
    found = least_of(found, Meshes(a, b, a.motion().inverse().after(b_to_a)).distance(interrupted));
  for (std::size_t i = 0; i < a_.others.primitives.size(); ++i) {
    const RigidMotion to_solid = a_.others.inverse_motions[i].after(b_to_a);
    found = least_of(found, MeshAndSuperquadric(b, a_.others.primitives[i], to_solid).distance(interrupted));
  }
  return found;
}

Enclosure MeshPairChecker::from_a(const PosedSuperquadric& b, const RigidMotion& b_to_a,
                                  const Hook& interrupted) const {
  Enclosure found{infinity, infinity};
  for (const MeshSolid& a : a_.meshes) {
    const RigidMotion to_solid = b_to_a.inverse().after(a.motion());
    found = least_of(found, MeshAndSuperquadric(a, b, to_solid).distance(interrupted));
  }
  for (std::size_t i = 0; i < a_.others.primitives.size(); ++i)
    found = least_of(found, distance_of({a_.others.primitives[i], b, a_.others.inverse_motions[i].after(b_to_a)}));
  return found;
}

}  // namespace verisq::verify
