/// The nearest point of a surface of convex_primitive.hpp, and the contacts of contact.hpp.

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "verify/proposals/support_mapping.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/contact.hpp"
#include "verify/search/convex_primitive.hpp"
#include "verify/search/krawczyk.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/distance.hpp"

namespace verisq::verify {

namespace {

using Wide = long double;
using WideVector = Coordinates<Wide>;

constexpr std::size_t kMostExits = 4000;  ///< points of the surface
constexpr int kMostBisections = 50;       ///< directions stay exact
constexpr Wide kExitMargin = 0x1p-62;     ///< of the gauge: the loss of a proposed surface point by rounding

/// A ray from q and a point q + d of it that is proven to lie in the solid.
struct Exit {
  WideVector direction;  ///< exact: barycentric coordinates that are multiples of a power of two
  PreciseVector unit;
  PreciseVector d;
  WideVector nearest_d;  ///< for proposals
};

struct DirectionCone {
  std::array<std::size_t, 3> exits;
  int bisections;
};

class DirectionCover {
 public:
  DirectionCover(const Superquadric& solid, const SuperquadricBounds<Real>& bounds, const PreciseVector& q,
                 const PreciseInterval& depth, const PreciseVector& box)
      : boundary_(solid), bounds_(bounds), q_(q), nearest_q_(midpoint(q)), depth_(depth), box_(box) {
    for (std::size_t k = 0; k < 3; ++k) mirrored_[k] = q[k].upper() == Real(0) && (k < 2 || !bounds.is_tapered());
  }

  [[nodiscard]] bool succeeds() {
    const std::size_t x = add({1, 0, 0});
    const std::size_t y = add({0, 1, 0});
    std::vector<DirectionCone> open{{{x, y, add({0, 0, 1})}, 0}};
    if (bounds_.is_tapered()) open.push_back({{x, y, add({0, 0, -1})}, 0});
    while (!open.empty()) {
      const DirectionCone cone = open.back();
      open.pop_back();
      if (cleared(cone) || in_box(cone)) continue;
      if (cone.bisections == kMostBisections || exits_.size() >= kMostExits) return false;
      for (const DirectionCone& half : halves(cone)) open.push_back(half);
    }
    return true;
  }

 private:
  /// A vector about normal to the face of three points, towards it, with the signs that the lemma requires.
  [[nodiscard]] PreciseVector axis_of(const WideVector& a, const WideVector& b, const WideVector& c) const {
    WideVector foot = closest_to_origin(a, b, c);
    const std::size_t folded = bounds_.is_tapered() ? 2 : 3;
    for (std::size_t k = 0; k < folded; ++k) foot[k] = std::max<Wide>(foot[k], 0);
    if (folded == 2)
      foot[2] = std::min({a[2], b[2], c[2]}) < 0 ? std::min<Wide>(foot[2], 0) : std::max<Wide>(foot[2], 0);
    return usable(foot) ? precise(foot) : PreciseVector();
  }

  [[nodiscard]] const Exit& exit_of(const DirectionCone& cone, std::size_t corner) const {
    return exits_[cone.exits[corner]];
  }

  [[nodiscard]] bool cleared(const DirectionCone& cone) const {
    const PreciseVector axis =
        axis_of(exit_of(cone, 0).nearest_d, exit_of(cone, 1).nearest_d, exit_of(cone, 2).nearest_d);
    const Real reach = (length<Real>(axis) * PreciseInterval(depth_.upper())).upper();
    return std::ranges::all_of(cone.exits, [&](std::size_t i) { return axis.dot(exits_[i].d).lower() > reach; });
  }

  [[nodiscard]] bool in_box(const DirectionCone& cone) const {
    const auto nearest = [&](std::size_t corner) { return midpoint(exit_of(cone, corner).unit); };
    const PreciseVector axis = axis_of(nearest(0), nearest(1), nearest(2));
    Real least = axis.dot(exit_of(cone, 0).unit).lower();
    for (std::size_t i = 1; i < 3; ++i) least = std::min(least, axis.dot(exit_of(cone, i).unit).lower());
    if (!(least > Real(0))) return false;
    const PreciseInterval longest = length<Real>(axis) / PreciseInterval(least);  // 1/m, from above
    const PreciseInterval factor = hull(PreciseInterval(depth_.lower()), PreciseInterval(depth_.upper()) * longest);
    for (std::size_t k = 0; k < 3; ++k) {
      const PreciseInterval u =
          hull(hull(exit_of(cone, 0).unit[k], exit_of(cone, 1).unit[k]), exit_of(cone, 2).unit[k]);
      const PreciseInterval p = q_[k] + u * factor;
      if (!subset(p, box_[k]) || (mirrored_[k] && !subset(-p, box_[k]))) return false;
    }
    return true;
  }

  std::size_t add(const WideVector& direction) {
    exits_.push_back(proven_exit(direction));
    return exits_.size() - 1;
  }

  /// The exit as far along the ray as can be proven; q itself at worst.
  [[nodiscard]] Exit proven_exit(const WideVector& direction) const {
    const PreciseVector exact = precise(direction);
    const PreciseVector unit = exact / length<Real>(exact);
    for (Wide margin = kExitMargin; margin < 1; margin *= 8) {
      const Wide reach = boundary_.exit(nearest_q_, direction, 1 - margin);
      const PreciseVector d = exact * PreciseInterval(Real(reach));
      if (std::isfinite(reach) && bounds_.gauge_up(q_ + d) <= Real(1)) {
        return {direction, unit, d, along(WideVector{}, direction, reach)};
      }
    }
    return {direction, unit, PreciseVector(), {}};
  }

  /// Cuts the longest edge between the unit vectors at the middle direction.
  [[nodiscard]] std::array<DirectionCone, 2> halves(const DirectionCone& cone) {
    constexpr std::array<std::pair<std::size_t, std::size_t>, 3> edges{{{0, 1}, {1, 2}, {2, 0}}};
    std::pair<std::size_t, std::size_t> longest{};
    Wide squared = -1;
    for (const auto& [i, j] : edges) {
      const WideVector edge = difference(exit_of(cone, i).nearest_d, exit_of(cone, j).nearest_d);
      if (dot(edge, edge) <= squared) continue;
      squared = dot(edge, edge);
      longest = {cone.exits[i], cone.exits[j]};
    }
    const std::size_t middle = middle_of(longest.first, longest.second);
    DirectionCone first{cone.exits, cone.bisections + 1};
    DirectionCone second = first;
    std::ranges::replace(first.exits, longest.second, middle);
    std::ranges::replace(second.exits, longest.first, middle);
    return {first, second};
  }

  [[nodiscard]] std::size_t middle_of(std::size_t a, std::size_t b) {
    const auto [position, created] = middles_.try_emplace(std::minmax(a, b), 0);
    if (created) {
      const WideVector u = exits_[a].direction;
      const WideVector v = exits_[b].direction;
      position->second = add({(u[0] + v[0]) / 2, (u[1] + v[1]) / 2, (u[2] + v[2]) / 2});
    }
    return position->second;
  }

  Boundary<Wide> boundary_;
  const SuperquadricBounds<Real>& bounds_;
  const PreciseVector& q_;
  WideVector nearest_q_;
  const PreciseInterval& depth_;
  const PreciseVector& box_;
  std::array<bool, 3> mirrored_{};
  std::vector<Exit> exits_;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles_;
};

}  // namespace

bool nearest_points_lie_in(const Superquadric& solid, const SuperquadricBounds<Real>& bounds, const PreciseVector& q,
                           const PreciseInterval& depth, const PreciseVector& box) {
  return DirectionCover(solid, bounds, q, depth, box).succeeds();
}

namespace {

constexpr const char* what_of_points = "a coordinate of the closest point of a superquadric";
constexpr const char* what_of_normals = "a component of the normal of a superquadric";
constexpr const char* what_of_distances = "the signed distance of a superquadric";

/// If a box is wider than this, in units of the size, another attempt is worth it.
constexpr double kNarrowestBox = 0x1p-46;

/// In the solid's own frame.
struct LocalAnswer {
  PreciseInterval distance;
  PreciseVector point;
  PreciseVector normal;
};

LocalAnswer intersection(const LocalAnswer& a, const LocalAnswer& b) {
  return {intersection(a.distance, b.distance, what_of_distances), intersection(a.point, b.point, what_of_points),
          intersection(a.normal, b.normal, what_of_normals)};
}

PreciseVector any_unit_vector() {
  const PreciseInterval component(-1, 1);
  return {component, component, component};
}

PreciseVector unit(const PreciseVector& v) {
  return v / length<Real>(v);
}

double widest(const PreciseVector& box) {
  double width = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    width = std::max(width, subtract(box[k].upper(), box[k].lower(), Direction::up).to_double(Direction::up));
  }
  return width;
}

/// One query.
class Projection {
 public:
  Projection(const PosedSuperquadric& solid, const PreciseVector& q)
      : solid_(solid.superquadric()),
        bounds_(solid.bounds()),
        q_(q),
        size_((length<Real>(q) + solid.radius()).upper()),
        equations_(solid.superquadric(), q),
        near_gauge_(NormFunction<long double>::gauge(solid.superquadric())) {}

  /// Nothing if q is not proven to lie outside.
  [[nodiscard]] std::optional<LocalAnswer> outside() const {
    if (!(bounds_.gauge(q_).lower() > Real(1))) return std::nullopt;
    const Contact rough = rough_contact(solid_, midpoint(q_));
    Ends ends = ends_of(refined(rough));
    std::optional<LocalAnswer> answer = ball(ends);
    if (answer && narrow(*answer)) return answer;
    // On an edge the gradient at the foot is not the direction to q.
    const Contact fast = fast_contact(solid_, midpoint(q_));
    ends = better(ends, ends_of(fast));
    ends = better(ends, by_support({ends.feasible, unit(precise(fast.normal)), {}, {}}));
    ends = better(ends, by_support({ends.feasible, thin(unit(q_ - ends.feasible)), {}, {}}));
    answer = ball(ends);
    if (answer && narrow(*answer)) return answer;
    const std::optional<LocalAnswer> zero = stationary(ends.feasible, -ends.distance_upper);
    if (!zero || !(zero->distance.lower() > Real(0))) return answer;
    return answer ? intersection(*answer, *zero) : *zero;
  }

  /// Precondition: q is proven to lie in the interior. Nothing if a nearest point is not proven to be the only one.
  [[nodiscard]] std::optional<LocalAnswer> inside(const PrimitiveDistance& found) const {
    const PreciseVector direction = unit(precise(found.direction));
    const PreciseInterval reach(Real(-found.distance.lo));
    std::optional<LocalAnswer> zero = stationary(q_ + direction * reach, reach.upper());
    if (!zero || !(zero->distance.upper() < Real(0))) return std::nullopt;
    // The stationary point is one of the surface: it is not nearer than the nearest, and that is not farther than it.
    const PreciseInterval proven(Real(-infinity), Real(found.distance.hi));
    zero->distance = intersection(zero->distance, proven, what_of_distances);
    const PreciseInterval depth(Real(-found.distance.hi), -zero->distance.lower());
    return only(*zero, depth) ? zero : std::nullopt;
  }

  /// Precondition: the signed distance lies in `distance`. For q within rounding of the surface.
  [[nodiscard]] std::optional<LocalAnswer> beside_surface(const PreciseInterval& distance) const {
    const PreciseVector region = about_q(distance);
    const std::optional<PreciseVector> gradient = gradient_over(region);
    if (!gradient) return std::nullopt;
    const PreciseInterval multiplier = -distance / length<Real>(*gradient);
    if (!contains_at_most_one_zero<4>(equations_, unknowns(q_, PreciseInterval(0)), unknowns(region, multiplier))) {
      return std::nullopt;
    }
    return LocalAnswer{distance, region, unit(*gradient)};
  }

  /// All points that are not too far.
  [[nodiscard]] LocalAnswer anywhere(const PreciseInterval& distance) const {
    return {distance, about_q(distance), any_unit_vector()};
  }

 private:
  /// Bounds of the distance d of q outside by two evaluations, and the vectors that prove them.
  struct Ends {
    PreciseVector feasible;   ///< y, a box of which one point is known to lie in K
    PreciseVector direction;  ///< v, of length 1
    Real distance_lower;      ///< lower end of (v·q - h(v)) / |v|
    Real distance_upper;      ///< upper end of |q - y|
  };

  [[nodiscard]] PreciseVector feasible(const PreciseVector& x) const {
    const Real gauge = bounds_.gauge_up(x);
    return gauge > Real(0) ? PreciseVector(x / PreciseInterval(gauge)) : x;
  }

  /// The ends by the direction and the feasible point.
  [[nodiscard]] Ends by_support(Ends ends) const {
    const PreciseVector& v = ends.direction;
    const PreciseInterval support(bounds_.support_up(v));
    ends.distance_lower = ((v.dot(q_) - support) / length<Real>(v)).lower();
    ends.distance_upper = length<Real>(PreciseVector(q_ - ends.feasible)).upper();
    return ends;
  }

  /// The same by one evaluation of the gauge at a point x that is no box: y = x / g(x), and v = Dg(x). For this v, h(v)
  /// = 1 because v·z <= g(z) for all z. Only valid if the gauge is differentiable at x.
  [[nodiscard]] std::optional<Ends> by_gradient(const PreciseVector& x) const {
    try {
      const NormExpansion<PreciseInterval> g = equations_.gauge(x);
      const PreciseInterval length_of_gradient = length<Real>(g.gradient);
      if (!(g.value.lower() > Real(0)) || !(length_of_gradient.lower() > Real(0))) return std::nullopt;
      const PreciseVector y = x / PreciseInterval(g.value.upper());
      return Ends{y, g.gradient / length_of_gradient,
                  ((g.gradient.dot(q_) - PreciseInterval(1)) / length_of_gradient).lower(),
                  length<Real>(PreciseVector(q_ - y)).upper()};
    } catch (const std::domain_error&) {
      return std::nullopt;
    }
  }

  [[nodiscard]] Ends ends_of(const Contact& contact) const {
    const PreciseVector x = precise(contact.point);
    // The support function of a tapered solid is a root that is known to long double: too little for a ball.
    if (bounds_.is_tapered()) {
      if (const std::optional<Ends> ends = by_gradient(x)) return *ends;
    }
    return by_support({feasible(x), unit(precise(contact.normal)), {}, {}});
  }

  /// The larger lower end and the smaller upper one, with the vectors that prove them.
  [[nodiscard]] static Ends better(const Ends& a, const Ends& b) {
    const Ends& below = b.distance_lower > a.distance_lower ? b : a;
    const Ends& above = b.distance_upper < a.distance_upper ? b : a;
    return {above.feasible, below.direction, below.distance_lower, above.distance_upper};
  }

  /// Newton's method on the equations in long double, from a contact in binary64: nothing is proven. The contact itself
  /// where that leads nowhere.
  [[nodiscard]] Contact refined(const Contact& contact) const {
    using Vector = Eigen::Matrix<long double, 3, 1>;
    constexpr int steps = 3;
    const Proposal middle = midpoint(q_);
    const Vector q(middle[0], middle[1], middle[2]);
    const Vector start(contact.point[0], contact.point[1], contact.point[2]);
    Vector p = start;
    NormExpansion<long double> g = near_gauge_(p);
    p /= g.value;
    long double multiplier = -(q - p).norm() / g.gradient.norm();
    for (int i = 0; i < steps; ++i) {
      g = near_gauge_(p);
      Eigen::Matrix<long double, 4, 1> value;
      value << p - q - g.gradient * multiplier, g.value - 1.0L;
      Eigen::Matrix<long double, 4, 4> jacobian = Eigen::Matrix<long double, 4, 4>::Zero();
      jacobian.topLeftCorner<3, 3>() = Eigen::Matrix<long double, 3, 3>::Identity() - g.hessian * multiplier;
      jacobian.topRightCorner<3, 1>() = -g.gradient;
      jacobian.bottomLeftCorner<1, 3>() = g.gradient.transpose();
      const Eigen::Matrix<long double, 4, 1> step = jacobian.partialPivLu().solve(value);
      p -= step.head<3>();
      multiplier -= step[3];
    }
    g = near_gauge_(p);
    const Contact found{{p[0], p[1], p[2]}, {g.gradient[0], g.gradient[1], g.gradient[2]}};
    const bool near = (p - q).norm() <= 2.0L * (start - q).norm();
    return near && usable(found.point) && usable(found.normal) ? found : contact;
  }

  /// docs/mathematics.md §25: |y - p|² <= hi² - lo² and |n - v|² <= 2 (hi - lo)/hi. Nothing unless lo > 0.
  [[nodiscard]] std::optional<LocalAnswer> ball(const Ends& ends) const {
    if (!(ends.distance_lower > Real(0))) return std::nullopt;
    const PreciseInterval distance =
        intersection(PreciseInterval(ends.distance_lower, Real(infinity)),
                     PreciseInterval(Real(-infinity), ends.distance_upper), what_of_distances);
    const PreciseInterval lo(distance.lower());
    const PreciseInterval hi(distance.upper());
    const PreciseInterval gap((hi - lo).upper());
    PreciseVector p = inflated(ends.feasible, sqrt(gap * (hi + lo)).upper());
    PreciseVector n = inflated(unit(ends.direction), sqrt(PreciseInterval(2) * gap / hi).upper());
    n = intersection(n, (q_ - p) / distance, what_of_normals);
    p = intersection(p, q_ - n * distance, what_of_points);
    return LocalAnswer{distance, p, n};
  }

  [[nodiscard]] bool narrow(const LocalAnswer& answer) const {
    return widest(answer.point) <= kNarrowestBox * size_.to_double(Direction::down) &&
           widest(answer.normal) <= kNarrowestBox;
  }

  /// Nothing if the gradient is not bounded away from 0.
  [[nodiscard]] std::optional<PreciseVector> gradient_over(const PreciseVector& region) const {
    try {
      const PreciseVector gradient = equations_.gauge(region).gradient;
      if (length<Real>(gradient).lower() > Real(0)) return gradient;
    } catch (const std::domain_error&) {
      // The gauge is not differentiable on all of the region.
    }
    return std::nullopt;
  }

  /// Contains every nearest point of the surface.
  [[nodiscard]] PreciseVector about_q(const PreciseInterval& distance) const {
    return inflated(q_, abs(distance).upper());
  }

  [[nodiscard]] static IntervalVector<4> unknowns(const PreciseVector& p, const PreciseInterval& multiplier) {
    IntervalVector<4> result;
    result << p[0], p[1], p[2], multiplier;
    return result;
  }

  /// The stationary point about `p`, `depth` from q: a zero of the equations. `distance` has the sign of outside.
  [[nodiscard]] std::optional<LocalAnswer> stationary(const PreciseVector& p, const Real& depth) const {
    const std::optional<PreciseVector> gradient = gradient_over(thin(p));
    if (!gradient) return std::nullopt;
    const Real multiplier = (PreciseInterval(depth) / length<Real>(*gradient)).lower();
    const auto zero = krawczyk<4>(equations_, {p[0].lower(), p[1].lower(), p[2].lower(), multiplier});
    if (!zero) return std::nullopt;
    const PreciseVector point = three_of(*zero);
    const std::optional<PreciseVector> normal = gradient_over(point);
    if (!normal) return std::nullopt;
    return LocalAnswer{-(*zero)[3] * length<Real>(*normal), point, unit(*normal)};
  }

  /// Returns whether q has no nearest point but that of `zero`; the depth is known to lie in `depth`.
  [[nodiscard]] bool only(const LocalAnswer& zero, const PreciseInterval& depth) const {
    if (alone_in(about_q(depth), zero, depth)) return true;
    const std::optional<PreciseVector> region = region_of(zero, depth);
    if (!region) return false;
    PreciseVector q = q_;
    PreciseVector box = *region;
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == 2 && bounds_.is_tapered()) continue;
      const bool in_plane = q[k].lower() == Real(0) && q[k].upper() == Real(0);
      if (in_plane || q[k].lower() > Real(0)) continue;
      if (!(q[k].upper() < Real(0))) return false;  // on which side q lies is not known
      q[k] = -q[k];
      box[k] = -box[k];
    }
    return nearest_points_lie_in(solid_, bounds_, q, depth, box);
  }

  /// Returns whether the region contains the point of `zero`, and no other point that is stationary at such a depth.
  [[nodiscard]] bool alone_in(const PreciseVector& region, const LocalAnswer& zero,
                              const PreciseInterval& depth) const {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!subset(zero.point[k], region[k])) return false;
    }
    const std::optional<PreciseVector> gradient = gradient_over(region);
    if (!gradient) return false;
    const PreciseInterval multiplier = depth / length<Real>(*gradient);
    const PreciseInterval own = -zero.distance / length<Real>(*gradient_over(zero.point));
    return contains_at_most_one_zero<4>(equations_, unknowns(zero.point, own), unknowns(region, multiplier));
  }

  /// The largest cube of some about the stationary point where it is alone.
  [[nodiscard]] std::optional<PreciseVector> region_of(const LocalAnswer& zero, const PreciseInterval& depth) const {
    constexpr int sizes = 12;
    Real half = depth.upper();
    for (int i = 0; i < sizes; ++i) {
      const PreciseVector cube = inflated(zero.point, half);
      if (alone_in(cube, zero, depth)) return cube;
      half = multiply(half, Real(0.5), Direction::up);
    }
    return std::nullopt;
  }

  const Superquadric& solid_;
  const SuperquadricBounds<Real>& bounds_;
  const PreciseVector& q_;
  Real size_;
  ProjectionEquations equations_;
  NormFunction<long double> near_gauge_;  ///< for proposals
};

ClosestSurfacePoint in_model(const RigidMotion& motion, const LocalAnswer& answer, bool unique) {
  const PreciseVector normal = motion.rotation * answer.normal;
  return {answer.distance, motion(answer.point), intersection(normal, any_unit_vector(), what_of_normals), unique};
}

/// The width, in parts of the largest semi-axis, to which the depth is enclosed before a nearest point is searched for.
constexpr double kDepthTolerance = 0x1p-10;

/// For any q. Proves nothing but the distance.
ClosestSurfacePoint within_distance(const PosedSuperquadric& solid, const Projection& projection,
                                    const PreciseInterval& distance) {
  return in_model(solid.motion(), projection.anywhere(distance), false);
}

ClosestSurfacePoint inside_point(const PosedSuperquadric& solid, const Projection& projection, const PreciseVector& q) {
  const Superquadric& superquadric = solid.superquadric();
  const double tolerance = kDepthTolerance * std::ranges::max(superquadric.semi_axes);
  const PrimitiveDistance found = interior_distance(superquadric, solid.bounds(), q, tolerance);
  if (const std::optional<LocalAnswer> inside = projection.inside(found))
    return in_model(solid.motion(), *inside, true);
  return within_distance(solid, projection, PreciseInterval(Real(found.distance.lo), Real(found.distance.hi)));
}

/// The signed distance of any q by single evaluations: tight on the surface alone.
PreciseInterval distance_by_contact(const PosedSuperquadric& solid, const PreciseVector& q) {
  const Contact contact = fast_contact(solid.superquadric(), midpoint(q));
  return {Real(lower_bound(solid.bounds(), q, contact.normal)), Real(upper_bound(solid.bounds(), q, contact.point))};
}

}  // namespace

ClosestSurfacePoint closest_surface_point(const PosedSuperquadric& solid, const Point& x) {
  const PreciseVector q = solid.motion().local_point(x);
  const Projection projection(solid, q);
  try {
    if (const auto outside = projection.outside()) return in_model(solid.motion(), *outside, true);
    if (solid.bounds().gauge(q).upper() < Real(1)) return inside_point(solid, projection, q);
    // q lies on the surface but for rounding, or outside by less than can be proven.
    const auto beside = projection.beside_surface(distance_by_contact(solid, q));
    if (beside) return in_model(solid.motion(), *beside, true);
  } catch (const std::domain_error&) {
    // Lengths that no interval divides by: q is hardly off the surface.
  }
  return within_distance(solid, projection, distance_by_contact(solid, q));
}

namespace {

template <class Float>
Contact solve(const Superquadric& solid, const Proposal& q, const logarithmic::Resolution& resolution) {
  Contact contact = is_tapered(solid) ? logarithmic::TaperedContactProblem<Float>(solid, q, resolution).solve()
                                      : logarithmic::ContactProblem<Float>(solid, q, resolution).solve();
  // Lengths hundreds of decades apart exceed even logarithms; the ray from the centre is never useless.
  if (!usable(contact.point)) contact.point = q;
  if (!usable(contact.normal)) contact.normal = q;
  return contact;
}

}  // namespace

Contact rough_contact(const Superquadric& solid, const Proposal& q) {
  return solve<double>(solid, q, logarithmic::kResolution<double>);
}

Contact fast_contact(const Superquadric& solid, const Proposal& q) {
  return solve<long double>(solid, q, logarithmic::kResolution<long double>);
}

Contact thorough_contact(const Superquadric& solid, const Proposal& q) {
  release_mpfr_cache_at_thread_exit();
  return solve<FiftyDigits>(solid, q, {.surface = 1e-40, .step = 1e-25, .below_two = 0.0, .above_zero = 1e-18});
}

}  // namespace verisq::verify

namespace verisq {

ClosestPoint closest_point_within(const Enclosure& distance, const Point& x) {
  using verify::Direction;
  const double farthest = std::max(std::fabs(distance.lo), std::fabs(distance.hi));
  ClosestPoint result{distance, {}, {}, std::nullopt, false};
  for (std::size_t k = 0; k < 3; ++k) {
    result.point[k] = {verify::subtract(x[k], farthest, Direction::down), verify::add(x[k], farthest, Direction::up)};
    result.normal[k] = {-1.0, 1.0};
  }
  return result;
}

std::array<Enclosure, 6> gradient_by_motion(const ClosestPoint& closest, const Point& x, const Point& centre) {
  using verify::PreciseInterval;
  const auto component = [&](std::size_t k) {
    return PreciseInterval(verify::Real(closest.normal[k].lo), verify::Real(closest.normal[k].hi));
  };
  const verify::PreciseVector n{component(0), component(1), component(2)};
  const verify::PreciseVector arm = verify::precise(x) - verify::precise(centre);
  const verify::PreciseVector moment{arm[1] * n[2] - arm[2] * n[1], arm[2] * n[0] - arm[0] * n[2],
                                     arm[0] * n[1] - arm[1] * n[0]};
  const auto turning = verify::rounded_outward(moment);
  return {closest.normal[0], closest.normal[1], closest.normal[2], turning[0], turning[1], turning[2]};
}

}  // namespace verisq
