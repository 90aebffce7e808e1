/// This file implements convex_primitive.hpp.
#include "verify/search/convex_primitive.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/contact.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

/// If a proposal leaves a width of more than this, in units of the largest length involved, a better one is worth it.
constexpr double kExpectedWidth = 1e-14;

/// GJK's share of the tolerance. Its point lies on a chord, below the surface. Moved along the ray from the centre up
/// to the surface of a solid with axes 1:400, it is farther by 400 times its depth.
constexpr double kShareOfTolerance = 1e-4;

/// GJK is not trusted with distances below this, in units of the size.
constexpr double kNearest = 1e-3;
/// Points at the distance of the size take 5 to 20 steps, points beside the surface 60.
constexpr int kMostSteps = 24;

Coordinates<double> rounded(const Proposal& x) {
  return {static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2])};
}

Proposal widened(const Coordinates<double>& x) {
  return {x[0], x[1], x[2]};
}

/// Nothing if GJK does not separate q from the solid, or only just. Beside the surface binary64 has no digits left for
/// its direction, the certificate's vector does not lead to the moved point, and `fast_contact` is faster.
std::optional<Contact> gjk_contact(const Superquadric& solid, const Proposal& q, double tolerance) {
  const Coordinates<double> point = rounded(q);
  const GjkResult<double> found = gjk<double>(SuperquadricSet<double>(solid), PointSet<double>{point}, point,
                                              {.absolute = kShareOfTolerance * tolerance, .most_steps = kMostSteps});
  if (!(found.lower > kNearest * std::ranges::max(solid.semi_axes))) return std::nullopt;
  // The direction that leads to the point, not the best one of the search: a certificate stores one vector for both.
  const Proposal x = widened(found.on_a);
  return Contact{x, {q[0] - x[0], q[1] - x[1], q[2] - x[2]}};
}

/// The foot of a contact, with the gradient of the gauge there instead of the vector to q. Hardly off a flat face of a
/// tapered solid, the difference of both has only some digits of its direction, because the height has been rounded.
Contact with_own_normal(const Superquadric& solid, const Contact& contact) {
  const Proposal& x = contact.point;
  const auto n = Boundary<long double>(solid).normal({std::fabs(x[0]), std::fabs(x[1]), x[2]});
  return {x, {std::copysign(n[0], x[0]), std::copysign(n[1], x[1]), n[2]}};
}

PrimitiveDistance certified(const SuperquadricBounds<Real>& bounds, const PreciseVector& q, const Contact& contact) {
  return {{lower_bound(bounds, q, contact.normal), upper_bound(bounds, q, contact.point)},
          contact.normal,
          difference(midpoint(q), contact.point)};
}

PrimitiveDistance best_of(const PrimitiveDistance& a, const PrimitiveDistance& b, const PreciseVector& q) {
  const auto what = [&] {
    return "the distance of a superquadric to " + text_of(rounded(midpoint(q))) + " in its frame";
  };
  return {intersection(a.distance, b.distance, what), b.distance.lo > a.distance.lo ? b.direction : a.direction,
          b.distance.hi < a.distance.hi ? b.witness : a.witness};
}

}  // namespace

PrimitiveDistance exterior_distance(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                    const PreciseVector& q, double tolerance) {
  const Proposal middle = midpoint(q);
  const double reach = length<Real>(q).upper().to_double(Direction::up);
  const double expected = kExpectedWidth * std::max(reach, std::ranges::max(solid.semi_axes));
  std::optional<PrimitiveDistance> best;
  const auto prove = [&](const Contact& contact) {
    const PrimitiveDistance proven = certified(bounds, q, contact);
    best = best ? best_of(*best, proven, q) : proven;
    return best->distance.width() <= std::max(tolerance, expected);
  };
  // Binary64 does for a tolerance; the tightest enclosure of a point beside the surface takes long double.
  if (tolerance > expected) {
    const std::optional<Contact> contact = gjk_contact(solid, middle, tolerance);
    if (contact && prove(*contact)) return *best;
  }
  const Contact fast = fast_contact(solid, middle);
  if (prove(fast) || bounds.gauge(q).lower() <= Real(1)) return *best;
  if (is_tapered(solid)) {
    const Contact own = with_own_normal(solid, fast);
    if (usable(own.normal) && prove(own)) return *best;
  }
  if (prove(thorough_contact(solid, middle))) return *best;
  // Whatever was proposed, nothing is looser than the ray from the centre, the ball and the box about the solid prove.
  if (usable(middle)) prove({middle, middle});
  for (std::size_t i = 0; i < 3; ++i) {
    Proposal axis{};
    axis[i] = std::copysign(1.0L, middle[i]);
    prove({middle, axis});
  }
  return *best;
}

namespace {

// The proof that the faces of the polyhedron bound the depth. Let d1, d2, d3 >= 0 with q + d_i proven inside the solid
// K, and c >= 0 with |c| <= 1 and c·d_i >= t > 0. A vector v of the cone of the d_i with |v| <= t is v = Σ l_i d_i, l_i
// >= 0, and t Σ l_i <= c·v <= |v| <= t. So q + v lies in the hull of q and the q + d_i, which lies in K. If cones cover
// the octant, B(q, t) lies in K, because g is monotone in each |coordinate| and |q_k + t u_k| <= q_k + t |u_k|. The
// best c points at the point of the triangle d1 d2 d3 closest to q, and then t is the distance to it. The gap to the
// surface is that of chords: zero where the surface is flat, quadratic in the size of the face elsewhere. For a tapered
// solid g is monotone in |x| and |y| alone: cones cover z < 0, too, where d_i and c have z <= 0.

using Vector = Coordinates<double>;

/// Σ a_k b_k of numbers whose products are not negative, on one side.
double rounded_dot(const Vector& a, const Vector& b, Direction direction) {
  const double xy = add(multiply(a[0], b[0], direction), multiply(a[1], b[1], direction), direction);
  return add(xy, multiply(a[2], b[2], direction), direction);
}

/// A point q + reach * direction, proven to lie in the solid.
struct Corner {
  Vector direction;  ///< exact: barycentric coordinates that are multiples of a power of two
  double reach;
  Vector offset;  ///< reach * direction, rounded down
};

/// The cone of three corners (of two, one repeated, in the plane).
struct Cell {
  std::array<int, 3> corners;
  double depth;  ///< proven for this cone
  int level;     ///< bisections so far

  bool operator<(const Cell& other) const { return depth > other.depth; }  // the shallowest cell comes first
};

/// Directions stay exact for this many bisections; tolerances of 1e-12 need about 40.
constexpr int kDeepestLevel = 50;

class Polyhedron {
 public:
  Polyhedron(const Superquadric& solid, const Vector& q) : boundary_(solid), bounds_(solid), q_(q) {}

  Depth enclose(bool planar, const DepthGoal& goal) {
    best_.lower = goal.known;
    const Vector start = boundary_.normal(q_);
    descend(start, boundary_.exit(q_, start));
    const int x = add_corner({1.0, 0.0, 0.0});
    const int z = add_corner({0.0, 0.0, 1.0});
    const int y = planar ? z : add_corner({0.0, 1.0, 0.0});
    std::priority_queue<Cell> cells;
    cells.push(cell({x, y, z}, 0));
    if (bounds_.is_tapered()) {
      const int below = add_corner({0.0, 0.0, -1.0});
      cells.push(cell({x, planar ? below : y, below}, 0));
    }
    for (;;) {
      const Cell worst = cells.top();
      best_.lower = std::max(best_.lower, worst.depth);
      if (best_.upper - best_.lower <= goal.tolerance || worst.level == kDeepestLevel ||
          static_cast<int>(corners_.size()) >= goal.budget) {
        return best_;
      }
      cells.pop();
      for (const Cell& half : bisect(worst)) cells.push(half);
    }
  }

 private:
  /// Goes from a direction to the normal where its ray leaves the solid, and repeats: each tangent plane is at least as
  /// close as the exit before it. Keeps the closest plane.
  void descend(Vector w, double exit) {
    for (int i = 0; i < 30; ++i) {
      const Vector n = boundary_.normal(along(q_, w, exit));
      const double distance = exit * dot(w, n);
      if (!(distance < best_.upper)) return;
      const bool settled = best_.upper - distance < 1e-15 * distance;
      best_.upper = distance;
      best_.normal = n;
      if (settled) return;
      w = n;
      exit = boundary_.exit(q_, w);
    }
  }

  [[nodiscard]] bool proven_inside(const Vector& w, double reach) const {
    Vector3<double> x;
    for (std::size_t k = 0; k < 3; ++k) x[k] = Interval(q_[k]) + Interval(reach) * Interval(w[k]);
    return bounds_.gauge_up(x) <= 1.0;
  }

  /// As far along the ray as can be proven; zero at worst, because q itself is inside.
  [[nodiscard]] double proven_reach(const Vector& w) const {
    double margin = 4e-15;
    while (margin < 1.0) {
      const double reach = boundary_.exit(q_, w, 1.0 - margin);
      if (proven_inside(w, reach)) return reach;
      margin *= 8.0;
    }
    return 0.0;
  }

  int add_corner(const Vector& w) {
    descend(w, boundary_.exit(q_, w));
    Corner corner{w, proven_reach(w), {}};
    for (std::size_t k = 0; k < 3; ++k) {
      corner.offset[k] = multiply(corner.reach, w[k], w[k] < 0.0 ? Direction::up : Direction::down);  // towards 0
    }
    corners_.push_back(corner);
    return static_cast<int>(corners_.size()) - 1;
  }

  [[nodiscard]] const Vector& offset(int corner) const { return corners_[static_cast<std::size_t>(corner)].offset; }

  [[nodiscard]] Cell cell(const std::array<int, 3>& corners, int level) const {
    const Vector& a = offset(corners[0]);
    const Vector& b = offset(corners[1]);
    const Vector& c = offset(corners[2]);
    Vector axis = closest_to_origin(a, b, c);
    // Dividing by a length rounded up, downwards, makes |axis| <= 1 certain.
    const double length = square_root(rounded_dot(axis, axis, Direction::up), Direction::up);
    if (!(length > 0.0)) return {corners, 0.0, level};
    const bool below = a[2] < 0.0 || b[2] < 0.0 || c[2] < 0.0;
    axis[2] = below ? -axis[2] : axis[2];
    for (double& k : axis) k = divide(std::max(k, 0.0), length, Direction::down);
    axis[2] = below ? -axis[2] : axis[2];
    const double depth = std::min({rounded_dot(axis, a, Direction::down), rounded_dot(axis, b, Direction::down),
                                   rounded_dot(axis, c, Direction::down)});
    return {corners, depth, level};
  }

  /// Splits at the middle of the longest edge of the face.
  std::array<Cell, 2> bisect(const Cell& parent) {
    constexpr std::array<std::pair<int, int>, 3> edges{{{0, 1}, {1, 2}, {2, 0}}};
    std::pair<int, int> longest{};
    double squared = -1.0;
    for (const auto& [i, j] : edges) {
      const Vector edge = difference(offset(parent.corners[i]), offset(parent.corners[j]));
      if (dot(edge, edge) <= squared) continue;
      squared = dot(edge, edge);
      longest = {parent.corners[i], parent.corners[j]};
    }
    const int middle = middle_of(longest.first, longest.second);
    std::array<int, 3> first = parent.corners;
    std::array<int, 3> second = parent.corners;
    std::ranges::replace(first, longest.second, middle);
    std::ranges::replace(second, longest.first, middle);
    return {cell(first, parent.level + 1), cell(second, parent.level + 1)};
  }

  int middle_of(int a, int b) {
    const auto [position, created] = middles_.try_emplace(std::minmax(a, b), 0);
    if (created) {
      const Vector& u = corners_[static_cast<std::size_t>(a)].direction;
      const Vector& v = corners_[static_cast<std::size_t>(b)].direction;
      position->second = add_corner({0.5 * (u[0] + v[0]), 0.5 * (u[1] + v[1]), 0.5 * (u[2] + v[2])});
    }
    return position->second;
  }

  Boundary<double> boundary_;
  SuperquadricBounds<double> bounds_;
  Vector q_;
  Depth best_{0.0, infinity, {1.0, 0.0, 0.0}};
  std::vector<Corner> corners_;
  std::map<std::pair<int, int>, int> middles_;
};

/// Depth of q, the largest t with B(q, t) inside the solid. Preconditions: q >= 0 in the solid's own frame, but for z
/// of a tapered solid; g(q) <= 1 proven by the caller; largest semi-axis in [1, 2) and none below 1e-200. With
/// `planar`, q[1] must be 0 and the solid one of revolution about z: the section y = 0 then decides.
Depth enclose_depth(const Superquadric& solid, const std::array<double, 3>& q, bool planar, const DepthGoal& goal) {
  return Polyhedron(solid, q).enclose(planar, goal);
}

/// Enough for a continuum of nearest boundary points at 1e-6; continua of revolution are reduced before.
constexpr int kBudget = 50'000;

/// The proofs of surface points in binary64 lose some 4e-15 of the largest semi-axis.
constexpr double kFinestTolerance = 1e-14;

/// The same problem in the octant of nonnegative coordinates (for a tapered solid z may be negative, too), with the
/// largest semi-axis in [1, 2).
struct Reduced {
  Superquadric solid;
  std::array<double, 3> q;  ///< at least the exact coordinates: by monotony, balls about it that lie inside prove more
  PreciseInterval moved;    ///< if g is not monotone: the distance of q from the exact point, in the original's unit
  bool planar;              ///< like `order`, as in RevolvedPoint
  std::array<std::size_t, 3> order;
  int scale;  ///< binary exponent of the original's unit
};

/// value * 2^exponent of a nonnegative value, rounded down: it is inexact where it underflows.
double scaled_down(double value, int exponent) {
  const double result = std::ldexp(value, exponent);
  return std::ldexp(result, -exponent) > value ? std::nextafter(result, 0.0) : result;
}

double scaled_up(double value, int exponent) {
  const double result = std::ldexp(value, exponent);
  return std::ldexp(result, -exponent) < value ? std::nextafter(result, 4.0) : result;
}

Reduced reduce(const Superquadric& solid, const PreciseVector& q) {
  const RevolvedPoint point = revolved(solid, q);
  Reduced reduced{point.solid,  {},          PreciseInterval(0),
                  point.planar, point.order, std::ilogb(std::ranges::max(solid.semi_axes))};
  for (double& axis : reduced.solid.semi_axes) axis = std::ldexp(axis, -reduced.scale);  // see searchable()
  for (std::size_t k = 0; k < 3; ++k) {
    const double coordinate = point.q[k].upper().to_double(Direction::up);
    reduced.q[k] = scaled_up(coordinate, -reduced.scale);
  }
  if (is_tapered(solid)) {
    reduced.moved = abs(point.q[2] - PreciseInterval(Real(std::ldexp(reduced.q[2], reduced.scale)))).upper();
  }
  return reduced;
}

/// Undoes the reduction for a direction; not proven, as a certificate's direction need not be.
Proposal restored(const Reduced& reduced, const std::array<double, 3>& normal, const PreciseVector& q) {
  std::array<long double, 3> original{};
  for (std::size_t k = 0; k < 3; ++k) {
    original[k] = q[reduced.order[k]].upper().to_long_double();
  }
  std::array<long double, 3> v{normal[0], normal[1], normal[2]};
  if (reduced.planar) {
    const long double radius = std::hypot(original[0], original[1]);
    const long double radial = v[0];
    v[0] = radius > 0.0L ? radial * std::fabs(original[0]) / radius : radial;
    v[1] = radius > 0.0L ? radial * std::fabs(original[1]) / radius : 0.0L;
  }
  Proposal result{};
  for (std::size_t k = 0; k < 3; ++k) result[reduced.order[k]] = std::copysign(v[k], original[k]);
  if (is_tapered(reduced.solid)) result[2] = v[2];
  return result;
}

/// Returns whether scaling kept the semi-axes exact and the proofs in binary64 still find q inside.
bool searchable(const Reduced& reduced) {
  return std::ranges::min(reduced.solid.semi_axes) >= 1e-200 &&
         SuperquadricBounds<double>(reduced.solid).gauge_up({reduced.q[0], reduced.q[1], reduced.q[2]}) <= 1.0;
}

/// The shortest semi-axis: a usable direction where nothing better is known.
std::array<double, 3> shortest_axis(const Superquadric& solid) {
  std::array<double, 3> axis{};
  axis[static_cast<std::size_t>(std::ranges::min_element(solid.semi_axes) - solid.semi_axes.begin())] = 1.0;
  return axis;
}

}  // namespace

PrimitiveDistance interior_distance(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                    const PreciseVector& q, double tolerance) {
  double depth = central_depth(solid, bounds, q);
  const Reduced reduced = reduce(solid, q);
  std::array<double, 3> normal = shortest_axis(reduced.solid);
  if (searchable(reduced)) {
    const double finest = std::max(std::ldexp(tolerance, -reduced.scale), kFinestTolerance);
    const Depth found =
        enclose_depth(reduced.solid, reduced.q, reduced.planar, {finest, scaled_down(depth, -reduced.scale), kBudget});
    const PreciseInterval about_q = PreciseInterval(Real(scaled_down(found.lower, reduced.scale))) - reduced.moved;
    depth = std::max(depth, about_q.lower().to_double(Direction::down));
    normal = found.normal;
  }
  const Proposal direction = restored(reduced, normal, q);
  return {{lower_bound(bounds, q, direction), -depth}, direction};
}

PrimitiveDistance ConvexPrimitive::signed_distance(const Point& x, double tolerance) const {
  const PreciseVector q = proof_.motion().local_point(x);
  PrimitiveDistance result = exterior_distance(proof_.superquadric(), proof_.bounds(), q, tolerance);
  if (result.distance.lo <= 0.0 && proof_.bounds().gauge(q).upper() <= Real(1)) {
    const PrimitiveDistance inside = interior_distance(proof_.superquadric(), proof_.bounds(), q, tolerance);
    result.distance.hi = inside.distance.hi;
    if (inside.distance.lo > result.distance.lo) result = inside;
  }
  result.distance = between(result.distance.lo, result.distance.hi,
                            [&] { return "the signed distance of a superquadric at " + text_of(x); });
  return result;
}

double ConvexPrimitive::ray_clearance(const Point& x, const Proposal& u) const {
  const PreciseVector q = proof_.motion().local_point(x);
  const PreciseVector v = proof_.motion().rotation.transpose() * precise(u);
  const PreciseInterval squared_length = square(v[0]) + square(v[1]) + square(v[2]);
  return ((proof_.bounds().support(v) - v.dot(q)) / squared_length).upper().to_double(Direction::up);
}

bool ConvexPrimitive::separated(const Point& x, const Proposal& u, double s) const {
  const PreciseVector q =
      proof_.motion().local_point(x) + proof_.motion().rotation.transpose() * precise(u) * PreciseInterval(Real(s));
  if ((length<Real>(q) - proof_.radius()).lower() > Real(0)) return true;
  return lower_bound(proof_.bounds(), q, fast_contact(proof_.superquadric(), midpoint(q)).normal) > 0.0;
}

PreciseVector ConvexPrimitive::bounding_box() const {
  return proof_.motion()(proof_.box());
}

}  // namespace verisq::verify
