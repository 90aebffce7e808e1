/// This file implements support_mapping.hpp.
#include "verify/proposals/support_mapping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "verify/proposals/multipliers.hpp"
#include "verify/solids/superquadric.hpp"

namespace verisq::verify {

namespace {

template <class Float>
Float norm_of_two(Float x, Float y, Float p) {
  const Float large = std::max(x, y);
  if (large == 0) return 0;
  return large * std::pow(1 + std::pow(std::min(x, y) / large, p), 1 / p);
}

}  // namespace

// Beyond p = 2e12 binary64 cannot distinguish the norm of equal coordinates from their maximum, nor one normal from
// two.
template <class Float>
Boundary<Float>::Boundary(const Superquadric& solid)
    : semi_axes_{solid.semi_axes[0], solid.semi_axes[1], solid.semi_axes[2]},
      p1_(2 / std::max<Float>(solid.exponents[0], 1e-12)),
      p2_(2 / std::max<Float>(solid.exponents[1], 1e-12)),
      k_(taper_coefficient<Float>(solid.taper)),
      fall_(1 - k_ * k_) {}

template <class Float>
Float Boundary<Float>::section(const Vector& x) const {
  return norm_of_two<Float>(x[0] / semi_axes_[0], x[1] / semi_axes_[1], p2_);
}

template <class Float>
Float Boundary<Float>::norm(const Vector& x) const {
  return norm_of_two<Float>(section(x), std::fabs(x[2]) / semi_axes_[2], p1_);
}

template <class Float>
Float Boundary<Float>::gauge(const Vector& x) const {
  return (norm(x) - k_ * x[2] / semi_axes_[2]) / fall_;
}

template <class Float>
typename Boundary<Float>::Vector Boundary<Float>::gradient(const Vector& x) const {
  const Float r = section(x);
  const Float norm = this->norm(x);
  const auto share = [](Float part, Float whole, Float exponent) {
    return std::pow(whole > 0 ? part / whole : 0, exponent);
  };
  const Float outer = share(r, norm, p1_ - 1) / fall_;
  const Float along = std::copysign(share(std::fabs(x[2]) / semi_axes_[2], norm, p1_ - 1), x[2]);
  return {outer * share(x[0] / semi_axes_[0], r, p2_ - 1) / semi_axes_[0],
          outer * share(x[1] / semi_axes_[1], r, p2_ - 1) / semi_axes_[1], (along - k_) / (fall_ * semi_axes_[2])};
}

template <class Float>
typename Boundary<Float>::Vector Boundary<Float>::normal(const Vector& x) const {
  Vector n = gradient(x);
  const Float length = std::hypot(n[0], n[1], n[2]);
  for (Float& c : n) c /= length;
  return n;
}

template <class Float>
Float Boundary<Float>::exit(const Vector& q, const Vector& w, Float level) const {
  // g is convex along the ray. In the octant g(q + s w) >= s g(w), anywhere g(q + s w) >= s g(w) - g(-q): Newton's
  // method descends monotonically from this start.
  constexpr Float finest_step = 5 * std::numeric_limits<Float>::epsilon();
  const Float before = k_ == 0 ? 0 : gauge({q[0], q[1], -q[2]});
  Float s = (level + before) / gauge(w);
  for (int i = 0; i < 60; ++i) {
    const Vector x{q[0] + s * w[0], q[1] + s * w[1], q[2] + s * w[2]};
    const Float g = gauge(x);
    const Vector n = gradient(x);
    const Float step = (g - level) / (n[0] * w[0] + n[1] * w[1] + n[2] * w[2]);
    if (!(step > finest_step * s)) break;
    s -= step;
  }
  return std::max<Float>(s, 0);
}

template class Boundary<double>;
template class Boundary<long double>;

namespace {

/// The dual norm of (x, y) and (cos φ)^e, (sin φ)^e of the angle with tan^2 φ = (y/x)^q, q = 2/(2 - e).
template <class Float>
struct DualNorm {
  Float value;
  std::array<Float, 2> support;  ///< cos^e φ and sin^e φ: the point of the unit ball at which the norm is attained
};

template <class Float>
Float dual_exponent_of(Float e) {
  return e == 2 ? std::numeric_limits<Float>::infinity() : 2 / (2 - e);
}

/// For nonnegative x, y; both shares are 0 for x = y = 0.
template <class Float>
DualNorm<Float> dual_norm(Float x, Float y, Float e) {
  const Float large = std::max(x, y);
  const Float small = std::min(x, y);
  if (small == 0) return {large, {x > 0 ? Float(1) : Float(0), y > 0 ? Float(1) : Float(0)}};
  // e = 2 has q = infinity: the power is 0 or, of equal terms, 1, which is the middle of an edge.
  const Float q = dual_exponent_of(e);
  const Float term = std::pow(small / large, q);
  const Float log_sum = std::log1p(term);
  // (cos^2)^(e/2), the cosine's share being 1/(1 + term) or term/(1 + term); term^(e/2) = (small/large)^(q - 1).
  const Float of_large = std::exp(-log_sum * e / 2);
  const Float of_small = of_large * (e == 2 ? term : std::pow(small / large, e / (2 - e)));
  const Float value = large * std::exp(log_sum * (2 - e) / 2);
  if (x < y) return {value, {of_small, of_large}};
  return {value, {of_large, of_small}};
}

template <class Float>
Coordinates<Float> converted(const Point& x) {
  return {Float(x[0]), Float(x[1]), Float(x[2])};
}

}  // namespace

template <class Float>
SuperquadricSet<Float>::SuperquadricSet(const Superquadric& superquadric)
    : semi_axes_(converted<Float>(superquadric.semi_axes)),
      exponents_{Float(superquadric.exponents[0]), Float(superquadric.exponents[1])},
      k_(taper_coefficient<Float>(superquadric.taper)) {}

template <class Float>
Coordinates<Float> SuperquadricSet<Float>::operator()(const Coordinates<Float>& v) const {
  return k_ == 0 ? untapered(v) : tapered(v);
}

// At the root τ of ‖(r, a3 v_z + k τ)‖ = τ: N's support point u along v + (0, 0, k τ / a3), made longer or shorter
// until it lies on the surface.
template <class Float>
Coordinates<Float> SuperquadricSet<Float>::tapered(const Coordinates<Float>& v) const {
  const Float section =
      dual_norm(semi_axes_[0] * std::fabs(v[0]), semi_axes_[1] * std::fabs(v[1]), exponents_[1]).value;
  const Float z = semi_axes_[2] * v[2];
  const Float root = near_root_of_support(section, z, k_, dual_exponent_of(exponents_[0]));
  const Coordinates<Float> u = untapered({v[0], v[1], v[2] + k_ * root / semi_axes_[2]});
  const Float scale = (1 - k_ * k_) / (1 - k_ * u[2] / semi_axes_[2]);
  return {scale * u[0], scale * u[1], scale * u[2]};
}

template <class Float>
Coordinates<Float> SuperquadricSet<Float>::untapered(const Coordinates<Float>& v) const {
  const auto term = [&](std::size_t i) { return semi_axes_[i] * std::fabs(v[i]); };
  const DualNorm<Float> section = dual_norm(term(0), term(1), exponents_[1]);
  const DualNorm<Float> whole = dual_norm(section.value, term(2), exponents_[0]);
  return {std::copysign(semi_axes_[0] * section.support[0] * whole.support[0], v[0]),
          std::copysign(semi_axes_[1] * section.support[1] * whole.support[0], v[1]),
          std::copysign(semi_axes_[2] * whole.support[1], v[2])};
}

template class SuperquadricSet<double>;
template class SuperquadricSet<long double>;

/// The rotation of the quaternion divided by its length. The components are scaled first: their squares may overflow.
template <class Float>
ApproximateMotion<Float>::ApproximateMotion(const Pose& pose) : translation_(converted<Float>(pose.translation)) {
  const auto& quaternion = pose.quaternion;
  Float largest = 0;
  for (const double component : quaternion) largest = std::max(largest, std::fabs(Float(component)));
  const Float w = Float(quaternion[0]) / largest;
  const Float x = Float(quaternion[1]) / largest;
  const Float y = Float(quaternion[2]) / largest;
  const Float z = Float(quaternion[3]) / largest;
  const Float s = 2 / (w * w + x * x + y * y + z * z);
  rows_ = {{{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
            {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
            {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}}};
}

template <class Float>
ApproximateMotion<Float> ApproximateMotion<Float>::of_own_frame(const Primitive& primitive) {
  ApproximateMotion motion(primitive.pose);
  const Superquadric& solid = primitive.superquadric;
  const auto k = taper_coefficient<Float>(solid.taper);
  motion.translation_ = motion.point({0, 0, -k * Float(solid.semi_axes[2])});
  return motion;
}

template <class Float>
Coordinates<Float> ApproximateMotion<Float>::direction(const Coordinates<Float>& v) const {
  return {dot(rows_[0], v), dot(rows_[1], v), dot(rows_[2], v)};
}

template <class Float>
Coordinates<Float> ApproximateMotion<Float>::inverse_direction(const Coordinates<Float>& v) const {
  return along(along(along({}, rows_[0], v[0]), rows_[1], v[1]), rows_[2], v[2]);
}

template <class Float>
Coordinates<Float> ApproximateMotion<Float>::point(const Coordinates<Float>& x) const {
  return along(translation_, direction(x), Float(1));
}

template <class Float>
Coordinates<Float> ApproximateMotion<Float>::inverse_point(const Coordinates<Float>& x) const {
  return inverse_direction(difference(x, translation_));
}

template class ApproximateMotion<double>;
template class ApproximateMotion<long double>;

namespace {

constexpr int most_fixed_points = 6;

Superquadric without_taper(Superquadric solid) {
  solid.taper = 1.0;
  return solid;
}

/// (1 - |z|^p)^(1/p)
double profile(double z, double p) {
  return std::pow(std::max(0.0, 1.0 - std::pow(std::fabs(z), p)), 1.0 / p);
}

double slope_of_profile(double z, double p) {
  return -std::copysign(std::pow(std::fabs(z) / profile(z, p), p - 1.0), z);
}

double sine_quotient_of(double angle) {
  return angle == 0.0 ? 1.0 : std::sin(angle) / angle;
}

double radians(double degrees) {
  return degrees * (std::numbers::pi / 180.0);
}

}  // namespace

SectionMapping::SectionMapping(const Primitive& primitive)
    : superquadric_(primitive.superquadric),
      is_bent_(primitive.bend && primitive.bend->curvature != 0.0),
      taper_((primitive.superquadric.taper - 1.0) / (primitive.superquadric.taper + 1.0)),
      unbent_(primitive.superquadric),
      untapered_(without_taper(primitive.superquadric)) {
  if (!is_bent_) return;
  curvature_ = primitive.bend->curvature;
  cosine_ = std::cos(radians(primitive.bend->angle_degrees));
  sine_ = std::sin(radians(primitive.bend->angle_degrees));
}

SectionMapping::End SectionMapping::end_at(double height) const {
  const double angle = curvature_ * height;
  return {height, std::cos(angle), std::sin(angle), height * std::sin(angle / 2) * sine_quotient_of(angle / 2),
          height * sine_quotient_of(angle)};
}

SectionMapping::Plain SectionMapping::turned(const Plain& v) const {
  return {v[0] * cosine_ + v[1] * sine_, v[1] * cosine_ - v[0] * sine_, v[2]};
}

SectionMapping::Plain SectionMapping::turned_back(const Plain& v) const {
  return {v[0] * cosine_ - v[1] * sine_, v[0] * sine_ + v[1] * cosine_, v[2]};
}

/// The bent point, in the frame of the bend.
SectionMapping::Plain SectionMapping::bent(const Plain& unbent) const {
  const double angle = curvature_ * unbent[2];
  return {unbent[0] * std::cos(angle) + unbent[2] * std::sin(angle / 2) * sine_quotient_of(angle / 2), unbent[1],
          (1.0 - curvature_ * unbent[0]) * unbent[2] * sine_quotient_of(angle)};
}

SectionMapping::Plain SectionMapping::unbent(const Plain& x) const {
  if (!is_bent_) return x;
  const Plain t = turned(x);
  const double m = 1.0 - curvature_ * t[0];
  const double w = std::hypot(m, curvature_ * t[2]);
  const double r = (2.0 * t[0] - curvature_ * (t[0] * t[0] + t[2] * t[2])) / (1.0 + w);
  return turned_back({r, t[1], std::atan2(curvature_ * t[2], m) / curvature_});
}

SectionMapping::Plain SectionMapping::bent_normal(const Plain& normal, const Plain& unbent_point) const {
  if (!is_bent_) return normal;
  const Plain n = turned(normal);
  const double angle = curvature_ * unbent_point[2];
  const double along_axis = n[2] / (1.0 - curvature_ * turned(unbent_point)[0]);
  return turned_back({n[0] * std::cos(angle) + along_axis * std::sin(angle), n[1],
                      along_axis * std::cos(angle) - n[0] * std::sin(angle)});
}

/// The farthest point of the unbent solid towards (c, across, slope), in the frame of the bend.
SectionMapping::Plain SectionMapping::farthest(double c, double across, double slope) const {
  Plain x = turned(unbent_(turned_back({c, across, slope})));
  x[2] -= taper_ * superquadric_.semi_axes[2];
  return x;
}

/// The same within the section at a height.
SectionMapping::Plain SectionMapping::farthest_at(double height, double c, double across) const {
  const Plain x = turned(untapered_(turned_back({c, across, 0.0})));
  const double scale = scale_at(height);
  return {scale * x[0], scale * x[1], height};
}

/// The scale of the section at a height, relative to the middle section of the solid without its taper
/// (docs/mathematics.md §18).
double SectionMapping::scale_at(double height) const {
  const double z = std::clamp(height / superquadric_.semi_axes[2], -1.0, 1.0);
  const double s = 1.0 + taper_ * z;
  return s * profile((z + taper_) / s, 2.0 / superquadric_.exponents[0]);
}

double SectionMapping::scale_slope_at(double height) const {
  const double z = height / superquadric_.semi_axes[2];
  const double s = 1.0 + taper_ * z;
  const double unbent = (z + taper_) / s;
  const double p = 2.0 / superquadric_.exponents[0];
  const double slope = taper_ * profile(unbent, p) + slope_of_profile(unbent, p) * (1.0 - taper_ * taper_) / s;
  return slope / superquadric_.semi_axes[2];
}

/// The ends have the same value, unless the height where H - v z is attained would leave the section.
double SectionMapping::slope(const Plain& direction, const Section& section) const {
  if (!is_bent_) return 0.0;
  const Plain n = turned(direction);
  const auto& [lower, upper] = section;
  const auto axis = [&](const End& end) { return n[0] * end.along + n[2] * end.up; };
  const auto along = [&](const End& end) { return n[0] * end.cosine - n[2] * end.sine; };
  const double rise = axis(upper) - axis(lower);
  const double between = upper.height - lower.height;
  const double c_lower = along(lower);
  const double c_upper = along(upper);
  double v = rise / between;
  double height = 0.0;
  for (int i = 0; i < 2; ++i) {
    const Plain x = farthest(0.5 * (c_lower + c_upper), n[1], v);
    height = x[2];
    v = (rise + (c_upper - c_lower) * x[0]) / between;
  }
  if (height >= lower.height && height <= upper.height) return v;
  const End& end = height < lower.height ? lower : upper;
  const Plain x = turned(untapered_(turned_back({along(end), n[1], 0.0})));
  const double at_end = -scale_slope_at(end.height) * (along(end) * x[0] + n[1] * x[1]);
  return std::isfinite(at_end) ? at_end : v;  // at a pole, which no height is beyond
}

Coordinates<double> SectionMapping::support_point(const Plain& direction, const Section& section) const {
  const Plain n = turned(direction);
  if (!is_bent_) return turned_back(farthest(n[0], n[1], n[2]));
  Plain best{};
  double reach = -std::numeric_limits<double>::infinity();
  const auto try_point = [&](const Plain& unbent) {
    const Plain image = bent(unbent);
    const double found = dot(n, image);
    if (found > reach) best = image;
    reach = std::max(reach, found);
  };
  double height = 0.5 * section.lower.height + 0.5 * section.upper.height;
  double before = height;
  double r = 0.0;
  for (int i = 0; i < most_fixed_points; ++i) {
    const double cosine = std::cos(curvature_ * height);
    const double sine = std::sin(curvature_ * height);
    const double c = n[0] * cosine - n[2] * sine;
    Plain x = farthest(c, n[1], (n[0] * sine + n[2] * cosine) * (1.0 - curvature_ * r));
    const double next = std::clamp(x[2], section.lower.height, section.upper.height);
    if (next != x[2]) x = farthest_at(next, c, n[1]);
    try_point(x);
    r = x[0];
    before = std::exchange(height, next);
    if (std::fabs(height - before) <= 0x1p-50 * superquadric_.semi_axes[2]) return turned_back(best);
  }
  // Between two corners, perhaps, which take turns.
  const double between = 0.5 * (height + before);
  const double c = n[0] * std::cos(curvature_ * between) - n[2] * std::sin(curvature_ * between);
  try_point(farthest_at(between, c, n[1]));
  return turned_back(best);
}

}  // namespace verisq::verify
