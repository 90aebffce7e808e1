/// Bisection on proven signs; Eqs. (1), (5), (14), (15) over boxes.
#include "verify/search/bisected_enclosure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "verisq/enclosure.hpp"

namespace verisq::verify {

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

/// The same over a box: rises with x, falls with y.
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
/// Where F has an edge or a vertex (p = 1, or S = 0) a coordinate X of the point is 0, and the box holds 0 or an end
/// of the interval of slopes in its place: a subgradient.
Vector3<double> BisectedEnclosure::normal(const Vector3<double>& x) const {
  const Vector3<double> scaled(x[0] / semi_axes_[0], x[1] / semi_axes_[1], x[2] / semi_axes_[2]);
  const Interval p2 = Interval(2) / e2_;
  const Interval k2 = (Interval(2) - e2_) / e2_;
  const Interval k1 = (Interval(2) - e1_) / e1_;
  const Interval section = pow(abs(scaled[0]), p2) + pow(abs(scaled[1]), p2);
  // At S = 0 alone X = Y = 0, where S^(p1/p2) is least.
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

}  // namespace verisq::verify
