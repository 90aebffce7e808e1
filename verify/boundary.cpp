/// Plain floating-point gauge, normals and ray exits.
#include "verify/boundary.hpp"

#include <algorithm>
#include <cmath>

namespace verisq::verify {

namespace {

double norm(double x, double y, double p) {
  const double large = std::max(x, y);
  if (large == 0.0) return 0.0;
  return large * std::pow(1.0 + std::pow(std::min(x, y) / large, p), 1.0 / p);
}

}  // namespace

// Beyond p = 2e12 binary64 no longer tells the norm of equal coordinates from their maximum, nor one normal from two.
Boundary::Boundary(const Superquadric& solid)
    : semi_axes_(solid.semi_axes),
      p1_(2.0 / std::max(solid.exponents[0], 1e-12)),
      p2_(2.0 / std::max(solid.exponents[1], 1e-12)) {}

double Boundary::section(const Vector& x) const {
  return norm(x[0] / semi_axes_[0], x[1] / semi_axes_[1], p2_);
}

double Boundary::gauge(const Vector& x) const {
  return norm(section(x), x[2] / semi_axes_[2], p1_);
}

Boundary::Vector Boundary::gradient(const Vector& x, double gauge) const {
  const double r = section(x);
  const auto share = [](double part, double whole, double exponent) {
    return std::pow(whole > 0.0 ? part / whole : 0.0, exponent);
  };
  const double outer = share(r, gauge, p1_ - 1.0);
  return {outer * share(x[0] / semi_axes_[0], r, p2_ - 1.0) / semi_axes_[0],
          outer * share(x[1] / semi_axes_[1], r, p2_ - 1.0) / semi_axes_[1],
          share(x[2] / semi_axes_[2], gauge, p1_ - 1.0) / semi_axes_[2]};
}

Boundary::Vector Boundary::normal(const Vector& x) const {
  Vector n = gradient(x, gauge(x));
  const double length = std::hypot(n[0], n[1], n[2]);
  for (double& c : n) c /= length;
  return n;
}

double Boundary::exit(const Vector& q, const Vector& w, double level) const {
  // g is convex along the ray and g(q + s w) >= s g(w) in the octant: Newton descends monotonically from this start.
  double s = level / gauge(w);
  for (int i = 0; i < 60; ++i) {
    const Vector x{q[0] + s * w[0], q[1] + s * w[1], q[2] + s * w[2]};
    const double g = gauge(x);
    const Vector n = gradient(x, g);
    const double step = (g - level) / (n[0] * w[0] + n[1] * w[1] + n[2] * w[2]);
    if (!(step > 1e-15 * s)) break;
    s -= step;
  }
  return std::max(s, 0.0);
}

}  // namespace verisq::verify
