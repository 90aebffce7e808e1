/// Plain floating-point gauge, normals and ray exits.
#include "verify/proposals/boundary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "verify/proof/superquadric.hpp"

namespace verisq::verify {

namespace {

template <class Float>
Float norm_of_two(Float x, Float y, Float p) {
  const Float large = std::max(x, y);
  if (large == 0) return 0;
  return large * std::pow(1 + std::pow(std::min(x, y) / large, p), 1 / p);
}

}  // namespace

// Beyond p = 2e12 binary64 no longer tells the norm of equal coordinates from their maximum, nor one normal from two.
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
  // g is convex along the ray, and g(q + s w) >= s g(w) in the octant, >= s g(w) - g(-q) anywhere: Newton descends
  // monotonically from this start.
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

}  // namespace verisq::verify
