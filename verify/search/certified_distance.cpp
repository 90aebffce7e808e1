/// Distances of points with certificates, and by the published method; bounds of a gauge in binary64.
#include "verify/search/certified_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/solids/model.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

WitnessEstimate::WitnessEstimate(const Model& model) {
  for (const Primitive& primitive : model.primitives) {
    const RigidMotion motion = PosedSuperquadric(primitive).motion();
    std::array<Vector, 3> rotation{};
    for (std::size_t i = 0; i < 3; ++i) rotation[i] = midpoint(motion.rotation.column(i));
    const auto& a = primitive.superquadric.semi_axes;
    primitives_.push_back({Boundary<long double>(primitive.superquadric), rotation, midpoint(motion.translation),
                           std::hypot(a[0], a[1], a[2])});
  }
}

long double WitnessEstimate::operator()(const Vector& point, const Normal& normal) const {
  const auto& [boundary, rotation, origin, radius] = primitives_[normal.primitive];
  const Vector d = difference(point, origin);
  Vector q{};
  Vector x{};
  for (std::size_t i = 0; i < 3; ++i) {
    q[i] = dot(rotation[i], d);
    x[i] = q[i] - normal.vector[i];
  }
  const long double gauge = boundary.gauge({std::fabs(x[0]), std::fabs(x[1]), x[2]});
  const Vector apart = along(q, x, gauge > 0.0L ? -1.0L / gauge : 0.0L);
  const long double rounding = 0x1p-56L * (radius + std::sqrt(dot(d, d)));
  return std::sqrt(dot(apart, apart)) + rounding;
}

namespace {

/// Halvings of the last bracket: the segment exceeds the shortest that is provable by this power of two at most.
constexpr int kHalvings = 6;

/// The sign of v on a magnitude.
Interval with_sign(const Interval& magnitude, const Interval& v) {
  if (v.lower() >= 0.0) return magnitude;
  if (v.upper() <= 0.0) return -magnitude;
  return {-magnitude.upper(), magnitude.upper()};
}

/// |x|^k with the sign of x.
Interval signed_power(const Interval& x, const Interval& k) {
  return with_sign(pow(abs(x), k), x);
}

/// x^q / (x^q + y^q) for numbers x, y >= 0 and q = 2/(2 - e): cos^2 ω of Eq. (14). Everything for x = y = 0.
Interval share(double x, double y, const Interval& e) {
  if (x == 0.0 && y == 0.0) return {0.0, 1.0};
  if (y == 0.0) return 1;
  if (x == 0.0) return 0;
  const Interval difference = Interval(2) - e;
  // q = infinity: the larger term takes all; of equal terms every division gives a support point.
  if (difference.lower() == 0.0) return {x > y ? 1.0 : 0.0, x < y ? 0.0 : 1.0};
  const Interval q = Interval(2) / difference;
  if (x < y) {
    const Interval term = pow(Interval(x) / Interval(y), q);
    return term / (Interval(1) + term);
  }
  return Interval(1) / (Interval(1) + pow(Interval(y) / Interval(x), q));
}

/// The share over a box: it rises with x and falls with y.
Interval share(const Interval& x, const Interval& y, const Interval& e) {
  return {share(x.lower(), y.upper(), e).lower(), share(x.upper(), y.lower(), e).upper()};
}

Vector3<double> exact(const Coordinates<double>& x) {
  return {x[0], x[1], x[2]};
}

double largest(const Coordinates<double>& x) {
  return std::max({std::fabs(x[0]), std::fabs(x[1]), std::fabs(x[2])});
}

/// The t of the given sign closest to 0, by doubling and halving, with `proven(t)`.
template <class Proven>
std::optional<double> first_proven(const Proven& proven, double step, double limit) {
  if (proven(0.0)) return 0.0;
  double failed = 0.0;
  double found = step;
  while (!proven(found)) {
    failed = found;
    found *= 2;
    if (!(std::fabs(found) <= limit)) return std::nullopt;
  }
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = failed + (found - failed) / 2;
    (proven(middle) ? found : failed) = middle;
  }
  return found;
}

}  // namespace

BisectedEnclosure::BisectedEnclosure(const Superquadric& superquadric)
    : bounds_(superquadric),
      semi_axes_(superquadric.semi_axes[0], superquadric.semi_axes[1], superquadric.semi_axes[2]),
      e1_(superquadric.exponents[0]),
      e2_(superquadric.exponents[1]),
      reach_(2 * largest(superquadric.semi_axes)) {}

std::optional<Vector3<double>> BisectedEnclosure::surface_point(const Coordinates<double>& p,
                                                                const Coordinates<double>& d) const {
  const double length = largest(d);
  if (!(length > 0.0 && length < infinity)) return std::nullopt;
  const auto line = [&](double t) -> Vector3<double> { return exact(p) + exact(d) * Interval(t); };
  // g <= 1 and F <= 1 are one statement, F being a power of g.
  const auto inside = [&](double t) { return bounds_.gauge(line(t)).upper() <= 1.0; };
  const auto outside = [&](double t) { return bounds_.gauge(line(t)).lower() >= 1.0; };
  const double scale = std::max(largest(p), reach_) / length;
  const double step = std::numeric_limits<double>::epsilon() * std::max(largest(p), reach_ * 1e-3) / length;
  const std::optional<double> t1 = first_proven(inside, -step, 4 * scale);
  if (!t1) return std::nullopt;
  const std::optional<double> t2 = first_proven(outside, step, 4 * scale);
  if (!t2) return std::nullopt;
  // F is continuous: it takes the value 1 on the exact segment, which lies in the hull of boxes about its ends.
  const Vector3<double> a = line(*t1);
  const Vector3<double> b = line(*t2);
  return Vector3<double>(hull(a[0], b[0]), hull(a[1], b[1]), hull(a[2], b[2]));
}

/// With X = x/a1, ..., S = |X|^p2 + |Y|^p2 and p_i = 2/e_i the gradient of F = S^(p1/p2) + |Z|^p1, divided by p1, is
///     ( S^((e2-e1)/e1) X^(p2-1) / a1,  S^((e2-e1)/e1) Y^(p2-1) / a2,  Z^(p1-1) / a3 ).
/// If F has an edge or a vertex (p = 1, or S = 0), a coordinate X of the point is 0, and the box contains 0 or an end
/// of the interval of slopes in its place: a subgradient.
Vector3<double> BisectedEnclosure::normal(const Vector3<double>& x) const {
  const Vector3<double> scaled(x[0] / semi_axes_[0], x[1] / semi_axes_[1], x[2] / semi_axes_[2]);
  const Interval p2 = Interval(2) / e2_;
  const Interval k2 = (Interval(2) - e2_) / e2_;
  const Interval k1 = (Interval(2) - e1_) / e1_;
  const Interval section = pow(abs(scaled[0]), p2) + pow(abs(scaled[1]), p2);
  // At S = 0 only X = Y = 0 is possible, where S^(p1/p2) is least.
  const Interval outer = section.upper() == 0.0 ? Interval(0) : pow(section, (e2_ - e1_) / e1_);
  return {outer * signed_power(scaled[0], k2) / semi_axes_[0], outer * signed_power(scaled[1], k2) / semi_axes_[1],
          signed_power(scaled[2], k1) / semi_axes_[2]};
}

Vector3<double> BisectedEnclosure::support_point(const Vector3<double>& v) const {
  const Interval x = abs(v[0] * semi_axes_[0]);
  const Interval y = abs(v[1] * semi_axes_[1]);
  const Interval z = abs(v[2] * semi_axes_[2]);
  const Interval r = bounds_.support(Vector3<double>(v[0], v[1], Interval(0)));  // ‖(x, y)‖ with exponent 2/(2 - e2)
  const Interval cos_eta = pow(share(r, z, e1_), e1_ / Interval(2));
  const Interval sin_eta = pow(share(z, r, e1_), e1_ / Interval(2));
  const Interval cos_omega = pow(share(x, y, e2_), e2_ / Interval(2));
  const Interval sin_omega = pow(share(y, x, e2_), e2_ / Interval(2));
  return {with_sign(semi_axes_[0] * cos_eta * cos_omega, v[0]), with_sign(semi_axes_[1] * cos_eta * sin_omega, v[1]),
          with_sign(semi_axes_[2] * sin_eta, v[2])};
}

bool bounded(const Vector3<double>& v) {
  const auto finite = [](const Interval& x) { return x.lower() > -infinity && x.upper() < infinity; };
  return finite(v[0]) && finite(v[1]) && finite(v[2]);
}

double plane_distance(const Vector3<double>& normal, const Vector3<double>& to) {
  if (!bounded(normal)) return 0.0;
  const double product = normal.dot(to).lower();
  if (!(product > 0.0)) return 0.0;
  return divide(product, length<double>(normal).upper(), Direction::down);
}

double bound_of_power(double base, double exponent, Direction direction) {
  return fast_power(base, exponent, direction);
}

template class SuperquadricBounds<double>;

}  // namespace verisq::verify

namespace verisq {

namespace {

using namespace verify;

constexpr std::string_view method_name = "the published method";

void require_convex(const Primitive& primitive, std::string_view what) {
  require_valid(Model{"", {primitive}});
  if (is_bent(primitive)) throw Error(ErrorKind::input, std::string(what) + ": not supported for bent solids");
  if (is_tapered(primitive.superquadric)) {
    throw Error(ErrorKind::input, std::string(what) + ": not supported for tapered solids");
  }
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

/// The closest points in the frame of `a`, turned back to the model's axes: translations in common cost no digits.
GjkResult<double> closest(const Primitive& a, const Primitive& b, double accuracy) {
  Primitive first = a;
  Primitive second = b;
  first.pose.translation = {};
  second.pose.translation = difference(b.pose.translation, a.pose.translation);
  return gjk<double>(posed_set<double>(first), posed_set<double>(second), second.pose.translation, stop_at(accuracy));
}

/// The surface near p, first along d as in the paper. If that line misses the solid (touching, where d is rounding
/// error), the search runs along the ray from the centre, which cannot miss it.
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
      : turn(in_binary64(b.rotation.transpose() * a.rotation)),
        shift(in_binary64(b.rotation.transpose() * PreciseVector(a.translation - b.translation))) {}

  [[nodiscard]] Vector3<double> point_of_b(const Vector3<double>& x_a) const { return turn * x_a + shift; }
  [[nodiscard]] Vector3<double> direction_of_b(const Vector3<double>& v_a) const { return turn * v_a; }
  [[nodiscard]] Vector3<double> point_of_a(const Vector3<double>& x_b) const {
    return turn.transpose() * Vector3<double>(x_b - shift);
  }
};

}  // namespace

Enclosure published_distance(const Primitive& solid, const Point& point, double accuracy) {
  require_convex(solid, method_name);
  require_finite(point, "point");
  const BisectedEnclosure enclosure(solid.superquadric);
  const PreciseVector local = RigidMotion(solid.pose).local_point(point);
  const Vector3<double> q = in_binary64(local);
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
  require_finite(point, "point");
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
