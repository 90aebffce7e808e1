/// Eqs. (16) to (20) of the paper.
///
/// Why the enclosures are right, whatever GJK says. The box P contains a point p* of the surface, because F takes the
/// value 1 on the bisected segment; p* belongs to the solid, so that sup |P - Q| is an upper bound. The box N contains
/// a (sub)gradient n of F at p*, and F is convex: F(x) >= F(p*) + n·(x - p*), so that the solid {F <= 1} lies in the
/// half-space n·(x - p*) <= 0. Hence n·(q - p*)/|n|, which lies in the interval L, is a lower bound for a point q. For
/// a second solid B, n·y over B is least at the support point r of -n, which lies in the box R: n·(r - p*)/|n| is a
/// lower bound. A distance is not negative: 0 is a lower bound in any case.
#include "verisq/published_method.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include "verify/proof/rigid_motion.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/bisected_enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq {

namespace {

using namespace verify;

constexpr std::string_view method_name = "the published method";

void require_convex(const Primitive& primitive, std::string_view what) {
  if (is_bent(primitive)) throw Error(ErrorKind::input, std::string(what) + ": not supported for bent solids");
  if (is_tapered(primitive.superquadric)) {
    throw Error(ErrorKind::input, std::string(what) + ": not supported for tapered solids");
  }
}

Interval rounded_outward(const PreciseInterval& x) {
  return {x.lower().to_double(Direction::down), x.upper().to_double(Direction::up)};
}

Vector3<double> rounded_outward(const PreciseVector& x) {
  return {rounded_outward(x[0]), rounded_outward(x[1]), rounded_outward(x[2])};
}

Matrix3<double> rounded_outward(const PreciseMatrix& x) {
  return {rounded_outward(x.row(0)), rounded_outward(x.row(1)), rounded_outward(x.row(2))};
}

Coordinates<double> middle(const PreciseVector& x) {
  const Proposal m = midpoint(x);
  return {static_cast<double>(m[0]), static_cast<double>(m[1]), static_cast<double>(m[2])};
}

GjkTolerance<double> stop_at(double accuracy) {
  return {.relative = accuracy};
}

GjkResult<double> closest(const Primitive& solid, const Coordinates<double>& local, double accuracy) {
  return gjk<double>(SuperquadricSet<double>(solid.superquadric), PointSet<double>{local}, local, stop_at(accuracy));
}

/// In the frame of `a`, turned back to the model's axes: translations in common cost no digits.
GjkResult<double> closest(const Primitive& a, const Primitive& b, double accuracy) {
  Primitive first = a;
  Primitive second = b;
  first.pose.translation = {};
  second.pose.translation = difference(b.pose.translation, a.pose.translation);
  return gjk<double>(posed_set<double>(first), posed_set<double>(second), second.pose.translation, stop_at(accuracy));
}

/// The surface near p, first along d as the paper has it; where that line misses the solid (touching, where d is
/// rounding error) along the ray from the centre, which cannot.
Vector3<double> surface_near(const BisectedEnclosure& solid, const Coordinates<double>& p,
                             const Coordinates<double>& d) {
  if (const auto box = solid.surface_point(p, d)) return *box;
  if (const auto box = solid.surface_point(p, p)) return *box;
  return solid.support_point(Vector3<double>(1, 0, 0));
}

/// B's frame seen from A's: x_B = turn x_A + shift.
struct RelativeMotion {
  Matrix3<double> turn;
  Vector3<double> shift;

  RelativeMotion(const RigidMotion& a, const RigidMotion& b)
      : turn(rounded_outward(b.rotation.transpose() * a.rotation)),
        shift(rounded_outward(b.rotation.transpose() * PreciseVector(a.translation - b.translation))) {}

  [[nodiscard]] Vector3<double> point_of_b(const Vector3<double>& x_a) const { return turn * x_a + shift; }
  [[nodiscard]] Vector3<double> direction_of_b(const Vector3<double>& v_a) const { return turn * v_a; }
  [[nodiscard]] Vector3<double> point_of_a(const Vector3<double>& x_b) const {
    return turn.transpose() * Vector3<double>(x_b - shift);
  }
};

}  // namespace

Enclosure published_distance(const Primitive& solid, const Point& point, double accuracy) {
  require_convex(solid, method_name);
  const BisectedEnclosure enclosure(solid.superquadric);
  const PreciseVector local = RigidMotion(solid.pose).local_point(point);
  const Vector3<double> q = rounded_outward(local);
  if (enclosure.bounds().gauge(q).upper() <= 1.0) return {0.0, 0.0};
  const GjkResult<double> found = closest(solid, middle(local), accuracy);
  const Vector3<double> p = surface_near(enclosure, found.on_a, difference(found.on_b, found.on_a));
  const Vector3<double> to = q - p;
  return {plane_distance(enclosure.normal(p), to), length<double>(to).upper()};
}

Enclosure published_distance(const Primitive& a, const Primitive& b, double accuracy) {
  require_convex(a, method_name);
  require_convex(b, method_name);
  const BisectedEnclosure enclosure_a(a.superquadric);
  const BisectedEnclosure enclosure_b(b.superquadric);
  const RelativeMotion relative(RigidMotion(a.pose), RigidMotion(b.pose));
  const GjkResult<double> found = closest(a, b, accuracy);

  const ApproximateMotion<double> of_a({{}, a.pose.quaternion});
  const ApproximateMotion<double> of_b({difference(b.pose.translation, a.pose.translation), b.pose.quaternion});
  const Coordinates<double> p_a = of_a.inverse_point(found.on_a);
  const Coordinates<double> to_b = of_a.inverse_direction(difference(found.on_b, found.on_a));
  const Coordinates<double> to_a = of_b.inverse_direction(difference(found.on_a, found.on_b));
  const Vector3<double> p = surface_near(enclosure_a, p_a, to_b);
  const Vector3<double> q = surface_near(enclosure_b, of_b.inverse_point(found.on_b), to_a);

  const Vector3<double> common(p_a[0], p_a[1], p_a[2]);
  if (found.end == GjkEnd::common && enclosure_a.bounds().gauge(common).upper() <= 1.0 &&
      enclosure_b.bounds().gauge(relative.point_of_b(common)).upper() <= 1.0) {
    return {0.0, 0.0};
  }
  const double hi = length<double>(Vector3<double>(relative.point_of_a(q) - p)).upper();
  const Vector3<double> normal = enclosure_a.normal(p);
  if (!bounded(normal)) return {0.0, hi};
  const Vector3<double> r = enclosure_b.support_point(-relative.direction_of_b(normal));
  return {plane_distance(normal, relative.point_of_a(r) - p), hi};
}

double unverified_distance(const Primitive& solid, const Point& point, double accuracy) {
  require_convex(solid, method_name);
  const GjkResult<double> found = closest(solid, ApproximateMotion<double>(solid.pose).inverse_point(point), accuracy);
  return found.end == GjkEnd::common ? 0.0 : found.upper;
}

double unverified_distance(const Primitive& a, const Primitive& b, double accuracy) {
  require_convex(a, method_name);
  require_convex(b, method_name);
  const GjkResult<double> found = closest(a, b, accuracy);
  return found.end == GjkEnd::common ? 0.0 : found.upper;
}

}  // namespace verisq
