/// Cosines and sines as shares of the terms of the dual norm.
#include "verify/proposals/support_mapping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "verify/proof/superquadric.hpp"
#include "verify/proposals/support_root.hpp"

namespace verisq::verify {

namespace {

/// The dual norm of (x, y) and (cos φ)^e, (sin φ)^e of the angle with tan^2 φ = (y/x)^q, q = 2/(2 - e).
template <class Float>
struct DualNorm {
  Float value;
  std::array<Float, 2> support;  ///< cos^e φ and sin^e φ: where on the unit ball the norm is attained
};

template <class Float>
Float dual_exponent_of(Float e) {
  return e == 2 ? std::numeric_limits<Float>::infinity() : 2 / (2 - e);
}

/// For nonnegative x, y; both shares 0 for x = y = 0.
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

// At the root τ of ‖(r, a3 v_z + k τ)‖ = τ N's support point u along v + (0, 0, k τ / a3), made longer or shorter until
// it lies on the surface.
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

}  // namespace verisq::verify
