/// Affine enclosures of a primitive's own coordinates over cubes, and the bounds that the convex gauge proves by them.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/closed_mesh.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/bend.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

// Nothing below throws: no interval here has +infinity as its lower or -infinity as its upper end. The input is finite,
// and rounding down never overflows to +infinity, nor rounding up to -infinity. Then sums, products, roots and
// quotients by intervals without 0 have the same property and never are NaN.

namespace {

constexpr HalfSpace kNothing{{0.0, 0.0, 0.0}, infinity};

BasicInterval<double> in_precision(const PreciseInterval& a, double /*of the ends*/) {
  return in_binary64(a);
}

PreciseInterval in_precision(const PreciseInterval& a, const Real& /*of the ends*/) {
  return a;
}

/// The frame of a primitive, seen from the model's.
template <class T>
class OwnFrame {
 public:
  explicit OwnFrame(const Primitive& primitive) {
    const RigidMotion motion(primitive.pose);
    for (int i = 0; i < 3; ++i) {
      translation_[i] = T(primitive.pose.translation[i]);
      for (int j = 0; j < 3; ++j) rotation_(i, j) = in_precision(motion.rotation(j, i), T());
    }
    if (primitive.bend) bend_.emplace(*primitive.bend);
    if (is_tapered(primitive.superquadric)) from_focus_.emplace(in_precision(-focus(primitive.superquadric)[2], T()));
  }

  [[nodiscard]] const Matrix3<T>& rotation() const { return rotation_; }  ///< model to own frame
  [[nodiscard]] const std::optional<BendMap<T>>& bend() const { return bend_; }

  [[nodiscard]] Vector3<T> from_centre(const Point& x) const {
    return {BasicInterval<T>(T(x[0])) - translation_[0], BasicInterval<T>(T(x[1])) - translation_[1],
            BasicInterval<T>(T(x[2])) - translation_[2]};
  }

  /// Unbent coordinates, about the focus, of a box in the bent frame. Without a taper the sign of z is lost at the cut,
  /// and the gauge does not depend on it.
  [[nodiscard]] Vector3<T> unbent(const Vector3<T>& bent) const {
    if (!bend_) return about_focus(bent);
    return from_focus_ ? about_focus(bend_->unbent(bent)) : bend_->unbent_up_to_sign(bent);
  }

  [[nodiscard]] Vector3<T> about_focus(Vector3<T> unbent) const {
    if (from_focus_) unbent[2] += *from_focus_;
    return unbent;
  }

 private:
  Matrix3<T> rotation_;
  Vector3<T> translation_;
  std::optional<BendMap<T>> bend_;
  std::optional<BasicInterval<T>> from_focus_;  ///< vector to the centre, along z, if there is a taper
};

/// The radius of a ball about the centre that contains the primitive. The ball reaches as far along x and y as the
/// support function gives. A bend keeps the length of the axis and the distances from it, so that the solid stays in
/// the ball of radius a3 + |(a1, a2)|.
double bounding_radius(const Primitive& primitive) {
  const SuperquadricBounds<double> bounds(primitive.superquadric);
  const Interval across =
      sqrt(square(Interval(bounds.support_up({1, 0, 0}))) + square(Interval(bounds.support_up({0, 1, 0}))));
  const Interval along(primitive.superquadric.semi_axes[2]);
  return (primitive.bend ? across + along : sqrt(square(across) + square(along))).upper();
}

/// The largest length that rows 0 and 2 of `turned` give to a vector with |e|_inf <= 1: convex, hence at a corner.
double reach_in_plane(const Matrix3<double>& turned) {
  double reach = 0.0;
  for (const int sign_y : {-1, 1}) {
    for (const int sign_z : {-1, 1}) {  // the other corners are opposite to these
      const auto component = [&](int row) {
        return turned(row, 0) + Interval(sign_y) * turned(row, 1) + Interval(sign_z) * turned(row, 2);
      };
      reach = std::max(reach, sqrt(square(component(0)) + square(component(2))).upper());
    }
  }
  return reach;
}

double reach_of_unit_cube(const OwnFrame<double>& own_frame) {
  if (!own_frame.bend()) return 0.0;
  const auto turned_column = [&](std::size_t j) { return own_frame.bend()->turned(own_frame.rotation().column(j)); };
  return reach_in_plane(Matrix3<double>(turned_column(0), turned_column(1), turned_column(2)).transpose());
}

/// y(c + e) = centre + derivative e + remainder for |e|_inf <= h, with |v . remainder| bounded for every v.
struct AffineMap {
  Vector3<double> centre;
  Matrix3<double> derivative;
  Vector3<double> direction;  // of the bend
  double radial = 0.0, axial = 0.0;

  [[nodiscard]] Interval remainder(const Vector3<double>& v) const {
    const Interval along = v[0] * direction[0] + v[1] * direction[1];
    return abs(along) * Interval(radial) + abs(v[2]) * Interval(axial);
  }
};

double sum_of_magnitudes(const Interval& a, const Interval& b, const Interval& c) {
  return (abs(a) + abs(b) + abs(c)).upper();
}

/// The box of all images.
Vector3<double> range(const AffineMap& map, double half_width) {
  Vector3<double> result;
  for (int i = 0; i < 3; ++i) {
    const Interval linear(sum_of_magnitudes(map.derivative(i, 0), map.derivative(i, 1), map.derivative(i, 2)));
    const Interval remainder = i == 2 ? Interval(map.axial) : abs(map.direction[i]) * Interval(map.radial);
    const double half = (linear * Interval(half_width) + remainder).upper();
    result[i] = map.centre[i] + Interval(-half, half);
  }
  return result;
}

Point midpoint(const Vector3<double>& box) {
  const auto middle = [](const Interval& a) { return 0.5 * a.lower() + 0.5 * a.upper(); };
  return {middle(box[0]), middle(box[1]), middle(box[2])};
}

Vector3<double> exact(const Point& x) {
  return {Interval(x[0]), Interval(x[1]), Interval(x[2])};
}

Interval scalar_product(const Vector3<double>& a, const Vector3<double>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// {n . e <= offset} with n = derivative^T v rounded: contains every |e|_inf <= h with v . (y(c + e) - centre) <=
/// bound.
HalfSpace pulled_back(const AffineMap& map, const Point& direction, double bound, double half_width) {
  const Vector3<double> v = exact(direction);
  const Vector3<double> image = map.derivative.transpose() * v;
  const Point normal = midpoint(image);
  if (!is_finite(normal)) return kNothing;
  const Vector3<double> error = image - exact(normal);
  const Interval slack = Interval(sum_of_magnitudes(error[0], error[1], error[2])) * Interval(half_width);
  return {normal, (Interval(bound) + slack + map.remainder(v)).upper()};
}

/// The least of a tapered solid's gauge over boxes of any size. With r the norm of the section, (1 - k²) g = f(z) =
/// N(r, z) - k z/a3, which is convex. It is nowhere less than (1 - |k|^q)^(1/q) r, by Hölder's inequality for the
/// conjugate exponent q.
class TaperedGauge {
 public:
  explicit TaperedGauge(const Superquadric& solid) {
    if (!is_tapered(solid)) return;
    const PreciseInterval k = TaperNumbers<Real>(solid.taper).k;
    const double e1 = solid.exponents[0];
    if (e1 == 2.0) return;  // q is infinite
    const PreciseInterval conjugate = PreciseInterval(2) / (PreciseInterval(2) - PreciseInterval(Real(e1)));
    const PreciseInterval power = pow(abs(k), conjugate);
    least_ = in_precision(pow(PreciseInterval(1) - power, PreciseInterval(1) / conjugate), 0.0);
    const double ratio = in_precision(power / (PreciseInterval(1) - power), 0.0).lower();
    turn_ = std::copysign(solid.semi_axes[2] * std::pow(ratio, 0.5 * e1), solid.taper - 1.0);
  }

  [[nodiscard]] double least(const SuperquadricBounds<double>& bounds, const Vector3<double>& box) const {
    const double thin = bounds.gauge_down(box);
    const auto [lo, hi] = std::pair(box[2].lower(), box[2].upper());
    if (lo == hi) return thin;
    const Interval section = bounds.section(abs(box[0]).lower(), abs(box[1]).lower(), Direction::down);
    const double least = std::max(thin, (section * least_ / bounds.taper().fall).lower());
    const double turn = section.lower() * turn_;
    if (turn >= lo && turn <= hi) return least;
    // If f at a height beyond the nearer end is not more than at that end, f does not fall from there on.
    const double end = turn < lo ? lo : hi;
    const auto at = [&](double z) { return bounds.gauge({abs(box[0]).lower(), abs(box[1]).lower(), z}); };
    const double at_end = at(end).lower();
    return at(turn).upper() <= at_end ? std::max(least, at_end) : least;
  }

 private:
  Interval least_{1};
  double turn_ = 0.0;  ///< height where f is least, of the section of norm 1
};

/// Returns whether no |e|_inf <= h lies in the half-space.
bool misses_cube(const HalfSpace& half_space, double half_width) {
  const auto& n = half_space.normal;
  const Interval reach = Interval(sum_of_magnitudes(Interval(n[0]), Interval(n[1]), Interval(n[2])));
  return (Interval(half_space.offset) + reach * Interval(half_width)).upper() < 0.0;
}

}  // namespace

struct BoxPrimitive::State {
  explicit State(const Primitive& primitive)
      : own_frame(primitive),
        precise_own_frame(primitive),
        bounds(primitive.superquadric),
        precise_bounds(primitive.superquadric),
        tapered_gauge(primitive.superquadric),
        boundary(primitive.superquadric),
        semi_axes(primitive.superquadric.semi_axes),
        radius(bounding_radius(primitive)),
        reach(reach_of_unit_cube(own_frame)),
        keeps_axes(primitive.pose.quaternion[1] == 0.0 && primitive.pose.quaternion[2] == 0.0 &&
                   primitive.pose.quaternion[3] == 0.0 && !primitive.bend) {}

  [[nodiscard]] bool sphere_misses(const Vector3<double>& from_centre, double half_width) const;
  [[nodiscard]] std::optional<AffineMap> affine(const Vector3<double>& own, double half_width) const;
  [[nodiscard]] Vector3<double> natural_range(const Vector3<double>& own, double half_width) const;

  [[nodiscard]] Colour box_colour(const Vector3<double>& box) const;
  [[nodiscard]] Colour precise_colour(const Point& x) const;
  [[nodiscard]] bool half_space_misses(const AffineMap& map, double half_width) const;

  [[nodiscard]] std::optional<Point> gradient(const Point& x) const;
  [[nodiscard]] double excess_over_tangent(const AffineMap& map, const Vector3<double>& box,
                                           const Point& tangent) const;
  [[nodiscard]] HalfSpace inside(const AffineMap& map, double half_width) const;
  [[nodiscard]] HalfSpace outside(const AffineMap& map, double half_width) const;

  OwnFrame<double> own_frame;
  OwnFrame<Real> precise_own_frame;
  SuperquadricBounds<double> bounds;
  SuperquadricBounds<Real> precise_bounds;
  TaperedGauge tapered_gauge;
  Boundary<double> boundary;
  Point semi_axes;
  double radius;
  double reach;     // in the plane of the bend, of the cube of half-width 1
  bool keeps_axes;  // the boxes of own coordinates are the cubes themselves
};

bool BoxPrimitive::State::sphere_misses(const Vector3<double>& from_centre, double half_width) const {
  const Interval half_diagonal = sqrt(Interval(3)) * Interval(half_width);
  return length<double>(from_centre).lower() > (Interval(radius) + half_diagonal).upper();
}

std::optional<AffineMap> BoxPrimitive::State::affine(const Vector3<double>& own, double half_width) const {
  if (!own_frame.bend()) return AffineMap{own_frame.about_focus(own), own_frame.rotation(), Vector3<double>()};
  const double step = (Interval(reach) * Interval(half_width)).upper();
  const auto expansion = own_frame.bend()->expansion(own, step);
  if (!expansion) return std::nullopt;
  return AffineMap{own_frame.about_focus(expansion->centre), expansion->derivative * own_frame.rotation(),
                   own_frame.bend()->direction(), expansion->radial, expansion->axial};
}

Vector3<double> BoxPrimitive::State::natural_range(const Vector3<double>& own, double half_width) const {
  const AffineMap posed{own, own_frame.rotation(), Vector3<double>()};
  return own_frame.unbent(range(posed, half_width));
}

/// Cheap bounds first: max <= g <= sum of the |coordinates| / semi-axes. A gauge in plain floating point then decides
/// which of the two proofs is worth its powers.
Colour BoxPrimitive::State::box_colour(const Vector3<double>& box) const {
  constexpr double doubt = 1e-9;
  if (bounds.is_tapered()) {
    if (tapered_gauge.least(bounds, box) > 1.0) return Colour::white;
    return bounds.gauge_up(box) < 1.0 ? Colour::black : Colour::gray;
  }
  const Point nearest = magnitudes<double>(box, Direction::down);
  const Point farthest = magnitudes<double>(box, Direction::up);
  double sum = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (nearest[i] > semi_axes[i]) return Colour::white;
    const double ratio = divide(farthest[i], semi_axes[i], Direction::up);
    sum = add(sum, ratio, Direction::up);
    largest = std::max(largest, ratio);
  }
  if (sum < 1.0) return Colour::black;
  if (boundary.gauge(nearest) > 1.0 - doubt && bounds.norm(nearest, Direction::down) > 1.0) return Colour::white;
  const bool hopeful = largest < 1.0 + doubt && boundary.gauge(farthest) < 1.0 + doubt;
  return hopeful && bounds.norm(farthest, Direction::up) < 1.0 ? Colour::black : Colour::gray;
}

/// For points whose colour binary64 cannot prove because of its rounding errors.
Colour BoxPrimitive::State::precise_colour(const Point& x) const {
  const PreciseVector own = precise_own_frame.rotation() * precise_own_frame.from_centre(x);
  const PreciseInterval gauge = precise_bounds.gauge(precise_own_frame.unbent(own));
  if (gauge.lower() > Real(1)) return Colour::white;
  return gauge.upper() < Real(1) ? Colour::black : Colour::gray;
}

/// The gradient of g in plain floating point, where it is usable.
std::optional<Point> BoxPrimitive::State::gradient(const Point& x) const {
  const Point folded{std::fabs(x[0]), std::fabs(x[1]), bounds.is_tapered() ? x[2] : std::fabs(x[2])};
  Point result = boundary.normal(folded);
  // Euler: g is homogeneous of degree 1.
  const double scale = boundary.gauge(folded) / (result[0] * folded[0] + result[1] * folded[1] + result[2] * folded[2]);
  for (std::size_t i = 0; i < 3; ++i) result[i] = folded[i] == x[i] ? result[i] * scale : -(result[i] * scale);
  if (!is_finite(result)) return std::nullopt;
  return result;
}

HalfSpace BoxPrimitive::State::inside(const AffineMap& map, double half_width) const {
  const auto v = gradient(midpoint(map.centre));
  if (!v) return kNothing;
  const double support = bounds.support_up(exact(*v));
  if (!std::isfinite(support)) return kNothing;
  const double bound = (Interval(support) - scalar_product(exact(*v), map.centre)).upper();
  return pulled_back(map, *v, bound, half_width);
}

/// A bound of g(y) - 1 - w . (y - centre) over the box: g minus a linear function is convex, largest at a corner.
double BoxPrimitive::State::excess_over_tangent(const AffineMap& map, const Vector3<double>& box,
                                                const Point& tangent) const {
  const auto end = [&box](int axis, int side) { return side == 0 ? box[axis].lower() : box[axis].upper(); };
  double largest = -infinity;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const double section = bounds.section(std::fabs(end(0, i)), std::fabs(end(1, j)), Direction::up);
      for (int l = 0; l < 2; ++l) {
        const Point corner{end(0, i), end(1, j), end(2, l)};
        const double gauge = bounds.is_tapered() ? bounds.gauge_up(exact(corner))
                                                 : bounds.norm(section, std::fabs(end(2, l)), Direction::up);
        if (!is_finite(corner) || !std::isfinite(gauge)) return infinity;
        const Interval linear = scalar_product(exact(tangent), Vector3<double>(exact(corner) - map.centre));
        largest = std::max(largest, (Interval(gauge) - Interval(1) - linear).upper());
      }
    }
  }
  return largest;
}

/// Outside of the interior, 1 <= g(y) <= 1 + m + w . (y - centre).
HalfSpace BoxPrimitive::State::outside(const AffineMap& map, double half_width) const {
  const auto w = gradient(midpoint(map.centre));
  if (!w) return kNothing;
  const double bound = excess_over_tangent(map, range(map, half_width), *w);
  if (!std::isfinite(bound)) return kNothing;
  return pulled_back(map, {-(*w)[0], -(*w)[1], -(*w)[2]}, bound, half_width);
}

/// Returns whether the half-space of the gradient, whose support is 1 but for rounding, proves that no point of the
/// cube lies in K. Its powers are only computed if the proof is about to succeed.
bool BoxPrimitive::State::half_space_misses(const AffineMap& map, double half_width) const {
  const Point centre = midpoint(map.centre);
  if (!(boundary.gauge({std::fabs(centre[0]), std::fabs(centre[1]), centre[2]}) > 1.0)) return false;
  const auto v = gradient(centre);
  if (!v) return false;
  const double bound = (Interval(1) - scalar_product(exact(*v), map.centre)).upper();
  return misses_cube(pulled_back(map, *v, bound, half_width), half_width) &&
         misses_cube(inside(map, half_width), half_width);
}

BoxPrimitive::BoxPrimitive(const Primitive& primitive)
    : state_(primitive.mesh ? Hidden<State>() : hidden<State>(primitive)),
      mesh_(primitive.mesh ? hidden<PosedMesh>(primitive) : Hidden<PosedMesh>()) {}

Colour BoxPrimitive::colour(const Cube& cube) const {
  if (mesh_) return verify::colour(*mesh_, cube);
  const Vector3<double> from_centre = state_->own_frame.from_centre(cube.centre);
  if (state_->sphere_misses(from_centre, cube.half_width)) return Colour::white;
  const Vector3<double> own = state_->own_frame.rotation() * from_centre;
  if (cube.half_width == 0.0) {
    const Colour found = state_->box_colour(state_->own_frame.unbent(own));
    return found == Colour::gray ? state_->precise_colour(cube.centre) : found;
  }
  const auto map = state_->affine(own, cube.half_width);
  if (!map) return state_->box_colour(state_->natural_range(own, cube.half_width));
  const Colour found = state_->box_colour(range(*map, cube.half_width));
  if (found != Colour::gray || state_->keeps_axes) return found;
  return state_->half_space_misses(*map, cube.half_width) ? Colour::white : Colour::gray;
}

HalfSpace BoxPrimitive::half_space(const Cube& cube, Side side) const {
  if (mesh_) return verify::half_space(*mesh_, cube, side);
  const Vector3<double> own = state_->own_frame.rotation() * state_->own_frame.from_centre(cube.centre);
  const auto map = state_->affine(own, cube.half_width);
  if (!map) return kNothing;
  return side == Side::inside ? state_->inside(*map, cube.half_width) : state_->outside(*map, cube.half_width);
}

}  // namespace verisq::verify
